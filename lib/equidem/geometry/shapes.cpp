// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/geometry/shapes.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/turns.hpp"

namespace equidem {

Vec2 axis_of_turns(double turns) {
  return {sine_of_turns(turns + 0.25), sine_of_turns(turns)};
}
Vec2 axis_at(double angle) {
  return axis_of_turns(angle / (2 * std::numbers::pi));
}

void check(const Clump& clump) {
  if (clump.discs.empty()) bad_input("a clump has no discs", "it needs at least one", "Give its discs");
  for (const Clump::Disc& disc : clump.discs) {
    if (std::isfinite(disc.offset.x + disc.offset.y) && is_positive(disc.radius)) continue;
    bad_input(
        fmt::format("a clump has a disc of the radius {} m at ({}, {}) m", disc.radius, disc.offset.x, disc.offset.y),
        "radii are > 0 and all numbers finite", "Correct it");
  }
}

Clump centred_clump(std::vector<Clump::Disc> discs) {
  check(Clump{discs});
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

double radius_of(const Clump& clump) {
  double radius = 0;
  for (const Clump::Disc& disc : clump.discs) radius = std::max(radius, norm(disc.offset) + disc.radius);
  return radius;
}

double reach_of(const Outline& outline) {
  double reach = outline.a;
  for (const Clump::Disc& disc : outline.discs)
    reach = std::max(reach, outline.scale * (norm(disc.offset) + disc.radius));
  return reach;
}

double reach_along(const Outline& outline, Vec2 direction) {
  double reach = -INFINITY;
  for (std::size_t p = 0; p < outline.parts(); ++p)
    reach = std::max(reach, dot(outline.offset(p), direction) + support(outline.part(p), direction).reach);
  return reach;
}

double inscribed_radius(const Outline& outline) {
  if (outline.discs.empty()) return outline.b;
  return outline.scale * std::ranges::min(outline.discs, {}, &Clump::Disc::radius).radius;
}

double longest_lever(const Outline& outline) {
  double lever = outline.a - outline.b;
  for (const Clump::Disc& disc : outline.discs) lever = std::max(lever, outline.scale * norm(disc.offset));
  return lever;
}

namespace {

/// \param branch from the centre of p to that of q
bool run_through_one_another(const Ellipse& p, const Ellipse& q, Vec2 branch) {
  const double skew = cross(p.axis, q.axis);
  if (skew == 0) return false;
  const auto reaches = [](const Ellipse& e, double along) { return std::abs(along) < e.a - e.b * e.b / e.a; };
  return reaches(p, cross(branch, q.axis) / skew) && reaches(q, cross(branch, p.axis) / skew);
}

}  // namespace

bool are_inside_one_another(const Outline& i, const Outline& j, Vec2 branch) {
  if (i.is_disc() && j.is_disc()) return norm(branch) < std::max(i.a, j.a);
  for (std::size_t p = 0; p < i.parts(); ++p)
    for (std::size_t q = 0; q < j.parts(); ++q) {
      const Ellipse one = i.part(p), other = j.part(q);
      const Vec2 between = branch + (j.offset(q) - i.offset(p));
      if (holds(one, between) || holds(other, between) || run_through_one_another(one, other, between)) return true;
    }
  return false;
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

/// Moments of what the disc around the origin shares with the triangle (0, a, b), negative if b lies clockwise of a.
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

}  // namespace

double clipped_area(std::span<const Clump::Disc> discs, const Rectangle& region) {
  double area = 0;
  for (const Moments& part : parts_of_union(discs, &region)) area += part.area;
  return area;
}

double clipped_area(const Outline& outline, Vec2 centre, const Rectangle& region) {
  const Vec2 low = centre - region.low, high = region.high - centre;
  const double inside = std::min({low.x, low.y, high.x, high.y}), reach = reach_of(outline);
  if (inside >= reach) return area_of(outline);
  if (inside <= -reach) return 0;
  if (!outline.discs.empty()) {
    std::vector<Clump::Disc> discs;
    for (std::size_t p = 0; p < outline.parts(); ++p) discs.push_back({centre + outline.offset(p), outline.part(p).a});
    return clipped_area(discs, region);
  }
  // In a plane where the ellipse is the unit circle.
  auto corners = corners_of(region);
  for (Vec2& x : corners) {
    const Vec2 from = x - centre;
    x = {dot(outline.axis, from) / outline.a, cross(outline.axis, from) / outline.b};
  }
  double area = 0;
  for (std::size_t k = 0; k < 4; ++k) area += sector_or_triangle(corners[k], corners[(k + 1) % 4], 1).area;
  return outline.a * outline.b * area;
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

double area_of(const Outline& outline) {
  if (outline.discs.empty()) return std::numbers::pi * outline.a * outline.b;
  return outline.scale * outline.scale * union_of(outline.discs).area;
}

}  // namespace equidem
