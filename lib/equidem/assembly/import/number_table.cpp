// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/import/number_table.hpp"

#include <algorithm>
#include <cctype>

#include "equidem/assembly/import/length_unit.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

ColumnName column_name(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = trimmed(text.substr(1, text.size() - 2));
  ColumnName result;
  const std::size_t bracket = text.find_first_of("[(");
  const std::size_t last = text.rfind('_');
  if (bracket != std::string_view::npos && bracket > 0 && (text.back() == ']' || text.back() == ')') &&
      length_unit(text.substr(bracket + 1, text.size() - bracket - 2))) {
    result.unit = text.substr(bracket + 1, text.size() - bracket - 2);
    text = trimmed(text.substr(0, bracket));
  } else if (last != std::string_view::npos && last > 0 && last + 1 < text.size() &&
             std::isalpha(static_cast<unsigned char>(text[last + 1])) != 0 && length_unit(text.substr(last + 1))) {
    result.unit = text.substr(last + 1);
    text = text.substr(0, last);
  }
  result.name = text;
  std::ranges::transform(result.name, result.name.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

/// The columns of YADE's export.textExt; none of a format that it does not have.
std::optional<std::string> columns_of_yade(std::string_view format) {
  if (format == "x_y_z_r" || format == "x_y_z_r_attrs") return "x y z r";
  if (format == "x_y_z_r_matId") return "x y z r matId";
  if (format == "id_x_y_z_r_matId") return "id x y z r matId";
  return {};
}

bool is_number(std::string_view text) {
  return number_from<double>(text.starts_with('+') ? text.substr(1) : text).has_value();
}

}  // namespace

NumberTable::NumberTable(std::string_view text) : lines_(without_byte_order_mark(text)) {
  while (lines_.next()) {
    const std::string_view line = lines_.line();
    if (line.empty()) continue;
    if (line.front() == '#') {
      take_comment(trimmed(line.substr(1)));
      continue;
    }
    separator_ = line.find(',') != std::string_view::npos ? ',' : line.find(';') != std::string_view::npos ? ';' : ' ';
    split(line);
    const auto is_numeric = [](std::string_view cell) { return cell.empty() || is_number(cell); };
    if (!names_.empty() || std::ranges::all_of(cells_, is_numeric)) {
      if (names_.empty() && commented_.size() == cells_.size()) {
        names_ = std::move(commented_);
        line_of_names_ = line_of_comment_;
      }
      if (!names_.empty() && (by_yade_ ? names_.size() > cells_.size() : names_.size() != cells_.size()))
        lines_.fail(fmt::format("the row has {}", counted(std::ssize(cells_), "cell")),
                    fmt::format("line {} names {}", line_of_names_, counted(std::ssize(names_), "column")),
                    "Correct it");
      return;
    }
    take_names(cells_, lines_.number());
  }
  lines_.fail("the table has no rows", "", "Write it again");
}

void NumberTable::split(std::string_view line) {
  cells_ = separator_ == ' ' ? words_of(line) : parts_of(line, separator_);
}

void NumberTable::take_names(const std::vector<std::string_view>& words, int line) {
  names_.clear();
  for (const std::string_view word : words) {
    ColumnName column = column_name(word);
    if (!column.name.empty() && std::ranges::find(names_, column.name, &ColumnName::name) != names_.end())
      lines_.fail(fmt::format("the column '{}' is there twice", column.name), "", "Keep one");
    names_.push_back(std::move(column));
  }
  line_of_names_ = line;
}

void NumberTable::take_comment(std::string_view comment) {
  constexpr std::string_view format = "format ";
  if (comment.starts_with(format)) {
    const std::string_view name = trimmed(comment.substr(format.size()));
    const auto columns = columns_of_yade(name);
    if (!columns)
      lines_.fail(fmt::format("'{}' is no format of places and radii", name),
                  "those of export.textExt are x_y_z_r, x_y_z_r_matId, x_y_z_r_attrs and id_x_y_z_r_matId",
                  "Export it with one of them");
    take_names(words_of(*columns), lines_.number());
    by_yade_ = true;
    return;
  }
  const std::vector<std::string_view> words =
      comment.find(',') != std::string_view::npos ? parts_of(comment, ',') : words_of(comment);
  commented_.clear();
  for (const std::string_view word : words) commented_.push_back(column_name(word));
  line_of_comment_ = lines_.number();
}

std::optional<std::size_t> NumberTable::find(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    const auto found = std::ranges::find(names_, name, &ColumnName::name);
    if (found != names_.end()) return found - names_.begin();
  }
  return {};
}

std::size_t NumberTable::need(const std::vector<std::string>& names, const std::string& why) const {
  if (const auto found = find(names)) return *found;
  std::vector<std::string> given;
  for (const ColumnName& column : names_) given.push_back(column.name);
  const auto with_unit = std::ranges::find_if(given, [&](const std::string& name) {
    return name.starts_with(names.front() + "_") || name.starts_with(names.front() + "[") ||
           name.starts_with(names.front() + " ");
  });
  if (with_unit != given.end()) {
    bad_input_at(fmt::format("line {}", line_of_names_), fmt::format("the column '{}' is missing", names.front()),
                 fmt::format("'{}' ends in no unit of length that is known: m, dm, cm, mm, um, nm, km", *with_unit),
                 fmt::format("Convert it, and name it as '{0}_mm' or '{0} [mm]'", names.front()));
  }
  const auto meant = nearest(names.front(), given);
  bad_input_at(fmt::format("line {}", line_of_names_), fmt::format("the column '{}' is missing", names.front()), why,
               meant ? fmt::format("The column '{}' may be meant", *meant)
                     : fmt::format("Add it; the columns are {}", joined(given)));
}

bool NumberTable::next() {
  const std::size_t width = cells_.size();
  do {
    if (!lines_.next()) return false;
  } while (lines_.line().empty() || lines_.line().front() == '#');
  split(lines_.line());
  if (cells_.size() == width) return true;
  lines_.fail(fmt::format("the row has {}", counted(std::ssize(cells_), "cell")),
              fmt::format("the first row has {}", width), "Correct it, or get the whole file if it was cut off");
}

}  // namespace equidem
