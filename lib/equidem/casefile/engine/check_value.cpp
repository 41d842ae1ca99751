// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/engine/removed_keys.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

using Type = TomlValue::Type;

std::string quoted_list(const std::vector<std::string>& words) {
  return joined(words, [](const std::string& word) { return fmt::format("\"{}\"", word); });
}

[[noreturn]] void fail(const TomlValue& value, const KeySpec& key, const std::string& problem,
                       const std::string& remedy) {
  fail_at(value, key.path(), problem, fmt::format("{} is {}", key.name, expected(key)), remedy);
}

/// A kind of value. In the texts {unit}, {range}, {choices} and {words} stand for those of the key, {number} for a
/// number in its range.
struct ValueKind {
  KeyType type;
  const char* expected;  ///< values that a key accepts
  const char* example;   ///< one of them, as TOML
  void (*check)(const TomlValue&, const KeySpec&);
};
const ValueKind& kind_of(KeyType type);

std::string filled(const char* text, const KeySpec& key) {
  const std::string words = quoted_list(key.choices);
  return fmt::format(fmt::runtime(text), fmt::arg("unit", key.unit.empty() ? "" : " in " + key.unit),
                     fmt::arg("range", key.range.text().empty() ? "" : ", " + key.range.text()),
                     fmt::arg("choices", (key.choices.size() == 1 ? "" : "one of ") + words), fmt::arg("words", words),
                     fmt::arg("first", key.choices.empty() ? "" : key.choices.front()),
                     fmt::arg("number", key.range.contains(1.0) ? "1.0" : "0.1"));
}

/// "Write it like key = example".
std::string like_example(const KeySpec& key) {
  return fmt::format("Write it like {} = {}", key.name, filled(kind_of(key.type).example, key));
}

[[noreturn]] void fail_type(const TomlValue& value, const KeySpec& key) {
  std::string remedy = like_example(key);
  if (value.type == Type::text &&
      (key.type == KeyType::number || key.type == KeyType::number_or_auto || key.type == KeyType::whole) &&
      number_from<double>(value.text))
    remedy = fmt::format("Leave out the quotes: {} = {}", key.name, value.text);
  if (value.type == Type::real && key.type == KeyType::whole && value.real == std::floor(value.real) &&
      std::abs(value.real) < 1e15)
    remedy = fmt::format("Write {} = {:.0f}", key.name, value.real);
  fail(value, key, fmt::format("{} is {}", value.shown(), value.type_name()), remedy);
}

[[noreturn]] void fail_range(const TomlValue& value, const KeySpec& key) {
  fail(value, key, fmt::format("{} is out of range", value.shown()), fmt::format("Give a number {}", key.range.text()));
}

void check_number(const TomlValue& value, const KeySpec& key) {
  if (!value.is_number()) fail_type(value, key);
  if (!std::isfinite(value.real))
    fail(value, key, fmt::format("{} is not a finite number", value.shown()), "Give a finite one");
  if (!key.range.contains(value.real)) fail_range(value, key);
}

template <std::size_t count>
void check_numbers(const TomlValue& value, const KeySpec& key) {
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
  if (value.items.empty()) fail(value, key, "the list is empty", like_example(key));
}

void check_list_of_numbers(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (const TomlValue& item : value.items) check_number(item, key);
}

