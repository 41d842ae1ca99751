// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds that resist bending: motion in time comes to the rest of the stiffness matrix, vibrates with its frequencies,
/// and follows turns of any size.
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/dynamics/relaxation.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/waves/natural_frequencies.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr SpringConstants bonded_springs{3e6, 1.2e6};

TimedSupport clamp(const std::string& group) {
  return {.group = group, .ux = Schedule{.value = 0}, .uy = Schedule{.value = 0}, .rotation = Schedule{.value = 0}};
}

Assembly bar_of(int discs, double radius) {
  Assembly bar = square_lattice({.columns = discs, .rows = 1, .radius = radius});
  bar.groups["root"].discs = {0};
  bar.groups["tip"].discs = {discs - 1};
  return bar;
}

/// Largest difference of two motions, rotations times the radius, over the largest motion.
double off_by(const std::vector<DiscMotion>& a, const std::vector<DiscMotion>& b, double radius) {
  double difference = 0, size = 0;
  for (std::size_t d = 0; d < a.size(); ++d) {
    difference = std::max({difference, norm(a[d].u - b[d].u), radius * std::abs(a[d].theta - b[d].theta)});
    size = std::max({size, norm(b[d].u), radius * std::abs(b[d].theta)});
  }
  return difference / size;
}

}  // namespace

TEST_CASE("motion_of_bonds_that_bend_comes_to_the_rest_of_the_stiffness_matrix") {
  const Assembly block =
      delaunay_assembly({.discs = 120, .disorder = 0.2, .seed = 5, .radii = {.smallest = 0.004, .largest = 0.006}});
  const ContactSprings springs = bending_springs(block, ContactSprings(bonded_springs), {.bond_width = 1.1});
  const Load load{.group = "right", .kind = LoadKind::total, .force = {4, 2}, .moment = 0.003};
  Scene scene(block, springs, inertia_of(block, 2500, Body::disc));
  scene.supports = {clamp("left")};
  scene.loads = {{.load = load, .factor = {.value = 1}}};
  const Relaxation rest = relax(scene, {.tolerance = 1e-14});
  const std::vector<Support> held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  const Equilibrium wanted = solve_equilibrium(block, springs, held, {load});
  const double difference = off_by(rest.motions, wanted.motions, 0.005);
  CAPTURE(rest.report(), difference);
  CHECK(difference < 1e-12);
  const std::vector<BodyContact> contacts = bonded_contacts(scene, LoopKind::Motion::small, rest.motions, 0);
  double moment_error = 0, largest = 0;
  for (std::size_t c = 0; c < block.contacts.size(); ++c) {
    moment_error = std::max(moment_error, std::abs(contacts[c].bending_moment - wanted.bending_moments[c]));
    largest = std::max(largest, std::abs(wanted.bending_moments[c]));
  }
  CAPTURE(moment_error, largest);
  CHECK(moment_error < 1e-11 * largest);
}

TEST_CASE("a_moment_rolls_a_bar_of_bonded_discs_up_to_a_ring") {
  constexpr int discs = 13;
  constexpr double radius = 0.01, kM = 40;
  const Assembly bar = bar_of(discs, radius);
  const ContactSprings springs = bending_springs(bar, ContactSprings(bonded_springs), {.kM = kM});
  const double turn = 2 * std::numbers::pi / (discs - 1);
  Scene scene(bar, springs, inertia_of(bar, 2500, Body::disc));
  scene.supports = {clamp("root")};
  scene.loads = {
      {.load = {.group = "tip", .kind = LoadKind::total, .force = {}, .moment = kM * turn}, .factor = {.value = 1}}};
  const Relaxation rest = relax(scene, {.motion = LoopKind::Motion::finite, .tolerance = 1e-13});
  // A pure moment: no force in any contact, each turns by the same angle, and its branch by the mean of both discs.
  std::vector<DiscMotion> wanted(discs);
  Vec2 place = bar.centres[0];
  for (int k = 1; k < discs; ++k) {
    const double along = (k - 0.5) * turn;
    place += 2 * radius * Vec2{std::cos(along), std::sin(along)};
    wanted[static_cast<std::size_t>(k)] = {place - bar.centres[static_cast<std::size_t>(k)], k * turn};
  }
  const double difference = off_by(rest.motions, wanted, radius);
  CAPTURE(rest.report(), difference, rest.motions.back().theta);
  CHECK(difference < 1e-9);
}

