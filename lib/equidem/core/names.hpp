// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Names of the values of an enum, written once, beside the enum:
///
///   enum class Plane { strain, stress };
///   template <>
///   struct EnumNames<Plane> {
///     static constexpr const char* what = "plane";
///     static constexpr NamedValue<Plane> list[] = {{Plane::strain, "strain"}, {Plane::stress, "stress"}};
///   };
///
/// Conversions, error messages and the choices of the case file follow from the list. Its entries may be of any type
/// with members `value` and `name`, so that a list can also hold what else distinguishes the values. An unknown name is
/// refused with the nearest known one.
#pragma once

#include <cassert>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace equidem {

/// Specialized for every enum whose values have names: `what` is the noun of a value, `list` its entries.
template <class Enum>
struct EnumNames;

template <class Enum>
struct NamedValue {
  Enum value;
  const char* name;
};

template <class Enum>
concept NamedEnum = requires {
  EnumNames<Enum>::what;
  EnumNames<Enum>::list;
};

/// "uniform", "contact_density" or "voronoi".
std::string alternatives(std::span<const std::string> names);

/// \throws Error (bad_input) always: `name` is none of `known`; suggests the nearest
[[noreturn]] void refuse_name(std::string_view name, const char* what, std::span<const std::string> known);

/// The names of all entries, in their order.
template <class List>
std::vector<std::string> names_in(const List& list) {
  std::vector<std::string> names;
  for (const auto& entry : list) names.emplace_back(entry.name);
  return names;
}

/// The entry with this name.
/// \throws Error (bad_input) naming the choices
template <class List>
const auto& entry_named(const List& list, std::string_view name, const char* what) {
  for (const auto& entry : list)
    if (name == entry.name) return entry;
  refuse_name(name, what, names_in(list));
}

/// "NAME: HELP; NAME: HELP", of entries with a member `help`.
template <class List>
std::string help_of(const List& list) {
  std::string text;
  for (const auto& entry : list) text += (text.empty() ? "" : "; ") + std::string(entry.name) + ": " + entry.help;
  return text;
}

/// The entry of a value, which must be in the list.
template <NamedEnum Enum>
constexpr const auto& entry_of(Enum value) {
  const auto* found = &EnumNames<Enum>::list[0];
  for (const auto& entry : EnumNames<Enum>::list)
    if (entry.value == value) found = &entry;
  assert(found->value == value);
  return *found;
}

template <NamedEnum Enum>
std::string to_string(Enum value) {
  return entry_of(value).name;
}

/// \throws Error (bad_input) naming the choices
template <NamedEnum Enum>
Enum enum_from(std::string_view name) {
  return entry_named(EnumNames<Enum>::list, name, EnumNames<Enum>::what).value;
}

/// The names of all values, in the order of the list: the choices of a key.
template <NamedEnum Enum>
std::vector<std::string> names_of() {
  return names_in(EnumNames<Enum>::list);
}

/// Number of letters to insert, delete, replace or swap with their neighbour to turn one word into the other (optimal
/// string alignment), upper and lower case taken as equal.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `name`; none where even that is further than a third of its letters (at least one, two
/// from four letters on). The first of equally near ones.
std::optional<std::string> nearest(std::string_view name, std::span<const std::string> candidates);

}  // namespace equidem
