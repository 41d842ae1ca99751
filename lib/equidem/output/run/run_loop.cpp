// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/run/run_loop.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double look_every = 0.2;  // s of wall-clock time: progress, interrupts, runaways

Error placed(const Error& error, const RunPlan& plan) {
  return plan.step_place.empty() ? error : error.at(plan.step_place);
}

class RunLoop {
 public:
  RunLoop(AnySimulation& simulation, const RunPlan& plan, const RunFiles& files, RunResult& result)
      : simulation_(simulation),
        plan_(plan),
        stride_(static_cast<std::int64_t>(
            std::bit_floor(static_cast<std::uint64_t>(std::max<std::int64_t>(1, plan.steps / plan.samples))))),
        frame_times_(plan.frame_interval, plan.time_step),
        probe_times_(plan.probe_interval, plan.time_step),
        files_(files),
        result_(result) {
    if (files.folder) open(files);
  }

  void go() {
    look();
    if (!files_.resume) save();   // a run that is killed before the next one goes on, too
    step_to(simulation_.step());  // what can never go on says so
    Progress progress("stepping");
    Stopwatch since_checkpoint;
    const std::int64_t first = simulation_.step();
    std::int64_t chunk = 64;
    while (simulation_.step() < plan_.steps && !simulation_.over()) {
      const std::int64_t now = simulation_.step();
      const std::int64_t next = std::min(
          {plan_.steps, frame_times_.after(now), probe_times_.after(now), now + stride_ - now % stride_, now + chunk});
      const Stopwatch steps;
      step_to(next);
      const double taken = steps.seconds();
      result_.steps_done = simulation_.step() - first;
      result_.seconds += taken;
      if (taken < 0.5 * look_every && next - now == chunk) chunk *= 2;
      if (taken > look_every && chunk > 1) chunk /= 2;
      look();
      if (simulation_.milestone() >= 0 && !simulation_.over()) keep();
      try {
        progress.update(static_cast<double>(simulation_.step()) / static_cast<double>(plan_.steps));
      } catch (const Error&) {
        save();
        throw;
      }
      if (checkpoint_ && since_checkpoint.seconds() > plan_.checkpoint_interval) {
        save();
        since_checkpoint.lap();
      }
    }
    save();
    close();
  }

 private:
  void open(const RunFiles& files) {
    const std::filesystem::path path = *files.folder / "run.checkpoint.h5";
    std::optional<Checkpoint> from;
    if (files.resume) from = go_on(path);
    checkpoint_.emplace(path, plan_.case_text, files.overwrite || files.resume);
    const auto mark_of = [&](const char* name) { return from ? std::optional(from->mark_of(name)) : std::nullopt; };
    // Tables are opened first, because they change with their first row, frames at once: a refusal changes no file.
    if (plan_.recorder != nullptr) plan_.recorder->open(*files.folder, files.overwrite, from ? &*from : nullptr);
    if (plan_.probe_interval) {
      const std::size_t bodies = simulation_.motions().size();
      history_.emplace(*files.folder / "history.csv", plan_.probes, bodies,
                       ProbeOptions{.family = simulation_.family(),
                                    .body = plan_.body,
                                    .walls = plan_.walls,
                                    .cell = plan_.cell,
                                    .overwrite = files.overwrite,
                                    .continue_from = mark_of("history.csv")});
    }
    if (plan_.frame_interval) {
      FrameOptions options = plan_.frames;
      options.overwrite = files.overwrite;
      options.continue_from = mark_of("frames.pvd");
      frames_.emplace(*files.folder, "frames", *plan_.frame_discs, options);
    }
  }

  /// Samples of a shorter run are more, and at every power of two steps: those of this run are among them, but for the
  /// one at its end.
  Checkpoint go_on(const std::filesystem::path& path) {
    Checkpoint checkpoint = read_checkpoint(path, plan_.case_text);
    simulation_.restore(checkpoint.state);
    if (simulation_.step() > plan_.steps) {
      bad_input(fmt::format("the run is to end at {:.6g} s, and its checkpoint lies at {:.6g} s",
                            static_cast<double>(plan_.steps) * plan_.time_step, simulation_.time()),
                "a run does not go back", "Give a longer duration, or start the run afresh");
    }
    RunRecord& record = checkpoint.record;
    for (std::size_t k = 0; k < record.energies.size(); ++k) {
      if (record.energies[k].step % stride_ != 0) continue;
      result_.record.energies.push_back(record.energies[k]);
      if (!record.paths.empty()) result_.record.paths.push_back(std::move(record.paths[k]));
    }
    for (FilmFrame& frame : record.film)
      if (is_filmed(frame.step)) result_.record.film.push_back(std::move(frame));
    return checkpoint;
  }

  [[nodiscard]] bool is_filmed(std::int64_t step) const {
    if (plan_.film_frames == 0) return false;
    const std::int64_t samples = plan_.steps / stride_ + 1;
    const std::int64_t samples_between = (samples + plan_.film_frames - 1) / plan_.film_frames;
    return step % (stride_ * samples_between) == 0;
  }

  [[nodiscard]] std::vector<Vec2> places_of(const std::vector<WallState>& walls) const {
    std::vector<Vec2> places;
    for (const std::string& name : plan_.walls) {
      const auto found = std::ranges::find(walls, name, &WallState::name);
      places.push_back(found == walls.end() ? Vec2{NAN, NAN} : found->place);
    }
    return places;
  }

