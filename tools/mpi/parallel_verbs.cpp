// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem-mpi solve and homogenize.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <sys/resource.h>

#include "equidem/core/text.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/output/files/vtk.hpp"

#include "homogenize/homogenize.hpp"
#include "part_problem.hpp"
#include "rank_program.hpp"
#include "solve/solve.hpp"

namespace equidem {
namespace {

/// Whether every disc that the rank owns has a cell of some area.
bool cells_are_known(const petsc::Part& part) {
  const auto& areas = part.assembly.cell_areas;
  return static_cast<std::int64_t>(areas.size()) >= part.owned &&
         std::all_of(areas.begin(), areas.begin() + part.owned, [](double area) { return area > 0; });
}

/// NAME_discs_K.vtp and NAME_contacts_K.vtp of rank K, by rank 0 also NAME.vtm.
/// \param motions per disc of the part
void write_part_files(const CommonOptions& options, const std::string& name, const petsc::Ranks& ranks,
                      const petsc::Part& part, std::span<const DiscMotion> motions,
                      std::span<const ContactForce> forces) {
  const AssemblyState state{.assembly = part.assembly, .motions = motions, .contact_forces = forces};
  const std::span<const std::int64_t> numbers(part.names.data(), static_cast<std::size_t>(part.owned));
  write_vtk_piece(*options.out, name, ranks.rank(), state, numbers, options.overwrite);
  if (ranks.first()) write_vtk_index(*options.out, name, ranks.count(), options.overwrite);
}

std::string suffix_of_case(const std::string& load_case) {
  return load_case.empty() ? "" : "_" + load_case;
}

SolvedCase evaluated(const petsc::Ranks& ranks, const PartProblem& p, const petsc::Network& network,
                     const std::string& name, const petsc::PartEquilibrium& solved) {
  SolvedCase result{.name = name, .equilibrium = solved.state};
  result.deformation = {solved.largest_deformation, p.whole.largest_radius};
  if (p.whole.area > 0) {
    result.stress = solved.stress;
    result.stress_scale = solved.stress_scale;
    result.moment_per_area = solved.moment_per_area;
    result.empty_cells = ranks.any(!cells_are_known(p.part));
  }
  if (p.problem.tension)
    result.tension = petsc::evaluate_tension(network, *p.problem.resolved.test, *p.problem.tension, solved);
  return result;
}

/// Checks that the files of the states can be written, and keeps others from the folder.
std::unique_ptr<FolderLock> lock_files(const petsc::Ranks& ranks, const CommonOptions& options,
                                       const std::vector<std::string>& states) {
  std::unique_ptr<FolderLock> lock;
  ranks.together([&] {
    if (!ranks.first()) return;
    const OutputPlan plan(options);
    plan.expect_results();
    for (const std::string& state : states) {
      plan.expect(state + ".vtm");
      for (int rank = 0; rank < ranks.count(); ++rank)
        for (const std::string& file : vtk_piece_names(state, rank)) plan.expect(file);
    }
    if (options.out) lock = std::make_unique<FolderLock>(*options.out);
  });
  return lock;
}

/// Memory of this process at its peak.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// The ranks: their number, discs, memory, messages of an exchange and in all since `before`.
Results rank_results(const petsc::Ranks& ranks, const petsc::Network& network, const petsc::Counted& before) {
  const petsc::Counted after = petsc::counted_messages();
  const double peak = ranks.largest(peak_bytes());
  const double messages = ranks.largest(after.messages - before.messages);
  const double bytes = ranks.largest(after.bytes - before.bytes);
  const double sums = ranks.largest(after.sums - before.sums);
  const double exchanged = ranks.largest(network.halo.bytes()) * static_cast<double>(network.block());
  const auto neighbours = static_cast<std::int64_t>(ranks.largest(network.halo.neighbours()));
  Results out;
  out.line("ranks")
      .add("ranks", "", ranks.count(), "rank", {Shown::count})
      .note("; on the one with most ")
      .add("discs_of_a_rank", "", network.whole.owned, "disc", {Shown::count})
      .add("ghosts_of_a_rank", "", network.whole.ghosts, "ghost", {Shown::count})
      .add("peak_bytes", "", peak, "at the peak", {Shown::bytes});
  out.line("messages")
      .add("neighbours", "", neighbours, "neighbour", {Shown::count})
      .add("exchange_bytes", "", exchanged, "to send for one value of each unknown", {Shown::bytes})
      .note("; in all ")
      .add("messages", "", static_cast<std::int64_t>(messages), "message", {Shown::count})
      .add("message_bytes", "of", bytes, "", {Shown::bytes})
      .add("sums_over_ranks", "", static_cast<std::int64_t>(sums), "sum", {Shown::count})
      .note(" over all ranks");
  return out;
}

void deliver_of_ranks(const petsc::Ranks& ranks, const CommonOptions& options, const PartProblem& p,
                      const std::string& status, Results all, StageTimes times) {
  if (!ranks.first()) return;
  deliver(options, status, std::move(all), std::move(times),
          {{"case.toml", [&](const CommonOptions& into) { write_case(into, p.problem.resolved); }}});
}

void solve(const petsc::Ranks& ranks, const CommonOptions& options) {
  const petsc::Counted before = petsc::counted_messages();
  const auto made = build_part_problem(ranks, options, false);
  const PartProblem& p = *made;
  std::vector<std::string> states;
  for (const NamedLoads& loads : p.problem.load_cases) states.push_back("state" + suffix_of_case(loads.name));
  const auto lock = lock_files(ranks, options, states);
  const petsc::Network network(ranks, p.part, p.whole, p.problem.springs.springs, p.effects, p.problem.supports);
  if (!p.scattered) petsc::check_held(network);
  StageTimes times = p.problem.times;
  petsc::PetscSolver solver(network, p.problem.resolved.solver.method, times);
  std::vector<SolvedCase> results;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const NamedLoads& loads = p.problem.load_cases[k];
    const petsc::PartEquilibrium solved = petsc::solve_loads(network, solver, loads.loads);
    results.push_back(evaluated(ranks, p, network, loads.name, solved));
    times.add(solved.state.times);
    if (!options.out) continue;
    ranks.together([&] {
      write_part_files(options, states[k], ranks, p.part, solved.state.motions, solved.state.contact_forces);
    });
  }
  Results all = solve_results(p.problem, part_problem_results(ranks, p), results);
  all.append(rank_results(ranks, network, before));
  deliver_of_ranks(ranks, options, p, status_of(results.front().equilibrium.unstable_modes), std::move(all),
                   std::move(times));
}

constexpr std::array strain_states{"state_strain_xx", "state_strain_yy", "state_strain_xy"};
constexpr double strain_of_states = 1e-3;

/// The sum over the contacts of all ranks; the area is that of the period.
Matrix3 voigt_of_all(const petsc::Ranks& ranks, const PartProblem& p) {
  Matrix3 stiffness = voigt_stiffness(p.part.assembly, p.problem.springs.springs);
  for (auto& row : stiffness) ranks.sum(row);
  return stiffness;
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
      write_part_files(options, strain_states[k], ranks, p.part, motions, states[k].forces);
    }
  });
}

