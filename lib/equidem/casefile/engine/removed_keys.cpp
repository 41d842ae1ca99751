// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/removed_keys.hpp"

#include <algorithm>
#include <array>

namespace equidem::casefile {
namespace {

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
};

/// Options and verbs of the command line.
constexpr std::array words_of_earlier_versions{
    RemovedWord{"--without-critical-ratio", "Leave it out: the critical ratio is always sought"},
    RemovedWord{"reproduce", "Use 'equidem-papers PAPER [OPTIONS]'; 'equidem-papers --help' lists the papers"},
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
