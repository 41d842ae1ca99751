// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/table_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_set>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::string_view separators = ",;\t ";

struct NamedUnit {
  std::string_view name;
  Dimension quantity;
  double factor;
};
// Of two micro signs, that of Latin-1 and the Greek letter, each is in use.
constexpr NamedUnit known_units[] = {{"m", Dimension::length, 1},          {"dm", Dimension::length, 0.1},
                                     {"cm", Dimension::length, 0.01},      {"mm", Dimension::length, 1e-3},
                                     {"um", Dimension::length, 1e-6},      {"\u00b5m", Dimension::length, 1e-6},
                                     {"\u03bcm", Dimension::length, 1e-6}, {"nm", Dimension::length, 1e-9},
                                     {"km", Dimension::length, 1e3},       {"s", Dimension::time, 1},
                                     {"ms", Dimension::time, 1e-3},        {"us", Dimension::time, 1e-6},
                                     {"\u00b5s", Dimension::time, 1e-6},   {"\u03bcs", Dimension::time, 1e-6},
                                     {"min", Dimension::time, 60},         {"Hz", Dimension::frequency, 1},
                                     {"kHz", Dimension::frequency, 1e3},   {"MHz", Dimension::frequency, 1e6},
                                     {"%", Dimension::share, 0.01},        {"percent", Dimension::share, 0.01},
                                     {"-", Dimension::share, 1},           {"1", Dimension::share, 1},
                                     {"rad", Dimension::angle, 1},         {"m_per_s", Dimension::speed, 1},
                                     {"m/s", Dimension::speed, 1},         {"mm_per_s", Dimension::speed, 1e-3},
                                     {"mm/s", Dimension::speed, 1e-3},     {"rad_per_s", Dimension::spin, 1},
                                     {"rad/s", Dimension::spin, 1},        {"kg_per_m3", Dimension::density, 1},
                                     {"kg/m3", Dimension::density, 1},     {"kg/m\u00b3", Dimension::density, 1},
                                     {"kg", Dimension::mass, 1},           {"kg_per_m", Dimension::mass, 1},
                                     {"Pa", Dimension::stress, 1},         {"kPa", Dimension::stress, 1e3},
                                     {"MPa", Dimension::stress, 1e6},      {"GPa", Dimension::stress, 1e9}};

std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text.front() == '+' && text[1] != '-' ? text.substr(1) : text;
}

bool is_number(std::string_view text) {
  return number_from<double>(without_plus(text)).has_value();
}

/// A number with a comma in place of the point: "0,5".
std::optional<double> number_of_decimal_comma(std::string_view text) {
  const std::size_t comma = text.find(',');
  const auto digit = [&](std::size_t at) { return at < text.size() && text[at] >= '0' && text[at] <= '9'; };
  if (comma == std::string_view::npos || comma == 0 || !digit(comma - 1) || !digit(comma + 1)) return {};
  if (text.find('.') != std::string_view::npos) return {};
  std::string pointed(text);
  pointed[comma] = '.';
  return number_from<double>(without_plus(pointed));
}

bool is_any_number(std::string_view text) {
  return is_number(text) || number_of_decimal_comma(text).has_value();
}

/// The text without what stands between quotes.
std::string outside_quotes(std::string_view text) {
  std::string outside;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"')
      quoted = !quoted;
    else
      outside += quoted ? 'x' : c;
  }
  return outside;
}

/// Whether a tab of the line separates: not those that follow or precede another separator.
bool tabs_separate(std::string_view line) {
  for (std::size_t tab = line.find('\t'); tab != std::string_view::npos; tab = line.find('\t', tab + 1)) {
    const std::size_t before = line.substr(0, tab).find_last_not_of(" \t"), after = line.find_first_not_of(" \t", tab);
    const auto is_other = [&](std::size_t at) {
      return at != std::string_view::npos && (line[at] == ',' || line[at] == ';');
    };
    if (is_other(before) || is_other(after)) continue;
    // Columns that tabs and blanks align.
    const std::vector<std::string_view> cells = parts_of(line, '\t');
    return std::ranges::none_of(cells, [](std::string_view cell) {
      const auto words = words_of(cell);
      return words.size() > 1 && std::ranges::all_of(words, is_any_number);
    });
  }
  return false;
}

