// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The force that the contacts exert, evaluated from the contact law itself.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/double_double.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// Motion of all discs as an unevaluated sum of two doubles, discs x per_disc components (u_x, u_y[, a theta]), m.
/// One double would not do: a displacement of 1000 stretches carries the round-off of 1000 stretches, and the
/// residual with it.
struct PreciseMotion {
  std::vector<double> high;
  std::vector<double> low;  ///< empty: 0

  explicit PreciseMotion(std::size_t components) : high(components, 0.0) {}
  /// Add a correction, keeping the digits that a sum in one double would lose.
  void add(std::span<const double> correction);
  template <typename Number = DoubleDouble>
  [[nodiscard]] Number at(std::size_t component) const {
    return low.empty() ? Number(high[component]) : Number(high[component], low[component]);
  }
};

/// Stretch and slip of a contact, and the rotations of its discs beside the mean strain, rad.
template <typename Number>
struct ContactMotionOf {
  DeformationOf<Number> deformation;
  Number theta_i = 0, theta_j = 0;
};
using ContactMotion = ContactMotionOf<double>;
ContactMotion motion_of(const SpringNetwork& network, const PreciseMotion& motion,
                        const std::optional<Tensor2>& gradient, std::size_t contact);

/// The change of the force of a contact along the normal and tangent of before the motion, prestress included.
ContactForce force_of(const ContactSprings& springs, std::size_t contact, const ContactMotion& motion);

/// Stretch and slip of a contact, with the digits of the motion.
using PreciseDeformation = DeformationOf<DoubleDouble>;
PreciseDeformation precise_deformation_of(const SpringNetwork& network, const PreciseMotion& motion,
                                          const std::optional<Tensor2>& gradient, std::size_t contact);

/// Evaluates a contact in a precise Number, without a mean strain.
/// \param i, j the first components of its discs \param rotations whether they are wanted beside the deformation
template <typename Number>
ContactMotionOf<Number> precise_motion_of(const ContactFrame& frame, const PreciseMotion& motion, std::size_t i,
                                          std::size_t j, const DegreesOfFreedom& unknowns, bool rotations) {
  ContactMotionOf<Number> result;
  Number turn, opening;
  if (unknowns.per_disc == 3) {
    const double a = unknowns.rotation_scale;
    const auto i_turns = motion.at<Number>(i + 2), j_turns = motion.at<Number>(j + 2);
    turn = (frame.lever_i * i_turns + frame.lever_j * j_turns) / a;
    if (frame.offset_i != 0 || frame.offset_j != 0) opening = (frame.offset_i * i_turns + frame.offset_j * j_turns) / a;
    if (rotations) result.theta_i = i_turns / a, result.theta_j = j_turns / a;
  }
  result.deformation = deformation(frame, motion.at<Number>(j) - motion.at<Number>(i),
                                   motion.at<Number>(j + 1) - motion.at<Number>(i + 1), turn, opening);
  return result;
}

/// The force and the moment that contacts exert on a disc, N/m and N.
template <typename Number>
struct PullOf {
  Number x, y, moment;

  /// N/m, moments over the scale of rotations.
  [[nodiscard]] std::array<Number, 3> components(double rotation_scale) const {
    return {x, y, moment / rotation_scale};
  }

  /// \param on_i, on_j whether the disc is the first, or the second, of the contact
  void add(const ContactFrame& frame, const ForceOf<Number>& force, bool on_i, bool on_j) {
    const Vec2 n = frame.normal;
    const Number fx = force.normal * n.x - force.tangential * n.y;
    const Number fy = force.normal * n.y + force.tangential * n.x;
    if (on_i) x += fx, y += fy, moment += moment_on_i(frame, force);
    if (on_j) x -= fx, y -= fy, moment += moment_on_j(frame, force);
  }
};

/// Force of every contact, from the differences of the motion of its discs with all their digits: a disc that has
/// turned far stretches its contacts by small differences of large products.
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
/// Stretch, slip, forces and their sums have twice the digits of a double.
/// \param gradient of the mean displacement (affine_deformation); none: 0
/// \param f per component; empty: no load
void residual_force(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                    std::span<const double> f, std::span<double> residual);

/// Moment that contacts exert on each disc about its centre, N.
std::vector<double> contact_moments(const Assembly& assembly, std::span<const ContactForce> forces);

}  // namespace equidem
