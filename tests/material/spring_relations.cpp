// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe's relations between springs and moduli, both ways, and what they refuse.
#include "equidem/material/spring_relations.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;
using std::numbers::pi;
using std::numbers::sqrt3;

namespace {

const IsotropicMeasures loose{0.8, 4.2 / (2 * pi)};

/// Each disc of a honeycomb has three contacts: its two sublattices move against one another under shear, so that
/// normal and tangential springs act in series. q = G/K = 2 kT/(kN + kT) lies between 0 and 2.
constexpr SpringRelation honeycomb{
    .name = "honeycomb",
    .place = "honeycomb lattice",
    .source = "three contacts in series",
    .validity = "",
    .static_limit = "the honeycomb lattice is unstable for every kT < 0",
    .moduli =
        [](const SpringConstants& k, const IsotropicMeasures&) {
          return SheetModuli{.bulk = k.kN / (2 * sqrt3), .shear = k.kN * k.kT / (sqrt3 * (k.kN + k.kT))};
        },
    .springs =
        [](const ElasticModuli& moduli, double, const IsotropicMeasures&) {
          const double K = moduli.bulk_modulus_2d(), q = moduli.shear_modulus / K;
          return SpringConstants{2 * sqrt3 * K, 2 * sqrt3 * K * q / (2 - q)};
        },
};

/// Elasticity of a set of bonds that follow a uniform strain, rotations in equilibrium (the mean rotation of the
/// field): sum over bonds of kN nnnn + kT ssss over twice the area. Independent of Abe's derivation by Taylor series.
struct Tensor {
  double C11, C12, C66;
};
Tensor affine_tensor(const SpringConstants& k, const std::vector<double>& angles, double area_per_disc) {
  const double branch = 2;  // unit radius; each disc owns half of each of its bonds
  Tensor t{};
  for (const double angle : angles) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const double weight = branch * branch / (2 * area_per_disc);
    t.C11 += weight * (k.kN * c * c * c * c + k.kT * c * c * s * s);
    t.C12 += weight * (k.kN - k.kT) * c * c * s * s;
    const double slip = (c * c - s * s) / 2;
    t.C66 += weight * (k.kN * c * c * s * s + k.kT * slip * slip);
  }
  return t;
}
std::vector<double> equally_spaced(int count) {
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(count));
  for (int b = 0; b < count; ++b) angles.push_back(2 * pi * b / count);
  return angles;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

template <class Function>
std::string refusal(Function&& function) {
  try {
    static_cast<void>(function());
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::bad_input);
    return error.what();
  }
  return "no refusal";
}

}  // namespace

TEST_CASE("springs_to_moduli_to_springs_is_the_identity") {
  const SpringRelation relation = GENERATE(isotropic_relation, lattices::hexagonal.relation, lattices::square.relation,
                                           lattices::hexagonal_restrained);
  const auto plane = GENERATE(Plane::strain, Plane::stress);
  for (const double kN : {1.0, 3e9}) {
    for (const double ratio : {-0.3, -0.1, 0.0, 0.1, 0.5, 1.0}) {
      if (relation.equal_springs != nullptr && ratio != 1.0) continue;
      if (std::string_view(relation.source) == "Abe 1996, eq. 53" && ratio >= 5.0 / 9) continue;
      const SpringConstants springs{kN, ratio * kN};
      const ElasticModuli moduli = moduli_of(springs, relation, loose, plane);
      CAPTURE(relation.name, to_string(plane), ratio, moduli.shear_modulus, moduli.poisson_ratio);
      CHECK(moduli.plane == plane);
      const SpringConstants back = springs_for(moduli, relation, loose, NegativeTangential::static_only);
      CHECK(back.kN == Approx(springs.kN).epsilon(1e-13));
      CHECK(back.kT == Approx(springs.kT).epsilon(1e-13).margin(1e-14 * kN));
    }
  }
}

