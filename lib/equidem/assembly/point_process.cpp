// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/point_process.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double sqrt3 = std::numbers::sqrt3;

/// The rectangle of the wanted aspect with room for the wanted count.
Vec2 wanted_extent(const PointOptions& options) {
  const double area = 0.5 * sqrt3 * options.spacing * options.spacing * static_cast<double>(options.count);
  const double height = std::sqrt(area / options.aspect);
  return {area / height, height};
}

/// Uniform in the disc of radius 1, by rejection.
Vec2 in_unit_disc(Random& random) {
  for (;;) {
    const double x = random.uniform(-1, 1);
    const double y = random.uniform(-1, 1);
    if (x * x + y * y <= 1) return {x, y};
  }
}

/// x moved by whole periods into [0, length).
double wrapped(double x, double length) {
  if (x < 0) x += length;
  if (x >= length) x -= length;
  return x;
}

/// x mirrored at the nearer end into [0, length].
double mirrored(double x, double length) {
  if (x < 0) x = -x;
  if (x > length) x = 2 * length - x;
  return x;
}

/// The whole number >= least nearest to x of those that `step` apart.
std::int64_t nearest_multiple(double x, std::int64_t step, std::int64_t least) {
  return std::max(least, step * static_cast<std::int64_t>(std::floor(x / static_cast<double>(step) + 0.5)));
}

}  // namespace

PointSet uniform_points(const PointOptions& options, Random& random) {
  PointSet set;
  set.extent = wanted_extent(options);
  set.points.resize(static_cast<std::size_t>(options.count));
  for (Vec2& point : set.points) {
    point.x = random.uniform() * set.extent.x;
    point.y = random.uniform() * set.extent.y;
  }
  return set;
}

PointSet perturbed_hexagonal_points(const PointOptions& options, double disorder, Random& random) {
  const double s = options.spacing;
  const double row_distance = 0.5 * sqrt3 * s;
  const Vec2 wanted = wanted_extent(options);
  const std::int64_t step = options.periodic ? 2 : 1;
  const std::int64_t rows = nearest_multiple(wanted.y / row_distance, step, step);
  const std::int64_t columns = nearest_multiple(static_cast<double>(options.count) / static_cast<double>(rows), 1, 1);
  PointSet set;
  set.extent = {static_cast<double>(columns) * s, static_cast<double>(rows) * row_distance};
  set.points.reserve(static_cast<std::size_t>(rows * columns));
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t column = 0; column < columns; ++column) {
      const Vec2 site = {(static_cast<double>(column) + (row % 2 == 0 ? 0.25 : 0.75)) * s,
                         (static_cast<double>(row) + 0.5) * row_distance};
      const Vec2 moved = site + disorder * s * in_unit_disc(random);
      set.points.push_back(options.periodic ? Vec2{wrapped(moved.x, set.extent.x), wrapped(moved.y, set.extent.y)}
                                            : Vec2{mirrored(moved.x, set.extent.x), mirrored(moved.y, set.extent.y)});
    }
  }
  return set;
}

}  // namespace equidem