void check_circles(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (const TomlValue& item : value.items) {
    if (!item.is_array()) fail_type(value, key);
    check_numbers<3>(item, key);
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
  if (std::ranges::find(key.choices, value.text) != key.choices.end()) return;
  const std::string problem =
      fmt::format("{} is {} {}", value.shown(), key.type == KeyType::words ? "none of the" : "no known", key.name);
  if (const RemovedKey* removed = removed_key(key.table, key.name, value.text))
    fail_at(value, key.path(), fmt::format("{} is of an earlier version", value.shown()),
            fmt::format("{} takes it no longer", key.name), std::string(removed->remedy));
  const auto refused = std::ranges::find(key.refused, value.text, &RefusedWord::word);
  if (refused != key.refused.end()) fail_at(value, key.path(), problem, refused->why, refused->remedy);
  const auto meant = nearest(value.text, key.choices);
  fail(value, key, problem, meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Choose one of these");
}

void check_words(const TomlValue& value, const KeySpec& key) {
  if (!(value.is_array() && key.may_be_empty)) check_list(value, key);
  for (std::size_t k = 0; k < value.items.size(); ++k) {
    check_choice(value.items[k], key);
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      if (value.items[earlier].text == value.items[k].text)
        fail(value.items[k], key, fmt::format("{} is there twice", value.items[k].shown()), "Write each word once");
  }
}

template <Type type>
void check_type(const TomlValue& value, const KeySpec& key) {
  if (value.type != type) fail_type(value, key);
}

void check_path(const TomlValue& value, const KeySpec& key) {
  check_type<Type::text>(value, key);
  if (value.text.empty()) fail(value, key, "the name is empty", "Name a file");
}

void check_whole(const TomlValue& value, const KeySpec& key) {
  const bool infinite = value.is_number() && !std::isfinite(value.real);
  if (value.type != Type::integer && !infinite) fail_type(value, key);
  check_number(value, key);
}

void check_number_or_auto(const TomlValue& value, const KeySpec& key) {
  if (value.type != Type::text || value.text != "auto") check_number(value, key);
}

void check_held(const TomlValue& value, const KeySpec& key) {
  if (value.type != Type::boolean) return check_number(value, key);
  if (!value.boolean) fail(value, key, "false is not allowed", fmt::format("Leave {} out where it is free", key.name));
}

void check_bytes(const TomlValue& value, const KeySpec& key) {
  const auto size = bytes_of(value);
  if (!size) fail_type(value, key);
  if (!key.range.contains(*size)) fail_range(value, key);
}

constexpr ValueKind kinds[] = {
    {KeyType::text, "text in quotes", "\"...\"", check_type<Type::text>},
    {KeyType::choice, "{choices}", "\"{first}\"", check_choice},
    {KeyType::path, "the name of a file, in quotes", "\"FILE\"", check_path},
    {KeyType::flag, "true or false", "true", check_type<Type::boolean>},
    {KeyType::whole, "a whole number{range}", "10", check_whole},
    {KeyType::number, "a number{unit}{range}", "{number}", check_number},
    {KeyType::vector, "two numbers [x, y]{unit}", "[1.0, 0.0]", check_numbers<2>},
    {KeyType::number_or_auto, "\"auto\", or a number{unit}{range}", "\"auto\"", check_number_or_auto},
    {KeyType::box, "four numbers [x_min, y_min, x_max, y_max]{unit}", "[0.0, 0.0, 1.0, 1.0]", check_numbers<4>},
    {KeyType::discs, "a list of disc numbers, such as [0, 1, 2]", "[0, 1, 2]", check_discs},
    {KeyType::circles, "a list of circles [x, y, radius]{unit}, radius > 0", "[[0.0, 0.0, 0.01], [0.015, 0.0, 0.01]]",
     check_circles},
    {KeyType::sizes, "a list of ascending whole numbers{range}", "[100, 400, 1600]", check_sizes},
    {KeyType::numbers, "a list of numbers{unit}{range}", "[0.0, 0.5, 1.0]", check_list_of_numbers},
    {KeyType::words, "a list of words out of {words}", "[\"{first}\"]", check_words},
    {KeyType::held, "a number{unit}, or true for 0", "0.001", check_held},
    {KeyType::bytes, "a number of bytes, or text such as \"4 GB\"", "\"4 GB\"", check_bytes},
};

const ValueKind& kind_of(KeyType type) {
  return *std::ranges::find(kinds, type, &ValueKind::type);
}

}  // namespace

std::string expected(const KeySpec& key) {
  return filled(kind_of(key.type).expected, key);
}

void check_value(const TomlValue& value, const KeySpec& key) {
  kind_of(key.type).check(value, key);
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

}  // namespace equidem::casefile
