// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Statics of bodies that touch off the lines of their centres.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/statics/critical_ratio.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/rigidity.hpp"

#include "statics/rigidity_report.hpp"
#include "support/catch.hpp"
#include "support/off_line_networks.hpp"
#include "support/sturm.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Assembly random_bodies(std::uint64_t seed, bool periodic, std::int64_t bodies = 20, int again = 5) {
  return off_line(delaunay_assembly({.discs = bodies, .seed = seed, .radii = {0.8, 1.2}, .periodic = periodic}), seed,
                  again);
}

/// kT of either sign, and none at every third contact.
ContactSprings random_springs(const Assembly& assembly, std::uint64_t seed, double least = -0.2) {
  Random random(seed);
  std::vector<SpringConstants> each(assembly.contacts.size());
  for (SpringConstants& k : each) {
    k = {random.uniform(0.5, 2), random.uniform(least, 1)};
    if (random.below(3) == 0) k.kT = 0;
  }
  return ContactSprings(std::move(each));
}

std::vector<DiscMotion> random_motions(const Assembly& assembly, Random& random) {
  std::vector<DiscMotion> motions(assembly.size());
  for (DiscMotion& m : motions) {
    m.u = {random.uniform(-1, 1), random.uniform(-1, 1)};
    m.theta = random.uniform(-1, 1);
  }
  return motions;
}

/// The bodies turn about a point with all that they carry.
std::vector<DiscMotion> rotation_about(const Assembly& assembly, Vec2 x) {
  std::vector<DiscMotion> motions(assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) motions[d] = {perpendicular(assembly.centres[d] - x), 1};
  return motions;
}

}  // namespace

TEST_CASE("stiffness_off_the_line_of_centres_is_the_second_derivative_of_the_energy_of_points") {
  const bool periodic = GENERATE(false, true);
  const std::uint64_t seed = GENERATE(1, 2, 3);
  const Assembly assembly = random_bodies(seed, periodic);
  check(assembly);
  REQUIRE(assembly.contacts.size() > 2 * assembly.size());
  const ContactSprings springs = random_springs(assembly, seed);
  const Effects effects = derive_effects(assembly, springs, Rotation::from_scene);
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, {});
  const ContactGraph graph(assembly);
  const DenseMatrix k = dense_matrix(assemble_stiffness(assembly, graph, springs, unknowns), assembly);
  const DenseMatrix expected = stiffness_of_energy(assembly, springs, unknowns.rotation_scale);
  CAPTURE(periodic, seed);
  CHECK(relative_difference(k.entries, expected.entries) < 1e-13);

  // Forces on bodies are the first derivative of the energy, and the energy is that of the contact law.
  Random random(seed);
  const std::vector<DiscMotion> motions = random_motions(assembly, random);
  PreciseMotion motion(3 * assembly.size());
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    motion.high[3 * d] = motions[d].u.x;
    motion.high[3 * d + 1] = motions[d].u.y;
    motion.high[3 * d + 2] = unknowns.rotation_scale * motions[d].theta;
  }
  std::vector<ContactForce> forces(assembly.contacts.size());
  contact_forces_of(assembly, springs, unknowns, motion, forces);
  std::vector<double> force(motion.high.size()), residual(force.size()), product(force.size(), 0.0);
  internal_force(assembly, graph, unknowns, forces, force);
  residual_force({assembly, graph, springs, unknowns}, motion, {}, {}, residual);
  for (std::size_t p = 0; p < force.size(); ++p)
    for (std::size_t q = 0; q < force.size(); ++q) product[p] += expected(p, q) * motion.high[q];
  CHECK(relative_difference(force, product) < 1e-13);
  for (double& f : residual) f = -f;
  CHECK(relative_difference(residual, product) < 1e-13);
  const std::vector<double> moments = contact_moments(assembly, forces);
  for (std::size_t d = 0; d < assembly.size(); ++d)
    CHECK(moments[d] == Approx(-product[3 * d + 2] * unknowns.rotation_scale).margin(1e-12));
  CHECK(elastic_energy(assembly, springs, motions) ==
        Approx(energy_of_points(assembly, springs, motions)).epsilon(1e-13));
}

