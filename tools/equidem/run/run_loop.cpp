// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_loop.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

#include "recurrence.hpp"

namespace equidem {
namespace {

constexpr double look_every = 0.2;  // s of the clock on the wall: progress, interrupts, runaways

class RunLoop {
 public:
  RunLoop(const RunSetup& setup, Simulation& simulation, const RunFiles& files)
      : setup_(setup),
        simulation_(simulation),
        total_(setup.steps()),
        stride_(static_cast<std::int64_t>(
            std::bit_floor(static_cast<std::uint64_t>(std::max<std::int64_t>(1, total_ / 200))))),
        frame_times_(setup.problem.resolved.output.frame_interval, setup.step.step),
        probe_times_(setup.problem.resolved.output.probe_interval, setup.step.step),
        watch_(setup.scene, setup.options,
               {.growth = 100, .critical_step = setup.step.critical, .growth_rate = setup.step.growth_rate}) {
    if (files.folder) open(files);
  }

  RunResult go() {
    look_and_record();
    Progress progress("stepping");
    Stopwatch since_checkpoint;
    const std::int64_t first = simulation_.step();
    std::int64_t chunk = 64;
    while (simulation_.step() < total_) {
      const std::int64_t now = simulation_.step();
      const std::int64_t next = std::min(
          {total_, frame_times_.after(now), probe_times_.after(now), now + stride_ - now % stride_, now + chunk});
      const Stopwatch steps;
      simulation_.advance(next - now);
      const double taken = steps.seconds();
      result_.seconds += taken;
      if (taken < 0.5 * look_every && next - now == chunk) chunk *= 2;
      if (taken > look_every && chunk > 1) chunk /= 2;
      look_and_record();
      try {
        progress.update(static_cast<double>(simulation_.step()) / static_cast<double>(total_));
      } catch (const Error& error) {
        if (error.kind() == ErrorKind::interrupted) save();
        throw;
      }
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
    if (files.resume) go_on(read_checkpoint(folder / "run.checkpoint.h5", setup_.fingerprint()));
    checkpoint_.emplace(folder / "run.checkpoint.h5", setup_.fingerprint(), files.overwrite || files.resume);
    if (resolved.output.frame_interval) {
      const double steps = static_cast<double>(total_);
      const double count = std::min(steps, steps * setup_.step.step / *resolved.output.frame_interval);
      frames_.emplace(
          folder, "frames", assembly,
          FrameOptions{.expected = static_cast<std::int64_t>(count) + 2,
                       .overwrite = files.overwrite,
                       .continue_after = files.resume ? std::optional(last_entry(frame_times_)) : std::nullopt});
    }
    if (resolved.output.probe_interval) {
      probes_ = std::make_unique<ProbeWriter>(
          folder / "history.csv", probes_of(), assembly.size(),
          ProbeOptions{.energy = true,
                       .interval = 5,
                       .overwrite = files.overwrite,
                       .continue_after = files.resume ? std::optional(last_entry(probe_times_)) : std::nullopt});
    }
  }

  /// Samples of a shorter run are more, and at every power of two steps: those of this run are among them, but for the
  /// one at its end.
  void go_on(Checkpoint checkpoint) {
    simulation_.restore(checkpoint.state);
    if (simulation_.step() > total_) {
      bad_input(fmt::format("the run is to end at {:.6g} s, and its checkpoint lies at {:.6g} s",
                            static_cast<double>(total_) * setup_.step.step, simulation_.time()),
                "a run does not go back", "Give a longer duration, or start the run afresh");
    }
    result_.energies = std::move(checkpoint.energies);
    std::erase_if(result_.energies, [&](const EnergySample& sample) { return sample.step % stride_ != 0; });
  }

  /// Where the run goes on: an entry that was made there only because the run ended is dropped.
  [[nodiscard]] std::int64_t last_entry(const Recurrence& times) const {
    return times.at(simulation_.step()) ? simulation_.step() : simulation_.step() - 1;
  }

  [[nodiscard]] std::vector<Probe> probes_of() const {
    std::vector<Probe> probes;
    for (const ProbeCase& wanted : setup_.run().probes) {
      Probe probe{.name = wanted.name, .discs = group(setup_.problem.assembly, wanted.group).discs, .quantities = {}};
      for (const std::string& word : wanted.quantities) {
        if (word != "energy")
          probe.quantities.push_back(enum_from<ProbeQuantity>(word));  // energies have columns of their own
      }
      if (!probe.quantities.empty()) probes.push_back(std::move(probe));
    }
    return probes;
  }

  void look_and_record() {
    const EnergyLedger ledger = simulation_.energy();
    watch_.look(simulation_, ledger);
    record(ledger);
  }

  void record(const EnergyLedger& ledger) {
    const std::int64_t step = simulation_.step();
    const bool fresh = result_.energies.empty() || result_.energies.back().step < step;
    const bool sample = fresh && (step == total_ || step % stride_ == 0);
    const bool frame = frames_ && frames_->last_step() < step && (frame_times_.at(step) || step == total_);
    const bool probe = probes_ && probes_->last_step() < step && (probe_times_.at(step) || step == total_);
    if (sample) result_.energies.push_back({step, simulation_.time(), ledger});
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
    checkpoint_->write(simulation_.save(), result_.energies);
  }

  const RunSetup& setup_;
  Simulation& simulation_;
  std::int64_t total_;
  std::int64_t stride_;  // from one sample of the energies to the next
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
