// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/packing/measures.hpp"

#include "packing/packings.hpp"
#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("friction_keeps_settled_discs_looser") {
  PackingOptions options = falling_soil(150, 0.2);
  const auto height_of_mass = [&](double friction) {
    options.settling.friction = options.settling.wall_friction = friction;
    double moment = 0, mass = 0;
    for (const Grain& grain : pack(options).grains) {
      moment += grain.inertia.mass * grain.position.y;
      mass += grain.inertia.mass;
    }
    return moment / mass;
  };
  CHECK(height_of_mass(0) < height_of_mass(0.8));
}

TEST_CASE("jammed_discs_have_moduli_between_those_of_their_bounds") {
  PackingOptions options = square_box(PackingMethod::growth, PackingBox::Sides::periodic, 200, 0.5);
  options.as_dense_as_possible = true;
  options.overlap = 1e-3;
  const GrainPacking packing = pack(options);
  const SpringConstants springs{1e8, 5e7};
  const Assembly assembly = network_of(packing, {.springs = springs});
  check(assembly);
  REQUIRE(assembly.contacts.size() == contacts_of(packing).size());
  const Matrix3 c = effective_stiffness(assembly, ContactSprings(springs)).stiffness;
  double affine = 0;
  for (const Contact& contact : assembly.contacts) {
    const Vec2 l = assembly.branch(contact);
    affine += (springs.kN + springs.kT) / 8 * dot(l, l) / assembly.area();
  }
  const double shear = (c[0][0] + c[1][1] - 2 * c[0][1] + 4 * c[2][2]) / 8;
  CAPTURE(shear, affine);
  CHECK(shear > 0.1 * affine);
  CHECK(shear < affine);
}

TEST_CASE("discs_that_cannot_come_to_rest_are_refused") {
  PackingOptions options = falling_soil(20, 0.1);
  options.settling.longest = 0.01;
  CHECK_THROWS_WITH(pack(options), Catch::Contains("not at rest"));
  options.settling.longest = 1;
  options.settling.springs.kT = 0;
  CHECK_THROWS_WITH(pack(options), Catch::Contains("tangential spring"));
  options.settling.damping = options.settling.friction = options.settling.wall_friction = 0;
  CHECK_THROWS_AS(pack(options), Error);
}

// velocity_verlet: what a contact stores when it begins within a step is not known to the work of that step: (W dt)²/6
// of the energy of the impact in the mean, W² = k/m, which the force gives back where the contact ends as fast as it
// began, and a dashpot does not.
TEST_CASE("the_energy_of_what_falls_is_accounted_for_but_for_an_error_of_the_order_of_the_scheme") {
  const double damping = GENERATE(0.3, 1.0), slip = GENERATE(0.0, 0.5);
  PackingOptions options = falling_soil(3, 0.1);
  options.settling.damping = damping;
  const auto errors = [&](double step) {
    double sum = 0;
    for (int k = 0; k < 10; ++k) {
      GrainScene scene = scene_of_box(0.1, options.settling);
      for (int disc = 0; disc < 3; ++disc) {  // a column, which falls straight where it does not slip
        Grain grain;
        grain.radius = 0.01;
        grain.inertia = inertia_of(grain.radius, options.settling.density, Body::disc);
        grain.position = {0.05, 0.012 + 0.0001 * k + 0.021 * disc};
        grain.velocity = {slip * 0.1, 0};
        scene.grains.push_back(grain);
      }
      GrainSimulation run(scene, {.law = NormalLaw::linear_dashpot,
                                  .integrator = GrainOptions::Integrator::velocity_verlet,
                                  .time_step = step});
      run.advance(std::llround(0.06 / step));
      const EnergyLedger ledger = run.energy();
      sum += std::abs(ledger.error()) / ledger.lost();
    }
    return sum / 10;
  };
  const double coarse = errors(8e-6), fine = errors(1e-6);
  CAPTURE(damping, slip, coarse, fine);
  CHECK(coarse < 6e-3);
  CHECK(fine < 1e-4);
  CHECK(coarse / fine > 40);  // 64 for the second order
}
