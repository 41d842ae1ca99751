// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/fields/spectrum.hpp"
#include "equidem/grains/scene/shaking.hpp"
#include "equidem/output/pictures/grain_animation.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {
namespace {

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
constexpr double sample_interval = 0.01, frame_interval = 0.04;  // s
/// Kinetic energy of bodies at rest, over the energy of a fall by the smallest radius; bonded pairs keep creeping.
constexpr double resting = 1e-6, creeping = 3e-4;
constexpr double longest_fall = 4, longest_rest = 1.5;  // s

/// The library that draws pictures is not safe for several threads.
std::mutex& drawing() {
  static std::mutex mutex;
  return mutex;
}

/// Measures of a box at a moment; positions relative to the box.
struct Moment {
  double void_ratio = not_measured, whole = not_measured;
  SurfaceShape surface;
  Vec2 centre;
  std::vector<char> heap;
};

Moment measure(const GrainScene& scene, const std::vector<Grain>& grains, double time, double diameter) {
  Moment moment;
  const GrainBox box = box_of(scene.walls, grains, time);
  moment.heap = heap_of(grains, diameter);
  if (const auto region = measured_region(grains, scene.clumps, box, moment.heap))
    moment.void_ratio = measure_solids(grains, scene.clumps, *region).void_ratio;
  const double left = box.inside.low.x, right = box.inside.high.x;
  const auto columns = static_cast<std::size_t>(std::max(2.0, (right - left) / (4 * largest_radius)));
  moment.surface = shape_of(surface_of(grains, scene.clumps, left, right, columns, moment.heap));
  double solid = 0;
  for (std::size_t g = 0; g < grains.size(); ++g) {
    if (moment.heap[g]) solid += area_of(grains[g], scene.clumps);
  }
  moment.whole = (right - left) * moment.surface.height / solid - 1;
  moment.centre = centre_of_mass(grains) - Vec2{left, 0};
  return moment;
}

/// Layer of each grain at the start, 0 to 4, by which it is coloured; the two of a bond in one layer.
std::vector<int> layers_of(const GrainScene& scene) {
  const std::size_t bodies = scene.grains.size() - scene.bonds.size(), grains = scene.bonds.empty() ? 1 : 2;
  std::vector<int> layers;
  for (std::size_t g = 0; g < scene.grains.size(); ++g) layers.push_back(static_cast<int>(5 * (g / grains) / bodies));
  return layers;
}

/// Void ratio as the thesis prints it, and porosity.
std::string density_of(const Outcome& outcome) {
  return fmt::format(", e = {:.3f}, n = {:.2f} %", outcome.whole, 100 * outcome.whole / (1 + outcome.whole));
}

std::string title_of(const Run& run, const std::string& when) {
  std::string text = fmt::format("{}, seed {}", words(plural_of(run.fill.shape)), run.fill.seed);
  if (run.shaking) text += fmt::format(", {:g} gal {:.3g} Hz", run.shaking->gal, run.shaking->frequency);
  return text + ": " + when;
}

/// A simulation, and what the two kinds of it have beyond AnySimulation.
struct Moved {
  std::unique_ptr<AnySimulation> simulation;
  std::function<std::vector<Grain>()> grains;
  std::function<std::vector<GrainContact>()> contacts;
  std::function<BondReport()> bonds;
};

template <class Simulation>
Moved moved_by(std::unique_ptr<Simulation> simulation) {
  const Simulation& kept = *simulation;
  Moved moved;
  moved.simulation = std::move(simulation);
  moved.grains = [&kept] { return kept.grains(); };
  moved.contacts = [&kept] { return kept.contacts(); };
  moved.bonds = [&kept] {
    if constexpr (requires { kept.bonds(); }) return kept.bonds();
    return BondReport{};
  };
  return moved;
}

Moved simulation_of(const GrainScene& scene, const Fill& fill) {
  if (!fill.printed) return moved_by(std::make_unique<GrainSimulation>(scene, options_of(scene, fill)));
  PrintedOptions options = *fill.printed;
  options.damping = fill.damping;
  options.time_step = step_of(scene, fill);
  return moved_by(std::make_unique<PrintedDiscs>(scene, options));
}

/// Filling or shaking of a box.
class BoxRun {
 public:
  BoxRun(const Run& run, GrainScene scene, bool shown, const Folder& folder)
      : run_(run),
        scene_(std::move(scene)),
        moved_(simulation_of(scene_, run.fill)),
        simulation_(*moved_.simulation),
        folder_(folder),
        shown_(shown && folder),
        layers_(layers_of(scene_)),
        followed_(followed(run.fill.grid, run.fill.shape)),
        diameter_(mean_diameter(scene_.grains, scene_.clumps)) {
    for (const Grain& grain : scene_.grains) {
      smallest_ = std::min(smallest_, grain.radius);
      weight_ += grain.inertia.mass * gravity;
    }
    rest_energy_ = (scene_.bonds.empty() ? resting : creeping) * weight_ * smallest_;
    ever_.assign(scene_.grains.size(), 0);
  }

