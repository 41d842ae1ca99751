// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Scenes that have no equilibrium, or none that could be trusted: each is refused with a sentence of its own.
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const SpringConstants stiff{1e9, 5e8};
const std::vector<Support> left_held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};

Assembly small_block() {
  Assembly assembly = hexagonal_lattice({.columns = 5, .rows = 4});
  assembly.groups["nobody"] = {};
  assembly.groups["all"] = {};
  for (std::size_t d = 0; d < assembly.size(); ++d)
    assembly.groups["all"].discs.push_back(static_cast<std::int32_t>(d));
  return assembly;
}

/// Solve; check that it is refused with one sentence of problem, why and remedy that holds the words.
void check_refused(const Assembly& assembly, SpringConstants k, const std::vector<Support>& supports,
                   const LoadCase& loads, const std::vector<std::string>& words, EquilibriumOptions options = {}) {
  const ContactSprings springs(k);
  const Refusal refusal =
      refusal_of([&] { static_cast<void>(solve_equilibrium(assembly, springs, supports, loads, options)); });
  INFO("the sentence: " << refusal.message);
  REQUIRE_FALSE(refusal.message.empty());
  for (const std::string& word : words) {
    INFO("looked for: " << word);
    CHECK(refusal.says(word));
  }
  CHECK(refusal.says("("));
  CHECK(refusal.message.back() == '.');
}

/// A block with one more disc that hangs on a single contact and rolls.
Assembly block_with_a_tail(int size, double angle) {
  Assembly tail = hexagonal_lattice({.columns = size, .rows = size});
  const std::int32_t from = tail.groups["bottom_right"].discs[0];
  const auto last = static_cast<std::int32_t>(tail.size());
  tail.centres.push_back(tail.centres[from] + Vec2{0.01, 0});
  tail.radii.push_back(0.005);
  tail.contacts.push_back({from, last, 0, 0, 0.005, 0.005});
  tail.cell_areas.clear();
  tail.facet_lengths.clear();
  tail.groups["last"].discs = {last};
  for (Vec2& x : tail.centres) x = std::cos(angle) * x + std::sin(angle) * perpendicular(x);
  return tail;
}

LoadCase load_on(const std::string& group, Vec2 force, double moment = 0, LoadKind kind = LoadKind::per_disc) {
  return {{.group = group, .kind = kind, .force = force, .moment = moment}};
}

}  // namespace

TEST_CASE("loads_that_make_no_sense_are_refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  check_refused(small_block(), stiff, left_held, load_on("nobody", {1, 0}),
                {"load", "'nobody'", "empty", "no disc to carry it"});
  check_refused(small_block(), stiff, left_held, load_on("rihgt", {1, 0}), {"no group 'rihgt'", "right"});
  check_refused(small_block(), stiff, left_held, load_on("right", {nan, 0}), {"'right'", "nan", "finite"});
  check_refused(small_block(), stiff, left_held, load_on("right", {0, infinity}), {"'right'", "inf", "finite"});
  check_refused(small_block(), stiff, left_held, load_on("right", {}, -infinity), {"'right'", "-inf", "finite"});
  check_refused(small_block(), stiff, left_held, load_on("all", {1, 0}, 0, LoadKind::traction),
                {"traction", "'all'", "no side"});
  check_refused(small_block(), {1e9, 0}, left_held, load_on("right", {}, 1), {"moment", "'right'", "no unknowns"});
  check_refused(small_block(), stiff, left_held, load_on("right", {}, 1), {"moment", "'right'", "no unknowns"},
                {.rotation = Rotation::restrained, .solver = {}});
}

TEST_CASE("assemblies_of_no_or_one_disc_are_refused") {
  check_refused({}, stiff, {}, {}, {"no discs"});
  Assembly one;
  one.centres = {{0.1, 0.2}};
  one.radii = {1};
  check_refused(one, stiff, {}, {}, {"single disc", "free to move", "(0.1, 0.2)"});
  one.groups["it"] = {.discs = {0}, .tributary_lengths = {}};
  check_refused(one, stiff, {{.group = "it", .ux = 0.0, .uy = 0.0, .rotation = {}}}, {},
                {"single disc", "touches nothing"});
}

TEST_CASE("contacts_that_cannot_be_are_refused") {
  Assembly absent = small_block(), self = small_block(), lever = small_block(), same = small_block();
  absent.contacts[3].j = 99;
  check_refused(absent, stiff, left_held, {}, {"contact 3", "disc 99", "numbered from 0 to"});
  self.contacts[2].j = self.contacts[2].i;
  check_refused(self, stiff, left_held, {}, {"contact 2", "to itself"});
  lever.contacts[1].lever_j = -0.1;
  check_refused(lever, stiff, left_held, {}, {"contact 1", "lever arm -0.1"});
  same.centres[same.contacts[0].j] = same.centres[same.contacts[0].i];
  check_refused(same, stiff, left_held, {}, {"contact 0", "no direction"});
}