char separator_of(std::string_view record) {
  const std::string line = outside_quotes(record);
  if (tabs_separate(line)) return '\t';
  const auto commas = std::ranges::count(line, ','), semicolons = std::ranges::count(line, ';');
  if (semicolons > 0) {
    const std::vector<std::string_view> cells = parts_of(line, ';');
    const bool numbers = std::ranges::all_of(cells, [](std::string_view c) { return c.empty() || is_any_number(c); });
    if (numbers || semicolons >= commas) return ';';
  }
  if (commas == 0) return ' ';
  const std::vector<std::string_view> words = words_of(line), cells = parts_of(line, ',');
  const bool decimal_commas = words.size() > 1 && std::ranges::all_of(words, is_any_number) &&
                              !std::ranges::all_of(cells, [](std::string_view c) { return is_number(c); });
  return decimal_commas ? ' ' : ',';
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

ColumnName column_name(std::string_view text) {
  ColumnName result{.text = std::string(text), .name = {}, .unit = {}};
  const std::size_t bracket = text.find_first_of("[(");
  if (bracket != std::string_view::npos && bracket > 0 && (text.back() == ']' || text.back() == ')')) {
    result.unit = trimmed(text.substr(bracket + 1, text.size() - bracket - 2));
    text = trimmed(text.substr(0, bracket));
    while (text.ends_with('_')) text.remove_suffix(1);
  } else {
    // The longest unit: that of vx_m_per_s is m_per_s.
    for (std::size_t at = text.find('_', 1); at != std::string_view::npos; at = text.find('_', at + 1)) {
      if (number_from<double>(text.substr(at + 1)) || !unit_factor(text.substr(at + 1))) continue;
      result.unit = text.substr(at + 1);
      text = text.substr(0, at);
      break;
    }
  }
  result.name = lower_case(text);
  return result;
}

/// Words between blanks; a unit in brackets belongs to the name before it.
std::vector<std::string> with_units(const std::vector<std::string_view>& words) {
  std::vector<std::string> names;
  for (const std::string_view word : words) {
    const bool unit =
        word.size() > 2 && (word.front() == '[' || word.front() == '(') && (word.back() == ']' || word.back() == ')');
    if (unit && !names.empty())
      names.back().append(" ").append(word);
    else
      names.emplace_back(word);
  }
  return names;
}

std::vector<ColumnName> column_names(const std::vector<std::string>& words) {
  std::vector<ColumnName> names;
  names.reserve(words.size());
  for (const std::string& word : words) names.push_back(column_name(word));
  return names;
}

constexpr const char* decimal_commas =
    "commas separate the cells: numbers with a decimal comma would be two cells each";

bool commas_may_be_decimal(char separator, const std::vector<std::string_view>& cells) {
  return separator == ',' && std::ranges::all_of(cells, [](std::string_view cell) {
           return !cell.empty() && without_plus(cell).find_first_not_of("-0123456789eE+") == std::string_view::npos;
         });
}

/// Whether each needed column is there.
bool holds(const TableFile::Names& needed, const std::vector<ColumnName>& names) {
  std::unordered_set<std::string_view> given;
  for (const ColumnName& column : names) given.insert(column.name);
  return !needed.empty() && std::ranges::all_of(needed, [&](const std::vector<std::string>& synonyms) {
    return std::ranges::any_of(synonyms, [&](const std::string& name) { return given.contains(lower_case(name)); });
  });
}

}  // namespace

std::optional<double> unit_factor(std::string_view unit, std::optional<Dimension> quantity) {
  for (const NamedUnit& known : known_units)
    if (unit == known.name && (!quantity || *quantity == known.quantity)) return known.factor;
  return {};
}

std::string units_of(Dimension quantity) {
  std::vector<std::string> names;
  for (const NamedUnit& known : known_units)
    if (known.quantity == quantity && static_cast<unsigned char>(known.name.front()) < 0x80)
      names.emplace_back(known.name);
  return joined(names);
}

std::optional<double> length_unit(std::string_view text) {
  text = trimmed(text);
  const std::size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  const std::string_view number = trimmed(text.substr(0, end));
  const auto factor = number.empty() ? std::optional(1.0) : number_from<double>(number);
  const auto metres = unit_factor(trimmed(text.substr(end)), Dimension::length);
  if (!factor || !is_positive(*factor) || !metres) return {};
  return *factor * *metres;
}

