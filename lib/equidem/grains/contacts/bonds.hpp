// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds of colliding discs (contact/finite_bond.hpp), one by one, and their stages of a step; kernels/bond_loop.hpp
/// has them in groups of eight.
///
/// A bond carries N (tension positive), T and M, the forces and the moment of its springs. A parallel bond of the width
/// w, with kM = kN w²/12, has its largest tension at the outer fibre, N/w + 6 |M|/w² (Potyondy & Cundall 2004, Int. J.
/// Rock Mech. Min. Sci. 41, 1329). It breaks where N + 6 |M|/w >= f_t, in bending where the moment has the larger share
/// of that, else in tension; and in shear where |T| >= f_s - mu N. The two discs then collide as any others,
/// with the friction of the collisions. A contact that is in compression when its bond breaks begins with its overlap
/// and an unstretched tangential spring.
///
/// Where the strengths are `beside_contact`, as those of a parallel bond, the discs touch as others do while they are
/// bonded: their contact carries compression and friction beside the springs of the bond, which alone decide when it
/// breaks, and goes on as it is when it has broken.
///
/// A bond that breaks switches its lane off; nothing else changes but the pairs of the blocks of its discs.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/finite_bond.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/cell/periodic_motion.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/neighbours/body_blocks.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/any_simulation.hpp"

namespace equidem {

struct GrainSystem;

/// A bond between bodies sorted by position.
struct TiedPair {
  std::int32_t i = 0, j = 0;  ///< i < j
  PeriodicImage image;        ///< of j that is bonded to i, in a periodic cell; body: 0
  BondModes dashpots;
  double share = 0;  ///< lever i over the distance: r_i/(r_i + r_j)
  FiniteBond springs;
  double angle_i = 0, angle_j = 0;  ///< of the bodies at rest, rad
  double tension = 0, shear = 0;    ///< strengths, N/m, where bonds break
  std::size_t number = 0;           ///< in the order of the scene
  std::int32_t packed = -1;         ///< lane in PackedBonds, which stores the impulse
  bool broken = false;              ///< its lane is switched off, and its discs collide