void homogenize(const petsc::Ranks& ranks, const CommonOptions& options) {
  const petsc::Counted before = petsc::counted_messages();
  const auto made = build_part_problem(ranks, options, true);
  const PartProblem& p = *made;
  const auto lock = lock_files(ranks, options, {strain_states.begin(), strain_states.end()});
  petsc::Network network(ranks, p.part, p.whole, p.problem.springs.springs, p.effects, {});
  network.hold(p.held);
  StageTimes times = p.problem.times;
  petsc::PetscSolver solver(network, p.problem.resolved.solver.method, times);
  BoundedStiffness homogenized{petsc::cell_stiffness(network, solver), {}};
  EffectiveStiffness& result = homogenized.result;
  if (options.out) write_strained(ranks, options, p, result);
  result.gear_modes = p.gears;
  result.discs_removed = p.removed;
  result.rattlers = p.rattlers;
  result.removed = p.left_out;
  homogenized.beside.push_back({"voigt", voigt_of_all(ranks, p), {}});
  times.add(result.times);
  Results all = homogenized_results(p.problem, part_problem_results(ranks, p), p.part.assembly.periodic(), homogenized,
                                    {}, relation_of_all(p));
  all.set("strain_of_states", strain_of_states);
  all.append(rank_results(ranks, network, before));
  deliver_of_ranks(ranks, options, p, status_of(result.unstable_modes), std::move(all), std::move(times));
}

template <void (*verb)(const petsc::Ranks&, const CommonOptions&)>
Run declare_on_all_ranks(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  return on_all_ranks([options](const petsc::Ranks& ranks) { verb(ranks, *options); });
}

}  // namespace

Run declare_parallel_solve(CLI::App& command) {
  return declare_on_all_ranks<solve>(command);
}
Run declare_parallel_homogenize(CLI::App& command) {
  return declare_on_all_ranks<homogenize>(command);
}

}  // namespace equidem
