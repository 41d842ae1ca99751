// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem solve: equilibrium under supports and loads, or Abe's tension test.
#include <algorithm>
#include <map>
#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "command.hpp"
#include "problem.hpp"
#include "solve/report.hpp"
#include "solve/solve_accuracy.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

/// "discs" or, of a named load case, "discs_NAME".
std::string file_stem(const std::string& stem, const std::string& load_case) {
  return load_case.empty() ? stem : stem + "_" + load_case;
}

/// Every file that will be written, asked for before anything is computed.
void check_outputs(const CommonOptions& options, const Case& resolved) {
  const OutputPlan plan(options);
  plan.expect_json();
  plan.expect("result.json");
  plan.expect("case.toml");
  for (const NamedLoads& loads : resolved.load_cases) {
    if (resolved.output.csv)
      for (const char* stem : {"discs", "contacts"}) plan.expect(file_stem(stem, loads.name) + ".csv");
    if (resolved.output.vtk)
      for (const char* end : {".vtm", "_discs.vtp", "_contacts.vtp"}) plan.expect(file_stem("state", loads.name) + end);
    if (resolved.output.picture)
      for (const char* end : {".svg", ".png"}) plan.expect(file_stem("picture", loads.name) + end);
  }
}

/// The force on each loaded disc.
std::vector<DrawnLoad> drawn_loads(const Problem& problem, const LoadCase& loads) {
  std::map<std::int32_t, Vec2> forces;
  for (const Load& load : loads) {
    const DiscGroup& pulled = group(problem.assembly, load.group);
    for (std::size_t k = 0; k < pulled.discs.size(); ++k) {
      double share = 1;
      if (load.kind == LoadKind::total) share = 1 / static_cast<double>(pulled.discs.size());
      if (load.kind == LoadKind::traction) share = pulled.tributary_lengths.at(k);
      forces[pulled.discs[k]] += share * load.force;
    }
  }
  std::vector<DrawnLoad> drawn;
  for (const auto& [disc, force] : forces) drawn.push_back({disc, force});
  return drawn;
}

std::vector<DrawnSupport> drawn_supports(const Problem& problem) {
  std::map<std::int32_t, DrawnSupport> held;
  for (const Support& support : problem.supports) {
    for (const std::int32_t disc : group(problem.assembly, support.group).discs) {
      DrawnSupport& drawn = held[disc];
      drawn.disc = disc;
      drawn.x = drawn.x || support.ux.has_value();
      drawn.y = drawn.y || support.uy.has_value();
    }
  }
  std::vector<DrawnSupport> all;
  for (const auto& [disc, drawn] : held)
    if (drawn.x || drawn.y) all.push_back(drawn);
  return all;
}

void write_outputs(const CommonOptions& options, const Problem& problem, const LoadCase& loads,
                   const SolvedCase& result) {
  const auto& folder = *options.out;
  const OutputCase& wanted = problem.resolved.output;
  const AssemblyState state{.assembly = problem.assembly,
                            .motions = result.equilibrium.motions,
                            .contact_forces = result.equilibrium.contact_forces,
                            .stresses = result.stresses};
  if (wanted.csv) {
    write_disc_csv(folder / (file_stem("discs", result.name) + ".csv"), state, options.overwrite);
    write_contact_csv(folder / (file_stem("contacts", result.name) + ".csv"), state, options.overwrite);
  }
  if (wanted.vtk) write_vtk(folder, file_stem("state", result.name), state, options.overwrite);
  if (wanted.picture) {
    PictureOptions picture{.title = problem.resolved.title};
    picture.loads = drawn_loads(problem, loads);
    picture.supports = drawn_supports(problem);
    write_picture(folder, file_stem("picture", result.name), state, picture, options.overwrite);
  }
}

/// The keys of one load case.
void add_result(JsonObject& object, const Problem& problem, const SolvedCase& result) {
  add_equilibrium(object, result.equilibrium);
  if (result.stress) {
    object.set("stress", voigt_stress(*result.stress));
    object.set("stress_tensor", *result.stress);
    object.set("stress_asymmetry", asymmetry(*result.stress));
    object.set("moment_per_area", result.moment_per_area);
  }

  if (result.tension) {
    add_tension(object, *problem.resolved.test, *problem.tension, *result.tension);
    if (const auto theory = tension_theory(problem)) {
      JsonObject expected;
      expected.set("poisson_ratio", theory->poisson_ratio).set("stiffness_ratio", theory->stiffness_ratio);
      object.set("theory", expected);
    }
  }
}

