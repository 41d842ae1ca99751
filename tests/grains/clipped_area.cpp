// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/clipped_area.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Area of what holds a point, by thin strips of which each is measured exactly: an oracle without Green's theorem.
double area_by_strips(const std::vector<Clump::Disc>& discs, const Region& region) {
  constexpr int strips = 40000;
  const double width = (region.high.x - region.low.x) / strips;
  double area = 0;
  for (int k = 0; k < strips; ++k) {
    const double x = region.low.x + (k + 0.5) * width;
    std::vector<std::pair<double, double>> covered;
    for (const Clump::Disc& disc : discs) {
      const double dx = x - disc.offset.x, half2 = disc.radius * disc.radius - dx * dx;
      if (half2 <= 0) continue;
      const double low = std::max(region.low.y, disc.offset.y - std::sqrt(half2));
      const double high = std::min(region.high.y, disc.offset.y + std::sqrt(half2));
      if (low < high) covered.push_back({low, high});
    }
    std::sort(covered.begin(), covered.end());
    double top = -INFINITY;
    for (const auto& [low, high] : covered) {
      area += width * std::max(0.0, high - std::max(low, top));
      top = std::max(top, high);
    }
  }
  return area;
}

}  // namespace

TEST_CASE("unions_of_discs_have_the_areas_that_strips_measure") {
  Random random(5);
  for (int k = 0; k < 12; ++k) {
    std::vector<Clump::Disc> discs;
    for (int d = 0; d < 1 + k % 5; ++d) {
      const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5);
      discs.push_back({{x, y}, random.uniform(0.1, 0.5)});
    }
    if (k % 4 == 3) discs.push_back(discs.front());  // counts once
    const double x = random.uniform(-0.6, 0), y = random.uniform(-0.6, 0);
    const Region region = {{x, y}, {x + 0.7, y + 0.6}}, all = {{-2, -2}, {2, 2}};
    CAPTURE(k, discs.size());
    CHECK(clipped_area(discs, region) == Approx(area_by_strips(discs, region)).margin(2e-6));
    CHECK(clipped_area(discs, all) == Approx(union_of(discs).area).epsilon(1e-12));
    CHECK(union_of(discs).area == Approx(area_by_strips(discs, all)).margin(2e-5));
  }
}

TEST_CASE("unions_of_discs_apart_have_centre_and_moment_by_the_theorem_of_parallel_axes") {
  const std::vector<Clump::Disc> discs = {{{100, 50}, 0.5}, {{101.5, 50.3}, 1}};
  const double pi = std::numbers::pi, a = pi * 0.25, b = pi;
  const DiscUnion whole = union_of(discs);
  CHECK(whole.area == Approx(a + b).epsilon(1e-13));
  const Vec2 centre = (a * discs[0].offset + b * discs[1].offset) / (a + b);
  CHECK(norm(whole.centre - centre) < 1e-12);
  double polar = 0;
  for (const Clump::Disc& disc : discs) {
    const Vec2 way = disc.offset - centre;
    polar += pi * disc.radius * disc.radius * (0.5 * disc.radius * disc.radius + dot(way, way));
  }
  CHECK(whole.polar_moment == Approx(polar).epsilon(1e-11));
}

TEST_CASE("regions_that_tile_the_plane_share_every_body_between_them") {
  const std::vector<Clump> clumps = {{{{{-0.2, 0}, 0.3}, {{0.3, 0.1}, 0.25}}}};
  Random random(8);
  for (int k = 0; k < 40; ++k) {
    Grain grain;
    grain.radius = 0.55;
    grain.angle = random.uniform(0, 6);
    const double x = random.uniform(-0.4, 0.4);
    grain.position = {x, random.uniform(-0.4, 0.4)};
    if (k % 3 == 1) grain.short_half_axis = 0.2;
    if (k % 3 == 2) grain.clump = 0;
    double sum = 0;
    for (const Region& region :
         {Region{{-2, -2}, {0, 0}}, Region{{0, -2}, {2, 0}}, Region{{-2, 0}, {0, 2}}, Region{{0, 0}, {2, 2}}})
      sum += clipped_area(grain, clumps, region);
    CAPTURE(k, x);
    CHECK(sum == Approx(area_of(grain, clumps)).epsilon(1e-12));
  }
  // Half of an ellipse that a side halves, whatever its angle.
  CHECK(clipped_area(Ellipse::at_angle(2, 0.1, 0.7), {0, 0}, {{0, -5}, {5, 5}}) ==
        Approx(std::numbers::pi * 0.1).epsilon(1e-13));
}
