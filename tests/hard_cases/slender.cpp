// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies many times longer than wide: the stiffness against bending falls as the cube of the length, the condition of
/// K grows as its fourth power.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "hard_cases/ledger.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double radius = 0.005;

const HardCase::Words long_strip{.name = "a strip 2 x 1e5",
                                 .why =
                                     "clamped at one end its condition grows as the fourth power of the length, to "
                                     "about 1e21; a double has 16 digits"};

Assembly strip(int columns, bool periodic = false) {
  return hexagonal_lattice({.columns = columns, .rows = 2, .radius = radius, .periodic = periodic});
}

/// Clamped at its left end.
Problem cantilever(int columns, double ratio, Vec2 force) {
  return {strip(columns),
          springs_of(ratio),
          {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}},
          {{.group = "bottom_right", .kind = LoadKind::total, .force = force}}};
}

/// Clamped at its left end, its bottom row on a rail.
Problem on_a_rail(int columns, double ratio) {
  Problem problem = cantilever(columns, ratio, {1000, 0});
  problem.supports[0].uy = {};
  problem.supports.push_back({.group = "bottom", .ux = {}, .uy = 0.0, .rotation = {}});
  return problem;
}

void strip_on_a_rail(HardCase& table, int columns) {
  for (const double ratio : {0.5, -0.05}) {
    CAPTURE(columns, ratio);
    table.right(fmt::format("solve 2 x {}, bottom on a rail", columns), solve(on_a_rail(columns, ratio)), 1e-9);
  }
}

void strip_cell(HardCase& table, int columns) {
  const double root = 0.86602540378443865;
  for (const double ratio : {0.5, 1e-8, -0.3}) {
    CAPTURE(columns, ratio);
    table.right(fmt::format("homogenize 2 x {}", columns),
                homogenize(strip(columns, true), springs_of(ratio), Rotation::from_scene,
                           isotropic_stiffness(root * 1e9, root / 2 * (1 + ratio) * 1e9)),
                1e-13);
  }
}

}  // namespace

TEST_CASE("a_long_strip_is_right_or_called_too_soft") {
  HardCase table(long_strip);
  for (const double ratio : {0.5, 0.0, -0.05}) {
    CAPTURE(ratio);
    table.right("solve 2 x 100, clamped at one end, pulled", solve(cantilever(100, ratio, {1000, 0})), 1e-9);
    table.right("solve 2 x 1000, clamped at one end, bent", solve(cantilever(1000, ratio, {0, 1000})), 1e-6);
  }
  table.right("solve 2 x 6000, clamped at one end, pulled", solve(cantilever(6000, 0.5, {1000, 0})), 1e-3);
  table.refused("solve 2 x 100000, clamped at one end", solve(cantilever(100000, 0.5, {0, 1000})),
                {"digits of a double", "slender", "more places"});
  strip_on_a_rail(table, 2000);
  strip_cell(table, 20000);
}

TEST_CASE("the_longest_strips_are_right_or_called_too_soft", "[.large]") {
  HardCase table(long_strip);
  for (const double ratio : {0.5, 0.0, -0.05}) {
    CAPTURE(ratio);
    table.right("solve 2 x 10000, clamped at one end, bent", solve(cantilever(10000, ratio, {0, 1000})), 1e-3);
    table.right("solve 2 x 10000, clamped at one end, pulled", solve(cantilever(10000, ratio, {1000, 0})), 1e-2);
  }
  for (const double ratio : {0.0, -0.05}) {
    CAPTURE(ratio);
    table.refused(fmt::format("solve 2 x 100000, clamped at one end, kT/kN = {}", ratio),
                  solve(cantilever(100000, ratio, {1000, 0})), {"digits of a double", "more places"});
  }
  strip_on_a_rail(table, 100000);
  strip_cell(table, 100000);
}

