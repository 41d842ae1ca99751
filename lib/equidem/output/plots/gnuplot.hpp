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
  bool timed_out = false;
};

/// Run `gnuplot script` in a folder, no shell between; it and what it has started are killed after `time_limit`
/// seconds. \param script a plain file name in the folder
/// \throws Error of kind interrupted where the user asked to stop
GnuplotRun run_gnuplot(const std::filesystem::path& folder, const std::string& script, double time_limit = 30);

}  // namespace equidem
