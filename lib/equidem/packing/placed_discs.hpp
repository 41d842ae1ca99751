// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs placed one after the other, and whether one more has room.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "equidem/packing/packing.hpp"

namespace equidem {

/// A grid of squares as wide as the largest disc; each holds the discs whose centres lie in it.
class PlacedDiscs {
 public:
  PlacedDiscs(const PackingBox& box, double largest_radius) : box_(box) {
    const double width = 2 * largest_radius;
    columns_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(box.size.x / width));
    rows_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(box.size.y / width));
    cells_.resize(static_cast<std::size_t>(columns_ * rows_));
  }

  [[nodiscard]] const std::vector<Vec2>& centres() const { return centres_; }
  [[nodiscard]] const std::vector<double>& radii() const { return radii_; }

  /// The same place in the box.
  [[nodiscard]] Vec2 wrapped(Vec2 place) const {
    if (!box_.periodic()) return place;
    return {wrapped(place.x, box_.size.x), wrapped(place.y, box_.size.y)};
  }
  /// From a to b, the shortest way.
  [[nodiscard]] Vec2 branch(Vec2 a, Vec2 b) const {
    Vec2 way = b - a;
    if (box_.periodic()) {
      way.x -= box_.size.x * std::nearbyint(way.x / box_.size.x);
      way.y -= box_.size.y * std::nearbyint(way.y / box_.size.y);
    }
    return way;
  }
  /// A wall is not in the way of a disc.
  [[nodiscard]] bool inside(Vec2 place, double radius) const {
    return box_.periodic() || (place.x >= radius && place.x <= box_.size.x - radius && place.y >= radius &&
                               place.y <= box_.size.y - radius);
  }

  /// Call body(disc) for the discs that a disc at `place` could touch, until it returns true.
  template <typename Body>
  bool any_near(Vec2 place, const Body& body) const {
    const std::int64_t column = cell_of(place.x, box_.size.x, columns_), row = cell_of(place.y, box_.size.y, rows_);
    return any_of(row, rows_, [&](std::int64_t y) {
      return any_of(column, columns_, [&](std::int64_t x) {
        const auto& cell = cells_[static_cast<std::size_t>(y * columns_ + x)];
        return std::any_of(cell.begin(), cell.end(), body);
      });
    });
  }

  /// Whether a disc overlaps no other by more than `slack`, m.
  [[nodiscard]] bool has_room(Vec2 place, double radius, double slack = 0) const {
    return inside(place, radius - slack) && !any_near(place, [&](std::int32_t other) {
             const auto k = static_cast<std::size_t>(other);
             const double reach = radii_[k] + radius - slack;
             const Vec2 way = branch(place, centres_[k]);
             return dot(way, way) < reach * reach;
           });
  }

  void add(Vec2 place, double radius) {
    cell(place).push_back(static_cast<std::int32_t>(centres_.size()));
    centres_.push_back(place);
    radii_.push_back(radius);
  }
  void move(std::int32_t disc, Vec2 place) {
    auto& from = cell(centres_[static_cast<std::size_t>(disc)]);
    auto& to = cell(place);
    if (&from != &to) {
      from.erase(std::find(from.begin(), from.end(), disc));
      to.push_back(disc);
    }
    centres_[static_cast<std::size_t>(disc)] = place;
  }

 private:
  static double wrapped(double x, double length) {
    x -= length * std::floor(x / length);
    return x < length ? x : 0;
  }
  static std::int64_t cell_of(double x, double length, std::int64_t count) {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(x / length * static_cast<double>(count)), 0, count - 1);
  }
  std::vector<std::int32_t>& cell(Vec2 place) {
    return cells_[static_cast<std::size_t>(cell_of(place.y, box_.size.y, rows_) * columns_ +
                                           cell_of(place.x, box_.size.x, columns_))];
  }
  /// The index and its neighbours, each once, across the period where there is one.
  template <typename Body>
  bool any_of(std::int64_t index, std::int64_t count, const Body& body) const {
    if (count <= 3 && box_.periodic()) {
      for (std::int64_t k = 0; k < count; ++k)
        if (body(k)) return true;
      return false;
    }
    for (std::int64_t k = index - 1; k <= index + 1; ++k) {
      if (!box_.periodic() && (k < 0 || k >= count)) continue;
      if (body((k + count) % count)) return true;
    }
    return false;
  }

  PackingBox box_;
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::int32_t>> cells_;
  std::vector<Vec2> centres_;
  std::vector<double> radii_;
};

}  // namespace equidem
