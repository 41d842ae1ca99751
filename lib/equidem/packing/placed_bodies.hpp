// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies placed one after the other, and whether one more has room.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/packing/overlaps.hpp"

namespace equidem {

struct Placement {
  Vec2 place;        ///< of the centre, m
  double turns = 0;  ///< angle over 2 pi
};

/// Anywhere, in any direction; between walls anywhere that it does not cross them.
Placement placement_at_random(const PackingOptions& options, const UnitBody& shape, double radius, Random& random);

/// Grids of squares, one for each class of sizes, a factor of four wide; each square holds the bodies whose centres lie
/// in it.
class PlacedBodies {
 public:
  /// \param radii of all bodies that may come
  PlacedBodies(const PackingBox& box, const UnitBody& shape, std::span<const double> radii);

  [[nodiscard]] const Bodies& bodies() const { return bodies_; }
  [[nodiscard]] const UnitBody& shape() const { return shape_; }
  [[nodiscard]] Vec2 centre(std::size_t body) const { return bodies_.centres[body]; }
  [[nodiscard]] double radius(std::size_t body) const { return bodies_.radii[body]; }

  [[nodiscard]] double turns(std::size_t body) const { return bodies_.turn(body); }

  /// The place, moved into the box by whole periods.
  [[nodiscard]] Vec2 wrapped(Vec2 place) const;
  /// From a to b, the shortest way.
  [[nodiscard]] Vec2 branch(Vec2 a, Vec2 b) const {
    Vec2 way = b - a;
    if (box_.periodic()) {
      way.x -= box_.size.x * std::nearbyint(way.x / box_.size.x);
      way.y -= box_.size.y * std::nearbyint(way.y / box_.size.y);
    }
    return way;
  }

  /// Call body(k) for the bodies that one of that radius at `place` could touch, and some more, until it returns true.
  template <typename Body>
  bool any_near(Vec2 place, double radius, const Body& body) const {
    return std::any_of(classes_.begin(), classes_.end(), [&](const SizeClass& sizes) {
      if (sizes.bodies == 0) return false;
      const double reach = shape_.reach * (radius + sizes.largest);
      const Span columns = span_of(place.x, reach, box_.size.x, sizes.columns);
      const Span rows = span_of(place.y, reach, box_.size.y, sizes.rows);
      for (std::int64_t row = rows.first; row <= rows.last; ++row) {
        for (std::int64_t column = columns.first; column <= columns.last; ++column) {
          const auto& cell = sizes.cells[remainder(row, sizes.rows) * sizes.columns + remainder(column, sizes.columns)];
          if (std::any_of(cell.begin(), cell.end(), body)) return true;
        }
      }
      return false;
    });
  }

  /// Call body(overlap) for all overlaps of a body at a place with others and with walls, m, until it returns true.
  /// \param angle turns
  /// \param except a body to leave out; -1: none
  template <typename Body>
  bool any_overlap(Vec2 place, double radius, double angle, std::int32_t except, const Body& body) const;

  /// Whether a body overlaps nothing by more than `slack`, m.
  [[nodiscard]] bool has_room(Vec2 place, double radius, double angle, double slack = 0) const {
    return !any_overlap(place, radius, angle, -1, [&](double overlap) { return overlap > slack; });
  }

  /// \param angle turns; not kept of what is round
  void add(Vec2 place, double radius, double angle);
  void move(std::int32_t body, Vec2 place, double angle);

 private:
  struct SizeClass {
    double largest = 0;  ///< radius, m
    std::int64_t columns = 1, rows = 1, bodies = 0;
    std::vector<std::vector<std::int32_t>> cells;
  };
  struct Span {
    std::int64_t first, last;
  };
  static std::int64_t remainder(std::int64_t k, std::int64_t count) {
    return k < 0 ? k + count : k < count ? k : k - count;
  }
  static std::int64_t cell_of(double x, double length, std::int64_t count) {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(x / length * static_cast<double>(count)), 0, count - 1);
  }
  /// Cells within reach, each once, across the period where there is one.
  [[nodiscard]] Span span_of(double x, double reach, double length, std::int64_t count) const;
  SizeClass& class_of(double radius);
  std::vector<std::int32_t>& cell(SizeClass& sizes, Vec2 place);

  PackingBox box_;
  UnitBody shape_;
  double largest_ = 0;
  std::vector<SizeClass> classes_;  ///< the largest first
  Bodies bodies_;
};

template <typename Body>
bool PlacedBodies::any_overlap(Vec2 place, double radius, double angle, std::int32_t except, const Body& body) const {
  const Outline self = shape_.outline(radius, angle);
  bool found = false;
  const auto add = [&](const Touch& touch) { found = found || body(touch.overlap); };
  for_wall_touches(self, place, box_, 0, [&](int, const Touch& touch) { add(touch); });
  return found || any_near(place, radius, [&](std::int32_t other) {
           if (other == except) return false;
           const auto k = static_cast<std::size_t>(other);
           const Vec2 way = branch(place, bodies_.centres[k]);
           const double reach = shape_.reach * (radius + bodies_.radii[k]);
           if (dot(way, way) >= reach * reach) return false;
           for_touches(self, shape_.outline(bodies_.radii[k], turns(k)), way, 0, add);
           return found;
         });
}

}  // namespace equidem
