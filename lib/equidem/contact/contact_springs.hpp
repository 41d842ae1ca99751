// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The springs of every contact of an assembly.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/names.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

/// Weighting of the given springs at each contact.
enum class SpringWeighting {
  uniform,          ///< the same at every contact
  contact_density,  ///< k / psi(theta), psi the measured contacts per radian around a disc (Abe 1996, eqs. 11
                    ///< and 21)
  voronoi,          ///< k h/l, shared cell edge over centre distance (Bolander & Saito 1998)
};

template <>
struct EnumNames<SpringWeighting> {
  static constexpr const char* what = "weighting of springs";
  static constexpr NamedValue<SpringWeighting> list[] = {{SpringWeighting::uniform, "uniform"},
                                                         {SpringWeighting::contact_density, "contact_density"},
                                                         {SpringWeighting::voronoi, "voronoi"}};
};

/// One pair of springs for all contacts, or one for each; the first stores two numbers.
class ContactSprings {
 public:
  explicit ContactSprings(SpringConstants uniform) : uniform_(uniform) {}
  explicit ContactSprings(std::vector<SpringConstants> per_contact) : per_contact_(std::move(per_contact)) {}

  SpringConstants operator[](std::size_t contact) const {
    return per_contact_.empty() ? uniform_ : per_contact_[contact];
  }
  [[nodiscard]] bool uniform() const { return per_contact_.empty(); }
  /// Whether some contact has a tangential spring.
  [[nodiscard]] bool any_tangential() const;
  /// Whether some contact has a negative tangential spring (static-only).
  [[nodiscard]] bool any_negative() const;
  /// Largest |kN| and |kT| of any contact, Pa.
  [[nodiscard]] double largest() const;

 private:
  SpringConstants uniform_;
  std::vector<SpringConstants> per_contact_;
};

/// The springs of every contact: the assembly's own where it gives some, else `springs` weighted as asked.
/// \throws Error (bad_input) where kN is not positive or a spring is not finite, where `voronoi` is asked of an
///         assembly without facet lengths, where a shared edge has no length, or psi is not positive at a contact
ContactSprings contact_springs(const Assembly& assembly, SpringConstants springs, SpringWeighting weighting);

/// Distribution of contact directions: psi(theta) = (z/2pi) (1 + sum a_k cos k theta + b_k sin k theta), k = 2, 4, the
/// harmonics that affect stiffness, a fourth-order tensor. Measured: a_k = 2 <cos k theta> over the contacts.
struct ContactHarmonics {
  double a2 = 0, b2 = 0, a4 = 0, b4 = 0;
};
ContactHarmonics contact_harmonics(const Assembly& assembly);

/// Contacts per radian around one disc at each contact's direction, psi(theta) of its harmonics (Abe 1996, eq. 11).
std::vector<double> contact_density(const Assembly& assembly);

}  // namespace equidem
