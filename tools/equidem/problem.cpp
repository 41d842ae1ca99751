// SPDX-License-Identifier: GPL-3.0-or-later
#include "problem.hpp"

#include <numeric>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

namespace {

/// Sum of the moments, N, that act on discs other than through contacts.
double outer_moment(const Problem& problem, const LoadCase& loads, const Equilibrium& equilibrium) {
  const std::vector<double>& restraining = equilibrium.rotation_moments;
  double sum = std::accumulate(restraining.begin(), restraining.end(), 0.0);
  for (const Reaction& reaction : equilibrium.reactions) sum += reaction.moment;
  for (const Load& load : loads) {
    const double times =
        load.kind == LoadKind::total ? 1.0 : static_cast<double>(group(problem.assembly, load.group).discs.size());
    sum += times * load.moment;
  }
  return sum;
}

}  // namespace

Problem build_problem(Case resolved, std::optional<Assembly> given) {
  const bool acts = resolved.test || !resolved.supports.empty() || !resolved.load_cases.front().loads.empty();
  if (!acts) {
    throw Error(ErrorKind::bad_input, "nothing pulls or holds the assembly", "it would stay as it is",
                "Add [test], or [[support]] and [[load]]", resolved.document.where());
  }
  StageTimes times;
  Stopwatch watch;
  Assembly assembly = given ? std::move(*given) : build_assembly(resolved);
  times.add("assembly", watch.lap());
  BuiltSprings springs = build_springs(resolved, assembly);
  times.add("springs", watch.lap());

  std::optional<TensionSetup> tension;
  std::vector<Support> supports = resolved.supports;
  std::vector<NamedLoads> load_cases = resolved.load_cases;
  if (resolved.test) {
    try {
      tension = tension_setup(assembly, *resolved.test);
    } catch (const Error& error) {
      throw error.at(resolved.where("test"));
    }
    supports = tension->supports;
    load_cases = {{"", tension->loads}};
  }
  return {std::move(resolved), std::move(assembly),   std::move(springs), std::move(tension),
          std::move(supports), std::move(load_cases), std::move(times)};
}

SolvedCase solve_case(const Problem& problem, const EquilibriumSolver& solver, const NamedLoads& loads) {
  SolvedCase result{.name = loads.name,
                    .equilibrium = solver.solve(loads.loads),
                    .stresses = {},
                    .stress = {},
                    .moment_per_area = 0,
                    .tension = {}};
  const Equilibrium& equilibrium = result.equilibrium;
  if (!problem.assembly.cell_areas.empty()) {
    result.stresses = disc_stresses(problem.assembly, equilibrium.contact_forces);
    result.stress = macroscopic_stress(problem.assembly, equilibrium.contact_forces);
    result.moment_per_area = outer_moment(problem, loads.loads, equilibrium) / problem.assembly.area();
  }
  if (problem.tension)
    result.tension = evaluate_tension(problem.assembly, problem.springs.springs, *problem.resolved.test,
                                      *problem.tension, equilibrium);
  return result;
}

std::optional<TensionTheory> tension_theory(const Problem& problem) {
  if (!problem.tension || !problem.springs.constants || !problem.springs.springs.uniform()) return {};
  const double ratio = problem.springs.constants->ratio();
  switch (problem.resolved.assembly.kind) {
    case AssemblyKind::hexagonal:
      return TensionTheory{poisson_ratio_of_ratio(ratio), hexagonal_stiffness_ratio(ratio)};
    case AssemblyKind::square:
      return TensionTheory{0, 1};
    default:
      return {};
  }
}

}  // namespace equidem
