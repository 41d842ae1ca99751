// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/inertia.hpp"

#include <cassert>
#include <numbers>

#include "equidem/core/error.hpp"

namespace equidem {

double inertia_factor(Body body) {
  return body == Body::disc ? 0.5 : 0.4;
}

Inertia inertia_of(double radius, double density, Body body) {
  assert(radius > 0);
  check_positive(density, "density of the discs", "kg/m³");
  const double section = std::numbers::pi * radius * radius;
  const double mass = density * (body == Body::disc ? section : 4.0 / 3 * section * radius);
  return {mass, inertia_factor(body) * mass * radius * radius};
}

std::vector<Inertia> inertia_of(const std::vector<double>& radii, double density, Body body) {
  std::vector<Inertia> all;
  all.reserve(radii.size());
  for (const double radius : radii) all.push_back(inertia_of(radius, density, body));
  return all;
}

Inertia inertia_of_ellipse(double a, double b, double density) {
  assert(a > 0 && b > 0);
  check_positive(density, "density of the ellipses", "kg/m³");
  const double mass = density * std::numbers::pi * a * b;
  return {mass, mass * (a * a + b * b) / 4};
}

}  // namespace equidem
