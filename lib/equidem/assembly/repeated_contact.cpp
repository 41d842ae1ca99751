// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/repeated_contact.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

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

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> find_repeated_contact(const Assembly& assembly) {
  std::vector<std::pair<Name, std::size_t>> named;
  named.reserve(assembly.contacts.size());
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) named.emplace_back(name_of(assembly, k), k);
  std::sort(named.begin(), named.end());
  const auto twice =
      std::adjacent_find(named.begin(), named.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice == named.end()) return {};
  return std::pair(twice->second, (twice + 1)->second);
}

}  // namespace equidem
