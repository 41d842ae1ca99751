// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/disjoint_ways.hpp"

#include <algorithm>

namespace equidem {

bool DisjointWays::around(std::size_t contact) {
  const Contact& c = assembly_.contacts[contact];
  if (!carries(c.i) || !carries(c.j)) return false;
  way_.clear();
  return finds_way(c) && finds_way(c);
}

bool DisjointWays::carries(std::int32_t disc) const {
  std::int64_t others = 0;
  bool resist_slip = assembly_.contact_arms.empty();
  for (const auto& edge : graph_.of(disc)) {
    if (!carries_on(edge)) continue;
    ++others;
    resist_slip = resist_slip && edge.other != disc && springs_[static_cast<std::size_t>(edge.contact)].kT > 0;
  }
  return others > 2 || (others == 2 && resist_slip);
}

bool DisjointWays::finds_way(const Contact& gone) {
  constexpr std::size_t most_discs = 300;
  struct Step {
    std::int32_t disc, before, contact, shift_x, shift_y;
  };
  const std::int32_t to = gone.j;
  std::vector<Step> reached = {{gone.i, -1, -1, 0, 0}};
  const auto taken = [&](std::int32_t disc) {
    return std::any_of(reached.begin(), reached.end(), [&](const Step& step) { return step.disc == disc; }) ||
           std::any_of(way_.begin(), way_.end(), [&](const auto& on) { return on.first == disc && disc != to; });
  };
  for (std::size_t next = 0; next < reached.size() && reached.size() < most_discs; ++next) {
    for (const auto& edge : graph_.of(reached[next].disc)) {
      const bool used =
          std::any_of(way_.begin(), way_.end(), [&](const auto& on) { return on.second == edge.contact; });
      if (!carries_on(edge) || used || taken(edge.other)) continue;
      const Contact& contact = assembly_.contacts[edge.contact];
      const std::int32_t sign = contact.i == reached[next].disc ? 1 : -1;
      const std::int32_t x = reached[next].shift_x + sign * contact.shift_x;
      const std::int32_t y = reached[next].shift_y + sign * contact.shift_y;
      if (edge.other == to && (x != gone.shift_x || y != gone.shift_y)) continue;
      reached.push_back({edge.other, static_cast<std::int32_t>(next), edge.contact, x, y});
      if (edge.other != to) continue;
      for (std::int32_t k = static_cast<std::int32_t>(reached.size()) - 1; reached[k].before >= 0;
           k = reached[k].before)
        way_.emplace_back(reached[k].disc, reached[k].contact);
      return true;
    }
  }
  return false;
}

}  // namespace equidem
