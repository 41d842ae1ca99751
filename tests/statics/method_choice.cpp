// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The method that "auto" takes.
#include "equidem/statics/choice/method_choice.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

const std::vector<Support> held_left{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
const LoadCase pull_of_right{{.group = "right", .kind = LoadKind::per_disc, .force = {1e3, 0}}};

MethodChoice choice(const Assembly& assembly, const ContactSprings& springs, const SolverOptions& options = {}) {
  const ContactGraph graph(assembly);
  const DegreesOfFreedom unknowns =
      number_unknowns(assembly, springs, derive_effects(assembly, springs, Rotation::from_scene), held_left);
  return choose_method({assembly, graph, springs, unknowns}, options);
}

Equilibrium pulled(const Assembly& assembly, SolverMethod method) {
  EquilibriumOptions options;
  options.solver.method = method;
  return solve_equilibrium(assembly, ContactSprings({1e9, 0.5e9}), held_left, pull_of_right, options);
}

}  // namespace

TEST_CASE("large_samples_are_iterated_small_ones_and_slender_ones_eliminated") {
  const ContactSprings springs({1e9, 0.5e9});
  const auto method = [&](int columns, int rows) {
    return choice(hexagonal_lattice({.columns = columns, .rows = rows}), springs).method;
  };
  CHECK(method(120, 120) == SolverMethod::multifrontal);
  CHECK(method(150, 150) == SolverMethod::multigrid);
  CHECK(method(250, 250) == SolverMethod::multigrid);
  CHECK(method(30000, 3) == SolverMethod::multifrontal);
}

TEST_CASE("negative_and_scattered_springs_and_many_load_cases_favour_elimination") {
  const Assembly assembly = hexagonal_lattice({.columns = 250, .rows = 250});
  CHECK(choice(assembly, ContactSprings({1e9, -0.1e9})).method == SolverMethod::multifrontal);
  Random random(4);
  std::vector<SpringConstants> each(assembly.contacts.size());
  for (SpringConstants& k : each) {
    k.kN = std::pow(10.0, random.uniform(5, 11));
    k.kT = 0.5 * k.kN;
  }
  const MethodChoice scattered = choice(assembly, ContactSprings(each));
  CAPTURE(scattered.reason);
  CHECK(scattered.method == SolverMethod::multifrontal);
  CHECK(scattered.reason.find("multigrid is estimated to take") == 0);
  CHECK(choice(assembly, ContactSprings({1e9, 0.5e9}), {.right_hand_sides = 30}).method == SolverMethod::multifrontal);
}

TEST_CASE("where_memory_does_not_hold_a_factor_iterations_are_chosen") {
  const Assembly assembly = hexagonal_lattice({.columns = 250, .rows = 250});
  const MethodChoice pressed =
      choice(assembly, ContactSprings({1e9, 0.5e9}), {.memory_limit = 1e8, .right_hand_sides = 30});
  CAPTURE(pressed.reason);
  CHECK(pressed.method == SolverMethod::multigrid);
  CHECK(pressed.reason.find("elimination would take about") == 0);
}

TEST_CASE("auto_tells_its_choice_and_gives_the_answer_of_elimination") {
  const Assembly assembly = hexagonal_lattice({.columns = 250, .rows = 210});
  const Equilibrium chosen = pulled(assembly, SolverMethod::automatic);
  const Equilibrium eliminated = pulled(assembly, SolverMethod::multifrontal);
  CAPTURE(chosen.solver, eliminated.solver);
  CHECK(chosen.iterations > 0);
  CHECK(chosen.solver.find("elimination is estimated to take") != std::string::npos);
  CHECK(eliminated.iterations == 0);
  CHECK(chosen.energy == Approx(eliminated.energy).epsilon(1e-10));
}

TEST_CASE("auto_eliminates_where_iterations_do_not_converge_and_says_so") {
  const Assembly gears = square_lattice({.columns = 240, .rows = 220});
  const Equilibrium rest = pulled(gears, SolverMethod::automatic);
  CAPTURE(rest.solver);
  CHECK(rest.iterations == 0);
  CHECK(rest.solver.find("multifrontal") == 0);
  CHECK(rest.solver.find("'multigrid' leaves a residual") != std::string::npos);
  CHECK(rest.relative_residual < 1e-12);
}
