// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Wave vectors of a periodic assembly: the first Brillouin zone, its points of symmetry, and the search for the
/// largest value of a function over it.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

/// A named wave vector, rad/m.
struct ZonePoint {
  std::string name;  ///< "Gamma", "M", "K", "X", ...; empty: none
  Vec2 q;
};

/// The zone of a lattice. Two wave vectors that differ by a reciprocal lattice vector are the same wave.
struct BrillouinZone {
  std::string lattice;             ///< "hexagonal", "square", "rectangular" or "oblique"
  std::array<Vec2, 2> reciprocal;  ///< rad/m, period_a . reciprocal_b = 2 pi delta_ab
  /// Points of symmetry, inequivalent ones all listed: hexagonal Gamma, M (3), K (2); square Gamma, X (2), M;
  /// rectangular Gamma, X, Y, S; oblique Gamma, the middles X, Y, C of the sides and the corners H (2: q and -q, as K
  /// is).
  std::vector<ZonePoint> points;
  /// Corners of the usual path: Gamma-M-K-Gamma, Gamma-X-M-Gamma, Gamma-X-S-Y-Gamma, Gamma-X-H-C-H-Y-Gamma.
  std::vector<ZonePoint> path;

  /// The shortest of the equivalent wave vectors.
  [[nodiscard]] Vec2 folded(Vec2 q) const;
  /// Whether two wave vectors are the same wave, or run opposite ways (to 1e-6 of the zone).
  [[nodiscard]] bool equivalent(Vec2 p, Vec2 q) const;
  /// The point of symmetry there, or an empty name.
  [[nodiscard]] std::string name_of(Vec2 q) const;
};

/// \param period lattice vectors, m, the shortest two, at 60 to 90 degrees
BrillouinZone brillouin_zone(const std::array<Vec2, 2>& period);

/// (i/n) b1 + (j/n) b2 for 0 <= i < n, 0 <= j <= n/2: since q and -q are alike, half of the grid is all of it.
std::vector<Vec2> zone_grid(const BrillouinZone& zone, int n);

struct ZoneSearch {
  int grid = 48;   ///< n of zone_grid, even: holds the middles of the sides
  int refine = 4;  ///< grid points whose neighbourhood is searched
  int steps = 40;  ///< of each such search, at most
};

/// The largest value found and where.
struct ZoneMaximum {
  double value = 0;
  ZonePoint at;                   ///< a point of symmetry where one reaches the value
  std::vector<ZonePoint> points;  ///< all points of symmetry that reach it to 1e-9
  std::vector<double> on_grid;    ///< values at zone_grid
  std::vector<double> on_points;  ///< values at zone.points
};

/// The largest value of f, by a grid, all points of symmetry, and then a derivative-free climb from the best grid
/// points. What is found is a lower bound of the maximum; symmetry makes the points of symmetry stationary, where f is
/// smooth. \param f of q and of -q alike; may be called by several threads at once; not finite: left out
ZoneMaximum maximize_over_zone(const BrillouinZone& zone, const std::function<double(Vec2 q)>& f,
                               const ZoneSearch& search = {});

}  // namespace equidem
