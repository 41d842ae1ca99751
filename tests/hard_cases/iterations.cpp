// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Assemblies on which multigrid might not converge, or only seem to: each is as elimination has it, or refused with
/// the method that serves.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const std::vector<Support> left_held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
const LoadCase pull{{.group = "right", .kind = LoadKind::per_disc, .force = {1000, 300}}};

Problem pulled(Assembly assembly, ContactSprings springs = usual_springs) {
  return {std::move(assembly), std::move(springs), left_held, pull};
}

/// A strip of two rows, its left end held, its bottom on a rail: clamped at one end alone it is too soft for a double.
Problem railed_strip(int columns) {
  Problem problem = pulled(hexagonal_lattice({.columns = columns, .rows = 2}));
  problem.supports.push_back({.group = "bottom", .ux = {}, .uy = 0.0, .rotation = {}});
  problem.loads[0].force.y = 0;
  return problem;
}

/// Springs of each contact by a function of the middle of its discs.
template <class Stiffness>
ContactSprings springs_by(const Assembly& assembly, const Stiffness& stiffness) {
  std::vector<SpringConstants> each;
  for (const Contact& c : assembly.contacts) {
    const double kN = stiffness(assembly.centres[c.i], assembly.centres[c.j]);
    each.push_back({kN, 0.5 * kN});
  }
  return ContactSprings(std::move(each));
}

/// Springs of 1e9 Pa, those across the middle `weak` times as stiff.
ContactSprings joined_by(const Assembly& assembly, double weak) {
  double right = 0;
  for (const Vec2 x : assembly.centres) right = std::max(right, x.x);
  const double middle = 0.5 * right;
  return springs_by(assembly, [=](Vec2 i, Vec2 j) { return (i.x < middle) != (j.x < middle) ? 1e9 * weak : 1e9; });
}

Assembly diluted(Assembly assembly, double share) {
  Random random(11);
  std::erase_if(assembly.contacts, [&](const Contact&) { return random.uniform() >= share; });
  assembly.facet_lengths.clear();
  return assembly;
}

double largest_motion(const Equilibrium& state) {
  double largest = 0;
  for (const DiscMotion& m : state.motions) largest = std::max({largest, norm(m.u), std::abs(m.theta)});
  return largest;
}

const Assembly block_of_discs = hexagonal_lattice({.columns = 60, .rows = 50});
constexpr std::int32_t inner_disc = 1465;
const std::vector<std::string> elimination_serves{"method = \"multifrontal\""};

const HardCase::Words slender{.name = "multigrid on slender strips and soft joints",
                              .why =
                                  "a coarse grid has few nodes across two rows, and one soft motion of large parts "
                                  "takes part in every iteration"};

void strip_by_multigrid(HardCase& table, int columns) {
  table.right(fmt::format("solve 2 x {}, bottom on a rail", columns), solve_by_multigrid(railed_strip(columns)), 1e-9);
}

}  // namespace

TEST_CASE("multigrid_solves_strips_and_soft_joints_as_elimination_does_or_names_it") {
  HardCase table(slender);
  strip_by_multigrid(table, 2000);
  const Problem clamped = pulled(hexagonal_lattice({.columns = 1000, .rows = 2}));
  table.refused("solve 2 x 1000, clamped at one end", solve_by_multigrid(clamped), elimination_serves);
  for (const double weak : {1e-2, 1e-6, 1e-10}) {
    CAPTURE(weak);
    table.right(fmt::format("solve, halves joined by contacts {:g} as stiff", weak),
                solve_by_multigrid(pulled(block_of_discs, joined_by(block_of_discs, weak))), 1e-6);
  }
}

TEST_CASE("multigrid_solves_the_longest_strip_as_elimination_does", "[.large]") {
  HardCase table(slender);
  strip_by_multigrid(table, 100000);
}

