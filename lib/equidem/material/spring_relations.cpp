// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/spring_relations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

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

/// \param springs of the moduli; none where nu lies at the lower end or below
[[noreturn]] void refuse_outside(const ElasticModuli& moduli, const SpringRelation& relation,
                                 const ShearToBulkRange& range, const std::optional<SpringConstants>& springs) {
  const double lowest = poisson_ratio_of(range.greatest, moduli.plane);
  const double highest = poisson_ratio_of(range.least, moduli.plane);
  const std::string problem =
      fmt::format("Poisson's ratio {:.12g} in plane {} is out of the range of the {}, {:.6g} to {:.6g}",
                  moduli.poisson_ratio, to_string(moduli.plane), relation.place, lowest, highest);
  if (!springs)
    bad_input(problem,
              fmt::format("by {} it falls with kT/kN, to {:.6g} where kT/kN is infinite", relation.source, lowest),
              fmt::format("Choose a Poisson's ratio above {:.6g}", lowest));
  bad_input(
      problem,
      fmt::format("above {:.6g} it needs kT < 0, here kT/kN = {:.4g} by {}, and no motion of the discs is stable "
                  "then; {}",
                  highest, springs->ratio(), relation.source, relation.static_limit),
      fmt::format(
          "Choose a Poisson's ratio of at most {:.6g}, allow kT < 0 with static_only = true, or take the kN and "
          "kT of 'equidem calibrate', which fits the assembly itself: random ones often reach more, lattices do not",
          highest));
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
    .source = "Abe 1996, eqs. 21 and 22",
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

double shear_to_bulk(const SpringRelation& relation, double ratio, const IsotropicMeasures& measures) {
  const SheetModuli sheet = relation.moduli({1, ratio}, measures);
  return sheet.bulk > 0 ? sheet.shear / sheet.bulk : std::numeric_limits<double>::infinity();
}

ShearToBulkRange shear_to_bulk_range(const SpringRelation& relation, const IsotropicMeasures& measures) {
  constexpr double large = 1e12, finite = 1e6;  // where q grows with kT/kN, it is about as large
  const double greatest = shear_to_bulk(relation, large, measures);
  return {shear_to_bulk(relation, 0, measures), greatest < finite ? greatest : std::numeric_limits<double>::infinity()};
}

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
    return relation.springs(moduli, one_minus_4nu, measures);
  }
  const ShearToBulkRange range = shear_to_bulk_range(relation, measures);
  if (moduli.shear_modulus >= range.greatest * moduli.bulk_modulus_2d()) refuse_outside(moduli, relation, range, {});
  const SpringConstants springs = relation.springs(moduli, one_minus_4nu, measures);
  if (springs.kT < 0 && negative == NegativeTangential::refuse) refuse_outside(moduli, relation, range, springs);
  return springs;
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
              fmt::format("K = G/(1 - 2 nu) by {} must be positive", relation.source), "Choose kT below kN");
  }
  return moduli_from_bulk(sheet.bulk, sheet.shear, plane);
}

double poisson_ratio_of_ratio(double ratio) {
  return (1 - ratio) / 4;
}

double poisson_ratio_of_strains(double e11, double e22) {
  return -e22 / (e11 - e22);
}

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

namespace {

void need_damping(double value) {
  if (value >= 0 && std::isfinite(value)) return;
  bad_input(fmt::format("the damping is {}", value), "a negative one would feed the motion", "Give 0 or more");
}

}  // namespace

WaveSpeeds wave_speeds_of(const ElasticModuli& moduli, double density) {
  check(moduli);
  check_positive(density, "density", "kg/m³");
  const double g = moduli.shear_modulus;
  return {std::sqrt(g / density), std::sqrt((moduli.bulk_modulus_2d() + g) / density)};
}

WaveSpeeds wave_speeds_from_shear(double shear_speed, double poisson_ratio) {
  check_positive(shear_speed, "shear wave speed", "m/s");
  if (!(poisson_ratio > -1 && poisson_ratio < 0.5)) {
    bad_input(fmt::format("Poisson's ratio is {}", poisson_ratio), "in plane strain it lies between -1 and 1/2",
              "Correct it");
  }
  return {shear_speed, shear_speed * std::sqrt(2 * (1 - poisson_ratio) / (1 - 2 * poisson_ratio))};
}

SpringConstants springs_of_wave_speeds(double density, const WaveSpeeds& speeds) {
  check_positive(density, "density", "kg/m³");
  check_positive(speeds.shear, "shear wave speed", "m/s");
  check_positive(speeds.pressure, "pressure wave speed", "m/s");
  const double quarter = std::numbers::pi / 4 * density;
  return {quarter * speeds.pressure * speeds.pressure, quarter * speeds.shear * speeds.shear};
}

double dashpot_of(double damping, double mass, double stiffness) {
  need_damping(damping);
  check_positive(mass, "mass", "kg");
  check_positive(stiffness, "stiffness", "N/m");
  return 2 * damping * std::sqrt(mass * stiffness);
}

ContactDamping contact_damping_of(double damping, bool at_wall, double inertia_factor) {
  need_damping(damping);
  check_positive(inertia_factor, "inertia factor");
  const double normal = at_wall ? damping : damping * std::numbers::sqrt2;
  return {normal, normal * std::sqrt(1 + 1 / inertia_factor)};
}

double semi_implicit_limit(double damping_ratio) {
  need_damping(damping_ratio);
  return 2 / (std::sqrt(1 + damping_ratio * damping_ratio) + damping_ratio);
}

}  // namespace equidem
