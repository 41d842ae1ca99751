// SPDX-License-Identifier: GPL-3.0-or-later
#include <initializer_list>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "command.hpp"
#include "run/run_accuracy.hpp"
#include "run/run_bonded.hpp"
#include "run/run_grains.hpp"
#include "run/run_report.hpp"
#include "solve/report.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct RunVerb {
  CommonOptions common;
  bool resume = false;
  std::optional<double> accuracy;
};

/// Asked before the run, so that no hour is lost to a full folder.
void check_outputs(const RunVerb& options, std::initializer_list<std::pair<const char*, bool>> files) {
  const CommonOptions& common = options.common;
  if (options.resume && !common.out) {
    throw Error(ErrorKind::bad_input, "--resume without --out", "the checkpoint lies in that folder",
                "Name the folder of the run that is to go on");
  }
  const OutputPlan plan(common);
  plan.expect_json();
  if (options.resume) return;
  plan.expect("result.json");
  plan.expect("case.toml");
  for (const auto& [name, wanted] : files)
    if (wanted) plan.expect(name);
}

void check_outputs(const RunVerb& options, const Case& resolved) {
  check_outputs(options, {{"discs.csv", resolved.output.csv}, {"picture.svg", resolved.output.picture}});
}

int dry_run(CommonOptions common, RunJob& job) {
  const RunPlan plan = job.plan();
  AnySimulation& simulation = job.simulation();
  std::string report = job.describe();
  JsonObject object;
  if (plan.steps > 0) {
    report += describe_output(job, plan, simulation);
    const double seconds = estimate_seconds(simulation, plan);
    report += report_line(
        "steps", fmt::format("{}, about {:.2g} s with these threads, output aside", grouped(plan.steps), seconds));
    object.set("steps", plan.steps).set("estimated_seconds", seconds);
    job.add_step(object);
  }
  add_common(object, "dry_run", report, job.times(), simulation.effects());
  object.set(fmt::format("bytes_per_{}", job.body_name()), simulation.bytes_per_body());
  common.out.reset();
  deliver(common, report, object);
  return 0;
}

/// Make all steps and deliver the results; false, and nothing delivered, where the step that the search proposed is too
/// long.
bool step_through(const RunVerb& options, RunJob& job, StepSearch* search) {
  CommonOptions common = options.common;
  AnySimulation& simulation = job.simulation();
  const RunPlan plan = job.plan();
  const RunResult result =
      run_through(simulation, plan, {.folder = common.out, .overwrite = common.overwrite, .resume = options.resume});
  if (search != nullptr && !search->accepts(simulation.motions(), result.seconds)) return false;
  StageTimes times = job.times();
  times.add("steps", result.seconds);
  common.overwrite = common.overwrite || options.resume;
  if (common.out) {
    Stopwatch watch;
    job.write_files(*common.out, result, common.overwrite);
    times.add("files", watch.lap());
  }
  std::string report =
      job.describe() + describe_output(job, plan, simulation) + describe_run(job, plan, simulation, result, times);
  JsonObject object;
  if (search != nullptr) report += describe_accuracy(search->reached());
  add_common(object, "done", report, times, simulation.effects());
  add_run(object, job, simulation, result);
  if (search != nullptr) add_accuracy(object, search->reached());
  deliver(common, report, object);
  if (common.out) say(common, fmt::format("written to {}", common.out->string()));
  return true;
}

int run_grains(const RunVerb& options) {
  const CommonOptions& common = options.common;
  if (options.accuracy) {
    bad_input("--accuracy does not act on bodies that collide",
              "their motions do not converge by one order with the step: impacts begin and end within it, and many of "
              "them make the motion chaotic",
              "Halve time_step and compare what is measured; 'equidem study collision_laws' shows the error of each "
              "law against the step");
  }
  if (common.seed) bad_input("--seed", "nothing in a case of grains is random", "Leave it out");
  if (common.threads > 0) set_thread_count(common.threads);
  set_progress_shown(!common.quiet);
  GrainCase resolved = read_grain_case(common.case_file, common.set);
  check_outputs(options, {{"energy.csv", true},
                          {"measures.csv", resolved.measures.has_value()},
                          {"grains.csv", resolved.output.csv},
                          {"picture.png", resolved.output.picture}});
  const GrainSetup setup(std::move(resolved));
  GrainRun job(setup);
  if (common.dry_run) return dry_run(common, job);
  step_through(options, job, nullptr);
  return 0;
}

int run_to_accuracy(RunVerb options, double accuracy) {
  if (options.resume)
    bad_input("--resume and --accuracy exclude each other", "the step is that of the checkpoint",
              "Leave one of them out");
  check_outputs(options, read_case(options.common));
  StepSearch search(options.common, accuracy);
  for (;;) {
    const RunSetup setup(search.propose());
    BondedRun job(setup);
    if (step_through(options, job, &search)) return 0;
    options.common.overwrite = true;  // what the step that was too long has left
  }
}

int run(const RunVerb& options) {
  const CommonOptions& common = options.common;
  refuse_dry_run_with_accuracy(common, options.accuracy.has_value());
  if (describes_grains(common.case_file, common.set)) return run_grains(options);
  if (options.accuracy) return run_to_accuracy(options, *options.accuracy);
  Case resolved = read_case(common);
  check_outputs(options, resolved);
  const bool goes_on = options.resume && resolved.run && resolved.run->duration;
  const RunSetup setup(std::move(resolved),
                       goes_on ? std::optional(kept_step(*common.out / "run.checkpoint.h5")) : std::nullopt);
  BondedRun job(setup);
  if (common.dry_run) return dry_run(common, job);
  if (setup.run().until_rest) {
    if (options.resume) {
      throw Error(ErrorKind::bad_input, "--resume of a run to rest", "it keeps no checkpoints: it ends where it ends",
                  "Run it anew");
    }
    return job.relax_to_rest(common);
  }
  step_through(options, job, nullptr);
  return 0;
}

}  // namespace

Run declare_run(CLI::App& command) {
  const auto options = std::make_shared<RunVerb>();
  add_common_options(command, options->common);
  command.add_flag("--resume", options->resume, "go on from the checkpoint in --out");
  add_accuracy_option(command, options->accuracy,
                      "bonded discs: the step that tells the displacements at the end to X");
  command.footer(
      "Examples:\n"
      "  equidem run data/cases/run_tension.toml                to rest: the answer of 'equidem solve'\n"
      "  equidem run data/cases/run_pulse.toml --out result     frames for ParaView, histories, checkpoint\n"
      "  equidem run data/cases/run_pulse.toml --out result --resume --set run.duration=4e-3\n"
      "  equidem run data/cases/run_pulse.toml --accuracy 0.01  the longest step that does\n"
      "  equidem run data/cases/grains_cradle.toml --out cradle  bodies that collide");
  return [options] { return run(*options); };
}

}  // namespace equidem
