// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Comparisons, and what the items share.
#include "validation/validation.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem::validation {
namespace {

constexpr double confidence_width = 2.576;  // standard errors of 99 % of a normal distribution
constexpr double round_off = 1e-12;         // relative, of a computation of some thousand steps

}  // namespace

Estimate estimate_of(const MeanEstimate& mean) {
  return {mean.mean, mean.standard_error};
}

Estimate mean_of(std::span<const double> samples) {
  return estimate_of(estimate_mean(samples, 0.95));
}

Estimate with_step_error(double coarse, double fine) {
  return {fine, std::abs(coarse - fine)};
}

double Comparison::error() const {
  const double size = std::max(std::abs(theirs.value), std::abs(ours.value));
  return std::hypot(std::hypot(theirs.error, ours.error), round_off * size);
}

bool Comparison::agrees() const {
  return std::abs(difference()) <= confidence_width * error() + allowance;
}

std::string Comparison::verdict() const {
  if (agrees()) return "agrees";
  return fmt::format("differs by {:+.2g}", difference()) + (why.empty() ? "" : ": " + why);
}

Comparison compare(std::string quantity, const std::string& published_key, Estimate ours, std::string why) {
  const Published& number = published(published_key);
  return {.quantity = std::move(quantity),
          .theirs = {number.value, number.error},
          .source = number.source,
          .ours = ours,
          .why = std::move(why)};
}

Comparison compare_formula(std::string quantity, double formula, std::string source, Estimate ours, std::string why) {
  return {.quantity = std::move(quantity),
          .theirs = {formula, 0},
          .source = std::move(source),
          .ours = ours,
          .why = std::move(why)};
}

std::span<const Item> items() {
  static const std::array all{
      Item{"bond_dilution",
           "Bonds removed from a triangular lattice",
           bond_dilution,
           {"bond_onsets", "bond_moduli"},
           {"bond_onsets", "bond_moduli"}},
      Item{"site_dilution", "Discs removed from a triangular lattice", site_dilution, {"site_onsets"}, {"site_onsets"}},
      Item{"adsorption", "Random sequential adsorption of discs", adsorption, {"adsorption"}, {"adsorption"}},
      Item{"jamming", "Jamming without friction", jamming, {"jamming"}, {"jamming"}},
      Item{"friction", "Coordination with large friction", friction, {"friction"}, {"friction"}},
      Item{"impacts", "Eight impacts", impacts, {"impacts_force", "impacts_oblique"}, {"impacts_oblique"}},
      Item{"lammps", "The granular test programs of LAMMPS", lammps, {}, {}},
      Item{"point_load", "A point load on a hexagonal half-plane", point_load, {"point_load"}, {"point_load"}},
      Item{"disc_moduli",
           "Moduli of assemblies of discs",
           disc_moduli,
           {"disc_moduli_K", "disc_moduli_G"},
           {"disc_moduli"}},
  };
  return all;
}

Series error_bars(const Series& points, std::span<const double> errors) {
  Series bars{.style = SeriesStyle::line, .colour = points.colour, .column = points.label + ", +- standard error"};
  for (std::size_t k = 0; k < points.x.size(); ++k) {
    for (const double end : {-errors[k], errors[k], std::numeric_limits<double>::quiet_NaN()}) {
      bars.x.push_back(points.x[k]);
      bars.y.push_back(points.y[k] + end);
    }
  }
  return bars;
}

void for_samples(const std::string& task, std::size_t samples, const std::function<void(std::size_t)>& body) {
  Progress progress(task);
  const auto at_once = static_cast<std::size_t>(thread_count());
  for (std::size_t begin = 0; begin < samples; begin += at_once) {
    parallel_tasks(std::min(at_once, samples - begin), [&](std::size_t k, int) { body(begin + k); });
    progress.update(static_cast<double>(std::min(begin + at_once, samples)) / static_cast<double>(samples));
  }
}

}  // namespace equidem::validation
