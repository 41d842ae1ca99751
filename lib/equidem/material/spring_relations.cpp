// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/spring_relations.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using std::numbers::sqrt3;

/// kT = kN and nu = 0 are asked of the square lattice to round-off.
constexpr double equality_tolerance = 1e-12;

constexpr const char* square_tensor =
    "the square lattice has C11 = kN, C12 = 0 and C66 = kT/2, which is isotropic for kT = kN only, and "
    "nu = 0 then";

void check(const IsotropicMeasures& measures) {
  const double phi = measures.solid_fraction;
  const double psi = measures.contact_density;
  if (!(phi > 0 && phi <= 1)) {
    bad_input(fmt::format("the solid fraction is {:.6g}", phi),
              "the isotropic relation (Abe 1996, eq. 21) divides by it, and it lies above 0 and not above 1",
              "Give the solid fraction of the assembly");
  }
  if (!(psi > 0 && std::isfinite(psi))) {
    bad_input(fmt::format("the contact density is {:.6g} contacts per radian", psi),
              "the isotropic relation (Abe 1996, eq. 21) divides by it",
              "Give z/(2 pi), z the mean number of contacts of a disc");
  }
}

void check(const SpringConstants& springs) {
  if (!(springs.kN > 0 && std::isfinite(springs.kN))) {
    bad_input(fmt::format("the normal spring is kN = {:.6g} Pa", springs.kN), "it must be positive and finite",
              "Give a kN above 0 Pa");
  }
  if (!std::isfinite(springs.kT)) {
    bad_input(fmt::format("the tangential spring is kT = {:.6g} Pa", springs.kT), "it must be finite",
              "Give a number of Pa");
  }
}

/// What is known of the stability of kT < 0, for messages.
std::string static_limit(Packing packing) {
  switch (packing) {
    case Packing::hexagonal:
      return "the periodic hexagonal lattice is statically stable for kT/kN > -1/3 only, nu < 1/3 in plane "
             "strain, and one with free edges for kT/kN > -0.26";
    case Packing::hexagonal_restrained:
      return "with rotation restrained the hexagonal lattice is stable for kT/kN > -1/3, which nu = 1/2 in "
             "plane strain reaches";
    case Packing::isotropic:
      return "a random assembly has its own static limit of kT/kN, the periodic hexagonal lattice's is -1/3";
    case Packing::square:
      break;
  }
  return "the square lattice is unstable for every kT < 0";
}

void refuse_square(const ElasticModuli& moduli) {
  if (std::abs(moduli.poisson_ratio) <= equality_tolerance) return;
  bad_input(fmt::format("Poisson's ratio is {:.6g} on the square lattice", moduli.poisson_ratio), square_tensor,
            "Set Poisson's ratio to 0, or use the hexagonal lattice");
}

void refuse_negative_tangential(const ElasticModuli& moduli, Packing packing) {
  const bool strain = moduli.plane == Plane::strain;
  bad_input(fmt::format("Poisson's ratio is {:.6g} in plane {}", moduli.poisson_ratio, to_string(moduli.plane)),
            fmt::format("above {} it needs kT < 0, and no motion of the discs is stable then; {}",
                        strain ? "1/4" : "1/3", static_limit(packing)),
            fmt::format("Choose a Poisson's ratio of at most {}, or allow kT < 0 with static_only = true",
                        strain ? "1/4" : "1/3"));
}

/// 1 - 4 nu, nu in plane strain; exactly 0 where nu is 1/4 (1/3 in plane stress) to rounding, so that kT = 0 is hit,
/// which takes the rotations out of the unknowns.
double tangential_factor(const ElasticModuli& moduli) {
  const double nu = moduli.poisson_ratio;
  const double numerator = moduli.plane == Plane::strain ? 1 - 4 * nu : 1 - 3 * nu;
  if (std::abs(numerator) <= 4 * std::numeric_limits<double>::epsilon()) return 0;
  return moduli.plane == Plane::strain ? numerator : numerator / (1 + nu);
}

/// The two moduli whose signs decide about stability.
struct SheetModuli {
  double bulk = 0;   ///< K, Pa
  double shear = 0;  ///< G, Pa
};

