// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/elastic_moduli.hpp"

#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Upper end of the range of nu, where the two-dimensional bulk modulus becomes infinite.
double incompressible_poisson_ratio(Plane plane) {
  return plane == Plane::strain ? 0.5 : 1.0;
}

void check_positive(double modulus, const char* name) {
  if (!std::isfinite(modulus) || modulus <= 0) {
    bad_input(fmt::format("the {} is {:.6g} Pa", name, modulus), "a modulus must be positive and finite",
              fmt::format("Give a {} above 0 Pa", name));
  }
}

void check_poisson_ratio(double nu, Plane plane) {
  const double limit = incompressible_poisson_ratio(plane);
  if (std::isfinite(nu) && nu > -1 && nu < limit) return;
  const bool other_reading = plane == Plane::strain && nu >= 0.5 && nu < 1;
  bad_input(fmt::format("Poisson's ratio is {:.6g} in plane {}", nu, to_string(plane)),
            fmt::format("it must lie between -1 and {}, both excluded, for the body to be stable", limit),
            other_reading ? "If it was measured on a thin sheet, set plane stress"
                          : fmt::format("Give a Poisson's ratio between -1 and {}", limit));
}

}  // namespace

ElasticModuli ElasticModuli::read_as(Plane other) const {
  if (other == plane) return *this;
  const double nu = poisson_ratio;
  return {shear_modulus, other == Plane::strain ? nu / (1 + nu) : nu / (1 - nu), other};
}

double ElasticModuli::young_modulus() const {
  return 2 * shear_modulus * (1 + poisson_ratio);
}

double ElasticModuli::bulk_modulus_2d() const {
  const double nu = poisson_ratio;
  return plane == Plane::strain ? shear_modulus / (1 - 2 * nu) : shear_modulus * (1 + nu) / (1 - nu);
}

double ElasticModuli::lame_lambda() const {
  const double nu = poisson_ratio;
  return shear_modulus * 2 * nu / (plane == Plane::strain ? 1 - 2 * nu : 1 - nu);
}

ElasticModuli moduli_from_young(double young_modulus, double poisson_ratio, Plane plane) {
  check_positive(young_modulus, "Young's modulus");
  check_poisson_ratio(poisson_ratio, plane);
  return {young_modulus / (2 * (1 + poisson_ratio)), poisson_ratio, plane};
}

ElasticModuli moduli_from_bulk(double bulk_modulus_2d, double shear_modulus, Plane plane) {
  check_positive(bulk_modulus_2d, "two-dimensional bulk modulus");
  check_positive(shear_modulus, "shear modulus");
  const double K = bulk_modulus_2d;
  const double G = shear_modulus;
  // A sheet with G >= 3 K is stable, but as a section of a solid in plane strain it would have nu <= -1, that
  // is E <= 0.
  if (plane == Plane::strain && G >= 3 * K) {
    bad_input(fmt::format("a shear modulus of {:.6g} Pa with a two-dimensional bulk modulus of {:.6g} Pa has no "
                          "reading in plane strain",
                          G, K),
              fmt::format("Poisson's ratio would be {:.6g}, and no solid has one of -1 or less", (K - G) / (2 * K)),
              "Read it in plane stress");
  }
  return {G, plane == Plane::strain ? (K - G) / (2 * K) : (K - G) / (K + G), plane};
}

void check(const ElasticModuli& moduli) {
  check_positive(moduli.shear_modulus, "shear modulus");
  check_poisson_ratio(moduli.poisson_ratio, moduli.plane);
}

}  // namespace equidem