  void step_to(std::int64_t step) {
    try {
      simulation_.advance(step - simulation_.step());
    } catch (const Error& error) {
      save();
      fail(error);
    } catch (...) {
      close();
      throw;
    }
  }

  [[noreturn]] void fail(const Error& error) {
    close();
    throw placed(error, plan_);
  }

  void look() {
    const std::int64_t step = simulation_.step();
    const bool last = step == plan_.steps || simulation_.over(), stage_ends = simulation_.milestone() >= 0;
    auto& energies = result_.record.energies;
    const bool regular_frame = frame_times_.at(step) || (stage_ends && !last);
    const bool regular_row = probe_times_.at(step) || (stage_ends && !last);
    const bool probing = regular_row || last;
    const bool sample = (energies.empty() || energies.back().step < step) && (last || step % stride_ == 0);
    const bool frame = frames_ && frames_->last_step() < step && (regular_frame || last);
    const bool row = history_ && history_->last_step() < step && probing;
    const bool recorded = plan_.recorder != nullptr && plan_.recorder->last_step() < step && probing;
    auto& film = result_.record.film;
    const bool filmed = plan_.film_frames > 0 && (last || is_filmed(step)) && (film.empty() || film.back().step < step);
    if (!plan_.watch_between && !stage_ends && !sample && !frame && !row && !recorded && !filmed) return;
    const EnergyLedger ledger = simulation_.energy();
    try {
      if (plan_.watch) plan_.watch(ledger);
    } catch (const Error& error) {
      fail(error);
    }
    const double time = simulation_.time();
    if (sample) energies.push_back({step, time, ledger});
    if (recorded) plan_.recorder->record(step, time, regular_row);
    const bool path = sample && plan_.paths;
    if (!path && !frame && !row && !filmed) return;
    const std::vector<DiscMotion> motions = simulation_.motions(), velocities = simulation_.velocities();
    const std::vector<WallState> walls = simulation_.walls();
    if (filmed) film.push_back({step, time, motions, places_of(walls)});
    if (path) {
      auto& places = result_.record.paths.emplace_back();
      for (const DiscMotion& motion : motions) places.push_back(motion.u);
    }
    if (frame) {
      const auto contacts = plan_.frames.contacts ? simulation_.body_contacts() : std::vector<BodyContact>();
      frames_->append(step, time, motions, velocities, contacts, regular_frame);
    }
    if (row) {
      const auto cell = plan_.cell ? simulation_.cell() : std::nullopt;
      const auto contacts =
          std::ranges::any_of(plan_.probes, has_stress) ? simulation_.body_contacts() : std::vector<BodyContact>();
      history_->record(step, time, motions, velocities, walls, ledger, regular_row, cell, contacts);
    }
  }

  /// Everything that the checkpoint counts on is on the disk before it is.
  void save() {
    if (checkpoint_) checkpoint_->write(checkpoint());
  }

  /// At the end of a stage. Its own checkpoint comes first: a run that is killed in between goes on from before the
  /// end.
  void keep() {
    if (!checkpoint_) return;
    const std::filesystem::path path = *files_.folder / fmt::format("run.{}.checkpoint.h5", plan_.milestone_name());
    CheckpointWriter(path, plan_.case_text, files_.overwrite || files_.resume).write(checkpoint());
    save();
  }

  Checkpoint checkpoint() {
    Checkpoint checkpoint{simulation_.save(), result_.record};
    if (history_) {
      history_->sync();
      checkpoint.files.push_back(history_->mark());
    }
    if (frames_) {
      frames_->sync();
      checkpoint.files.push_back(frames_->mark());
    }
    if (plan_.recorder != nullptr) plan_.recorder->save(checkpoint);
    return checkpoint;
  }

  void close() {
    if (frames_) frames_->finish();
    if (history_) history_->flush();
  }

  AnySimulation& simulation_;
  const RunPlan& plan_;
  std::int64_t stride_;  ///< steps from one sample of the energies to the next
  Recurrence frame_times_, probe_times_;
  const RunFiles& files_;
  std::optional<CheckpointWriter> checkpoint_;
  std::optional<FrameWriter> frames_;
  std::optional<ProbeWriter> history_;
  RunResult& result_;
};

}  // namespace

void run_through(AnySimulation& simulation, const RunPlan& plan, const RunFiles& files, RunResult& result) {
  RunLoop(simulation, plan, files, result).go();
}

double estimate_seconds(AnySimulation& simulation, const RunPlan& plan) {
  constexpr double enough = 0.05;  // s of wall-clock time
  for (std::int64_t steps = 1;; steps *= 4) {
    steps = std::min(steps, plan.steps - simulation.step());
    if (steps <= 0) return 0;
    const Stopwatch watch;
    try {
      simulation.advance(steps);
    } catch (const Error& error) {
      throw placed(error, plan);
    }
    const double seconds = watch.seconds();
    if (seconds > enough || simulation.step() == plan.steps || simulation.over())
      return seconds / static_cast<double>(steps) * static_cast<double>(plan.steps);
  }
}

}  // namespace equidem
