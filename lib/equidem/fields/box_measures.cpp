// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/fields/box_measures.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/neighbours.hpp"

namespace equidem {

namespace {

/// Raises the columns that a convex body spans.
/// \param ellipse its upper boundary over x: concave, highest at its top, lower to both sides
void raise(SurfaceProfile& profile, double right, const Ellipse& ellipse, Vec2 centre) {
  // y(x) = (c x + sqrt(det (w² - x²)))/w², w the reach along x, from Q = R diag(a², b²) R^T = [w² c; c ..].
  const double p = ellipse.axis.x, q = ellipse.axis.y, aa = ellipse.a * ellipse.a, bb = ellipse.b * ellipse.b;
  const double w2 = aa * p * p + bb * q * q, c = (aa - bb) * p * q, w = std::sqrt(w2);
  const double top = c / std::sqrt(aa * q * q + bb * p * p);  // x of the highest point
  const auto count = static_cast<double>(profile.heights.size());
  if (centre.x + w <= profile.left || centre.x - w >= right) return;
  const auto column = [&](double x) {
    return static_cast<std::size_t>(std::clamp((x - profile.left) / profile.width, 0.0, count - 1));
  };
  for (std::size_t k = column(centre.x - w); k <= column(centre.x + w); ++k) {
    const double from = profile.left + profile.width * static_cast<double>(k) - centre.x;
    const double x = std::clamp(std::clamp(top, from, from + profile.width), -w, w);
    const double height = centre.y + (c * x + ellipse.a * ellipse.b * std::sqrt(std::max(0.0, w2 - x * x))) / w2;
    double& highest = profile.heights[k];
    if (!(highest >= height)) highest = height;
  }
}

}  // namespace

SurfaceProfile surface_of(std::span<const Grain> grains, std::span<const Clump> clumps, double left, double right,
                          std::size_t columns, std::span<const char> heap) {
  assert(columns >= 1 && left < right && (heap.empty() || heap.size() == grains.size()));
  SurfaceProfile profile{.left = left, .width = (right - left) / static_cast<double>(columns), .heights = {}};
  profile.heights.assign(columns, not_measured);
  for (std::size_t g = 0; g < grains.size(); ++g) {
    if (!heap.empty() && !heap[g]) continue;
    const Outline outline = outline_of(grains[g], clumps);
    for (std::size_t p = 0; p < outline.parts(); ++p)
      raise(profile, right, outline.part(p), grains[g].position + outline.offset(p));
  }
  return profile;
}

SurfaceShape shape_of(const SurfaceProfile& profile) {
  double n = 0;
  Vec2 mean;
  const auto for_columns = [&](const auto& body) {
    for (std::size_t k = 0; k < profile.heights.size(); ++k)
      if (!std::isnan(profile.heights[k])) body(Vec2{profile.place(k), profile.heights[k]});
  };
  for_columns([&](Vec2 place) {
    n += 1;
    mean += place;
  });
  if (n == 0) return {not_measured, not_measured, not_measured};
  mean = {mean.x / n, mean.y / n};
  double xx = 0, xy = 0;
  for_columns([&](Vec2 place) {
    xx += (place.x - mean.x) * (place.x - mean.x);
    xy += (place.x - mean.x) * (place.y - mean.y);
  });
  SurfaceShape shape{.height = mean.y, .slope = xx > 0 ? xy / xx : 0};
  double squares = 0;
  for_columns([&](Vec2 place) {
    const double off = place.y - mean.y - shape.slope * (place.x - mean.x);
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
      const std::size_t a = lead(i), b = lead(static_cast<std::size_t>(list.partner[at]));
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
    const Vec2 x = grain.position;
    box.inside.low = {std::min(box.inside.low.x, x.x - grain.radius), std::min(box.inside.low.y, x.y - grain.radius)};
    box.inside.high = {std::max(box.inside.high.x, x.x + grain.radius),
                       std::max(box.inside.high.y, x.y + grain.radius)};
    middle += x / static_cast<double>(grains.size());
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
  const auto wall_or = [](double wall, double side) { return std::isfinite(wall) ? wall : side; };
  box.inside.low = {wall_or(walled.low.x, box.inside.low.x), wall_or(walled.low.y, box.inside.low.y)};
  box.inside.high = {wall_or(walled.high.x, box.inside.high.x), wall_or(walled.high.y, box.inside.high.y)};
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

void check_area(const Rectangle& region, const char* name) {
  const Vec2 sides = region.high - region.low;
  if (sides.x > 0 && sides.y > 0) return;
  bad_input(fmt::format("the {} is {} m wide and {} m high", name, sides.x, sides.y), "it has no area",
            "Give its lower left corner first");
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
  std::optional<Rectangle> region = options_.region;
  if (region) *region = {region->low + moved, region->high + moved};
  if (!region) region = measured_region(grains, scene_.clumps, box, heap);
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
  const GrainBox box = box_of(simulation.placed_walls(), simulation.present_grains(), simulation.time());
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

namespace {

std::optional<std::size_t> cell_at(const CoarseGrid& grid, Vec2 place) {
  const Vec2 size = grid.cell_size(), way = place - grid.region.low;
  const double column = std::floor(way.x / size.x), row = std::floor(way.y / size.y);
  if (!(column >= 0 && row >= 0 && column < static_cast<double>(grid.columns) && row < static_cast<double>(grid.rows)))
    return {};
  return static_cast<std::size_t>(row) * grid.columns + static_cast<std::size_t>(column);
}

/// Shares of a way at which it crosses the lines of the grid along one axis.
void add_crossings(double from, double way, double low, double width, std::size_t lines, std::vector<double>& shares) {
  if (way == 0) return;
  const double a = (std::min(from, from + way) - low) / width, b = (std::max(from, from + way) - low) / width;
  const double first = std::max(0.0, std::ceil(a)), last = std::min(static_cast<double>(lines), b);
  for (std::size_t n = 0; first + static_cast<double>(n) <= last; ++n) {
    const double k = first + static_cast<double>(n);
    const double share = (low + k * width - from) / way;
    if (share > 0 && share < 1) shares.push_back(share);
  }
}

}  // namespace

Rectangle CoarseGrid::cell(std::size_t k) const {
  const Vec2 size = cell_size();
  const std::size_t column = k % columns, row = k / columns;
  const Vec2 low = region.low + Vec2{size.x * static_cast<double>(column), size.y * static_cast<double>(row)};
  return {low, low + size};
}

CoarseGrid grid_over(const Rectangle& region, double width) {
  check_area(region, "region of the fields");
  check_positive(width, "width of the cells of the fields", "m");
  const Vec2 sides = region.high - region.low;
  constexpr double most = 1e6;
  if (!(sides.x / width * (sides.y / width) <= most))
    bad_input(fmt::format("cells of {} m in a region of {:.4g} m by {:.4g} m", width, sides.x, sides.y),
              "they would be more than a million", "Give a larger width, a few bodies wide");
  const auto count = [&](double side) { return static_cast<std::size_t>(std::max(1.0, std::round(side / width))); };
  return {region, count(sides.x), count(sides.y)};
}

CoarseFields coarse_fields(std::span<const Grain> grains, std::span<const Clump> clumps,
                           std::span<const BodyContact> contacts, const CoarseGrid& grid) {
  CoarseFields fields{.grid = grid,
                      .stress = std::vector<Tensor2>(grid.size()),
                      .solid_fraction = std::vector<double>(grid.size(), 0.0),
                      .coordination = std::vector<double>(grid.size(), not_measured),
                      .velocity = std::vector<Vec2>(grid.size(), {not_measured, not_measured})};
  if (grid.size() == 0) return fields;
  const Vec2 size = grid.cell_size();
  const double area = size.x * size.y;

  std::vector<double> held(grains.size(), 0.0), shares;
  for (const BodyContact& contact : contacts) {
    const auto i = static_cast<std::size_t>(contact.i);
    const Grain& grain = grains[i];
    held[i] += 1;
    Vec2 branch = contact.arm;
    if (contact.j >= 0) {
      const auto j = static_cast<std::size_t>(contact.j);
      held[j] += 1;
      branch = grains[j].position - grain.position;
    }
    shares = {0, 1};
    add_crossings(grain.position.x, branch.x, grid.region.low.x, size.x, grid.columns, shares);
    add_crossings(grain.position.y, branch.y, grid.region.low.y, size.y, grid.rows, shares);
    std::sort(shares.begin(), shares.end());
    for (std::size_t k = 0; k + 1 < shares.size(); ++k) {
      const auto cell = cell_at(grid, grain.position + 0.5 * (shares[k] + shares[k + 1]) * branch);
      if (cell) fields.stress[*cell] += ((shares[k + 1] - shares[k]) / area) * outer(contact.force, branch);
    }
  }

  std::vector<double> bodies(grid.size(), 0.0), masses(grid.size(), 0.0), ends(grid.size(), 0.0);
  std::vector<Vec2> momenta(grid.size());
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const Grain& grain = grains[g];
    if (!grain.present) continue;
    if (const auto cell = cell_at(grid, grain.position)) {
      bodies[*cell] += 1;
      ends[*cell] += held[g];
      masses[*cell] += grain.inertia.mass;
      momenta[*cell] += grain.inertia.mass * grain.velocity;
    }
    const Outline outline = outline_of(grain, clumps);
    const auto span_of = [&](double centre, double low, double width, std::size_t count) {
      const auto last = static_cast<double>(count);
      return std::pair(
          static_cast<std::size_t>(std::clamp(std::floor((centre - grain.radius - low) / width), 0.0, last)),
          static_cast<std::size_t>(std::clamp(std::ceil((centre + grain.radius - low) / width), 0.0, last)));
    };
    const auto [left, right] = span_of(grain.position.x, grid.region.low.x, size.x, grid.columns);
    const auto [bottom, top] = span_of(grain.position.y, grid.region.low.y, size.y, grid.rows);
    for (std::size_t row = bottom; row < top; ++row)
      for (std::size_t column = left; column < right; ++column) {
        const std::size_t cell = row * grid.columns + column;
        fields.solid_fraction[cell] += clipped_area(outline, grain.position, grid.cell(cell)) / area;
      }
  }
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (bodies[cell] == 0) continue;
    fields.coordination[cell] = ends[cell] / bodies[cell];
    fields.velocity[cell] = momenta[cell] / masses[cell];
  }
  return fields;
}

namespace {

/// The part of the way from a point that lies in a rectangle.
Vec2 part_inside(const Rectangle& region, Vec2 from, Vec2 way) {
  double first = 0, last = 1;
  const auto cut = [&](double start, double along, double low, double high) {
    if (along == 0) {
      if (start < low || start > high) last = first;
      return;
    }
    const double a = (low - start) / along, b = (high - start) / along;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  };
  cut(from.x, way.x, region.low.x, region.high.x);
  cut(from.y, way.y, region.low.y, region.high.y);
  return std::max(0.0, last - first) * way;
}

}  // namespace

Tensor2 region_stress(const Rectangle& region, std::span<const std::int32_t> bodies, std::span<const DiscMotion> places,
                      std::span<const BodyContact> contacts) {
  std::vector<char> counts(places.size(), 0);
  for (const std::int32_t body : bodies) counts[body] = 1;
  Tensor2 sum;
  for (const BodyContact& contact : contacts) {
    const Vec2 at_i = places[contact.i].u;
    if (counts[contact.i] != 0) sum += outer(contact.force, part_inside(region, at_i, contact.arm));
    if (contact.j < 0 || counts[contact.j] == 0) continue;
    const Vec2 at_j = places[contact.j].u;
    sum += outer(-contact.force, part_inside(region, at_j, at_i + contact.arm - contact.shift - at_j));
  }
  const Vec2 sides = region.high - region.low;
  return (1 / (sides.x * sides.y)) * sum;
}

}  // namespace equidem