TEST_CASE("moving_and_turning_all_bodies_together_costs_nothing_off_the_line_of_centres") {
  const Assembly assembly = random_bodies(4, false);
  const ContactSprings springs(SpringConstants{1, 0.5});
  std::vector<DiscMotion> shifted(assembly.size());
  for (DiscMotion& m : shifted) m.u = {0.3, -0.7};
  CHECK(softness(assembly, springs, shifted) < 1e-30);
  CHECK(softness(assembly, springs, rotation_about(assembly, {3, -1})) < 1e-30);
  const ContactGraph graph(assembly);
  const Effects effects = derive_effects(assembly, springs, Rotation::from_scene);
  const RigidityReport report =
      examine_rigidity(assembly, graph, springs, number_unknowns(assembly, springs, effects, {}));
  CHECK(report.free_rigid_motions == 3);
  CHECK(report.gear_modes == 0);
}

// Motions without energy: rigid ones, gears, rotations that nothing resists and all others are distinguished, and none
// is missed.
TEST_CASE("mechanisms_off_the_line_of_centres_are_as_many_as_the_energy_leaves") {
  int with_gears = 0, with_others = 0;
  for (std::uint64_t seed = 1; seed <= 160; ++seed) {
    Random random(seed);
    Assembly assembly = random_bodies(seed, seed % 2 == 0, 12);
    // Many contacts go, and many of the rest lie on the line of centres.
    Assembly sparse = assembly;
    sparse.contacts.clear(), sparse.contact_arms.clear();
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      if (random.below(100) < 45) continue;
      if (random.below(2) == 0) {
        const Vec2 l = assembly.branch(assembly.contacts[c]);
        place_contact(sparse, assembly.contacts[c], l / norm(l), random.uniform(0.3, 0.7) * l);
        sparse.contact_arms.back().offset_i = sparse.contact_arms.back().offset_j = 0;
      } else {
        sparse.contacts.push_back(assembly.contacts[c]);
        sparse.contact_arms.push_back(assembly.contact_arms[c]);
      }
    }
    if (sparse.contacts.empty()) continue;
    const double ratio = seed % 3 == 0 ? 0 : 0.5;
    const ContactSprings springs(SpringConstants{1, ratio});
    const Effects effects = derive_effects(sparse, springs, Rotation::from_scene);
    if (!effects.rotation) continue;
    const DegreesOfFreedom unknowns = number_unknowns(sparse, springs, effects, {});
    const MechanismReport found = find_mechanisms(sparse, springs, Rotation::from_scene, {});
    const auto nullity =
        static_cast<std::int64_t>(signs_of(stiffness_of_energy(sparse, springs, unknowns.rotation_scale), 1e-11).zero);
    CAPTURE(seed, ratio, found.rigid_motions, found.free_pieces, found.gears, found.others,
            unknowns.rotations_without_stiffness);
    CHECK(found.rigid_motions + found.free_pieces + found.gears + found.others + unknowns.rotations_without_stiffness ==
          nullity);
    with_gears += found.gears > 0 ? 1 : 0;
    with_others += found.others > 0 ? 1 : 0;
  }
  CAPTURE(with_gears, with_others);
  CHECK(with_gears > 0);
  CHECK(with_others > 5);
}

TEST_CASE("equilibrium_off_the_line_of_centres_is_that_of_the_dense_matrix_and_carries_its_load") {
  const std::uint64_t seed = GENERATE(5, 6);
  const double kT = GENERATE(0.5, 0.0);
  // Normal springs alone hold bodies that all touch twice.
  Assembly assembly = random_bodies(seed, false, 30, kT == 0 ? 1 : 5);
  assembly.groups["one"] = {{0}, {}};
  assembly.groups["other"] = {{7}, {}};
  const ContactSprings springs(SpringConstants{1e8, kT * 1e8});
  const std::vector<Support> supports{{.group = "one", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  const LoadCase loads{{.group = "other", .force = {1e3, -2e3}, .moment = 300}};
  EquilibriumOptions options;
  options.error_bound = true;
  const Equilibrium found = solve_equilibrium(assembly, springs, supports, loads, options);
  CHECK(found.relative_residual < 1e-14);
  const double scale = assembly.mean_radius();
  DenseMatrix k = stiffness_of_energy(assembly, springs, scale);
  std::vector<double> force(k.size, 0.0);
  force[21] = 1e3, force[22] = -2e3, force[23] = 300 / scale;
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t q = 0; q < k.size; ++q) k(p, q) = k(q, p) = 0;
    k(p, p) = 1e8;
  }
  const std::vector<double> expected = solve(k, force);
  std::vector<double> motion;
  for (const DiscMotion& m : found.motions) motion.insert(motion.end(), {m.u.x, m.u.y, scale * m.theta});
  // The dense solution has no refinement: it is off by the round-off of the matrix.
  const double round_off = found.condition * std::numeric_limits<double>::epsilon();
  CAPTURE(seed, kT, found.condition, round_off);
  CHECK(relative_difference(motion, expected) < std::max(1e-12, round_off));
  // The support takes the load, force and moment.
  REQUIRE(found.reactions.size() == 1);
  const Vec2 arm = assembly.centres[7] - assembly.centres[0];
  CHECK(found.reactions[0].force.x == Approx(-1e3).epsilon(1e-10));
  CHECK(found.reactions[0].force.y == Approx(2e3).epsilon(1e-10));
  CHECK(found.reactions[0].moment == Approx(-300 - cross(arm, {1e3, -2e3})).epsilon(1e-9));
}

