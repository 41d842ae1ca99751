// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/check_value.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

using Type = TomlValue::Type;

std::string quoted_list(const std::vector<std::string>& words) {
  return joined(words, [](const std::string& word) { return fmt::format("\"{}\"", word); });
}

[[noreturn]] void fail(const TomlValue& value, const KeySpec& key, const std::string& problem,
                       const std::string& remedy) {
  throw Error(ErrorKind::bad_input, problem, fmt::format("{} is {}", key.name, expected(key)), remedy,
              fmt::format("{}: {}", value.where(), key.path()));
}

bool reads_as_number(const std::string& text) {
  double number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  return problem == std::errc() && end == text.data() + text.size() && !text.empty();
}

/// A value that the key accepts, as TOML.
std::string example(const KeySpec& key) {
  switch (key.type) {
    case KeyType::text:
      return "\"...\"";
    case KeyType::choice:
      return fmt::format("\"{}\"", key.choices.front());
    case KeyType::path:
      return "\"FILE\"";
    case KeyType::flag:
      return "true";
    case KeyType::whole:
      return "10";
    case KeyType::number:
      return key.range.contains(1.0) ? "1.0" : "0.1";
    case KeyType::number_or_auto:
      return "\"auto\"";
    case KeyType::vector:
      return "[1.0, 0.0]";
    case KeyType::box:
      return "[0.0, 0.0, 1.0, 1.0]";
    case KeyType::discs:
      return "[0, 1, 2]";
    case KeyType::circles:
      return "[[0.0, 0.0, 0.01], [0.015, 0.0, 0.01]]";
    case KeyType::sizes:
      return "[100, 400, 1600]";
    case KeyType::numbers:
      return "[0.0, 0.5, 1.0]";
    case KeyType::words:
      return fmt::format("[\"{}\"]", key.choices.front());
    case KeyType::held:
      return "0.001";
    case KeyType::bytes:
      return "\"4 GB\"";
  }
  return {};
}

[[noreturn]] void fail_type(const TomlValue& value, const KeySpec& key) {
  std::string remedy = fmt::format("Write it like {} = {}", key.name, example(key));
  if (value.type == Type::text &&
      (key.type == KeyType::number || key.type == KeyType::number_or_auto || key.type == KeyType::whole) &&
      reads_as_number(value.text))
    remedy = fmt::format("Leave out the quotes: {} = {}", key.name, value.text);
  if (value.type == Type::real && key.type == KeyType::whole && value.real == std::floor(value.real) &&
      std::abs(value.real) < 1e15)
    remedy = fmt::format("Write {} = {:.0f}", key.name, value.real);
  fail(value, key, fmt::format("{} is {}", value.shown(), value.type_name()), remedy);
}

void check_number(const TomlValue& value, const KeySpec& key) {
  if (!value.is_number()) fail_type(value, key);
  if (!std::isfinite(value.real))
    fail(value, key, fmt::format("{} is not a finite number", value.shown()), "Give a finite one");
  if (!key.range.contains(value.real))
    fail(value, key, fmt::format("{} is out of range", value.shown()),
         fmt::format("Give a number {}", key.range.text()));
}

void check_numbers(const TomlValue& value, const KeySpec& key, std::size_t count) {
  if (!value.is_array()) fail_type(value, key);
  if (value.items.size() != count) {
    fail(value, key,
         fmt::format("{} has {}", value.shown(),
                     counted(static_cast<long long>(value.items.size()), "entry", "entries")),
         fmt::format("Give {} of them", count));
  }
  for (const TomlValue& item : value.items) check_number(item, key);
}

void check_discs(const TomlValue& value, const KeySpec& key) {
  if (!value.is_array()) fail_type(value, key);
  if (value.items.empty()) fail(value, key, "the list is empty", "Name at least one disc");
  for (const TomlValue& item : value.items) {
    if (item.type != Type::integer || item.integer < 0 || item.integer > INT32_MAX)
      fail(item, key, fmt::format("{} is no number of a disc", item.shown()), "Discs are counted 0, 1, 2, ...");
  }
}

/// A list that is not empty.
void check_list(const TomlValue& value, const KeySpec& key) {
  if (!value.is_array()) fail_type(value, key);
  if (value.items.empty())
    fail(value, key, "the list is empty", fmt::format("Write it like {} = {}", key.name, example(key)));
}

void check_circles(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (const TomlValue& item : value.items) {
    if (!item.is_array()) fail_type(value, key);
    check_numbers(item, key, 3);
    if (!(item.items[2].real > 0))
      fail(item.items[2], key, fmt::format("the radius {} is out of range", item.items[2].shown()),
           "Give a number > 0");
  }
}

void check_sizes(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (std::size_t k = 0; k < value.items.size(); ++k) {
    const TomlValue& item = value.items[k];
    if (item.type != Type::integer) fail_type(item, key);
    check_number(item, key);
    if (k > 0 && item.integer <= value.items[k - 1].integer) {
      fail(item, key, fmt::format("{} comes after {}", item.integer, value.items[k - 1].integer),
           "Write each number once, the smallest first");
    }
  }
}

