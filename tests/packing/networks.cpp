// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Packings of all shapes as networks of contacts with springs.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/delaunay.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/overlaps.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "packing/packings.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

namespace {

using Kind = PackingShape::Kind;
constexpr SpringConstants usual{1e8, 5e7};

std::vector<PackingShape> networked_shapes() {
  return {{.kind = Kind::disc},
          {.kind = Kind::ellipse, .aspect = 2},
          {.kind = Kind::rigid_pair},
          {.kind = Kind::clump, .discs = {{{0, 0}, 1}, {{1.5, 0}, 1}, {{0.7, 1.2}, 1}}}};
}

PackingOptions jammed(const PackingShape& shape, std::int64_t bodies) {
  PackingOptions options = square_box(PackingMethod::growth, PackingBox::Sides::periodic, bodies, 0.5);
  options.shape = shape;
  const double side = std::sqrt(area_of(shape, options.radii) / 0.5);
  options.box.size = {side, side};
  options.as_dense_as_possible = true;
  options.overlap = 1e-3;
  return options;
}

}  // namespace

TEST_CASE("settled_bodies_of_every_shape_make_a_network_that_walls_hold") {
  const PackingShape shape = GENERATE(from_range(networked_shapes()));
  PackingOptions options = falling_soil(40, 0.15);
  options.shape = shape;
  const GrainPacking packing = pack(options);
  const SettlingReport& report = packing.settling;
  CAPTURE(to_string(shape.kind), report.unbalanced, report.time);
  CHECK(report.unbalanced <= 1e-6);
  const HeldNetwork held = held_network_of(packing, {.springs = options.settling.springs});
  check(held.assembly);
  CHECK(held.assembly.contact_arms.empty() == shape.is_disc());
  CHECK(held.assembly.groups.at("walls").discs.size() + held.bodies.size() == held.assembly.size());
}

// Jammed bodies without weight hold each other: their forces balance on every body, moments too.
TEST_CASE("the_forces_at_rest_of_jammed_bodies_balance_and_are_those_of_their_overlaps") {
  const PackingShape shape = GENERATE(from_range(networked_shapes()));
  const GrainPacking packing = pack(jammed(shape, 60));
  const Assembly assembly = network_of(packing, {.springs = usual});
  check(assembly);
  const RestBalance balance = balance_at_rest(assembly);
  CAPTURE(to_string(shape.kind), balance.loaded, balance.mean_force, balance.relative, balance.disc_of_force,
          balance.largest_force, balance.largest_moment);
  CHECK(balance.loaded > 60);
  CHECK(balance.mean_force == Approx(1e-3 * usual.kN * assembly.mean_radius()).epsilon(0.6));
  CHECK(balance.relative < 1e-4);
  const std::vector<PackingContact> contacts = contacts_of(packing);
  REQUIRE(contacts.size() == assembly.contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    CHECK(force_at_rest(assembly, c).normal == -usual.kN * std::max(contacts[c].overlap, 0.0));
    CHECK(force_at_rest(assembly, c).tangential == 0);
  }
  // Without springs there is no force to tell, and what only lies apart carries none.
  CHECK_FALSE(carries_forces(network_of(packing, {})));
  PackingOptions loose = jammed(shape, 30);
  loose.method = PackingMethod::rejection;
  loose.box.size = 2.0 * loose.box.size;
  CHECK_FALSE(carries_forces(network_of(pack(loose), {.springs = usual, .gap_tolerance = 0.1})));
}

