// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/unbonded_scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/breakage/solved_states.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

bool is_bond(const ContactStrengths& strengths, std::size_t contact) {
  return strengths.tension[contact] > 0 || strengths.shear[contact] > 0;
}

/// Forces at rest that the law of contacts without a bond cannot carry.
void check_rest(const BreakageScene& scene, double friction, std::span<const ContactForce> rest) {
  constexpr double settled = 1e-6;  // of the largest: what bodies that came to rest leave beyond the law
  double largest = 0;
  for (const ContactForce& f : rest) largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
  for (std::size_t c = 0; c < rest.size(); ++c) {
    if (is_bond(scene.strengths, c)) continue;
    const ContactForce& f = rest[c];
    const double limit = friction * std::max(-f.normal, 0.0);
    if (std::abs(f.tangential) <= limit + settled * largest) continue;
    bad_input(
        fmt::format("contact {} has the forces at rest N = {:g}, T = {:g} N/m and no bond", c, f.normal, f.tangential),
        fmt::format("with the friction {:g} it carries |T| up to {:g} N/m", friction, limit),
        "Give the friction with which the bodies came to rest (strength.residual_friction), or a bond");
  }
}

}  // namespace

std::vector<UnbondedLaw> laws_of(const BreakageScene& scene, double friction, std::span<const ContactForce> rest) {
  std::vector<UnbondedLaw> laws(scene.assembly.contacts.size());
  for (std::size_t c = 0; c < laws.size(); ++c) {
    laws[c] = {scene.springs[c], friction, rest.empty() ? ContactForce{} : rest[c]};
  }
  return laws;
}

std::vector<ContactStatus> first_status(const BreakageScene& scene, std::span<const UnbondedLaw> laws) {
  std::vector<ContactStatus> status(laws.size());
  for (std::size_t c = 0; c < laws.size(); ++c) {
    status[c] = is_bond(scene.strengths, c) ? ContactStatus::bonded
                : laws[c].rest.normal > 0   ? ContactStatus::open
                                            : ContactStatus::stuck;
  }
  return status;
}

void check_control_of_rubbing(const LoadPath& path) {
  if (path.control == LoadControl::path) {
    bad_input("lambda may fall from event to event, and contacts close and slip",
              "their state depends on the path by which lambda falls, which this control leaves open",
              "Take control = \"load\" or \"motion\"");
  }
  if (path.control == LoadControl::load && path.driven_by != DrivenBy::loads) {
    bad_input("the load is held, and a motion is imposed", "the motion would have to follow the load, not lambda",
              "Take control = \"motion\", or drive by loads");
  }
}

void check_rubbing(const BreakageScene& scene, double friction, std::span<const ContactForce> rest) {
  if (!(friction >= 0) || !std::isfinite(friction))
    bad_input(fmt::format("the friction of contacts without a bond is {}", friction),
              "it must be finite and not negative", "Correct it");
  check_control_of_rubbing(scene.path);
  check_rest(scene, friction, rest);
}

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
