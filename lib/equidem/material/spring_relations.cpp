// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/spring_relations.hpp"

#include <cmath>
#include <limits>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Tolerance of kT = kN and nu = 0, relative.
constexpr double equality_tolerance = 1e-12;

void check(const IsotropicMeasures& measures) {
  const double phi = measures.solid_fraction;
  const double psi = measures.contact_density;
  if (!(phi > 0 && phi <= 1)) {
    bad_input(fmt::format("the solid fraction is {:.6g}", phi),
              "the isotropic relation (Abe 1996, eq. 21) divides by it, and it lies above 0 and not above 1",
              "Give the solid fraction of the assembly");
  }
  if (!is_positive(psi)) {
    bad_input(fmt::format("the contact density is {:.6g} contacts per radian", psi),
              "the isotropic relation (Abe 1996, eq. 21) divides by it",
              "Give z/(2 pi), z the mean number of contacts of a disc");
  }
}

void refuse_negative_tangential(const ElasticModuli& moduli, const SpringRelation& relation) {
  const char* largest = moduli.plane == Plane::strain ? "1/4" : "1/3";
  bad_input(fmt::format("Poisson's ratio is {:.6g} in plane {}", moduli.poisson_ratio, to_string(moduli.plane)),
            fmt::format("above {} it needs kT < 0, and no motion of the discs is stable then; {}", largest,
                        relation.static_limit),
            fmt::format("Choose a Poisson's ratio of at most {}, or allow kT < 0 with static_only = true", largest));
}

/// 1 - 4 nu, nu in plane strain; exactly 0 where nu is 1/4 (1/3 in plane stress) to rounding, so that kT = 0 is met
/// exactly, which removes the rotations from the unknowns.
double tangential_factor(const ElasticModuli& moduli) {
  const double nu = moduli.poisson_ratio;
  const double numerator = moduli.plane == Plane::strain ? 1 - 4 * nu : 1 - 3 * nu;
  if (std::abs(numerator) <= 4 * std::numeric_limits<double>::epsilon()) return 0;
  return moduli.plane == Plane::strain ? numerator : numerator / (1 + nu);
}

}  // namespace

void check(const SpringConstants& springs, const std::string& of) {
  const std::string which = of.empty() ? "" : " " + of;
  if (!is_positive(springs.kN)) {
    bad_input(fmt::format("the normal spring{} is kN = {:.6g} Pa", which, springs.kN), "it must be positive and finite",
              "Give a kN above 0 Pa");
  }
  if (!std::isfinite(springs.kT)) {
    bad_input(fmt::format("the tangential spring{} is kT = {:.6g} Pa", which, springs.kT), "it must be finite",
              "Give a number of Pa");
  }
}

constinit const SpringRelation isotropic_relation{
    .name = "mean field, eqs. (21), (22)",
    .place = "isotropic assembly",
    .equation = "21",
    .validity =
        "holds for nu <= 1/4 (plane strain; 1/3 in plane stress): above, kT < 0, and only a static answer "
        "exists. A mean-field estimate: every disc is taken to follow the smooth field (Abe 1996, eqs. 20 to "
        "22).",
    .static_limit = "a random assembly has its own static limit of kT/kN, the periodic hexagonal lattice's is -1/3",
    .needs_measures = true,
    .moduli =
        [](const SpringConstants& k, const IsotropicMeasures& measures) {
          const double density = measures.solid_fraction * measures.contact_density;
          return SheetModuli{.bulk = density * k.kN, .shear = density * (k.kN + k.kT) / 2};
        },
    .springs =
        [](const ElasticModuli& moduli, double one_minus_4nu, const IsotropicMeasures& measures) {
          const double density = measures.solid_fraction * measures.contact_density;
          const double K = moduli.bulk_modulus_2d();
          return SpringConstants{K / density, K * one_minus_4nu / density};
        },
};

SpringConstants springs_for(const ElasticModuli& moduli, const SpringRelation& relation,
                            const IsotropicMeasures& measures, NegativeTangential negative) {
  check(moduli);
  if (relation.needs_measures) check(measures);
  const double one_minus_4nu = tangential_factor(moduli);
  if (relation.equal_springs != nullptr) {
    if (std::abs(moduli.poisson_ratio) > equality_tolerance) {
      bad_input(fmt::format("Poisson's ratio is {:.6g} on the {}", moduli.poisson_ratio, relation.place),
                relation.equal_springs, "Set Poisson's ratio to 0, or use the hexagonal lattice");
    }
  } else if (one_minus_4nu < 0 && negative == NegativeTangential::refuse) {
    refuse_negative_tangential(moduli, relation);
  }
  return relation.springs(moduli, one_minus_4nu, measures);
}

ElasticModuli moduli_of(const SpringConstants& springs, const SpringRelation& relation,
                        const IsotropicMeasures& measures, Plane plane) {
  check(springs);
  if (relation.needs_measures) check(measures);
  if (relation.equal_springs != nullptr && std::abs(springs.kT - springs.kN) > equality_tolerance * springs.kN) {
    bad_input(fmt::format("kT/kN is {:.6g} on the {}", springs.ratio(), relation.place), relation.equal_springs,
              "Set kT = kN, or use the hexagonal lattice");
  }
  const SheetModuli sheet = relation.moduli(springs, measures);
  if (!(sheet.shear > 0)) {
    bad_input(fmt::format("kT/kN is {:.6g}", springs.ratio()),
              fmt::format("the shear modulus is no longer positive at {} and below; {}", relation.shear_limit,
                          relation.static_limit),
              fmt::format("Choose kT/kN above {}", relation.shear_limit));
  }
  if (!(sheet.bulk > 0)) {
    bad_input(fmt::format("kT/kN is {:.6g} on the {}", springs.ratio(), relation.place),
              fmt::format("K = G/(1 - 2 nu) of Abe 1996, eq. ({}) must be positive", relation.equation),
              "Choose kT below kN");
  }
  return moduli_from_bulk(sheet.bulk, sheet.shear, plane);
}

double poisson_ratio_of_ratio(double ratio) {
  return (1 - ratio) / 4;
}

double poisson_ratio_of_strains(double e11, double e22) {
  return -e22 / (e11 - e22);
}

}  // namespace equidem
