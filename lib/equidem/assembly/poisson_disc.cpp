// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "equidem/assembly/point_process.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

/// Area that points r apart take of the plane once no more fit, over r²: the discs of diameter r then cover 0.547070
/// of it (Zhang & Torquato 2013, Phys. Rev. E 88, 053312).
constexpr double saturation_density = 4 * 0.547070 / std::numbers::pi;
/// A free side is crowded: nothing outside takes space from it. It counts as if it were this share of r further out
/// (measured on samples of this generator; only the closeness to the wanted count depends on it).
constexpr double side_gain = 1.0 / 3;

/// A square of the 2^level-th part of a base square of the grid.
struct Square {
  std::uint32_t x;
  std::uint32_t y;
};

/// A trial point in a square.
struct Dart {
  Vec2 point;
  std::int32_t column;  ///< of the base square
  std::int32_t row;
};

/// Random sequential adsorption on a grid of base squares so small that each holds at most one point.
class Adsorption {
 public:
  Adsorption(Vec2 extent, double distance, bool periodic)
      : extent_(extent), periodic_(periodic), squared_distance_(distance * distance) {
    const double widest = distance / std::numbers::sqrt2;
    columns_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(extent.x / widest)));
    rows_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(extent.y / widest)));
    size_ = {extent.x / static_cast<double>(columns_), extent.y / static_cast<double>(rows_)};
    reach_x_ = static_cast<std::int64_t>(std::ceil(distance / size_.x));
    reach_y_ = static_cast<std::int64_t>(std::ceil(distance / size_.y));
    points_.assign(static_cast<std::size_t>(columns_ * rows_), {nothing, nothing});
  }

  std::vector<Vec2> saturate(Random& random) {
    std::vector<Square> squares;
    squares.reserve(points_.size());
    for (std::int64_t y = 0; y < rows_; ++y) {
      for (std::int64_t x = 0; x < columns_; ++x) {
        squares.push_back({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)});
      }
    }
    // After twenty halvings the squares that are left are negligible.
    for (int level = 0; level <= 20 && !squares.empty(); ++level) {
      throw_darts(squares, level, random);
      squares = halved(squares, level);
    }
    return std::move(found_);
  }

 private:
  static constexpr double nothing = std::numeric_limits<double>::infinity();

  /// A few throws for every square, each into any of them, so that points stay uniform in the free space. The throws
  /// of a round are made block by block, in which they keep their order: neighbouring blocks then stay in the cache,
  /// and only throws of one round on both sides of a block's border may change places in time.
  void throw_darts(std::vector<Square>& squares, int level, Random& random) {
    const double part = 1.0 / static_cast<double>(1U << level);
    for (int round = 0; round < 6 && !squares.empty(); ++round) {
      std::vector<Dart> darts((squares.size() + 7) / 8);
      for (Dart& dart : darts) {
        const Square square = squares[random.below(squares.size())];
        dart.point = {(square.x + random.uniform()) * part * size_.x, (square.y + random.uniform()) * part * size_.y};
        dart.column = static_cast<std::int32_t>(square.x >> level);
        dart.row = static_cast<std::int32_t>(square.y >> level);
      }
      sort_by_block(darts);
      for (const Dart& dart : darts) {
        Vec2& held = points_[static_cast<std::size_t>(dart.row * columns_ + dart.column)];
        if (held.x != nothing || !is_free(dart.point, dart.column, dart.row)) continue;
        held = dart.point;
        found_.push_back(dart.point);
      }
      std::erase_if(squares, [&](const Square& square) { return taken(square, level); });
    }
  }

  [[nodiscard]] bool taken(const Square& square, int level) const {
    return points_[static_cast<std::size_t>((square.y >> level) * columns_ + (square.x >> level))].x != nothing;
  }

  /// Stable counting sort.
  void sort_by_block(std::vector<Dart>& darts) const {
    constexpr std::int64_t width = 64;
    const std::int64_t blocks_in_row = (columns_ + width - 1) / width;
    const auto block = [&](const Dart& dart) {
      return static_cast<std::size_t>(dart.row / width * blocks_in_row + dart.column / width);
    };
    std::vector<std::size_t> place(static_cast<std::size_t>((rows_ + width - 1) / width * blocks_in_row) + 1, 0);
    for (const Dart& dart : darts) ++place[block(dart) + 1];
    for (std::size_t k = 1; k < place.size(); ++k) place[k] += place[k - 1];
    std::vector<Dart> sorted(darts.size());
    for (const Dart& dart : darts) sorted[place[block(dart)]++] = dart;
    darts.swap(sorted);
  }

  /// Call body(point) for the points near a base square, nearest images where periodic, until it returns true.
  template <typename Body>
  bool any_near(std::int64_t column, std::int64_t row, const Body& body) const {
    for (std::int64_t y = row - reach_y_; y <= row + reach_y_; ++y) {
      Vec2 shift;
      const std::int64_t wy = periodic_ ? wrapped(y, rows_, extent_.y, shift.y) : y;
      if (wy < 0 || wy >= rows_) continue;
      for (std::int64_t x = column - reach_x_; x <= column + reach_x_; ++x) {
        const std::int64_t wx = periodic_ ? wrapped(x, columns_, extent_.x, shift.x) : x;
        if (wx < 0 || wx >= columns_) continue;
        const Vec2 point = points_[static_cast<std::size_t>(wy * columns_ + wx)];
        if (point.x != nothing && body(point + shift)) return true;
      }
    }
    return false;
  }

  static std::int64_t wrapped(std::int64_t index, std::int64_t count, double length, double& shift) {
    shift = 0;
    for (; index < 0; index += count) shift -= length;
    for (; index >= count; index -= count) shift += length;
    return index;
  }

  [[nodiscard]] bool is_free(Vec2 place, std::int64_t column, std::int64_t row) const {
    return !any_near(column, row, [&](Vec2 point) {
      const Vec2 d = point - place;
      return dot(d, d) < squared_distance_;
    });
  }

  /// The quarters of squares that no single point covers whole, in the order of the squares.
  [[nodiscard]] std::vector<Square> halved(const std::vector<Square>& squares, int level) const {
    constexpr std::size_t piece = 16384;
    std::vector<std::vector<Square>> quarters((squares.size() + piece - 1) / piece);
    parallel_tasks(quarters.size(), [&](std::size_t task, int) {
      std::vector<Vec2> near;
      const std::size_t end = std::min(squares.size(), (task + 1) * piece);
      for (std::size_t k = task * piece; k < end; ++k) {
        near.clear();
        any_near(squares[k].x >> level, squares[k].y >> level, [&](Vec2 point) {
          near.push_back(point);
          return false;
        });
        add_quarters(squares[k], level, near, quarters[task]);
      }
    });
    std::vector<Square> result;
    for (const auto& some : quarters) result.insert(result.end(), some.begin(), some.end());
    return result;
  }

  void add_quarters(const Square& square, int level, const std::vector<Vec2>& near,
                    std::vector<Square>& quarters) const {
    const Vec2 half = 0.5 / static_cast<double>(2U << level) * size_;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Square quarter = {2 * square.x + (k & 1U), 2 * square.y + (k >> 1U)};
      const Vec2 centre = {(2.0 * quarter.x + 1) * half.x, (2.0 * quarter.y + 1) * half.y};
      const bool covered = std::any_of(near.begin(), near.end(), [&](Vec2 point) {
        const Vec2 furthest = {std::abs(point.x - centre.x) + half.x, std::abs(point.y - centre.y) + half.y};
        return dot(furthest, furthest) < squared_distance_;
      });
      if (!covered) quarters.push_back(quarter);
    }
  }

  Vec2 extent_;
  bool periodic_;
  double squared_distance_;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t reach_x_ = 0;  ///< base squares to either side that can hold a point in the way
  std::int64_t reach_y_ = 0;
  Vec2 size_;                 ///< of a base square
  std::vector<Vec2> points_;  ///< of each base square
  std::vector<Vec2> found_;
};

/// The distance r at which `count` points are expected: count r² = density (width + 2 gain r) (height + 2 gain r).
double distance_for(double count, Vec2 extent, double gain) {
  const double a = count / saturation_density - 4 * gain * gain;
  const double b = 2 * gain * (extent.x + extent.y);
  const double c = extent.x * extent.y;
  return (b + std::sqrt(b * b + 4 * std::max(a, 0.0) * c)) / (2 * std::max(a, 0.1));
}

}  // namespace

PointSet poisson_disc_points(const PointOptions& options, Random& random) {
  const auto count = static_cast<double>(options.count);
  const double area_per_point = 0.5 * std::numbers::sqrt3 * options.spacing * options.spacing;
  // At first in units in which a point has the area 1; the number found decides the scale.
  const double height = std::sqrt(count / options.aspect);
  const Vec2 extent = {count / height, height};
  const double distance = distance_for(count, extent, options.periodic ? 0 : side_gain);
  PointSet set;
  set.points = Adsorption(extent, distance, options.periodic).saturate(random);
  const double scale = std::sqrt(area_per_point * static_cast<double>(set.points.size()) / count);
  for (Vec2& point : set.points) point *= scale;
  set.extent = scale * extent;
  return set;
}

}  // namespace equidem
