// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/material/spring_relations.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("yade_makes_the_springs_of_its_materials_between_bodies_of_any_radii") {
  for (const SpringConstants k : {SpringConstants{2e9, 0.5e9}, SpringConstants{1e6, 0}}) {
    for (const double r : {0.001, 0.004, 0.1}) {
      for (const double s : {0.001, 0.03}) {
        const SpringConstants found = yade_springs(yade_material(k, r), r, yade_material(k, s), s);
        CAPTURE(k.kN, r, s, found.kN, found.kT);
        CHECK(found.kN == Approx(k.kN).epsilon(1e-14));
        CHECK(found.kT == Approx(k.kT).epsilon(1e-14));
      }
    }
  }
  // One material for both radii gives other springs: the harmonic mean of the radii.
  const YadeMaterial one{.young = 1e9, .poisson = 0.25};
  const SpringConstants mixed = yade_springs(one, 1, one, 3);
  CHECK(mixed.kN == Approx(1.5e9));
  CHECK(mixed.kT == Approx(0.375e9));
}

TEST_CASE("a_parallel_bond_of_pfc_has_the_springs_over_twice_the_smaller_radius") {
  const SpringConstants k{3e9, 1e9}, bond = pfc_parallel_bond(k, 0.02, 0.005);
  CHECK(bond.kN * 2 * 0.005 == Approx(k.kN));
  CHECK(bond.kT / bond.kN == Approx(k.ratio()));
}
