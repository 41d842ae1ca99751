// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Binding of the case file of an assembly to a Case.
#pragma once

#include <string>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/casefile/packing/packing_tables.hpp"
#include "equidem/casefile/springs_table.hpp"

namespace equidem::casefile {

/// [[load]].
struct LoadTable {
  Load load;
  std::string load_case;  ///< empty: acts in every case
};

/// A Case and the tables from which it is completed.
struct CaseTables : Case, MotionTables {
  std::vector<LoadTable> load_tables;
  PackingTables packing_tables;
  std::optional<SpringsTable> springs_table;
};

/// The case file, schema "equidem/1".
const File<CaseTables>& case_file();

/// [output] of all case files.
std::vector<Key<OutputCase>> output_keys();

}  // namespace equidem::casefile
