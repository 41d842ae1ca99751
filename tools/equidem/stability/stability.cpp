// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem stability: mechanisms, inertia, waves, critical kT/kN, highest frequency and time step.
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/assembly/body_inertia.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "command.hpp"
#include "solve/report.hpp"
#include "stability/stability_analysis.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

int dry_run_survey(const CommonOptions& options, const Problem& problem) {
  const Assembly& assembly = problem.assembly;
  const ContactSprings& springs = problem.springs.springs;
  const Effects effects = derive_effects(assembly, springs, problem.resolved.rotation);
  StageTimes times = problem.times;
  Stopwatch watch;
  const SolveEstimate size = estimate_solve(assembly, springs, problem.supports, problem.options());
  std::string waves = "none: the assembly is not periodic";
  JsonObject object;
  if (assembly.periodic()) {
    const PrimitiveCell cell = primitive_cell(assembly, springs);
    const bool surveyed = cell.size() <= most_discs_of_survey;
    object.set("primitive_cell_discs", cell.size());
    if (surveyed) object.set("wave_vectors", survey_size(cell));
    waves = surveyed
                ? fmt::format("about {} wave vectors of a cell of {}", survey_size(cell),
                              counted(static_cast<std::int64_t>(cell.size()), "disc"))
                : fmt::format("none: the smallest cell has {} discs, more than {}", cell.size(), most_discs_of_survey);
  }
  const auto inertia = inertia_of(assembly, density_of(problem.resolved), problem.resolved.assembly.body);
  check_magnitudes(assembly, springs, inertia);
  const double step = 2 / std::sqrt(element_bound(assembly, springs, inertia, effects.rotation));
  times.add("analysis", watch.lap());
  const std::string report =
      describe_problem(problem, effects) +
      report_line("factorizations", "about 15 of the size below, 50 where a large cell is periodic") +
      report_line("waves", waves) +
      report_line("time step", fmt::format("{:.6g} s is guaranteed to be stable (element bound{})", step,
                                           problem.resolved.assembly.density ? "" : "; density 1 kg/m³ assumed")) +
      describe_estimate(size);
  JsonObject result;
  add_common(result, "dry_run", report, times, effects);
  result.set("unknowns", size.unknowns);
  result.set("factor_bytes", size.factor_bytes);
  result.set("peak_bytes", size.peak_bytes);
  result.set("operations", size.operations);
  result.set("element_bound_time_step", step);
  result.set("density_assumed", !problem.resolved.assembly.density.has_value());
  result.set("waves", object);
  CommonOptions without_folder = options;
  without_folder.out.reset();
  deliver(without_folder, report, result);
  return 0;
}

int stability(const CommonOptions& options) {
  const Case resolved = read_case(options);
  const OutputPlan plan(options);
  plan.expect_json();
  for (const char* name : {"result.json", "case.toml"}) plan.expect(name);
  for (const std::string& name : survey_files()) plan.expect(name);
  const Problem problem = stability_problem(resolved);
  if (options.dry_run) return dry_run_survey(options, problem);
  const Stability result = analyze_stability(problem);
  const std::string report = describe_stability(result);
  if (options.out) {
    write_survey(*options.out, result, options.overwrite);
    write_file(*options.out / "case.toml", to_toml(problem.resolved, *options.out), options.overwrite);
  }
  deliver(options, report, stability_json(result, report));
  if (options.out) say(options, fmt::format("written to {}", options.out->string()));
  return 0;
}

}  // namespace

Run declare_stability(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(command, *options);
  command.footer(
      "A periodic assembly needs neither supports nor loads; a free one is judged with its [[support]]\n"
      "or [test], or as a free body.\n"
      "Examples:\n"
      "  equidem stability data/cases/abe1996_fig6.toml         free edges: stable down to kT/kN = -0.2650\n"
      "  equidem stability cell.toml --out waves                dispersion, critical kT/kN over the zone\n"
      "  equidem stability cell.toml --set springs.kT=-0.1e9    stable in statics, but not in motion");
  return [options] { return stability(*options); };
}

}  // namespace equidem
