// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/files/file_keys.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Bodies, shift and offsets: bodies that touch in several places do so with offsets of their own, since all their
/// contacts lead along the same branch.
using Name = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t, double, double>;

Name name_of(const Assembly& assembly, std::size_t contact) {
  const Contact& c = assembly.contacts[contact];
  const ContactArms arms = assembly.contact_arms.empty() ? ContactArms{} : assembly.contact_arms[contact];
  return std::tuple(c.i, 0, 0) <= std::tuple(c.j, c.shift_x, c.shift_y)
             ? Name{c.i, c.j, c.shift_x, c.shift_y, arms.offset_i, arms.offset_j}
             : Name{c.j, c.i, -c.shift_x, -c.shift_y, arms.offset_j, arms.offset_i};
}

/// Contacts from the lower disc to the higher that ascend, as this library writes them, need no sorting.
bool ascend(const Assembly& assembly) {
  const std::vector<Contact>& all = assembly.contacts;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Contact& c = all[k];
    if (c.i >= c.j) return false;
    if (k == 0) continue;
    const Contact& before = all[k - 1];
    if (std::tie(before.i, before.j, before.shift_x, before.shift_y) >= std::tie(c.i, c.j, c.shift_x, c.shift_y))
      return false;
  }
  return true;
}

std::optional<std::pair<std::size_t, std::size_t>> find_repeated_contact(const Assembly& assembly) {
  if (ascend(assembly)) return {};
  std::vector<std::pair<Name, std::size_t>> named;
  named.reserve(assembly.contacts.size());
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) named.emplace_back(name_of(assembly, k), k);
  std::sort(named.begin(), named.end());
  const auto twice =
      std::adjacent_find(named.begin(), named.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice == named.end()) return {};
  return std::pair(twice->second, (twice + 1)->second);
}

}  // namespace

void check_schema(const std::string& given, const std::string& example) {
  if (given == assembly_schema) return;
  bad_input_at("schema",
               given.empty() ? std::string("the key 'schema' is missing") : fmt::format("the schema is \"{}\"", given),
               fmt::format("an assembly file has {}", example),
               given.starts_with("equidem-assembly/") ? "Read it with the version of equidem that wrote it"
                                                      : "Add or correct it, if this is an assembly file");
}

void check_key(const std::string& key, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), key) != known.end()) return;
  const auto meant = nearest(key, known);
  bad_input_at(key, fmt::format("there is no key '{}'", key), "an assembly file is read strictly",
               meant ? fmt::format("Did you mean '{}'?", *meant) : "Remove it");
}

void check_keys_together(const std::function<bool(const char*)>& has, double gap_tolerance) {
  if (!has("contacts")) {
    const auto refuse = [&](const char* key) {
      if (!has(key)) return;
      bad_input_at(key, fmt::format("there are {} but no contacts", key), "they are given in the order of the contacts",
                   "Add \"contacts\"");
    };
    for (const char* key : {"levers", "normals", "offsets", "facet_lengths"}) refuse(key);
    for (const ContactNumbers& numbers : contact_numbers) refuse(numbers.key);
    if (has("sections")) {
      bad_input_at("sections", "there are sections but no contacts", "only of discs it is known where they touch",
                   "Add \"contacts\"");
    }
  } else if (gap_tolerance > 0) {
    bad_input_at("contacts", "the file gives contacts, and the case a gap_tolerance", "it is for files that give none",
                 "Remove gap_tolerance, or the contacts");
  }
  if (!has("normals") && !has("offsets")) return;
  for (const char* key : {"levers", "normals", "offsets"}) {
    if (has(key)) continue;
    bad_input_at(key, fmt::format("the key '{}' is missing", key),
                 "off the line of centres a contact has a normal, levers along it and offsets across it",
                 fmt::format("Add \"{}\"", key));
  }
}

void refuse_repeated_contacts(const Assembly& assembly) {
  const auto twice = find_repeated_contact(assembly);
  if (!twice) return;
  const auto& [first, second] = *twice;
  const Contact& c = assembly.contacts[first];
  bad_input_at(fmt::format("contacts[{}]", second),
               fmt::format("contacts {} and {} are the same, of discs {} and {}", first, second, std::min(c.i, c.j),
                           std::max(c.i, c.j)),
               "its springs would count twice", "Remove one of them");
}

}  // namespace equidem
