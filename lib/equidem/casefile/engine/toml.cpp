// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/toml.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <toml++/toml.h>

#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/given.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;
using Source = std::shared_ptr<const std::string>;

constexpr const char* no_such_key = "no key of a file is that long";

TomlValue plain(const toml::node& node, const Source& source) {
  using Type = TomlValue::Type;
  constexpr std::size_t longest_key = 200;
  TomlValue value;
  value.source = source;
  value.line = static_cast<int>(node.source().begin.line);
  if (const toml::table* table = node.as_table()) {
    value.type = Type::table;
    for (const auto& [key, child] : *table) {
      if (key.str().size() > longest_key)
        bad_input_at(fmt::format("{}:{}", *source, key.source().begin.line),
                     fmt::format("a key has {} bytes", key.str().size()), no_such_key, "Correct the key");
      TomlValue entry = plain(child, source);
      // The name stands where the reader looks; the value of a table may begin on a later line.
      entry.line = static_cast<int>(key.source().begin.line);
      value.entries.push_back({std::string(key.str()), std::move(entry)});
    }
    std::stable_sort(value.entries.begin(), value.entries.end(),
                     [](const auto& a, const auto& b) { return a.value.line < b.value.line; });
  } else if (const toml::array* array = node.as_array()) {
    value.type = Type::array;
    for (const toml::node& item : *array) value.items.push_back(plain(item, source));
  } else if (const auto* text = node.as_string()) {
    value.type = Type::text;
    value.text = text->get();
    if (has_controls(value.text))
      bad_input_at(value.where(), "a text has control characters",
                   "terminals obey them, and no page or picture can hold them", "Remove them");
  } else if (const auto* integer = node.as_integer()) {
    value.type = Type::integer;
    value.integer = integer->get();
    value.real = static_cast<double>(value.integer);
  } else if (const auto* real = node.as_floating_point()) {
    value.type = Type::real;
    value.real = real->get();
  } else if (const auto* boolean = node.as_boolean()) {
    value.type = Type::boolean;
    value.boolean = boolean->get();
  } else {
    value.type = Type::date;
  }
  return value;
}

/// Control characters, which would break a message into lines, as spaces.
std::string in_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, ' ');
  return text;
}

/// Each part of a dotted key is a table in a table, and each of these a call on the stack. Points of texts and numbers
/// count, too, up to the next comma or line.
void check_depth(std::string_view text, const std::string& source) {
  constexpr int deepest = 100;
  int points = 0, line = 1;
  std::vector<int> outside;  // of each inline table that is open
  for (const char c : text) {
    if (c == '.') ++points;
    if ((c == '=' || c == ']') && points > deepest)
      bad_input_at(fmt::format("{}:{}", source, line), fmt::format("a key has {} parts", points + 1), no_such_key,
                   "Correct the key");
    if (c == '{') outside.push_back(points);
    if (c == ',' || c == '}') points = outside.empty() ? 0 : outside.back();
    if (c == '}' && !outside.empty()) outside.pop_back();
    if (c != '\n') continue;
    ++line;
    points = 0;
    outside.clear();
  }
}

