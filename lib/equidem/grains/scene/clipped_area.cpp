// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/clipped_area.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace equidem {
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
      return clipped_area(placed(grain, clumps[static_cast<std::size_t>(grain.clump)]), region);
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
      return union_of(clumps[static_cast<std::size_t>(grain.clump)].discs).area;
    case GrainShape::ellipse:
      return std::numbers::pi * grain.radius * grain.short_half_axis;
    case GrainShape::disc:
      break;
  }
  return std::numbers::pi * grain.radius * grain.radius;
}

}  // namespace equidem
