// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "equidem/casefile/grain_case.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/relaxation.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "command.hpp"
#include "run/run_accuracy.hpp"
#include "run/run_grains.hpp"
#include "run/run_loop.hpp"
#include "run/run_report.hpp"
#include "run/run_setup.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct RunVerb {
  CommonOptions common;
  bool resume = false;
  std::optional<double> accuracy;
};

void check_outputs(const RunVerb& options, const Case& resolved) {
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
  if (resolved.output.csv) plan.expect("discs.csv");
  if (resolved.output.picture) plan.expect("picture.svg");
}

/// Contact forces of small motions, for pictures; of finite ones nothing is drawn but the motion.
std::vector<ContactForce> forces_of(const Problem& problem, const std::vector<DiscMotion>& motions) {
  std::vector<ContactForce> forces(problem.assembly.contacts.size());
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const Contact& contact = problem.assembly.contacts[c];
    forces[c] = linear_spring_force(problem.springs.springs[c],
                                    deformation(frame_of(problem.assembly, c), motions[contact.i], motions[contact.j]));
  }
  return forces;
}

void write_state(const CommonOptions& common, const RunSetup& setup, const std::vector<DiscMotion>& motions,
                 bool overwrite) {
  const Assembly& assembly = setup.problem.assembly;
  const OutputCase& wanted = setup.problem.resolved.output;
  std::vector<ContactForce> forces;
  if (setup.run().motion == LoopKind::Motion::small) forces = forces_of(setup.problem, motions);
  const AssemblyState state{.assembly = assembly, .motions = motions, .contact_forces = forces, .stresses = {}};
  if (wanted.csv) write_disc_csv(*common.out / "discs.csv", state, overwrite);
  if (wanted.vtk) write_vtk(*common.out, "state", state, overwrite);
  if (wanted.picture) {
    const bool far = setup.run().motion == LoopKind::Motion::finite;  // then where it began is worth seeing
    write_picture(*common.out, "picture", state, {.title = setup.problem.resolved.title, .undeformed = far}, overwrite);
  }
}

int dry_run(const CommonOptions& common, const RunSetup& setup) {
  Simulation simulation(setup.simulation());
  std::string report = describe_run_setup(setup, simulation);
  JsonObject object;
  if (!setup.run().until_rest) {
    const double seconds = estimate_seconds(setup, simulation);
    report += describe_estimate(setup, seconds);
    object.set("steps", setup.steps()).set("estimated_seconds", seconds);
    add_time_step(object, setup.step);
  }
  add_common(object, "dry_run", report, setup.problem.times, simulation.effects());
  object.set("bytes_per_disc", simulation.bytes_per_disc());
  CommonOptions without_folder = common;
  without_folder.out.reset();
  deliver(without_folder, report, object);
  return 0;
}

int relax_to_rest(const RunVerb& options, const RunSetup& setup) {
  const CommonOptions& common = options.common;
  if (options.resume) {
    throw Error(ErrorKind::bad_input, "--resume of a run to rest", "it keeps no checkpoints: it ends where it ends",
                "Run it anew");
  }
  const Simulation simulation(setup.simulation());
  StageTimes times = setup.problem.times;
  Stopwatch watch;
  const Relaxation rest = relax(setup.scene, relaxation_options(setup));
  times.add("relaxation", watch.lap());
  if (common.out) write_state(common, setup, rest.motions, common.overwrite);
  const std::string report = describe_run_setup(setup, simulation) + describe_rest(setup, rest, times);
  JsonObject object;
  add_common(object, "at_rest", report, times, simulation.effects());
  add_rest(object, setup, rest);
  if (common.out) write_file(*common.out / "case.toml", to_toml(setup.problem.resolved, *common.out), common.overwrite);
  deliver(common, report, object);
  return 0;
}

/// Makes all steps and delivers what came of them; false, and nothing delivered, where the step that the search
/// proposed is too long.
bool step_through(const RunVerb& options, const RunSetup& setup, StepSearch* search) {
  const CommonOptions& common = options.common;
  Simulation simulation(setup.simulation());
  const RunResult result =
      run_through(setup, simulation, {.folder = common.out, .overwrite = common.overwrite, .resume = options.resume});
  if (search != nullptr && !search->accepts(simulation.motions(), result.seconds)) return false;
  StageTimes times = setup.problem.times;
  times.add("steps", result.seconds);
  const bool overwrite = common.overwrite || options.resume;
  if (common.out) {
    Stopwatch watch;
    write_state(common, setup, simulation.motions(), overwrite);
    write_file(*common.out / "case.toml", to_toml(setup.problem.resolved, *common.out), overwrite);
    write_energy_plot(*common.out, setup, result, overwrite);
    times.add("files", watch.lap());
  }
  std::string report = describe_run_setup(setup, simulation) + describe_run(setup, simulation, result, times);
  JsonObject object;
  if (search != nullptr) report += describe_accuracy(search->reached());
  add_common(object, "done", report, times, simulation.effects());
  add_run(object, setup, simulation, result);
  if (search != nullptr) add_accuracy(object, search->reached());
  CommonOptions delivered = common;
  delivered.overwrite = overwrite;
  deliver(delivered, report, object);
  if (common.out) say(common, fmt::format("written to {}", common.out->string()));
  return true;
}

int run_to_accuracy(RunVerb options, double accuracy) {
  if (options.resume)
    bad_input("--resume and --accuracy exclude each other", "the step is that of the checkpoint",
              "Leave one of them out");
  check_outputs(options, read_case(options.common));
  StepSearch search(options.common, accuracy);
  while (!step_through(options, RunSetup(search.propose()), &search))
    options.common.overwrite = true;  // what the step that was too long has left
  return 0;
}

int run(const RunVerb& options) {
  const CommonOptions& common = options.common;
  refuse_dry_run_with_accuracy(common, options.accuracy.has_value());
  if (describes_grains(common.case_file, common.set)) {
    if (options.accuracy) {
      bad_input(
          "--accuracy does not act on bodies that collide",
          "their motions do not converge by one order with the step: impacts begin and end within it, and many of "
          "them make the motion chaotic",
          "Halve time_step and compare what is measured; 'equidem study collision_laws' shows the error of each "
          "law against the step");
    }
    return run_grains(common, options.resume);
  }
  if (options.accuracy) return run_to_accuracy(options, *options.accuracy);
  Case resolved = read_case(common);
  check_outputs(options, resolved);
  const bool goes_on = options.resume && resolved.run && resolved.run->duration;
  const RunSetup setup(std::move(resolved),
                       goes_on ? std::optional(kept_step(*common.out / "run.checkpoint.h5")) : std::nullopt);
  if (common.dry_run) return dry_run(common, setup);
  if (setup.run().until_rest) return relax_to_rest(options, setup);
  step_through(options, setup, nullptr);
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
