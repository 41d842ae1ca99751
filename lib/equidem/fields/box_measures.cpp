// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/box_measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"

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
  return shaking.displacement.at(std::min(time, until) - from) * shaking.direction;
}

BoxMeasures::BoxMeasures(const GrainScene& scene, const MeasureOptions& options, std::vector<BoxShaking> shakings)
    : scene_(scene),
      options_(options),
      start_(box_of(scene.walls, scene.grains, 0)),
      diameter_(equidem::mean_diameter(scene.grains, scene.clumps)) {
  set_shakings(std::move(shakings));
  if (options_.cell) static_cast<void>(grid_over(start_.inside, *options_.cell));  // refused before the run
  double largest = 0;
  for (const Grain& grain : scene.grains) largest = std::max(largest, grain.radius);
  constexpr double most = 10'000;
  const double fitting = (start_.inside.high.x - start_.inside.low.x) / (4 * largest);
  columns_ = static_cast<std::size_t>(std::clamp(fitting, 2.0, most));
}

void BoxMeasures::set_shakings(std::vector<BoxShaking> shakings) {
  shakings_ = std::move(shakings);
  shaken_from_ = shakings_.empty() ? 0 : std::ranges::min(shakings_, {}, &BoxShaking::start).start();
}

SurfaceProfile BoxMeasures::empty_profile() const {
  const double width = (start_.inside.high.x - start_.inside.low.x) / static_cast<double>(columns_);
  return {.left = start_.inside.low.x, .width = width, .heights = {}};
}

const MeasuredMoment& BoxMeasures::before() const {
  const auto later = std::find_if(moments_.begin() + 1, moments_.end(),
                                  [this](const MeasuredMoment& moment) { return moment.time > shaken_from_; });
  return *(later - 1);
}

void BoxMeasures::restore(std::vector<MeasuredMoment> moments, const std::vector<SurfaceProfile>& profiles) {
  moments_ = std::move(moments);
  before_ = profiles.at(static_cast<std::size_t>(&before() - moments_.data()));
  last_ = profiles.back();
}

const MeasuredMoment& BoxMeasures::record(std::int64_t step, double time, const std::vector<Grain>& grains,
                                          const std::vector<Wall>& walls) {
  Vec2 moved;
  for (const BoxShaking& shaking : shakings_) moved += shaking.displacement(time);
  const GrainBox box = box_of(walls, grains, time);
  const std::vector<char> heap = heap_of(grains, diameter_);
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
  last_ =
      surface_of(grains, scene_.clumps, start_.inside.low.x + moved.x, start_.inside.high.x + moved.x, columns_, heap);
  last_.left = start_.inside.low.x;
  for (double& height : last_.heights) height -= moved.y;
  if (moments_.empty() || time <= shaken_from_) before_ = last_;
  moment.surface = shape_of(last_);
  moment.centre = centre_of_mass(grains) - moved;
  for (const Grain& grain : grains) {
    const Vec2 x = grain.position;
    const bool in = x.x >= box.inside.low.x && x.x <= box.inside.high.x && x.y >= box.inside.low.y;
    if (!in) ++moment.outside;
  }
  moments_.push_back(moment);
  return moments_.back();
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
