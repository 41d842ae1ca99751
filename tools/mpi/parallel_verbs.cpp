// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem-mpi solve and homogenize.
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/text.hpp"
#include "equidem/homogenize/bounds.hpp"

#include "homogenize/homogenize.hpp"
#include "part_problem.hpp"
#include "petsc/stiffness.hpp"
#include "rank_program.hpp"
#include "solve/solve.hpp"

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
  deliver(options, status_of(results.front().equilibrium.unstable_modes), std::move(all), std::move(times),
          {{"case.toml", [&](const CommonOptions& into) { write_case(into, problem.resolved); }}});
}

}  // namespace

Run declare_parallel_solve(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  return on_all_ranks([options](const petsc::Ranks& ranks) { solve(ranks, *options); });
}

namespace {

constexpr std::array strain_states{"state_strain_xx", "state_strain_yy", "state_strain_xy"};
constexpr double strain_of_states = 1e-3;

/// The sum over the contacts of all ranks; the area is that of the period.
Matrix3 voigt_of_all(const petsc::Ranks& ranks, const PartProblem& p) {
  const Matrix3 own = voigt_stiffness(p.part.assembly, p.problem.springs.springs);
  std::array<double, 9> sums{};
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = own[k / 3][k % 3];
  ranks.sum(sums);
  Matrix3 all{};
  for (std::size_t k = 0; k < sums.size(); ++k) all[k / 3][k % 3] = sums[k];
  return all;
}

/// Moduli by the relation of Abe (1996), where the springs stand for an isotropic continuum.
std::optional<RelationBeside> relation_of_all(const PartProblem& p) {
  const auto& constants = p.problem.springs.constants;
  if (!constants || !p.lattice) return {};
  return relation_beside(*constants, spring_relation(p.problem.resolved, p.part.assembly));
}

void write_strained(const petsc::Ranks& ranks, const CommonOptions& options, const PartProblem& p,
                    const EffectiveStiffness& result) {
  ranks.together([&] {
    const std::vector<StrainedState> states =
        strained_states(p.part.assembly, p.problem.springs.springs, result, strain_of_states);
    for (std::size_t k = 0; k < states.size(); ++k) {
      std::vector<DiscMotion> motions = states[k].fluctuations;
      for (std::size_t d = 0; d < motions.size(); ++d) motions[d].u += states[k].gradient * p.part.assembly.centres[d];
      write_part_files(*options.out, strain_states[k], ranks, p.part, motions, states[k].forces, options.overwrite);
    }
  });
}

void homogenize(const petsc::Ranks& ranks, const CommonOptions& options) {
  const petsc::Counted before = petsc::counted_messages();
  const auto made = build_part_problem(ranks, options, true);
  const PartProblem& p = *made;
  std::unique_ptr<FolderLock> lock;
  ranks.together([&] {
    if (!ranks.first()) return;
    OutputPlan(options).expect_results();
    for (const char* state : strain_states) expect_part_files(OutputPlan(options), ranks, state);
    if (options.out) lock = std::make_unique<FolderLock>(*options.out);
  });
  petsc::CellSolver solver(ranks, p.part, p.whole, p.problem.springs.springs, p.effects,
                           p.problem.resolved.solver.method, p.held);
  BoundedStiffness homogenized{solver.solve(), {}};
  EffectiveStiffness& result = homogenized.result;
  if (options.out) write_strained(ranks, options, p, result);
  result.gear_modes = p.gears;
  result.discs_removed = p.removed;
  result.rattlers = p.rattlers;
  result.removed = p.left_out;
  homogenized.beside.push_back({"voigt", voigt_of_all(ranks, p), {}});
  StageTimes times = p.problem.times;
  times.add(result.times);
  Results all = homogenized_results(p.problem, part_problem_results(ranks, p), p.part.assembly.periodic(), homogenized,
                                    {}, relation_of_all(p));
  all.set("strain_of_states", strain_of_states);
  all.append(rank_results(ranks, solver.network(), before, petsc::counted_messages()));
  if (!ranks.first()) return;
  deliver(options, status_of(result.unstable_modes), std::move(all), std::move(times),
          {{"case.toml", [&](const CommonOptions& into) { write_case(into, p.problem.resolved); }}});
}

}  // namespace

Run declare_parallel_homogenize(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  return on_all_ranks([options](const petsc::Ranks& ranks) { homogenize(ranks, *options); });
}

}  // namespace equidem