void check_choice(const TomlValue& value, const KeySpec& key) {
  if (value.type != Type::text) fail_type(value, key);
  if (std::find(key.choices.begin(), key.choices.end(), value.text) != key.choices.end()) return;
  const auto meant = nearest(value.text, key.choices);
  fail(value, key,
       fmt::format("{} is {} {}", value.shown(), key.type == KeyType::words ? "none of the" : "no known", key.name),
       meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Choose one of these");
}

void check_words(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (std::size_t k = 0; k < value.items.size(); ++k) {
    check_choice(value.items[k], key);
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      if (value.items[earlier].text == value.items[k].text)
        fail(value.items[k], key, fmt::format("{} is there twice", value.items[k].shown()), "Write each word once");
  }
}

}  // namespace

std::string expected(const KeySpec& key) {
  const std::string unit = key.unit.empty() ? "" : fmt::format(" in {}", key.unit);
  const std::string range = key.range.text().empty() ? "" : fmt::format(", {}", key.range.text());
  switch (key.type) {
    case KeyType::text:
      return "text in quotes";
    case KeyType::choice:
      return key.choices.size() == 1 ? quoted_list(key.choices) : fmt::format("one of {}", quoted_list(key.choices));
    case KeyType::path:
      return "the name of a file, in quotes";
    case KeyType::flag:
      return "true or false";
    case KeyType::whole:
      return "a whole number" + range;
    case KeyType::number:
      return "a number" + unit + range;
    case KeyType::number_or_auto:
      return "\"auto\", or a number" + unit + range;
    case KeyType::vector:
      return "two numbers [x, y]" + unit;
    case KeyType::box:
      return "four numbers [x_min, y_min, x_max, y_max]" + unit;
    case KeyType::discs:
      return "a list of disc numbers, such as [0, 1, 2]";
    case KeyType::circles:
      return "a list of circles [x, y, radius]" + unit + ", radius > 0";
    case KeyType::sizes:
      return "a list of ascending whole numbers" + range;
    case KeyType::numbers:
      return "a list of numbers" + unit + range;
    case KeyType::words:
      return "a list of words out of " + quoted_list(key.choices);
    case KeyType::held:
      return "a number" + unit + ", or true for 0";
    case KeyType::bytes:
      return "a number of bytes, or text such as \"4 GB\"";
  }
  return {};
}

std::optional<double> bytes_of(const TomlValue& value) {
  if (value.is_number()) return value.real;
  if (value.type != Type::text) return {};
  double number = 0;
  const char* const end = value.text.data() + value.text.size();
  const auto [rest, problem] = std::from_chars(value.text.data(), end, number);
  if (problem != std::errc()) return {};
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  struct Unit {
    std::string_view name;
    double bytes;
  };
  constexpr std::array units{Unit{"B", 1},        Unit{"kB", 1e3},     Unit{"MB", 1e6},
                             Unit{"GB", 1e9},     Unit{"TB", 1e12},    Unit{"KiB", 0x1p10},
                             Unit{"MiB", 0x1p20}, Unit{"GiB", 0x1p30}, Unit{"TiB", 0x1p40}};
  for (const Unit& known : units)
    if (unit == known.name) return number * known.bytes;
  return {};
}

void check_value(const TomlValue& value, const KeySpec& key) {
  switch (key.type) {
    case KeyType::text:
      if (value.type != Type::text) fail_type(value, key);
      return;
    case KeyType::choice:
      return check_choice(value, key);
    case KeyType::path:
      if (value.type != Type::text) fail_type(value, key);
      if (value.text.empty()) fail(value, key, "the name is empty", "Name a file");
      return;
    case KeyType::flag:
      if (value.type != Type::boolean) fail_type(value, key);
      return;
    case KeyType::whole:
      if (value.is_number() && !std::isfinite(value.real)) return check_number(value, key);
      if (value.type != Type::integer) fail_type(value, key);
      return check_number(value, key);
    case KeyType::number:
      return check_number(value, key);
    case KeyType::number_or_auto:
      if (value.type == Type::text && value.text == "auto") return;
      return check_number(value, key);
    case KeyType::vector:
      return check_numbers(value, key, 2);
    case KeyType::box:
      return check_numbers(value, key, 4);
    case KeyType::discs:
      return check_discs(value, key);
    case KeyType::circles:
      return check_circles(value, key);
    case KeyType::sizes:
      return check_sizes(value, key);
    case KeyType::numbers:
      check_list(value, key);
      return check_numbers(value, key, value.items.size());
    case KeyType::words:
      return check_words(value, key);
    case KeyType::held:
      if (value.type == Type::boolean) {
        if (value.boolean) return;
        fail(value, key, "false is not allowed", fmt::format("Leave {} out where it is free", key.name));
      }
      return check_number(value, key);
    case KeyType::bytes: {
      const auto bytes = bytes_of(value);
      if (!bytes) fail_type(value, key);
      if (!key.range.contains(*bytes))
        fail(value, key, fmt::format("{} is out of range", value.shown()),
             fmt::format("Give a number {}", key.range.text()));
      return;
    }
  }
}

}  // namespace equidem::casefile
