// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds of colliding discs that break.
///
/// A bond carries N (tension positive), T and M, the forces and the moment of its springs. A parallel bond of the width
/// w, with kM = kN w²/12, has its largest tension at the outer fibre, N/w + 6 |M|/w² (Potyondy & Cundall 2004, Int. J.
/// Rock Mech. Min. Sci. 41, 1329). It breaks where N + 6 |M|/w >= f_t, in bending where the moment has the larger share
/// of that, else in tension; and in shear where |T| >= f_s - mu N. The two discs then collide as any others,
/// with the friction of the collisions. A contact that is in compression when its bond breaks begins with its overlap
/// and an unstretched tangential spring.
///
/// A bond that breaks switches its lane off; nothing else changes but the pairs of the blocks of its discs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/contacts/bond_step.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// A bond that broke.
struct BondBreak {
  std::int64_t step = 0;  ///< steps done when it broke
  std::size_t bond = 0;   ///< in the order of the scene
  BreakMode mode = BreakMode::tension;
  Vec2 place = {};    ///< of the bond, m
  double energy = 0;  ///< of its springs, J (discs: per metre of depth)
};

/// The numbers of a break in a saved state.
inline constexpr auto break_numbers = [](auto& event, const auto& visit) {
  visit(event.step), visit(event.bond), visit(event.mode), visit(event.place.x), visit(event.place.y);
  visit(event.energy);
};

/// Strengths of the bonds of a scene, scattered in their order as those of the contacts of an assembly.
/// \throws Error (bad_input) as contact_strengths
ContactStrengths bond_strengths(const GrainScene& scene, const StrengthOptions& options);

/// The force at the outer fibre by a moment, over it: 6/w, 1/m; 0 of a bond without bending spring.
double moment_to_force(const SpringConstants& k, double kM);

/// How a bond breaks under the forces of its springs, if it does; one that carries nothing does not break, as in
/// breakage/break_search.hpp.
/// \param moment of the bending spring, N m; \param tension, shear its strengths, N/m
std::optional<BreakMode> break_of(const SpringConstants& k, double kM, const ContactForce& force, double moment,
                                  double tension, double shear, double friction);

/// Breaks bonds that have reached their strengths at the present motions, where push_springs() saw some that may have,
/// and lets their discs collide.
/// \return whether some broke
bool break_bonds(GrainSystem& system);

/// \throws Error (bad_input) where breaks of a saved state name a bond that is not there, or one twice
void check_breaks(const GrainSystem& system, const std::vector<BondBreak>& breaks);

/// The state in which exactly these bonds have broken.
/// \param breaks checked
void restore_breaks(GrainSystem& system, std::vector<BondBreak> breaks);

}  // namespace equidem
