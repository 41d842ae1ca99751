// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A study file made into a study: each setting is a run of a verb, in this process.
#pragma once

#include <filesystem>

#include "equidem/study/study.hpp"

#include "command.hpp"

namespace equidem {

/// \throws Error (bad_input) as read_study_case, and where the case cannot be read
Study study_of_file(const std::filesystem::path& path, const CommonOptions& options);

}  // namespace equidem
