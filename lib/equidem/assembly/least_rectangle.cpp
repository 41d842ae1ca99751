// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/least_rectangle.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace equidem {
namespace {

constexpr double pi = std::numbers::pi, unlimited = std::numeric_limits<double>::infinity();

Vec2 direction(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

/// To [-pi, pi).
double wrapped(double angle) {
  return angle >= pi ? angle - 2 * pi : angle < -pi ? angle + 2 * pi : angle;
}

/// Discs about an origin among them, so that a sample far away loses no digits.
struct Discs {
  std::span<const Vec2> centres;
  std::span<const double> radii;

  [[nodiscard]] Vec2 centre(std::int32_t disc) const { return centres[disc] - centres[0]; }
  /// How far the disc reaches along a unit vector.
  [[nodiscard]] double reach(std::int32_t disc, Vec2 along) const { return dot(along, centre(disc)) + radii[disc]; }
};

/// The discs that may touch the hull: all but those inside the polygon of the outermost points of 16 directions.
std::vector<std::int32_t> outer_discs(const Discs& discs) {
  constexpr std::size_t directions = 16, few = 64;
  const auto count = static_cast<std::int32_t>(discs.radii.size());
  std::array<Vec2, directions> along, corner;
  std::array<double, directions> furthest;
  furthest.fill(-unlimited);
  for (std::size_t k = 0; k < directions; ++k) along[k] = direction(2 * pi * static_cast<double>(k) / directions);
  for (std::int32_t disc = 0; disc < count; ++disc) {
    for (std::size_t k = 0; k < directions; ++k) {
      const double reach = discs.reach(disc, along[k]);
      if (reach <= furthest[k]) continue;
      furthest[k] = reach;
      corner[k] = discs.centre(disc) + discs.radii[disc] * along[k];
    }
  }
  const double margin =
      1e-9 * (*std::max_element(furthest.begin(), furthest.end()) + norm(corner[0]) + norm(corner[directions / 2]));
  std::vector<std::pair<Vec2, double>> edges;  // outward normals, and how far the polygon reaches along them
  for (std::size_t k = 0; k < directions; ++k) {
    const Vec2 edge = corner[(k + 1) % directions] - corner[k];
    if (!(norm(edge) > margin)) continue;
    const Vec2 normal = -perpendicular(edge) / norm(edge);
    edges.emplace_back(normal, dot(normal, corner[k]) - margin);
  }
  const auto inside = [&](std::int32_t disc) {
    return std::ranges::all_of(edges, [&](const auto& edge) { return discs.reach(disc, edge.first) < edge.second; });
  };
  std::vector<std::int32_t> outer;
  for (std::int32_t disc = 0; disc < count; ++disc)
    if (static_cast<std::size_t>(count) <= few || !inside(disc)) outer.push_back(disc);
  return outer;
}

/// The disc that reaches furthest in every direction, as pieces of the circle of directions from -pi to pi.
struct Piece {
  double begin = -pi;
  std::int32_t disc = 0;
};
using Hull = std::vector<Piece>;

/// Disc i reaches as far as j in the directions at most `half` from `middle`.
struct Arc {
  double middle = 0, half = 0;
};
Arc where_further(const Discs& discs, std::int32_t i, std::int32_t j) {
  const Vec2 apart = discs.centre(i) - discs.centre(j);
  const double distance = norm(apart), larger = discs.radii[i] - discs.radii[j];
  if (distance <= std::abs(larger)) return {0, larger > 0 || (larger == 0 && i < j) ? 2 * pi : -1};
  return {std::atan2(apart.y, apart.x), std::acos(-larger / distance)};
}

Hull joined_hulls(const Discs& discs, const Hull& p, const Hull& q) {
  Hull hull;
  const auto add = [&](double begin, std::int32_t disc) {
    if (hull.empty() || hull.back().disc != disc) hull.push_back({begin, disc});
  };
  std::size_t a = 0, b = 0;
  double begin = -pi;
  while (begin < pi) {
    const double end = std::min(a + 1 < p.size() ? p[a + 1].begin : pi, b + 1 < q.size() ? q[b + 1].begin : pi);
    const std::int32_t i = p[a].disc, j = q[b].disc;
    const Arc arc = where_further(discs, i, j);
    std::array<double, 4> cuts = {begin, end, end, end};
    if (arc.half >= 0 && arc.half <= pi) {
      cuts[1] = std::clamp(wrapped(arc.middle - arc.half), begin, end);
      cuts[2] = std::clamp(wrapped(arc.middle + arc.half), begin, end);
      if (cuts[1] > cuts[2]) std::swap(cuts[1], cuts[2]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(cuts[k] < cuts[k + 1])) continue;
      const double middle = 0.5 * (cuts[k] + cuts[k + 1]);
      add(cuts[k], std::abs(wrapped(middle - arc.middle)) <= arc.half ? i : j);
    }
    if (a + 1 < p.size() && p[a + 1].begin <= end) ++a;
    if (b + 1 < q.size() && q[b + 1].begin <= end) ++b;
    begin = end;
  }
  return hull;
}

Hull hull_of(const Discs& discs, std::span<const std::int32_t> some) {
  if (some.size() == 1) return {{-pi, some[0]}};
  const std::size_t half = some.size() / 2;
  return joined_hulls(discs, hull_of(discs, some.first(half)), hull_of(discs, some.subspan(half)));
}

/// How far the discs reach along a unit vector: the disc of its piece, or of a piece beside it by round-off.
double reach_of_all(const Discs& discs, const Hull& hull, Vec2 along) {
  const double angle = wrapped(std::atan2(along.y, along.x));
  const auto after =
      std::upper_bound(hull.begin(), hull.end(), angle, [](double x, const Piece& piece) { return x < piece.begin; });
  const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - hull.begin() - 1)), n = hull.size();
  double furthest = -unlimited;
  for (const std::size_t k : {at, (at + 1) % n, (at + n - 1) % n})
    furthest = std::max(furthest, discs.reach(hull[k].disc, along));
  return furthest;
}

