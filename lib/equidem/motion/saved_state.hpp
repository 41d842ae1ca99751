// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The state of a simulation as named arrays; a restored run continues bit-identically.
/// Probes: the motion of chosen bodies over time, and the period of a quantity that oscillates about zero.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/names.hpp"

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
  [[nodiscard]] const SavedArray& array(std::string_view name) const;
  [[nodiscard]] const std::vector<double>& operator[](std::string_view name) const { return array(name).values; }
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

/// \throws Error (bad_input): an array has not whole rows of so many numbers
void check_rows(const SavedArray& array, std::size_t columns);

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
  const SavedArray& array = state.array(name);
  std::size_t columns = 0;
  Row any{};
  numbers(any, [&](const auto&) { ++columns; });
  check_rows(array, columns);
  std::vector<Row> rows(array.values.size() / columns);
  const double* from = array.values.data();
  for (Row& row : rows)
    numbers(row, [&](auto& number) { number = value_of_saved<std::remove_cvref_t<decltype(number)>>(*from++, name); });
  return rows;
}

// The numbers of rows that several states have.
inline constexpr auto one_number = [](auto& number, const auto& visit) { visit(number); };
inline constexpr auto vector_numbers = [](auto& v, const auto& visit) { visit(v.x), visit(v.y); };
inline constexpr auto motion_numbers = [](auto& m, const auto& visit) { visit(m.u.x), visit(m.u.y), visit(m.theta); };

/// As rows of motion_numbers.
std::vector<double> numbers_of(std::span<const DiscMotion> motions);
std::vector<DiscMotion> motions_of(std::span<const double> numbers);

/// Bonded discs have displacements and rotations, colliding bodies positions and angles, and the stress of the box of
/// the probe; both velocities and spins.
enum class ProbeQuantity { displacement, rotation, position, angle, velocity, spin, stress };

struct ProbeQuantityFacts {
  ProbeQuantity value;
  const char* name;
  bool rate;
  std::array<const char*, 4> columns;  ///< ends of their names; null: no more of them
};
template <>
struct EnumNames<ProbeQuantity> {
  static constexpr const char* what = "quantity of a probe";
  static constexpr ProbeQuantityFacts list[] = {
      {ProbeQuantity::displacement, "displacement", false, {"_ux_m", "_uy_m"}},
      {ProbeQuantity::rotation, "rotation", false, {"_rotation_rad"}},
      {ProbeQuantity::position, "position", false, {"_x_m", "_y_m"}},
      {ProbeQuantity::angle, "angle", false, {"_angle_rad"}},
      {ProbeQuantity::velocity, "velocity", true, {"_vx_m_per_s", "_vy_m_per_s"}},
      {ProbeQuantity::spin, "spin", true, {"_spin_rad_per_s"}},
      {ProbeQuantity::stress, "stress", false, {"_stress_xx_Pa", "_stress_xy_Pa", "_stress_yx_Pa", "_stress_yy_Pa"}}};
};

/// The mean over some bodies.
struct Probe {
  std::string name;                  ///< begins the names of its columns
  std::vector<std::int32_t> bodies;  ///< numbers from 0; empty: those of `group`
  std::vector<ProbeQuantity> quantities = {ProbeQuantity::displacement};
  std::string group = {};
  std::optional<Rectangle> box = {};      ///< m; the bodies with their centre inside are counted too; a stress is its
  std::optional<double> wavelength = {};  ///< m, of a standing wave whose period the mean velocity has
};

inline bool has_stress(const Probe& probe) {
  return std::ranges::find(probe.quantities, ProbeQuantity::stress) != probe.quantities.end();
}

/// Counts the passages of a sampled quantity through zero, each interpolated between two samples; the error of the
/// period is of second order in the time between samples.
class Oscillation {
 public:
  /// Add a sample. \param time s, ascending
  void add(double time, double value);

  [[nodiscard]] std::int64_t passages() const { return passages_; }
  /// s, twice the mean time between passages; none before the second passage
  [[nodiscard]] std::optional<double> period() const;
  /// Largest difference of a time between two passages from their mean, over the mean; none before the second passage
  [[nodiscard]] std::optional<double> spread() const;

  static constexpr auto numbers = [](auto& o, const auto& visit) {
    visit(o.samples_), visit(o.passages_), visit(o.time_), visit(o.value_), visit(o.first_), visit(o.last_);
    visit(o.shortest_), visit(o.longest_);
  };

 private:
  std::int64_t samples_ = 0, passages_ = 0;
  double time_ = 0, value_ = 0;        ///< of the last sample
  double first_ = 0, last_ = 0;        ///< s, passages
  double shortest_ = 0, longest_ = 0;  ///< s between two passages
};

}  // namespace equidem
