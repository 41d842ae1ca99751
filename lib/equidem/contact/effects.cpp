// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/effects.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

Effects::Entry rotation_entry(bool tangential_springs, bool off_lines, Rotation rotation) {
  if (!tangential_springs && !off_lines) return {"rotation", false, "kT = 0 everywhere: nothing can turn a disc"};
  if (rotation == Rotation::restrained) {
    return {"rotation", false, "restrained as asked: moments hold the discs, and the stress need not be symmetric"};
  }
  if (off_lines) return {"rotation", true, "contacts off the lines of centres turn the bodies"};
  return {"rotation", true, "tangential springs turn the discs"};
}

Effects derive(const ContactSprings& springs, bool off_lines, Rotation rotation) {
  Effects effects;
  effects.tangential_springs = springs.any_tangential();
  const Effects::Entry turning = rotation_entry(effects.tangential_springs, off_lines, rotation);
  effects.rotation = turning.active;
  effects.restrained = !turning.active && (effects.tangential_springs || off_lines);

  effects.entries.push_back({"normal springs", true, "every contact has one"});
  if (effects.tangential_springs) {
    effects.entries.push_back({"tangential springs", true, "kT is not 0 at some contact"});
  } else {
    effects.entries.push_back({"tangential springs", false, "kT = 0 everywhere"});
  }
  effects.entries.push_back(turning);
  return effects;
}

}  // namespace

std::string Effects::report() const {
  std::string active;
  std::string inactive;
  for (const Entry& entry : entries) {
    std::string& list = entry.active ? active : inactive;
    if (!list.empty()) list += ", ";
    list += entry.active ? entry.name : fmt::format("{} ({})", entry.name, entry.why);
  }
  std::string text = "active: " + active + ".";
  if (!inactive.empty()) text += " inactive: " + inactive + ".";
  return text;
}

Effects derive_effects(const Assembly& assembly, const ContactSprings& springs, Rotation rotation) {
  return derive(springs, !on_lines_of_centres(assembly), rotation);
}

Effects derive_effects(const ContactSprings& springs, Rotation rotation) {
  return derive(springs, false, rotation);
}

}  // namespace equidem
