// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Whether the forces that contacts carry at rest count in the stiffness: decided once, before any loop.
#pragma once

#include <optional>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

enum class PrestressChoice { automatic, on, off };

template <>
struct EnumNames<PrestressChoice> {
  using enum PrestressChoice;
  static constexpr const char* what = "setting of prestress";
  static constexpr NamedValue<PrestressChoice> list[] = {{automatic, "auto"}, {on, "on"}, {off, "off"}};
};

/// The largest |N0|/(kN l) of the contacts with a normal spring, l the distance of the centres.
double largest_prestress(const Assembly& assembly, const ContactSprings& springs);

/// Prestress counts by "auto" from this largest |N0|/(kN l) on: to leave it out changes
/// moduli of jammed packings with kT = kN/2 by up to 1.05 of that share, as measured (docs/explanation/prestress.md).
/// Without tangential springs it always counts, since such packings may be rigid by it alone.
inline constexpr double noticeable_prestress = 1e-4;
/// Forces at rest of a periodic cell, where nothing else acts, balance on every body to this share of their mean.
inline constexpr double largest_imbalance = 1e-3;

/// Springs with or without the geometric stiffness of the forces at rest, and why.
struct PrestressedSprings {
  ContactSprings springs;
  double largest = 0;  ///< largest_prestress
  RestBalance balance = {};
  std::string sentence;  ///< what was decided, with the reason
};

/// None where the assembly carries no forces at rest.
/// \throws Error (bad_input) where prestress is asked for and contacts carry no forces, forces of a periodic cell do
///         not balance, or bodies that are no discs have no curvatures. "auto" leaves prestress out then, and says so.
std::optional<PrestressedSprings> choose_prestress(const Assembly& assembly, const ContactSprings& springs,
                                                   PrestressChoice choice);

/// The geometric stiffness of every contact.
/// \throws Error (bad_input) as choose_prestress, but for the balance
std::vector<ContactPrestress> prestress_of(const Assembly& assembly);

}  // namespace equidem
