// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Area, first moments about the origin and polar moment about it.
struct Moments {
  long double area = 0, x = 0, y = 0, polar = 0;
};

/// Of what lies below a part of a circle, or of a straight line (radius 0), from x = a to b: primitives of the powers
/// of its height. \param side 1 the upper half of the circle, -1 the lower
Moments below(const Clump::Disc& disc, long double side, long double a, long double b) {
  const long double r = disc.radius, cx = disc.offset.x, cy = disc.offset.y;
  const auto at = [&](long double x) {
    const long double t = x - cx, w = std::sqrt(std::max(0.0L, (r - t) * (r + t)));
    const long double angle = r > 0 ? std::atan2(t, w) : 0, r2 = r * r;
    const long double i0 = side * (t * w + r2 * angle) / 2, i1 = -side * w * w * w / 3;
    const long double i2 = side * (t * (2 * t * t - r2) * w + r2 * r2 * angle) / 8, t3 = t * t * t / 3;
    const long double w2 = r > 0 ? r2 * t - t3 : 0;
    return Moments{cy * t + i0, cx * (cy * t + i0) + cy * t * t / 2 + i1, (cy * cy * t + w2) / 2 + cy * i0,
                   cy * (cx * cx * t + cx * t * t + t3) + cx * cx * i0 + 2 * cx * i1 + i2 +
                       (cy * cy * cy * t + r2 * i0 - i2) / 3 + cy * cy * i0 + cy * w2};
  };
  const Moments high = at(b), low = at(a);
  return {high.area - low.area, high.x - low.x, high.y - low.y, high.polar - low.polar};
}

/// An oracle without arcs that are cut or cells: between the abscissas at which circles begin, end, cross each other or
/// the region's sides, the same circles bound what a line x = const cuts; there the integrals are elementary. What
/// rounding puts into a wrong order lies between two abscissas, or two heights, that differ by rounding.
Moments moments_by_chords(const std::vector<Clump::Disc>& discs, const Rectangle& region) {
  std::vector<long double> cuts = {region.low.x, region.high.x};
  for (const Clump::Disc& disc : discs) {
    const long double x = disc.offset.x, y = disc.offset.y, r = disc.radius;
    cuts.insert(cuts.end(), {x - r, x + r});
    for (const long double side : {region.low.y, region.high.y}) {
      const long double half = std::sqrt(std::max(0.0L, (r - side + y) * (r + side - y)));
      cuts.insert(cuts.end(), {x - half, x + half});
    }
    for (const Clump::Disc& other : discs) {
      const long double dx = other.offset.x - x, dy = other.offset.y - y, d2 = dx * dx + dy * dy, s = other.radius;
      if (d2 == 0) continue;
      const long double along = (1 + (r - s) * (r + s) / d2) / 2;
      const long double across = std::sqrt(std::max(0.0L, r * r / d2 - along * along));
      cuts.insert(cuts.end(), {x + along * dx - across * dy, x + along * dx + across * dy});
    }
  }
  for (long double& cut : cuts) cut = std::clamp<long double>(cut, region.low.x, region.high.x);
  std::sort(cuts.begin(), cuts.end());
  struct Edge {
    long double height = 0, side = 0;
    Clump::Disc disc;
  };
  Moments sum;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const long double x = (cuts[k] + cuts[k + 1]) / 2;
    std::vector<std::pair<Edge, Edge>> covered;
    for (const Clump::Disc& disc : discs) {
      const long double dx = x - disc.offset.x, half2 = (disc.radius - dx) * (disc.radius + dx);
      if (half2 <= 0) continue;
      Edge low{disc.offset.y - std::sqrt(half2), -1, disc}, high{disc.offset.y + std::sqrt(half2), 1, disc};
      if (low.height < region.low.y) low = {region.low.y, 1, {{disc.offset.x, region.low.y}, 0}};
      if (high.height > region.high.y) high = {region.high.y, 1, {{disc.offset.x, region.high.y}, 0}};
      if (low.height < high.height) covered.push_back({low, high});
    }
    std::sort(covered.begin(), covered.end(),
              [](const auto& a, const auto& b) { return a.first.height < b.first.height; });
    Edge top{-INFINITY, 1, {}};
    const auto add = [&](long double sign, const Edge& edge) {
      const Moments part = below(edge.disc, edge.side, cuts[k], cuts[k + 1]);
      sum = {sum.area + sign * part.area, sum.x + sign * part.x, sum.y + sign * part.y, sum.polar + sign * part.polar};
    };
    for (const auto& [low, high] : covered) {
      if (high.height <= top.height) continue;
      add(-1, low.height > top.height ? low : top);
      add(1, high);
      top = high;
    }
  }
  return sum;
}

Vec2 turned(Vec2 x, double angle) {
  return {std::cos(angle) * x.x - std::sin(angle) * x.y, std::sin(angle) * x.x + std::cos(angle) * x.y};
}

