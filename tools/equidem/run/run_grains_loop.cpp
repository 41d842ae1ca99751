// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_loop.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <string_view>
#include <utility>

#include "equidem/casefile/echo.hpp"
#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/grain_energy.hpp"
#include "equidem/output/files/grain_frames.hpp"
#include "equidem/output/files/growing_csv.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "recurrence.hpp"

namespace equidem {
namespace {

constexpr double look_every = 0.2;                            // s of the clock on the wall: progress, interrupts
constexpr std::int64_t moments = 200, moments_of_few = 1000;  // of the record, the latter where paths are drawn

/// Tells whether files that a case names are still what they were.
std::string checksum_of(const GrainCase& resolved) {
  Checksum sum;
  for (std::size_t g = 0; g < resolved.scene.grains.size(); ++g) {
    const Grain& grain = resolved.scene.grains[g];
    for (const double value : {grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y,
                               grain.spin, grain.angle, resolved.densities[g], static_cast<double>(grain.kind),
                               grain.short_half_axis, static_cast<double>(grain.clump)})
      sum.add(value);
  }
  for (const GrainBond& bond : resolved.scene.bonds)
    for (const double value :
         {static_cast<double>(bond.i), static_cast<double>(bond.j), bond.normal_dashpot, bond.tangential_dashpot,
          bond.rolling_dashpot, bond.normal_spring, bond.tangential_spring})
      sum.add(value);
  for (const Clump& clump : resolved.scene.clumps)
    for (const Clump::Disc& disc : clump.discs)
      for (const double value : {disc.offset.x, disc.offset.y, disc.radius}) sum.add(value);
  for (const GrainWall& wall : resolved.scene.walls)
    for (const Schedule* schedule : {&wall.move_x, &wall.move_y})
      for (const auto* numbers : {&schedule->times, &schedule->values, &schedule->rates}) sum.add(*numbers);
  return sum.text();
}

void erase(TomlValue& table, std::initializer_list<std::string_view> names) {
  std::erase_if(table.entries,
                [&](const auto& entry) { return std::find(names.begin(), names.end(), entry.first) != names.end(); });
}

std::vector<std::string> history_columns(const GrainCase& resolved) {
  std::vector<std::string> columns{"step", "time_s"};
  for (const GrainProbe& probe : resolved.probes) {
    for (const std::string& quantity : probe.quantities) {
      if (quantity == "position") {
        columns.insert(columns.end(), {probe.name + "_x_m", probe.name + "_y_m"});
      } else if (quantity == "velocity") {
        columns.insert(columns.end(), {probe.name + "_vx_m_per_s", probe.name + "_vy_m_per_s"});
      } else {
        columns.push_back(probe.name + (quantity == "angle" ? "_angle_rad" : "_spin_rad_per_s"));
      }
    }
  }
  for (const std::string& name : grain_energy_columns(resolved.body)) columns.push_back(name);
  return columns;
}

std::vector<double> history_row(const GrainCase& resolved, double time, const std::vector<Grain>& grains,
                                const GrainLedger& ledger) {
  std::vector<double> row{time};
  for (const GrainProbe& probe : resolved.probes) {
    Grain mean;
    for (const std::int32_t number : probe.grains) {
      const Grain& grain = grains[static_cast<std::size_t>(number)];
      mean.position += grain.position;
      mean.velocity += grain.velocity;
      mean.angle += grain.angle;
      mean.spin += grain.spin;
    }
    const auto count = static_cast<double>(probe.grains.size());
    for (const std::string& quantity : probe.quantities) {
      if (quantity == "angle" || quantity == "spin") {
        row.push_back((quantity == "angle" ? mean.angle : mean.spin) / count);
      } else {
        const Vec2 value = (quantity == "position" ? mean.position : mean.velocity) / count;
        row.insert(row.end(), {value.x, value.y});
      }
    }
  }
  for (const double cell : grain_energy_cells(ledger)) row.push_back(cell);
  return row;
}

/// What rounding of positions can make of kinetic energy and of potential.
double rounding_of_energy(const GrainSetup& setup, const std::vector<Grain>& grains) {
  constexpr double rounding = 1e-15;
  double sum = 0;
  for (const Grain& grain : grains) {
    const double lost_way = rounding * norm(grain.position) / setup.step.step;
    sum += grain.inertia.mass *
           (lost_way * lost_way + 1e3 * rounding * norm(setup.resolved.scene.gravity) * norm(grain.position));
  }
  return sum;
}

/// Losses may be counted badly where steps are long; motion out of nothing is no answer at all.
/// \throws Error (computation_failed)
void refuse_made_energy(const GrainSetup& setup, const GrainSimulation& simulation, const GrainLedger& ledger) {
  if (!std::isfinite(ledger.error())) {
    computation_failed(fmt::format("step {}: an energy is not a number any more", simulation.step()),
                       "squares of speeds, or stiffnesses, are beyond all numbers", "Use smaller ones");
  }
  constexpr double most = 4;
  const double given = ledger.initial + std::abs(ledger.work_of_walls) + std::abs(ledger.potential);
  if (ledger.kinetic <= most * given) return;
  if (ledger.kinetic <= most * (given + rounding_of_energy(setup, simulation.grains()))) return;
  computation_failed(
      fmt::format("step {}: the bodies move with {:.3g} times the energy that there was", simulation.step(),
                  ledger.kinetic / given),
      "contacts make energy where steps are too long for them, and maps where several act on a body at once",
      "Use a shorter time_step, or the law exact_flow");
}

class GrainLoop {
 public:
  GrainLoop(const GrainSetup& setup, GrainSimulation& simulation, const GrainFiles& files, GrainMeasures* measures)
      : setup_(setup),
        simulation_(simulation),
        measures_(measures),
        draws_paths_(setup.resolved.scene.grains.size() <= most_drawn_paths),
        stride_(static_cast<std::int64_t>(std::bit_floor(static_cast<std::uint64_t>(
            std::max<std::int64_t>(1, setup.steps / (draws_paths_ ? moments_of_few : moments)))))),
        frame_times_(setup.resolved.output.frame_interval, setup.step.step),
        probe_times_(setup.resolved.output.probe_interval, setup.step.step) {
    if (files.folder) open(files);
  }