TEST_CASE("lattice_moduli_are_those_of_bonds_that_follow_the_strain") {
  const SpringConstants k{1.0, GENERATE(-0.2, 0.0, 0.3, 1.0)};
  CAPTURE(k.ratio());
  SECTION("hexagonal") {
    const Tensor t = affine_tensor(k, equally_spaced(6), 2 * sqrt3);
    const ElasticModuli moduli = moduli_of(k, lattices::hexagonal.relation);
    CHECK(t.C66 == Approx(moduli.shear_modulus).epsilon(1e-13));
    CHECK((t.C11 + t.C12) / 2 == Approx(moduli.bulk_modulus_2d()).epsilon(1e-13));
    CHECK((t.C11 - t.C12) / 2 == Approx(t.C66).epsilon(1e-13));  // isotropic
  }
  SECTION("isotropic with any number of equally spaced contacts from 5 on") {
    const int z = GENERATE(5, 6, 7, 12);
    const double area = 3.7;
    CAPTURE(z);
    const Tensor t = affine_tensor(k, equally_spaced(z), area);
    const ElasticModuli moduli = moduli_of(k, isotropic_relation, {pi / area, z / (2 * pi)});
    CHECK(t.C66 == Approx(moduli.shear_modulus).epsilon(1e-13));
    CHECK((t.C11 + t.C12) / 2 == Approx(moduli.bulk_modulus_2d()).epsilon(1e-13));
  }
  SECTION("square: C11 = kN, C12 = 0, C66 = kT/2, isotropic for kT = kN only") {
    const Tensor t = affine_tensor(k, equally_spaced(4), 4);
    CHECK(t.C11 == Approx(k.kN).epsilon(1e-13));
    CHECK(std::abs(t.C12) < 1e-15);
    CHECK(t.C66 == Approx(k.kT / 2).epsilon(1e-13).margin(1e-15));
    if (k.kT == k.kN) {
      const ElasticModuli moduli = moduli_of(k, lattices::square.relation);
      CHECK(moduli.shear_modulus == Approx(t.C66).epsilon(1e-13));
      CHECK(moduli.young_modulus() == Approx(k.kN).epsilon(1e-13));
    }
  }
}

TEST_CASE("isotropic_relation_with_six_contacts_is_the_hexagonal_one") {
  const IsotropicMeasures hexagonal{pi / (2 * sqrt3), 6 / (2 * pi)};
  for (const double nu : {-0.5, 0.0, 0.1, 0.25}) {
    const ElasticModuli moduli{2.5, nu};
    const SpringConstants a = springs_for(moduli, isotropic_relation, hexagonal);
    const SpringConstants b = springs_for(moduli, lattices::hexagonal.relation);
    CAPTURE(nu);
    CHECK(a.kN == Approx(b.kN).epsilon(1e-14));
    CHECK(a.kT == Approx(b.kT).epsilon(1e-14).margin(1e-15));
  }
}

TEST_CASE("hexagonal_springs_are_those_printed_in_eq_34_and_square_in_eq_31") {
  const double G = 3;
  const double nu = 0.1;
  const SpringConstants hexagonal = springs_for({G, nu}, lattices::hexagonal.relation);
  CHECK(hexagonal.kN == Approx(2 / sqrt3 * G / (1 - 2 * nu)));
  CHECK(hexagonal.kT == Approx(2 / sqrt3 * (1 - 4 * nu) / (1 - 2 * nu) * G));
  const SpringConstants restrained = springs_for({G, nu}, lattices::hexagonal_restrained);
  CHECK(restrained.kN == Approx(sqrt3 * (5 - 4 * nu) / (6 * (1 - 2 * nu)) * G));
  CHECK(restrained.kT == Approx(sqrt3 * (1 - 4 * nu) / (6 * (1 - 2 * nu)) * G));
  const ElasticModuli no_contraction = moduli_from_young(8, 0, Plane::strain);
  CHECK(springs_for(no_contraction, lattices::square.relation).kN == Approx(8));
  CHECK(springs_for(no_contraction, lattices::square.relation).kT == Approx(8));
}

