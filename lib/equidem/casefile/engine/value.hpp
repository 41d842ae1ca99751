// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Conversion of values of a file to the C++ type of a member.
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
#include "equidem/core/names.hpp"
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

}  // namespace equidem::casefile
