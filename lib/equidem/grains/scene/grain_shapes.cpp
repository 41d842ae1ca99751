// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/grains/scene/grain_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/turns.hpp"

namespace equidem {

Clump centred_clump(std::vector<Clump::Disc> discs) {
  if (discs.empty()) bad_input("a clump has no discs", "there is nothing to it", "Give at least one");
  for (const Clump::Disc& disc : discs) {
    if (std::isfinite(disc.offset.x + disc.offset.y) && disc.radius > 0 && std::isfinite(disc.radius)) continue;
    bad_input(fmt::format("a disc of a clump has the radius {} m and is at ({}, {}) m", disc.radius, disc.offset.x,
                          disc.offset.y),
              "it would touch nothing", "Give a radius > 0 and finite numbers");
  }
  for (std::size_t p = 0; p < discs.size(); ++p) {
    for (std::size_t q = 0; q < discs.size(); ++q) {
      // A disc that touches the other from inside adds nothing either, whatever rounding says.
      const double reach = norm(discs[p].offset - discs[q].offset) + discs[p].radius;
      if (p == q || reach > discs[q].radius * (1 + 1e-12)) continue;
      bad_input(fmt::format("disc {} of a clump lies within disc {}", p, q),
                "it adds nothing to the body, and where the two meet others contacts would count twice",
                "Leave it out");
    }
  }
  const Vec2 centre = union_of(discs).centre;
  for (Clump::Disc& disc : discs) disc.offset -= centre;
  return {std::move(discs)};
}

Inertia inertia_of_clump(const Clump& clump, double density) {
  if (!(density > 0 && std::isfinite(density))) {
    bad_input(fmt::format("the density of the clumps is {:.6g} kg/m³", density), "it must be positive and finite",
              "Give a density above 0 kg/m³");
  }
  const DiscUnion all = union_of(clump.discs);
  return {density * all.area, density * all.polar_moment};
}

double radius_of(const Clump& clump) {
  double radius = 0;
  for (const Clump::Disc& disc : clump.discs) radius = std::max(radius, norm(disc.offset) + disc.radius);
  return radius;
}

bool has_shapes(const GrainScene& scene) {
  return std::any_of(scene.grains.begin(), scene.grains.end(),
                     [](const Grain& grain) { return grain.shape() != GrainShape::disc; });
}

std::vector<GrainPart> parts_of(const Grain& grain, const std::vector<Clump>& clumps) {
  switch (grain.shape()) {
    case GrainShape::disc:
      return {{{}, grain.radius, grain.radius, grain.radius}};
    case GrainShape::ellipse:
      return {{{}, grain.radius, grain.short_half_axis, std::sqrt(grain.radius * grain.short_half_axis)}};
    case GrainShape::clump:
      break;
  }
  std::vector<GrainPart> parts;
  for (const Clump::Disc& disc : clumps[grain.clump].discs) {
    parts.push_back({disc.offset, disc.radius, disc.radius, disc.radius});
  }
  const auto place = [](const GrainPart& part) { return std::tuple(part.offset.x, part.offset.y, part.a); };
  std::sort(parts.begin(), parts.end(), [&](const GrainPart& p, const GrainPart& q) { return place(p) < place(q); });
  return parts;
}

double inscribed_radius(const Grain& grain, std::span<const Clump> clumps) {
  switch (grain.shape()) {
    case GrainShape::clump:
      return std::ranges::min(clumps[grain.clump].discs, {}, &Clump::Disc::radius).radius;
    case GrainShape::ellipse:
      return grain.short_half_axis;
    case GrainShape::disc:
      break;
  }
  return grain.radius;
}

double smallest_inscribed_radius(const GrainScene& scene) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Grain& grain : scene.grains) smallest = std::min(smallest, inscribed_radius(grain, scene.clumps));
  return smallest;
}

Vec2 axis_of_turns(double turns) {
  return {sine_of_turns(turns + 0.25), sine_of_turns(turns)};
}
Vec2 axis_at(double angle) {
  return axis_of_turns(angle / (2 * std::numbers::pi));
}

namespace {

void check_length(const char* what, double length) {
  if (length > 0 && std::isfinite(length)) return;
  bad_input(fmt::format("the {} {} m is not positive", what, length), "a body has a size", "Give a number > 0");
}

}  // namespace

void GrainShapes::check_body(const char* shape) const {
  if (body_ == Body::disc) return;
  bad_input(fmt::format("{} among spheres", shape),
            "ellipses and clumps are cylinders, their mass is per metre of depth", "Write body = \"disc\" in [grains]");
}

void GrainShapes::make_disc(Grain& grain, double radius, double density) const {
  check_length("radius", radius);
  grain.radius = radius;
  grain.inertia = inertia_of(radius, density, body_);
}