TEST_CASE("hexagonal_lattice_in_plane_stress_has_the_sheet_formulas") {
  // K = sqrt3/2 kN, G = sqrt3/4 (kN + kT), nu = (kN - kT)/(3 kN + kT), E = 2 sqrt3 kN (kN + kT)/(3 kN + kT)
  // (Griffiths & Mustoe 2001).
  const double kN = 2;
  for (const double kT : {-0.5, 0.0, 0.4, 1.0, 2.0}) {
    CAPTURE(kT);
    const ElasticModuli stress = moduli_of({kN, kT}, lattices::hexagonal.relation, {}, Plane::stress);
    CHECK(stress.poisson_ratio == Approx((kN - kT) / (3 * kN + kT)).margin(1e-15));
    CHECK(stress.young_modulus() == Approx(2 * sqrt3 * kN * (kN + kT) / (3 * kN + kT)));
    CHECK(stress.bulk_modulus_2d() == Approx(sqrt3 / 2 * kN));
    const ElasticModuli strain = moduli_of({kN, kT}, lattices::hexagonal.relation, {}, Plane::strain);
    CHECK(strain.poisson_ratio == Approx(poisson_ratio_of_ratio(kT / kN)).margin(1e-15));
    CHECK(strain.poisson_ratio == Approx(stress.poisson_ratio / (1 + stress.poisson_ratio)).margin(1e-15));
  }
}

TEST_CASE("springs_do_not_depend_on_the_reading_of_the_same_sheet") {
  const SpringRelation relation =
      GENERATE(isotropic_relation, lattices::hexagonal.relation, lattices::hexagonal_restrained);
  for (const double nu : {-0.3, 0.0, 0.15, 0.24}) {
    const ElasticModuli strain{1, nu, Plane::strain};
    const SpringConstants a = springs_for(strain, relation, loose);
    const SpringConstants b = springs_for(strain.read_as(Plane::stress), relation, loose);
    CAPTURE(nu);
    CHECK(a.kN == Approx(b.kN).epsilon(1e-13));
    CHECK(a.kT == Approx(b.kT).epsilon(1e-13));
  }
}

TEST_CASE("restrained_springs_give_the_wave_speeds_of_the_wanted_body") {
  // Wave operator of the lattice with rotation held: G' = sqrt3/4 (kN + 3 kT), G'/(1 - 2 nu') = sqrt3/2 (kN -
  // kT).
  const ElasticModuli moduli{5, 0.2};
  const SpringConstants k = springs_for(moduli, lattices::hexagonal_restrained);
  CHECK(sqrt3 / 4 * (k.kN + 3 * k.kT) == Approx(moduli.shear_modulus));
  CHECK(sqrt3 / 2 * (k.kN - k.kT) == Approx(moduli.shear_modulus / (1 - 2 * moduli.poisson_ratio)));
}

TEST_CASE("the_largest_poisson_ratio_without_negative_kT_is_hit_exactly") {
  const SpringRelation relation =
      GENERATE(isotropic_relation, lattices::hexagonal.relation, lattices::hexagonal_restrained);
  CHECK(springs_for({1, 0.25, Plane::strain}, relation, loose).kT == 0);
  CHECK(springs_for({1, 1.0 / 3, Plane::stress}, relation, loose).kT == 0);
  CHECK(springs_for(ElasticModuli{1, 0.25, Plane::strain}.read_as(Plane::stress), relation, loose).kT == 0);
  CHECK(springs_for(ElasticModuli{1, 1.0 / 3, Plane::stress}.read_as(Plane::strain), relation, loose).kT == 0);
}