  GrainRun go() {
    if (simulation_.step() == 0) write_due();
    Progress progress("stepping");
    Stopwatch since_checkpoint;
    const std::int64_t first = simulation_.step();
    std::int64_t chunk = 64;
    while (simulation_.step() < setup_.steps) {
      const std::int64_t now = simulation_.step();
      const std::int64_t next = std::min(
          {setup_.steps, frame_times_.after(now), probe_times_.after(now), now + stride_ - now % stride_, now + chunk});
      const Stopwatch steps;
      keep_what_was_reached([&] { simulation_.advance(next - now); });
      const double taken = steps.seconds();
      result_.seconds += taken;
      if (taken < 0.5 * look_every && next - now == chunk) chunk *= 2;
      if (taken > look_every && chunk > 1) chunk /= 2;
      write_due();
      try {
        progress.update(static_cast<double>(simulation_.step()) / static_cast<double>(setup_.steps));
      } catch (const Error&) {
        save();
        throw;
      }
      if (checkpoint_ && since_checkpoint.seconds() > setup_.resolved.output.checkpoint_interval) {
        save();
        since_checkpoint.lap();
      }
    }
    save();
    close();
    result_.steps_done = simulation_.step() - first;
    return std::move(result_);
  }

 private:
  /// \throws Error of the work, with the line of the step
  template <class Work>
  void keep_what_was_reached(const Work& work) {
    try {
      work();
    } catch (const Error& error) {
      save();
      close();
      throw error.at(setup_.resolved.where("run.time_step"));
    }
  }

  void open(const GrainFiles& files) {
    const std::filesystem::path& folder = *files.folder;
    const GrainCase& resolved = setup_.resolved;
    const std::filesystem::path path = folder / "run.checkpoint.h5";
    std::optional<std::int64_t> after;
    if (files.resume) {
      GrainCheckpoint checkpoint = read_grain_checkpoint(path, setup_.fingerprint(), resolved.scene.grains);
      after = checkpoint.state.step;
      if (*after > setup_.steps) {
        bad_input(fmt::format("the checkpoint '{}' lies past the end of the run", path.string()),
                  fmt::format("it is at step {}, the run has {}", *after, setup_.steps),
                  "Give a longer duration, or start the run afresh");
      }
      simulation_.restore(checkpoint.state);
      result_.record = std::move(checkpoint.record);
    }
    checkpoint_.emplace(path, setup_.fingerprint(), files.overwrite || files.resume);
    if (resolved.output.frame_interval) {
      const double steps = static_cast<double>(setup_.steps);
      const double count = std::min(steps, steps * setup_.step.step / *resolved.output.frame_interval);
      frames_ = std::make_unique<GrainFrames>(
          folder, "frames", resolved.scene.grains, resolved.scene.clumps,
          FrameOptions{
              .expected = static_cast<std::int64_t>(count) + 2, .overwrite = files.overwrite, .continue_after = after});
    }
    if (measures_ != nullptr) measures_->open(folder, files.overwrite, after);
    if (resolved.output.probe_interval) {
      history_ = std::make_unique<GrowingCsv>(folder / "history.csv", history_columns(resolved),
                                              GrowingCsvOptions{.overwrite = files.overwrite, .continue_after = after});
    }
  }

