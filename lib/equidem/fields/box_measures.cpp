// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/box_measures.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/neighbours.hpp"

namespace equidem {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Raises the columns that a convex body spans.
class Raised {
 public:
  Raised(SurfaceProfile& profile, double right) : profile_(profile), right_(right) {}

  /// \param ellipse its upper boundary over x: concave, highest at its top, lower to both sides
  void by(const Ellipse& ellipse, Vec2 centre) {
    // y(x) = (c x + sqrt(det (w² - x²)))/w², w the reach along x, from Q = R diag(a², b²) R^T = [w² c; c ..].
    const double p = ellipse.axis.x, q = ellipse.axis.y, aa = ellipse.a * ellipse.a, bb = ellipse.b * ellipse.b;
    const double w2 = aa * p * p + bb * q * q, c = (aa - bb) * p * q, w = std::sqrt(w2);
    const double top = c / std::sqrt(aa * q * q + bb * p * p);  // x of the highest point
    const auto count = static_cast<double>(profile_.heights.size());
    const auto column = [&](double x) {
      return static_cast<std::size_t>(std::clamp((x - profile_.left) / profile_.width, 0.0, count - 1));
    };
    if (centre.x + w <= profile_.left || centre.x - w >= right_) return;
    for (std::size_t k = column(centre.x - w); k <= column(centre.x + w); ++k) {
      const double from = profile_.left + profile_.width * static_cast<double>(k) - centre.x;
      const double x = std::clamp(std::clamp(top, from, from + profile_.width), -w, w);
      const double height = centre.y + (c * x + ellipse.a * ellipse.b * std::sqrt(std::max(0.0, w2 - x * x))) / w2;
      double& highest = profile_.heights[k];
      if (!(highest >= height)) highest = height;
    }
  }

 private:
  SurfaceProfile& profile_;
  double right_;
};

}  // namespace

SurfaceProfile surface_of(std::span<const Grain> grains, std::span<const Clump> clumps, double left, double right,
                          std::size_t columns, std::span<const char> heap) {
  assert(columns >= 1 && left < right && (heap.empty() || heap.size() == grains.size()));
  SurfaceProfile profile{.left = left, .width = (right - left) / static_cast<double>(columns), .heights = {}};
  profile.heights.assign(columns, not_a_number);
  Raised raised(profile, right);
  for (std::size_t g = 0; g < grains.size(); ++g) {
    if (!heap.empty() && !heap[g]) continue;
    const Grain& grain = grains[g];
    if (grain.shape() == GrainShape::clump) {
      const Vec2 axis{std::cos(grain.angle), std::sin(grain.angle)};
      for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs)
        raised.by({disc.radius, disc.radius},
                  grain.position + disc.offset.x * axis + disc.offset.y * perpendicular(axis));
    } else if (grain.shape() == GrainShape::ellipse) {
      raised.by(Ellipse::at_angle(grain.radius, grain.short_half_axis, grain.angle), grain.position);
    } else {
      raised.by({grain.radius, grain.radius}, grain.position);
    }
  }
  return profile;
}

SurfaceShape shape_of(const SurfaceProfile& profile) {
  double n = 0, x_mean = 0, y_mean = 0;
  const auto for_columns = [&](const auto& body) {
    for (std::size_t k = 0; k < profile.heights.size(); ++k)
      if (!std::isnan(profile.heights[k])) body(profile.place(k), profile.heights[k]);
  };
  for_columns([&](double x, double y) {
    n += 1;
    x_mean += x;
    y_mean += y;
  });
  if (n == 0) return {not_a_number, not_a_number, not_a_number};
  x_mean /= n;
  y_mean /= n;
  double xx = 0, xy = 0;
  for_columns([&](double x, double y) {
    xx += (x - x_mean) * (x - x_mean);
    xy += (x - x_mean) * (y - y_mean);
  });
  SurfaceShape shape{.height = y_mean, .slope = xx > 0 ? xy / xx : 0};
  double squares = 0;
  for_columns([&](double x, double y) {
    const double off = y - y_mean - shape.slope * (x - x_mean);
    squares += off * off;
  });
  shape.roughness = std::sqrt(squares / n);
  return shape;
}