/// Abe (20), (33), (53) read from springs to moduli: K = G/(1 - 2 nu).
SheetModuli sheet_moduli(const SpringConstants& k, Packing packing, const IsotropicMeasures& measures) {
  switch (packing) {
    case Packing::isotropic: {
      const double density = measures.solid_fraction * measures.contact_density;
      return {density * k.kN, density * (k.kN + k.kT) / 2};
    }
    case Packing::hexagonal:
      return {sqrt3 / 2 * k.kN, sqrt3 / 4 * (k.kN + k.kT)};
    case Packing::hexagonal_restrained:
      return {sqrt3 / 2 * (k.kN - k.kT), sqrt3 / 4 * (k.kN + 3 * k.kT)};
    case Packing::square:
      break;
  }
  return {k.kN / 2, k.kN / 2};
}

}  // namespace

SpringConstants springs_for(const ElasticModuli& moduli, Packing packing, const IsotropicMeasures& measures,
                            NegativeTangential negative) {
  check(moduli);
  if (packing == Packing::square) {
    refuse_square(moduli);
    const double E = 2 * moduli.shear_modulus;
    return {E, E};
  }
  if (packing == Packing::isotropic) check(measures);
  const double one_minus_4nu = tangential_factor(moduli);
  if (one_minus_4nu < 0 && negative == NegativeTangential::refuse) refuse_negative_tangential(moduli, packing);

  const double K = moduli.bulk_modulus_2d();  // G/(1 - 2 nu)
  switch (packing) {
    case Packing::isotropic: {
      const double density = measures.solid_fraction * measures.contact_density;
      return {K / density, K * one_minus_4nu / density};
    }
    case Packing::hexagonal:
      return {2 / sqrt3 * K, 2 / sqrt3 * K * one_minus_4nu};
    default:
      return {sqrt3 / 6 * K * (4 + one_minus_4nu), sqrt3 / 6 * K * one_minus_4nu};
  }
}

ElasticModuli moduli_of(const SpringConstants& springs, Packing packing, const IsotropicMeasures& measures,
                        Plane plane) {
  check(springs);
  if (packing == Packing::isotropic) check(measures);
  if (packing == Packing::square && std::abs(springs.kT - springs.kN) > equality_tolerance * springs.kN) {
    bad_input(fmt::format("kT/kN is {:.6g} on the square lattice", springs.ratio()), square_tensor,
              "Set kT = kN, or use the hexagonal lattice");
  }
  const SheetModuli sheet = sheet_moduli(springs, packing, measures);
  if (!(sheet.shear > 0)) {
    const bool restrained = packing == Packing::hexagonal_restrained;
    bad_input(fmt::format("kT/kN is {:.6g}", springs.ratio()),
              fmt::format("the shear modulus is no longer positive at {} and below; {}", restrained ? "-1/3" : "-1",
                          static_limit(packing)),
              fmt::format("Choose kT/kN above {}", restrained ? "-1/3" : "-1"));
  }
  if (!(sheet.bulk > 0)) {
    bad_input(fmt::format("kT/kN is {:.6g} with rotation restrained", springs.ratio()),
              "G/(1 - 2 nu) = sqrt3/2 (kN - kT) of eq. (53) must be positive", "Choose kT below kN");
  }
  return moduli_from_bulk(sheet.bulk, sheet.shear, plane);
}

std::string validity(Packing packing) {
  switch (packing) {
    case Packing::isotropic:
      return "holds for nu <= 1/4 (plane strain; 1/3 in plane stress): above, kT < 0, and only a static "
             "answer exists. "
             "A mean-field estimate: every disc is taken to follow the smooth field (Abe 1996, eqs. 20 to "
             "22).";
    case Packing::hexagonal:
      return "holds for nu <= 1/4 (plane strain; 1/3 in plane stress): above, kT < 0, and a static answer "
             "exists down to kT/kN = -1/3 on the periodic lattice, -0.26 with free edges, a dynamic one "
             "never. "
             "Exact for uniform strain (Abe 1996, eq. 34).";
    case Packing::square:
      return "holds for nu = 0 and kT = kN = E only: " + std::string(square_tensor) + " (Abe 1996, eq. 31).";
    case Packing::hexagonal_restrained:
      break;
  }
  return "holds for nu <= 1/4 (plane strain; 1/3 in plane stress): above, kT < 0, and only a static answer "
         "exists. "
         "It matches the equation of the displacements, so wave speeds and problems with prescribed "
         "displacements, "
         "but not the stress, which is not symmetric (Abe 1996, eqs. 53 and 55).";
}

double poisson_ratio_of_ratio(double ratio) {
  return (1 - ratio) / 4;
}

double hexagonal_stiffness_ratio(double ratio) {
  return 2 * sqrt3 * (1 + ratio) / (3 + ratio);
}

double poisson_ratio_of_strains(double e11, double e22) {
  return -e22 / (e11 - e22);
}

}  // namespace equidem
