// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem solve: equilibrium under supports and loads, or Abe's tension test.
#include <algorithm>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"

#include "accuracy.hpp"
#include "command.hpp"
#include "problem.hpp"
#include "solve/solve_results.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

/// End of the names of the files of a load case.
std::string suffix_of(const std::string& load_case) {
  return load_case.empty() ? "" : "_" + load_case;
}

/// Every file that will be written, checked before the computation.
void check_solution_files(const CommonOptions& options, const Case& resolved) {
  const OutputPlan plan(options);
  plan.expect_results();
  expect_assembly(plan, resolved.output);
  for (const NamedLoads& loads : resolved.load_cases) expect_state(plan, resolved.output, suffix_of(loads.name));
}

void write_state_of(const CommonOptions& options, const OutputCase& wanted, const Problem& problem,
                    const LoadCase& loads, const SolvedCase& result) {
  const std::vector<ContactForce> forces = forces_in_total(problem, result.equilibrium.contact_forces);
  std::vector<Tensor2> stresses;
  if (cells_hold_area(problem.assembly)) stresses = disc_stresses(problem.assembly, forces);
  const AssemblyState state{.assembly = problem.assembly,
                            .motions = result.equilibrium.motions,
                            .contact_forces = forces,
                            .stresses = stresses,
                            .bending_moments = result.equilibrium.bending_moments};
  write_state(options, wanted, suffix_of(result.name), state);
  PictureOptions picture{.title = problem.resolved.title};
  picture.loads = drawn_loads(problem.assembly, loads);
  picture.supports = drawn_supports(problem.assembly, problem.supports);
  if (problem.tension) {
    const auto& [a, b] = problem.tension->horizontal;
    const auto& [c, d] = problem.tension->vertical;
    picture.gauges = {{a, b, "A", "B"}, {c, d, "C", "D"}};
  }
  write_state_picture(options, wanted, suffix_of(result.name), state, picture);
}

void write_outputs(const CommonOptions& options, const OutputCase& wanted, const Problem& problem,
                   const std::vector<SolvedCase>& results) {
  write_assembly(options, wanted, problem.assembly);
  for (std::size_t k = 0; k < results.size(); ++k)
    write_state_of(options, wanted, problem, problem.load_cases[k].loads, results[k]);
  write_case(options, problem.resolved);
}

/// The worst of all load cases.
ReachedAccuracy bound_of(const std::vector<SolvedCase>& results, double accuracy, double seconds) {
  const auto worst = std::max_element(results.begin(), results.end(), [](const SolvedCase& a, const SolvedCase& b) {
    return a.equilibrium.error_bound < b.equilibrium.error_bound;
  });
  return solver_accuracy(accuracy, worst->equilibrium.error_bound, worst->equilibrium.condition, seconds);
}

/// Solves and delivers; false, and nothing delivered, where the block that the search proposed is too small.
bool solve_once(const CommonOptions& options, const std::shared_ptr<const Problem>& shared_problem,
                const std::optional<double>& accuracy, BlockSearch* search) {
  const Problem& problem = *shared_problem;
  EquilibriumOptions solver_options = problem.options();
  solver_options.error_bound = true;
  if (accuracy && search == nullptr) solver_options.solver.accuracy = 0.5 * *accuracy;
  solver_options.solver.right_hand_sides = static_cast<int>(problem.load_cases.size());
  const auto shared_results = std::make_shared<std::vector<SolvedCase>>();
  std::vector<SolvedCase>& results = *shared_results;
  Effects effects;
  {  // the factorization is not needed beyond the load cases
    const EquilibriumSolver solver(problem.assembly, problem.springs.springs, problem.supports, solver_options);
    for (const NamedLoads& loads : problem.load_cases) results.push_back(solve_case(problem, solver, loads));
    effects = solver.effects();
  }

  StageTimes times = problem.times;
  for (const SolvedCase& result : results) {
    const bool first = &result == &results.front();  // all load cases share one factorization
    for (const auto& [stage, seconds] : result.equilibrium.times.stages()) {
      if (first || stage == "solve" || stage == "refine") times.add(stage, seconds);
    }
  }
  std::optional<ReachedAccuracy> reached;
  if (search != nullptr) {
    if (!search->accepts(BlockSearch::values_of(*results.front().tension), times.total())) return false;
    reached = search->reached();
  } else if (accuracy) {
    reached = bound_of(results, *accuracy, times.total());
  }
  Results all = solve_results(problem, problem_results(problem, effects), results);
  if (reached) all.append(accuracy_results(*reached));
  std::vector<OutputPart> parts;
  if (options.out) {
    const OutputCase& wanted = problem.resolved.output;
    parts.push_back({"case.toml", [&] { write_case(options, problem.resolved); }});
    parts.push_back({"the assembly", [&] { write_assembly(options, wanted, problem.assembly); }});
    for (std::size_t k = 0; k < results.size(); ++k)
      parts.push_back(
          {"the state", [&, k] { write_state_of(options, wanted, problem, problem.load_cases[k].loads, results[k]); }});
  }
  deliver(options, results.front().status(), std::move(all), std::move(times), parts);
  if (!arrays_wanted()) return true;
  for (const SolvedCase& result : results) {
    hand_over(state_arrays(result.name.empty() ? "" : result.name + "/",
                           std::shared_ptr<const Equilibrium>(shared_results, &result.equilibrium)));
  }
  hand_over(std::shared_ptr<const Assembly>(shared_problem, &problem.assembly));
  hand_over([shared_problem, shared_results](const CommonOptions& into) {
    write_outputs(into, pictures_of(shared_problem->resolved.output), *shared_problem, *shared_results);
  });
  return true;
}

int solve(const CommonOptions& options, const std::optional<double>& accuracy) {
  Case resolved = read_case(options);
  check_solution_files(options, resolved);
  const auto lock = lock_out(options);
  const bool searched = accuracy && BlockSearch::serves(resolved);
  if (searched && !options.dry_run) {
    BlockSearch search(options, resolved, *accuracy);
    while (!solve_once(options, std::make_shared<const Problem>(prestressed(build_problem(search.propose()))), accuracy,
                       &search)) {
    }
    return 0;
  }
  const auto problem = std::make_shared<const Problem>(prestressed(build_problem(std::move(resolved))));
  if (options.dry_run) {
    Results further;
    if (accuracy) further = accuracy_plan(*accuracy, searched ? BlockSearch::plan : bound_is_compared);
    deliver(options, "dry_run", dry_run_results(*problem, further), problem->times);
    return 0;
  }
  solve_once(options, problem, accuracy, nullptr);
  return 0;
}

}  // namespace

Run declare_solve(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  const auto accuracy = std::make_shared<std::optional<double>>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  add_accuracy_option(
      command, *accuracy,
      "tension test of a lattice: the size that tells nu to X;\nelse: fail unless the error is below X");
  command.footer(
      "Examples:\n"
      "  equidem solve data/cases/abe1996_fig6.toml\n"
      "  equidem solve data/cases/cantilever.toml --out result      tables, picture, files for ParaView\n"
      "  equidem solve data/cases/abe1996_fig6.toml --set springs.kT=0 --json -\n"
      "  equidem solve data/cases/abe1996_fig6.toml --accuracy 1e-3    as large a block as nu to 1e-3 needs");
  return [options, accuracy] { return solve(*options, *accuracy); };
}

}  // namespace equidem
