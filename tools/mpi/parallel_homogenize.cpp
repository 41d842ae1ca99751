// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem-mpi homogenize.
#include <array>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/core/text.hpp"
#include "equidem/homogenize/bounds.hpp"

#include "homogenize/homogenize_results.hpp"
#include "mpi_verbs.hpp"
#include "part_files.hpp"
#include "part_problem.hpp"
#include "petsc/stiffness.hpp"
#include "rank_program.hpp"

namespace equidem {
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
  deliver(options, status_of(result), std::move(all), std::move(times),
          {{"case.toml", [&] { write_case(options, p.problem.resolved); }}});
}

}  // namespace

Run declare_parallel_homogenize(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  return on_all_ranks([options](const petsc::Ranks& ranks) { homogenize(ranks, *options); });
}

}  // namespace equidem
