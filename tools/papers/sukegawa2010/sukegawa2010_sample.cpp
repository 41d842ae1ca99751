// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "equidem/fields/spectrum.hpp"
#include "equidem/grains/scene/shaking.hpp"

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {

double Sample::mean() const {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double Sample::deviation() const {
  const double middle = mean();
  double squares = 0;
  for (const double value : values) squares += (value - middle) * (value - middle);
  return values.size() < 2 ? std::numeric_limits<double>::quiet_NaN()
                           : std::sqrt(squares / static_cast<double>(values.size() - 1));
}

Sample sample_of(const Reproduction& result, const Kind& kind, const std::function<double(const Outcome&)>& value) {
  Sample sample;
  for (const Done& done : result.runs) {
    const Fill& fill = done.run.fill;
    const Shaking& shaking = *done.run.shaking;
    if (fill.shape != kind.shape || fill.variant != kind.variant || shaking.gal != kind.gal ||
        shaking.frequency != kind.frequency || shaking.cycles != kind.cycles)
      continue;
    const double number = value(done.outcome);
    if (std::isfinite(number)) sample.values.push_back(number);
  }
  return sample;
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
  // Modes 1, 3, 5, ... of a box whose floor and walls accelerate: each answers the uniform acceleration as an
  // oscillator; their shares of the static shift of the centre of mass are those of 1/n^4 (long waves).
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
  // (7.2) as printed: omega_1^2 = (pi g/l) tanh(2 pi h/l).
  const double k = std::numbers::pi / width;
  return 2 * std::numbers::pi / std::sqrt(gravity * k * std::tanh(2 * k * depth));
}

}  // namespace equidem::sukegawa2010
