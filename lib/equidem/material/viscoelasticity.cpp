// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/viscoelasticity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// i x/(1 + i x) without overflow.
std::complex<double> maxwell_factor(double x) {
  if (x <= 1) return std::complex(x * x, x) / (1 + x * x);
  const double y = 1 / x;
  return std::complex(1.0, y) / (1 + y * y);
}

std::complex<double> interpolated(const std::vector<MeasuredSpring>& table, double frequency) {
  if (frequency < table.front().frequency || frequency > table.back().frequency) {
    bad_input(fmt::format("the frequency {:.6g} Hz is outside the table of springs", frequency),
              fmt::format("it reaches from {:.6g} to {:.6g} Hz, and nothing is known beyond it",
                          table.front().frequency, table.back().frequency),
              "Choose frequencies inside, or measure further");
  }
  const auto above = std::ranges::lower_bound(table, frequency, {}, &MeasuredSpring::frequency);
  if (above->frequency == frequency) return above->factor;
  const auto below = above - 1;
  const double share = std::log(frequency / below->frequency) / std::log(above->frequency / below->frequency);
  return (1 - share) * below->factor + share * above->factor;
}

void check_table(const std::vector<MeasuredSpring>& table, const std::string& of) {
  if (table.empty()) {
    bad_input(fmt::format("the table of the {} spring is empty", of), "its stiffness is read there", "Add frequencies");
  }
  double before = 0;
  for (const MeasuredSpring& row : table) {
    if (!(row.frequency > before) || !std::isfinite(row.frequency)) {
      bad_input(fmt::format("the frequencies of the table of springs do not ascend: {} Hz after {} Hz", row.frequency,
                            before),
                "stiffness is interpolated between neighbours, and frequencies are positive", "Sort the rows");
    }
    before = row.frequency;
    const std::string place = fmt::format("of the {} spring at {:.6g} Hz", of, row.frequency);
    if (!std::isfinite(row.factor.real()) || !std::isfinite(row.factor.imag())) {
      bad_input(fmt::format("the stiffness {} is no number", place), "every frequency needs storage and loss",
                "Correct the table");
    }
    if (row.factor.imag() < 0) {
      bad_input(fmt::format("the loss {} is negative", place),
                "such a spring would give away energy in every cycle, which no passive contact does",
                "Correct the sign: storage + i loss, for motions as exp(i omega t)");
    }
    if (row.factor.real() < 0 || row.factor == 0.0) {
      bad_input(fmt::format("the storage {} is {:.6g} of the spring of the case", place, row.factor.real()),
                row.factor == 0.0 ? "nothing is left of the spring"
                                  : "a contact that pushes where it should pull is unstable",
                "Correct the table; a spring that is absent is kT = 0 in the case");
    }
  }
}

std::string describe(const ViscoelasticSpring& spring) {
  std::string name = to_string(spring.model);
  switch (spring.model) {
    case SpringModel::elastic:
      return name;
    case SpringModel::kelvin_voigt:
    case SpringModel::maxwell:
      return fmt::format("{}, tau = {:.6g} s", name, spring.time);
    case SpringModel::standard_solid:
      return fmt::format("{}, tau = {:.6g} s, arm {:.6g}", name, spring.time, spring.arm);
    case SpringModel::table:
      break;
  }
  return fmt::format("{} of {}, {:.6g} to {:.6g} Hz", name,
                     counted(static_cast<std::int64_t>(spring.table.size()), "frequency", "frequencies"),
                     spring.table.front().frequency, spring.table.back().frequency);
}

}  // namespace

std::complex<double> ViscoelasticSpring::factor(double frequency) const {
  const double x = 2 * std::numbers::pi * frequency * time;
  switch (model) {
    case SpringModel::elastic:
      return 1;
    case SpringModel::kelvin_voigt:
      return {1, x};
    case SpringModel::maxwell:
      return maxwell_factor(x);
    case SpringModel::standard_solid:
      return 1.0 + arm * maxwell_factor(x);
    case SpringModel::table:
      break;
  }
  return interpolated(table, frequency);
}

void check(const ViscoelasticSpring& spring, const std::string& of) {
  if (spring.model == SpringModel::table) return check_table(spring.table, of);
  if (!(spring.time >= 0) || !std::isfinite(spring.time)) {
    bad_input(fmt::format("the time of the {} spring is {} s", of, spring.time),
              "it is the viscosity of a dashpot over the stiffness of its spring", "Give 0 or more");
  }
  if (spring.model == SpringModel::maxwell && spring.time == 0) {
    bad_input(fmt::format("the Maxwell model of the {} spring has the time 0", of),
              "a spring behind a dashpot without viscosity carries no force", "Give a time > 0, or another model");
  }
  if (!(spring.arm > 0) || !std::isfinite(spring.arm)) {
    bad_input(fmt::format("the arm of the {} spring is {} of it", of, spring.arm), "its spring is positive",
              "Give a ratio > 0");
  }
}

std::string describe(const Viscoelasticity& springs) {
  return fmt::format("normal {}; tangential {}", describe(springs.normal), describe(springs.tangential));
}

std::vector<double> logarithmic_frequencies(double lowest, double highest, int per_decade) {
  if (!(lowest > 0 && highest >= lowest) || !std::isfinite(highest)) {
    bad_input(fmt::format("the frequencies reach from {} to {} Hz", lowest, highest),
              "they are positive, and the first is the lowest", "Correct them");
  }
  constexpr double most = 10000;
  const double count = std::ceil(std::log10(highest / lowest) * per_decade - 1e-9);
  if (!(count < most)) {
    bad_input(fmt::format("{} frequencies come out", count + 1), "each needs a factorization", "Take fewer per decade");
  }
  const auto steps = static_cast<int>(count);
  std::vector<double> result;
  result.reserve(static_cast<std::size_t>(steps) + 1);
  for (int k = 0; k < steps; ++k) result.push_back(lowest * std::pow(highest / lowest, static_cast<double>(k) / count));
  result.push_back(highest);
  return result;
}

std::vector<double> frequencies_of_interest(const Viscoelasticity& springs, int per_decade) {
  for (const ViscoelasticSpring* one : {&springs.normal, &springs.tangential}) {
    if (one->model != SpringModel::table) continue;
    std::vector<double> frequencies;
    frequencies.reserve(one->table.size());
    for (const MeasuredSpring& row : one->table) frequencies.push_back(row.frequency);
    return frequencies;
  }
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const ViscoelasticSpring* one : {&springs.normal, &springs.tangential}) {
    if (one->model == SpringModel::elastic || one->time == 0) continue;
    least = std::min(least, one->time);
    most = std::max(most, one->time);
  }
  if (most == 0) {
    bad_input("no spring has a dashpot", "both are elastic at every frequency",
              "Choose another model or time, or give the frequencies");
  }
  constexpr double beyond = 1000;
  const auto corner = [](double time) { return 1 / (2 * std::numbers::pi * time); };
  return logarithmic_frequencies(corner(most) / beyond, corner(least) * beyond, per_decade);
}

}  // namespace equidem
