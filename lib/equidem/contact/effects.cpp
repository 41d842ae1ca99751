// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/effects.hpp"

#include "equidem/contact/frame.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

Effects::Entry rotation_entry(bool tangential_springs, bool off_lines, bool bends, Rotation rotation) {
  if (!tangential_springs && !off_lines)
    return {"rotation", false,
            bends ? "kT = 0 everywhere: bending springs alone, which resist rotations, are left out; give a small kT"
                  : "kT = 0 everywhere: nothing can turn a disc"};
  if (rotation == Rotation::restrained) {
    return {"rotation", false, "restrained as asked: moments hold the discs, and the stress need not be symmetric"};
  }
  if (off_lines) return {"rotation", true, "contacts off the lines of centres turn the bodies"};
  return {"rotation", true, "tangential springs turn the discs"};
}

}  // namespace

std::string Effects::report() const {
  std::vector<std::string> active, inactive;
  for (const Entry& entry : entries) {
    if (entry.active) active.push_back(entry.name);
    if (!entry.active) inactive.push_back(fmt::format("{} ({})", entry.name, entry.why));
  }
  const std::string text = "active: " + joined(active) + ".";
  return inactive.empty() ? text : text + " inactive: " + joined(inactive) + ".";
}

Effects derive_effects(const ContactSprings& springs, Rotation rotation, bool off_lines) {
  Effects effects;
  effects.tangential_springs = springs.any_tangential();
  const Effects::Entry turning = rotation_entry(effects.tangential_springs, off_lines, springs.bends(), rotation);
  effects.rotation = turning.active;
  effects.restrained = !turning.active && (effects.tangential_springs || off_lines);

  effects.entries.push_back({"normal springs", true, "every contact has one"});
  effects.entries.push_back({"tangential springs", effects.tangential_springs,
                             effects.tangential_springs ? "kT is not 0 at some contact" : "kT = 0 everywhere"});
  effects.entries.push_back(turning);
  effects.bending = springs.bends() && effects.rotation;
  if (springs.bends()) {
    effects.entries.push_back({"bending springs", effects.bending,
                               effects.bending ? "kM is not 0: contacts carry moments"
                                               : "rotations are no unknowns: contacts bend by relative rotation"});
  }
  return effects;
}

bool resists_rotation_without_tangential(const Assembly& assembly, const ContactSprings& springs) {
  if (!on_lines_of_centres(assembly)) return true;
  if (!springs.prestressed() || springs.any_tangential()) return false;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const ContactFrame frame = frame_of(assembly, c);
    if (turns_i(*springs.prestress(c), frame) || turns_j(*springs.prestress(c), frame)) return true;
  }
  return false;
}

Effects derive_effects(const Assembly& assembly, const ContactSprings& springs, Rotation rotation) {
  springs.check_count(assembly.contacts.size());
  Effects effects = derive_effects(springs, rotation, resists_rotation_without_tangential(assembly, springs));
  effects.prestress = springs.prestressed();
  if (carries_forces(assembly)) {
    effects.entries.push_back({"prestress", effects.prestress,
                               effects.prestress ? "contacts carry forces at rest, which turn with them"
                                                 : "the stiffness leaves the forces at rest out"});
  }
  return effects;
}

}  // namespace equidem