TableRecord take_record(std::string_view& rest) {
  TableRecord record;
  const std::size_t line = std::min(rest.find_first_of("\r\n"), rest.size());
  std::size_t end = line;
  if (rest.substr(0, line).find('"') != std::string_view::npos) {
    record.has_quotes = true;
    bool quoted = false, begins = true;  // of a cell
    for (end = 0; end < rest.size(); ++end) {
      const char c = rest[end];
      if (quoted) {
        const bool breaks = c == '\n' || (c == '\r' && !rest.substr(end + 1).starts_with('\n'));
        if (breaks) ++record.lines;
        if (c != '"') continue;
        if (rest.substr(end + 1).starts_with('"'))
          ++end;
        else
          quoted = false;
      } else if (c == '\n' || c == '\r') {
        break;
      } else if (c == '"' && begins) {
        quoted = true;
      }
      begins = separators.find(c) != std::string_view::npos;
    }
    record.is_closed = !quoted;
  }
  record.text = rest.substr(0, end);
  rest.remove_prefix(end);
  rest.remove_prefix(rest.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest.size()));
  return record;
}

/// The quoted cell at the begin of the text, which is taken off.
std::string_view TableCells::unquoted(std::string_view& rest) {
  std::string text;
  std::size_t k = 1;
  for (; k < rest.size(); ++k) {
    if (rest[k] == '"') {
      if (!rest.substr(k + 1).starts_with('"')) break;
      ++k;
    }
    text += rest[k];
  }
  rest.remove_prefix(std::min(k + 1, rest.size()));
  return kept_.emplace_back(std::move(text));
}

void TableCells::split(const TableRecord& record, char separator) {
  cells_.clear();
  kept_.clear();
  std::string_view rest = record.text;
  const std::string_view blanks = separator == '\t' ? " \r" : " \t\r";
  if (!record.has_quotes) {
    if (separator == ' ') {
      cells_ = words_of(rest);
      return;
    }
    for (std::size_t end = 0; end != std::string_view::npos;) {
      end = rest.find(separator);
      cells_.push_back(trimmed(rest.substr(0, end)));
      if (end != std::string_view::npos) rest.remove_prefix(end + 1);
    }
    return;
  }
  bool more = true;
  while (more) {
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    if (separator == ' ' && rest.empty()) return;
    std::string_view cell;
    const bool quoted = rest.starts_with('"');
    if (quoted) cell = unquoted(rest);
    const std::size_t end = separator == ' ' ? rest.find_first_of(" \t") : rest.find(separator);
    const std::string_view left = trimmed(rest.substr(0, end));
    // What follows the quotes of a cell belongs to it: "a" b.
    if (quoted && !left.empty()) cell = kept_.emplace_back(std::string(cell).append(left));
    cells_.push_back(quoted ? cell : left);
    more = end != std::string_view::npos;
    if (more) rest.remove_prefix(end + 1);
  }
}

TableFile::TableFile(const std::filesystem::path& path, Names needed)
    : name_(path.string()), content_(read_file(path)), needed_(std::move(needed)), rest_(content_) {
  begin({});
}

TableFile::TableFile(std::string_view text, std::string name, Names needed, const OfComment& of_comment)
    : name_(std::move(name)), needed_(std::move(needed)), rest_(text) {
  begin(of_comment);
}

std::string TableFile::place(int line) const {
  return name_.empty() ? fmt::format("line {}", line) : fmt::format("{}:{}", name_, line);
}

std::string TableFile::where() const {
  return place(line_);
}

std::string TableFile::where_of_names() const {
  return place(line_of_names_);
}

void TableFile::fail(std::string problem, std::string why, std::string remedy) const {
  bad_input_at(where(), std::move(problem), std::move(why), std::move(remedy));
}

void TableFile::fail_at_names(std::string problem, std::string why, std::string remedy) const {
  bad_input_at(where_of_names(), std::move(problem), std::move(why), std::move(remedy));
}

void TableFile::check_text(std::string_view text) const {
  if (const auto at = place_of_wrong_byte(text)) {
    const auto line = line_ + static_cast<int>(std::ranges::count(text.substr(0, *at), '\n'));
    bad_input_at(place(line),
                 fmt::format("the text is not UTF-8: byte {} of the line is 0x{:02x}",
                             *at - (text.substr(0, *at).rfind('\n') + 1) + 1, static_cast<unsigned char>(text[*at])),
                 "it is of another encoding, such as Latin-1 (Windows-1252)",
                 "Save the file as UTF-8, or leave such characters out");
  }
}