/// Turns n by right angles to the direction that is nearest to x. \pre finite
Vec2 folded(Vec2 n) {
  while (!(n.x >= std::abs(n.y))) n = perpendicular(n);
  return n.y == -n.x ? perpendicular(n) : n;
}

/// The directions of the rectangles that have a side along a common tangent of neighbours on the hull.
std::vector<Vec2> flush_directions(const Discs& discs, const Hull& hull) {
  std::vector<Vec2> directions = {{1, 0}};
  for (std::size_t k = 0; k < hull.size() && hull.size() > 1; ++k) {
    const std::int32_t i = hull[k].disc, j = hull[(k + 1) % hull.size()].disc;
    const Vec2 apart = discs.centre(j) - discs.centre(i);
    const double distance = norm(apart), larger = discs.radii[i] - discs.radii[j];
    if (!(distance > std::abs(larger))) continue;
    const Vec2 way = apart / distance;
    const double sine = larger / distance;
    // Counter-clockwise the tangent has the discs on its left: its outward normal n obeys n . way = sine.
    directions.push_back(folded(sine * way - std::sqrt((1 - sine) * (1 + sine)) * perpendicular(way)));
  }
  return directions;
}

/// A rectangle as it is compared with others.
struct Candidate {
  Vec2 along, low, high;  ///< low and high along the direction and across it
  double area = 0;
  double off_middle = 0;  ///< m, of the mean of the centres

  /// Distance of a place from the nearest side, m.
  [[nodiscard]] double depth(Vec2 place) const {
    const Vec2 x = {dot(along, place), cross(along, place)};
    return std::min({x.x - low.x, x.y - low.y, high.x - x.x, high.y - x.y});
  }
};

