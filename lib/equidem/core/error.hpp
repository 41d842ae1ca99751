// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Errors of bad input and of failed computations. Broken preconditions between functions are asserted instead.
#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace equidem {

/// The kind of an error, which decides the exit code of the program.
enum class ErrorKind {
  computation_failed = 1,  ///< the input was accepted, but no trustworthy answer exists or was reached
  bad_input = 2,           ///< the input cannot be used as it is
  out_of_memory = 3,       ///< likewise accepted, but the machine or a limit has too little memory: exit code 1
  interrupted = 130,       ///< the user asked to stop
};

/// A sentence for the user: "[where: ]problem (why it is one). What to do." Words of more than 200 bytes are
/// shortened, control characters are written as \xHH.
class Error : public std::runtime_error {
 public:
  /// \param problem what is wrong, starting in lower case, without a full stop
  /// \param why the reason for which it is a problem, without brackets; may be empty
  /// \param remedy what the user can do, a sentence without its full stop; may be empty
  /// \param where "file:line: key", or empty
  Error(ErrorKind kind, std::string problem, std::string why, std::string remedy, std::string where = {});

  [[nodiscard]] ErrorKind kind() const { return kind_; }
  /// Whether the input was accepted and no answer was reached, for want of memory or otherwise.
  [[nodiscard]] bool failed() const {
    return kind_ == ErrorKind::computation_failed || kind_ == ErrorKind::out_of_memory;
  }
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const std::string& why() const { return why_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[nodiscard]] int exit_code() const { return failed() ? 1 : static_cast<int>(kind_); }

  /// A copy with the place in the user's file that caused the error. One that is set stays; interruptions have none.
  [[nodiscard]] Error at(const std::string& where) const;
  /// A copy with one more reason.
  [[nodiscard]] Error because(const std::string& reason) const;

 private:
  ErrorKind kind_;
  std::string problem_, why_, remedy_, where_;
};

/// An error, with what was found before it.
template <class Found>
class ErrorWith : public Error {
 public:
  ErrorWith(const Error& error, Found found) : Error(error), found_(std::make_shared<const Found>(std::move(found))) {}
  /// \param reason one more
  ErrorWith(const Error& error, const std::string& reason, Found found)
      : ErrorWith(error.because(reason), std::move(found)) {}

  [[nodiscard]] const Found& found() const { return *found_; }

 private:
  std::shared_ptr<const Found> found_;
};

/// Throw an Error of kind bad_input.
[[noreturn]] void bad_input(std::string problem, std::string why, std::string remedy);
/// Throw an Error of kind bad_input with a place: file, line and key, or the option at fault.
[[noreturn]] void bad_input_at(std::string where, std::string problem, std::string why, std::string remedy);
/// Whether a number is positive and finite.
inline bool is_positive(double value) {
  return value > 0 && std::isfinite(value);
}

/// Numbers that an option accepts; those that are not finite never.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;
  bool zero_excluded = false;

  static constexpr Range positive() { return {.low = 0, .low_open = true}; }
  static constexpr Range above_zero_to(double high) { return {.low = 0, .high = high, .low_open = true}; }
  static constexpr Range not_negative() { return {.low = 0}; }
  static constexpr Range from(double low, double high) { return {.low = low, .high = high}; }

  [[nodiscard]] bool contains(double value) const;
  /// "> 0", "from 1 to 100", ">= 0 and < 0.5", "not 0"; empty for any number.
  [[nodiscard]] std::string text() const;
};

/// \throws Error (bad_input): "the radius of grain 3 is -1 m (it must be > 0 and finite). Give a number > 0."
void check_range(const Range& range, double value, const std::string& name, const std::string& unit = {});

/// The range of a member.
template <class Struct>
struct Bound {
  const char* name;
  double Struct::*member;
  Range range;
  const char* unit = "";
};

/// Checks the members of a table.
/// \param owner returns the words behind the name, " of grain 3"
template <class Struct, std::size_t count, class Owner>
void check_bounds(const Struct& values, const Bound<Struct> (&bounds)[count], const Owner& owner) {
  for (const Bound<Struct>& bound : bounds)
    if (!bound.range.contains(values.*bound.member))
      check_range(bound.range, values.*bound.member, bound.name + std::string(owner()), bound.unit);
}

/// \return the value
/// \throws Error (bad_input) where it is not positive and finite
double check_positive(double value, const std::string& name, const std::string& unit = {});

/// Throw an Error of kind computation_failed.
[[noreturn]] void computation_failed(std::string problem, std::string why, std::string remedy);
/// Throw an Error of kind out_of_memory.
[[noreturn]] void out_of_memory(std::string problem, std::string why, std::string remedy);

}  // namespace equidem
