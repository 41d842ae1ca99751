// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/engine_springs.hpp"

#include <algorithm>

namespace equidem {

YadeMaterial yade_material(const SpringConstants& springs, double radius) {
  return {.young = springs.kN * engine_depth / radius, .poisson = springs.ratio()};
}

SpringConstants yade_springs(const YadeMaterial& i, double radius_i, const YadeMaterial& j, double radius_j) {
  const auto joined = [](double a, double b) { return a + b == 0 ? 0 : 2 * a * b / (a + b); };
  const double a = i.young * radius_i, b = j.young * radius_j;
  return {.kN = joined(a, b) / engine_depth, .kT = joined(a * i.poisson, b * j.poisson) / engine_depth};
}

SpringConstants pfc_parallel_bond(const SpringConstants& springs, double radius_i, double radius_j) {
  const double area = 2 * std::min(radius_i, radius_j) * engine_depth;
  return {.kN = springs.kN * engine_depth / area, .kT = springs.kT * engine_depth / area};
}

}  // namespace equidem