/// Decides between rectangles of equal area: by the distance of the mean of the centres from the middle, then by the
/// distances of the first disc, the second, ... from the nearest side.
Vec2 chosen_direction(const Discs& discs, std::vector<Candidate> equal) {
  const double close = 1e-9 * std::sqrt(equal.front().area);
  const auto keep_least = [&](const auto& value) {
    const double least = value(std::ranges::min(equal, {}, value));
    std::erase_if(equal, [&](const Candidate& c) { return value(c) > least + close; });
  };
  keep_least([](const Candidate& c) { return c.off_middle; });
  // Sides that are straight up to round-off have many tangents of one direction.
  constexpr double same = 1e-9;
  std::ranges::sort(equal, {}, [](const Candidate& c) { return c.along.y; });
  std::vector<Candidate> distinct;
  for (const Candidate& c : equal) {
    if (distinct.empty() || cross(distinct.back().along, c.along) > same) {
      distinct.push_back(c);
    } else if (std::abs(c.along.y) < std::abs(distinct.back().along.y)) {
      distinct.back() = c;
    }
  }
  equal = std::move(distinct);
  const auto count = static_cast<std::int32_t>(discs.radii.size());
  for (std::int32_t disc = 0; disc < count && equal.size() > 1; ++disc)
    keep_least([&](const Candidate& c) { return c.depth(discs.centre(disc)); });
  return equal.front().along;
}

}  // namespace

Rectangle upright_rectangle(std::span<const Vec2> centres, std::span<const double> radii) {
  Rectangle box{.low = {unlimited, unlimited}, .high = {-unlimited, -unlimited}};
  for (std::size_t disc = 0; disc < centres.size(); ++disc) {
    const Vec2 x = centres[disc];
    const double r = radii.empty() ? 0 : radii[disc];
    box.low = {std::min(box.low.x, x.x - r), std::min(box.low.y, x.y - r)};
    box.high = {std::max(box.high.x, x.x + r), std::max(box.high.y, x.y + r)};
  }
  return box;
}

TurnedRectangle least_rectangle(std::span<const Vec2> centres, std::span<const double> radii) {
  assert(!centres.empty() && centres.size() == radii.size());
  const Discs discs{centres, radii};
  const Hull hull = hull_of(discs, outer_discs(discs));
  Vec2 mean;
  double coordinates = 0;
  for (const Vec2 x : centres) {
    mean += (x - centres[0]) / static_cast<double>(centres.size());
    coordinates = std::max({coordinates, std::abs(x.x), std::abs(x.y)});
  }
  std::vector<Candidate> candidates;
  double least = unlimited, shorter = unlimited;
  for (const Vec2 along : flush_directions(discs, hull)) {
    const Vec2 across = perpendicular(along);
    const Vec2 high = {reach_of_all(discs, hull, along), reach_of_all(discs, hull, across)};
    const Vec2 low = {-reach_of_all(discs, hull, -along), -reach_of_all(discs, hull, -across)};
    const Vec2 size = high - low, middle = 0.5 * (low + high);
    candidates.push_back({along, low, high, size.x * size.y, norm(Vec2{dot(along, mean), dot(across, mean)} - middle)});
    least = std::min(least, candidates.back().area);
    shorter = std::min({shorter, size.x, size.y});
  }
  const double rounding = 64 * std::numeric_limits<double>::epsilon() * (1 + coordinates / shorter);
  std::erase_if(candidates, [&](const Candidate& c) { return c.area > (1 + rounding) * least; });
  const Vec2 along = chosen_direction(discs, std::move(candidates));
  if (along == Vec2{1, 0}) return upright_rectangle(centres, radii);
  Vec2 low = {unlimited, unlimited}, high = -low;
  const Vec2 across = perpendicular(along);
  for (std::size_t disc = 0; disc < centres.size(); ++disc) {
    const Vec2 x = centres[disc] - centres[0], place = {dot(along, x), dot(across, x)};
    const double r = radii[disc];
    low = {std::min(low.x, place.x - r), std::min(low.y, place.y - r)};
    high = {std::max(high.x, place.x + r), std::max(high.y, place.y + r)};
  }
  const auto corner = [&](Vec2 at) { return centres[0] + at.x * along + at.y * across; };
  return TurnedRectangle({corner(low), corner(high)}, along);
}

}  // namespace equidem
