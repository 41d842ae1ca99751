// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fabric: lattices have the symmetry of their name, and directions turn with the assembly.
#include <cmath>
#include <numbers>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/stress.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;
using std::numbers::pi;

namespace {

/// How far two angles are apart, of those that differ by a period.
double apart(double a, double b, double period) {
  return std::abs(std::remainder(a - b, period));
}

}  // namespace

TEST_CASE("lattices_have_the_fabric_of_their_symmetry") {
  const LatticeOptions options{.columns = 4, .rows = 6, .radius = 0.005, .periodic = true};
  for (const Assembly& assembly : {hexagonal_lattice(options), square_lattice(options)}) {
    const Fabric f = fabric(assembly);
    const double z = assembly.coordination_number();
    CAPTURE(assembly.kind, f.anisotropy_2, f.anisotropy_4, f.direction_4);
    CHECK(difference(f.normal, {0.5, 0, 0, 0.5}) < 1e-14);
    CHECK(f.anisotropy_2 < 1e-14);
    CHECK(f.anisotropy_4 == Approx(assembly.kind == "square" ? 2 : 0).margin(1e-14));
    if (assembly.kind == "square") CHECK(apart(f.direction_4, 0, pi / 2) < 1e-14);
    CHECK(f.branch.xx + f.branch.yy == Approx(2 * z * assembly.solid_fraction() / pi).epsilon(1e-13));
    CHECK(f.mean_branch == Approx(0.01).epsilon(1e-13));
  }
}

TEST_CASE("contacts_of_one_direction_have_the_largest_anisotropy") {
  const double angle = GENERATE(0.0, 0.3, 1.4, 2.0, 3.1, -0.5);
  const Fabric f = fabric(turned(square_lattice({.columns = 5, .rows = 1, .radius = 0.005}), angle));
  const Vec2 n{std::cos(angle), std::sin(angle)};
  CAPTURE(angle, f.anisotropy_2, f.direction_2, f.anisotropy_4, f.direction_4);
  CHECK(difference(f.normal, outer(n, n)) < 1e-14);
  CHECK(f.anisotropy_2 == Approx(2).epsilon(1e-14));
  CHECK(f.anisotropy_4 == Approx(2).epsilon(1e-14));
  CHECK(apart(f.direction_2, angle, pi) < 1e-14);
  CHECK(apart(f.direction_4, angle, pi / 2) < 1e-14);
}

TEST_CASE("directions_of_fabric_turn_with_the_assembly_and_nothing_else_does") {
  const double angle = GENERATE(0.4, 1.7, -2.2, 6.0);
  for (const auto& [name, assembly] : assemblies(false)) {
    const Fabric before = fabric(assembly), after = fabric(turned(assembly, angle));
    CAPTURE(name, angle, before.anisotropy_2, before.direction_2, after.direction_2);
    CHECK(after.anisotropy_2 == Approx(before.anisotropy_2).epsilon(1e-12).margin(1e-14));
    CHECK(after.anisotropy_4 == Approx(before.anisotropy_4).epsilon(1e-12).margin(1e-14));
    if (before.anisotropy_2 > 1e-10) CHECK(apart(after.direction_2, before.direction_2 + angle, pi) < 1e-12);
    if (before.anisotropy_4 > 1e-10) CHECK(apart(after.direction_4, before.direction_4 + angle, pi / 2) < 1e-12);
    CHECK(after.mean_branch == Approx(before.mean_branch).epsilon(1e-13));
    CHECK((after.direction_2 >= 0 && after.direction_2 < pi));
    CHECK((after.direction_4 >= 0 && after.direction_4 < pi / 2));
  }
}

TEST_CASE("fabric_tensors_are_the_means_over_contacts") {
  for (const bool periodic : {false, true}) {
    for (const auto& [name, assembly] : assemblies(periodic)) {
      Tensor2 normal, branch;
      double length = 0;
      for (const Contact& contact : assembly.contacts) {
        const Vec2 l = assembly.branch(contact);
        normal += outer(l / norm(l), l / norm(l));
        branch += outer(l, l);
        length += norm(l);
      }
      const auto count = static_cast<double>(assembly.contacts.size());
      const Fabric f = fabric(assembly);
      CAPTURE(name, periodic, shown(f.normal), shown(f.branch));
      CHECK(difference(f.normal, (1 / count) * normal) < 1e-13);
      CHECK(difference(f.branch, (1 / assembly.area()) * branch) < 1e-13);
      CHECK(f.mean_branch == Approx(length / count).epsilon(1e-13));
    }
  }
}

TEST_CASE("assembly_without_contacts_has_no_fabric") {
  Assembly assembly = square_lattice({.columns = 3, .rows = 3, .radius = 0.005});
  assembly.contacts.clear();
  CHECK(contains(message_of([&] { static_cast<void>(fabric(assembly)); }), "the assembly has no contacts"));
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
