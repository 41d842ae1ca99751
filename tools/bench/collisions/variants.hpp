// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The laws side by side, each as its own field sets it up.
#pragma once

#include <string>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"

namespace equidem::bench {

struct Variant {
  std::string name;
  NormalLaw law = NormalLaw::linear_dashpot;
  double dimensionless = 0;  ///< a = k dt²/m
  GrainOptions::Scheme scheme = GrainOptions::Scheme::semi_implicit_euler;
};

/// C first. The paper's stiffness (Table 2): a = 0.1, for T 4.62; X also
/// at w dt = 2, and where an impact lasts a tenth of a step.
inline std::vector<Variant> variants() {
  using enum GrainOptions::Scheme;
  return {{"C", NormalLaw::linear_dashpot, 0.1},
          {"C, a = 0.001", NormalLaw::linear_dashpot, 1e-3},
          {"C, velocity Verlet", NormalLaw::linear_dashpot, 0.1, velocity_verlet},
          {"T", NormalLaw::hertz_dashpot, 4.62},
          {"F", NormalLaw::five_case_map, 0.1},
          {"P", NormalLaw::energy_map, 0.1},
          {"X", NormalLaw::exact_flow, 0.1},
          {"X, a = 4", NormalLaw::exact_flow, 4},
          {"X, a = 1000", NormalLaw::exact_flow, 1000}};
}

inline PairProperties pair_of(const Variant& variant, double restitution) {
  PairProperties pair;
  pair.dimensionless = variant.dimensionless;
  pair.restitution = restitution;
  pair.end = variant.law == NormalLaw::exact_flow ? ContactEnd::at_zero_force : ContactEnd::at_zero_overlap;
  return pair;
}

inline GrainSimulation start(const GrainScene& scene, const Variant& variant, double step) {
  GrainOptions options;
  options.law = variant.law;
  options.scheme = variant.scheme;
  options.time_step = step;
  return {scene, options};
}

}  // namespace equidem::bench
