// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The law of a contact that need not be bonded: it opens, closes, sticks and slips.
///
/// With the normal and tangential deformation (dn, ds) of the contact and its forces at rest (N_r, T_r),
///
///   N = min(N_r + kN dn, 0)               an open contact has the gap (N_r + kN dn)/kN > 0
///   T = T_r + kT (ds - p), |T| <= -mu N   p is the plastic slip: it grows where the limit is reached, along T
///
/// A bond is linear both ways: N = N_r + kN dn, T = T_r + kT (ds - p). Where a contact has no tangential spring or no
/// friction, T = 0 while it is closed.
#pragma once

#include <cmath>
#include <cstdint>

#include "equidem/breakage/path_numbers.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

enum class ContactStatus : std::uint8_t {
  bonded,
  stuck,           ///< closed, |T| <= -mu N
  slips_forward,   ///< closed, T = -mu N
  slips_backward,  ///< closed, T = mu N
  open,
};

constexpr bool is_slipping(ContactStatus status) {
  return status == ContactStatus::slips_forward || status == ContactStatus::slips_backward;
}

/// The sign of T, and of the slip, of a contact that slips.
constexpr double direction_of(ContactStatus status) {
  return status == ContactStatus::slips_backward ? -1 : 1;
}

constexpr ContactStatus slipping(double direction) {
  return direction < 0 ? ContactStatus::slips_backward : ContactStatus::slips_forward;
}

/// The derivative of the force: dN = nn dn, dT = tn dn + tt ds.
struct ContactTangent {
  double nn = 0, tn = 0, tt = 0;  ///< Pa

  /// The rate of force at these rates of deformation.
  [[nodiscard]] ContactForce rate(const ContactDeformation& d) const {
    return {nn * d.normal, tn * d.normal + tt * d.tangential};
  }
  void pass(PathNumbers& n) { EQUIDEM_PASS(n, nn, tn, tt); }
  friend bool operator==(const ContactTangent&, const ContactTangent&) = default;
};

struct UnbondedLaw {
  SpringConstants k;
  double friction = 0;  ///< mu
  ContactForce rest;    ///< N/m: (N_r, T_r)

  /// Whether the contact carries a tangential force without a bond.
  [[nodiscard]] bool rough() const { return k.kT > 0 && friction > 0; }

  [[nodiscard]] ContactTangent tangent(ContactStatus status) const {
    switch (status) {
      case ContactStatus::bonded:
        return {k.kN, 0, k.kT};
      case ContactStatus::stuck:
        return {k.kN, 0, rough() ? k.kT : 0};
      case ContactStatus::slips_forward:
      case ContactStatus::slips_backward:
        return {k.kN, -direction_of(status) * friction * k.kN, 0};
      case ContactStatus::open:
        return {};
    }
    return {};
  }

  /// \param slip p; in the precision of the deformation: where discs move far, the force is a small difference of them
  template <typename Number>
  [[nodiscard]] ContactForce force(ContactStatus status, const DeformationOf<Number>& d, Number slip) const {
    const double n = normal_coordinate(d);
    const auto t = [&] { return static_cast<double>(rest.tangential + k.kT * (d.tangential - slip)); };
    switch (status) {
      case ContactStatus::bonded:
        return {n, t()};
      case ContactStatus::stuck:
        return {n, rough() ? t() : 0};
      case ContactStatus::slips_forward:
      case ContactStatus::slips_backward:
        return {n, -direction_of(status) * friction * n};
      case ContactStatus::open:
        return {};
    }
    return {};
  }

  /// N_r + kN dn
  template <typename Number>
  [[nodiscard]] double normal_coordinate(const DeformationOf<Number>& d) const {
    return static_cast<double>(rest.normal + k.kN * d.normal);
  }

  /// The plastic slip with which a stuck contact has the tangential force T.
  template <typename Number>
  [[nodiscard]] Number slip_at(const DeformationOf<Number>& d, double tangential) const {
    return k.kT != 0 ? d.tangential - (static_cast<Number>(tangential) - rest.tangential) / k.kT : 0;
  }
};

/// The place of a contact on the limits of its law, where the way that it goes on is not determined by its force alone.
enum class OnLimit : std::uint8_t {
  none,      ///< its status goes on
  friction,  ///< |T| = -mu N > 0: it sticks, or slips in the direction of T
  apex,      ///< N = T = 0 without a gap: it opens, sticks, or slips either way
};

struct LimitContact {
  std::size_t contact = 0;
  OnLimit limit = OnLimit::none;
  double direction = 1;  ///< of T, where friction is the limit
};

/// The status that follows from the rates of deformation of a contact on a limit, per unit of lambda or of another
/// parameter.
/// \param none rates of force below it are round-off: the present status stays where it serves
inline ContactStatus status_after(const UnbondedLaw& law, const LimitContact& at, const ContactDeformation& rate,
                                  ContactStatus present, double none) {
  const double n = law.k.kN * rate.normal, t = law.k.kT * rate.tangential;
  if (at.limit == OnLimit::friction) {
    const double beyond = at.direction * t + law.friction * n;
    if (std::abs(beyond) <= none) return present;
    return beyond > 0 ? slipping(at.direction) : ContactStatus::stuck;
  }
  const bool closed = n < -none || (n <= none && present != ContactStatus::open);
  if (!closed) return ContactStatus::open;
  if (!law.rough()) return ContactStatus::stuck;
  const double beyond = std::abs(t) + law.friction * n;
  if (std::abs(beyond) > none) return beyond > 0 ? slipping(t) : ContactStatus::stuck;
  if (present == ContactStatus::open) return ContactStatus::stuck;
  return is_slipping(present) && direction_of(present) * t < -none ? slipping(t) : present;
}

}  // namespace equidem
