// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The method that "auto" takes.
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/solver_choice.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

const std::vector<Support> held_left{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
const LoadCase pull_of_right{{.group = "right", .kind = LoadKind::per_disc, .force = {1e3, 0}}};

Equilibrium pulled(const Assembly& assembly, SolverMethod method) {
  EquilibriumOptions options;
  options.solver.method = method;
  return solve_equilibrium(assembly, ContactSprings({1e9, 0.5e9}), held_left, pull_of_right, options);
}

}  // namespace

TEST_CASE("large_samples_are_iterated_and_small_slender_negative_and_often_loaded_ones_eliminated") {
  const auto method = [](int columns, int rows, double kT = 0.5e9, int right_hand_sides = 1) {
    return choose_method(hexagonal_lattice({.columns = columns, .rows = rows}), ContactSprings({1e9, kT}),
                         {.right_hand_sides = right_hand_sides});
  };
  CHECK(method(120, 120) == SolverMethod::multifrontal);
  CHECK(method(150, 150) == SolverMethod::multigrid);
  CHECK(method(150, 150, 0.5e9, 3) == SolverMethod::multigrid);
  CHECK(method(250, 250) == SolverMethod::multigrid);
  CHECK(method(30000, 3) == SolverMethod::multifrontal);
  CHECK(method(250, 250, -0.1e9) == SolverMethod::multifrontal);
  CHECK(method(250, 250, 0.5e9, 30) == SolverMethod::multifrontal);
}

TEST_CASE("auto_gives_the_answer_of_elimination") {
  const Assembly assembly = hexagonal_lattice({.columns = 250, .rows = 210});
  const Equilibrium chosen = pulled(assembly, SolverMethod::automatic);
  const Equilibrium eliminated = pulled(assembly, SolverMethod::multifrontal);
  CAPTURE(chosen.solver, eliminated.solver);
  CHECK(chosen.iterations > 0);
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