  void write_due() {
    const std::int64_t step = simulation_.step();
    const bool last = step == setup_.steps;
    auto& energies = result_.record.energies;
    const bool sample = (energies.empty() || energies.back().step < step) && (last || step % stride_ == 0);
    const bool frame = frames_ && frames_->last_step() < step && (frame_times_.at(step) || last);
    const bool row = history_ && history_->last_step() < step && (probe_times_.at(step) || last);
    const bool measured = measures_ != nullptr && measures_->last_step() < step && (probe_times_.at(step) || last);
    if (!sample && !frame && !row && !measured) return;
    const GrainLedger ledger = simulation_.energy();
    keep_what_was_reached([&] { refuse_made_energy(setup_, simulation_, ledger); });
    const double time = simulation_.time();
    const bool path = sample && draws_paths_;
    if (sample) energies.push_back({step, time, ledger});
    if (!path && !frame && !row && !measured) return;
    const std::vector<Grain> grains = simulation_.grains();
    if (path) {
      auto& places = result_.record.paths.emplace_back();
      for (const Grain& grain : grains) places.push_back(grain.position);
    }
    if (frame) frames_->append(step, time, grains);
    if (row) history_->add(step, history_row(setup_.resolved, time, grains, ledger));
    if (measured) measures_->record(step, time, grains);
  }

  /// Everything that the checkpoint counts on is on the disk before it is.
  void save() {
    if (!checkpoint_) return;
    if (history_) history_->sync();
    if (frames_) frames_->sync();
    if (measures_ != nullptr) measures_->sync();
    write_grain_checkpoint(*checkpoint_, simulation_.save(), result_.record);
  }

  void close() {
    if (frames_) frames_->finish();
    if (history_) history_->flush();
  }

  const GrainSetup& setup_;
  GrainSimulation& simulation_;
  GrainMeasures* measures_;
  bool draws_paths_;
  std::int64_t stride_;  ///< steps from one moment of the record to the next
  Recurrence frame_times_, probe_times_;
  std::optional<CheckpointWriter> checkpoint_;
  std::unique_ptr<GrainFrames> frames_;
  std::unique_ptr<GrowingCsv> history_;
  GrainRun result_;
};

/// What moves faster than steps can follow.
void check_events(const GrainCase& resolved, const GrainTimeStep& step) {
  constexpr double most = 0.5;
  for (std::size_t k = 0; k < resolved.scene.walls.size(); ++k) {
    for (const Schedule* schedule : {&resolved.scene.walls[k].move_x, &resolved.scene.walls[k].move_y}) {
      const MissedEvent missed = missed_event(*schedule, step.step, resolved.duration);
      if (missed.share <= most) continue;
      throw Error(
          ErrorKind::bad_input,
          fmt::format("its schedule has an event at {:.6g} s that steps of {:.6g} s miss", missed.time, step.step),
          fmt::format("between two steps lie {:.0f} % of the range of its values", 100 * missed.share),
          "Give a time_step well below its length, or let it last longer",
          resolved.where(fmt::format("wall.{}.schedule", k)));
    }
  }
}

}  // namespace

GrainSetup::GrainSetup(GrainCase given)
    : resolved(std::move(given)), step(choose_grain_step(resolved)), steps(count_steps(resolved, step.step)) {
  check_events(resolved, step);
}

GrainSimulation GrainSetup::simulation() const {
  const GrainScene scene = build_grain_scene(resolved, step.step);
  const GrainOptions options = grain_options(resolved, step.step);
  try {
    check(scene, options, [this](std::size_t grain) { return resolved.where_grain(grain); });
  } catch (const Error& error) {
    throw error.at(resolved.where("collisions"));
  }
  return {scene, options};
}

std::string GrainSetup::fingerprint() const {
  TomlValue known = resolved.document;
  erase(*known.find("run"), {"duration", "time_step", "steps_per_contact"});  // the step is below
  erase(known, {"title", "output", "probe", "measures"});
  return to_toml(std::move(known), {}) + fmt::format("\n# step {} s\n# checksum of grains and schedules {}\n",
                                                     toml_number(step.step), checksum_of(resolved));
}

GrainRun run_through(const GrainSetup& setup, GrainSimulation& simulation, const GrainFiles& files,
                     GrainMeasures* measures) {
  return GrainLoop(setup, simulation, files, measures).go();
}

}  // namespace equidem