TEST_CASE("arms_on_the_line_of_centres_give_what_discs_give") {
  Assembly discs = delaunay_assembly({.discs = 40, .seed = 7, .radii = {0.8, 1.2}});
  discs.groups["one"] = {{0}, {}};
  discs.groups["other"] = {{7}, {}};
  Assembly bodies = discs;
  for (const Contact& contact : discs.contacts) {
    const Vec2 l = discs.branch(contact);
    bodies.contact_arms.push_back({l / norm(l), 0, 0});
  }
  CHECK(on_lines_of_centres(bodies));
  const double kT = GENERATE(0.5, 0.0, -0.05);
  const ContactSprings springs(SpringConstants{1e8, kT * 1e8});
  const std::vector<Support> supports{{.group = "one", .ux = 0.0, .uy = 0.0, .rotation = 0.0},
                                      {.group = "other", .ux = {}, .uy = 0.0, .rotation = {}}};
  const LoadCase loads{{.group = "other", .force = {1e3, 0}}};
  const Equilibrium a = solve_equilibrium(discs, springs, supports, loads),
                    b = solve_equilibrium(bodies, springs, supports, loads);
  CAPTURE(kT);
  for (std::size_t d = 0; d < discs.size(); ++d) {
    CHECK(a.motions[d].u == b.motions[d].u);
    CHECK(a.motions[d].theta == b.motions[d].theta);
  }
  CHECK(a.energy == b.energy);
  CHECK(a.unstable_modes == b.unstable_modes);
  CHECK(find_critical_ratio(discs, springs, supports).ratio == find_critical_ratio(bodies, springs, supports).ratio);
}

TEST_CASE("what_contacts_off_the_line_of_centres_cannot_be_is_refused") {
  const Assembly assembly = random_bodies(8, true);
  CHECK_THROWS_WITH(find_critical_ratio(assembly, ContactSprings(SpringConstants{1, 0.1}), {}),
                    Catch::Contains("off the lines of centres"));
  Assembly wrong = assembly;
  wrong.contact_arms[3].normal *= 1.1;
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("its length must be 1"));
  wrong = assembly;
  wrong.contact_arms[3].offset_i += 1e-6;
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("contact 3") && Catch::Contains("m apart at their ends"));
  wrong = assembly;
  wrong.contact_arms.pop_back();
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("arms are given"));
  wrong = assembly;
  wrong.sections[2].polar_moment = 0;
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("body 2"));
  wrong = assembly;
  const double area = wrong.sections[2].area, disc = area * area / (2 * std::numbers::pi);
  wrong.sections[2].polar_moment = disc;
  CHECK_NOTHROW(check(wrong));
  wrong.sections[2].polar_moment = 0.99 * disc;
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("body 2") && Catch::Contains("smaller one than the disc"));
  wrong = assembly;
  wrong.radii[2] *= 1.01;
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("body 2") && Catch::Contains("disc of equal area"));
  wrong = assembly;
  wrong.contact_arms[3].offset_i = 1e80, wrong.contact_arms[3].offset_j = -1e80;
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("contact 3") && Catch::Contains("offset"));
  wrong = assembly;
  wrong.contacts[3].lever_i = 1e80, wrong.contacts[3].lever_j = -1e80;
  CHECK_THROWS_WITH(check(wrong), Catch::Contains("contact 3") && Catch::Contains("lever arm"));
}
