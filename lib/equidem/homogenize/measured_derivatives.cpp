// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/measured_derivatives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "equidem/homogenize/stress.hpp"

namespace equidem {
namespace {

MeasuredNumber measured(EquilibriumSolver& solver, const Equilibrium& state, const Measure& measure,
                        std::string symbol) {
  MeasureDerivatives found = derivatives(solver, state, measure);
  return {std::move(static_cast<SpringDerivatives&>(found)), std::move(symbol), found.value, 1};
}

/// Changes of numbers that belong together are relative to their size as one.
void set_scale(std::vector<MeasuredNumber>& numbers, std::size_t first) {
  double size = 0;
  for (std::size_t k = first; k < numbers.size(); ++k) size = std::hypot(size, numbers[k].value);
  for (std::size_t k = first; k < numbers.size(); ++k) numbers[k].scale = size > 0 ? size : 1;
}

/// x a + y b.
SpringDerivatives combined(double x, const SpringDerivatives& a, double y, const SpringDerivatives& b) {
  const auto sum = [&](std::vector<double> of_a, const std::vector<double>& of_b) {
    for (std::size_t c = 0; c < of_a.size(); ++c) of_a[c] = x * of_a[c] + y * of_b[c];
    return of_a;
  };
  return {sum(a.by_kN, b.by_kN), sum(a.by_kT, b.by_kT), sum(a.by_kM, b.by_kM)};
}

Measure elongation(const Assembly& assembly, const StrainGauge& gauge) {
  const Vec2 l = assembly.centres[gauge.second] - assembly.centres[gauge.first];
  Measure measure;
  measure.motions.resize(assembly.size());
  measure.motions[gauge.second].force = (1 / dot(l, l)) * l;
  measure.motions[gauge.first].force = (-1 / dot(l, l)) * l;
  return measure;
}

}  // namespace

std::vector<MeasuredNumber> displacement_derivatives(EquilibriumSolver& solver, const Equilibrium& state,
                                                     const LoadCase& loads) {
  const Assembly& assembly = solver.assembly();
  std::set<std::string> names;
  for (const Load& load : loads) names.insert(load.group);
  std::vector<MeasuredNumber> numbers;
  for (const std::string& name : names) {
    const std::vector<std::int32_t>& discs = group(assembly, name).discs;
    const std::size_t first = numbers.size();
    for (const auto& [component, direction] : {std::pair{"ux", Vec2{1, 0}}, std::pair{"uy", Vec2{0, 1}}}) {
      Measure measure;
      measure.motions.resize(assembly.size());
      for (const std::int32_t disc : discs)
        measure.motions[disc].force = (1 / static_cast<double>(discs.size())) * direction;
      numbers.push_back(measured(solver, state, measure, name + "_" + component));
    }
    set_scale(numbers, first);
  }
  const auto held = [](const MeasuredNumber& number) {
    const auto none = [](double value) { return value == 0; };
    return std::ranges::all_of(number.by_kN, none) && std::ranges::all_of(number.by_kT, none) &&
           std::ranges::all_of(number.by_kM, none);
  };
  std::erase_if(numbers, held);
  return numbers;
}

std::vector<MeasuredNumber> stress_derivatives(EquilibriumSolver& solver, const Equilibrium& state) {
  const Assembly& assembly = solver.assembly();
  std::vector<MeasuredNumber> numbers;
  if (assembly.cell_areas.empty()) return numbers;
  const double area = assembly.area();
  constexpr std::array<std::pair<const char*, double Voigt::*>, 3> components{
      {{"stress_xx", &Voigt::xx}, {"stress_yy", &Voigt::yy}, {"stress_xy", &Voigt::xy}}};
  for (const auto& [symbol, component] : components) {
    Measure measure;
    measure.forces.resize(assembly.contacts.size());
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      const ContactFrame frame = frame_of(assembly, c);
      measure.forces[c] = {voigt_stress(force_by_branch(frame, {1, 0})).*component / area,
                           voigt_stress(force_by_branch(frame, {0, 1})).*component / area};
    }
    numbers.push_back(measured(solver, state, measure, symbol));
  }
  set_scale(numbers, 0);
  return numbers;
}

std::vector<MeasuredNumber> tension_derivatives(EquilibriumSolver& solver, const Equilibrium& state,
                                                const TensionTest& test, const TensionSetup& setup) {
  const Assembly& assembly = solver.assembly();
  const MeasuredNumber e11 = measured(solver, state, elongation(assembly, setup.horizontal), "");
  const MeasuredNumber e22 = measured(solver, state, elongation(assembly, setup.vertical), "");
  const double young = test.stress / e11.value, poisson = -e22.value / e11.value;
  return {{combined(-young / e11.value, e11, 0, e22), "E", young, std::abs(young)},
          {combined(-poisson / e11.value, e11, -1 / e11.value, e22), "nu", poisson, 1}};
}

}  // namespace equidem
