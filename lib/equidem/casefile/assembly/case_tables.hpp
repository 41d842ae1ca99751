// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tables of the case file of an assembly, bound to a Case and to data completed from several tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/motion_tables.hpp"
#include "equidem/material/elastic_moduli.hpp"

namespace equidem::casefile {

/// [springs].
struct SpringsTable {
  SpringConstants springs;
  SpringWeighting weighting = SpringWeighting::uniform;
};

/// [material].
struct MaterialTable {
  ElasticMaterial material;
  bool static_only = false;
  SpringWeighting weighting = SpringWeighting::uniform;
};

/// [[support]].
struct SupportTable {
  Support support;
  std::optional<std::string> schedule;
};

/// [[load]].
struct LoadTable {
  Load load;
  std::string load_case;  ///< empty: acts in every case
  std::optional<std::string> schedule;
};

struct CaseTables : Case, MotionTables {
  std::optional<SpringsTable> springs_table;
  std::optional<MaterialTable> material_table;
  std::vector<SupportTable> support_tables;
  std::vector<LoadTable> load_tables;
  std::vector<InitialVelocity> velocities;
};

/// The case file, schema "equidem/1".
const File<CaseTables>& case_file();
/// The springs file, schema "equidem-springs/1".
const File<SpringsTable>& springs_file_format();

/// [output] of all case files.
std::vector<Key<OutputCase>> output_keys();

void bind_run_tables(File<CaseTables>& file);

/// Complete [run] by the tables that act in a run, with their schedules.
/// \param tables with supports, load cases and schedules
/// \throws Error (bad_input) with line and key: both or neither of duration and until_rest, a time step longer than the
///         run, two kinds of dashpots, a schedule that does not exist, a wall without a normal, tables that require a
///         run without [run], several load cases (a run is one motion)
void complete_run(const TomlValue& root, CaseTables& tables);

}  // namespace equidem::casefile
