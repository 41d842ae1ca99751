// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains.hpp"

#include <algorithm>
#include <optional>

#include "equidem/casefile/echo.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/files/grain_tables.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "run/run_grains_loop.hpp"
#include "run/run_grains_report.hpp"
#include "solve/report.hpp"

namespace equidem {
namespace {

GrainCase read(const CommonOptions& common) {
  if (common.seed) bad_input("--seed", "nothing in a case of grains is random", "Leave it out");
  if (common.threads > 0) set_thread_count(common.threads);
  set_progress_shown(!common.quiet);
  return read_grain_case(common.case_file, common.set);
}

void check_outputs(const CommonOptions& common, bool resume, const GrainCase& resolved) {
  if (resume && !common.out)
    bad_input("--resume without --out", "the checkpoint lies in that folder",
              "Name the folder of the run that is to go on");
  const OutputPlan plan(common);
  plan.expect_json();
  if (resume) return;
  plan.expect("result.json");
  plan.expect("case.toml");
  plan.expect("energy.csv");
  if (resolved.measures) plan.expect("measures.csv");
  if (resolved.output.csv) plan.expect("grains.csv");
  if (resolved.output.picture) plan.expect("picture.png");
}

/// Seconds that all steps will take, from the time of the first few, which are made.
double estimate_seconds(const GrainSetup& setup, GrainSimulation& simulation) {
  constexpr double enough = 0.05;  // s of the clock on the wall
  for (std::int64_t steps = 1;; steps *= 4) {
    steps = std::min(steps, setup.steps - simulation.step());
    if (steps == 0) return 0;
    const Stopwatch watch;
    try {
      simulation.advance(steps);
    } catch (const Error& error) {
      throw error.at(setup.resolved.where("run.time_step"));
    }
    const double seconds = watch.seconds();
    if (seconds > enough || simulation.step() == setup.steps)
      return seconds / static_cast<double>(steps) * static_cast<double>(setup.steps);
  }
}

int dry_run(const CommonOptions& common, const GrainSetup& setup) {
  GrainSimulation simulation = setup.simulation();
  std::string report = describe_grains(setup, simulation);
  const double seconds = estimate_seconds(setup, simulation);
  report += report_line("steps", fmt::format("{}, about {:.2g} s, output aside", grouped(setup.steps), seconds));
  JsonObject object;
  add_common(object, "dry_run", report, {}, simulation.effects());
  object.set("steps", setup.steps).set("estimated_seconds", seconds);
  add_grain_step(object, setup.step);
  object.set("bytes_per_grain", simulation.bytes_per_grain());
  CommonOptions without_folder = common;
  without_folder.out.reset();
  deliver(without_folder, report, object);
  return 0;
}

void write_state(const std::filesystem::path& folder, const GrainSetup& setup, const GrainSimulation& simulation,
                 const GrainRun& run, bool overwrite) {
  const GrainCase& resolved = setup.resolved;
  const std::vector<Grain> grains = simulation.grains();
  std::vector<std::string> groups;
  std::vector<int> colours;
  for (const Grain& grain : grains) {
    groups.push_back(resolved.contacts.kinds[static_cast<std::size_t>(grain.kind)]);
    // Kinds of one group may differ by radius: the first of them lends its colour.
    colours.push_back(
        static_cast<int>(std::find(resolved.contacts.kinds.begin(), resolved.contacts.kinds.end(), groups.back()) -
                         resolved.contacts.kinds.begin()));
  }
  if (resolved.output.csv) {
    write_grain_csv(folder / "grains.csv", {grains, resolved.scene.clumps, groups, resolved.densities}, overwrite);
    write_grain_contact_csv(folder / "contacts.csv", simulation.contacts(), resolved.scene.walls, resolved.body,
                            overwrite);
  }
  if (resolved.output.csv && !resolved.scene.bonds.empty())
    write_bond_csv(folder / "bonds.csv", resolved.scene.bonds, simulation.bond_drifts(), overwrite);
  if (resolved.output.picture) {
    write_grain_picture(folder, "picture",
                        {.title = resolved.title,
                         .time = simulation.time(),
                         .grains = grains,
                         .clumps = resolved.scene.clumps,
                         .groups = colours,
                         .bonds = resolved.scene.bonds,
                         .walls = resolved.scene.walls,
                         .paths = run.record.paths},
                        overwrite);
    write_grain_energy_plot(folder, setup, run, overwrite);
    write_probe_paths(folder, resolved, overwrite);
  }
  write_grain_energy_csv(folder / "energy.csv", run.record.energies, resolved.body, overwrite);
  write_file(folder / "case.toml", to_toml(resolved.document, folder), overwrite);
}

}  // namespace

int run_grains(const CommonOptions& common, bool resume) {
  StageTimes times;
  Stopwatch watch;
  GrainCase resolved = read(common);
  check_outputs(common, resume, resolved);
  const GrainSetup setup(std::move(resolved));
  if (common.dry_run) return dry_run(common, setup);
  GrainSimulation simulation = setup.simulation();
  times.add("scene", watch.lap());
  std::optional<GrainMeasures> measures;
  if (setup.resolved.measures) measures.emplace(setup.resolved);
  const GrainRun run =
      run_through(setup, simulation, {.folder = common.out, .overwrite = common.overwrite, .resume = resume},
                  measures ? &*measures : nullptr);
  times.add("steps", run.seconds);
  CommonOptions delivered = common;
  delivered.overwrite = common.overwrite || resume;
  if (common.out) {
    watch.lap();
    write_state(*common.out, setup, simulation, run, delivered.overwrite);
    if (measures) measures->write_files(*common.out, simulation, delivered.overwrite);
    times.add("files", watch.lap());
  }
  const std::string report = describe_grains(setup, simulation) + (measures ? measures->describe() : "") +
                             describe_grain_run(setup, simulation, run, times);
  JsonObject object;
  add_common(object, "done", report, times, simulation.effects());
  add_grain_run(object, setup, simulation, run);
  add_shaking(object, setup.resolved);
  if (measures) measures->add_to(object);
  deliver(delivered, report, object);
  if (common.out) say(common, fmt::format("written to {}", common.out->string()));
  return 0;
}

}  // namespace equidem