// The contacts of a body that fell bear its weight, and those with the walls the weight of all.
TEST_CASE("the_forces_at_rest_of_bodies_that_fell_balance_their_weight") {
  const PackingShape shape = GENERATE(from_range(networked_shapes()), PackingShape{.kind = Kind::bonded_pair});
  PackingOptions options = falling_soil(30, 0.12);
  options.shape = shape;
  const GrainPacking packing = pack(options);
  const HeldNetwork held = held_network_of(packing, {.springs = options.settling.springs});
  const Assembly& assembly = held.assembly;
  check(assembly);
  std::vector<Vec2> forces(assembly.size());
  std::vector<double> moments(assembly.size()), within(assembly.size());
  double largest_tangential = 0, mean = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const ContactFrame frame = frame_of(assembly, c);
    const ContactForce force = force_at_rest(assembly, c);
    const auto i = static_cast<std::size_t>(assembly.contacts[c].i),
               j = static_cast<std::size_t>(assembly.contacts[c].j);
    forces[i] += force_on_i(frame, force);
    forces[j] -= force_on_i(frame, force);
    moments[i] += moment_on_i(frame, force);
    moments[j] += moment_on_j(frame, force);
    CHECK(force.normal <= 0);
    // the place of a contact in its overlap is a matter of convention
    const double about = std::hypot(force.normal, force.tangential) * -force.normal / options.settling.springs.kN;
    within[i] += about;
    within[j] += about;
    largest_tangential = std::max(largest_tangential, std::abs(force.tangential));
    mean += std::abs(force.normal) / static_cast<double>(assembly.contacts.size());
  }
  CHECK(largest_tangential > 0.01 * mean);
  const std::vector<Inertia> inertia = inertia_of(assembly, options.settling.density, Body::disc);
  for (std::size_t k = 0; k < held.bodies.size(); ++k) {
    const Vec2 lack = forces[k] - Vec2{0, inertia[k].mass * options.settling.gravity};
    CAPTURE(to_string(shape.kind), k, lack.x, lack.y, moments[k], within[k], mean);
    CHECK(norm(lack) < 1e-4 * mean);
    CHECK(std::abs(moments[k]) < within[k] + 1e-5 * mean * assembly.radii[k]);
  }
  // The walls are left out: their mirrors lack all that they hold up.
  const RestBalance balance = balance_at_rest(assembly, assembly.groups.at("walls").discs);
  CHECK(balance.disc_of_force < static_cast<std::int32_t>(held.bodies.size()));
  CHECK(balance.largest_force ==
        Approx(options.settling.gravity * std::ranges::max(inertia, {}, &Inertia::mass).mass).epsilon(0.3));
}

TEST_CASE("pairs_tied_by_dashpots_are_rigid_bodies_of_the_network") {
  PackingOptions options = falling_soil(20, 0.12);
  options.shape = {.kind = Kind::bonded_pair};
  const GrainPacking packing = pack(options);
  CAPTURE(packing.settling.unbalanced);
  CHECK(packing.settling.unbalanced <= 1e-6);
  const Assembly network = network_of(packing, {.springs = options.settling.springs});
  REQUIRE(network.size() == packing.size());
  const std::vector<Inertia> inertia = inertia_of(network, options.settling.density, Body::disc);
  for (std::size_t k = 0; k < packing.size(); ++k) {
    const Grain &a = packing.grains[2 * k], &b = packing.grains[2 * k + 1];
    const Vec2 way = b.position - a.position;
    CHECK(inertia[k].mass == Approx(a.inertia.mass + b.inertia.mass).epsilon(1e-12));
    CHECK(inertia[k].moment ==
          Approx(a.inertia.moment + b.inertia.moment + 0.5 * a.inertia.mass * dot(way, way)).epsilon(1e-12));
  }
}

TEST_CASE("networks_have_all_contacts_masses_and_areas_of_their_packing_and_moduli_below_their_bound") {
  const PackingShape shape = GENERATE(from_range(networked_shapes()));
  const PackingOptions options = jammed(shape, 80);
  const GrainPacking packing = pack(options);
  const Assembly assembly = network_of(packing, {.springs = usual});
  check(assembly);
  REQUIRE(assembly.size() == packing.size());
  CHECK(assembly.contacts.size() == contacts_of(packing).size());
  CHECK(assembly.solid_fraction() == Approx(measure(packing).solid_fraction).epsilon(1e-10));
  const std::vector<Inertia> inertia = inertia_of(assembly, options.settling.density, Body::disc);
  for (std::size_t k = 0; k < packing.size(); ++k) {
    CHECK(inertia[k].mass == Approx(packing.grains[k].inertia.mass).epsilon(1e-10));
    CHECK(inertia[k].moment == Approx(packing.grains[k].inertia.moment).epsilon(1e-10));
  }
  const Matrix3 c = effective_stiffness(assembly, ContactSprings(usual)).stiffness,
                voigt = voigt_stiffness(assembly, ContactSprings(usual));
  const auto own = eigenstrains(c), below = eigenstrains(voigt + (-1.0) * c);
  CAPTURE(to_string(shape.kind), assembly.contacts.size(), own.values[0], own.values[2], below.values[0]);
  CHECK(own.values[0] > 0.05 * usual.kN);
  CHECK(below.values[0] > 0);
}

