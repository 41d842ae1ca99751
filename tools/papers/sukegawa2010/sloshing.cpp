// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Selections of runs, and sloshing of a liquid.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/fields/spectrum.hpp"
#include "equidem/grains/scene/shaking.hpp"

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {

std::vector<double> values_of(const Reproduction& result, const Kind& kind,
                              const std::function<double(const Outcome&)>& value) {
  std::vector<double> values;
  for (const Done& done : result.runs) {
    const Fill& fill = done.run.fill;
    const Shaking& shaking = *done.run.shaking;
    if (fill.shape != kind.shape || fill.variant != kind.variant || shaking.gal != kind.gal ||
        shaking.frequency != kind.frequency || shaking.cycles != kind.cycles)
      continue;
    const double number = value(done.outcome);
    if (std::isfinite(number)) values.push_back(number);
  }
  return values;
}

MeanEstimate sample_of(const Reproduction& result, const Kind& kind,
                       const std::function<double(const Outcome&)>& value) {
  return estimate_mean(values_of(result, kind, value), 0.95);
}

std::vector<Done> mapped(const Reproduction& result, Shape shape) {
  std::vector<Done> runs;
  for (const Done& done : result.runs)
    if (done.run.mapped && done.run.fill.shape == shape) runs.push_back(done);
  return runs;
}

std::vector<Done> resonance_runs(const Reproduction& result) {
  std::vector<Done> runs = mapped(result, Shape::disc);
  std::erase_if(runs, [](const Done& done) { return done.run.shaking->gal != 400; });
  std::sort(runs.begin(), runs.end(),
            [](const Done& a, const Done& b) { return a.run.shaking->frequency > b.run.shaking->frequency; });
  return runs;
}

double first_period(const Done& done) {
  return sloshing_period(done.run.fill.grid.width(), done.outcome.height_before, gravity);
}

double amplification_of(const Done& done) {
  const Shaking& shaking = *done.run.shaking;
  const double width = done.run.fill.grid.width();
  const double tilted = gal * shaking.gal / gravity * width * width / (12 * done.outcome.height_before);
  return done.outcome.swing / tilted;
}

double liquid_amplification(double period, double width, double depth) {
  // Modes 1, 3, 5, ... of an accelerated box are oscillators under a uniform acceleration; their shares of the static
  // shift of the centre of mass are proportional to 1/n^4 (long waves).
  double sum = 0, all = 0;
  for (int n = 1; n < 20; n += 2) {
    const double share = 1.0 / (n * n * n * n);
    const double own = sloshing_period(width / n, depth, gravity);
    all += share;
    sum += share / (1 - (own / period) * (own / period));
  }
  return std::abs(sum / all);
}

double printed_formula_period(double width, double depth) {
  const double k = std::numbers::pi / width;
  return 2 * std::numbers::pi / std::sqrt(gravity * k * std::tanh(2 * k * depth));
}

}  // namespace equidem::sukegawa2010