TEST_CASE("bonds_that_bend_vibrate_with_their_natural_frequencies") {
  Assembly bar = bar_of(6, 0.01);
  const auto name = [](int disc) { return "disc" + std::to_string(disc); };
  for (int d = 0; d < 6; ++d) bar.groups[name(d)].discs = {d};
  const ContactSprings springs = bending_springs(bar, ContactSprings(bonded_springs), {.bond_width = 1.0});
  Scene scene(bar, springs, inertia_of(bar, 2500, Body::disc));
  scene.supports = {clamp("root")};
  const DegreesOfFreedom unknowns =
      number_unknowns(bar, springs, derive_effects(bar, springs, Rotation::from_scene),
                      std::vector<Support>{{.group = "root", .ux = 0.0, .uy = 0.0, .rotation = 0.0}});
  const NaturalFrequencies modes = natural_frequencies(bar, springs, unknowns, scene.inertia, {.count = 1});
  const double omega = std::sqrt(modes.squared[0]), period = 2 * std::numbers::pi / omega;
  for (int d = 0; d < 6; ++d) {
    const DiscMotion& mode = modes.motions[0][static_cast<std::size_t>(d)];
    scene.velocities.push_back({.group = name(d), .velocity = 1e-6 * mode.u, .spin = 1e-6 * mode.theta});
  }
  for (const LoopKind::Motion motion : {LoopKind::Motion::small, LoopKind::Motion::finite}) {
    constexpr int steps = 4000;
    Simulation simulation(scene, {.motion = motion, .time_step = period / steps});
    const std::vector<DiscMotion> before = simulation.velocities();
    simulation.advance(steps / 2);
    std::vector<DiscMotion> after = simulation.velocities();
    for (DiscMotion& v : after) v = {-1 * v.u, -v.theta};
    const EnergyLedger energy = simulation.energy();
    CAPTURE(motion == LoopKind::Motion::finite, period, off_by(after, before, 0.01), energy.error(), energy.initial);
    CHECK(off_by(after, before, 0.01) < 1e-6);
    CHECK(std::abs(energy.error()) < 1e-10 * energy.initial);
  }
}

TEST_CASE("dashpots_beside_bending_springs_take_what_the_ledger_says") {
  const Assembly bar = bar_of(8, 0.01);
  const ContactSprings springs = bending_springs(bar, ContactSprings(bonded_springs), {.bond_width = 1.0});
  Scene scene(bar, springs, inertia_of(bar, 2500, Body::disc));
  scene.supports = {clamp("root")};
  const Load load{.group = "tip", .kind = LoadKind::total, .force = {0, 0.4}};
  scene.loads = {{.load = load, .factor = {.value = 1}}};
  for (const Damping& damping : {Damping{.contact = 0.5}, Damping{.stiffness = 2e-4}, Damping{.local = 0.7}}) {
    SimulationOptions options{.damping = damping, .time_step = 1};
    options.time_step = choose_time_step(scene, options, {}).step;
    Simulation simulation(scene, options);
    simulation.advance(400);
    const EnergyLedger early = simulation.energy();
    simulation.advance(400000);
    const std::vector<Support> held{{.group = "root", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
    const Equilibrium wanted = solve_equilibrium(bar, springs, held, {load});
    const EnergyLedger energy = simulation.energy();
    CAPTURE(damping.contact, damping.stiffness, damping.local, options.time_step, early.error(), early.largest(),
            energy.error(), energy.largest(), off_by(simulation.motions(), wanted.motions, 0.01));
    CHECK(off_by(simulation.motions(), wanted.motions, 0.01) < 1e-6);
    CHECK(std::abs(early.error()) < 1e-3 * early.largest());
    CHECK(std::abs(energy.error()) < 1e-3 * energy.largest());
    CHECK(std::abs(energy.lost() - wanted.energy) < 1e-2 * wanted.energy);
  }
}
