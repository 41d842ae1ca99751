// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Zero-energy modes: the unknowns that hold those of free pieces, and the mechanisms of a network.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/rigid_motions.hpp"

namespace equidem {

/// Over the size of its terms: what rounding leaves of the reaction of a component that is held in place of a
/// zero-energy mode on which the loads do no work.
inline constexpr double negligible_reaction = 1e-8;

struct HeldMotions {
  std::vector<std::size_t> components;  ///< disc * per_disc + k, one for each motion
  std::int64_t rigid = 0;
  std::vector<GearMode> gears;
};

/// Hold one component for each free rigid motion of a piece (that which the motion moves most) and the rotation of one
/// disc of each group of gears. The reactions are zero exactly where the loads do no work in those motions.
HeldMotions hold_free_motions(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                              DegreesOfFreedom& unknowns);

/// Motions that neither stretch nor slip, and that forces at rest do not resist where they count; kT of either sign
/// counted by its size. The rigid motions of an assembly in one piece that no support is given for (a free body 3, a
/// periodic cell 2 translations) are no mechanisms.
struct MechanismReport {
  std::int64_t rigid_motions = 0;  ///< of the whole, allowed
  std::int64_t free_pieces = 0;    ///< rigid motions of pieces or discs that should be held but are not
  std::int64_t gears = 0;          ///< groups of discs that can counter-rotate
  std::int64_t others = 0;         ///< found as zero pivots of K
  /// Directions of the period in which nothing joins the assembly to its images: in the infinite assembly they move
  /// apart and past each other, in no motion that repeats with the cell.
  std::int64_t unjoined = 0;
  std::vector<std::string> sentences;  ///< one for each kind, naming the first

  [[nodiscard]] std::int64_t count() const { return free_pieces + gears + others + unjoined; }
};

/// One L D L^T factorization, or none where the network grows rigid from its triangles (grows_rigid).
/// \throws Error (bad_input) as number_unknowns does; (out_of_memory) where the factor would not fit
MechanismReport find_mechanisms(const Assembly& assembly, const ContactSprings& springs, Rotation rotation,
                                std::span<const Support> supports);

/// Negative eigenvalues of K with its free rigid motions and gears held, and those beyond one for each rotation.
struct InertiaReport {
  std::int64_t negative_pivots = 0;
  std::optional<std::int64_t> unstable_modes = 0;  ///< none: the rotations alone are singular
};
InertiaReport find_inertia(const Assembly& assembly, const ContactSprings& springs, Rotation rotation,
                           std::span<const Support> supports);

/// Maxwell & Calladine: independent states of self-stress = constraints - unknowns + motions without energy, a
/// constraint being a stretch, where kT != 0 a slip, and where bending springs count a relative rotation.
std::int64_t count_self_stresses(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                                 std::int64_t unknowns, std::int64_t free_motions);

}  // namespace equidem
