// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/toml.hpp"

#include <algorithm>
#include <cmath>

#include <toml++/toml.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using Source = std::shared_ptr<const std::string>;

TomlValue plain(const toml::node& node, const Source& source) {
  using Type = TomlValue::Type;
  TomlValue value;
  value.source = source;
  value.line = static_cast<int>(node.source().begin.line);
  if (const toml::table* table = node.as_table()) {
    value.type = Type::table;
    for (const auto& [key, child] : *table) {
      TomlValue entry = plain(child, source);
      // The name stands where the reader looks; the value of a table may begin on a later line.
      entry.line = static_cast<int>(key.source().begin.line);
      value.entries.emplace_back(std::string(key.str()), std::move(entry));
    }
    std::stable_sort(value.entries.begin(), value.entries.end(),
                     [](const auto& a, const auto& b) { return a.second.line < b.second.line; });
  } else if (const toml::array* array = node.as_array()) {
    value.type = Type::array;
    for (const toml::node& item : *array) value.items.push_back(plain(item, source));
  } else if (const auto* text = node.as_string()) {
    value.type = Type::text;
    value.text = text->get();
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

/// Messages of toml++ are "Error while parsing X: what"; only `what` is reported.
std::string reason_of(const toml::parse_error& error) {
  std::string reason(error.description());
  if (reason.starts_with("Error while parsing ")) reason = "in the " + reason.substr(20);
  while (!reason.empty() && reason.back() == '.') reason.pop_back();
  return in_one_line(reason);
}

/// Cut between two characters, not inside the bytes of one.
std::string shortened(const std::string& text) {
  constexpr std::size_t longest = 40;
  if (text.size() <= longest) return text;
  std::size_t end = longest - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

}  // namespace

const TomlValue* TomlValue::find(std::string_view name) const {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == name; });
  return found == entries.end() ? nullptr : &found->second;
}

TomlValue* TomlValue::find(std::string_view name) {
  return const_cast<TomlValue*>(static_cast<const TomlValue*>(this)->find(name));
}

std::string TomlValue::where() const {
  const std::string name = source ? *source : std::string();
  return line > 0 ? fmt::format("{}:{}", name, line) : name;
}

std::string TomlValue::type_name() const {
  switch (type) {
    case Type::table:
      return "a table";
    case Type::array:
      return "an array";
    case Type::integer:
      return "a whole number";
    case Type::real:
      return "a number";
    case Type::boolean:
      return "true or false";
    case Type::text:
      return "text";
    case Type::date:
      return "a date";
  }
  return {};
}

std::string TomlValue::shown() const {
  switch (type) {
    case Type::table:
      return "{ ... }";
    case Type::integer:
      return fmt::format("{}", integer);
    case Type::real:
      return toml_number(real);
    case Type::boolean:
      return boolean ? "true" : "false";
    case Type::text:
      return toml_text(shortened(text));
    case Type::date:
      return "a date";
    case Type::array: {
      std::string shown_items;
      for (std::size_t k = 0; k < items.size() && k < 4; ++k) shown_items += (k > 0 ? ", " : "") + items[k].shown();
      return fmt::format("[{}{}]", shown_items, items.size() > 4 ? ", ..." : "");
    }
  }
  return {};
}

TomlValue parse_toml(std::string_view text, const std::string& source) {
  const auto name = std::make_shared<const std::string>(source);
  try {
    return plain(toml::parse(text, std::string_view(source)), name);
  } catch (const toml::parse_error& error) {
    throw Error(ErrorKind::bad_input, "this is not TOML", reason_of(error),
                "Correct the line; 'equidem help case' shows a case file",
                fmt::format("{}:{}", source, error.source().begin.line));
  }
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

}  // namespace equidem
