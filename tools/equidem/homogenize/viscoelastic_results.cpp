// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/viscoelastic_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "equidem/core/text.hpp"

#include "result_arrays.hpp"

namespace equidem {
namespace {

using Modulus = std::complex<double> HarmonicModuli::*;

/// A complex modulus with its names in the JSON, the table and the report; without a unit a ratio.
struct ModulusName {
  const char* key;
  const char* column;
  const char* symbol;
  const char* unit;
  Modulus value;
  bool shown;  ///< in the report
};
constexpr std::array modulus_names{
    ModulusName{"bulk_modulus_2d", "bulk_modulus_2d", "K", "Pa", &HarmonicModuli::bulk_modulus_2d, true},
    ModulusName{"shear_modulus", "shear_modulus", "G", "Pa", &HarmonicModuli::shear_modulus, true},
    ModulusName{"poisson_ratio/plane_strain", "poisson_ratio_plane_strain", "nu", "", &HarmonicModuli::poisson_strain,
                true},
    ModulusName{"poisson_ratio/plane_stress", "poisson_ratio_plane_stress", "nu", "", &HarmonicModuli::poisson_stress,
                false},
    ModulusName{"young_modulus/plane_strain", "young_modulus_plane_strain", "E", "Pa", &HarmonicModuli::young_strain,
                false},
    ModulusName{"young_modulus/plane_stress", "young_modulus_plane_stress", "E", "Pa", &HarmonicModuli::young_stress,
                false}};

Results frequency_row(const HarmonicStiffness& one) {
  const HarmonicModuli moduli = harmonic_moduli(one);
  Results row;
  row.add("frequency", "f", one.frequency, "Hz", {.digits = 5});
  for (const ModulusName& name : modulus_names) {
    const std::complex<double> value = moduli.*name.value;
    const std::string storage = fmt::format("{}/storage", name.key), loss = fmt::format("{}/loss", name.key);
    if (name.shown) {
      const bool ratio = *name.unit == '\0';
      row.add(storage, ratio ? fmt::format("Re {}", name.symbol) : fmt::format("{}'", name.symbol), value.real(),
              name.unit, {.digits = 7});
      row.add(loss, ratio ? fmt::format("Im {}", name.symbol) : fmt::format("{}''", name.symbol), value.imag(),
              name.unit, {.digits = 7});
    } else {
      row.set(storage, value.real()).set(loss, value.imag());
    }
  }
  row.set("normal_factor/storage", one.normal.real()).set("normal_factor/loss", one.normal.imag());
  row.set("tangential_factor/storage", one.tangential.real()).set("tangential_factor/loss", one.tangential.imag());
  row.set("stiffness/storage", one.storage).set("stiffness/loss", one.loss);
  row.set("relative_residual", one.relative_residual)
      .set("condition", one.condition)
      .set("error_bound", one.error_bound);
  return row;
}

}  // namespace

Results viscoelastic_results(const Viscoelasticity& springs, const ViscoelasticStiffness& result) {
  Results out;
  out.block(
      "\nViscoelastic: the moduli above are those of the elastic springs, these of stress over strain as exp(i 2 "
      "pi f t), without inertia\n");
  std::vector<Results> rows;
  double residual = 0, error = 0, condition = 0;
  for (const HarmonicStiffness& one : result.harmonic) {
    rows.push_back(frequency_row(one));
    residual = std::max(residual, one.relative_residual);
    condition = std::max(condition, one.condition);
    error = std::max(error, one.error_bound / std::hypot(largest_entry(one.storage), largest_entry(one.loss)));
  }
  out.table("viscoelastic/harmonic", std::move(rows));
  out.line("accuracy")
      .add("", "error bound", error, "of the largest entry, or less", {Shown::power, 1})
      .add("", "residual", residual, "", {Shown::power, 1})
      .add("", "condition", condition, "", {Shown::power, 1});
  out.line("complex solver", result.solver).add("", "factor", result.factor_bytes, "", {Shown::bytes});
  out.set("viscoelastic/normal", to_string(springs.normal.model))
      .set("viscoelastic/tangential", to_string(springs.tangential.model))
      .set("viscoelastic/solver", result.solver)
      .set("viscoelastic/factor_bytes", result.factor_bytes);
  return out;
}

Table viscoelastic_table(const ViscoelasticStiffness& result) {
  Table table;
  const auto& rows = result.harmonic;
  table.add("frequency_Hz", rows, &HarmonicStiffness::frequency);
  table.add("omega_rad_per_s", rows, [](const HarmonicStiffness& one) { return 2 * std::numbers::pi * one.frequency; });
  for (const ModulusName& name : modulus_names) {
    const std::string unit = *name.unit == '\0' ? "" : fmt::format("_{}", name.unit);
    const auto value = [&](const HarmonicStiffness& one) { return harmonic_moduli(one).*name.value; };
    table.add(fmt::format("{}_storage{}", name.column, unit), rows,
              [&](const HarmonicStiffness& one) { return value(one).real(); });
    table.add(fmt::format("{}_loss{}", name.column, unit), rows,
              [&](const HarmonicStiffness& one) { return value(one).imag(); });
  }
  table.add("error_bound_Pa", rows, &HarmonicStiffness::error_bound);
  return table;
}

Plot viscoelastic_plot(const std::string& title, const ViscoelasticStiffness& result) {
  Plot plot{.title = literal(title),
            .x = {.label = "frequency f = {/:Italic ω}/2π, Hz", .logarithmic = true},
            .y = {.label = "modulus, Pa", .logarithmic = true},
            .enhanced = true};
  struct Curve {
    const char* label;
    const char* column;
    Modulus value;
    bool loss;
    PlotColour colour;
  };
  constexpr Curve curves[] = {
      {"storage of K", "K_storage", &HarmonicModuli::bulk_modulus_2d, false, PlotColour::blue},
      {"loss of K", "K_loss", &HarmonicModuli::bulk_modulus_2d, true, PlotColour::blue},
      {"storage of G", "G_storage", &HarmonicModuli::shear_modulus, false, PlotColour::vermilion},
      {"loss of G", "G_loss", &HarmonicModuli::shear_modulus, true, PlotColour::vermilion}};
  for (const Curve& curve : curves) {
    Series series{.label = curve.label,
                  .style = curve.loss ? SeriesStyle::dashed_line : SeriesStyle::line,
                  .colour = curve.colour,
                  .column = curve.column};
    bool any = false;
    for (const HarmonicStiffness& one : result.harmonic) {
      const std::complex<double> value = harmonic_moduli(one).*curve.value;
      const double part = curve.loss ? value.imag() : value.real();
      series.x.push_back(one.frequency);
      series.y.push_back(part > one.error_bound ? part : std::numeric_limits<double>::quiet_NaN());
      any = any || part > one.error_bound;
    }
    if (any) plot.series.push_back(std::move(series));
  }
  return plot;
}

std::vector<ResultArray> viscoelastic_arrays(const ViscoelasticStiffness& result) {
  using Amplitudes = std::vector<std::complex<double>>;
  std::vector<double> frequencies;
  Amplitudes stiffness;
  for (const HarmonicStiffness& one : result.harmonic) {
    frequencies.push_back(one.frequency);
    for (int r = 0; r < 3; ++r) {
      for (int s = 0; s < 3; ++s) stiffness.emplace_back(one.storage[r][s], one.loss[r][s]);
    }
  }
  std::vector<ResultArray> arrays{array_of("viscoelastic/frequencies", "Hz", std::move(frequencies), 1)};
  const auto add = [&](const char* name, const char* unit, Amplitudes values, std::size_t columns) {
    const auto owner = std::make_shared<const Amplitudes>(std::move(values));
    arrays.push_back(
        {fmt::format("viscoelastic/{}", name), unit, owner, owner->data(), owner->size() / columns, columns, columns});
  };
  const auto all = [&](Modulus value) {
    Amplitudes values;
    for (const HarmonicStiffness& one : result.harmonic) values.push_back(harmonic_moduli(one).*value);
    return values;
  };
  add("bulk_moduli_2d", "Pa", all(&HarmonicModuli::bulk_modulus_2d), 1);
  add("shear_moduli", "Pa", all(&HarmonicModuli::shear_modulus), 1);
  add("young_moduli", "Pa", all(&HarmonicModuli::young_strain), 1);
  add("poisson_ratios", "", all(&HarmonicModuli::poisson_strain), 1);
  add("stiffnesses", "Pa", std::move(stiffness), 9);
  return arrays;
}

}  // namespace equidem
