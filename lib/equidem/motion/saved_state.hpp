// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The state of a simulation as named arrays; a restored run continues bit-identically.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/contact/frame.hpp"

namespace equidem {

/// Rows of numbers; integers up to 2^53 are exact.
struct SavedArray {
  std::string name;
  std::size_t columns = 1;
  std::vector<double> values;  ///< row by row
  bool operator==(const SavedArray&) const = default;
};

struct SavedState {
  std::int64_t step = 0;
  std::vector<SavedArray> arrays;

  /// \throws Error (bad_input) if there is no such array
  [[nodiscard]] const std::vector<double>& operator[](std::string_view name) const;
  [[nodiscard]] std::vector<double>& operator[](std::string_view name);
  bool operator==(const SavedState&) const = default;
};

/// Rows of x, y and rotation.
std::vector<double> numbers_of(std::span<const DiscMotion> motions);
std::vector<DiscMotion> motions_of(std::span<const double> numbers);

}  // namespace equidem
