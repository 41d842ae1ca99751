// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/checkpoint.hpp"

#include "command.hpp"
#include "run/run_bonded.hpp"
#include "run/run_grains.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct RunVerb {
  CommonOptions common;
  bool resume = false;
  std::optional<std::filesystem::path> begin_from;
  std::optional<double> accuracy;
};

/// Before the run, so that no hour is lost to a full folder.
void check_outputs(const RunVerb& options, const RunJob& job) {
  const OutputPlan plan(options.common);
  plan.expect_json();
  if (options.resume) return;
  plan.expect_results();
  for (const std::string& name : job.files()) plan.expect(name);
}

/// Delivers the results of a run with its files, which keep job and result.
/// \param history of probes, whose paths are drawn, for a page in memory
void deliver_run(const RunVerb& options, const char* status, Results results, StageTimes times,
                 const std::shared_ptr<RunJob>& job, const std::shared_ptr<const RunResult>& result,
                 const std::optional<Error>& failure, const std::string& history = {}) {
  std::vector<OutputPart> parts = job->parts(*result);
  for (OutputPart& part : parts)
    part.write = [job, result, write = std::move(part.write)](const CommonOptions& into) { write(into); };
  if (!history.empty()) {
    const auto write = [history](const CommonOptions& into) {
      const std::filesystem::path path = *into.out / "history.csv";
      if (!std::filesystem::exists(path)) write_file(path, history, false);
    };
    parts.insert(parts.begin(), {"history.csv", write, OutputPart::page});
  }
  CommonOptions written = options.common;
  written.overwrite |= options.resume;
  deliver(written, status, std::move(results), std::move(times), parts, failure);
}

/// Make all steps and deliver the results; false, and nothing delivered, where the step that the search proposed is too
/// long.
bool step_through(const RunVerb& options, const std::shared_ptr<RunJob>& shared_job, CaseSearch* search = nullptr) {
  const CommonOptions& common = options.common;
  RunJob& job = *shared_job;
  RunPlan plan = job.plan();
  if (common.out || arrays_wanted()) plan.film_frames = frames_of_film(job.simulation().motions().size());
  const HistoryFolder tables(common.out, arrays_wanted() && (plan.probe_interval || plan.recorder != nullptr));
  if (tables.is_temporary()) plan.frame_interval.reset();
  const auto shared_result = std::make_shared<RunResult>();
  const RunResult& result = *shared_result;
  const std::optional<Error> failure = failure_of([&] {
    try {
      run_through(job.simulation(), plan,
                  {.folder = tables.path(), .overwrite = common.overwrite, .resume = options.resume}, *shared_result);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::interrupted) throw;
      throw_stopped(common, fmt::format("{} of {} steps are done", job.simulation().step(), plan.steps),
                    "Run the same command with --resume to do the rest");
    }
  });
  if (failure && failure->kind() == ErrorKind::bad_input && result.steps_done == 0) throw *failure;
  if (!failure && search != nullptr && !search->accepts(searched_values(job.simulation().motions()), result.seconds))
    return false;
  const StopsHeldBack held_back(failure);
  StageTimes times = job.times();
  times.add("steps", result.seconds);
  Results results = run_results(job, plan, result, failure.has_value());
  results.set("complete", true);
  if (!failure && search != nullptr) results.append(accuracy_results(reached_by_step(*search)));
  deliver_run(options, "done", std::move(results), std::move(times), shared_job, shared_result, failure,
              arrays_wanted() ? tables.history() : "");
  if (arrays_wanted()) hand_over(tables.arrays(result.record.energies, job.simulation().family(), plan.body));
  return true;
}

void relax_to_rest(const RunVerb& options, const std::shared_ptr<RunJob>& shared_job) {
  RunJob& job = *shared_job;
  if (options.resume) {
    bad_input("--resume of a run to rest", "it keeps no checkpoints: it ends where it ends", "Run it anew");
  }
  StageTimes times = job.times();
  Results results;
  const std::optional<Error> failure = failure_of([&] { results = job.relax(times); });
  if (failure && failure->kind() == ErrorKind::bad_input) throw *failure;
  const StopsHeldBack held_back(failure);
  if (failure) results = job.scene();
  results.set("complete", true);
  deliver_run(options, "at_rest", std::move(results), std::move(times), shared_job, std::make_shared<const RunResult>(),
              failure);
}

