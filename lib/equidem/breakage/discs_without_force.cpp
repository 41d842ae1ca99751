// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/discs_without_force.hpp"

#include <utility>

#include "equidem/statics/load_bearing.hpp"

namespace equidem {

std::vector<std::uint8_t> discs_without_force(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken,
                                              const std::vector<std::uint8_t>& held) {
  const Assembly& whole = network.assembly;
  Assembly rest;
  rest.centres = whole.centres;
  rest.radii = whole.radii;
  rest.period = whole.period;
  rest.sections = whole.sections;
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < whole.contacts.size(); ++c) {
    if (broken[c] != 0) continue;
    rest.contacts.push_back(whole.contacts[c]);
    if (!whole.contact_arms.empty()) rest.contact_arms.push_back(whole.contact_arms[c]);
    springs.push_back(network.springs[c]);
  }
  const LoadBearingNetwork found =
      load_bearing_network(rest, ContactSprings(std::move(springs)), network.effects, held);
  std::vector<std::uint8_t> without(whole.size(), 0);
  if (!found.part) return without;
  without.assign(whole.size(), 1);
  for (const std::int32_t disc : found.part->discs) without[static_cast<std::size_t>(disc)] = 0;
  return without;
}

}  // namespace equidem
