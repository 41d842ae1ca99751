// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "equidem/contact/shapes/ellipse.hpp"
#include "equidem/grains/neighbours/neighbours.hpp"

namespace equidem {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Raises the columns that a convex body spans.
class Raised {
 public:
  Raised(SurfaceProfile& profile, double right) : profile_(profile), right_(right) {}

  /// \param ellipse its upper boundary over x: concave, highest at its top, lower to both sides
  void by(const Ellipse& ellipse, Vec2 centre) {
    // y(x) = (c x + sqrt(det (w² - x²)))/w², w the reach along x, from Q = R diag(a², b²) R^T = [w² c; c ..].
    const double p = ellipse.axis.x, q = ellipse.axis.y, aa = ellipse.a * ellipse.a, bb = ellipse.b * ellipse.b;
    const double w2 = aa * p * p + bb * q * q, c = (aa - bb) * p * q, w = std::sqrt(w2);
    const double top = c / std::sqrt(aa * q * q + bb * p * p);  // x of the highest point
    const auto count = static_cast<double>(profile_.heights.size());
    const auto column = [&](double x) {
      return static_cast<std::size_t>(std::clamp((x - profile_.left) / profile_.width, 0.0, count - 1));
    };
    if (centre.x + w <= profile_.left || centre.x - w >= right_) return;
    for (std::size_t k = column(centre.x - w); k <= column(centre.x + w); ++k) {
      const double from = profile_.left + profile_.width * static_cast<double>(k) - centre.x;
      const double x = std::clamp(std::clamp(top, from, from + profile_.width), -w, w);
      const double height = centre.y + (c * x + ellipse.a * ellipse.b * std::sqrt(std::max(0.0, w2 - x * x))) / w2;
      double& highest = profile_.heights[k];
      if (!(highest >= height)) highest = height;
    }
  }

 private:
  SurfaceProfile& profile_;
  double right_;
};

}  // namespace

SurfaceProfile surface_of(std::span<const Grain> grains, std::span<const Clump> clumps, double left, double right,
                          std::size_t columns, std::span<const char> heap) {
  assert(columns >= 1 && left < right && (heap.empty() || heap.size() == grains.size()));
  SurfaceProfile profile{.left = left, .width = (right - left) / static_cast<double>(columns), .heights = {}};
  profile.heights.assign(columns, not_a_number);
  Raised raised(profile, right);
  for (std::size_t g = 0; g < grains.size(); ++g) {
    if (!heap.empty() && !heap[g]) continue;
    const Grain& grain = grains[g];
    if (grain.shape() == GrainShape::clump) {
      const Vec2 axis{std::cos(grain.angle), std::sin(grain.angle)};
      for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs)
        raised.by({disc.radius, disc.radius},
                  grain.position + disc.offset.x * axis + disc.offset.y * perpendicular(axis));
    } else if (grain.shape() == GrainShape::ellipse) {
      raised.by(Ellipse::at_angle(grain.radius, grain.short_half_axis, grain.angle), grain.position);
    } else {
      raised.by({grain.radius, grain.radius}, grain.position);
    }
  }
  return profile;
}

SurfaceShape shape_of(const SurfaceProfile& profile) {
  double n = 0, x_mean = 0, y_mean = 0;
  const auto for_columns = [&](const auto& body) {
    for (std::size_t k = 0; k < profile.heights.size(); ++k)
      if (!std::isnan(profile.heights[k])) body(profile.place(k), profile.heights[k]);
  };
  for_columns([&](double x, double y) {
    n += 1;
    x_mean += x;
    y_mean += y;
  });
  if (n == 0) return {not_a_number, not_a_number, not_a_number};
  x_mean /= n;
  y_mean /= n;
  double xx = 0, xy = 0;
  for_columns([&](double x, double y) {
    xx += (x - x_mean) * (x - x_mean);
    xy += (x - x_mean) * (y - y_mean);
  });
  SurfaceShape shape{.height = y_mean, .slope = xx > 0 ? xy / xx : 0};
  double squares = 0;
  for_columns([&](double x, double y) {
    const double off = y - y_mean - shape.slope * (x - x_mean);
    squares += off * off;
  });
  shape.roughness = std::sqrt(squares / n);
  return shape;
}

std::vector<char> heap_of(std::span<const Grain> grains, double gap) {
  std::vector<Circle> circles;
  for (const Grain& grain : grains) circles.push_back({grain.position, grain.radius});
  const NeighbourList list = neighbours_within(circles, gap);
  std::vector<std::size_t> leader(grains.size());
  std::iota(leader.begin(), leader.end(), std::size_t{0});
  const auto lead = [&](std::size_t k) {
    while (leader[k] != k) k = leader[k] = leader[leader[k]];
    return k;
  };
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (auto at = list.begin[i]; at < list.begin[i + 1]; ++at) {
      const std::size_t a = lead(i), b = lead(static_cast<std::size_t>(list.partner[static_cast<std::size_t>(at)]));
      leader[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::size_t> sizes(grains.size(), 0);
  for (std::size_t k = 0; k < grains.size(); ++k) ++sizes[lead(k)];
  const auto largest = static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<char> heap(grains.size());
  for (std::size_t k = 0; k < grains.size(); ++k) heap[k] = lead(k) == largest ? 1 : 0;
  return heap;
}

Vec2 centre_of_mass(std::span<const Grain> grains) {
  double mass = 0;
  Vec2 sum;
  for (const Grain& grain : grains) {
    mass += grain.inertia.mass;
    sum += grain.inertia.mass * grain.position;
  }
  return sum / mass;
}

}  // namespace equidem
