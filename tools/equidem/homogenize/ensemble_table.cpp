// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/ensemble_table.hpp"

#include <cstdint>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {
namespace {

std::string with_unit(const EnsembleQuantity& quantity, const std::string& what = "") {
  return quantity.name + what + (quantity.modulus ? "_Pa" : "");
}

std::vector<std::string> column_names() {
  std::vector<std::string> names{"discs", "seed", "discs_built"};
  for (const EnsembleQuantity& quantity : ensemble_quantities) names.push_back(with_unit(quantity));
  names.emplace_back("refusal");
  return names;
}

}  // namespace

std::string samples_csv(const std::vector<EnsembleSample>& samples) {
  CsvText csv(column_names(), samples.size());
  for (const EnsembleSample& sample : samples) {
    csv.cell(sample.discs);
    csv.cell(static_cast<std::int64_t>(sample.seed));
    csv.cell(sample.cell.discs);
    for (const EnsembleQuantity& quantity : ensemble_quantities) {
      if (sample.refused())
        csv.empty_cell();
      else
        csv.cell(sample.cell.moduli.*quantity.value);
    }
    csv.cell(std::string_view(sample.refusal));
    csv.end_row();
  }
  return csv.text();
}

std::vector<EnsembleSample> read_samples_csv(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorKind::bad_input, "the samples to continue cannot be read", why,
                "Choose another --out, or leave out --resume and pass --overwrite", path.string());
  };
  const auto rows = csv_cells(read_file(path));
  const auto names = column_names();
  if (rows.empty() || rows.front() != names) fail("its columns are not those of an ensemble");
  std::vector<EnsembleSample> samples;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const auto& row = rows[r];
    if (row.size() != names.size()) fail(fmt::format("line {} has {}", r + 1, counted(std::ssize(row), "cell")));
    const auto checked = [&](const auto& number, std::size_t column) {
      if (!number) fail(fmt::format("'{}' in line {} is not a number", row[column], r + 1));
      return *number;
    };
    EnsembleSample sample;
    sample.discs = checked(csv_integer(row[0]), 0);
    sample.seed = static_cast<std::uint64_t>(checked(csv_integer(row[1]), 1));
    sample.cell.discs = checked(csv_integer(row[2]), 2);
    for (std::size_t q = 0; q < ensemble_quantities.size(); ++q)
      sample.cell.moduli.*ensemble_quantities[q].value = checked(csv_number(row[3 + q]), 3 + q);
    sample.refusal = row.back();
    samples.push_back(std::move(sample));
  }
  return samples;
}

Table statistics_table(const EnsembleStatistics& statistics) {
  std::vector<std::int64_t> discs, samples, refused;
  std::vector<double> mean_discs;
  for (const EnsembleSize& size : statistics.sizes) {
    discs.push_back(size.discs);
    mean_discs.push_back(size.mean_discs);
    samples.push_back(size.estimates.front().samples);
    refused.push_back(size.refused);
  }
  Table table;
  table.add("discs", discs).add("mean_discs", mean_discs).add("samples", samples).add("refused", refused);
  for (std::size_t q = 0; q < ensemble_quantities.size(); ++q) {
    const auto column = [&](const char* what, const auto& value) {
      std::vector<double> values;
      for (const EnsembleSize& size : statistics.sizes) values.push_back(value(size.estimates[q]));
      table.add(with_unit(ensemble_quantities[q], what), std::move(values));
    };
    column("_mean", [](const MeanEstimate& e) { return e.mean; });
    column("_standard_deviation", [](const MeanEstimate& e) { return e.standard_deviation; });
    column("_standard_error", [](const MeanEstimate& e) { return e.standard_error; });
    column("_low", [](const MeanEstimate& e) { return e.low(); });
    column("_high", [](const MeanEstimate& e) { return e.high(); });
  }
  return table;
}

}  // namespace equidem
