// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/energies.hpp"

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {

std::vector<std::string> energy_columns(BodyFamily family, Body body) {
  std::vector<std::string> columns;
  for (const EnergyTerm& term : energy_terms(family))
    columns.push_back(fmt::format("{}_J{}", term.key, per_depth(body)));
  columns.push_back(fmt::format("error_J{}", per_depth(body)));
  return columns;
}

std::vector<double> energy_cells(BodyFamily family, const EnergyLedger& ledger) {
  std::vector<double> cells;
  for (const EnergyTerm& term : energy_terms(family)) cells.push_back(ledger.*term.value);
  cells.push_back(ledger.error());
  return cells;
}

void write_energy_csv(const std::filesystem::path& path, std::span<const EnergySample> energies, BodyFamily family,
                      Body body, bool overwrite) {
  std::vector<std::string> columns{"step", "time_s"};
  for (const std::string& name : energy_columns(family, body)) columns.push_back(name);
  CsvText text(columns, energies.size());
  for (const EnergySample& sample : energies) {
    text.cell(sample.step);
    text.cell(sample.time);
    for (const double value : energy_cells(family, sample.ledger)) text.cell(value);
    text.end_row();
  }
  write_file(path, text.text(), overwrite);
}

Results energy_results(BodyFamily family, Body body, const EnergyLedger& ledger, double scale) {
  const char* unit = body == Body::disc ? "J/m" : "J";
  Results energy;
  for (const EnergyTerm& term : energy_terms(family)) {
    const char* what = term.role == EnergyRole::lost ? "lost by " : term.role == EnergyRole::work ? "work of " : "";
    energy.set(term.key, ledger.*term.value, unit, fmt::format("energy: {}{}", what, term.label));
  }
  return energy.set("elastic", ledger.elastic(), unit, "energy: elastic")
      .set("dissipated", ledger.lost(), unit, "energy: lost in all")
      .set("input", ledger.work(), unit, "energy: work done on the bodies")
      .set("error", ledger.error(), unit, "energy: error of the balance")
      .set("relative_error", scale > 0 ? ledger.error() / scale : 0.0, "",
           "energy: error of the balance, relative to the largest term");
}

}  // namespace equidem
