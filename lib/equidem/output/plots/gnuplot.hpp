// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The program gnuplot as a child process.
#pragma once

#include <filesystem>
#include <string>

namespace equidem {

/// Result of a run of gnuplot.
struct GnuplotRun {
  bool succeeded = false;
  std::string reason;  ///< reason of a failure: "gnuplot is not installed", or the first line of its error output
};

/// Run `gnuplot script` in a folder, no shell between; ended after `time_limit` seconds.
/// \param script a plain file name in the folder
GnuplotRun run_gnuplot(const std::filesystem::path& folder, const std::string& script, double time_limit = 120);

}  // namespace equidem