TEST_CASE("a_poisson_ratio_that_needs_negative_kT_is_refused_unless_static_only") {
  const SpringRelation relation =
      GENERATE(isotropic_relation, lattices::hexagonal.relation, lattices::hexagonal_restrained);
  const std::string in_strain = refusal([&] { return springs_for({1, 0.3, Plane::strain}, relation, loose); });
  CAPTURE(in_strain);
  CHECK(contains(in_strain, "Poisson's ratio 0.3 in plane strain is out of the range of the "));
  CHECK(contains(in_strain, ", -1 to 0.25 (above 0.25 it needs kT < 0, here kT/kN = -0."));
  CHECK(contains(in_strain, relation.source));
  CHECK(contains(in_strain, "-1/3"));
  CHECK(contains(in_strain,
                 "at most 0.25, allow kT < 0 with static_only = true, or take the kN and kT of 'equidem calibrate'"));
  const std::string in_stress = refusal([&] { return springs_for({1, 0.34, Plane::stress}, relation, loose); });
  CAPTURE(in_stress);
  CHECK(contains(in_stress, ", -1 to 0.333333 (above 0.333333"));
  CHECK_NOTHROW(springs_for({1, 0.3, Plane::stress}, relation, loose));
  const SpringConstants continued =
      springs_for({1, 0.3, Plane::strain}, relation, loose, NegativeTangential::static_only);
  CHECK(continued.kN > 0);
  CHECK(continued.kT < 0);
}

TEST_CASE("each_end_of_the_range_of_a_relation_is_refused_for_its_own_reason") {
  for (const double nu : {-0.49, 0.0, 0.25, 0.3, 0.49}) {
    CAPTURE(nu);
    const SpringConstants k = springs_for({1, nu}, honeycomb);
    CHECK(k.kT > 0);
    CHECK(moduli_of(k, honeycomb).poisson_ratio == Approx(nu).margin(1e-14));
  }
  for (const auto negative : {NegativeTangential::refuse, NegativeTangential::static_only}) {
    const std::string in_strain = refusal([&] { return springs_for({1, -0.6}, honeycomb, {}, negative); });
    CAPTURE(in_strain);
    CHECK(contains(in_strain,
                   "Poisson's ratio -0.6 in plane strain is out of the range of the honeycomb lattice, -0.5 "
                   "to 0.5 (by three contacts in series it falls with kT/kN, to -0.5 where kT/kN is "
                   "infinite). Choose a Poisson's ratio above -0.5."));
    const std::string in_stress = refusal([&] {
      return springs_for({1, -0.4, Plane::stress}, honeycomb, {}, negative);
    });
    CAPTURE(in_stress);
    CHECK(contains(in_stress, "honeycomb lattice, -0.333333 to 1 (by three contacts in series it falls"));
  }
}

TEST_CASE("the_continuation_ends_where_the_body_is_incompressible") {
  const SpringRelation relation =
      GENERATE(isotropic_relation, lattices::hexagonal.relation, lattices::hexagonal_restrained);
  const auto continued = [&](double nu, Plane plane) {
    return springs_for({1, nu, plane}, relation, loose, NegativeTangential::static_only);
  };
  CHECK(std::isfinite(continued(0.4999999, Plane::strain).kN));
  CHECK(contains(refusal([&] { return continued(0.5, Plane::strain); }), "between -1 and 0.5"));
  CHECK(contains(refusal([&] { return continued(1.0, Plane::stress); }), "between -1 and 1"));
}

TEST_CASE("the_square_lattice_stands_for_nu_0_only") {
  for (const double nu : {0.1, -0.1, 0.25, 0.3}) {
    for (const auto negative : {NegativeTangential::refuse, NegativeTangential::static_only}) {
      const std::string message = refusal([&] {
        return springs_for({1, nu}, lattices::square.relation, {}, negative);
      });
      CAPTURE(nu, message);
      CHECK(contains(message, "on the square lattice (the square lattice has C11 = kN, C12 = 0 and C66 = kT/2"));
    }
  }
  const std::string message = refusal([&] { return moduli_of({1, 0.5}, lattices::square.relation); });
  CAPTURE(message);
  CHECK(contains(message, "kT/kN is 0.5 on the square lattice"));
  CHECK(contains(message, "Set kT = kN"));
}

