// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <optional>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/rigidity.hpp"

#include "part_problem.hpp"
#include "problem.hpp"

namespace equidem {
namespace {

/// The whole assembly on rank 0, until it is given out.
struct WholeProblem {
  std::optional<Problem> problem;
  Effects effects;
  LoadBearingNetwork bearing;

  [[nodiscard]] const Assembly& assembly() const { return bearing.part ? bearing.part->assembly : problem->assembly; }
  [[nodiscard]] const ContactSprings& springs() const {
    return bearing.part ? bearing.part->springs : problem->springs.springs;
  }
};

void check_whole(WholeProblem& whole) {
  const Problem& problem = *whole.problem;
  const Assembly& assembly = problem.assembly;
  const DegreesOfFreedom unknowns = number_unknowns(assembly, problem.springs.springs, whole.effects, problem.supports);
  check_rigidity(assembly, ContactGraph(assembly), problem.springs.springs, unknowns);
}

/// Leaves out what carries no load, and finds the motions to hold.
void prune_whole(WholeProblem& whole, PartProblem& p) {
  const Problem& problem = *whole.problem;
  if (!problem.assembly.periodic()) {
    bad_input("the assembly is not periodic", "equidem-mpi homogenizes periodic cells",
              "Use 'equidem homogenize' for free samples");
  }
  whole.bearing = load_bearing_network(problem.assembly, problem.springs.springs, whole.effects, {});
  const LoadBearingNetwork& bearing = whole.bearing;
  if (bearing.spanned != 2 || bearing.pieces == 0) {
    bad_input("the network does not span the cell in both directions",
              bearing.sentences.empty() ? "some mean strain costs it no energy" : joined(bearing.sentences, "; "),
              "It has no modulus. Add contacts, or pack the discs more densely");
  }
  DegreesOfFreedom unknowns = number_unknowns(whole.assembly(), whole.springs(), whole.effects, {});
  const HeldMotions held =
      hold_free_motions(whole.assembly(), ContactGraph(whole.assembly()), whole.springs(), unknowns);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  for (const std::size_t component : held.components)
    p.held.push_back(static_cast<std::int64_t>(3 * (component / b) + component % b));
  p.gears = std::ssize(held.gears);
  p.removed = bearing.removed();
  p.rattlers = bearing.rattlers;
  p.left_out = bearing.sentences;
}

}  // namespace

void scatter_problem(const petsc::Ranks& ranks, PartProblem& p, bool homogenize) {
  WholeProblem whole;
  p.scattered = true;
  ranks.together([&] {
    if (!ranks.first()) return;
    Case resolved = p.problem.resolved;
    whole.problem.emplace(homogenize ? problem_of(std::move(resolved)) : build_problem(std::move(resolved)));
    const Problem& problem = *whole.problem;
    refuse_prestress(problem, "equidem-mpi");
    whole.effects = derive_effects(problem.assembly, problem.springs.springs, problem.resolved.rotation);
    p.of_problem = problem_results(problem, whole.effects);
    p.problem.tension = problem.tension;
    if (homogenize) {
      prune_whole(whole, p);
    } else {
      check_whole(whole);
    }
    p.problem.springs.constants = problem.springs.constants;
    p.problem.springs.report = problem.springs.report;
  });
  p.held = ranks.joined(p.held);
  petsc::ScatteredPart scattered = petsc::scattered_part(ranks, ranks.first() ? &whole.assembly() : nullptr,
                                                         ranks.first() ? &whole.springs() : nullptr);
  p.part = std::move(scattered.part);
  p.problem.springs.springs = std::move(*scattered.springs);
  // The gauges that rank 0 has placed.
  if (!p.problem.resolved.test || homogenize) return;
  std::vector<std::int64_t> gauges;
  std::array<double, 2> heights{};
  if (ranks.first()) {
    const TensionSetup& setup = *p.problem.tension;
    gauges = {setup.horizontal.first, setup.horizontal.second, setup.vertical.first, setup.vertical.second};
    heights[0] = setup.height;
  }
  gauges = ranks.joined(gauges);
  ranks.sum(heights);
  TensionSetup setup = tension_loads(*p.problem.resolved.test, heights[0], heights[0]);
  const auto gauge = [&](std::size_t k) {
    return StrainGauge{static_cast<std::int32_t>(gauges[k]), static_cast<std::int32_t>(gauges[k + 1])};
  };
  setup.horizontal = gauge(0);
  setup.vertical = gauge(2);
  p.problem.tension = setup;
}

}  // namespace equidem
