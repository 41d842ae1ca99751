// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The measurements of a study as a table that can be written, read back and continued.
#pragma once

#include <filesystem>
#include <string>

#include "equidem/output/files/csv.hpp"
#include "equidem/study/run_study.hpp"
#include "equidem/study/study.hpp"

namespace equidem {

/// One row per timing: setting (its number), round (0: the values, not timed), seconds, processor_seconds, one column
/// per quantity (round 0 only), refusal, checksum.
Table study_samples_table(const Study& study, const StudySamples& samples, const std::string& checksum);

/// Reads a table of study_samples_table; numbers have the same bits.
/// \throws Error (bad_input) where the file is another table, damaged, or of another study, machine or build
StudySamples read_study_samples(const std::filesystem::path& path, const Study& study, const std::string& checksum);

}  // namespace equidem
