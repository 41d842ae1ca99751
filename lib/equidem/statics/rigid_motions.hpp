// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motions that neither contacts nor supports resist and that follow from the contact graph alone: rigid motions of
/// connected pieces, and the counter-rotation of discs like gears.
///
/// Let the centres of a connected piece move rigidly, u = t + omega e_z x (x - c). No contact stretches. The slip of
/// a contact of length l,
///
///   ds = omega l - (r_i theta_i + r_j theta_j),
///
/// must vanish where kT != 0: a disc that rolls on its neighbour turns by theta_j = (omega l - r_i theta_i) / r_j.
/// Along contacts with kT != 0 all rotations of a component thus follow from omega and the rotation gamma of one
/// disc, theta_i = alpha_i omega + beta_i gamma, and every contact that closes a ring requires
///
///   (r_i alpha_i + r_j alpha_j - l) omega + (r_i beta_i + r_j beta_j) gamma = 0.
///
/// Together with one row for each held component these are the equations for (t, omega, gamma), and their null space is
/// what can move. gamma alone is the gear mode: it exists where every ring of the component closes, that is, has an
/// even number of contacts and equal products of lever arms either way round. With rotation restrained every theta is
/// zero and any kT != 0 resists omega. Off the lines of centres the arms of a contact meet in one point, so that omega
/// has no energy where all bodies turn with it: rotations beside it, theta_i - omega = beta_i gamma, must leave r_i
/// theta_i + r_j theta_j (where kT != 0) and o_i theta_i + o_j theta_j without change, o the offsets. A piece that
/// winds around the period cannot rotate.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// u = t + rotation/size e_z x (x - centre), with the size and centre of a piece.
struct RigidMotion {
  Vec2 t;
  double rotation = 0;
};

/// A connected piece and its free motions.
struct PieceMotions {
  std::int32_t first_disc = 0;
  std::int64_t discs = 0;
  bool has_contacts = false;
  bool held = false;              ///< some component of it is
  bool rolls = false;             ///< its rotation makes discs turn otherwise than the piece
  Vec2 centre;                    ///< m
  double size = 0;                ///< m: half the diagonal of the box around its centres
  std::vector<RigidMotion> free;  ///< orthonormal basis of (t, rotation)
};

/// Discs that can counter-rotate like gears.
struct GearMode {
  std::int32_t first_disc = 0;
  std::int64_t discs = 0;
};

struct FreeMotions {
  std::vector<PieceMotions> pieces;  ///< of one disc (with or without contacts) or more
  std::vector<GearMode> gears;
  UnwrappedPieces unwrapped;  ///< the discs of the pieces
};

/// In a time proportional to the contacts. Sums below 1e-9 of their terms count as zero, below the rounding of
/// coordinates where that is more (discs a million radii from the origin). Rotations that no contact resists are none
/// of these motions (number_unknowns holds them).
FreeMotions find_free_motions(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                              const DegreesOfFreedom& unknowns);

}  // namespace equidem