// The cells of a free sample fill the rectangle about the bodies as they lie, not one about discs of their area.
TEST_CASE("a_free_sample_takes_the_rectangle_about_its_bodies") {
  const PackingShape shape = GENERATE(from_range(networked_shapes()), PackingShape{.kind = Kind::bonded_pair});
  PackingOptions options = square_box(PackingMethod::rejection, PackingBox::Sides::walls, 30, 0.3);
  options.shape = shape;
  const double side = std::sqrt(area_of(shape, options.radii) / 0.3);
  options.box.size = {side, side};
  const GrainPacking packing = pack(options);
  Assembly assembly = network_of(packing, {.springs = usual});
  measure_cells(assembly);
  // By places on the outlines, one by one; between two of them an arc rises by at most 1/2 (pi/n)² of its half-axis.
  constexpr int places = 2000;
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Grain& grain : packing.grains) {
    const Outline outline = outline_of(grain, packing.clumps);
    for (std::size_t p = 0; p < outline.parts(); ++p) {
      const Ellipse part = outline.part(p);
      for (int k = 0; k < places; ++k) {
        const double angle = 2 * std::numbers::pi * k / places;
        const Vec2 x = grain.position + outline.offset(p) + part.a * std::cos(angle) * part.axis +
                       part.b * std::sin(angle) * perpendicular(part.axis);
        low = {std::min(low.x, x.x), std::min(low.y, x.y)}, high = {std::max(high.x, x.x), std::max(high.y, x.y)};
      }
    }
  }
  CAPTURE(to_string(shape.kind), low.x, low.y, high.x, high.y);
  CHECK(assembly.area() == Approx((high.x - low.x) * (high.y - low.y)).epsilon(1e-5));
  CHECK(assembly.box.has_value());
}

// Jammed ellipses have fewer contacts than their motions need (Donev et al. 2007, Phys. Rev. E 75, 051304): without
// friction they are floppy, or a hair's breadth from it.
TEST_CASE("jammed_ellipses_without_friction_have_no_modulus_and_no_support_is_asked_of_their_cell") {
  for (const double size : {1.0, 1e-4, 1e5}) {
    PackingOptions options = jammed({.kind = Kind::ellipse, .aspect = 2}, 30);
    options.box.size *= size;
    for (double& radius : options.radii) radius *= size;
    const Assembly assembly = network_of(pack(options), {.springs = usual});
    REQUIRE(2 * assembly.contacts.size() < 6 * assembly.size());
    const std::string remedy = test::refusal_of([&] {
                                 effective_stiffness(assembly, ContactSprings(SpringConstants{usual.kN, 0}));
                               }).remedy;
    CAPTURE(size, remedy);
    CHECK_THAT(remedy,
               Catch::Contains("contacts") && Catch::Contains("tangential springs") && !Catch::Contains("support"));
  }
}