  [[nodiscard]] bool has_dashpots() const {
    return dashpots.normal > 0 || dashpots.tangential > 0 || dashpots.rolling > 0;
  }
  [[nodiscard]] bool has_springs() const { return springs.springs.kN > 0 || springs.springs.kT > 0 || springs.kM > 0; }
};

/// The state of a bond from which a run continues.
struct BondState {
  PeriodicImage image;  ///< as in TiedPair
  BondModes impulse;    ///< of the dashpots in the last step
};

/// The numbers of a bond in a saved state.
inline constexpr auto bond_numbers_of_state = [](auto& bond, const auto& visit) {
  visit(bond.image.a), visit(bond.image.b);
  visit(bond.impulse.normal), visit(bond.impulse.tangential), visit(bond.impulse.rolling);
};

BondState state_of(const GrainSystem& system, const TiedPair& bond);
/// \param states of all bonds
void take_states(GrainSystem& system, const std::vector<BondState>& states);

/// Two discs that are bonded as they are now; in a periodic cell i and the image of j that is nearest.
BondRest rest_of(const GrainScene& scene, std::size_t i, std::size_t j);

/// Set the bonds of a sorted scene, sorted in turn, so that results do not depend on the caller's order. In a periodic
/// cell each is of i and the image of j that is nearest.
void tie_bonds(GrainSystem& system, const GrainScene& scene);

/// The place of the bond of two bodies i < j in a list ordered by them, or that of the first behind it.
template <class Bonds>
auto place_of_bond(Bonds& bonds, std::int32_t i, std::int32_t j) {
  return std::ranges::lower_bound(bonds, std::pair(i, j), {}, [](const TiedPair& b) { return std::pair(b.i, b.j); });
}

/// Motion of a bond from rest to now.
BondMotion<double> motion_of_bond(const GrainSystem& system, const TiedPair& bond);

/// Smallest distance of the centres over the sum of the radii at which the direction of a bond is defined.
constexpr double nearest_centres_of_bonds = 1e-3;

/// \throws Error (computation_failed) naming the first bond whose centres are nearer than nearest_centres_of_bonds
void refuse_crept_bonds(const GrainSystem& system);

/// Bodies have been taken as their images inside a periodic cell: so are those of bonds, however far they are
/// stretched.
/// \param columns periods along x that the period along y has lost \param moves periods by which bodies have been moved
void move_images_of_bonds(GrainSystem& system, std::int32_t columns, const std::vector<PeriodicImage>& moves);

/// From the centre of i to that of j, or of its image, now.
Vec2 branch_of(const GrainSystem& system, const TiedPair& bond);

/// Sum of force times branch over the bonds, in the last step, N m.
Tensor2 moment_of_bonds(const GrainSystem& system);

/// Impulses of a bond on i and on j: of its dashpots in the last step, and in a step of its springs as they are now.
std::array<BodyImpulse, 2> impulses_of_bond(const GrainSystem& system, const TiedPair& bond);

/// Whether two bodies i < j are bonded. Calls must be in ascending order of pairs; `next` carries the position from
/// call to call.
inline bool are_tied(const std::vector<TiedPair>& bonds, std::size_t& next, std::int32_t i, std::int32_t j) {
  while (next < bonds.size() && (bonds[next].i < i || (bonds[next].i == i && bonds[next].j < j))) ++next;
  return next < bonds.size() && bonds[next].i == i && bonds[next].j == j && !bonds[next].broken;
}

/// Position of the first bond whose first body is `body` or a later one, for are_tied().
inline std::size_t first_bond_from(const std::vector<TiedPair>& bonds, std::int32_t body) {
  const auto before = [](const TiedPair& bond, std::int32_t i) { return bond.i < i; };
  return static_cast<std::size_t>(std::lower_bound(bonds.begin(), bonds.end(), body, before) - bonds.begin());
}

/// Compute the impulses of springs by where the discs are, and the rates of the bonds, before all contacts.
/// \throws Error (computation_failed) if the centres of bonded discs nearly coincide
void push_springs(GrainSystem& system);

/// Add the impulses of springs to those of the step, and then those of dashpots, after all contacts.
void add_bond_impulses(GrainSystem& system);

/// Verlet schemes: count the energy lost in dashpots in the half kick at the start of a step; add_bond_impulses counts
/// that of the half kick at its end.
void count_opening_kick(GrainSystem& system);

/// Energy of the springs of bonds, J.
double elastic_of_bonds(const GrainSystem& system);

/// The bonds as contacts in the order of (i, j): springs stretched as they are now, dashpots by their mean force over
/// the last step. Moments of rolling dashpots are left out.
std::vector<BodyContact> contacts_of_bonds(const GrainSystem& system);

/// Longest stable step, s; infinite if there is no limit. M^-1 C and M^-1 K are bounded by the sum over the bonds of
/// each disc of the largest rate of each bond: exact for pairs of discs and for long chains of equal discs, otherwise
/// conservative. Dashpots limit the step only if they are explicit. Contacts with other bodies are not included.
double bond_step_limit(const GrainScene& scene, GrainOptions::BondStep bond_step);

/// The limit, s, of a step with dashpots taken at its start: dt < 2 m_n/C_n, 2 m_s/C_s for a pair. Dashpots of bonds
/// that share discs act one after the other: their loss is off by about dt over it.
double explicit_step_limit(const GrainScene& scene);

/// \throws Error (bad_input): a law without bonds, or without bonds that break where there are strengths
void check_law_of_bonds(const GrainScene& scene, NormalLaw law);

/// \throws Error (bad_input): bodies that do not exist, that are not discs, that are bonded to themselves or twice to
///         one another; centres that coincide; dashpots and springs that are negative, not finite or all 0; a law
///         without bonds; a step above the limit
void check_bonds(const GrainScene& scene, const GrainOptions& options);

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
