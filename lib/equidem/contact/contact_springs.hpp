// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The springs of every contact of an assembly, bending springs of bonds too, and all that a contact answers to the
/// motion of its bodies.
/// The springs with which an assembly represents a given continuum.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/contact/prestress/prestress.hpp"
#include "equidem/core/names.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// Weighting of the given springs at each contact.
enum class SpringWeighting {
  uniform,                ///< the same at every contact
  contact_density,        ///< k / psi(theta), psi the measured contacts per radian around a disc (Abe 1996, eqs. 11
                          ///< and 21), a mean over all discs
  local_contact_density,  ///< k / psi, psi that of the two discs of the contact alone
  voronoi,                ///< k h/l, shared cell edge over centre distance (Bolander & Saito 1998)
};

template <>
struct EnumNames<SpringWeighting> {
  static constexpr const char* what = "weighting of springs";
  static constexpr NamedValue<SpringWeighting> list[] = {
      {SpringWeighting::uniform, "uniform"},
      {SpringWeighting::contact_density, "contact_density"},
      {SpringWeighting::local_contact_density, "local_contact_density"},
      {SpringWeighting::voronoi, "voronoi"}};
};

/// One pair of springs for all contacts, or one for each; the first stores two numbers. Where the forces that contacts
/// carry at rest count, each contact has its geometric stiffness beside its springs; where contacts resist the relative
/// rotation of their bodies, a bending spring.
class ContactSprings {
 public:
  explicit ContactSprings(SpringConstants uniform) : uniform_(uniform) {}
  explicit ContactSprings(std::vector<SpringConstants> per_contact) : per_contact_(std::move(per_contact)) {}

  SpringConstants operator[](std::size_t contact) const {
    return per_contact_.empty() ? uniform_ : per_contact_[contact];
  }
  [[nodiscard]] bool uniform() const { return per_contact_.empty(); }
  /// The springs change(k) in place of every k; bending springs stay.
  template <typename Change>
  [[nodiscard]] ContactSprings changed(const Change& change) const {
    ContactSprings result = *this;
    result.uniform_ = change(uniform_);
    for (SpringConstants& k : result.per_contact_) k = change(k);
    return result;
  }
  /// Springs of one contact. \param contacts of the assembly: the others keep what is the same for all of them now
  void set(std::size_t contact, SpringConstants k, std::size_t contacts) {
    if (per_contact_.empty()) per_contact_.assign(contacts, uniform_);
    per_contact_[contact] = k;
  }
  /// A copy of the springs with the geometric stiffness of each contact; empty: without.
  [[nodiscard]] ContactSprings with_prestress(std::vector<ContactPrestress> per_contact) const {
    ContactSprings result = *this;
    result.prestress_ = std::move(per_contact);
    return result;
  }
  [[nodiscard]] bool prestressed() const { return !prestress_.empty(); }
  /// The geometric stiffness of one contact; null where forces at rest do not count.
  [[nodiscard]] const ContactPrestress* prestress(std::size_t contact) const {
    return prestress_.empty() ? nullptr : &prestress_[contact];
  }
  /// The geometric stiffness of all contacts under forces at rest `factor` times as large.
  [[nodiscard]] std::vector<ContactPrestress> scaled_prestress(double factor) const;
  /// A copy of the springs with the bending springs kM >= 0 of the contacts, N m/rad per metre of depth: one for all of
  /// them, or one for each; empty: without.
  [[nodiscard]] ContactSprings with_bending(std::vector<double> kM) const {
    ContactSprings result = *this;
    result.bending_ = std::move(kM);
    return result;
  }
  [[nodiscard]] bool bends() const { return !bending_.empty(); }
  /// kM of one contact, N m/rad per metre of depth; 0: it carries no moment.
  [[nodiscard]] double bending(std::size_t contact) const {
    if (bending_.empty()) return 0;
    return bending_[bending_.size() == 1 ? 0 : contact];
  }
  /// As with_bending takes them.
  [[nodiscard]] const std::vector<double>& bending_springs() const { return bending_; }
  /// \throws Error (bad_input) where springs, bending springs or prestress of each contact are not of so many contacts
  void check_count(std::size_t contacts) const;
  /// True with prestress or with some kT < 0: K may be indefinite.
  [[nodiscard]] bool may_be_indefinite() const { return prestressed() || any_negative(); }
  /// Whether some contact has a tangential spring.
  [[nodiscard]] bool any_tangential() const {
    return any([](const SpringConstants& k) { return k.kT != 0; });
  }
  /// Whether some contact has a negative tangential spring (static-only).
  [[nodiscard]] bool any_negative() const {
    return any([](const SpringConstants& k) { return k.kT < 0; });
  }
  /// Largest |kN| and |kT| of any contact, Pa.
  [[nodiscard]] double largest() const;

 private:
  template <typename Predicate>
  [[nodiscard]] bool any(const Predicate& holds) const {
    return uniform() ? holds(uniform_) : std::any_of(per_contact_.begin(), per_contact_.end(), holds);
  }

