// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/voids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/assembly/triangulation.hpp"

namespace equidem {
namespace {

struct Circles {
  std::vector<Vec2> centres;
  std::vector<double> radii;
};

/// The discs of a free assembly; of a periodic one also the images near its sides.
Circles with_images(const Assembly& assembly) {
  constexpr double reach = 10;  // mean distances of discs: the images that a void across a side can touch
  Circles all{assembly.centres, assembly.radii};
  if (!assembly.period) return all;
  const Vec2 period = *assembly.period;
  const double margin = reach * std::sqrt(period.x * period.y / static_cast<double>(assembly.size()));
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    Vec2& home = all.centres[d];
    home -= {std::floor(home.x / period.x) * period.x, std::floor(home.y / period.y) * period.y};
    const Vec2 at = home;
    for (int sy = -1; sy <= 1; ++sy) {
      for (int sx = -1; sx <= 1; ++sx) {
        const Vec2 image = at + Vec2{sx * period.x, sy * period.y};
        const bool near =
            image.x > -margin && image.x < period.x + margin && image.y > -margin && image.y < period.y + margin;
        if ((sx == 0 && sy == 0) || !near) continue;
        all.centres.push_back(image);
        all.radii.push_back(assembly.radii[d]);
      }
    }
  }
  return all;
}

/// The circle that touches three others from between them, |c - p_k| = rho + r_k (Apollonius): the differences of two
/// such equations squared are linear in c and rho, so that c = u + v rho.
std::optional<EmptyCircle> circle_between(const std::array<Vec2, 3>& p, const std::array<double, 3>& r) {
  const Vec2 a = p[1] - p[0], b = p[2] - p[0];
  const double twice_area = cross(a, b);
  if (twice_area == 0) return std::nullopt;
  const double s = r[1] - r[0], t = r[2] - r[0];
  const double g = 0.5 * (dot(a, a) - r[1] * r[1] + r[0] * r[0]), h = 0.5 * (dot(b, b) - r[2] * r[2] + r[0] * r[0]);
  const Vec2 u = Vec2{g * b.y - h * a.y, h * a.x - g * b.x} / twice_area;
  const Vec2 v = Vec2{t * a.y - s * b.y, s * b.x - t * a.x} / twice_area;
  // |u + v rho|² = (rho + r_0)²
  const double square = dot(v, v) - 1, half = dot(u, v) - r[0], rest = dot(u, u) - r[0] * r[0];
  const double root = half * half - square * rest;
  if (root < 0) return std::nullopt;
  double rho = std::numeric_limits<double>::infinity();
  const double q = -(half + std::copysign(std::sqrt(root), half));
  for (const double candidate : {q / square, rest / q})
    if (candidate > 0) rho = std::min(rho, candidate);
  if (!std::isfinite(rho)) return std::nullopt;
  return EmptyCircle{p[0] + u + rho * v, rho};
}

bool is_inside(Vec2 c, const std::array<Vec2, 3>& p) {
  const double first = cross(p[1] - p[0], c - p[0]), second = cross(p[2] - p[1], c - p[1]),
               third = cross(p[0] - p[2], c - p[2]);
  return (first >= 0 && second >= 0 && third >= 0) || (first <= 0 && second <= 0 && third <= 0);
}

/// The circles of all triangles, the largest first.
std::vector<EmptyCircle> candidates(const Circles& discs) {
  std::vector<double> weights;
  for (const double radius : discs.radii) weights.push_back(radius * radius);
  std::vector<EmptyCircle> found;
  for (const TriangulationEdge& edge : triangulation_edges(discs.centres, weights, hilbert_order(discs.centres))) {
    for (const std::int32_t third : {edge.left, edge.right}) {
      if (third <= std::max(edge.a, edge.b)) continue;  // a triangle is seen from three edges
      // The lower corner first: edges are named from either end, and bits must not depend on it.
      const auto a = static_cast<std::size_t>(std::min(edge.a, edge.b)),
                 b = static_cast<std::size_t>(std::max(edge.a, edge.b)), c = static_cast<std::size_t>(third);
      const std::array corners{discs.centres[a], discs.centres[b], discs.centres[c]};
      const auto circle = circle_between(corners, {discs.radii[a], discs.radii[b], discs.radii[c]});
      if (circle && is_inside(circle->centre, corners)) found.push_back(*circle);
    }
  }
  std::ranges::sort(found, [](const EmptyCircle& p, const EmptyCircle& q) {
    return std::tie(p.radius, p.centre.x, p.centre.y) > std::tie(q.radius, q.centre.x, q.centre.y);
  });
  return found;
}

bool in_cell(Vec2 place, Vec2 period) {
  constexpr double rounding = 1e-9;
  const auto within = [](double x, double length) { return x >= -rounding * length && x <= (1 + rounding) * length; };
  return within(place.x, period.x) && within(place.y, period.y);
}

/// The largest radius of a circle about a place that no disc reaches into; negative inside a disc or out of the box.
double room_at(Vec2 place, const Circles& discs, const std::optional<TurnedRectangle>& box) {
  double room = std::numeric_limits<double>::infinity();
  if (box) {
    const Vec2 from_low = box->seen(place - box->low), to_high = box->seen(box->high - place);
    room = std::min({from_low.x, from_low.y, to_high.x, to_high.y});
  }
  for (std::size_t d = 0; d < discs.radii.size(); ++d)
    room = std::min(room, norm(place - discs.centres[d]) - discs.radii[d]);
  return room;
}

}  // namespace

std::optional<EmptyCircle> largest_void(const Assembly& assembly) {
  constexpr int most_trials = 1000;  // each looks at all discs
  if (assembly.size() < 3) return std::nullopt;
  const Circles discs = with_images(assembly);
  std::optional<EmptyCircle> best;
  int trials = 0;
  for (const EmptyCircle& candidate : candidates(discs)) {
    if (assembly.period && !in_cell(candidate.centre, *assembly.period)) continue;  // an image of one in the cell
    if ((best && candidate.radius <= best->radius) || ++trials > most_trials) break;
    const double room = room_at(candidate.centre, discs, assembly.box);
    if (room > 0 && (!best || room > best->radius)) best = EmptyCircle{candidate.centre, room};
  }
  if (best && assembly.period) {
    const Vec2 period = *assembly.period;
    Vec2& c = best->centre;
    c -= {std::floor(c.x / period.x) * period.x, std::floor(c.y / period.y) * period.y};
  }
  return best;
}

}  // namespace equidem
