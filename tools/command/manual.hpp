// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The manual of a program for man(1), made from its command line.
/// Completion of a program's command line by bash, made from the command line itself.
#pragma once

#include <optional>
#include <string>

#include "program.hpp"

namespace equidem {

/// A page in the macros of man(7): the program's own in section 1, of a command PROGRAM-COMMAND(1), of a help topic
/// PROGRAM-TOPIC(5). The first names all others under SEE ALSO.
/// \param name of the command or topic; empty: the page of the program
/// \return nothing where there is no such command or topic
std::optional<std::string> man_page(const Program& program, const CLI::App& app, const std::string& name);

/// A script for bash that completes commands, their options, and after options what the type of their value names:
/// files, commands, keys of the case file and their words.
std::string bash_completion(const Program& program, const CLI::App& app);

}  // namespace equidem