void GrainShapes::make_ellipse(Grain& grain, double long_half_axis, double short_half_axis, double density) const {
  check_body("an ellipse");
  check_length("long half-axis", long_half_axis);
  check_length("short half-axis", short_half_axis);
  if (short_half_axis > long_half_axis) {
    bad_input(
        fmt::format("the short half-axis {} m is longer than the long one, {} m", short_half_axis, long_half_axis),
        "at angle 0 the long one lies along x", "Exchange them, and add a quarter turn (1.5708) to the angle");
  }
  grain.radius = long_half_axis;
  grain.short_half_axis = short_half_axis;
  grain.inertia = inertia_of_ellipse(long_half_axis, short_half_axis, density);
}

void GrainShapes::make_clump(Grain& grain, std::vector<Clump::Disc> discs, double density) {
  check_body("a clump");
  std::vector<std::array<double, 3>> key;
  for (const Clump::Disc& disc : discs) key.push_back({disc.offset.x, disc.offset.y, disc.radius});
  const auto [at, is_new] = known_.try_emplace(std::move(key), static_cast<int>(clumps_.size()));
  if (is_new) {
    constexpr double rounding = 1e-12;
    Clump centred = centred_clump(discs);
    const double shift = norm(centred.discs[0].offset - discs[0].offset);
    if (shift <= rounding * radius_of(centred)) centred.discs = std::move(discs);  // read back: the same bits
    clumps_.push_back(std::move(centred));
    inertias_.push_back(inertia_of_clump(clumps_.back(), 1));
  }
  const auto c = static_cast<std::size_t>(at->second);
  grain.clump = at->second;
  grain.radius = radius_of(clumps_[c]);
  grain.inertia = {density * inertias_[c].mass, density * inertias_[c].moment};
}

namespace {

/// Area, first moments and polar moment of a part of a disc about its centre.
struct Moments {
  double area = 0, polar = 0;
  Vec2 first;

  void operator+=(const Moments& more) {
    area += more.area;
    polar += more.polar;
    first += more.first;
  }
};

Moments triangle(Vec2 a, Vec2 b) {
  const double area = 0.5 * cross(a, b);
  return {area, area * (dot(a, a) + dot(a, b) + dot(b, b)) / 6, area / 3 * (a + b)};
}

/// \param from, to seen from the centre; their lengths do not matter
Moments sector(Vec2 from, Vec2 to, double radius) {
  const double length = norm(from), other = norm(to);
  if (!(length > 0 && other > 0)) return {};
  const double angle = std::atan2(cross(from, to), dot(from, to)), square = radius * radius;
  const Vec2 change = to / other - from / length;
  return {0.5 * square * angle, 0.25 * square * square * angle, square * radius / 3 * Vec2{change.y, -change.x}};
}

/// Of what the disc around the origin shares with the triangle (0, a, b), negative if b lies clockwise of a.
Moments sector_or_triangle(Vec2 a, Vec2 b, double radius) {
  const double length = norm(b - a);
  if (!(length > 0)) return {};
  const Vec2 way = (b - a) / length;
  const double distance = std::abs(cross(a, way));
  if (distance >= radius) return sector(a, b, radius);
  // The circle is entered and left at a + t way.
  const double half = std::sqrt((radius - distance) * (radius + distance)), middle = -dot(a, way);
  const double first = middle - half, last = middle + half;
  if (last <= 0 || first >= length) return sector(a, b, radius);
  const Vec2 in = first > 0 ? a + first * way : a, out = last < length ? a + last * way : b;
  Moments sum = triangle(in, out);
  if (first > 0) sum += sector(a, in, radius);
  if (last < length) sum += sector(out, b, radius);
  return sum;
}

std::array<Vec2, 4> corners_of(const Rectangle& region) {
  return {region.low, {region.high.x, region.low.y}, region.high, {region.low.x, region.high.y}};
}

/// The part of a disc that lies in half-planes.
class CutDisc {
 public:
  explicit CutDisc(double radius) : radius_(radius) {
    const double half = 2 * radius;
    polygon_ = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  }

  /// Keeps where dot(normal, x) <= limit, x from the centre, the normal being a unit vector.
  void keep(Vec2 normal, double limit) {
    if (limit >= radius_) return;
    if (limit <= -radius_) return polygon_.clear();
    kept_.clear();
    for (std::size_t k = 0; k < polygon_.size(); ++k) {
      const Vec2 a = polygon_[k], b = polygon_[k + 1 < polygon_.size() ? k + 1 : 0];
      const double out_a = dot(normal, a) - limit, out_b = dot(normal, b) - limit;
      if (out_a <= 0) kept_.push_back(a);
      if ((out_a < 0 && out_b > 0) || (out_a > 0 && out_b < 0)) kept_.push_back(a + out_a / (out_a - out_b) * (b - a));
    }
    std::swap(polygon_, kept_);
  }

  void clear() { polygon_.clear(); }

  [[nodiscard]] Moments moments() const {
    Moments sum;
    for (std::size_t k = 0; k < polygon_.size(); ++k)
      sum += sector_or_triangle(polygon_[k], polygon_[k + 1 < polygon_.size() ? k + 1 : 0], radius_);
    return sum;
  }