  SpringConstants uniform_;
  std::vector<SpringConstants> per_contact_;
  std::vector<ContactPrestress> prestress_;
  std::vector<double> bending_;  ///< N m/rad per metre of depth
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

/// psi of eq. (11) at each contact from the contacts of its two discs alone, contacts per radian: the inverse of the
/// mean over both discs of the angle that the contact has to itself, half of the way to the next contact on either
/// side. The sums (12) to (14) over the contacts of one disc, weighted by those angles, are the trapezoidal rule of the
/// integrals over theta. An angle of half a turn or more between two contacts is that of a side of the assembly: the
/// contact beside it counts its other side twice. A single contact has the full turn.
std::vector<double> local_contact_density(const Assembly& assembly);

/// Every spring replaced by one of 1 Pa, and bending springs by the square of a length, without prestress: the
/// zero-energy modes of the springs stay, but not the energies of the other modes.
/// \param radius mean radius of the discs, m
ContactSprings equal_springs(const ContactSprings& springs, double radius);

/// All springs, bending springs too, and forces at rest, times a factor.
ContactSprings scaled_springs(const ContactSprings& springs, double factor);

/// The power of two at or below the largest spring, Pa, or 1: dividing by it rounds nothing.
double spring_unit(const ContactSprings& springs);

/// The stiffest spring over the softest that there is, by magnitude; bending springs over the square of the mean
/// radius.
double spring_spread(const Assembly& assembly, const ContactSprings& springs);

/// Refuse springs so far apart that the softest leaves too few digits of a double beside the stiffest.
/// \throws Error (bad_input) with their ratio
[[noreturn]] void refuse_spread(double spread);

/// With their prestress, in the order of the numbers of the contacts.
ContactSprings chosen_springs(const ContactSprings& springs, const std::vector<std::int32_t>& contacts);

/// The force of the springs, the moment of the bending spring, and what the force that the contact carries at rest
/// adds. \param theta_i, theta_j rotations of the two bodies, rad
template <typename Number>
ContactResponse<Number> contact_response(const ContactSprings& springs, std::size_t contact,
                                         const DeformationOf<Number>& deformation, Number theta_i, Number theta_j) {
  ContactResponse<Number> response{.force = linear_spring_force(springs[contact], deformation)};
  if (springs.bends()) {
    const Number moment = bending_moment(springs.bending(contact), theta_i, theta_j);
    response.moment_i += moment;
    response.moment_j -= moment;
  }
  if (const ContactPrestress* const prestress = springs.prestress(contact))
    add_prestress(*prestress, deformation, theta_i, theta_j, response);
  return response;
}

inline ContactStiffness contact_stiffness(const ContactSprings& springs, std::size_t contact, const ContactFrame& frame,
                                          double rotation_scale) {
  const SpringConstants k = springs[contact];
  return {.ends = end_gradients(frame, rotation_scale),
          .kN = k.kN,
          .kT = k.kT,
          .kM = springs.bends() ? springs.bending(contact) / (rotation_scale * rotation_scale) : 0,
          .prestress = springs.prestress(contact),
          .rotation_scale = rotation_scale};
}

/// One of the two, or none: contacts carry no moments.
struct BendingOptions {
  std::optional<double> kM = {};          ///< >= 0, N m/rad per metre of depth, of every contact
  std::optional<double> bond_width = {};  ///< >= 0: width w of a bond over the diameter of its smaller disc

  [[nodiscard]] bool given() const { return kM || bond_width; }
};

/// Width of the bond of a contact, m; 0 where none is given.
double bond_width(const Assembly& assembly, std::size_t contact, const BendingOptions& options);

/// The springs with the bending springs of the bonds: kM as given, or that of a parallel bond, an elastic layer whose
/// stiffness kN/w per length is spread evenly over its width w: kM = (kN/w) w³/12 = kN w²/12, kN that of the contact
/// (Potyondy & Cundall 2004, Int. J. Rock Mech. Min. Sci. 41, 1329: a rectangle in two dimensions).
/// \throws Error (bad_input) where both are given, a number is negative or not finite, or kM is more than 1e10 times
///         kN r², r the radius of the smaller disc
ContactSprings bending_springs(const Assembly& assembly, const ContactSprings& springs, const BendingOptions& options);

/// A relation between springs and moduli (Abe 1996) with the measures that it needs.
struct ChosenRelation {
  SpringRelation relation;
  IsotropicMeasures measures;
};

/// The relation that holds for an assembly: that of its lattice where springs are equal, else the isotropic one, (20)
/// and (21), with the solid fraction and the coordination number; of springs weighted by contact_density or
/// local_contact_density k psi = K/phi by (21); of springs weighted by voronoi K = kN/2, since the facets of Voronoi
/// cells obey sum h l = 2 V and uniform strain then stores w = kN <(n e n)²>.
/// \param lattice of the assembly; null: none
ChosenRelation spring_relation(const Assembly& assembly, SpringWeighting weighting, const Lattice* lattice);

/// The springs, before weighting, with which the assembly represents a continuum of these moduli.
/// \throws Error (bad_input) as springs_for; weighted springs on a lattice whose relation is for equal springs
SpringConstants springs_of_moduli(const ElasticModuli& moduli, const Assembly& assembly, SpringWeighting weighting,
                                  const Lattice* lattice, NegativeTangential negative = NegativeTangential::refuse);

/// The density rho of the discs themselves, kg/m³: the given one, else gamma/phi, gamma the density of the continuum
/// and phi the solid fraction (Abe 1996, section 2). None where neither is given.
/// \throws Error (bad_input): both are given and gamma differs from rho phi by more than 1e-6 of it; gamma alone is
///         given for spheres, since a sheet of them has no mass per metre of depth
std::optional<double> disc_density(std::optional<double> of_discs, std::optional<double> of_continuum, Body body,
                                   const Assembly& assembly);

}  // namespace equidem
