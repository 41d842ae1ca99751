// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Neighbour lists of bodies that may touch, with a margin so that they are valid for many steps; pairs of bodies that
/// repeat.
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

/// Bounding circle of a body.
struct Circle {
  Vec2 centre;
  double radius = 0;
};

/// Pairs i < j whose circles come nearer than the margin, |x_i - x_j| < r_i + r_j + margin, ordered by i, then j.
struct NeighbourList {
  std::vector<std::int64_t> begin;    ///< size bodies + 1: partners of i are partner[begin[i]] .. partner[begin[i+1]]
  std::vector<std::int32_t> partner;  ///< ascending within i
};

/// Finds neighbours repeatedly in the same memory.
///
/// Bodies are divided into size classes, a factor of four wide, and each class into rows as high as the interaction
/// range of its bodies, sorted by x; each row is then compared with the rows within range, of its own class and of
/// larger ones, in one sweep of both. Radii in ratio 100:1 and more cost little more than equal ones. Only occupied
/// rows are stored, so bodies may be scattered over any area; time and memory are linear in bodies, pairs and size
/// classes. Fastest where bodies close in space are close in `circles`.
class NeighbourFinder {
 public:
  NeighbourFinder();
  ~NeighbourFinder();
  NeighbourFinder(const NeighbourFinder&) = delete;
  NeighbourFinder& operator=(const NeighbourFinder&) = delete;
  NeighbourFinder(NeighbourFinder&&) noexcept;
  NeighbourFinder& operator=(NeighbourFinder&&) noexcept;

  /// \param circles lengths whose squares neither overflow nor underflow: 0 or from 1e-150 to 1e150 m; radii >= 0;
  ///        fewer than 2^31
  /// \param margin >= 0, m
  /// \return valid until the next call; the same list for every number of threads and every grid
  /// \throws Error (computation_failed) on a centre or radius that is not finite
  const NeighbourList& within(std::span<const Circle> circles, double margin);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

/// The neighbour list of one call to NeighbourFinder::within.
NeighbourList neighbours_within(std::span<const Circle> circles, double margin);

/// A body moved by a whole number of each period.
struct PeriodicImage {
  std::int32_t body = 0;
  std::int32_t b = 0, a = 0;  ///< along y, along x
  auto operator<=>(const PeriodicImage&) const = default;
};

struct Periods {
  Vec2 a, b;  ///< a along x; b = {} without a period along y
  [[nodiscard]] Vec2 shift(const PeriodicImage& image) const {
    return static_cast<double>(image.a) * a + static_cast<double>(image.b) * b;
  }
};

/// The image of a body in the cell around a centre: body 0, and the periods by which it is moved into the cell.
PeriodicImage image_inside(const Periods& periods, Vec2 centre, Vec2 position);

/// Circle i and an image of circle j.
struct CirclePair {
  std::int32_t i = 0;
  PeriodicImage j;
  Vec2 shift;  ///< of the image from j, m
};

/// Finds pairs repeatedly in the same memory.
class PairFinder {
 public:
  /// \param periods none: nothing repeats
  /// \return valid until the next call: each pair with |x_j + shift - x_i| < r_i + r_j + margin once, i <= j, ascending
  ///         by i; for i = j the image further along (a, b)
  const std::vector<CirclePair>& within(std::span<const Circle> circles, const std::optional<Periods>& periods,
                                        double margin);

 private:
  NeighbourFinder finder_;
  std::vector<Circle> circles_;
  std::vector<CirclePair> pairs_;
};

/// The pairs of one call to PairFinder::within.
std::vector<CirclePair> pairs_within(std::span<const Circle> circles, const std::optional<Periods>& periods,
                                     double margin);

}  // namespace equidem
