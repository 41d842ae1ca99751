// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/clipped_area.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace equidem {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;

/// Signed area that the circle around the origin shares with the triangle (0, a, b).
double sector_or_triangle(Vec2 a, Vec2 b, double radius) {
  const auto sector = [&](Vec2 from, Vec2 to) {
    return 0.5 * radius * radius * std::atan2(cross(from, to), dot(from, to));
  };
  const Vec2 way = b - a;
  const double length2 = dot(way, way);
  if (!(length2 > 0)) return 0;
  // The circle is entered and left at a + t way.
  const double middle = -dot(a, way) / length2;
  const double square = middle * middle - (dot(a, a) - radius * radius) / length2;
  if (square <= 0) return sector(a, b);
  const double half = std::sqrt(square), first = middle - half, last = middle + half;
  if (last <= 0 || first >= 1) return sector(a, b);
  const Vec2 in = a + std::max(first, 0.0) * way, out = a + std::min(last, 1.0) * way;
  double area = 0.5 * cross(in, out);
  if (first > 0) area += sector(a, in);
  if (last < 1) area += sector(out, b);
  return area;
}

std::array<Vec2, 4> corners_of(const Region& region) {
  return {region.low, {region.high.x, region.low.y}, region.high, {region.low.x, region.high.y}};
}

bool holds(const Clump::Disc& disc, Vec2 place) {
  const Vec2 way = place - disc.offset;
  return dot(way, way) < disc.radius * disc.radius;
}

bool holds(const Region& region, Vec2 place) {
  return place.x > region.low.x && place.x < region.high.x && place.y > region.low.y && place.y < region.high.y;
}

/// A part of a circle, counter-clockwise.
struct Arc {
  Vec2 centre;
  double radius = 0, from = 0, to = 0;  ///< rad
};

/// Angles at which a circle crosses another.
void add_crossings(const Clump::Disc& circle, const Clump::Disc& other, std::vector<double>& angles) {
  const Vec2 way = other.offset - circle.offset;
  const double distance = norm(way), r = circle.radius, s = other.radius;
  if (!(distance < r + s) || !(distance > std::abs(r - s))) return;
  // Half the common chord by Heron's formula, the same from both circles: the edge closes even where they hardly cross.
  const double chord = std::sqrt((distance + r + s) * (r + s - distance) * (distance + r - s) * (distance - r + s));
  const double half = std::atan2(chord, distance * distance + r * r - s * s);
  const double middle = std::atan2(way.y, way.x);
  angles.push_back(middle - half);
  angles.push_back(middle + half);
}

/// Angles at which a circle crosses the lines of the sides.
void add_crossings(const Clump::Disc& circle, const Region& region, std::vector<double>& angles) {
  for (const double x : {region.low.x, region.high.x}) {
    const double share = (x - circle.offset.x) / circle.radius;
    if (std::abs(share) >= 1) continue;
    const double half = std::acos(share);
    angles.push_back(half);
    angles.push_back(-half);
  }
  for (const double y : {region.low.y, region.high.y}) {
    const double share = (y - circle.offset.y) / circle.radius;
    if (std::abs(share) >= 1) continue;
    const double angle = std::asin(share);
    angles.push_back(angle);
    angles.push_back(std::numbers::pi - angle);
  }
}

/// The arcs that bound the discs together, in the region where there is one.
template <typename Body>
void for_arcs(std::span<const Clump::Disc> discs, const Region* region, const Body& body) {
  std::vector<double> angles;
  for (std::size_t k = 0; k < discs.size(); ++k) {
    const Clump::Disc& circle = discs[k];
    const auto same = [&](const Clump::Disc& other) {
      return other.offset == circle.offset && other.radius == circle.radius;
    };
    if (std::any_of(discs.begin(), discs.begin() + static_cast<std::ptrdiff_t>(k), same)) continue;
    angles = {0};
    for (const Clump::Disc& other : discs) add_crossings(circle, other, angles);
    if (region != nullptr) add_crossings(circle, *region, angles);
    for (double& angle : angles) angle -= full_turn * std::floor(angle / full_turn);
    angles.push_back(full_turn);
    std::sort(angles.begin(), angles.end());
    for (std::size_t a = 0; a + 1 < angles.size(); ++a) {
      const double middle = 0.5 * (angles[a] + angles[a + 1]);
      const Vec2 place = circle.offset + circle.radius * Vec2{std::cos(middle), std::sin(middle)};
      const auto covers = [&](const Clump::Disc& other) { return !same(other) && holds(other, place); };
      if (std::any_of(discs.begin(), discs.end(), covers)) continue;
      if (region == nullptr || holds(*region, place)) body(Arc{circle.offset, circle.radius, angles[a], angles[a + 1]});
    }
  }
}

/// (1/2) integral of x dy - y dx.
double area_under(const Arc& arc) {
  const double r = arc.radius;
  return 0.5 * r *
         (arc.centre.x * (std::sin(arc.to) - std::sin(arc.from)) -
          arc.centre.y * (std::cos(arc.to) - std::cos(arc.from)) + r * (arc.to - arc.from));
}

