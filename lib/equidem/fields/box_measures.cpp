// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/box_measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/fields/spectrum.hpp"

namespace equidem {

void check(const MeasureOptions& options, Body body) {
  if (body == Body::sphere)
    bad_input("the bodies are spheres", "areas of the plane say nothing of their volumes",
              "Remove [measures], or take discs");
  if (!options.region) return;
  const auto& [low, high] = *options.region;
  if (!(low.x < high.x && low.y < high.y))
    bad_input_at("region", "the region has no area", "its lower left corner comes first",
                 "Write it like [0.1, 0.1, 0.9, 0.5]");
}

Vec2 BoxShaking::displacement(double time) const {
  if (time < from) return {};
  return shaking.motion.displacement.at(std::min(time, until) - from) * shaking.direction;
}

BoxMeasures::BoxMeasures(const GrainScene& scene, MeasureOptions options, std::size_t bodies,
                         std::vector<BoxShaking> shakings)
    : scene_(scene),
      options_(std::move(options)),
      start_(box_of(scene.walls, scene.grains, 0)),
      diameter_(equidem::mean_diameter(scene.grains, scene.clumps)),
      throws_(bodies) {
  set_shakings(std::move(shakings));
  if (options_.cell) static_cast<void>(grid_over(start_.inside, *options_.cell));  // refused before the run
  if (options_.columns > 0) return;
  double largest = 0;
  for (const Grain& grain : scene.grains) largest = std::max(largest, grain.radius);
  constexpr double most = 10'000;
  const double fitting = (start_.inside.high.x - start_.inside.low.x) / (4 * largest);
  options_.columns = static_cast<std::size_t>(std::clamp(fitting, 2.0, most));
}

void BoxMeasures::set_shakings(std::vector<BoxShaking> shakings) {
  shakings_ = std::move(shakings);
  shaken_from_ = shakings_.empty() ? 0 : std::ranges::min(shakings_, {}, &BoxShaking::start).start();
}

SurfaceProfile BoxMeasures::empty_profile() const {
  const double width = (start_.inside.high.x - start_.inside.low.x) / static_cast<double>(options_.columns);
  return {.left = start_.inside.low.x, .width = width, .heights = {}};
}

const MeasuredMoment& BoxMeasures::before() const {
  const auto later = std::find_if(moments_.begin() + 1, moments_.end(),
                                  [this](const MeasuredMoment& moment) { return moment.time > shaken_from_; });
  return *(later - 1);
}

void BoxMeasures::restore(std::vector<MeasuredMoment> moments, const std::vector<SurfaceProfile>& profiles,
                          std::vector<std::optional<FirstThrow>> throws) {
  moments_ = std::move(moments);
  before_ = profiles.at(static_cast<std::size_t>(&before() - moments_.data()));
  last_ = profiles.back();
  throws_ = std::move(throws);
}

const MeasuredMoment& BoxMeasures::record(std::int64_t step, double time, const std::vector<Grain>& grains,
                                          const std::vector<std::size_t>& numbers, const std::vector<Wall>& walls) {
  Vec2 moved;
  for (const BoxShaking& shaking : shakings_) moved += shaking.displacement(time);
  const GrainBox box = box_of(walls, grains, time);
  const std::vector<char> heap = heap_of(grains, options_.thrown_gap * diameter_);
  MeasuredMoment moment;
  moment.step = step;
  moment.time = time;
  std::optional<Region> region;
  if (options_.region) {
    region = Region{options_.region->low + moved, options_.region->high + moved};
  } else {
    region = measured_region(grains, scene_.clumps, box, heap);
  }
  if (region) {
    const SolidMeasures solids = measure_solids(grains, scene_.clumps, *region);
    if (solids.solid_fraction > 0) moment.void_ratio = solids.void_ratio;
    moment.porosity = solids.porosity;
  }
  last_ = surface_of(grains, scene_.clumps, start_.inside.low.x + moved.x, start_.inside.high.x + moved.x,
                     options_.columns, heap);
  last_.left = start_.inside.low.x;
  for (double& height : last_.heights) height -= moved.y;
  if (moments_.empty() || time <= shaken_from_) before_ = last_;
  moment.surface = shape_of(last_);
  moment.centre = centre_of_mass(grains) - moved;
  for (std::size_t g = 0; g < grains.size(); ++g) {
    if (!heap[g]) {
      ++moment.thrown;
      if (auto& thrown = throws_[numbers[g]]; !thrown) thrown = FirstThrow{step, time};
    }
    const Vec2 x = grains[g].position;
    const bool in = x.x >= box.inside.low.x && x.x <= box.inside.high.x && x.y >= box.inside.low.y;
    if (!in) ++moment.outside;
  }
  moment.ever_thrown = std::count_if(throws_.begin(), throws_.end(), [](const auto& t) { return t.has_value(); });
  moments_.push_back(moment);
  return moments_.back();
}

Sloshing BoxMeasures::sloshing() const {
  Sloshing result;
  const double width = start_.inside.high.x - start_.inside.low.x;
  const double depth = before().surface.height - start_.inside.low.y, gravity = -scene_.gravity.y;
  if (gravity > 0 && depth > 0 && width > 0) result.theory = sloshing_period(width, depth, gravity);
  // Free motion is preferred to forced motion; two periods of it suffice.
  double end = 0;
  for (const BoxShaking& shaking : shakings_) end = std::max(end, shaking.end());
  const double last = moments_.back().time;
  const bool free = !std::isnan(result.theory) && last - end >= 2 * result.theory;
  result.from = free ? end : before().time;
  std::vector<double> times, slopes;
  for (const MeasuredMoment& moment : moments_) {
    if (moment.time < result.from || std::isnan(moment.surface.slope)) continue;
    times.push_back(moment.time);
    slopes.push_back(moment.surface.slope);
  }
  try {
    constexpr double widest = 4;  // times the theory, and its inverse
    const double lowest = std::isnan(result.theory) ? 0 : 1 / (widest * result.theory);
    const double highest = std::isnan(result.theory) ? INFINITY : widest / result.theory;
    const SpectralPeak peak = spectral_peak(times, slopes, lowest, highest);
    result.period = peak.period();
    result.amplitude = peak.amplitude;
    result.frequency_resolution = peak.resolution;
  } catch (const Error& error) {
    result.missing = error.problem();
  }
  return result;
}

CoarseGrid BoxMeasures::grid_of_fields(const GrainSimulation& simulation) const {
  const GrainBox box = box_of(simulation.placed_walls(), simulation.grains(), simulation.time());
  Region region = box.inside;
  if (!box.lid) {
    region.high.y = -INFINITY;
    for (const double height : last_.heights)
      if (height > region.high.y) region.high.y = height;
  }
  if (!(region.low.x < region.high.x && region.low.y < region.high.y))
    computation_failed("no heap of bodies is left in the box", "the fields are those below its surface",
                       "End the run earlier, or close the box by walls");
  try {
    return grid_over(region, *options_.cell);
  } catch (const Error& error) {
    computation_failed(error.problem(), error.why(), error.remedy());
  }
}

CoarseFields BoxMeasures::fields(const GrainSimulation& simulation, const CoarseGrid& grid) const {
  return coarse_fields(simulation.grains(), scene_.clumps, simulation.body_contacts(), grid);
}

}  // namespace equidem
