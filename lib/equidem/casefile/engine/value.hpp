// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Conversion of values of a file to the C++ type of a member.
/// Values of a checked document, by key; for the readers of its tables.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"

namespace equidem::casefile {

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;

/// A rectangle, [x_min, y_min, x_max, y_max].
template <class T>
concept BoxLike = requires(T box) {
  Vec2{box.low}, Vec2{box.high};
};
/// A disc, [x, y, radius].
template <class T>
concept CircleLike = requires(T circle) {
  Vec2{circle.offset}, double{circle.radius};
};

template <class T>
constexpr KeyType type_of_key() {
  if constexpr (is_optional<T>) {
    return type_of_key<typename T::value_type>();
  } else if constexpr (is_vector<T>) {
    using Item = typename T::value_type;
    if constexpr (std::same_as<Item, std::int32_t>)
      return KeyType::discs;
    else if constexpr (std::integral<Item>)
      return KeyType::sizes;
    else if constexpr (std::floating_point<Item>)
      return KeyType::numbers;
    else if constexpr (CircleLike<Item>)
      return KeyType::circles;
    else
      return KeyType::words;
  } else if constexpr (std::same_as<T, bool>) {
    return KeyType::flag;
  } else if constexpr (std::integral<T>) {
    return KeyType::whole;
  } else if constexpr (std::floating_point<T>) {
    return KeyType::number;
  } else if constexpr (std::is_enum_v<T>) {
    return KeyType::choice;
  } else if constexpr (std::same_as<T, Vec2>) {
    return KeyType::vector;
  } else if constexpr (BoxLike<T>) {
    return KeyType::box;
  } else if constexpr (std::same_as<T, std::filesystem::path>) {
    return KeyType::path;
  } else {
    static_assert(std::same_as<T, std::string>);
    return KeyType::text;
  }
}

/// Names of the values of an enum; none for other types.
template <class T>
std::vector<std::string> choices_of() {
  if constexpr (is_optional<T>)
    return choices_of<typename T::value_type>();
  else if constexpr (NamedEnum<T>)
    return names_of<T>();
  else
    return {};
}

/// A default as TOML; `none` for a std::optional without a value.
template <class T>
std::string default_text(const T& value) {
  if constexpr (is_optional<T>) {
    return value ? default_text(*value) : KeySpec::none;
  } else if constexpr (is_vector<T>) {
    std::string list;
    for (const auto& item : value) list += (list.empty() ? "" : ", ") + default_text(item);
    return "[" + list + "]";
  } else if constexpr (std::same_as<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::integral<T>) {
    return std::to_string(value);
  } else if constexpr (std::floating_point<T>) {
    return toml_number(value);
  } else if constexpr (std::is_enum_v<T>) {
    return toml_text(to_string(value));
  } else if constexpr (std::same_as<T, Vec2>) {
    return "[" + toml_number(value.x) + ", " + toml_number(value.y) + "]";
  } else if constexpr (std::same_as<T, std::string>) {
    return toml_text(value);
  } else {
    return KeySpec::none;  // files, boxes, circles
  }
}

/// The number of a checked value: `true` is 0 (KeyType::held), text is bytes.
double number_of(const TomlValue& value);
/// The path of a checked value, resolved against the folder of the file; the value is replaced by it.
std::filesystem::path path_of(TomlValue& value, const std::filesystem::path& folder);

/// A checked value as a T. "auto" leaves `result` as it is (a std::optional: without a value), unless it is a name of
/// the enum.
template <class T>
void assign(T& result, TomlValue& value, const std::filesystem::path& folder) {
  if constexpr (is_optional<T>) {
    typename T::value_type read{};
    const bool automatic = value.type == TomlValue::Type::text && value.text == "auto";
    result.reset();
    if constexpr (NamedEnum<typename T::value_type>) {
      if (automatic) return;
    } else if constexpr (std::floating_point<typename T::value_type>) {
      if (automatic) return;
    }
    assign(read, value, folder);
    result = std::move(read);
  } else if constexpr (is_vector<T>) {
    result.clear();
    for (TomlValue& item : value.items) assign(result.emplace_back(), item, folder);
  } else if constexpr (std::same_as<T, bool>) {
    result = value.boolean;
  } else if constexpr (std::integral<T>) {
    result = static_cast<T>(value.integer);
  } else if constexpr (std::floating_point<T>) {
    if (value.type != TomlValue::Type::text || value.text != "auto") result = number_of(value);
  } else if constexpr (std::is_enum_v<T>) {
    result = enum_from<T>(value.text);
  } else if constexpr (std::same_as<T, Vec2>) {
    result = {value.items[0].real, value.items[1].real};
  } else if constexpr (BoxLike<T>) {
    result.low = {value.items[0].real, value.items[1].real};
    result.high = {value.items[2].real, value.items[3].real};
  } else if constexpr (CircleLike<T>) {
    result.offset = {value.items[0].real, value.items[1].real};
    result.radius = value.items[2].real;
  } else if constexpr (std::same_as<T, std::filesystem::path>) {
    result = path_of(value, folder);
  } else {
    result = value.text;
  }
}

/// Throw an Error (bad_input) that names the line of a value, and the key.
[[noreturn]] inline void fail_at(const TomlValue& at, const std::string& key, const std::string& problem,
                                 const std::string& why, const std::string& remedy) {
  bad_input_at(fmt::format("{}: {}", at.where(), key), problem, why, remedy);
}

/// The result of a step; its Error gets a place, unless it has one.
template <class Step>
auto with_place(const std::string& where, const Step& step) {
  try {
    return step();
  } catch (const Error& error) {
    throw error.at(where);
  }
}

/// The result of a step; its Error gets the line of that key of the table.
template <class Step>
auto with_key(const TomlValue& table, const std::string& path, const char* key, const Step& step) {
  return with_place(fmt::format("{}: {}.{}", table.find(key)->where(), path, key), step);
}

/// The result of a step of the library: its Error, whose place may be the name of an option, gets the line of that key
/// of the table, or of the table.
/// \param usual the key of an Error without a place; empty: that of the table
template <class Step>
auto at_key(const TomlValue& table, const std::string& path, const Step& step, const std::string& usual = {}) {
  try {
    return step();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    const std::string& option = error.where().empty() ? usual : error.where();
    const TomlValue* key = option.empty() ? nullptr : table.find(option);
    throw Error(error.kind(), error.problem(), error.why(), error.remedy(),
                key == nullptr ? fmt::format("{}: {}", table.where(), path)
                               : fmt::format("{}: {}.{}", key->where(), path, option));
  }
}

/// The tables of a list such as [[load]]; empty if there are none.
const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name);

/// A path of the file, resolved against its folder.
std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder);

/// \throws Error (bad_input) where two tables of a list have one name, or a name is empty
void check_names(const TomlValue& root, const char* list, const std::string& prefix = {});

/// \param what "a load case"
/// \param use "it becomes part of the names of files"
/// \throws Error (bad_input) where the text holds more than letters, digits, '_' and '-'
void check_plain_name(const TomlValue& value, const std::string& key, const std::string& what, const std::string& use);

/// \throws Error (bad_input) where the corners of a box are not in ascending order
void check_box(const TomlValue& given, const std::string& key, Vec2 low, Vec2 high);

}  // namespace equidem::casefile