  AnySimulation& simulation() { return simulation_; }

  void start() {
    zero_ = simulation_.time();
    computing_.lap();
    sample();
    first_ = last_;
  }

  /// Advance until the bodies are at rest.
  /// \param from, end s since the start: earliest and latest end
  void until_rest(double from, double end, const std::function<void(double)>& tick) {
    const auto block = std::max<std::int64_t>(1, std::llround(sample_interval / step_of(scene_, run_.fill)));
    while (simulation_.time() - zero_ < end) {
      for (std::int64_t done = 0; done < block; done += 50) {
        simulation_.advance(std::min<std::int64_t>(50, block - done));
        tick(std::min(1.0, (simulation_.time() - zero_) / end));
      }
      sample();
      if (simulation_.time() - zero_ > from && simulation_.energy().kinetic < rest_energy_) return;
    }
  }

  Outcome outcome() {
    Outcome o;
    o.void_ratio_before = first_.void_ratio, o.void_ratio = last_.void_ratio;
    o.whole_before = first_.whole, o.whole = last_.whole;
    o.height_before = first_.surface.height, o.height = last_.surface.height;
    o.roughness_before = first_.surface.roughness, o.roughness = last_.surface.roughness;
    o.centre_before = first_.centre.y, o.centre = last_.centre.y;
    o.slope = slope_;
    o.thrown = static_cast<double>(std::count(ever_.begin(), ever_.end(), 1));
    const auto contacts = moved_.contacts();
    double ends = 0;
    for (const GrainContact& contact : contacts) {
      ends += contact.j >= 0 ? 2 : 1;
      o.overlap = std::max(o.overlap, contact.overlap / smallest_);
    }
    o.coordination = ends / static_cast<double>(scene_.grains.size() - scene_.bonds.size());
    const BondReport bonds = moved_.bonds();
    o.creep = bonds.number > 0 ? bonds.distance.mean : not_measured;
    o.roll = bonds.number > 0 ? bonds.roll.mean : not_measured;
    o.steps = static_cast<double>(simulation_.step());
    o.time = simulation_.time() - zero_;
    o.time_step = step_of(scene_, run_.fill);
    const EnergyLedger energy = simulation_.energy();
    o.energy_error = run_.fill.printed ? not_measured : energy.error() / std::abs(energy.potential);
    movement_.tell(o, run_.fill.grid.width());
    o.seconds = computing_.lap();
    return o;
  }

  /// The history as a table.
  void write(const std::string& name) const {
    if (!folder_) return;
    Table history;
    for (const auto& [column, values] : columns_) history.add(column, values);
    write_csv(*folder_ / "runs" / (name + ".csv"), history, true);
  }

  /// Amplitude of the centre of mass along x in the box at the frequency of shaking, over its last two cycles.
  double swing(const Shaking& shaking) const {
    const std::vector<double>&all_times = columns_[0].second, &all_centres = columns_[3].second;
    std::vector<double> times, centres;
    for (std::size_t k = 0; k < all_times.size(); ++k) {
      const double phase = all_times[k] * shaking.frequency;
      if (phase < static_cast<double>(shaking.cycles - 2) || phase > static_cast<double>(shaking.cycles)) continue;
      times.push_back(all_times[k]);
      centres.push_back(all_centres[k]);
    }
    return times.size() < 8 ? not_measured : amplitude_spectrum(times, centres, std::array{shaking.frequency}).front();
  }

  /// The bodies now. \param when part of the title
  void draw(const std::string& name, const std::string& when) const {
    draw(name, when, moved_.grains(), simulation_.time());
  }
  /// The bodies when their centre of mass was displaced farthest.
  void draw_farthest(const std::string& name, const std::string& when) const {
    if (!farthest_.empty()) draw(name, when, farthest_, farthest_time_);
  }
  void animate(const std::string& name) const {
    if (!folder_ || !run_.animated) return;
    write_grain_animation(*folder_ / (name + ".html"),
                          {.title = title_of(run_, "shaken"),
                           .caption = "Colours: five layers of the grid that the box was filled from.",
                           .shapes = scene_.grains,
                           .clumps = scene_.clumps,
                           .groups = layers_,
                           .walls = scene_.walls,
                           .frames = frames_},
                          true);
  }

 private:
  void draw(const std::string& name, const std::string& when, const std::vector<Grain>& grains, double time) const {
    if (!shown_) return;
    const std::lock_guard lock(drawing());
    write_grain_picture(*folder_, name,
                        {.title = title_of(run_, when),
                         .time = time,
                         .grains = grains,
                         .clumps = scene_.clumps,
                         .groups = layers_,
                         .bonds = scene_.bonds,
                         .walls = scene_.walls},
                        true);
  }