/// Cut between two characters, not inside the bytes of one.
std::string shortened(const std::string& text, std::size_t longest) {
  if (text.size() <= longest) return text;
  std::size_t end = longest - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

/// Messages of toml++ are "Error while parsing X: what"; only `what` is reported.
std::string reason_of(const toml::parse_error& error) {
  std::string reason(error.description());
  if (reason.starts_with("Error while parsing ")) reason = "in the " + reason.substr(20);
  while (!reason.empty() && reason.back() == '.') reason.pop_back();
  return shortened(in_one_line(reason), 200);
}

/// Advice on the first number of a line that TOML does not take.
std::optional<NumberAdvice> advice_on_line(std::string_view line) {
  line = line.substr(0, line.find('#'));
  for (std::size_t at = line.find('='); at != std::string_view::npos; at = line.find('=', at + 1)) {
    std::string_view value = line.substr(at + 1);
    if (const auto advice = number_advice(trimmed(value))) return advice;
    const std::size_t end = value.find_first_of("}=");
    value = value.substr(0, end);
    if (const auto advice = number_advice(trimmed(value))) return advice;
    for (const std::string_view part : parts_of(value, ',')) {
      std::string_view item = part;
      while (!item.empty() && (item.front() == '[' || item.front() == ' ')) item.remove_prefix(1);
      while (!item.empty() && (item.back() == ']' || item.back() == ' ')) item.remove_suffix(1);
      if (const auto advice = number_advice(item)) return advice;
    }
  }
  return {};
}

/// A value as TOML, texts and lists cut to these lengths; tables and dates only named.
std::string written(const TomlValue& value, std::size_t longest_text, std::size_t most_items) {
  switch (value.type) {
    case TomlValue::Type::table:
      return "{ ... }";
    case TomlValue::Type::integer:
      return fmt::format("{}", value.integer);
    case TomlValue::Type::real:
      return toml_number(value.real);
    case TomlValue::Type::boolean:
      return value.boolean ? "true" : "false";
    case TomlValue::Type::text:
      return toml_text(shortened(value.text, longest_text));
    case TomlValue::Type::date:
      return value.type_name();
    case TomlValue::Type::array:
      break;
  }
  const std::string items = joined(std::span(value.items).first(std::min(value.items.size(), most_items)),
                                   [&](const TomlValue& item) { return written(item, longest_text, most_items); });
  return fmt::format("[{}{}]", items, value.items.size() > most_items ? ", ..." : "");
}

constexpr std::size_t unlimited = std::numeric_limits<std::ptrdiff_t>::max();

bool is_list_of_tables(const TomlValue& value) {
  return value.is_array() && !value.items.empty() && value.items[0].is_table();
}

void write_table(std::string& out, const std::string& path, const TomlValue& table) {
  for (const auto& [name, value] : table.entries) {
    if (value.is_table() || is_list_of_tables(value) || (value.is_array() && value.items.empty())) continue;
    out += name + " = " + written(value, unlimited, unlimited) + "\n";
  }
  for (const auto& [name, value] : table.entries) {
    const std::string full = path.empty() ? name : path + "." + name;
    if (value.is_table() && !value.entries.empty()) {
      out += "\n[" + full + "]\n";
      write_table(out, full, value);
    } else if (is_list_of_tables(value)) {
      for (const TomlValue& item : value.items) {
        out += "\n[[" + full + "]]\n";
        write_table(out, full, item);
      }
    }
  }
}

void make_relative(TomlValue& value, const fs::path& folder) {
  for (TomlValue& item : value.items) make_relative(item, folder);
  for (auto& [name, entry] : value.entries) make_relative(entry, folder);
  if (!value.is_path) return;
  std::error_code failed;
  const fs::path from = fs::absolute(folder, failed).lexically_normal();
  const fs::path to = fs::absolute(value.text, failed).lexically_normal();
  const fs::path relative = to.lexically_relative(from);
  value.text = relative.empty() ? to.string() : relative.string();
}

}  // namespace

const TomlValue* TomlValue::find(std::string_view name) const {
  if (is_array()) {
    const auto index = number_from<std::size_t>(name);
    return index && *index < items.size() ? &items[*index] : nullptr;
  }
  const auto found = std::ranges::find(entries, name, &TomlEntry::name);
  return found == entries.end() ? nullptr : &found->value;
}

TomlValue* TomlValue::find(std::string_view name) {
  return const_cast<TomlValue*>(static_cast<const TomlValue*>(this)->find(name));
}

std::string TomlValue::where() const {
  const std::string name = source ? *source : std::string();
  return line > 0 ? fmt::format("{}:{}", name, line) : name;
}

std::string TomlValue::place() const {
  return path.empty() ? where() : fmt::format("{}: {}", where(), path);
}

void set_paths(TomlValue& value, const std::string& path) {
  value.path = path;
  for (TomlValue& item : value.items) set_paths(item, path);
  for (auto& [name, entry] : value.entries) set_paths(entry, path.empty() ? name : path + "." + name);
}

std::string TomlValue::type_name() const {
  return to_string(type);
}

std::string TomlValue::shown() const {
  return written(*this, 40, 4);
}

const TomlValue& value_at(const TomlValue& root, std::string_view path) {
  const TomlValue* at = &root;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const TomlValue* next = at->find(path.substr(0, dot));
    if (next == nullptr) break;
    at = next;
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return *at;
}

std::string CaseDocument::where(std::string_view key) const {
  return fmt::format("{}: {}", value_at(document, key).where(), key);
}

std::vector<std::string> CaseDocument::headings(std::span<const char* const> tables) const {
  std::vector<std::string> found;
  for (const char* name : tables) {
    if (const TomlValue* table = document.find(name); table != nullptr)
      found.push_back(table->is_array() ? fmt::format("[[{}]]", name) : fmt::format("[{}]", name));
  }
  return found;
}

