// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Independent solvers find the same state of rest.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/statics/equilibrium.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/motions.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Equilibrium solved(const HeldScene& scene, SolverMethod method, CholmodOrdering ordering = CholmodOrdering::equidem) {
  EquilibriumOptions options = scene.options;
  options.solver.method = method;
  options.solver.ordering = ordering;
  return solve_equilibrium(scene.assembly(), scene.springs, scene.supports,
                           {{.group = "a", .kind = LoadKind::per_disc, .force = {1e5, -3e4}},
                            {.group = "b", .kind = LoadKind::per_disc, .force = {-5e4, 7e4}}},
                           options);
}

}  // namespace

TEST_CASE("all_solvers_find_the_same_state_of_rest") {
  for (const HeldScene& scene : held_scenes()) {
    const Equilibrium ours = solved(scene, SolverMethod::multifrontal), lu = solved(scene, SolverMethod::umfpack);
    const double to_lu = largest_difference(scene.assembly(), ours, lu);
    CAPTURE(scene.name, ours.solver, lu.solver, to_lu);
    CHECK(to_lu < 1e-10);
    if (scene.springs.any_negative()) continue;
    for (const auto& ordering : EnumNames<CholmodOrdering>::list) {
      const Equilibrium supernodal = solved(scene, SolverMethod::cholmod, ordering.value);
      const double to_cholmod = largest_difference(scene.assembly(), ours, supernodal);
      CAPTURE(ordering.name, supernodal.solver, to_cholmod);
      CHECK(to_cholmod < 1e-10);
      CHECK(supernodal.solver != ours.solver);
      CHECK(supernodal.energy == Approx(ours.energy).epsilon(1e-10));
    }
    const Equilibrium iterated = solved(scene, SolverMethod::multigrid);
    const double to_multigrid = largest_difference(scene.assembly(), ours, iterated);
    CAPTURE(to_multigrid);
    CHECK(to_multigrid < 1e-10);
  }
}
