// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/error.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Control characters of the user's files, which a terminal does not obey, and bytes that are no UTF-8, as \xHH.
std::string printable(std::string whole) {
  std::string_view text = whole;
  const bool controls = std::ranges::any_of(whole, [](unsigned char code) { return code < 0x20 || code == 0x7f; });
  if (!controls && !place_of_wrong_byte(text)) return whole;
  std::string plain;
  while (!text.empty()) {
    const std::size_t wrong = std::min(place_of_wrong_byte(text).value_or(text.size()), text.size());
    for (const char c : text.substr(0, wrong)) {
      const auto code = static_cast<unsigned char>(c);
      if (code < 0x20 || code == 0x7f)
        plain += fmt::format("\\x{:02x}", code);
      else
        plain += c;
    }
    if (wrong < text.size()) plain += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[wrong]));
    text.remove_prefix(std::min(wrong + 1, text.size()));
  }
  return plain;
}

std::string sentence(const std::string& problem, const std::string& why, const std::string& remedy,
                     const std::string& where) {
  std::string text = (where.empty() ? "" : where + ": ") + problem;
  if (!why.empty()) text += " (" + why + ")";
  text += ".";
  if (!remedy.empty()) text += " " + remedy + (remedy.ends_with('?') ? "" : ".");
  return with_short_words(printable(text));
}

constexpr double unlimited = std::numeric_limits<double>::infinity();

}  // namespace

Error::Error(ErrorKind kind, std::string problem, std::string why, std::string remedy, std::string where)
    : std::runtime_error(sentence(problem, why, remedy, where)),
      kind_(kind),
      problem_(printable(std::move(problem))),
      why_(printable(std::move(why))),
      remedy_(printable(std::move(remedy))),
      where_(printable(std::move(where))) {}

Error Error::at(const std::string& where) const {
  return where_.empty() && kind_ != ErrorKind::interrupted ? Error(kind_, problem_, why_, remedy_, where) : *this;
}

Error Error::because(const std::string& reason) const {
  return {kind_, problem_, why_.empty() ? reason : why_ + "; " + reason, remedy_, where_};
}

void bad_input(std::string problem, std::string why, std::string remedy) {
  bad_input_at({}, std::move(problem), std::move(why), std::move(remedy));
}

bool Range::contains(double value) const {
  if (!std::isfinite(value) || (zero_excluded && value == 0)) return false;
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  const auto shown = [](double value) {
    const bool short_whole = std::abs(value) < 1e7 && value == std::floor(value);
    return short_whole ? fmt::format("{:.0f}", value) : fmt::format("{:g}", value);
  };
  if (zero_excluded) return "not 0";
  if (low == -unlimited && high == unlimited) return {};
  if (high == unlimited) return fmt::format("{} {}", low_open ? ">" : ">=", shown(low));
  if (low == -unlimited) return fmt::format("{} {}", high_open ? "<" : "<=", shown(high));
  if (low_open && high_open) return fmt::format("between {} and {}", shown(low), shown(high));
  if (!low_open && !high_open) return fmt::format("from {} to {}", shown(low), shown(high));
  return fmt::format("{} {} and {} {}", low_open ? ">" : ">=", shown(low), high_open ? "<" : "<=", shown(high));
}

void check_range(const Range& range, double value, const std::string& name, const std::string& unit) {
  if (range.contains(value)) return;
  const std::string bounds = range.text();
  bad_input(fmt::format("the {} is {:.6g}{}", name, value, unit.empty() ? "" : " " + unit),
            bounds.empty()                          ? "it must be finite"
            : std::isfinite(range.high - range.low) ? "it must be " + bounds
                                                    : fmt::format("it must be {} and finite", bounds),
            bounds.empty() ? "Give a finite number" : "Give a number " + bounds);
}

double check_positive(double value, const std::string& name, const std::string& unit) {
  check_range(Range::positive(), value, name, unit);
  return value;
}

void bad_input_at(std::string where, std::string problem, std::string why, std::string remedy) {
  throw Error(ErrorKind::bad_input, std::move(problem), std::move(why), std::move(remedy), std::move(where));
}

void computation_failed(std::string problem, std::string why, std::string remedy) {
  throw Error(ErrorKind::computation_failed, std::move(problem), std::move(why), std::move(remedy));
}

void out_of_memory(std::string problem, std::string why, std::string remedy) {
  throw Error(ErrorKind::out_of_memory, std::move(problem), std::move(why), std::move(remedy));
}

}  // namespace equidem
