// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/loose_discs.hpp"

#include <utility>

#include "equidem/breakage/rest_of_network.hpp"

namespace equidem {

std::vector<std::int32_t> loose_discs(const BreakableNetwork& network, std::span<const UnbondedLaw> laws,
                                      std::span<const ContactStatus> status, std::span<const std::uint8_t> carried) {
  std::vector<std::uint8_t> without(status.size(), 0);
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < status.size(); ++c) {
    const bool bonded = status[c] == ContactStatus::bonded;
    without[c] = bonded || (status[c] != ContactStatus::open && carried[c] != 0) ? 0 : 1;
    springs.push_back({laws[c].k.kN, bonded || laws[c].rough() ? laws[c].k.kT : 0});
  }
  const ContactSprings as_they_are(std::move(springs));
  const BreakableNetwork carrying{network.assembly, as_they_are,   network.effects,
                                  network.supports, network.cases, network.solver};
  const RestOfNetwork rest = load_bearing_rest(carrying, without, held_or_loaded(network));
  const std::vector<std::uint8_t> outside = discs_outside(rest, network.assembly.size());
  std::vector<std::int32_t> discs;
  for (std::size_t d = 0; d < outside.size(); ++d)
    if (outside[d] != 0) discs.push_back(static_cast<std::int32_t>(d));
  return discs;
}

std::vector<std::int32_t> untouched_discs(const Assembly& assembly, const DegreesOfFreedom& unknowns,
                                          std::span<const ContactStatus> status) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<std::uint8_t> touched(assembly.size(), 0);
  for (std::size_t d = 0; d < touched.size(); ++d) {
    for (std::size_t k = d * b; k < (d + 1) * b; ++k)
      if (unknowns.held[k] == DegreesOfFreedom::supported) touched[d] = 1;
  }
  for (std::size_t c = 0; c < status.size(); ++c) {
    if (status[c] == ContactStatus::open) continue;
    const Contact& contact = assembly.contacts[c];
    touched[static_cast<std::size_t>(contact.i)] = touched[static_cast<std::size_t>(contact.j)] = 1;
  }
  std::vector<std::int32_t> discs;
  for (std::size_t d = 0; d < touched.size(); ++d)
    if (touched[d] == 0) discs.push_back(static_cast<std::int32_t>(d));
  return discs;
}

}  // namespace equidem