  void sample() {
    const std::vector<Grain> grains = moved_.grains();
    const double time = simulation_.time();
    last_ = measure(scene_, grains, time, diameter_);
    for (std::size_t g = 0; g < grains.size(); ++g)
      if (!last_.heap[g]) ever_[g] = 1;
    if (columns_.empty()) swings_from_ = last_.centre.x;
    slope_ = std::max(slope_, std::abs(last_.surface.slope));
    const double swing = std::abs(last_.centre.x - swings_from_);
    if (shown_ && run_.shaking && swing > farthest_swing_) {
      farthest_swing_ = swing;
      farthest_ = grains;
      farthest_time_ = time;
    }
    movement_.add(grains, box_of(scene_.walls, grains, time).inside.low.x, time - zero_);
    record(grains, time - zero_);
    if (run_.animated && run_.shaking && time - zero_ >= static_cast<double>(frames_.size()) * frame_interval)
      frames_.push_back(frame_of(grains, time));
  }

  void record(const std::vector<Grain>& grains, double time) {
    std::vector<std::pair<std::string, double>> row{
        {"time_s", time},
        {"void_ratio", last_.void_ratio},
        {"whole_void_ratio", last_.whole},
        {"centre_x_m", last_.centre.x},
        {"centre_y_m", last_.centre.y},
        {"slope", last_.surface.slope},
        {"thrown", static_cast<double>(std::count(last_.heap.begin(), last_.heap.end(), 0))}};
    if (shown_) {
      const double left = box_of(scene_.walls, grains, simulation_.time()).inside.low.x;
      for (std::size_t k = 0; k < followed_.size(); ++k) {
        const Grain& grain = grains[followed_[k]];
        row.emplace_back(fmt::format("x{}_m", k), grain.position.x - left);
        row.emplace_back(fmt::format("y{}_m", k), grain.position.y);
        row.emplace_back(fmt::format("angle{}_rad", k), grain.angle - scene_.grains[followed_[k]].angle);
      }
    }
    columns_.resize(row.size());
    for (std::size_t c = 0; c < row.size(); ++c) {
      columns_[c].first = row[c].first;
      columns_[c].second.push_back(row[c].second);
    }
  }

  const Run& run_;
  GrainScene scene_;
  Moved moved_;
  AnySimulation& simulation_;
  const Folder& folder_;
  bool shown_;
  std::vector<int> layers_;
  std::array<std::size_t, 9> followed_;
  double diameter_, smallest_ = INFINITY, weight_ = 0, rest_energy_ = 0, zero_ = 0;
  double slope_ = 0, swings_from_ = 0;
  Moment first_, last_;
  std::vector<char> ever_;
  GrainMovement movement_;
  double farthest_swing_ = -1, farthest_time_ = 0;
  std::vector<Grain> farthest_;
  std::vector<GrainFrame> frames_;
  std::vector<std::pair<std::string, std::vector<double>>> columns_;
  Stopwatch computing_;
};

}  // namespace

FilledBox fill_box(const Fill& fill, bool shown, const Folder& folder, const std::function<void(double)>& tick) {
  const Run run{.fill = fill};
  BoxRun box(run, start_of(fill), shown, folder);
  box.draw(run.name() + "_start", "the start");
  box.start();
  box.until_rest(0.5, longest_fall, tick);
  FilledBox filled{.state = box.simulation().save(), .outcome = box.outcome()};
  Outcome& o = filled.outcome;  // the box was empty before
  o.void_ratio_before = o.whole_before = o.height_before = o.roughness_before = o.slope = o.swing = o.thrown =
      not_measured;
  box.write(run.name());
  box.draw(run.name() + "_filled", "filled, at rest" + density_of(o));
  return filled;
}

Outcome shake_box(const Run& run, const FilledBox& filled, const Folder& folder,
                  const std::function<void(double)>& tick) {
  GrainScene scene = start_of(run.fill);
  const Shaking& shaking = *run.shaking;
  const double start = static_cast<double>(filled.state.step) * step_of(scene, run.fill);
  const double duration = static_cast<double>(shaking.cycles) / shaking.frequency;
  shake(scene.walls, {1, 0}, harmonic_shaking(gal * shaking.gal, shaking.frequency, start, shaking.cycles));
  BoxRun box(run, std::move(scene), run.shown, folder);
  box.simulation().restore(filled.state);
  box.start();
  box.until_rest(duration, duration + longest_rest, tick);
  Outcome outcome = box.outcome();
  outcome.swing = box.swing(shaking);
  outcome.steps -= static_cast<double>(filled.state.step);
  box.write(run.name());
  box.draw_farthest(run.name() + "_during", "largest displacement");
  box.draw(run.name() + "_after", "at rest again" + density_of(outcome));
  box.animate(run.name());
  return outcome;
}

}  // namespace equidem::sukegawa2010
