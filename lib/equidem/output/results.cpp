// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/results.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <nlohmann/json.hpp>

#include "equidem/contact/effects.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::size_t name_width = 16, value_width = 94;
constexpr double round_off = 1e-12;

template <typename... Cases>
struct Visitor : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Visitor(Cases...) -> Visitor<Cases...>;  // Clang before 17 makes none of an aggregate

double without_round_off(double value, double largest) {
  return std::abs(value) <= round_off * largest ? 0 : value;
}

std::string shown_number(double value, const Shown& shown, const std::string& unknown = "-") {
  if (std::isnan(value)) return unknown;
  switch (shown.as) {
    case Shown::decimals:
      return fmt::format("{:.{}f}", value, shown.digits);
    case Shown::power:
      return fmt::format("{:.{}e}", value, shown.digits);
    case Shown::percent:
      return percent(value, shown.digits);
    case Shown::degrees:
      return fmt::format("{:.1f}°", value * 180 / std::numbers::pi);
    case Shown::bytes:
      return readable_bytes(value);
    case Shown::count:
      return grouped(static_cast<std::int64_t>(value));
    case Shown::number:
    case Shown::components:
      break;
  }
  return fmt::format("{:.{}g}", value, shown.digits);
}

/// Rows of a tensor or the Voigt vector of a symmetric one.
std::string shown_components(const std::vector<std::pair<const char*, double>>& components, const Shown& shown) {
  double largest = 0;
  for (const auto& [name, value] : components) largest = std::max(largest, std::abs(value));
  std::vector<std::string> texts;
  for (const auto& [name, value] : components)
    texts.push_back(fmt::format("{} {}", name, shown_number(without_round_off(value, largest), shown)));
  return joined(texts);
}

std::string shown_value(const ResultValue& value, const Shown& shown) {
  const auto list = [&](const auto& values) {
    std::vector<std::string> texts;
    for (const auto& one : values) texts.push_back(shown_value(one, shown));
    return joined(texts);
  };
  return std::visit(
      Visitor{[](const ResultValue::Null& null) { return null.why.empty() ? std::string("-") : null.why; },
              [](bool flag) { return std::string(flag ? "yes" : "no"); },
              [&](std::int64_t number) {
                return shown.as == Shown::number || shown.as == Shown::components
                           ? fmt::format("{}", number)
                           : shown_number(static_cast<double>(number), shown);
              },
              [&](double number) { return shown_number(number, shown); }, [](const std::string& text) { return text; },
              [&](const std::vector<double>& values) {
                if (shown.as != Shown::components || values.size() != 3) return list(values);
                return shown_components({{"xx", values[0]}, {"yy", values[1]}, {"xy", values[2]}}, shown);
              },
              [&](const std::vector<std::int64_t>& values) { return list(values); },
              [](const std::vector<std::string>& values) { return joined(values); },
              [&](const std::vector<std::vector<double>>& rows) {
                if (shown.as != Shown::components || rows.size() != 2) return std::string();
                return shown_components(
                    {{"xx", rows[0][0]}, {"yy", rows[1][1]}, {"xy", rows[0][1]}, {"yx", rows[1][0]}}, shown);
              },
              [](const std::shared_ptr<const Results>&) { return std::string(); },
              [](const std::shared_ptr<const std::vector<Results>>&) { return std::string(); }},
      value.value);
}

/// "label value unit".
std::string shown_part(const Result& part) {
  std::string text = part.label;
  const auto append = [&](const std::string& word) {
    if (!word.empty()) text += (text.empty() ? "" : " ") + word;
  };
  append(shown_value(part.value, part.shown));
  const auto* count = std::get_if<std::int64_t>(&part.value.value);
  append(part.shown.as == Shown::count && !part.unit.empty() && count != nullptr && *count != 1 ? part.unit + "s"
                                                                                                : part.unit);
  return text;
}