TomlValue parse_toml(std::string_view text, const std::string& source) {
  refuse_utf16(text, source);
  check_depth(text, source);
  const auto name = std::make_shared<const std::string>(source);
  try {
    TomlValue root = plain(toml::parse(text, std::string_view(source)), name);
    set_paths(root);
    return root;
  } catch (const toml::parse_error& error) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool json = first != std::string_view::npos && text[first] == '{';
    if (json || source.ends_with(".csv")) {
      bad_input_at(source, json ? "this is JSON, not a case file" : "this is a CSV table, not a case file",
                   "a case file is TOML that says what is computed",
                   json ? "Name an assembly as path in [assembly], with kind = \"file\""
                        : "Name a table of grains as path in [grains], a sieve curve in [packing.radii]");
    }
    const auto line = error.source().begin.line;
    std::string_view rest = text;
    for (toml::source_index k = 1; k < line && !rest.empty(); ++k)
      rest.remove_prefix(std::min(rest.find('\n'), rest.size() - 1) + 1);
    const std::string where = fmt::format("{}:{}", source, line);
    if (const auto advice = advice_on_line(trimmed(rest.substr(0, rest.find('\n')))))
      bad_input_at(where, "this is not TOML", advice->why, advice->remedy);
    bad_input_at(where, "this is not TOML", reason_of(error),
                 "Correct the line; 'equidem help case' shows a case file");
  }
}

std::optional<NumberAdvice> number_advice(std::string_view text) {
  const std::string_view sign = text.substr(0, text.find_first_not_of("+-") == 1 ? 1 : 0);
  std::string number(text.substr(sign.size()));
  std::string why;
  bool is_scaled = false;
  if (const std::size_t blank = number.find(' '); blank != std::string::npos) {
    const std::string unit(trimmed(std::string_view(number).substr(blank)));
    const bool has_digits = unit.find_first_of("0123456789") != std::string::npos && !unit_factor(unit);
    number.resize(blank);
    if (has_digits || !number_from<double>(number) || unit.find_first_of(".,=[]{}\"'") != std::string::npos) return {};
    why = fmt::format("a number stands without its unit, here {}", unit);
    is_scaled = unit_factor(unit).value_or(1) != 1;
  } else if (const std::size_t comma = number.find(','); comma != std::string::npos) {
    number[comma] = '.';
    why = "numbers have a decimal point, not a comma";
  }
  const auto digit_at = [&](std::size_t k) { return k < number.size() && number[k] >= '0' && number[k] <= '9'; };
  if (number.starts_with('.') && digit_at(1)) {
    number.insert(0, 1, '0');
    if (why.empty()) why = "a digit stands before the point";
  }
  const std::size_t point = number.find('.');
  if (point != std::string::npos &&
      (point + 1 == number.size() || number[point + 1] == 'e' || number[point + 1] == 'E')) {
    number.insert(point + 1, 1, '0');
    if (why.empty()) why = "a digit stands behind the point";
  }
  if (why.empty() || !digit_at(0) || !number_from<double>(number)) return {};
  return NumberAdvice{"TOML: " + why, is_scaled ? "Write the number in the unit of the key"
                                                : fmt::format("Write {}{}", sign == "-" ? "-" : "", number)};
}

std::string toml_parser() {
  return fmt::format("toml++ {}.{}.{}", TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH);
}

std::string toml_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += fmt::format("\\u{:04X}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string to_toml(TomlValue document, const fs::path& folder) {
  make_relative(document, folder);
  const auto place = [](const auto& entry) { return entry.name == "schema" ? 0 : entry.name == "title" ? 1 : 2; };
  std::stable_sort(document.entries.begin(), document.entries.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  std::string out;
  write_table(out, "", document);
  return out;
}

namespace {

void collect_paths(const TomlValue& value, std::vector<fs::path>& paths) {
  for (const TomlValue& item : value.items) collect_paths(item, paths);
  for (const auto& [name, entry] : value.entries)
    if (entry.path != "output") collect_paths(entry, paths);
  if (value.is_path) paths.emplace_back(value.text);
}

}  // namespace

std::string note_of_files(const TomlValue& document, std::span<const fs::path> further) {
  std::vector<fs::path> paths;
  collect_paths(document, paths);
  paths.insert(paths.end(), further.begin(), further.end());
  Checksum sum;
  bool any = false;
  for (const fs::path& path : paths) {
    std::error_code missing;
    if (Given<std::string>::find(path) == nullptr && !fs::is_regular_file(path, missing)) continue;
    const std::string content = read_file(path);
    sum.add(std::as_bytes(std::span(content)));
    sum.add(std::uint64_t{content.size()});
    any = true;
  }
  return any ? fmt::format("\n# checksum of the files that the case reads: {}\n", sum.text()) : std::string();
}

}  // namespace equidem
