// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Errors of bad input and of failed computations. Broken preconditions between functions are asserted instead.
#pragma once

#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>

namespace equidem {

/// The kind of an error, which decides the exit code of the program.
enum class ErrorKind {
  computation_failed = 1,  ///< the input was accepted, but no trustworthy answer exists or was reached
  bad_input = 2,           ///< the input cannot be used as it is
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
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const std::string& why() const { return why_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[nodiscard]] int exit_code() const { return static_cast<int>(kind_); }

  /// A copy with the place in the user's file that caused the error. One that is set stays; interruptions have none.
  [[nodiscard]] Error at(const std::string& where) const;

 private:
  ErrorKind kind_;
  std::string problem_, why_, remedy_, where_;
};

/// Throw an Error of kind bad_input.
[[noreturn]] void bad_input(std::string problem, std::string why, std::string remedy);
/// Throw an Error of kind bad_input with a place: file, line and key, or the option at fault.
[[noreturn]] void bad_input_at(std::string where, std::string problem, std::string why, std::string remedy);
/// Whether a number is positive and finite.
inline bool is_positive(double value) {
  return value > 0 && std::isfinite(value);
}

/// \return the value
/// \throws Error (bad_input) where it is not positive and finite
double check_positive(double value, const std::string& name, const std::string& unit = {});

/// Throw an Error of kind computation_failed.
[[noreturn]] void computation_failed(std::string problem, std::string why, std::string remedy);

}  // namespace equidem
