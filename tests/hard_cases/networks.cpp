// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Networks that are singular, or nearly, for the way in which their discs are joined.
#include <cmath>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"

#include "hard_cases/ledger.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Problem pulled_block(Assembly block) {
  return {std::move(block),
          usual_springs,
          {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}},
          {{.group = "right", .kind = LoadKind::per_disc, .force = {1000, 300}, .moment = 0.1}}};
}

/// A diagonal contact across one square.
void close_odd_ring(Assembly& assembly, int columns) {
  const double length = norm(assembly.centres[columns + 1] - assembly.centres[0]);
  assembly.contacts.push_back({0, columns + 1, 0, 0, 0.5 * length, 0.5 * length});
  assembly.facet_lengths.clear();
}

}  // namespace

TEST_CASE("one_odd_ring_decides_whether_the_discs_of_a_square_lattice_turn_like_gears") {
  HardCase table(
      {.name = "a bipartite network, and the same with one odd ring",
       .why = "without odd rings all discs counter-rotate at no cost; a single one holds hundreds of discs"});
  const int n = 24;
  Assembly block = square_lattice({.columns = n, .rows = n});
  const Answer geared = solve(pulled_block(block));
  table.refused("solve without", geared, {"counter-rotate like gears", "bipartite", "odd ring"});
  Problem held = pulled_block(block);
  held.supports.push_back({.group = "bottom_left", .ux = {}, .uy = {}, .rotation = 0.0});
  table.right("solve without, one rotation held", solve(held), 1e-12);
  close_odd_ring(block, n);
  table.right("solve with", solve(pulled_block(block)), 1e-12);

  Assembly cell = square_lattice({.columns = 6, .rows = 6, .periodic = true});
  table.right("homogenize without",
              homogenize(cell, usual_springs, Rotation::from_scene, {{{1e9, 0, 0}, {0, 1e9, 0}, {0, 0, 0.2e9}}}),
              1e-13);
  close_odd_ring(cell, 6);
  table.right("homogenize with", homogenize(cell, usual_springs), 1e-12);
}

TEST_CASE("a_single_chain_is_right_where_it_is_held_and_has_no_modulus") {
  HardCase table(
      {.name = "a single chain", .why = "a tree of contacts: discs roll on one another, and nothing is redundant"});
  const Assembly chain = chain_of_discs(50, 0.01);
  const LoadCase pull{{.group = "last", .kind = LoadKind::total, .force = {1000, 100}}};
  const auto hold = [](std::optional<double> rotation) {
    return std::vector<Support>{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = rotation}};
  };
  table.refused("solve, rotations free", solve({chain, usual_springs, hold({}), pull}), {"rotation about", "Hold"});
  table.refused("solve, one rotation held", solve({chain, usual_springs, hold(0.0), pull}), {"rotation about", "Hold"});
  table.right("solve, rotations restrained", solve({chain, usual_springs, hold({}), pull, Rotation::restrained}),
              1e-12);
  Assembly periodic = square_lattice({.columns = 8, .rows = 1, .periodic = true});
  std::erase_if(periodic.contacts, [](const Contact& c) { return c.shift_y != 0; });
  periodic.facet_lengths.clear();
  table.refused("homogenize", homogenize(periodic, usual_springs), {"one direction only", "Add contacts"});
}

TEST_CASE("a_rattler_inside_a_ring_is_named_or_left_out") {
  HardCase table({.name = "a rattler inside a ring", .why = "a disc that touches nothing leaves rows of zeros in K"});
  Assembly cell = hexagonal_lattice({.columns = 6, .rows = 6, .periodic = true});
  const std::int32_t loose = 14;
  const auto remove = [&](Assembly& assembly) {
    std::erase_if(assembly.contacts, [&](const Contact& c) { return c.i == loose || c.j == loose; });
    assembly.facet_lengths.clear();
  };
  remove(cell);
  table.right("homogenize", homogenize(cell, usual_springs), 1e-12);
  const EffectiveStiffness result = effective_stiffness(cell, usual_springs);
  CHECK(result.rattlers == 1);
  REQUIRE(result.removed.size() == 1);
  CHECK(result.removed[0].find("disc 14") != std::string::npos);
  Assembly block = hexagonal_lattice({.columns = 6, .rows = 6});
  remove(block);
  table.refused("solve", solve(pulled_block(block)), {"disc 14", "no contacts", "Hold it, remove it"});
}

TEST_CASE("contacts_at_the_centre_of_a_disc_are_right") {
  HardCase table({.name = "lever arms of zero",
                  .why = "a contact at the centre of a disc does not turn it: some rotations have no stiffness, others "
                         "have only one side's"});
  for (const std::int32_t every : {1, 2, 3}) {  // discs whose contacts all lie at their centre
    CAPTURE(every);
    // Between two such discs the levers are both zero, or the contact lies in the middle.
    const auto without_levers = [&](Assembly assembly, bool both) {
      for (Contact& c : assembly.contacts) {
        const double length = norm(assembly.branch(c));
        const bool at_i = c.i % every == 0, at_j = c.j % every == 0;
        if (at_i && at_j) c.lever_i = c.lever_j = both ? 0 : 0.5 * length;
        if (at_i != at_j) c.lever_i = at_i ? 0 : length, c.lever_j = at_i ? length : 0;
      }
      return assembly;
    };
    Problem problem = pulled_block(without_levers(hexagonal_lattice({.columns = 5, .rows = 6}), true));
    problem.loads[0].moment = 0;
    table.right("solve", solve(problem), 1e-12);
    const Assembly cell = delaunay_assembly({.discs = 40, .periodic = true});
    table.right("homogenize", homogenize(without_levers(cell, false), usual_springs), 1e-12);
    table.refused("homogenize, levers that do not add up", homogenize(without_levers(cell, true), usual_springs),
                  {"has the lever arms 0 and 0 m", "Correct the levers"});
  }
}

TEST_CASE("a_train_of_gears_of_a_million_to_one_is_right") {
  HardCase table(
      {.name = "a gear train of ratio 1e6",
       .why = "one motion turns the last disc a million times as far as the first, whose rotation holds it"});
  Assembly train;
  double x = 0;
  for (int d = 0; d < 13; ++d) {
    const double radius = std::pow(10.0, -0.5 * d);
    if (d > 0) x += train.radii.back() + radius;
    train.centres.push_back({x, 0});
    train.radii.push_back(radius);
    if (d > 0) train.contacts.push_back({d - 1, d, 0, 0, train.radii[d - 1], radius});
    train.groups["all"].discs.push_back(d);
  }
  train.groups["first"].discs = {0};
  train.groups["last"].discs = {12};
  const LoadCase twist{{.group = "last", .kind = LoadKind::total, .force = {}, .moment = 1e-3}};
  const Support pinned{.group = "all", .ux = 0.0, .uy = 0.0, .rotation = {}};
  const Support locked{.group = "first", .ux = {}, .uy = {}, .rotation = 0.0};
  table.right("solve", solve({train, usual_springs, {pinned, locked}, twist}), 1e-11);
  table.refused("solve, none locked", solve({train, usual_springs, {pinned}, twist}),
                {"gears", "Hold the rotation of one"});
}
