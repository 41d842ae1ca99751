// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Forces of an affine motion: balance on lattices, virtual work everywhere.

#include <cmath>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/homogenize/stress.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;

TEST_CASE("affine_forces_balance_on_every_disc_of_a_lattice") {
  Random random(21);
  const double ratio = GENERATE(-0.3, 0.0, 0.4, 1.0);
  const ContactSprings springs(SpringConstants{1, ratio});
  for (const auto& [name, assembly] : assemblies(true)) {
    if (assembly.kind == "delaunay") continue;
    const Tensor2 gradient = random_tensor(random);
    const double a = assembly.radii.front();
    double out_of_balance = 0, moment_free = 0, moment_held = 0;
    for (const Resultant& r :
         contact_resultants(assembly, affine_contact_forces(assembly, springs, gradient, mean_rotation(gradient)))) {
      out_of_balance = std::max(out_of_balance, norm(r.force) / a);
      moment_free = std::max(moment_free, std::abs(r.moment) / (a * a));
    }
    for (const Resultant& r : contact_resultants(assembly, affine_contact_forces(assembly, springs, gradient, 0))) {
      moment_held = std::max(moment_held, std::abs(r.moment) / (a * a));
    }
    CAPTURE(name, ratio, shown(gradient), out_of_balance, moment_free, moment_held);
    CHECK(out_of_balance < 1e-13);
    CHECK(moment_free < 1e-13);
    // Held discs feel z r kT 2 r omega with omega the rotation of the field.
    const double contacts_per_disc = assembly.coordination_number();
    CHECK(moment_held ==
          Approx(2 * contacts_per_disc * std::abs(ratio * mean_rotation(gradient))).epsilon(1e-12).margin(1e-13));
  }
}

TEST_CASE("rigid_rotation_loads_no_contact") {
  const bool periodic = GENERATE(false, true);
  const Tensor2 spin{0, -0.3, 0.3, 0};
  CHECK(mean_rotation(spin) == Approx(0.3));
  for (const auto& [name, assembly] : assemblies(periodic)) {
    double worst = 0;
    for (const ContactForce& f :
         affine_contact_forces(assembly, ContactSprings(SpringConstants{1, 0.7}), spin, mean_rotation(spin)))
      worst = std::max({worst, std::abs(f.normal), std::abs(f.tangential)});
    CAPTURE(name, periodic, worst);
    CHECK(worst < 1e-14 * 0.01);  // times the diameter, 0.01 m, of the greatest lever
  }
}

TEST_CASE("elastic_energy_of_an_affine_motion_is_the_work_of_its_stress") {
  // 2 W = A s_ij h_ij without rotation: each contact works along h l, and its levers make up l.
  Random random(22);
  for (const auto& [name, assembly] : assemblies(true)) {
    const Tensor2 h = random_tensor(random);
    std::vector<SpringConstants> constants(assembly.contacts.size());
    for (SpringConstants& k : constants) k = {random.uniform(0.5, 1.5), random.uniform(-0.2, 1)};
    const ContactSprings springs(constants);
    const auto forces = affine_contact_forces(assembly, springs, h, 0);
    double energy = 0;
    for (std::size_t c = 0; c < forces.size(); ++c) {
      energy +=
          linear_spring_energy(springs[c], {forces[c].normal / springs[c].kN, forces[c].tangential / springs[c].kT});
    }
    const Tensor2 s = macroscopic_stress(assembly, forces);
    const double work = assembly.area() / 2 * (s.xx * h.xx + s.xy * h.xy + s.yx * h.yx + s.yy * h.yy);
    CAPTURE(name, shown(h), energy, work);
    CHECK(work == Approx(energy).epsilon(1e-12));
  }
}
