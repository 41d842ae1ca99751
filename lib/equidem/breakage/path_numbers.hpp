// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The state of a path as a list of numbers, bit for bit: one description of it saves and restores. The last number
/// follows from the names and kinds of all members in turn: numbers of a state with other members are refused.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/core/double_double.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/vector.hpp"

/// Passes members with their names, which are saved beside their kinds.
#define EQUIDEM_PASS(numbers, ...) (numbers).pass(#__VA_ARGS__, __VA_ARGS__)

namespace equidem {

class PathNumbers {
 public:
  /// To save into.
  PathNumbers() = default;
  /// To restore from.
  explicit PathNumbers(std::vector<double> numbers) : numbers_(std::move(numbers)), restores_(true) {}

  [[nodiscard]] bool restores() const { return restores_; }
  /// What was saved.
  [[nodiscard]] std::vector<double> numbers() const {
    std::vector<double> all = numbers_;
    all.push_back(kinds());
    return all;
  }
  /// \throws Error (bad_input) where numbers are left over, or were saved of other kinds
  void check_end() const {
    if (restores_ && (next_ + 1 != numbers_.size() || numbers_.back() != kinds())) refuse();
  }

  /// Saves these, or restores them; see EQUIDEM_PASS.
  template <typename... Values>
  void pass(const char* names, Values&... values) {
    for (; *names != '\0'; ++names) mark(static_cast<unsigned char>(*names));
    all(values...);
  }

 private:
  [[noreturn]] static void refuse() {
    bad_input("the state of the path cannot be restored", "it has other contacts, events or members",
              "Begin anew, without --resume and with --overwrite");
  }
  double& next() {
    if (!restores_) return numbers_.emplace_back();
    if (next_ == numbers_.size()) refuse();
    return numbers_[next_++];
  }

  template <typename... Values>
  void all(Values&... values) {
    (one(values), ...);
  }
  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void one(T& value) {
    mark(std::is_floating_point_v<T> ? 1 : std::is_enum_v<T> ? 2 : 3);
    double& number = next();
    if (restores_) {
      value = static_cast<T>(number);
    } else {
      number = static_cast<double>(value);  // integers below 2^53 are exact
    }
  }
  void one(DoubleDouble& value) {
    double high = value.high(), low = value.low();
    all(high, low);
    if (restores_) value = DoubleDouble(high, low);
  }
  template <typename T>
  void one(DeformationOf<T>& d) {
    all(d.normal, d.tangential);
  }
  void one(ContactForce& f) { all(f.normal, f.tangential); }
  void one(Tensor2& t) { all(t.xx, t.xy, t.yx, t.yy); }
  template <typename T>
  requires requires(T& value, PathNumbers& numbers) { value.pass(numbers); }
  void one(T& value) { value.pass(*this); }
  template <typename T>
  void one(std::optional<T>& value) {
    bool there = value.has_value();
    one(there);
    if (restores_ && there) value.emplace();
    if (restores_ && !there) value.reset();
    if (there) one(*value);
  }
  template <typename T>
  void one(std::vector<T>& values) {
    std::size_t size = values.size();
    one(size);
    if (restores_ && size > numbers_.size()) refuse();
    values.resize(size);
    for (T& value : values) one(value);
  }
  void one(std::string& text) {
    std::vector<char> letters(text.begin(), text.end());
    one(letters);
    text.assign(letters.begin(), letters.end());
  }

  void mark(std::uint64_t kind) { kinds_ = (kinds_ ^ kind) * 0x100000001b3; }  // FNV-1a
  [[nodiscard]] double kinds() const { return static_cast<double>(kinds_ >> 11); }

  std::vector<double> numbers_;
  std::size_t next_ = 0;
  std::uint64_t kinds_ = 0xcbf29ce484222325;
  bool restores_ = false;
};

}  // namespace equidem