void add_problem(JsonObject& object, const Problem& problem) {
  object.set("title", problem.resolved.title);
  object.set("discs", problem.assembly.size());
  object.set("contacts", problem.assembly.contacts.size());
  object.set("coordination_number", problem.assembly.coordination_number());
  if (problem.assembly.periodic() || !problem.assembly.cell_areas.empty()) {
    object.set("area", problem.assembly.area());
    object.set("solid_fraction", problem.assembly.solid_fraction());
  }
  if (problem.springs.constants) {
    object.set("kN", problem.springs.constants->kN);
    object.set("kT", problem.springs.constants->kT);
  }
}

int dry_run_solution(const CommonOptions& options, const Problem& problem) {
  const Effects effects = derive_effects(problem.assembly, problem.springs.springs, problem.resolved.rotation);
  StageTimes times = problem.times;
  Stopwatch watch;
  const SolveEstimate size =
      estimate_solve(problem.assembly, problem.springs.springs, problem.supports, problem.options());
  times.add("analysis", watch.lap());
  const std::string report = describe_problem(problem, effects) + describe_estimate(size);
  JsonObject object;
  add_common(object, "dry_run", report, times, effects);
  add_problem(object, problem);
  object.set("unknowns", size.unknowns);
  object.set("factor_nonzeros", size.factor_nonzeros);
  object.set("factor_bytes", size.factor_bytes);
  object.set("peak_bytes", size.peak_bytes);
  object.set("operations", size.operations);
  CommonOptions without_folder = options;
  without_folder.out.reset();
  deliver(without_folder, report, object);
  return 0;
}

/// The worst of all load cases.
ReachedAccuracy bound_of(const std::vector<SolvedCase>& results, double accuracy, double seconds) {
  const auto worst = std::max_element(results.begin(), results.end(), [](const SolvedCase& a, const SolvedCase& b) {
    return a.equilibrium.error_bound < b.equilibrium.error_bound;
  });
  return solver_accuracy(accuracy, worst->equilibrium.error_bound, worst->equilibrium.condition, seconds);
}

/// Solves and delivers; false, and nothing delivered, where the block that the search proposed is too small.
bool solve_once(const CommonOptions& options, const Problem& problem, const std::optional<double>& accuracy,
                BlockSearch* search) {
  EquilibriumOptions solver_options = problem.options();
  solver_options.error_bound = true;
  const EquilibriumSolver solver(problem.assembly, problem.springs.springs, problem.supports, solver_options);
  std::vector<SolvedCase> results;
  for (const NamedLoads& loads : problem.load_cases) results.push_back(solve_case(problem, solver, loads));

  StageTimes times = problem.times;
  for (const SolvedCase& result : results) {
    const bool first = &result == &results.front();  // all load cases share one factorization
    for (const auto& [stage, seconds] : result.equilibrium.times.stages()) {
      if (first || stage == "solve" || stage == "refine") times.add(stage, seconds);
    }
  }
  std::optional<ReachedAccuracy> reached;
  if (search != nullptr) {
    if (!search->accepts(*results.front().tension, times.total())) return false;
    reached = search->reached();
  } else if (accuracy) {
    reached = bound_of(results, *accuracy, times.total());
  }
  Stopwatch watch;
  if (options.out) {
    for (std::size_t k = 0; k < results.size(); ++k)
      write_outputs(options, problem, problem.load_cases[k].loads, results[k]);
    write_file(*options.out / "case.toml", to_toml(problem.resolved, *options.out), options.overwrite);
    times.add("files", watch.lap());
  }

  const Effects& effects = solver.effects();
  std::string report = describe_problem(problem, effects) + describe_results(problem, results, times);
  if (reached) report += describe_accuracy(*reached);
  JsonObject object;
  add_common(object, results.front().status(), report, times, effects);
  add_problem(object, problem);
  if (results.size() == 1 && results.front().name.empty()) {
    add_result(object, problem, results.front());
  } else {
    std::vector<JsonObject> cases;
    for (const SolvedCase& result : results) {
      JsonObject one;
      one.set("case", result.name);
      add_result(one, problem, result);
      cases.push_back(std::move(one));
    }
    object.set("load_cases", cases);
  }
  if (reached) add_accuracy(object, *reached);
  deliver(options, report, object);
  if (options.out) say(options, fmt::format("written to {}", options.out->string()));
  return true;
}

int solve(const CommonOptions& options, const std::optional<double>& accuracy) {
  refuse_dry_run_with_accuracy(options, accuracy.has_value());
  Case resolved = read_case(options);
  check_outputs(options, resolved);
  if (accuracy && BlockSearch::serves(resolved)) {
    BlockSearch search(options, resolved, *accuracy);
    while (!solve_once(options, build_problem(search.propose()), accuracy, &search)) {
    }
    return 0;
  }
  const Problem problem = build_problem(std::move(resolved));
  if (options.dry_run) return dry_run_solution(options, problem);
  solve_once(options, problem, accuracy, nullptr);
  return 0;
}

}  // namespace

Run declare_solve(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  const auto accuracy = std::make_shared<std::optional<double>>();
  add_common_options(command, *options);
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
