// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Free samples as a file gives them, discs alone, and the same samples lying otherwise.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/core/random.hpp"

namespace equidem::test {

/// Rows of equal discs of diameter 1; row k has `first` - k `lost` discs, all rows in the middle above one another.
inline Assembly rows_of_discs(int first, int rows, int lost, double row_distance = std::numbers::sqrt3 / 2) {
  Assembly a;
  a.kind = "file";
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < first - lost * row; ++k)
      a.centres.push_back({k - 0.5 * (first - 1 - lost * row), row * row_distance});
  a.radii.assign(a.centres.size(), 0.5);
  return a;
}

/// A hexagonal block of 8 by 8 discs.
inline Assembly hexagonal_block(int columns = 8, int rows = 8) {
  Assembly a;
  a.kind = "file";
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < columns; ++k) a.centres.push_back({k + 0.5 * (row % 2), row * std::numbers::sqrt3 / 2});
  a.radii.assign(a.centres.size(), 0.5);
  return a;
}

inline Assembly scattered_discs(std::size_t count, double largest, double aspect, Random& random) {
  Assembly a;
  a.kind = "file";
  const double width = std::sqrt(static_cast<double>(count) * aspect), height = width / aspect;
  for (std::size_t k = 0; k < count; ++k) {
    a.centres.push_back({random.uniform(0, width), random.uniform(0, height)});
    a.radii.push_back(random.uniform(0.2, largest));
  }
  return a;
}

/// Heaps, blocks, scattered discs of equal and of unequal radii, sides that are straight, single rows, two discs, one.
inline Assembly free_sample(std::uint64_t number) {
  Random random(number + 1);
  const auto some = [&](double low, double high) { return static_cast<int>(random.uniform(low, high)); };
  switch (number % 10) {
    case 0:
      return hexagonal_block(some(2, 9), some(2, 9));
    case 1: {
      const int first = some(3, 9);
      return rows_of_discs(first, first, 1);
    }
    case 2:
      return rows_of_discs(some(2, 9), some(2, 9), 0, 1);
    case 3:
      return scattered_discs(static_cast<std::size_t>(some(3, 60)), 0.2, random.uniform(0.3, 3), random);
    case 4:
      return scattered_discs(static_cast<std::size_t>(some(3, 60)), 0.7, random.uniform(0.3, 3), random);
    case 5:
      return rows_of_discs(some(3, 20), 1, 0);
    case 6:
      return scattered_discs(2, 0.7, 1, random);
    case 7:
      return scattered_discs(1, 0.7, 1, random);
    case 8: {  // a heap with a flat top, without some disc
      Assembly a = rows_of_discs(some(6, 9), some(3, 5), 1);
      const auto hole = static_cast<std::ptrdiff_t>(random.uniform(0, static_cast<double>(a.size())));
      a.centres.erase(a.centres.begin() + hole);
      a.radii.pop_back();
      return a;
    }
    default: {  // unequal discs between two walls
      Assembly a = scattered_discs(static_cast<std::size_t>(some(6, 40)), 0.7, 2, random);
      for (std::size_t k = 0; k < a.size(); ++k)
        if (k % 3 != 2) a.centres[k].y = k % 3 == 0 ? a.radii[k] : 4 - a.radii[k];
      return a;
    }
  }
}

/// How a sample lies: turned, then mirrored, moved, in other units.
struct Placement {
  double degrees = 0;
  bool mirrored = false;
  Vec2 moved;
  double unit = 1;

  [[nodiscard]] Vec2 turned(Vec2 v) const {
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const Vec2 turned = {c * v.x - s * v.y, s * v.x + c * v.y};
    return mirrored ? Vec2{-turned.x, turned.y} : turned;
  }
  [[nodiscard]] Vec2 place(Vec2 x) const { return unit * (turned(x) + moved); }
  [[nodiscard]] std::string name() const {
    return std::to_string(degrees) + " degrees" + (mirrored ? ", mirrored" : "") + ", moved by " +
           std::to_string(moved.x) + ", unit " + std::to_string(unit);
  }
};

/// The discs of a sample lying otherwise, with the same contacts, without what was measured.
inline Assembly placed(const Assembly& sample, const Placement& placement) {
  Assembly a;
  a.kind = sample.kind;
  for (const Vec2 x : sample.centres) a.centres.push_back(placement.place(x));
  for (const double r : sample.radii) a.radii.push_back(placement.unit * r);
  a.contacts = sample.contacts;
  for (Contact& c : a.contacts) c.lever_i *= placement.unit, c.lever_j *= placement.unit;
  return a;
}

}  // namespace equidem::test
