// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The results of a computation as one list of (key, label, unit, value), from which the report and the JSON are
/// printed.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "equidem/core/matrix.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

class Results;
struct Effects;

template <typename Type, typename Variant>
inline constexpr bool is_alternative = false;
template <typename Type, typename... Types>
inline constexpr bool is_alternative<Type, std::variant<Types...>> = (std::same_as<Type, Types> || ...);

/// An alternative of a variant that is no integer.
template <typename Given, typename Variant>
concept AlternativeOf =
    is_alternative<std::remove_cvref_t<Given>, Variant> && !std::integral<std::remove_cvref_t<Given>>;

/// The value of a result: number, integer, text, flag, vector, matrix, sub-results, a list of them, or null with the
/// reason why it is not known.
class ResultValue {
 public:
  struct Null {
    std::string why = {};
  };
  using Variant = std::variant<Null, bool, std::int64_t, double, std::string, std::vector<double>,
                               std::vector<std::int64_t>, std::vector<std::string>, std::vector<std::vector<double>>,
                               std::shared_ptr<const Results>, std::shared_ptr<const std::vector<Results>>>;

  template <AlternativeOf<Variant> Given>
  ResultValue(Given&& given) : value(std::in_place_type<std::remove_cvref_t<Given>>, std::forward<Given>(given)) {}
  ResultValue(bool flag) : value(flag) {}
  template <std::integral Integer>
  ResultValue(Integer integer) : value(static_cast<std::int64_t>(integer)) {}
  ResultValue(std::nullptr_t) : value(Null{}) {}
  ResultValue(const char* text) : value(std::string(text)) {}
  ResultValue(std::string_view text) : value(std::string(text)) {}
  ResultValue(const Voigt& v) : value(std::vector<double>{v.xx, v.yy, v.xy}) {}  ///< [xx, yy, xy]
  ResultValue(const Vec2& v) : value(std::vector<double>{v.x, v.y}) {}
  ResultValue(const Tensor2& t)  ///< [[xx, xy], [yx, yy]]
      : value(std::vector<std::vector<double>>{{t.xx, t.xy}, {t.yx, t.yy}}) {}
  template <std::size_t N>
  ResultValue(const SquareMatrix<N>& matrix) : value(std::vector<std::vector<double>>{}) {
    for (const auto& row : matrix)
      std::get<std::vector<std::vector<double>>>(value).emplace_back(row.begin(), row.end());
  }
  /// Null where it is empty.
  template <typename Given>
  ResultValue(const std::optional<Given>& given) : value(Null{}) {
    if (given) *this = ResultValue(*given);
  }
  ResultValue(const Results& results);
  ResultValue(std::vector<Results> list);

  Variant value;
};

/// Format of a number in the report.
struct Shown {
  enum class As {
    number,      ///< that many significant digits
    decimals,    ///< that many digits after the point
    power,       ///< as a power of ten, that many digits after the point: 1.2e-15
    percent,     ///< a share, in %
    degrees,     ///< an angle in rad, in °
    bytes,       ///< "5.7 GB"
    count,       ///< digits in groups of three; the unit is a noun, in the plural where the count is not 1
    components,  ///< of a tensor, "xx 1, yy 2, xy 0", to that many digits; round-off beside the largest is 0
  };
  using enum As;
  As as = As::number;
  int digits = 6;
};

/// A part of a list of results.
struct Result {
  enum class Part {
    value,  ///< in report and JSON; only in the JSON if hidden; only in the report if the key is empty
    line,   ///< the report begins a line; label: its name
    note,   ///< text of the report after the values before it
    block,  ///< lines of the report as they are
    table,  ///< a list of results: a table of the report
    list,   ///< a list of results: their reports, one below the other
  };
  Part part = Part::value;
  std::string key = {};  ///< with '/' between the keys of nested objects
  std::string label = {};
  std::string unit = {};
  ResultValue value = nullptr;
  Shown shown = {};
  bool hidden = false;  ///< left out of the report
  /// Its line, or its block, is a warning. Where warnings stand alone this text takes the place of the name of the
  /// line, if it is not empty.
  std::optional<std::string> warning = {};
};

/// An ordered list of results. Values that are added stand on the last line of the report, with commas between them, as
/// "label value unit".
class Results {
 public:
  /// A value of the report and the JSON. \param key empty: of the report alone
  Results& add(std::string key, std::string label, ResultValue value, std::string unit = {}, Shown shown = {});
  /// A value of the JSON alone. \param label of a number; empty: that of quantities.hpp
  Results& set(std::string key, ResultValue value, std::string unit = {}, std::string label = {});
  /// Begins a line of the report. \param name its first column; empty: the line continues the one above
  Results& line(std::string name, const std::string& text = {});
  /// A line that the reader must not miss.
  Results& warning(std::string name, const std::string& text) { return line(std::move(name), text).warn(); }
  /// The last line or block of the report, of which there is one, is such a line.
  /// \param heading in place of the name of the line where warnings stand alone
  Results& warn(std::string heading = {});
  /// Text of the report that follows on the line, as it is.
  Results& note(std::string text);
  /// Lines of the report as they are.
  Results& block(std::string text);
  /// A list of results, one row each: a column for each label. \param key empty: of the report alone
  Results& table(std::string key, std::vector<Results> rows);
  /// A list of results whose reports follow one another. \param key empty: of the report alone
  Results& list(std::string key, std::vector<Results> items);
  /// All parts of another list.
  Results& append(const Results& others);

  /// The results with their keys in a nested object of the JSON.
  [[nodiscard]] Results under(const std::string& object) const;
  /// The values for the JSON alone.
  [[nodiscard]] Results hidden() const;

  [[nodiscard]] const std::vector<Result>& parts() const { return parts_; }
  /// The report: a name in a column of its own, its line broken into lines of about 110 columns beside it.
  [[nodiscard]] std::string report() const;
  /// The JSON object, indented by two spaces, arrays of numbers on one line, with a final line break. Keys keep their
  /// order, a later value replaces an earlier one of its key. Numbers are written in the shortest form that reads back
  /// to the same bits; NaN and infinity, which JSON lacks, become null. Text that is not UTF-8 has its bad bytes
  /// replaced.
  [[nodiscard]] std::string json() const;

 private:
  std::vector<Result> parts_;
};

/// The last value of a key in nested objects and lists; null where there is none.
/// \param path keys and positions in lists with '/' between them; '$' is the last position
const Result* find_result(const Results& results, std::string_view path);

/// effects {active: [names], inactive: {name: why}}.
void add_effects(Results& results, const Effects& effects);

/// The number at a path of keys and positions such as "poisson_ratio.plane_strain" or "stress.0" in a JSON text; none
/// where there is none.
std::optional<double> number_in_json(std::string_view text, const std::string& path);

/// The version of the library, "0.2.0".
std::string library_version();

}  // namespace equidem
