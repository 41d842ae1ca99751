// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The force that the contacts exert, evaluated from the contact law itself.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// Motion of all discs as an unevaluated sum of two doubles, discs x per_disc components (u_x, u_y[, a theta]), m.
/// One double would not do: a displacement of 1000 stretches carries the round-off of 1000 stretches, and the
/// residual with it.
struct PreciseMotion {
  std::vector<double> high;
  std::vector<double> low;  ///< empty: 0
  /// Stretches and slips are differences in quadruple precision, not in extended: for motions so far beyond them that
  /// the rounding of 64 bits counts.
  bool quadruple = false;

  explicit PreciseMotion(std::size_t components) : high(components, 0.0) {}
  /// Add a correction, keeping the digits that a sum in one double would lose.
  void add(std::span<const double> correction);
};

/// Stretch and slip of a contact, and the rotations of its discs beside the mean strain, rad.
struct ContactMotion {
  ContactDeformation deformation;
  double theta_i = 0, theta_j = 0;
};
ContactMotion motion_of(const SpringNetwork& network, const PreciseMotion& motion,
                        const std::optional<Tensor2>& gradient, std::size_t contact);

/// The change of the force of a contact along the normal and tangent of before the motion, prestress included.
ContactForce force_of(const ContactSprings& springs, std::size_t contact, const ContactMotion& motion);

/// Stretch and slip of a contact by the motion, from differences in extended precision or more, and by a
/// mean strain.
/// \param gradient of the mean displacement (affine_deformation); none: 0
ContactDeformation deformation_of(const SpringNetwork& network, const PreciseMotion& motion,
                                  const std::optional<Tensor2>& gradient, std::size_t contact);

/// Likewise, with the digits of extended precision.
using PreciseDeformation = DeformationOf<long double>;
PreciseDeformation precise_deformation_of(const SpringNetwork& network, const PreciseMotion& motion,
                                          const std::optional<Tensor2>& gradient, std::size_t contact);

/// Force of every contact, from the differences of the motion of its discs, evaluated in extended precision or more: a
/// disc that has turned far stretches its contacts by small differences of large products.
void contact_forces_of(const Assembly& assembly, const ContactSprings& springs, const DegreesOfFreedom& unknowns,
                       const PreciseMotion& motion, std::span<ContactForce> forces);

/// Moment of the bending spring of every contact on its first disc, N; its negative acts on the second.
std::vector<double> bending_moments_of(const SpringNetwork& network, const PreciseMotion& motion);

/// Internal force f_int = K u per component (N/m; moments over a), of contacts that carry no moments: the negative of
/// what contacts exert on the discs.
void internal_force(const Assembly& assembly, const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                    std::span<const ContactForce> forces, std::span<double> result);

/// The internal force of a motion, N/m per component, with the moments that bending springs and prestress add.
void internal_force(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                    std::span<double> result);

/// Residual force f - f_int(motion) on free components, 0 on held ones.
/// Stretch, slip, forces and their sums are all evaluated in extended precision or more.
/// \param gradient as in deformation_of
/// \param f per component; empty: no load
void residual_force(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                    std::span<const double> f, std::span<double> residual);

/// Moment that contacts exert on each disc about its centre, N.
std::vector<double> contact_moments(const Assembly& assembly, std::span<const ContactForce> forces);

}  // namespace equidem