int run_to_accuracy(RunVerb options, double accuracy) {
  CaseSearch search(options.common, [&] {
    const BondedRun given(read_case(options.common));
    check_outputs(options, given);
    return searched_step(given, accuracy);
  }());
  const auto lock = lock_out(options.common);
  for (;;) {
    const auto job = std::make_shared<BondedRun>(search.propose());
    if (step_through(options, job, &search)) return 0;
    options.common.overwrite = true;  // files of the step that was too long
  }
}

/// Combinations of options that are not possible.
void check_options(const RunVerb& options, bool collide) {
  const CommonOptions& common = options.common;
  if (options.resume && !common.out)
    bad_input("--resume without --out", "the checkpoint lies in that folder",
              "Name the folder of the run that is to go on");
  if (options.accuracy && collide) {
    bad_input("--accuracy does not act on bodies that collide",
              "their motions do not converge by one order with the step: impacts begin and end within it, and many of "
              "them make the motion chaotic",
              "Halve time_step and compare what is measured; 'equidem study collision_laws' shows the error of each "
              "law against the step");
  }
  if (options.accuracy && options.resume)
    bad_input("--resume and --accuracy exclude each other", "the step is that of the checkpoint",
              "Leave one of them out");
  if (options.begin_from && options.resume)
    bad_input("--begin-from and --resume exclude each other", "a run begins once", "Leave one of them out");
  if (options.begin_from && !collide)
    bad_input("--begin-from of bonded discs", "only runs of grains are in stages, with a checkpoint at the end of each",
              "Leave it out; --resume goes on with a longer duration");
  if (common.seed && collide) bad_input("--seed", "nothing in a case of grains is random", "Leave it out");
}

int run(const RunVerb& options) {
  const bool collide = describes_grains(casefile::read_document(options.common.case_file, options.common.set));
  check_options(options, collide);
  if (options.accuracy && !options.common.dry_run) return run_to_accuracy(options, *options.accuracy);
  const std::shared_ptr<RunJob> job = make_run_job(options.common, options.resume, options.begin_from);
  check_outputs(options, *job);
  const auto lock = lock_out(options.common);
  if (options.common.dry_run) {
    Results results = dry_run_results(*job, options.common.out.has_value());
    if (options.accuracy) results.append(accuracy_plan(*options.accuracy, plan_of_steps));
    deliver(options.common, "dry_run", results, job->times());
  } else if (job->goes_to_rest()) {
    relax_to_rest(options, job);
  } else {
    step_through(options, job);
  }
  return 0;
}

}  // namespace

std::unique_ptr<RunJob> make_run_job(const CommonOptions& options, bool resume,
                                     const std::optional<std::filesystem::path>& begin_from) {
  prepare(options);
  if (describes_grains(casefile::read_document(options.case_file, options.set))) {
    GrainCase resolved = read_grain_case(options.case_file, options.set);
    if (resume) {
      const std::string text = case_of_checkpoint(*options.out / "run.checkpoint.h5");
      const std::optional<double> step = kept_grain_step(text, resolved);
      auto job = std::make_unique<GrainRun>(std::move(resolved), step);
      job->go_on_from(text);
      return job;
    }
    if (!begin_from) return std::make_unique<GrainRun>(std::move(resolved));
    auto job = std::make_unique<GrainRun>(std::move(resolved), step_of_stages(*begin_from));
    job->begin_from(*begin_from);
    return job;
  }
  Case resolved = read_case(options);
  const bool continues = resume && resolved.run && resolved.run->duration;
  return std::make_unique<BondedRun>(
      std::move(resolved), continues ? std::optional(kept_step(*options.out / "run.checkpoint.h5")) : std::nullopt);
}

Run declare_run(CLI::App& command) {
  const auto options = std::make_shared<RunVerb>();
  add_common_options(command, options->common);
  command.add_flag("--resume", options->resume, "go on from the checkpoint in --out");
  command
      .add_option("--begin-from", options->begin_from,
                  "grains in stages: begin with the state in a checkpoint of another run, run.STAGE.checkpoint.h5, "
                  "with which the case agrees until the end of that stage")
      ->type_name("FILE");
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
