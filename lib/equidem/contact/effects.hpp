// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The effects that can change the result: determined once, from the scene alone, before any loop.
#pragma once

#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

enum class Rotation {
  from_scene,  ///< free where a tangential spring can turn a disc
  free,
  restrained,
};

template <>
struct EnumNames<Rotation> {
  static constexpr const char* what = "setting of rotation";
  static constexpr NamedValue<Rotation> list[] = {
      {Rotation::from_scene, "from_scene"}, {Rotation::free, "free"}, {Rotation::restrained, "restrained"}};
};

/// The effects of a scene, each active or inactive with the reason.
struct Effects {
  struct Entry {
    std::string name;
    bool active = false;
    std::string why;
  };
  std::vector<Entry> entries;
  bool tangential_springs = false;
  bool rotation = false;    ///< rotations are unknowns
  bool prestress = false;   ///< forces at rest count
  bool bending = false;     ///< contacts resist the relative rotation of their bodies
  bool restrained = false;  ///< rotations are fixed although contacts would resist them

  [[nodiscard]] int unknowns_per_disc() const { return rotation ? 3 : 2; }
  /// "active: normal springs, tangential springs. inactive: rotation (kT = 0 everywhere: nothing can turn a disc)."
  [[nodiscard]] std::string report() const;
};

/// Normal springs always; tangential springs where some kT != 0; rotation where moreover it is not restrained. Free
/// rotation with kT = 0 would leave rotations without stiffness: they are not unknowns, unless contacts lie off the
/// lines of centres, where normal springs resist them, or forces at rest turn bodies that are no discs. The entries
/// name prestress where the assembly carries forces at rest, and bending springs where there are some: without
/// rotations as unknowns they do nothing.
Effects derive_effects(const Assembly& assembly, const ContactSprings& springs, Rotation rotation);
/// Whether normal springs, or forces at rest, resist rotations where no contact has a tangential spring.
bool resists_rotation_without_tangential(const Assembly& assembly, const ContactSprings& springs);
/// \param off_lines what resists_rotation_without_tangential returns
Effects derive_effects(const ContactSprings& springs, Rotation rotation, bool off_lines = false);

}  // namespace equidem