void TableFile::begin(const OfComment& of_comment) {
  refuse_utf16(rest_, name_);
  rest_ = without_byte_order_mark(rest_);
  if (!take_row(of_comment)) return;
  const std::vector<std::string_view>& cells = cells_.all();
  width_ = cells.size();
  row_at_hand_ = true;
  if (names_by_format_) return;
  std::vector<std::string> words(cells.begin(), cells.end());
  if (separator_ == ' ') words = with_units(cells);
  std::vector<ColumnName> columns = column_names(words);
  if (holds(needed_, columns) || std::ranges::none_of(cells, is_any_number)) {
    take_names(std::move(columns));
    line_of_names_ = line_;
    width_ = names_.size();
    row_at_hand_ = false;
  } else if (names_.size() != width_) {
    take_names({});
  }
}

/// The next row with a cell that is not empty; comments before the first one may name the columns.
bool TableFile::take_row(const OfComment& of_comment) {
  while (!rest_.empty()) {
    line_ = next_line_;
    const std::size_t first = rest_.find_first_not_of(" \t");
    if (first != std::string_view::npos && rest_[first] == '#') {
      const std::string_view line = rest_.substr(0, rest_.find_first_of("\r\n"));
      if (separator_ == 0) take_comment(trimmed(line.substr(first + 1)), of_comment);
      rest_.remove_prefix(line.size());
      rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest_.size()));
      ++next_line_;
      continue;
    }
    const TableRecord record = take_record(rest_);
    next_line_ += record.lines;
    const bool names_separator = separator_ == 0 && record.text.starts_with("sep=");  // of spreadsheets
    if (names_separator || trimmed(record.text).empty()) continue;
    check_text(record.text);
    if (!record.is_closed)
      fail("a quote begins here and does not end", "what stands in quotes is one cell", "Close it, or take it out");
    if (separator_ == 0) separator_ = separator_of(record.text);
    cells_.split(record, separator_);
    if (std::ranges::any_of(cells(), [](std::string_view cell) { return !cell.empty(); })) return true;
  }
  return false;
}

void TableFile::take_comment(std::string_view comment, const OfComment& of_comment) {
  if (const auto columns = of_comment ? of_comment(*this, comment) : std::nullopt) {
    take_names(column_names(with_units(words_of(*columns))));
    names_by_format_ = true;
    line_of_names_ = line_;
  }
  if (names_by_format_) return;
  for (const char separator : separators) {
    std::vector<std::string> words;
    if (separator == ' ')
      words = with_units(words_of(comment));
    else
      for (const std::string_view word : parts_of(comment, separator)) words.emplace_back(word);
    std::vector<ColumnName> columns = column_names(words);
    if (!holds(needed_, columns)) continue;
    check_text(comment);
    take_names(std::move(columns));
    line_of_names_ = line_;
    return;
  }
}

void TableFile::take_names(std::vector<ColumnName> names) {
  names_ = std::move(names);
  places_.clear();
  repeated_.clear();
  for (std::size_t c = 0; c < names_.size(); ++c)
    if (!places_.emplace(names_[c].name, c).second) repeated_.emplace(names_[c].name, c);
}

std::optional<std::size_t> TableFile::find(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    const auto found = places_.find(lower_case(name));
    if (found == places_.end()) continue;
    if (const auto again = repeated_.find(found->first); again != repeated_.end())
      fail_at_names(fmt::format("the column '{}' is there twice", name),
                    fmt::format("they are '{}' and '{}', columns {} and {}", names_[found->second].text,
                                names_[again->second].text, found->second + 1, again->second + 1),
                    "Keep one");
    return found->second;
  }
  return {};
}

std::size_t TableFile::need(const std::vector<std::string>& names, const std::string& why) const {
  if (const auto found = find(names)) return *found;
  const std::string& wanted = names.front();
  for (const ColumnName& column : names_) {
    if (!column.name.starts_with(lower_case(wanted) + "_")) continue;
    fail_at_names(
        fmt::format("the column '{}' is missing", wanted),
        fmt::format("'{}' ends in no unit that is known", column.text),
        fmt::format("Units are written as m, mm, um, s, ms: convert it, and name it as '{0}_mm' or '{0} [mm]'",
                    wanted));
  }
  constexpr std::size_t most = 20;
  std::vector<std::string> given;
  for (const ColumnName& column : names_) given.push_back(column.text);
  const auto meant = nearest(wanted, given);
  if (given.size() > most) {
    const std::size_t others = given.size() - most;
    given.resize(most);
    given.push_back(fmt::format("... ({} more)", others));
  }
  fail_at_names(fmt::format("the column '{}' is missing", wanted), why,
                meant           ? fmt::format("The column '{}' may be meant", *meant)
                : given.empty() ? fmt::format("Name the columns in the first row, {} among them", wanted)
                                : fmt::format("Add it; the columns are {}", joined(given)));
}