std::vector<char> heap_of(std::span<const Grain> grains, double gap) {
  std::vector<Circle> circles;
  for (const Grain& grain : grains) circles.push_back({grain.position, grain.radius});
  const NeighbourList list = neighbours_within(circles, gap);
  std::vector<std::size_t> leader(grains.size());
  std::iota(leader.begin(), leader.end(), std::size_t{0});
  const auto lead = [&](std::size_t k) {
    while (leader[k] != k) k = leader[k] = leader[leader[k]];
    return k;
  };
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (auto at = list.begin[i]; at < list.begin[i + 1]; ++at) {
      const std::size_t a = lead(i), b = lead(static_cast<std::size_t>(list.partner[static_cast<std::size_t>(at)]));
      leader[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::size_t> sizes(grains.size(), 0);
  for (std::size_t k = 0; k < grains.size(); ++k) ++sizes[lead(k)];
  const auto largest = static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<char> heap(grains.size());
  for (std::size_t k = 0; k < grains.size(); ++k) heap[k] = lead(k) == largest ? 1 : 0;
  return heap;
}

Vec2 centre_of_mass(std::span<const Grain> grains) {
  double mass = 0;
  Vec2 sum;
  for (const Grain& grain : grains) {
    mass += grain.inertia.mass;
    sum += grain.inertia.mass * grain.position;
  }
  return sum / mass;
}

namespace {

constexpr double side_strip = 2, surface_strip = 3, least = 2;  // mean diameters

/// Along y for a wall along x; 0: it stands askew.
Vec2 normal_of(const Wall& wall) {
  Vec2 normal = wall.normal;
  if (wall.shape == Wall::Shape::segment) normal = perpendicular(wall.end - wall.point) / norm(wall.end - wall.point);
  constexpr double straight = 1e-9;
  if (std::abs(normal.x) < straight) return {0, 1};
  if (std::abs(normal.y) < straight) return {1, 0};
  return {};
}

}  // namespace

GrainBox box_of(std::span<const Wall> walls, std::span<const Grain> grains, double time) {
  if (grains.empty()) bad_input("a box without grains", "there is nothing to measure", "Add some");
  GrainBox box{.inside = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}}};
  Vec2 middle;
  for (const Grain& grain : grains) {
    box.inside.low = {std::min(box.inside.low.x, grain.position.x - grain.radius),
                      std::min(box.inside.low.y, grain.position.y - grain.radius)};
    box.inside.high = {std::max(box.inside.high.x, grain.position.x + grain.radius),
                       std::max(box.inside.high.y, grain.position.y + grain.radius)};
    middle += grain.position / static_cast<double>(grains.size());
  }
  Rectangle walled{{-INFINITY, -INFINITY}, {INFINITY, INFINITY}};
  for (const Wall& wall : walls) {
    const Vec2 normal = normal_of(wall);
    const Vec2 place = wall.point + wall.displacement(time);
    if (normal.x != 0 && place.x < middle.x) walled.low.x = std::max(walled.low.x, place.x);
    if (normal.x != 0 && place.x >= middle.x) walled.high.x = std::min(walled.high.x, place.x);
    if (normal.y != 0 && place.y < middle.y) walled.low.y = std::max(walled.low.y, place.y);
    if (normal.y != 0 && place.y >= middle.y) walled.high.y = std::min(walled.high.y, place.y);
  }
  box.lid = std::isfinite(walled.high.y);
  const auto put = [](double& side, double wall) {
    if (std::isfinite(wall)) side = wall;
  };
  put(box.inside.low.x, walled.low.x);
  put(box.inside.low.y, walled.low.y);
  put(box.inside.high.x, walled.high.x);
  put(box.inside.high.y, walled.high.y);
  return box;
}

double mean_diameter(std::span<const Grain> grains, std::span<const Clump> clumps) {
  double sum = 0;
  for (const Grain& grain : grains)
    sum +=
        grain.shape() == GrainShape::disc ? 2 * grain.radius : 2 * std::sqrt(area_of(grain, clumps) / std::numbers::pi);
  return sum / static_cast<double>(grains.size());
}

std::optional<Rectangle> measured_region(std::span<const Grain> grains, std::span<const Clump> clumps,
                                         const GrainBox& box, std::span<const char> heap) {
  const double diameter = mean_diameter(grains, clumps);
  const Vec2 strip{side_strip * diameter, side_strip * diameter};
  Rectangle region{box.inside.low + strip, box.inside.high - strip};
  if (!box.lid) {
    double largest = 0;
    for (const Grain& grain : grains) largest = std::max(largest, grain.radius);
    const double width = box.inside.high.x - box.inside.low.x;
    const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>(width / (4 * largest)));
    const SurfaceProfile surface = surface_of(grains, clumps, box.inside.low.x, box.inside.high.x, columns, heap);
    for (const double height : surface.heights) {
      // A column without bodies is open to the floor.
      const double top = std::isnan(height) ? box.inside.low.y : height;
      region.high.y = std::min(region.high.y, top - surface_strip * diameter);
    }
  }
  const Vec2 size = region.high - region.low;
  if (!(size.x >= least * diameter && size.y >= least * diameter)) return {};
  return region;
}

SolidMeasures solid_measures(double covered, const Rectangle& region) {
  SolidMeasures measures{.solid_fraction = covered / region.area()};
  measures.porosity = 1 - measures.solid_fraction;
  measures.void_ratio = measures.porosity / measures.solid_fraction;
  return measures;
}

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
  std::optional<Rectangle> region;
  if (options_.region) {
    region = Rectangle{options_.region->low + moved, options_.region->high + moved};
  } else {
    region = measured_region(grains, scene_.clumps, box, heap);
  }
  if (region) {
    const SolidMeasures solids = solid_measures(clipped_area(grains, scene_.clumps, *region), *region);
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
  Rectangle region = box.inside;
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