/// The same of the parts of a side that lie in discs.
double area_under(Vec2 from, Vec2 to, std::span<const Clump::Disc> discs, std::vector<double>& cuts) {
  const Vec2 way = to - from;
  const double length2 = dot(way, way);
  cuts = {0, 1};
  for (const Clump::Disc& disc : discs) {
    const Vec2 a = from - disc.offset;
    const double middle = -dot(a, way) / length2;
    const double square = middle * middle - (dot(a, a) - disc.radius * disc.radius) / length2;
    if (square <= 0) continue;
    for (const double cut : {middle - std::sqrt(square), middle + std::sqrt(square)})
      if (cut > 0 && cut < 1) cuts.push_back(cut);
  }
  std::sort(cuts.begin(), cuts.end());
  double share = 0;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const Vec2 place = from + 0.5 * (cuts[k] + cuts[k + 1]) * way;
    const auto covers = [&](const Clump::Disc& disc) { return holds(disc, place); };
    if (std::any_of(discs.begin(), discs.end(), covers)) share += cuts[k + 1] - cuts[k];
  }
  return 0.5 * share * cross(from, to);
}

/// Integrals over an arc, by Green's theorem: of x and y (x² dy/2, -y² dx/2) and of x² + y² ((x³ dy - y³ dx)/3).
struct Moments {
  double area = 0, polar = 0;
  Vec2 first;
};

Moments moments_under(const Arc& arc) {
  // Powers of cos and sin from 1 to 4, integrated.
  const auto powers = [](double t, bool of_sine) {
    const double s = std::sin(t), c = std::cos(t), s2 = std::sin(2 * t), s4 = std::sin(4 * t);
    return of_sine ? std::array{-c, t / 2 - s2 / 4, -c + c * c * c / 3, 3 * t / 8 - s2 / 4 + s4 / 32}
                   : std::array{s, t / 2 + s2 / 4, s - s * s * s / 3, 3 * t / 8 + s2 / 4 + s4 / 32};
  };
  // Integrals of (c + r f)^2 r f and (c + r f)^3 r f, f = cos or sin.
  const auto integrate = [&](double c, bool of_sine) {
    const auto low = powers(arc.from, of_sine), high = powers(arc.to, of_sine);
    const double r = arc.radius;
    const double p1 = high[0] - low[0], p2 = high[1] - low[1], p3 = high[2] - low[2], p4 = high[3] - low[3];
    return std::pair(r * (c * c * p1 + 2 * c * r * p2 + r * r * p3),
                     r * (c * c * c * p1 + 3 * c * c * r * p2 + 3 * c * r * r * p3 + r * r * r * p4));
  };
  const auto [x2, x3] = integrate(arc.centre.x, false);
  const auto [y2, y3] = integrate(arc.centre.y, true);
  return {area_under(arc), (x3 + y3) / 3, {x2 / 2, y2 / 2}};
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

double clipped_area(Vec2 centre, double radius, const Region& region) {
  return clipped_area(Ellipse{radius, radius}, centre, region);
}

double clipped_area(const Ellipse& ellipse, Vec2 centre, const Region& region) {
  // In a plane where the ellipse is the unit circle.
  auto corners = corners_of(region);
  for (Vec2& x : corners) {
    const Vec2 way = x - centre;
    x = {dot(ellipse.axis, way) / ellipse.a, cross(ellipse.axis, way) / ellipse.b};
  }
  double area = 0;
  for (std::size_t k = 0; k < 4; ++k) area += sector_or_triangle(corners[k], corners[(k + 1) % 4], 1);
  return ellipse.a * ellipse.b * area;
}

double clipped_area(std::span<const Clump::Disc> discs, const Region& region) {
  double area = 0;
  for_arcs(discs, &region, [&](const Arc& arc) { area += area_under(arc); });
  const auto corners = corners_of(region);
  std::vector<double> cuts;
  for (std::size_t k = 0; k < 4; ++k) area += area_under(corners[k], corners[(k + 1) % 4], discs, cuts);
  return area;
}

double clipped_area(const Grain& grain, std::span<const Clump> clumps, const Region& region) {
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

DiscUnion union_of(std::span<const Clump::Disc> discs) {
  // About the first centre: far from the origin digits would cancel.
  std::vector<Clump::Disc> near(discs.begin(), discs.end());
  const Vec2 origin = near.front().offset;
  for (Clump::Disc& disc : near) disc.offset -= origin;
  Moments sum;
  for_arcs(near, nullptr, [&](const Arc& arc) {
    const Moments part = moments_under(arc);
    sum.area += part.area;
    sum.first += part.first;
    sum.polar += part.polar;
  });
  const Vec2 centre = sum.first / sum.area;
  return {sum.area, origin + centre, sum.polar - sum.area * dot(centre, centre)};
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
