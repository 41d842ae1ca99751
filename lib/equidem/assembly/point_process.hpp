// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Random points in a rectangle. Only sums, products, quotients and square roots are used, which IEEE 754 rounds the
/// same on every machine, so that a seed gives the same bits everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

enum class PointProcess {
  poisson_disc,         ///< random points no closer than a distance (blue noise)
  perturbed_hexagonal,  ///< hexagonal lattice, each point moved at random by at most `disorder` times the
                        ///< spacing
  uniform,              ///< independent uniform points (Poisson process conditioned on its count)
};

template <>
struct EnumNames<PointProcess> {
  static constexpr const char* what = "kind of points";
  static constexpr NamedValue<PointProcess> list[] = {{PointProcess::poisson_disc, "poisson_disc"},
                                                      {PointProcess::perturbed_hexagonal, "perturbed_hexagonal"},
                                                      {PointProcess::uniform, "random"}};
};

struct PointOptions {
  std::int64_t count = 10000;  ///< wanted
  double spacing = 1;          ///< m: the rectangle has sqrt3/2 spacing² per point, as the hexagonal lattice has
  double aspect = 1;           ///< wanted width over height
  bool periodic = false;
};

/// Points of a rectangle from the origin to `extent`.
struct PointSet {
  std::vector<Vec2> points;  ///< m, in [0, extent); where free, also on the sides
  Vec2 extent;               ///< m
};

/// Independent uniform points, exactly `count`.
PointSet uniform_points(const PointOptions& options, Random& random);

/// Staggered rows of equally many points, the spacing apart, each point moved by a vector uniform in the disc of the
/// radius disorder * spacing (where free, mirrored back at the sides). The rectangle is the lattice's own: whole
/// columns and rows (even in number where periodic) that come nearest to the aspect and then to the count.
PointSet perturbed_hexagonal_points(const PointOptions& options, double disorder, Random& random);

/// Points at least a distance r apart, added one by one, uniformly in the free space, until none is left: the
/// saturated state of random sequential adsorption, also called maximal Poisson-disc sampling. Each point is tried in
/// squares that are not wholly covered yet; those left over are halved (Ebeida et al. 2012, Comput. Graph. Forum 31).
/// r is chosen so that the expected number of points is the wanted one; the number itself falls where it may, within
/// about 0.2/sqrt(count) of that, and the rectangle is scaled so that the spacing holds exactly.
PointSet poisson_disc_points(const PointOptions& options, Random& random);

}  // namespace equidem