/// Discs of a kind: at random; on grids, touching; through one point; nested, touching there or not; the same several
/// times; a tiny one at the edge of a huge one; a row in which each but the first touches the one before from inside.
std::vector<Clump::Disc> discs_of(int kind, Random& random) {
  std::vector<Clump::Disc> discs;
  const int count = 2 + static_cast<int>(random.uniform(0, 8));
  const auto whole = [&](double largest) { return std::floor(random.uniform(0, largest + 1)); };
  for (int d = 0; d < count; ++d) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), r = random.uniform(0.1, 0.8);
    const double angle = random.uniform(0, 7);
    switch (kind) {
      case 0:
        discs.push_back({{x, y}, r});
        break;
      case 1:
        discs.push_back({{whole(3) * 0.2, whole(3) * 0.2}, 0.1 * (1 + whole(2))});
        break;
      case 2: {
        const double row = whole(3);
        discs.push_back({0.2 * Vec2{whole(3) + 0.5 * row, std::sqrt(0.75) * row}, 0.1});
        break;
      }
      case 3:
        discs.push_back({r * turned({1, 0}, d % 2 == 0 ? angle : 0.25 * std::numbers::pi * whole(7)), r});
        break;
      case 4:
        discs.push_back({{0.1 * d, 0}, 0.1 * (d + 1 + (d % 3 == 2 ? 1 : 0))});
        break;
      case 5:
        discs.push_back(d % 3 == 0 ? Clump::Disc{{x, y}, r} : discs[static_cast<std::size_t>(whole(d - 1))]);
        break;
      case 6:
        discs.push_back(d == 0 ? Clump::Disc{{0, 0}, 1}
                               : Clump::Disc{turned({1 + whole(2) - 1, 0}, angle), std::pow(10, -1 - whole(8))});
        break;
      default:
        discs.push_back({{0.3 * (d % 4), 0.3 * whole(2)}, d % 2 == 0 ? 0.15 : 0.3});
    }
  }
  return discs;
}

}  // namespace

TEST_CASE("unions_of_discs_that_touch_nest_coincide_or_cross_in_one_point_have_the_moments_of_their_chords") {
  Random random(5);
  for (int k = 0; k < 1000; ++k) {
    std::vector<Clump::Disc> discs = discs_of(k % 8, random);
    const double angle = k % 16 < 8 ? 0 : random.uniform(0, 7);
    const Vec2 far = k % 5 == 0 ? Vec2{1e4, -3e4} : Vec2{};
    for (Clump::Disc& disc : discs) disc.offset = turned(disc.offset, angle) + far;
    const DiscUnion whole = union_of(discs);
    // The oracle sees the same discs from near.
    std::vector<Clump::Disc> near = discs;
    for (Clump::Disc& disc : near) disc.offset -= whole.centre;
    const Moments right = moments_by_chords(near, {{-9, -9}, {9, 9}});
    const double area = static_cast<double>(right.area), polar = static_cast<double>(right.polar);
    const Vec2 centre = {static_cast<double>(right.x) / area, static_cast<double>(right.y) / area};
    // Sides that touch discs, halve them, and others.
    const Clump::Disc& some = near[static_cast<std::size_t>(k) % near.size()];
    const double share = k % 3 == 0 ? some.radius : k % 3 == 1 ? 0.0 : random.uniform(-0.5, 0.5);
    const Rectangle region = {some.offset - Vec2{share, 1.1}, some.offset + Vec2{0.9, share}};
    const double clipped = region.area() > 0 ? static_cast<double>(moments_by_chords(near, region).area) : 0;
    const double off_area = std::abs(whole.area - area) / area;
    const double off_centre = (norm(centre) - 1e-16 * norm(far)) / std::sqrt(area);
    const double off_polar = std::abs(whole.polar_moment - polar + area * dot(centre, centre)) / polar;
    const double off_clipped =
        region.area() > 0 ? std::abs(clipped_area(near, region) - clipped) / std::min(area, region.area()) : 0;
    CAPTURE(k, discs.size(), area, off_area, off_centre, off_polar, off_clipped);
    CHECK(off_area < 1e-13);
    CHECK(off_centre < 1e-13);
    CHECK(off_polar < 1e-13);
    CHECK(off_clipped < 1e-12);
  }
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
    for (const Rectangle& region : {Rectangle{{-2, -2}, {0, 0}}, Rectangle{{0, -2}, {2, 0}}, Rectangle{{-2, 0}, {0, 2}},
                                    Rectangle{{0, 0}, {2, 2}}})
      sum += clipped_area(outline_of(grain, clumps), grain.position, region);
    CAPTURE(k, x);
    CHECK(sum == Approx(area_of(grain, clumps)).epsilon(1e-12));
  }
  // Half of an ellipse that a side halves, whatever its angle.
  CHECK(clipped_area(Outline{.a = 2, .b = 0.1, .axis = axis_at(0.7)}, {0, 0}, {{0, -5}, {5, 5}}) ==
        Approx(std::numbers::pi * 0.1).epsilon(1e-13));
}
