// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem-mpi solve.
#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/text.hpp"

#include "mpi_verbs.hpp"
#include "part_files.hpp"
#include "part_problem.hpp"
#include "petsc/tension.hpp"
#include "rank_program.hpp"
#include "solve/solve_results.hpp"

namespace equidem {
namespace {

std::string suffix_of_case(const std::string& load_case) {
  return load_case.empty() ? "" : "_" + load_case;
}

SolvedCase evaluated(const petsc::Ranks& ranks, const PartProblem& p, const petsc::Network& network,
                     const std::string& name, const petsc::PartEquilibrium& solved) {
  SolvedCase result{.name = name, .equilibrium = solved.state};
  result.deformation = {solved.largest_deformation, p.whole.largest_radius};
  if (p.whole.area > 0) {
    result.stress = solved.stress;
    result.moment_per_area = solved.moment_per_area;
    result.empty_cells = ranks.any(!cells_are_known(p.part));
  }
  if (p.problem.tension)
    result.tension = petsc::evaluate_tension(network, *p.problem.resolved.test, *p.problem.tension, solved);
  return result;
}

void solve(const petsc::Ranks& ranks, const CommonOptions& options) {
  const petsc::Counted before = petsc::counted_messages();
  const auto made = build_part_problem(ranks, options, false);
  const PartProblem& p = *made;
  const Problem& problem = p.problem;
  std::unique_ptr<FolderLock> lock;
  ranks.together([&] {
    if (!ranks.first()) return;
    OutputPlan(options).expect_results();
    for (const NamedLoads& loads : problem.load_cases)
      expect_part_files(OutputPlan(options), ranks, "state" + suffix_of_case(loads.name));
    if (options.out) lock = std::make_unique<FolderLock>(*options.out);
  });
  petsc::PartSolver solver(ranks, p.part, p.whole, problem.springs.springs, p.effects, problem.supports,
                           problem.resolved.solver.method, p.scattered);
  std::vector<SolvedCase> results;
  StageTimes times = problem.times;
  for (const NamedLoads& loads : problem.load_cases) {
    const petsc::PartEquilibrium solved = solver.solve(loads.loads);
    results.push_back(evaluated(ranks, p, solver.network(), loads.name, solved));
    const bool first = results.size() == 1;  // all load cases share one matrix
    for (const auto& [stage, seconds] : solved.state.times.stages()) {
      if (first || stage == "solve" || stage == "forces") times.add(stage, seconds);
    }
    if (options.out) {
      ranks.together([&] {
        write_part_files(*options.out, "state" + suffix_of_case(loads.name), ranks, p.part, solved.state.motions,
                         solved.state.contact_forces, options.overwrite);
      });
    }
  }
  Results all = solve_results(problem, part_problem_results(ranks, p), results);
  all.append(rank_results(ranks, solver.network(), before, petsc::counted_messages()));
  if (!ranks.first()) return;
  deliver(options, results.front().status(), std::move(all), std::move(times),
          {{"case.toml", [&] { write_case(options, problem.resolved); }}});
}

}  // namespace

Run declare_parallel_solve(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  return on_all_ranks([options](const petsc::Ranks& ranks) { solve(ranks, *options); });
}

}  // namespace equidem