TEST_CASE("clumps_that_touch_twice_have_a_spring_in_each_place") {
  GrainPacking packing;
  packing.box = {{10, 10}, PackingBox::Sides::walls};
  // Two pairs lying on each other, side by side, the lower on the floor.
  make_grains({.kind = Kind::rigid_pair}, {{{5, 1}, {5, 3}}, {1, 1}, {0, 0}}, 1, packing);
  const Assembly free = network_of(packing, {.springs = usual});
  REQUIRE(free.contacts.size() == 2);
  CHECK(free.contact_arms[0].offset_i + free.contact_arms[1].offset_i == Approx(0).margin(1e-14));
  CHECK(std::abs(free.contact_arms[0].offset_i) == Approx(1));
  CHECK(free.contacts[0].lever_i == Approx(1));
  const HeldNetwork held = held_network_of(packing, {.springs = usual});
  REQUIRE(held.assembly.contacts.size() == 4);
  CHECK(held.assembly.groups.at("walls").discs.size() == 1);
  // Normal springs alone hold what rests in two places: statics has an answer, stiff against rocking as two springs two
  // apart.
  const std::vector<Support> walls{{.group = "walls", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  Assembly scene = held.assembly;
  scene.groups["top"] = {{1}, {}};
  const Equilibrium rocked =
      solve_equilibrium(scene, ContactSprings(usual), walls, {{.group = "top", .force = {}, .moment = 1}});
  CHECK(rocked.motions[1].theta == Approx(1 / usual.kN).epsilon(1e-9));
}

TEST_CASE("bonds_join_the_discs_whose_gap_is_within_the_tolerance_and_no_others") {
  const double tolerance = GENERATE(0.0, 0.01, 0.1, 0.5);
  const auto sides = GENERATE(PackingBox::Sides::periodic, PackingBox::Sides::walls);
  const GrainPacking packing = pack(square_box(PackingMethod::growth, sides, 60, 0.7));
  const Assembly network = network_of(packing, {.gap_tolerance = tolerance});
  std::vector<std::array<std::int32_t, 4>> expected, found;
  const int images = packing.box.periodic() ? 1 : 0;
  for (std::int32_t i = 0; i < std::ssize(packing.grains); ++i) {
    for (std::int32_t j = i + 1; j < std::ssize(packing.grains); ++j) {
      for (int sx = -images; sx <= images; ++sx) {
        for (int sy = -images; sy <= images; ++sy) {
          const Vec2 shift{sx * packing.box.size.x, sy * packing.box.size.y};
          const double ri = packing.radii[static_cast<std::size_t>(i)], rj = packing.radii[static_cast<std::size_t>(j)];
          const Vec2 branch = packing.grains[static_cast<std::size_t>(j)].position + shift -
                              packing.grains[static_cast<std::size_t>(i)].position;
          if (norm(branch) - ri - rj <= std::max(tolerance * (ri + rj), 1e-8 * std::min(ri, rj)))
            expected.push_back({i, j, sx, sy});
        }
      }
    }
  }
  for (const Contact& c : network.contacts) found.push_back({c.i, c.j, c.shift_x, c.shift_y});
  std::ranges::sort(expected);
  std::ranges::sort(found);
  CAPTURE(tolerance, packing.box.periodic(), expected.size());
  CHECK(found == expected);
  for (const BondCount& count : bond_counts(packing))
    if (count.gap_tolerance == tolerance) CHECK(count.contacts == std::ssize(expected));
  CHECK(bond_counts(network).back().contacts == bond_counts(packing).back().contacts);
}

TEST_CASE("bonds_of_every_shape_meet_between_the_surfaces_of_their_bodies") {
  const PackingShape shape = GENERATE(from_range(networked_shapes()));
  PackingOptions options = jammed(shape, 60);
  options.as_dense_as_possible = false;
  options.overlap = 1e-6;
  const GrainPacking packing = pack(options);
  std::size_t fewer = 0;
  for (const double tolerance : {0.0, 0.05, 0.2}) {
    const auto contacts = contacts_of(packing, tolerance);
    CAPTURE(to_string(shape.kind), tolerance, contacts.size());
    CHECK(contacts.size() >= fewer);
    fewer = contacts.size();
    for (const PackingContact& contact : contacts) {
      const double sum =
          packing.radii[static_cast<std::size_t>(contact.i)] + packing.radii[static_cast<std::size_t>(contact.j)];
      CHECK(-contact.overlap <= std::max(tolerance, 1e-8) * sum);
      CHECK(norm(contact.normal) == Approx(1).epsilon(1e-12));
    }
  }
  CHECK(fewer > 20);
}
