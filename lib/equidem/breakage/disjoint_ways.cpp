// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/disjoint_ways.hpp"

#include <algorithm>

namespace equidem {

bool DisjointWays::around(std::size_t contact) {
  const Contact& c = assembly_.contacts[contact];
  if (!carries(c.i) || !carries(c.j)) return false;
  const bool found = finds_way(c) && finds_way(c);
  for (const Step& step : steps_) reached_[2 * step.disc] = reached_[2 * step.disc + 1] = none;
  for (const Step& step : way_) place_[step.disc] = none;
  steps_.clear();
  way_.clear();
  return found;
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

// Two ways that share no disc are a flow of two units through discs that one unit passes (Ford & Fulkerson 1956): the
// second way may meet the first one and take its contacts back, towards i, until it leaves it.
bool DisjointWays::finds_way(const Contact& gone) {
  const bool second = !way_.empty();
  for (const Step& step : steps_) reached_[2 * step.disc] = reached_[2 * step.disc + 1] = none;
  steps_.clear();
  const auto reach = [&](const Step& step) {
    std::int32_t& at = reached_[2 * step.disc + (step.backwards ? 1 : 0)];
    if (at != none) return;
    at = static_cast<std::int32_t>(steps_.size());
    steps_.push_back(step);
  };
  reach({gone.i, none, none, 0, 0, false});
  for (std::size_t next = 0; next < steps_.size(); ++next) {
    const Step here = steps_[next];
    const auto from = static_cast<std::int32_t>(next);
    const std::int32_t place = place_[here.disc];  // on the first way
    if (place > 0) {
      // Where a cell is periodic, ways that exchange their ends may lead to other images.
      if (!assembly_.periodic()) {
        const std::int32_t before = way_[place].before;
        if (before > 0) reach({way_[before].disc, from, way_[place].contact, 0, 0, true});
      }
      if (!here.backwards) continue;
    }
    for (const auto& edge : graph_.of(here.disc)) {
      if (!carries_on(edge) || edge.other == gone.i) continue;
      const bool used =
          second && ((place >= 0 && place + 1 < std::ssize(way_) && way_[place + 1].contact == edge.contact) ||
                     (place > 0 && way_[place].contact == edge.contact));
      if (used) continue;
      const Contact& contact = assembly_.contacts[edge.contact];
      const std::int32_t sign = contact.i == here.disc ? 1 : -1;
      const Step step{
          edge.other, from, edge.contact, here.shift_x + sign * contact.shift_x, here.shift_y + sign * contact.shift_y,
          false};
      if (edge.other != gone.j) {
        reach(step);
        continue;
      }
      if (step.shift_x != gone.shift_x || step.shift_y != gone.shift_y) continue;
      if (!second) keep(step);
      return true;
    }
  }
  return false;
}

void DisjointWays::keep(const Step& last) {
  way_ = {last};
  for (std::int32_t k = last.before; k >= 0; k = steps_[k].before) way_.push_back(steps_[k]);
  std::reverse(way_.begin(), way_.end());
  for (std::size_t k = 0; k < way_.size(); ++k) {
    way_[k].before = static_cast<std::int32_t>(k) - 1;
    place_[way_[k].disc] = static_cast<std::int32_t>(k);
  }
}

}  // namespace equidem
