// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The papers of the program equidem-papers, and the steps that all of them share. A paper is one folder with one
/// declare function, and one line in the list of main.cpp.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/stopwatch.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/json.hpp"
#include "equidem/output/plots/plot.hpp"

#include "command.hpp"
#include "program.hpp"

namespace equidem {

template <class Item>
using Named = std::vector<std::pair<std::string, Item>>;

namespace abe1996 {
equidem::Run declare(CLI::App& command);
}
namespace abe1996_random {
equidem::Run declare(CLI::App& command);
}
namespace fujioka2005 {
equidem::Run declare(CLI::App& command);
}

/// Options of a paper with a full and a quick computation: those of results, and --quick.
Run declare_with_quick(CLI::App& command, const std::string& footer,
                       int (*reproduce)(const CommonOptions& options, bool quick));

/// Apply threads and quiet, and check before the computation that every file of it can be written.
/// \param files beside report.txt and result.json
/// \return lock_out, to be kept until finish_paper
/// \throws Error (bad_input) where a file cannot be written
[[nodiscard]] std::optional<FolderLock> start_paper(const CommonOptions& options, const std::vector<std::string>& plots,
                                                    const std::vector<std::string>& files);

/// Results of the computation of a paper.
struct PaperResult {
  std::string paper;
  std::string report;
  StageTimes times;
  Effects effects;
  std::function<void(Results&)> add_numbers;  ///< keys of this paper alone
  Named<Table> tables = {};                   ///< NAME.csv in --out
  Named<Plot> plots = {};                     ///< files of write_plot in --out
  Named<std::string> texts = {};              ///< files in --out, with their names
  std::string status = "done";
};

/// Write tables, plots and report.txt into --out, and deliver report and JSON.
/// \return exit code 0
/// \throws Error (bad_input) where a file cannot be written
int finish_paper(const CommonOptions& options, const PaperResult& result);

}  // namespace equidem
