// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Completion of a program's command line by bash, made from the command line itself.
#pragma once

#include <string>

#include "program.hpp"

namespace equidem {

/// A script for bash that completes commands, their options, and after options what the type of their value names:
/// files, commands, keys of the case file and their words.
std::string bash_completion(const Program& program, const CLI::App& app);

}  // namespace equidem
