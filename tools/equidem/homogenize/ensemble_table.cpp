// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/ensemble_table.hpp"

#include <cstdint>
#include <functional>
#include <optional>

namespace equidem {
namespace {

std::string with_unit(const EnsembleQuantity& quantity, const std::string& what = "") {
  return quantity.name + what + (quantity.modulus ? "_Pa" : "");
}

}  // namespace

Table samples_table(const std::vector<EnsembleSample>& samples) {
  Table table;
  table.add("discs", samples, &EnsembleSample::discs).add("seed", samples, &EnsembleSample::seed);
  table.add("discs_built", samples, [](const EnsembleSample& sample) { return sample.cell.discs; });
  for (const EnsembleQuantity& quantity : ensemble_quantities) {
    table.add(with_unit(quantity), samples, [&](const EnsembleSample& sample) {
      return sample.refused() ? std::nullopt : std::optional(sample.cell.moduli.*quantity.value);
    });
  }
  return table.add("refusal", samples, &EnsembleSample::refusal);
}

std::vector<EnsembleSample> read_samples(const std::filesystem::path& path) {
  const StoredTable table(path, samples_table({}), "ensemble",
                          "Choose another --out, or leave out --resume and pass --overwrite");
  std::vector<EnsembleSample> samples(table.rows());
  for (std::size_t row = 0; row < samples.size(); ++row) {
    EnsembleSample& sample = samples[row];
    sample.discs = table.integer(row, 0);
    sample.seed = static_cast<std::uint64_t>(table.integer(row, 1));
    sample.cell.discs = table.integer(row, 2);
    for (std::size_t q = 0; q < ensemble_quantities.size(); ++q)
      sample.cell.moduli.*ensemble_quantities[q].value = table.number(row, 3 + q);
    sample.refusal = table.text(row, 3 + ensemble_quantities.size());
  }
  return samples;
}

Table statistics_table(const EnsembleStatistics& statistics) {
  const auto& sizes = statistics.sizes;
  Table table;
  table.add("discs", sizes, &EnsembleSize::discs).add("mean_discs", sizes, &EnsembleSize::mean_discs);
  table.add("samples", sizes, [](const EnsembleSize& size) { return size.estimates.front().samples; });
  table.add("refused", sizes, &EnsembleSize::refused);
  for (std::size_t q = 0; q < ensemble_quantities.size(); ++q) {
    const auto column = [&](const char* what, const auto& value) {
      table.add(with_unit(ensemble_quantities[q], what), sizes,
                [&](const EnsembleSize& size) { return std::invoke(value, size.estimates[q]); });
    };
    column("_mean", &MeanEstimate::mean);
    column("_standard_deviation", &MeanEstimate::standard_deviation);
    column("_standard_error", &MeanEstimate::standard_error);
    column("_low", &MeanEstimate::low);
    column("_high", &MeanEstimate::high);
  }
  return table;
}

}  // namespace equidem
