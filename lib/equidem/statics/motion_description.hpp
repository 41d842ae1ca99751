// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A motion of an assembly in words and in energy: the kind of a mode of zero or negative stiffness, and whether
/// it is a mechanism or merely soft.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"

namespace equidem {

/// The kind of a motion, as words that fit into a sentence (no capital, no full stop): "a rigid rotation of
/// the whole assembly about (0.1, 0.05)", "a local motion of about 3 of 900 discs: disc 17 at (0.02, 0.01), ...".
/// Told apart are rigid translation and rotation (of all discs, or of those that move, such as a row or a ring, also
/// across the period), counter-rotation of discs, motion of one disc or of a few, groups that slide past one another,
/// uniform strain, and other motions that extend over the assembly; and where no contact stretches, whether discs slip
/// or roll. Does not depend on the scale or the sign of the motions. \param motions per disc, finite
std::string describe_motion(const Assembly& assembly, std::span<const DiscMotion> motions);

/// "x", "y" or the unit vector "(0.6, 0.8)"; opposite directions have one name.
std::string describe_direction(Vec2 direction);
/// "disc 17 at (0.02, 0.01)".
std::string describe_disc(const Assembly& assembly, std::size_t disc);

/// "Add contacts, give the contacts bending springs (kM > 0), or restrain rotation": what leaves a network fewer
/// zero-energy modes, of what it does not have yet.
/// \param rotation whether discs turn \param before what else helps: "hold that motion by a support"
std::string remedy_of_mechanisms(const Assembly& assembly, const ContactSprings& springs, bool rotation,
                                 std::vector<std::string> before = {});

/// Elastic energy of a motion, N (J/m per m): sum over contacts of kN dn²/2 + kT ds²/2, and
/// kM (theta_j - theta_i)²/2.
double elastic_energy(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions);

/// The scale of that energy, N: the same sum with the motions of the two discs of a contact in place of the stretch
/// and slip that they share, kN (|u_i|² + |u_j|²)/2 + |kT| ((r_i theta_i)² + (r_j theta_j)²)/2 + kM (theta_i² +
/// theta_j²)/2.
double reference_energy(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions);

/// elastic_energy / reference_energy of a motion; 0 where nothing moves, negative for an unstable mode (kT < 0). A
/// mechanism has what rounding leaves, below 1e-27. A stable mode may be soft, but not that soft: the bending of a
/// clamped strip, N rows long and two discs wide, has 0.3/N⁴ (1.7e-12 for 660 rows), and a mode that only tangential
/// springs resist about kT/kN times 1/N².
double softness(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions);
/// Mechanisms have less softness() than this, and motions that springs resist have more.
constexpr double softness_of_mechanisms = 1e-21;

}  // namespace equidem