std::optional<double> TableFile::factor(std::size_t column, std::optional<Dimension> quantity) const {
  if (column >= names_.size() || names_[column].unit.empty()) return {};
  const ColumnName& name = names_[column];
  if (const auto factor = unit_factor(name.unit, quantity)) return factor;
  fail_at_names(fmt::format("the column '{}' has the unit '{}'", name.text, name.unit),
                quantity ? "those that are read here are " + units_of(*quantity) : "it is not known",
                "Convert it, and name one of these, in the same letters");
}

bool TableFile::next() {
  if (width_ == 0) return false;
  if (row_at_hand_) {
    row_at_hand_ = false;
  } else if (!take_row({})) {
    return false;
  }
  const std::size_t count = cells().size();
  const std::size_t wanted = names_.empty() ? width_ : names_.size();
  if (count == wanted || (names_by_format_ && count > wanted)) return true;
  // Spreadsheets end rows in separators.
  if (count > wanted && std::all_of(cells().begin() + static_cast<std::ptrdiff_t>(wanted), cells().end(),
                                    [](std::string_view cell) { return cell.empty(); }))
    return true;
  const std::string expected = names_.empty() ? fmt::format("the first row has {}", wanted)
                                              : fmt::format("line {} names {}", line_of_names_,
                                                            counted(static_cast<long long>(wanted), "column"));
  if (count > wanted && commas_may_be_decimal(separator_, cells()))
    fail(fmt::format("the row has {}", counted(std::ssize(cells()), "cell")), expected + ", and " + decimal_commas,
         "Correct it, or export it with a decimal point, or with semicolons or tabs between the cells");
  fail(fmt::format("the row has {}", counted(static_cast<long long>(count), "cell")), expected,
       "Correct it, or get the whole file if it was cut off");
}

void TableFile::refuse_decimal_commas() const {
  if (!commas_may_be_decimal(separator_, cells())) return;
  fail(fmt::format("the row has {}", counted(std::ssize(cells()), "cell")), decimal_commas,
       "Correct it, or export it with a decimal point, or with semicolons or tabs between the cells");
}

double TableFile::number(std::size_t column, std::string_view name) const {
  const std::string_view cell = cells()[column];
  const std::string_view text = without_plus(cell);
  std::optional<double> value = number_from<double>(text);
  char sign = value && cell.find('.') != std::string_view::npos ? '.' : '\0';
  if (!value) {
    value = number_of_decimal_comma(cell);
    sign = value ? ',' : '\0';
  }
  const std::string what = !name.empty() ? std::string(name) : column < names_.size() ? names_[column].text : "number";
  if (!value || !std::isfinite(*value)) {
    const bool grouped = cell.find('.') != std::string_view::npos && cell.find(',') != std::string_view::npos;
    fail(fmt::format("'{}' is no {}", cell, what), grouped ? "it has a point and a comma" : "a finite number is needed",
         grouped ? "Write it without signs between thousands" : "Correct it");
  }
  if (sign != '\0' && decimal_sign_ == '\0') {
    decimal_sign_ = sign;
    line_of_decimal_sign_ = line_;
  } else if (sign != '\0' && sign != decimal_sign_) {
    fail(fmt::format("'{}' has a decimal {}", cell, sign == ',' ? "comma" : "point"),
         fmt::format("a number of line {} has a decimal {}", line_of_decimal_sign_, sign == ',' ? "point" : "comma"),
         "Write all numbers alike, without signs between thousands");
  }
  return *value;
}

std::int64_t TableFile::whole(std::size_t column, std::string_view name) const {
  if (const auto value = number_from<std::int64_t>(without_plus(cells()[column]))) return *value;
  fail(fmt::format("'{}' is no {}", cells()[column],
                   !name.empty()            ? name
                   : column < names_.size() ? std::string_view(names_[column].text)
                                            : "number"),
       "a whole number is needed", "Correct it");
}

}  // namespace equidem
