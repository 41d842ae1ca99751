// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The forces that the contacts of an assembly carry at rest, before any motion (Assembly::contact_normal_force).
///
/// Whether the forces that contacts carry at rest count in the stiffness: decided once, before any loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

/// True where some contact carries a force at rest.
bool carries_forces(const Assembly& assembly);

/// The force at rest of a contact; 0 where the assembly has none.
inline ContactForce force_at_rest(const Assembly& assembly, std::size_t contact) {
  if (assembly.contact_normal_force.empty()) return {};
  return {assembly.contact_normal_force[contact], assembly.contact_tangential_force[contact]};
}

/// The forces at rest that act on every body together, N/m, and their moments about its centre, N.
struct RestSums {
  std::vector<Vec2> forces;
  std::vector<double> moments;
  std::int64_t loaded = 0;  ///< contacts that carry a force, beyond round-off of the largest
  double mean_force = 0;    ///< N/m, magnitude, over those contacts
};
RestSums sums_at_rest(const Assembly& assembly);

/// The sums of the forces at rest on every body, which vanish where these forces balance each other. Weight and other
/// loads are not counted: the part that they balance is told here as lacking.
struct RestBalance {
  std::int64_t loaded = 0;         ///< likewise
  double mean_force = 0;           ///< N/m, magnitude, over those contacts
  double largest_force = 0;        ///< N/m, the largest sum of forces on one body
  double largest_moment = 0;       ///< N, the largest sum of moments on one body, about its centre
  std::int32_t disc_of_force = 0;  ///< the first body with that force
  std::int32_t disc_of_moment = 0;
  double relative = 0;  ///< the larger of force and moment over the mean radius, over the mean force; 0 without forces
};

/// \param held discs that are not counted, since supports balance them; ascending
RestBalance balance_at_rest(const Assembly& assembly, const std::vector<std::int32_t>& held = {});

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
