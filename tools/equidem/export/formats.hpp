// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The formats of `equidem export`. A format is one file with one function that makes its files, and one line in the
/// table below.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "equidem/core/stopwatch.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"

namespace equidem {

/// A file of the folder; its text is made when it is written.
struct ExportedFile {
  std::string name;
  std::function<std::string()> text;
};

/// The files that a format makes of a case. It owns what its functions refer to.
struct Exported {
  std::vector<ExportedFile> files;
  Results results;  ///< lines of the report
  StageTimes times;
  std::function<void(const CommonOptions&)> write_case = {};  ///< write_case of the resolved case
};

/// Options of the verb.
struct ExportOptions : CommonOptions {
  std::string to;                   ///< name of the format
  std::vector<std::string> accept;  ///< words of EngineFeatureRow::accept
};

/// Reads the case of the options and makes the files; writes nothing.
/// \throws Error (bad_input) as the reader of the case does, and on what the format cannot carry
using ExportFunction = Exported (*)(const ExportOptions& options);

Exported export_to_lammps(const ExportOptions& options);
Exported export_to_yade(const ExportOptions& options);
Exported export_to_matrix_market(const ExportOptions& options);

struct ExportFormat {
  const char* name;  ///< as --to takes it
  const char* help;  ///< files of the folder
  ExportFunction make;
};

inline constexpr std::array export_formats{
    ExportFormat{"lammps", "in.equidem and its data file", export_to_lammps},
    ExportFormat{"yade", "run_equidem.py", export_to_yade},
    ExportFormat{"matrix-market", "K, right-hand sides, rigid motions (.mtx)", export_to_matrix_market},
};

}  // namespace equidem
