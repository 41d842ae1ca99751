// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

/// Where the contact point of two discs lies on the line of their centres, at the distance d.
enum class ContactPoints { radii, middle, halfway };

template <>
struct EnumNames<ContactPoints> {
  using enum ContactPoints;
  struct Entry {
    ContactPoints value;
    const char *name, *help;
  };
  static constexpr const char* what = "place of contact points";
  static constexpr Entry list[] = {
      {radii, "radii", "the distance in the ratio of the radii, d r_i/(r_i + r_j) from i"},
      {middle, "middle", "the middle of the gap or overlap, (d + r_i - r_j)/2 from i, as in YADE"},
      {halfway, "halfway", "half-way between the centres, d/2, as in LAMMPS"}};
};

/// Sets the levers of all contacts.
/// \throws Error (bad_input) where a contact is off the line of centres, or would lie outside of it
void place_contact_points(Assembly& assembly, ContactPoints points);

}  // namespace equidem