/// Rows of a matrix as lines; what is round-off beside the largest entry reads as 0.
std::string matrix_lines(const std::string& name, const std::vector<std::vector<double>>& matrix, const Result& part) {
  double largest = 0;
  for (const auto& row : matrix)
    for (const double entry : row) largest = std::max(largest, std::abs(entry));
  std::string text;
  for (const auto& row : matrix) {
    const bool first = &row == &matrix.front();
    text += fmt::format("{:<{}}", first ? name : "", name_width);
    for (const double entry : row)
      text += fmt::format("{:>17.{}g}", without_round_off(entry, largest), part.shown.digits);
    text += (first ? "  " + part.unit : "") + "\n";
  }
  return text;
}

std::string title_of(const Result& part) {
  return part.unit.empty() ? part.label : part.label + ", " + part.unit;
}

/// One row for each list, one column for each label; text to the left, numbers to the right.
std::string table_lines(const std::vector<Results>& rows) {
  std::vector<std::vector<std::string>> cells(1);
  std::vector<bool> left;
  for (const Results& row : rows) {
    for (const Result& part : row.parts()) {
      if (part.hidden || part.part != Result::Part::value) continue;
      const std::string title = title_of(part);
      if (std::ranges::find(cells.front(), title) != cells.front().end()) continue;
      cells.front().push_back(title);
      left.push_back(std::holds_alternative<std::string>(part.value.value));
    }
  }
  std::vector<std::string> ends{""};
  for (const Results& row : rows) {
    std::vector<std::string> line(left.size());
    ends.emplace_back();
    for (const Result& part : row.parts()) {
      if (part.part == Result::Part::note) ends.back() += part.label;
      if (part.hidden || part.part != Result::Part::value) continue;
      const auto column = std::ranges::find(cells.front(), title_of(part)) - cells.front().begin();
      line[static_cast<std::size_t>(column)] = shown_value(part.value, part.shown);
    }
    cells.push_back(std::move(line));
  }
  std::vector<std::size_t> widths(left.size());
  for (const auto& line : cells)
    for (std::size_t k = 0; k < line.size(); ++k) widths[k] = std::max(widths[k], columns_of(line[k]));
  std::string text;
  for (std::size_t r = 0; r < cells.size(); ++r) {
    for (std::size_t k = 0; k < left.size(); ++k)
      cells[r][k].insert(left[k] ? cells[r][k].size() : 0, widths[k] - columns_of(cells[r][k]), ' ');
    if (!ends[r].empty()) cells[r].push_back(ends[r]);
    std::string line = joined(cells[r], "  ");
    text += line.erase(line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

/// A line of a report: the name in a column of its own, the value broken into lines beside it.
std::string report_line(const std::string& name, const std::string& value) {
  std::string text, line = fmt::format("{:<{}}", name, name_width);
  std::size_t used = 0;
  for (std::size_t begin = 0; begin < value.size();) {
    std::size_t end = value.find(' ', begin + 1);
    if (end == std::string::npos) end = value.size();
    const std::string word = value.substr(begin, end - begin);
    if (used > 0 && used + word.size() > value_width) {
      text += line + "\n";
      line.assign(name_width, ' ');
      used = 0;
      line += word.substr(1);
    } else {
      line += word;
    }
    used += word.size();
    begin = end;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return text + line + "\n";
}

/// The last line of a report, as long as values follow on it.
class OpenLine {
 public:
  void begin(std::string name) { name_ = std::move(name), open_ = true; }
  void add(const std::string& text) {
    if (!text_.empty() && !text_.ends_with(' ') && !text_.ends_with('(')) text_ += ", ";
    text_ += text;
    open_ = true;
  }
  void continue_with(const std::string& text) { text_ += text, open_ = true; }
  void close(std::string& report) {
    if (open_ && !text_.empty()) report += report_line(name_, text_);
    name_.clear(), text_.clear(), open_ = false;
  }
  /// The name, where nothing stands on the line yet.
  std::string take_name() { return std::exchange(name_, {}); }

 private:
  std::string name_, text_;
  bool open_ = false;
};

}  // namespace

ResultValue::ResultValue(const Results& results) : value(std::make_shared<const Results>(results)) {}
ResultValue::ResultValue(std::vector<Results> list)
    : value(std::make_shared<const std::vector<Results>>(std::move(list))) {}

Results& Results::add(std::string key, std::string label, ResultValue value, std::string unit, Shown shown) {
  parts_.push_back({.key = std::move(key),
                    .label = std::move(label),
                    .unit = std::move(unit),
                    .value = std::move(value),
                    .shown = shown});
  return *this;
}

Results& Results::set(std::string key, ResultValue value, std::string unit, std::string label) {
  add(std::move(key), std::move(label), std::move(value), std::move(unit));
  parts_.back().hidden = true;
  return *this;
}

Results& Results::line(std::string name, const std::string& text) {
  parts_.push_back({.part = Result::Part::line, .label = std::move(name)});
  return text.empty() ? *this : note(text);
}

Results& Results::warn(std::string heading) {
  auto part = parts_.rbegin();
  while (part->part != Result::Part::line && part->part != Result::Part::block) ++part;
  part->warning = std::move(heading);
  return *this;
}

Results& Results::note(std::string text) {
  parts_.push_back({.part = Result::Part::note, .label = std::move(text)});
  return *this;
}

Results& Results::block(std::string text) {
  parts_.push_back({.part = Result::Part::block, .label = std::move(text)});
  return *this;
}

Results& Results::table(std::string key, std::vector<Results> rows) {
  parts_.push_back({.part = Result::Part::table, .key = std::move(key), .value = std::move(rows)});
  return *this;
}

Results& Results::list(std::string key, std::vector<Results> items) {
  parts_.push_back({.part = Result::Part::list, .key = std::move(key), .value = std::move(items)});
  return *this;
}

Results Results::under(const std::string& object) const {
  Results nested = *this;
  for (Result& part : nested.parts_)
    if (!part.key.empty()) part.key.insert(0, object + "/");
  return nested;
}

Results Results::hidden() const {
  Results values;
  for (const Result& part : parts_) {
    if (part.key.empty()) continue;
    part.hidden ? values.parts_.push_back(part) : void(values.set(part.key, part.value));
  }
  return values;
}

Results& Results::append(const Results& others) {
  const std::vector<Result> copy = others.parts_;
  parts_.insert(parts_.end(), copy.begin(), copy.end());
  return *this;
}

std::string Results::report() const {
  std::string report;
  OpenLine line;
  for (const Result& part : parts_) {
    if (part.hidden) continue;
    switch (part.part) {
      case Result::Part::line:
        line.close(report);
        line.begin(part.label);
        break;
      case Result::Part::note:
        line.continue_with(part.label);
        break;
      case Result::Part::block:
        line.close(report);
        report += part.label;
        break;
      case Result::Part::table:
        line.close(report);
        report += table_lines(*std::get<std::shared_ptr<const std::vector<Results>>>(part.value.value));
        break;
      case Result::Part::list:
        line.close(report);
        for (const Results& item : *std::get<std::shared_ptr<const std::vector<Results>>>(part.value.value))
          report += item.report();
        break;
      case Result::Part::value: {
        const auto* matrix = std::get_if<std::vector<std::vector<double>>>(&part.value.value);
        if (matrix != nullptr && part.shown.as != Shown::components) {
          report += matrix_lines(line.take_name(), *matrix, part);
        } else {
          line.add(shown_part(part));
        }
        break;
      }
    }
  }
  line.close(report);
  return report;
}

const Result* find_result(const Results& results, std::string_view path) {
  const Result* found = nullptr;
  for (const Result& part : results.parts()) {
    if (part.key.empty() || !path.starts_with(part.key)) continue;
    const Result* here = &part;
    if (path.size() > part.key.size()) {
      if (path[part.key.size()] != '/') continue;
      std::string_view rest = path.substr(part.key.size() + 1);
      const auto& value = part.value.value;
      here = nullptr;
      if (const auto* nested = std::get_if<std::shared_ptr<const Results>>(&value)) {
        here = find_result(**nested, rest);
      } else if (const auto* list = std::get_if<std::shared_ptr<const std::vector<Results>>>(&value)) {
        const std::string_view word = rest.substr(0, rest.find('/'));
        const auto position = word == "$" ? std::optional((*list)->size() - 1) : number_from<std::size_t>(word);
        rest.remove_prefix(std::min(rest.size(), word.size() + 1));
        if (position && *position < (*list)->size()) here = find_result((**list)[*position], rest);
      }
    }
    if (here != nullptr) found = here;
  }
  return found;
}

void add_effects(Results& results, const Effects& effects) {
  std::vector<std::string> active;
  Results inactive;
  for (const Effects::Entry& entry : effects.entries)
    if (entry.active) active.push_back(entry.name);
  results.line("effects", joined(active));
  for (const Effects::Entry& entry : effects.entries) {
    if (entry.active) continue;
    inactive.set(entry.name, entry.why);
    results.line("", fmt::format("no {}: {}", entry.name, entry.why));
  }
  results.set("effects", Results().set("active", active).set("inactive", inactive));
}

namespace {

using Json = nlohmann::ordered_json;

bool is_scalar(const Json& value) {
  return !value.is_array() && !value.is_object();
}

bool fits_one_line(const Json& array) {
  return std::all_of(array.begin(), array.end(),
                     [](const Json& v) { return v.is_number() || v.is_null() || v.is_boolean(); });
}

std::string quoted(const std::string& text) {
  const bool plain = std::ranges::all_of(text, [](char c) { return c >= ' ' && c < 127 && c != '"' && c != '\\'; });
  if (plain) return '"' + text + '"';
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

void append_json(std::string& text, const Json& value, std::size_t depth) {
  const auto new_line = [&](std::size_t at) { text += '\n' + std::string(2 * at, ' '); };
  if (value.is_number_float()) {
    const double number = value.get<double>();
    text += std::isfinite(number) ? fmt::format("{}", number) : "null";
  } else if (value.is_string()) {
    text += quoted(value.get_ref<const std::string&>());
  } else if (is_scalar(value)) {
    text += value.dump();
  } else if (value.empty()) {
    text += value.is_array() ? "[]" : "{}";
  } else if (value.is_array()) {
    const bool one_line = fits_one_line(value);
    text += '[';
    for (std::size_t index = 0; index < value.size(); ++index) {
      if (index > 0) text += one_line ? ", " : ",";
      if (!one_line) new_line(depth + 1);
      append_json(text, value[index], depth + 1);
    }
    if (!one_line) new_line(depth);
    text += ']';
  } else {
    text += '{';
    bool first = true;
    for (const auto& [key, entry] : value.items()) {
      if (!std::exchange(first, false)) text += ',';
      new_line(depth + 1);
      text += quoted(key) + ": ";
      append_json(text, entry, depth + 1);
    }
    new_line(depth);
    text += '}';
  }
}

Json object_of(const Results& results);

Json json_of(const ResultValue& value) {
  return std::visit(
      [](const auto& given) -> Json {
        using Given = std::remove_cvref_t<decltype(given)>;
        if constexpr (std::is_same_v<Given, ResultValue::Null>) {
          return nullptr;
        } else if constexpr (std::is_same_v<Given, std::shared_ptr<const Results>>) {
          return object_of(*given);
        } else if constexpr (std::is_same_v<Given, std::shared_ptr<const std::vector<Results>>>) {
          Json array = Json::array();
          for (const Results& one : *given) array.push_back(object_of(one));
          return array;
        } else {
          return given;
        }
      },
      value.value);
}

Json object_of(const Results& results) {
  Json object = Json::object();
  for (const Result& part : results.parts()) {
    if (part.key.empty()) continue;
    Json* at = &object;
    std::string_view path = part.key;
    for (std::size_t slash = path.find('/'); slash != std::string_view::npos; slash = path.find('/')) {
      at = &(*at)[std::string(path.substr(0, slash))];
      if (!at->is_object()) *at = Json::object();
      path.remove_prefix(slash + 1);
    }
    (*at)[std::string(path)] = json_of(part.value);
  }
  return object;
}

}  // namespace

std::string Results::json() const {
  std::string text;
  append_json(text, object_of(*this), 0);
  return text + '\n';
}

std::string library_version() {
  return EQUIDEM_VERSION;
}

std::optional<double> number_in_json(std::string_view text, const std::string& path) {
  const Json root = Json::parse(text, nullptr, false);
  std::string pointer = "/" + path;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  const Json::json_pointer at(pointer);
  if (root.is_discarded() || !root.contains(at) || !root[at].is_number()) return {};
  return root[at].get<double>();
}

}  // namespace equidem
