// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The state of a simulation as named arrays; a restored run continues bit-identically.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
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

/// \throws Error (bad_input): a number of an array does not fit its place
[[noreturn]] void refuse_saved_number(std::string_view array, double number);

/// A saved number as a value of its type. \throws Error (bad_input) on one that the type does not have
template <class Number>
Number value_of_saved(double saved, std::string_view array) {
  if constexpr (std::is_enum_v<Number>) {
    return static_cast<Number>(value_of_saved<std::underlying_type_t<Number>>(saved, array));
  } else if constexpr (std::is_integral_v<Number>) {
    constexpr double exact = 0x1p53;
    constexpr double least = std::max(-exact, static_cast<double>(std::numeric_limits<Number>::min())),
                     most = std::min(exact, static_cast<double>(std::numeric_limits<Number>::max()));
    if (!(saved >= least && saved <= most && saved == std::floor(saved))) refuse_saved_number(array, saved);
  }
  return static_cast<Number>(saved);
}

/// Rows of numbers from structs, and back.
/// \param numbers function of a row and a visitor that calls the visitor with the numbers of the row, always the same
template <class Row, class Numbers>
SavedArray saved_rows(std::string name, std::vector<Row> rows, const Numbers& numbers) {
  SavedArray array{.name = std::move(name), .columns = 0, .values = {}};
  Row any{};
  numbers(any, [&](const auto&) { ++array.columns; });
  array.values.reserve(array.columns * rows.size());
  for (Row& row : rows) numbers(row, [&](const auto& number) { array.values.push_back(static_cast<double>(number)); });
  return array;
}
/// \throws Error (bad_input) if there is no such array, or its numbers are no such rows
template <class Row, class Numbers>
std::vector<Row> rows_in(const SavedState& state, std::string_view name, const Numbers& numbers) {
  const std::vector<double>& values = state[name];
  std::vector<Row> rows;
  for (auto from = values.begin(); from != values.end();) {
    numbers(rows.emplace_back(), [&](auto& number) {
      if (from == values.end()) refuse_saved_number(name, std::numeric_limits<double>::quiet_NaN());
      number = value_of_saved<std::remove_cvref_t<decltype(number)>>(*from++, name);
    });
  }
  return rows;
}

/// Rows of one number.
inline constexpr auto one_number = [](auto& number, const auto& visit) { visit(number); };

/// Rows of x, y and rotation.
std::vector<double> numbers_of(std::span<const DiscMotion> motions);
std::vector<DiscMotion> motions_of(std::span<const double> numbers);

}  // namespace equidem