 private:
  double radius_;
  std::vector<Vec2> polygon_, kept_;
};

/// The moments of disjoint parts of a union of discs, one part of each disc: the points of which its power |x - c|² -
/// r² is the least. Rounding shifts the straight line between two parts, by digits of their distance, and no part
/// depends on whether two circles cross: that is not decidable where they touch.
std::vector<Moments> parts_of_union(std::span<const Clump::Disc> discs, const Rectangle* region) {
  std::vector<Moments> parts;
  for (std::size_t k = 0; k < discs.size(); ++k) {
    const auto& [centre, r] = discs[k];
    CutDisc part(r);
    if (region != nullptr) {
      part.keep({-1, 0}, centre.x - region->low.x);
      part.keep({1, 0}, region->high.x - centre.x);
      part.keep({0, -1}, centre.y - region->low.y);
      part.keep({0, 1}, region->high.y - centre.y);
    }
    for (std::size_t other = 0; other < discs.size(); ++other) {
      const Vec2 way = discs[other].offset - centre;
      const double distance = norm(way), s = discs[other].radius;
      if (distance > 0) {
        part.keep(way / distance, 0.5 * (distance + (r - s) * ((r + s) / distance)));
      } else if (s > r || (s == r && other < k)) {
        part.clear();
      }
    }
    parts.push_back(part.moments());
  }
  return parts;
}

std::vector<Clump::Disc> placed(const Grain& grain, const Clump& clump) {
  const double c = std::cos(grain.angle), s = std::sin(grain.angle);
  std::vector<Clump::Disc> discs = clump.discs;
  for (Clump::Disc& disc : discs) {
    const Vec2 x = disc.offset;
    disc.offset = grain.position + Vec2{c * x.x - s * x.y, s * x.x + c * x.y};
  }
  return discs;
}

}  // namespace

double clipped_area(Vec2 centre, double radius, const Rectangle& region) {
  return clipped_area(Ellipse{radius, radius}, centre, region);
}

double clipped_area(const Ellipse& ellipse, Vec2 centre, const Rectangle& region) {
  // In a plane where the ellipse is the unit circle.
  auto corners = corners_of(region);
  for (Vec2& x : corners) {
    const Vec2 way = x - centre;
    x = {dot(ellipse.axis, way) / ellipse.a, cross(ellipse.axis, way) / ellipse.b};
  }
  double area = 0;
  for (std::size_t k = 0; k < 4; ++k) area += sector_or_triangle(corners[k], corners[(k + 1) % 4], 1).area;
  return ellipse.a * ellipse.b * area;
}

double clipped_area(std::span<const Clump::Disc> discs, const Rectangle& region) {
  double area = 0;
  for (const Moments& part : parts_of_union(discs, &region)) area += part.area;
  return area;
}

double clipped_area(const Grain& grain, std::span<const Clump> clumps, const Rectangle& region) {
  const Vec2 low = grain.position - region.low, high = region.high - grain.position;
  const double inside = std::min({low.x, low.y, high.x, high.y});
  if (inside >= grain.radius) return area_of(grain, clumps);
  if (inside <= -grain.radius) return 0;
  switch (grain.shape()) {
    case GrainShape::clump:
      return clipped_area(placed(grain, clumps[grain.clump]), region);
    case GrainShape::ellipse:
      return clipped_area(Ellipse::at_angle(grain.radius, grain.short_half_axis, grain.angle), grain.position, region);
    case GrainShape::disc:
      break;
  }
  return clipped_area(grain.position, grain.radius, region);
}

double clipped_area(std::span<const Grain> grains, std::span<const Clump> clumps, const Rectangle& region) {
  double area = 0;
  for (const Grain& grain : grains) area += clipped_area(grain, clumps, region);
  return area;
}

DiscUnion union_of(std::span<const Clump::Disc> discs) {
  const std::vector<Moments> parts = parts_of_union(discs, nullptr);
  DiscUnion whole;
  Vec2 first;  // about the first centre: far from the origin digits would cancel
  const Vec2 origin = discs.front().offset;
  for (std::size_t k = 0; k < discs.size(); ++k) {
    whole.area += parts[k].area;
    first += parts[k].first + parts[k].area * (discs[k].offset - origin);
  }
  whole.centre = first / whole.area;
  for (std::size_t k = 0; k < discs.size(); ++k) {
    const Vec2 way = discs[k].offset - origin - whole.centre;
    whole.polar_moment += parts[k].polar + 2 * dot(parts[k].first, way) + parts[k].area * dot(way, way);
  }
  whole.centre += origin;
  return whole;
}

double area_of(const Grain& grain, std::span<const Clump> clumps) {
  switch (grain.shape()) {
    case GrainShape::clump:
      return union_of(clumps[grain.clump].discs).area;
    case GrainShape::ellipse:
      return std::numbers::pi * grain.radius * grain.short_half_axis;
    case GrainShape::disc:
      break;
  }
  return std::numbers::pi * grain.radius * grain.radius;
}

}  // namespace equidem