TEST_CASE("a_chain_of_2000_springs_of_all_sizes_stretches_by_the_sum_of_its_flexibilities") {
  HardCase table({.name = "a chain of 2000 springs that differ by up to 1e6",
                  .why = "stiff links between soft ones: their stretch is lost in the motion that they share"});
  const int n = 2000;
  Random random(1);
  std::vector<SpringConstants> k;
  double flexibility = 0;
  for (int c = 0; c + 1 < n; ++c) {
    const double stiffness = 1e9 * std::pow(10.0, static_cast<double>(random.below(7)) - 3);
    k.push_back({stiffness, 0.3 * stiffness});
    flexibility += 1 / stiffness;
  }
  const Problem chain{chain_of_discs(n, 0.01),
                      ContactSprings(k),
                      {{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = {}}},
                      {{.group = "last", .kind = LoadKind::total, .force = {1, 0.5}}},
                      Rotation::restrained};
  table.right("solve", solve(chain), 1e-12);
  const Equilibrium state = solve_equilibrium(chain.assembly, chain.springs, chain.supports, chain.loads,
                                              {.rotation = Rotation::restrained, .solver = {}});
  double off = 0;
  for (const ContactForce& f : state.contact_forces) {
    off = std::max({off, std::abs(f.normal - 1), std::abs(f.tangential - 0.5)});
  }
  CAPTURE(off, state.relative_residual, state.refinements);
  CHECK(off < 1e-13);
  CHECK(state.motions.back().u.x == Approx(flexibility).epsilon(1e-12));
  CHECK(state.motions.back().u.y == Approx(0.5 * flexibility / 0.3).epsilon(1e-12));
  table.note("solve", "every contact carries the load to 1e-13", fmt::format("{:.1e}", off));
}

TEST_CASE("every_section_of_a_strip_of_2_by_2000_carries_the_load_and_its_moment") {
  const double ratio = GENERATE(0.5, 0.0, -0.05);
  const Vec2 force = GENERATE(Vec2{1000, 0}, Vec2{0, 1000});
  const Problem problem = cantilever(2000, ratio, force);
  const Assembly& assembly = problem.assembly;
  const Equilibrium state = solve_equilibrium(assembly, problem.springs, problem.supports, problem.loads);
  const Vec2 at = assembly.centres[group(assembly, "bottom_right").discs[0]];
  // Cut between discs; contacts across the cut carry force and moment of the part to the right.
  double worst_force = 0, worst_moment = 0;
  for (int section = 1; section < 100; ++section) {
    const double cut = (40 * section + 0.5) * radius;
    Vec2 sum;
    double moment = 0;
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      const Contact& contact = assembly.contacts[c];
      const Vec2 i = assembly.centres[contact.i], j = assembly.centres[contact.j];
      if ((i.x < cut) == (j.x < cut)) continue;
      const ContactFrame frame = frame_of(assembly, c);
      const Vec2 f = (i.x < cut ? 1.0 : -1.0) * force_on_i(frame, state.contact_forces[c]);
      sum += f;
      moment += cross(i + contact.lever_i * frame.normal - at, f);
    }
    worst_force = std::max(worst_force, norm(sum - force));
    worst_moment = std::max(worst_moment, std::abs(moment));
  }
  const double length = at.x;
  CAPTURE(ratio, force.x, force.y, worst_force, worst_moment, state.relative_residual, state.refinements,
          state.unstable_modes.value_or(-1));
  CHECK(worst_force < 1e-8 * 1000);
  CHECK(worst_moment < 1e-8 * 1000 * length);
  const double half_work = 0.5 * dot(force, state.motions[group(assembly, "bottom_right").discs[0]].u);
  CHECK(state.energy == Approx(half_work).epsilon(1e-8));
  // What round-off of contact forces, here up to the length over the height times the load, leaves of the residual.
  double largest_force = 0;
  for (const ContactForce& f : state.contact_forces)
    largest_force = std::max({largest_force, std::abs(f.normal), std::abs(f.tangential)});
  CAPTURE(largest_force);
  CHECK(state.relative_residual <= std::max(1e-13, 1e-15 * largest_force / 1000 * std::sqrt(2.0 * 4000)));
}
