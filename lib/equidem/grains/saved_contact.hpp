// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The numbers of a contact in the array `contacts` of GrainSimulation::save.
#pragma once

#include <cstddef>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Places of numbers in a row: i, j, steps, mode, then the other members of a Candidate; in a periodic cell the periods
/// of the image; in scenes with shapes the two parts and the arms to the contact point.
struct ContactColumns {
  static constexpr std::size_t i = 0, j = 1, steps = 2, mode = 3, stretch = 4, overlap = 5, closing = 6, normal = 7,
                               impulse = 9, moment = 10, tangential_impulse = 11, parted = 12;
  std::size_t image = 13;  ///< a, b
  std::size_t part = 13;   ///< of i, of j
  std::size_t arm = 13;    ///< x and y of i, of j
  std::size_t count = 13;  ///< of all numbers

  explicit ContactColumns(const GrainSystem& system) {
    if (system.cell.active) part = arm = count = image + 2;
    if (!system.shapes.parts.empty()) arm = part + 2, count = arm + 4;
  }
};

}  // namespace equidem
