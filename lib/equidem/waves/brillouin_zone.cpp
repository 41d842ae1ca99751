// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/brillouin_zone.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double same = 1e-6;  // of the zone or the angle

/// The centre of the circle through 0, a and b: a corner of the zone, as near to 0 as to its neighbours a and b.
Vec2 circumcentre(Vec2 a, Vec2 b) {
  const double twice = 2 * cross(a, b);
  return Vec2{b.y * dot(a, a) - a.y * dot(b, b), a.x * dot(b, b) - b.x * dot(a, a)} / twice;
}

/// Climbs from a grid point on stencils of nine points: to the best of them, or to the top of the paraboloid that they
/// suggest, with a smaller stencil wherever the centre is best.
class Climb {
 public:
  Climb(const BrillouinZone& zone, const std::function<double(Vec2)>& f, double step)
      : zone_(zone), f_(f), step_(step) {}

  /// The top near x, in units of the reciprocal vectors.
  ZonePoint from(Vec2 x, double& value, int steps) {
    value = at(x);
    for (int k = 0; k < steps && step_ > 1e-9; ++k) {
      double v[3][3];
      Vec2 best = x;
      double top = value;
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
          const Vec2 y = x + Vec2{i * step_, j * step_};
          v[i + 1][j + 1] = i == 0 && j == 0 ? value : at(y);
          if (v[i + 1][j + 1] > top) top = v[i + 1][j + 1], best = y;
        }
      }
      const double gx = v[2][1] - v[0][1], gy = v[1][2] - v[1][0];
      const double hxx = 4 * (v[2][1] - 2 * v[1][1] + v[0][1]), hyy = 4 * (v[1][2] - 2 * v[1][1] + v[1][0]);
      const double hxy = v[2][2] - v[2][0] - v[0][2] + v[0][0], det = hxx * hyy - hxy * hxy;
      double to_top = std::numeric_limits<double>::infinity();  // in steps
      if (hxx < 0 && det > 0) {
        const Vec2 shift = Vec2{hxy * gy - hyy * gx, hxy * gx - hxx * gy} * (2 / det);
        to_top = norm(shift);
        const Vec2 y = x + step_ * shift;
        const double there = to_top < 2 ? at(y) : -std::numeric_limits<double>::infinity();
        if (there > top) top = there, best = y;
      }
      const bool inside = norm(best - x) < 0.9 * step_;
      const double gain = top - value;
      x = best, value = top;
      if (inside) step_ *= 0.25;
      if (gain <= 1e-15 * std::abs(value) && (step_ < 1e-4 || to_top < 1e-6)) break;
    }
    return {"", zone_.folded(wave_vector(x))};
  }

 private:
  [[nodiscard]] Vec2 wave_vector(Vec2 x) const { return x.x * zone_.reciprocal[0] + x.y * zone_.reciprocal[1]; }
  [[nodiscard]] double at(Vec2 x) const {
    const double value = f_(wave_vector(x));
    return std::isfinite(value) ? value : -std::numeric_limits<double>::infinity();
  }

  const BrillouinZone& zone_;
  const std::function<double(Vec2)>& f_;
  double step_;
};

}  // namespace

Vec2 BrillouinZone::folded(Vec2 q) const {
  // The shortest of the nine nearest by coordinates; the first of several.
  const double size = cross(reciprocal[0], reciprocal[1]);
  const double x = cross(q, reciprocal[1]) / size, y = cross(reciprocal[0], q) / size;
  q -= std::round(x) * reciprocal[0] + std::round(y) * reciprocal[1];
  Vec2 shortest = q;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const Vec2 p = q + i * reciprocal[0] + j * reciprocal[1];
      if (norm(p) < norm(shortest) * (1 - same)) shortest = p;
    }
  }
  return shortest;
}

bool BrillouinZone::equivalent(Vec2 p, Vec2 q) const {
  const double near = same * norm(reciprocal[0]);
  return norm(folded(p - q)) < near || norm(folded(p + q)) < near;
}

std::string BrillouinZone::name_of(Vec2 q) const {
  for (const ZonePoint& point : points)
    if (equivalent(point.q, q)) return point.name;
  return {};
}

