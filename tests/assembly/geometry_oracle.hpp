// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Plain power cells, by cutting a polygon with every other disc: slow, and simple enough to be believed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include "equidem/assembly/power_cells.hpp"

namespace equidem::oracle {

/// A corner of a polygon and what cut the edge that leaves it: the index of a site, or -1 for the outline.
struct Corner {
  Vec2 x;
  std::ptrdiff_t cut_by = -1;
};
using Polygon = std::vector<Corner>;

inline Polygon rectangle(const TurnedRectangle& r) {
  const Vec2 width = r.size().x * r.along;
  return {{r.low}, {r.low + width}, {r.high}, {r.high - width}};
}

/// The part of a polygon with normal . x <= offset.
inline Polygon cut(const Polygon& polygon, Vec2 normal, double offset, std::ptrdiff_t cut_by) {
  Polygon result;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Corner& p = polygon[k];
    const Vec2 q = polygon[(k + 1) % polygon.size()].x;
    const double hp = dot(normal, p.x) - offset;
    const double hq = dot(normal, q) - offset;
    const Vec2 crossing = p.x + (hp / (hp - hq)) * (q - p.x);
    if (hp <= 0) result.push_back(p);
    if (hp <= 0 && hq > 0) result.push_back({crossing, cut_by});
    if (hp > 0 && hq <= 0) result.push_back({crossing, p.cut_by});
  }
  return result;
}

inline double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    twice += cross(polygon[k].x, polygon[(k + 1) % polygon.size()].x);
  }
  return 0.5 * twice;
}

/// A disc or an image of it.
struct Site {
  Vec2 x;
  double weight = 0;
  std::int32_t disc = 0;
  std::int32_t shift_x = 0;
  std::int32_t shift_y = 0;
};

using Pair = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t>;
struct Neighbour {
  Pair pair;  ///< i, j, shift x, shift y as a contact names them
  double facet = 0;
};
struct Cells {
  std::vector<double> areas;
  std::vector<Neighbour> neighbours;  ///< ascending by pair
};

/// Cells of an assembly whose centres lie in its cell where periodic, with `rings` of images around it.
inline Cells cells(const Assembly& assembly, const TurnedRectangle& domain, int rings) {
  std::vector<Site> sites;
  const Vec2 period = assembly.period.value_or(Vec2{});
  const int around = assembly.periodic() ? rings : 0;
  for (int sy = -around; sy <= around; ++sy) {
    for (int sx = -around; sx <= around; ++sx) {
      for (std::size_t d = 0; d < assembly.size(); ++d) {
        sites.push_back({assembly.centres[d] + Vec2{sx * period.x, sy * period.y},
                         assembly.radii[d] * assembly.radii[d], static_cast<std::int32_t>(d), sx, sy});
      }
    }
  }
  const double far = 3 * around;
  TurnedRectangle outline = domain;
  if (assembly.periodic()) outline = Rectangle{-far * period, (1 + far) * period};
  Cells result;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const Vec2 x = assembly.centres[d];
    const double weight = assembly.radii[d] * assembly.radii[d];
    Polygon cell = rectangle(outline);
    for (std::size_t k = 0; k < sites.size(); ++k) {
      const Site& s = sites[k];
      if (s.disc == static_cast<std::int32_t>(d) && s.shift_x == 0 && s.shift_y == 0) continue;
      const Vec2 l = s.x - x;
      cell = cut(cell, 2 * l, dot(s.x, s.x) - dot(x, x) + weight - s.weight, static_cast<std::ptrdiff_t>(k));
    }
    result.areas.push_back(area(cell));
    for (std::size_t k = 0; k < cell.size(); ++k) {
      if (cell[k].cut_by < 0) continue;
      const Site& s = sites[static_cast<std::size_t>(cell[k].cut_by)];
      const auto i = static_cast<std::int32_t>(d);
      if (std::tuple(i, 0, 0) > std::tuple(s.disc, s.shift_x, s.shift_y)) continue;
      const double facet = norm(cell[(k + 1) % cell.size()].x - cell[k].x);
      if (facet <= 1e-9 * norm(s.x - x)) continue;
      result.neighbours.push_back({{i, s.disc, s.shift_x, s.shift_y}, facet});
    }
  }
  std::sort(result.neighbours.begin(), result.neighbours.end(),
            [](const Neighbour& a, const Neighbour& b) { return a.pair < b.pair; });
  return result;
}

inline Pair pair(const Contact& c) {
  return {c.i, c.j, c.shift_x, c.shift_y};
}

}  // namespace equidem::oracle