TEST_CASE("what_can_move_freely_is_refused_and_named") {
  check_refused(small_block(), stiff, {}, {}, {"no support", "translation along x and along y, and rotation"});
  check_refused(small_block(), stiff, {{.group = "bottom", .ux = {}, .uy = 0.0, .rotation = {}}}, {},
                {"translation along x"});
  check_refused(small_block(), stiff, {{.group = "bottom_left", .ux = 0.0, .uy = 0.0, .rotation = {}}}, {},
                {"rotation about (0.005"});

  Assembly rattler = small_block();
  rattler.centres.push_back({1, 1});
  rattler.radii.push_back(0.005);
  rattler.cell_areas.clear();
  check_refused(rattler, stiff, left_held, {}, {"disc 18 at (1, 1)", "no contacts"});

  const Assembly square = square_lattice({.columns = 5, .rows = 5});
  check_refused(square, stiff, {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}}, {},
                {"like gears", "bipartite"});
}

TEST_CASE("mechanisms_are_refused_whatever_the_solver_and_the_sign_of_kT") {
  struct Mechanism {
    std::string name;
    Assembly assembly;
    SpringConstants springs;
    std::vector<Support> supports;
    Vec2 force;
  };
  const std::vector<Support> end_held{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  Assembly square = square_lattice({.columns = 6, .rows = 6});
  square.groups["last"] = square.groups["top"];
  Assembly chain = chain_of_discs(6, 0.01);
  std::vector<Mechanism> mechanisms{
      {"square lattice without tangential springs",
       square,
       {1e9, 0},
       {{.group = "bottom", .ux = 0.0, .uy = 0.0, .rotation = {}}},
       {1, 0}},
      {"chain that rolls", chain, stiff, end_held, {0, 1}},
      {"chain that rolls, kT < 0", chain, {1e9, -1e8}, end_held, {0, 1}},
  };
  for (const int size : {3, 6, 15, 30}) {
    for (const double angle : {0.0, 0.3, 1.1, 2.5}) {
      for (const double kT : {5e8, -1e7}) {
        mechanisms.push_back({"block of " + std::to_string(size) + " turned by " + std::to_string(angle) +
                                  ", kT = " + std::to_string(kT),
                              block_with_a_tail(size, angle),
                              {1e9, kT},
                              left_held,
                              {0.2, 1}});
      }
    }
  }
  for (const int size : {4, 10, 24}) {
    // The waves of the zone boundary lose all stiffness at kT/kN = -1/3; even numbers of rows and columns
    // carry them.
    Assembly periodic = hexagonal_lattice({.columns = size, .rows = size, .periodic = true});
    periodic.groups["first"].discs = {0};
    periodic.groups["last"].discs = {1, size + 2};
    mechanisms.push_back({"periodic hexagonal lattice at its critical ratio, " + std::to_string(size),
                          periodic,
                          {3, -1},
                          {{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = {}}},
                          {0.3, 1}});
  }
  for (const Mechanism& m : mechanisms) {
    for (const SolverMethod method : {SolverMethod::automatic, SolverMethod::cholmod, SolverMethod::umfpack}) {
      if (method == SolverMethod::cholmod && m.springs.kT < 0) continue;
      CAPTURE(m.name, to_string(method));
      EquilibriumOptions options;
      options.solver.method = method;
      check_refused(m.assembly, m.springs, m.supports, load_on("last", m.force), {}, options);
    }
  }
}

TEST_CASE("solver_methods_have_names_and_refuse_what_they_cannot_do") {
  for (const SolverMethod method : {SolverMethod::automatic, SolverMethod::multifrontal, SolverMethod::cholmod,
                                    SolverMethod::umfpack, SolverMethod::multigrid}) {
    CHECK(enum_from<SolverMethod>(to_string(method)) == method);
  }
  const Refusal unknown = refusal_of([] { static_cast<void>(enum_from<SolverMethod>("lapack")); });
  CAPTURE(unknown.message);
  CHECK(unknown.says("unknown solver method 'lapack'"));
  CHECK(unknown.says("\"auto\", \"multifrontal\", \"cholmod\", \"umfpack\" or \"multigrid\""));
  EquilibriumOptions options;
  options.solver.method = SolverMethod::cholmod;
  check_refused(small_block(), {1e9, -1e8}, left_held, {}, {"'cholmod'", "negative", "method = \"auto\""}, options);
  options.solver.method = SolverMethod::multigrid;
  options.solver.ordering = CholmodOrdering::metis;
  check_refused(small_block(), {1e9, 1e8}, left_held, {},
                {"ordering = \"metis\"", "an ordering of CHOLMOD", "method = \"cholmod\""}, options);
}