BrillouinZone brillouin_zone(const std::array<Vec2, 2>& period) {
  const auto [a, b] = period;
  const double area = cross(a, b), cosine = dot(a, b) / (norm(a) * norm(b));
  const bool equal = std::abs(norm(a) - norm(b)) < same * norm(a);
  const bool upright = std::abs(cosine) < same;
  BrillouinZone zone;
  zone.reciprocal = {2 * std::numbers::pi / area * Vec2{b.y, -b.x}, 2 * std::numbers::pi / area * Vec2{-a.y, a.x}};
  const auto [g, h] = zone.reciprocal;
  const Vec2 corner = circumcentre(g, g + h), other_corner = circumcentre(g + h, h);
  const auto named = [](const char* name, Vec2 q) {  // no -0
    return ZonePoint{name, q + Vec2{}};
  };
  const ZonePoint gamma = named("Gamma", {});
  if (upright && equal) {
    zone.lattice = "square";
    zone.points = {gamma, named("X", 0.5 * g), named("X", 0.5 * h), named("M", 0.5 * (g + h))};
    zone.path = {gamma, zone.points[1], zone.points[3], gamma};
  } else if (upright) {
    zone.lattice = "rectangular";
    zone.points = {gamma, named("X", 0.5 * g), named("Y", 0.5 * h), named("S", 0.5 * (g + h))};
    zone.path = {gamma, zone.points[1], zone.points[3], zone.points[2], gamma};
  } else if (equal && std::abs(cosine - 0.5) < same) {
    zone.lattice = "hexagonal";
    zone.points = {gamma,
                   named("M", 0.5 * g),
                   named("M", 0.5 * h),
                   named("M", 0.5 * (g + h)),
                   named("K", corner),
                   named("K", other_corner)};
    zone.path = {gamma, zone.points[1], zone.points[4], gamma};
  } else {
    zone.lattice = "oblique";
    zone.points = {gamma,
                   named("X", 0.5 * g),
                   named("Y", 0.5 * h),
                   named("C", 0.5 * (g + h)),
                   named("H", corner),
                   named("H", other_corner)};
    zone.path = {gamma, zone.points[1], zone.points[4], zone.points[3], zone.points[5], zone.points[2], gamma};
  }
  return zone;
}

std::vector<Vec2> zone_grid(const BrillouinZone& zone, int n) {
  std::vector<Vec2> grid;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; 2 * j <= n; ++j)
      grid.push_back(static_cast<double>(i) / n * zone.reciprocal[0] + static_cast<double>(j) / n * zone.reciprocal[1]);
  }
  return grid;
}

ZoneMaximum maximize_over_zone(const BrillouinZone& zone, const std::function<double(Vec2 q)>& f,
                               const ZoneSearch& search) {
  const std::vector<Vec2> grid = zone_grid(zone, search.grid);
  ZoneMaximum result;
  result.on_grid.resize(grid.size());
  result.on_points.resize(zone.points.size());
  parallel_tasks(grid.size() + zone.points.size(), [&](std::size_t k, int) {
    if (k < grid.size()) {
      result.on_grid[k] = f(grid[k]);
    } else {
      result.on_points[k - grid.size()] = f(zone.points[k - grid.size()].q);
    }
  });

  const auto rank = [](double value) {
    return std::isfinite(value) ? value : -std::numeric_limits<double>::infinity();
  };
  std::vector<std::size_t> order(grid.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t p, std::size_t q) { return rank(result.on_grid[p]) > rank(result.on_grid[q]); });
  const std::size_t starts = std::min<std::size_t>(std::max(search.refine, 0), order.size());
  std::vector<ZonePoint> tops(starts);
  std::vector<double> heights(starts);
  const auto columns = static_cast<std::size_t>(search.grid) / 2 + 1;
  parallel_tasks(starts, [&](std::size_t k, int) {
    const std::size_t row = order[k] / columns, column = order[k] % columns;
    const Vec2 start{static_cast<double>(row) / search.grid, static_cast<double>(column) / search.grid};
    tops[k] = Climb(zone, f, 0.5 / search.grid).from(start, heights[k], search.steps);
  });

  result.value = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < starts; ++k)
    if (rank(heights[k]) > result.value) result.value = heights[k], result.at = tops[k];
  double largest = 0;
  for (const double value : result.on_points)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  const double margin = 1e-9 * (std::isfinite(result.value) ? std::abs(result.value) : 0.0) + 1e-13 * largest;
  for (std::size_t k = 0; k < zone.points.size(); ++k) {
    const double value = rank(result.on_points[k]);
    if (value < result.value - margin) continue;
    if (result.points.empty() || value > result.value + margin) {
      result.points.clear();
      result.value = std::max(value, result.value);
      result.at = zone.points[k];
    }
    result.points.push_back(zone.points[k]);
  }
  return result;
}

}  // namespace equidem
