// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/removed_keys.hpp"

#include <algorithm>
#include <array>

namespace equidem::casefile {
namespace {

constexpr const char* chain_of_segments = "Give a chain of walls of shape = \"segment\": ends that meet are joined";
constexpr const char* table_of_displacement =
    "Integrate the record by a script, and let walls follow a [[schedule]] of kind = \"table\" by displacement and "
    "schedule of [[wall]]";
constexpr const char* end_of_law =
    "Leave it out: contacts end where their law says (linear_dashpot at zero force, hertz_dashpot at zero overlap)";
constexpr const char* both_limited = "Leave it out: friction limits spring and dashpot together";

/// Keys and tables, in the order of the reference page.
constexpr std::array keys_of_earlier_versions{
    RemovedKey{"springs", "ks", "", "Write kT instead"},
    RemovedKey{"probe", "grains", "", "Write bodies instead"},
    RemovedKey{"run", "scheme", "", "Write integrator instead"},
    RemovedKey{"ensemble", "confidence", "",
               "Leave it out: intervals are those of 95 %, and samples.csv has every sample"},
    RemovedKey{"output", "csv", "", "Name what is written in files, such as files = ['vtk', 'picture']"},
    RemovedKey{"output", "vtk", "", "Name what is written in files, such as files = ['csv', 'picture']"},
    RemovedKey{"output", "picture", "", "Name what is written in files, such as files = ['csv', 'vtk']"},
    RemovedKey{"wall", "shape", "arc", chain_of_segments},
    RemovedKey{"wall", "centre", "", chain_of_segments},
    RemovedKey{"wall", "radius", "", chain_of_segments},
    RemovedKey{"wall", "from", "", chain_of_segments},
    RemovedKey{"wall", "to", "", chain_of_segments},
    RemovedKey{"shaking", "unit", "", "Leave it out: accelerations are in m/s² (1 gal = 0.01, 1 g = 9.80665)"},
    RemovedKey{"shaking", "record", "", table_of_displacement},
    RemovedKey{"shaking", "quantity", "", table_of_displacement},
    RemovedKey{"shaking", "baseline", "", table_of_displacement},
    RemovedKey{"shaking", "scale", "", table_of_displacement},
    RemovedKey{"schedule", "kind", "smooth_table", "Write kind = \"table\" with points close enough"},
    RemovedKey{"measures", "thrown_gap", "", "Find bodies that lie apart in grains.csv or in the frames"},
    RemovedKey{"measures", "columns", "", "Leave it out: columns are two largest diameters wide"},
    RemovedKey{"collisions", "contact_end", "", end_of_law},
    RemovedKey{"collisions", "friction_cap", "", both_limited},
    RemovedKey{"collisions.walls", "contact_end", "", end_of_law},
    RemovedKey{"collisions.walls", "friction_cap", "", both_limited},
    RemovedKey{"collisions.pair", "contact_end", "", end_of_law},
    RemovedKey{"collisions.pair", "friction_cap", "", both_limited},
    RemovedKey{"stage.pair", "contact_end", "", end_of_law},
    RemovedKey{"stage.pair", "friction_cap", "", both_limited},
    RemovedKey{"collisions", "ellipse_contact", "enlarged_as_printed", "Write \"enlarged\""},
    RemovedKey{"run", "integrator", "corrected_verlet", "Write \"velocity_verlet\""},
    RemovedKey{"settling", "start", "", "Leave it out: bodies fall in time; method = \"growth\" begins dense"},
};

/// Options and verbs of the command line.
constexpr std::array words_of_earlier_versions{
    RemovedWord{"--without-critical-ratio", "Leave it out: the critical ratio is always sought"},
    RemovedWord{"reproduce", "Run tools/papers/PAPER.py of the source"},
    RemovedWord{"--list", "Give a study of data/studies"},
    RemovedWord{"--quick", "Vary fewer values in the file of the study"},
    RemovedWord{"--discs", "Give the number of discs in the case"},
};

/// The table whose keys a stage takes: "collisions" of "stage.collisions".
std::string_view of_the_case(std::string_view table) {
  constexpr std::string_view stage = "stage.";
  return table.starts_with(stage) ? table.substr(stage.size()) : table;
}

}  // namespace

std::span<const RemovedKey> removed_keys() {
  return keys_of_earlier_versions;
}

std::span<const RemovedWord> removed_words() {
  return words_of_earlier_versions;
}

const RemovedKey* removed_key(std::string_view table, std::string_view name, std::string_view value) {
  const auto found = std::ranges::find_if(keys_of_earlier_versions, [&](const RemovedKey& row) {
    return (row.table == table || row.table == of_the_case(table)) && row.name == name && row.value == value;
  });
  return found == keys_of_earlier_versions.end() ? nullptr : &*found;
}

const RemovedWord* removed_word(std::string_view word) {
  const auto found = std::ranges::find(words_of_earlier_versions, word, &RemovedWord::word);
  return found == words_of_earlier_versions.end() ? nullptr : &*found;
}

}  // namespace equidem::casefile
