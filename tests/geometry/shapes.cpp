// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Areas and moments of unions of discs, beside sums over a fine grid.
#include "equidem/geometry/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Sums over the centres of squares of that side; their error is that of the squares that the outline crosses.
DiscUnion summed(const std::vector<Clump::Disc>& discs, double side, const Rectangle& region) {
  DiscUnion sum;
  double square = 0;
  for (double x = region.low.x + side / 2; x < region.high.x; x += side) {
    for (double y = region.low.y + side / 2; y < region.high.y; y += side) {
      const Vec2 at{x, y};
      const auto holds = [&](const Clump::Disc& disc) { return norm(at - disc.offset) < disc.radius; };
      if (std::none_of(discs.begin(), discs.end(), holds)) continue;
      sum.area += side * side;
      sum.centre += side * side * at;
      square += side * side * dot(at, at);
    }
  }
  sum.centre = sum.centre / sum.area;
  sum.polar_moment = square - sum.area * dot(sum.centre, sum.centre);
  return sum;
}

}  // namespace

TEST_CASE("area_centroid_and_moment_of_a_union_count_each_point_once") {
  const auto discs = GENERATE(values<std::vector<Clump::Disc>>({{{{0.3, 0.1}, 1}},
                                                                {{{0, 0}, 1}, {{1.2, 0.3}, 0.7}},
                                                                {{{0, 0}, 1}, {{3, 0}, 0.5}},
                                                                {{{0, 0}, 1}, {{1, 0.2}, 0.8}, {{0.4, 0.9}, 0.6}}}));
  constexpr double side = 2e-3;
  const Rectangle all{{-1.5, -1.5}, {4, 2}}, part{{-0.35, -0.7}, {1.1, 0.6}};
  const DiscUnion exact = union_of(discs), sum = summed(discs, side, all);
  CAPTURE(discs.size(), exact.area, sum.area, exact.polar_moment, sum.polar_moment);
  // About the length of the outline times the side, a hundredth of that by chance of signs.
  constexpr double error = 0.02 * 20 * side;
  CHECK(std::abs(exact.area - sum.area) < error);
  CHECK(norm(exact.centre - sum.centre) < error);
  CHECK(std::abs(exact.polar_moment - sum.polar_moment) < 4 * error);
  CHECK(std::abs(clipped_area(discs, part) - summed(discs, side, part).area) < error);
}
