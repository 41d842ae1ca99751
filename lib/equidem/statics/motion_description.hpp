// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A motion of an assembly in words and in energy: which disc moves most, and whether it is a mechanism or merely soft.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"

namespace equidem {

/// "a motion of 12 of 22 discs, most of all of disc 21 at (0.05, 0.02), which moves along (0.6, 0.8)": words that fit
/// into a sentence (no capital, no full stop). Does not depend on the scale or the sign of the motions. Discs that move
/// less than 1e-3 of the largest motion count as at rest.
/// \param motions per disc, finite
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