TEST_CASE("multigrid_converges_or_refuses_near_the_onset_of_rigidity_and_meets_mechanisms") {
  HardCase table({.name = "multigrid near the onset of rigidity",
                  .why = "iterations may seem to converge where a motion costs no energy and no load drives it"});
  for (const double ratio : {0.4, 0.0}) {
    for (const double kept : {0.9, 0.8, 0.7, 0.66, 0.6}) {
      CAPTURE(ratio, kept);
      const std::string task = fmt::format("homogenize {} of the contacts, kT/kN = {}", kept, ratio);
      const Assembly cell = diluted(hexagonal_lattice({.columns = 40, .rows = 40, .periodic = true}), kept);
      Matrix3 exact{};
      const Answer eliminated = attempt([&] {
        exact =
            effective_stiffness(cell, springs_of(ratio), {.solver = {.method = SolverMethod::multifrontal}}).stiffness;
      });
      const Answer answer = homogenize(cell, springs_of(ratio), Rotation::from_scene, exact, SolverMethod::multigrid);
      if (!answer.refusal.message.empty()) {
        table.refused(task, answer, elimination_serves);
        continue;
      }
      CHECK(eliminated.refusal.message.empty());
      CHECK(kept >= 0.8);
      table.right(task, answer, 1e-12);
    }
  }
  Assembly hinged = block_of_discs;
  hinged.facet_lengths.clear();
  const auto of_inner = [](const Contact& c) { return c.i == inner_disc || c.j == inner_disc; };
  std::erase_if(hinged.contacts, [&, met = 0](const Contact& c) mutable { return of_inner(c) && ++met > 1; });
  table.refused("solve, a disc inside on one contact", solve_by_multigrid(pulled(hinged)), elimination_serves);
  std::erase_if(hinged.contacts, of_inner);
  table.refused("solve, a rattler inside", solve_by_multigrid(pulled(hinged)), {"disc 1465", "no contacts"});
  Assembly cell = hexagonal_lattice({.columns = 40, .rows = 40, .periodic = true});
  std::erase_if(cell.contacts, of_inner);
  cell.facet_lengths.clear();
  const auto eliminated = effective_stiffness(cell, usual_springs, {.solver = {.method = SolverMethod::multifrontal}});
  table.right("homogenize, a rattler inside",
              homogenize(cell, usual_springs, Rotation::from_scene, eliminated.stiffness, SolverMethod::multigrid),
              1e-12);
}

TEST_CASE("multigrid_solves_springs_decades_apart_or_refuses_them") {
  HardCase table({.name = "multigrid on springs up to ten decades apart",
                  .why = "a coarse grid has one stiffness where its discs have many"});
  for (const int decades : {1, 3, 6, 10}) {
    CAPTURE(decades);
    Random random(8);
    const ContactSprings mixed =
        springs_by(block_of_discs, [&](Vec2, Vec2) { return std::pow(10.0, 9 + random.uniform(-decades, 0)); });
    const ContactSprings layers = springs_by(
        block_of_discs, [=](Vec2 i, Vec2) { return std::pow(10.0, 9 - decades * std::fmod(20 * i.x, 1.0)); });
    const auto record = [&](const std::string& arranged, const ContactSprings& springs, int most) {
      const std::string task = fmt::format("solve, {}, {}", arranged, counted(decades, "decade"));
      const Answer answer = solve_by_multigrid(pulled(block_of_discs, springs));
      if (decades <= most)
        table.right(task, answer, 1e-9);
      else
        table.refused(task, answer, elimination_serves);
    };
    record("at random", mixed, 6);
    record("in layers", layers, 3);
  }
}

TEST_CASE("multigrid_solves_a_single_load_no_load_and_nothing_to_move") {
  HardCase table({.name = "multigrid with a single load, or none",
                  .why = "the error of one loaded disc is rough on every grid; with no load, or no unknowns, there is "
                         "nothing to divide by"});
  Problem point = pulled(block_of_discs);
  point.assembly.groups["inner"].discs = {inner_disc};
  point.loads = {{.group = "inner", .kind = LoadKind::total, .force = {100, 0}, .moment = 0.1}};
  table.right("solve, force and moment on one disc", solve_by_multigrid(point), 1e-9);
  const auto state = [](const Problem& problem) {
    return solve_equilibrium(problem.assembly, problem.springs, problem.supports, problem.loads,
                             {.rotation = {}, .solver = {.method = SolverMethod::multigrid}});
  };
  Problem idle = pulled(block_of_discs);
  idle.loads.clear();
  const double moved = largest_motion(state(idle));
  CHECK(moved == 0);
  table.note("solve, no load", "no motion", fmt::format("largest motion {}", moved));
  for (std::size_t d = 0; d < block_of_discs.size(); ++d)
    idle.assembly.groups["all"].discs.push_back(static_cast<int>(d));
  idle.supports = {{.group = "all", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  idle.loads = pull;
  const Equilibrium held = state(idle);
  double reaction = 0;
  for (const Reaction& r : held.reactions) reaction += r.force.x;
  const double load = 1000.0 * static_cast<double>(group(block_of_discs, "right").discs.size());
  CHECK(largest_motion(held) == 0);
  CHECK(reaction == -load);
  table.note(
      "solve, all discs held", "no motion, reactions are the loads",
      fmt::format("largest motion {}, sum of reactions over the load {}", largest_motion(held), reaction / load));
}