TEST_CASE("springs_that_stand_for_no_stable_body_are_refused_with_the_limit") {
  const auto hexagonal = refusal([] { return moduli_of({1, -1}, lattices::hexagonal.relation); });
  CAPTURE(hexagonal);
  CHECK(contains(hexagonal, "kT/kN is -1 (the shear modulus is no longer positive at -1"));
  CHECK(contains(hexagonal, "-1/3"));
  CHECK_NOTHROW(moduli_of({1, -0.999}, lattices::hexagonal.relation));
  CHECK(contains(refusal([] { return moduli_of({1, -1.2}, isotropic_relation, loose); }), "Choose kT/kN above -1."));
  const auto restrained = refusal([] { return moduli_of({3, -1}, lattices::hexagonal_restrained); });
  CAPTURE(restrained);
  CHECK(contains(restrained, "Choose kT/kN above -1/3"));
  CHECK(contains(refusal([] { return moduli_of({1, 1}, lattices::hexagonal_restrained); }), "Choose kT below kN"));
  // kT/kN >= 5: a stable sheet, but with nu <= -1 it is no section of a solid.
  CHECK(contains(refusal([] { return moduli_of({1, 5}, lattices::hexagonal.relation); }), "Read it in plane stress"));
  CHECK(moduli_of({1, 5}, lattices::hexagonal.relation, {}, Plane::stress).poisson_ratio == Approx(-0.5));

  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double kN : {0.0, -1.0, nan}) {
    CHECK(contains(refusal([&] { return moduli_of({kN, 0}, lattices::hexagonal.relation); }), "kN = "));
  }
  CHECK(contains(refusal([&] { return moduli_of({1, nan}, lattices::hexagonal.relation); }), "kT = nan"));
}

TEST_CASE("the_isotropic_relation_asks_for_its_measures") {
  CHECK(contains(refusal([] { return springs_for({1, 0.1}, isotropic_relation); }), "solid fraction is 0 "));
  CHECK(contains(refusal([] { return springs_for({1, 0.1}, isotropic_relation, {1.2, 1}); }), "1.2"));
  CHECK(contains(refusal([] { return springs_for({1, 0.1}, isotropic_relation, {0.8, 0}); }), "contact density is 0 "));
  CHECK(contains(refusal([] { return moduli_of({1, 0.1}, isotropic_relation); }), "solid fraction is 0 "));
}

TEST_CASE("every_relation_says_where_it_holds") {
  for (const SpringRelation& relation :
       {isotropic_relation, lattices::hexagonal.relation, lattices::hexagonal_restrained}) {
    INFO(std::string(relation.validity));
    CHECK(contains(std::string(relation.validity), "holds for nu <= 1/4 (plane strain; 1/3 in plane stress)"));
  }
  CHECK(contains(lattices::hexagonal.relation.validity, "-1/3"));
  CHECK(contains(lattices::square.relation.validity, "nu = 0"));
  CHECK(contains(lattices::square.relation.validity, "C66 = kT/2"));
}

TEST_CASE("theory_lines_of_figures_7_and_8_agree_with_the_moduli") {
  for (const double ratio : {-0.9, -0.3, 0.0, 0.25, 0.5, 1.0}) {
    const ElasticModuli moduli = moduli_of({1, ratio}, lattices::hexagonal.relation);
    CAPTURE(ratio);
    CHECK(poisson_ratio_of_ratio(ratio) == Approx(moduli.poisson_ratio).margin(1e-15));
    CHECK(hexagonal_stiffness_ratio(ratio) ==
          Approx(2 * moduli.shear_modulus / (1 - moduli.poisson_ratio)).epsilon(1e-13));
    // Uniaxial stress along x in plane strain: e22 = -nu/(1 - nu) e11, whichever way the discs are pulled.
    const double nu = moduli.poisson_ratio;
    for (const double e11 : {1e-3, -2e-3}) {
      CHECK(poisson_ratio_of_strains(e11, -nu / (1 - nu) * e11) == Approx(nu).margin(1e-15));
    }
  }
}
