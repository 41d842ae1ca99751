// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/rest_of_network.hpp"

#include <numeric>
#include <utility>

#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {

RestOfNetwork unbroken_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken) {
  const Assembly& whole = network.assembly;
  RestOfNetwork rest;
  Assembly& a = rest.assembly;
  a.kind = whole.kind;
  a.centres = whole.centres;
  a.radii = whole.radii;
  a.period = whole.period;
  a.groups = whole.groups;
  a.sections = whole.sections;
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < whole.contacts.size(); ++c) {
    if (broken[c] != 0) continue;
    rest.contacts.push_back(static_cast<std::int32_t>(c));
    a.contacts.push_back(whole.contacts[c]);
    if (!whole.contact_arms.empty()) a.contact_arms.push_back(whole.contact_arms[c]);
    if (!network.springs.uniform()) springs.push_back(network.springs[c]);
  }
  rest.springs = springs.empty() ? network.springs : ContactSprings(std::move(springs));
  rest.discs.resize(whole.size());
  std::iota(rest.discs.begin(), rest.discs.end(), 0);
  return rest;
}

RestOfNetwork load_bearing_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken,
                                const std::vector<std::uint8_t>& held) {
  RestOfNetwork rest = unbroken_rest(network, broken);
  LoadBearingNetwork found = load_bearing_network(rest.assembly, rest.springs, network.effects, held);
  if (!found.part) return rest;
  for (std::int32_t& contact : found.part->contacts) contact = rest.contacts[static_cast<std::size_t>(contact)];
  return {std::move(found.part->assembly), std::move(found.part->springs), std::move(found.part->discs),
          std::move(found.part->contacts)};
}

std::vector<std::uint8_t> discs_outside(const RestOfNetwork& rest, std::size_t discs) {
  std::vector<std::uint8_t> outside(discs, 1);
  for (const std::int32_t disc : rest.discs) outside[static_cast<std::size_t>(disc)] = 0;
  return outside;
}

std::string describe_driven(const BreakableNetwork& network, const RestOfNetwork& rest,
                            std::vector<DiscMotion> motions) {
  std::vector<std::uint8_t> without_force(network.assembly.contacts.size(), 1);
  for (const std::int32_t contact : rest.contacts) without_force[static_cast<std::size_t>(contact)] = 0;
  const std::vector<std::uint8_t> outside = discs_outside(rest, motions.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    if (outside[d] != 0) motions[d] = {};
  }
  return "a load drives " + describe_motion(unbroken_rest(network, without_force).assembly, motions);
}

}  // namespace equidem
