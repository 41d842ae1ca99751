// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_histories.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/energies.hpp"

#include "result_arrays.hpp"

namespace equidem {
namespace {

std::filesystem::path temporary_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "equidem_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    bad_input("no temporary folder for the histories of the run", std::generic_category().message(errno),
              "Make room there, or let TMPDIR name another folder");
  return name;
}

std::string text_of(const std::filesystem::path& path) {
  return std::filesystem::exists(path) ? read_file(path) : std::string();
}

void add_columns(std::vector<ResultArray>& arrays, const std::string& prefix, const std::string& csv) {
  if (csv.empty()) return;
  const std::vector<std::vector<std::string>> rows = csv_cells(csv);
  for (std::size_t c = 0; c < rows.front().size(); ++c) {
    std::vector<double> column;
    for (std::size_t r = 1; r < rows.size(); ++r) column.push_back(csv_number(rows[r].at(c)).value_or(std::nan("")));
    arrays.push_back(array_of(prefix + rows.front()[c], "", std::move(column), 1));
  }
}

}  // namespace

HistoryFolder::HistoryFolder(const std::optional<std::filesystem::path>& out, bool temporary)
    : path_(out), temporary_(!out && temporary) {
  if (temporary_) path_ = temporary_folder();
}

HistoryFolder::~HistoryFolder() {
  std::error_code ignored;
  if (temporary_) std::filesystem::remove_all(*path_, ignored);
}

std::string HistoryFolder::history() const {
  return path_ ? text_of(*path_ / "history.csv") : std::string();
}

std::vector<ResultArray> HistoryFolder::arrays(const std::vector<EnergySample>& energies, BodyFamily family,
                                               Body body) const {
  std::vector<ResultArray> arrays;
  if (path_) {
    add_columns(arrays, "history/", history());
    add_columns(arrays, "measures_history/", text_of(*path_ / "measures.csv"));
  }
  const std::vector<std::string> names = energy_columns(family, body);
  std::vector<double> times;
  std::vector<std::vector<double>> columns(names.size());
  for (const EnergySample& sample : energies) {
    times.push_back(sample.time);
    const std::vector<double> cells = energy_cells(family, sample.ledger);
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].push_back(cells[c]);
  }
  arrays.push_back(array_of("energies/time_s", "", std::move(times), 1));
  for (std::size_t c = 0; c < columns.size(); ++c)
    arrays.push_back(array_of("energies/" + names[c], "", std::move(columns[c]), 1));
  return arrays;
}

}  // namespace equidem
