// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_loop.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double look_every = 0.2;  // s of the clock on the wall: progress, interrupts, runaways

/// Steps at which something happens every so many seconds of the run, each the nearest to its time; never where there
/// is no interval.
class Recurrence {
 public:
  Recurrence(std::optional<double> interval, double step) : interval_(interval.value_or(0) / step) {}
  /// The first such step after `step`.
  [[nodiscard]] std::int64_t after(std::int64_t step) const {
    if (!(interval_ > 0)) return never;
    if (interval_ <= 1) return step + 1;
    const double turn = std::ceil((static_cast<double>(step) + 0.5) / interval_ - 1e-9);
    const double next = std::floor(turn * interval_ + 0.5);
    if (next >= 1e18) return never;
    if (next > static_cast<double>(step)) return static_cast<std::int64_t>(next);
    return static_cast<std::int64_t>(std::floor((turn + 1) * interval_ + 0.5));
  }
  [[nodiscard]] bool at(std::int64_t step) const { return step == 0 || (step > 0 && after(step - 1) == step); }
  static constexpr std::int64_t never = INT64_MAX;

 private:
  double interval_;
};

class RunLoop {
 public:
  RunLoop(const RunSetup& setup, Simulation& simulation, const RunFiles& files)
      : setup_(setup),
        simulation_(simulation),
        total_(setup.steps()),
        frame_times_(setup.problem.resolved.output.frame_interval, setup.step.step),
        probe_times_(setup.problem.resolved.output.probe_interval, setup.step.step),
        watch_(setup.scene, setup.options,
               {.growth = 100, .critical_step = setup.step.critical, .growth_rate = setup.step.growth_rate}) {
    if (files.folder) open(files);
  }

  RunResult go() {
    if (simulation_.step() == 0) record();
    Progress progress("stepping");
    Stopwatch since_checkpoint;
    const std::int64_t first = simulation_.step();
    std::int64_t chunk = 64;
    while (simulation_.step() < total_) {
      const std::int64_t now = simulation_.step();
      const std::int64_t next = std::min(
          {total_, frame_times_.after(now), probe_times_.after(now),
           now + std::max<std::int64_t>(1, total_ / 200 - now % std::max<std::int64_t>(1, total_ / 200)), now + chunk});
      const Stopwatch steps;
      simulation_.advance(next - now);
      const double taken = steps.seconds();
      result_.seconds += taken;
      if (taken < 0.5 * look_every && next - now == chunk) chunk *= 2;
      if (taken > look_every && chunk > 1) chunk /= 2;
      try {
        watch_.look(simulation_);
        progress.update(static_cast<double>(simulation_.step()) / static_cast<double>(total_));
      } catch (const Error& error) {
        if (error.kind() == ErrorKind::interrupted) {
          record();
          save();
        }
        throw;
      }
      record();
      if (checkpoint_ && since_checkpoint.seconds() > setup_.problem.resolved.output.checkpoint_interval) {
        save();
        since_checkpoint.lap();
      }
    }
    save();
    if (frames_) frames_->finish();
    if (probes_) probes_->flush();
    result_.steps_done = simulation_.step() - first;
    return std::move(result_);
  }

 private:
  void open(const RunFiles& files) {
    const std::filesystem::path& folder = *files.folder;
    const Case& resolved = setup_.problem.resolved;
    const Assembly& assembly = setup_.problem.assembly;
    std::optional<std::int64_t> after;
    if (files.resume) {
      const SimulationState state = read_checkpoint(folder / "run.checkpoint.h5", setup_.fingerprint());
      simulation_.restore(state);
      after = state.step;
    }
    checkpoint_.emplace(folder / "run.checkpoint.h5", setup_.fingerprint(), files.overwrite || files.resume);
    if (resolved.output.frame_interval) {
      const double steps = static_cast<double>(total_);
      const double count = std::min(steps, steps * setup_.step.step / *resolved.output.frame_interval);
      frames_.emplace(
          folder, "frames", assembly,
          FrameOptions{
              .expected = static_cast<std::int64_t>(count) + 2, .overwrite = files.overwrite, .continue_after = after});
    }
    if (resolved.output.probe_interval) {
      probes_ = std::make_unique<ProbeWriter>(
          folder / "history.csv", probes_of(), assembly.size(),
          ProbeOptions{.energy = true, .interval = 5, .overwrite = files.overwrite, .continue_after = after});
    }
  }

  [[nodiscard]] std::vector<Probe> probes_of() const {
    std::vector<Probe> probes;
    for (const ProbeCase& wanted : setup_.run().probes) {
      Probe probe{.name = wanted.name, .discs = group(setup_.problem.assembly, wanted.group).discs, .quantities = {}};
      for (const std::string& word : wanted.quantities) {
        if (word != "energy")
          probe.quantities.push_back(probe_quantity_from(word));  // energies have columns of their own
      }
      if (!probe.quantities.empty()) probes.push_back(std::move(probe));
    }
    return probes;
  }

  void record() {
    const std::int64_t step = simulation_.step();
    const bool sample = step == 0 || step == total_ || step % std::max<std::int64_t>(1, total_ / 200) == 0;
    const bool frame = frames_ && frames_->last_step() < step && (frame_times_.at(step) || step == total_);
    const bool probe = probes_ && probes_->last_step() < step && (probe_times_.at(step) || step == total_);
    if (!sample && !frame && !probe) return;
    const EnergyLedger ledger = simulation_.energy();
    if (sample) result_.energies.push_back({simulation_.time(), ledger});
    if (!frame && !probe) return;
    const std::vector<DiscMotion> motions = simulation_.motions(), velocities = simulation_.velocities();
    if (frame) frames_->append(step, simulation_.time(), motions, velocities);
    if (probe) probes_->record(step, simulation_.time(), motions, velocities, ledger);
  }

  /// Everything that the checkpoint counts on is on the disk before it is.
  void save() {
    if (!checkpoint_) return;
    if (probes_) probes_->sync();
    if (frames_) frames_->sync();
    checkpoint_->write(simulation_.save());
  }

  const RunSetup& setup_;
  Simulation& simulation_;
  std::int64_t total_;
  Recurrence frame_times_, probe_times_;
  RunawayWatch watch_;
  std::optional<CheckpointWriter> checkpoint_;
  std::optional<FrameWriter> frames_;
  std::unique_ptr<ProbeWriter> probes_;
  RunResult result_;
};

}  // namespace

RunResult run_through(const RunSetup& setup, Simulation& simulation, const RunFiles& files) {
  return RunLoop(setup, simulation, files).go();
}

}  // namespace equidem
