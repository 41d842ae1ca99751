// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds of discs, eight at a time: springs along, across and against bending, dashpots, strengths.
///
/// Springs push by where the discs are at the start of a step; what they bear is compared with the strengths at once.
/// When the impulses of contacts are known, dashpots resist one group after the other, each exactly with those before
/// it as they are: what they take, they take from the motion, in whatever number bonds hang together. No body is twice
/// in a group, so that the eight of a group are independent of one another.
///
/// Groups are in batches: first one for each block of bodies, of the bonds inside it; then one for each seam between a
/// block and the next one; then one of all other bonds. Batches of a phase (blocks, even seams, odd seams, the others)
/// share no body and are stepped on all threads, in an order and with sums that no number of threads changes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/cell/periodic_motion.hpp"
#include "equidem/grains/neighbours/near_pairs.hpp"

namespace equidem {

struct GrainSystem;
struct TiedPair;

/// Eight bonds. The lane of a bond that broke, or of none, has the bodies of another bond of the group, and constants
/// with which it does nothing.
struct alignas(64) BondGroup {
  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];
  PairLanes per_reach;  ///< 1/(r_i + r_j), 1/m
  PairLanes share;      ///< of the lever of i in the branch, r_i/(r_i + r_j)
};

/// Springs of a group (contact/finite_bond.hpp).
struct alignas(64) SpringGroup {
  PairLanes rest_x, rest_y;      ///< l0, m
  PairLanes levers;              ///< r_i + r_j at rest, m; also the length of l0
  PairLanes angle_i, angle_j;    ///< of the bodies at rest, rad
  PairLanes normal, tangential;  ///< kN dt, kT dt, N s/m
  PairLanes bending;             ///< kM dt, N m s/rad
};

/// Impulses of a step that springs cannot bear, N s; a little less than the strengths of bonds.hpp, which
/// decides.
struct alignas(64) StrengthGroup {
  PairLanes tension, shear;
  PairLanes per_moment;  ///< 6/width, 1/m; 0 without bending spring
};

struct alignas(64) DashpotGroup {
  PairLanes mass;         ///< 1/m_n, 1/kg
  PairLanes turning;      ///< r_i²/I_i + r_j²/I_j, 1/kg
  PairLanes normal;       ///< impulse per rate: C_n dt times Decay::mean, or C_n dt by the explicit step, kg
  PairLanes normal_gain;  ///< impulse per velocity gain by steady forces: (1 - Decay::mean) m_n, kg
  PairLanes tangential;   ///< C_s dt, kg
  // of the last step, N s
  PairLanes normal_impulse, tangential_impulse;
};

/// Rolling dashpots, where bonds have some.
struct alignas(64) RollingGroup {
  PairLanes mass;          ///< 1/m_r = 1/I_i + 1/I_j, 1/(kg m²)
  PairLanes coupling;      ///< r_i/I_i - r_j/I_j: rolling by an impulse along the rims, 1/(kg m)
  PairLanes rolling;       ///< as DashpotGroup::normal, kg m²
  PairLanes rolling_gain;  ///< as DashpotGroup::normal_gain, kg m²
  PairLanes impulse;       ///< of the last step, N m s
};

/// A bonded body in a step, for dashpots. Rows of four: velocity along x, along y, speed of the rim, spin.
struct alignas(32) BondedBody {
  double weights[4];  ///< per impulse, impulse, torque, torque
  double steady[4];   ///< what all impulses but those of dashpots change
  double given[4];    ///< impulse by dashpots, N s, and its torque, N m s, twice
};

struct BondBatch {
  std::size_t first_group = 0, end_group = 0;
  std::size_t first_body = 0, end_body = 0;  ///< in PackedBonds::bodies; of seams none
  // of the present step
  double lost = 0;     ///< J
  double nearest = 0;  ///< least distance of centres over the sum of the radii
  ImageImpulses on_images;
  std::vector<std::size_t> reached;  ///< groups of which a bond may have reached its strength
};

struct PackedBonds {
  static constexpr std::size_t phases = 4;
  using Loop = void (*)(GrainSystem& system, BondBatch& batch);
  /// Bonds of the lanes of a group, as numbers in BondList::tied; -1: none.
  using Lanes = std::array<std::int32_t, lanes_of_pairs>;

  std::vector<Lanes> lanes;
  LaneVector<BondGroup> groups;
  // as long as the groups, or empty where no bond has them
  LaneVector<SpringGroup> springs;
  LaneVector<StrengthGroup> strengths;
  LaneVector<PairImages> images;
  LaneVector<DashpotGroup> dashpots;
  LaneVector<RollingGroup> rolling;

  std::vector<BondBatch> batches;
  std::array<std::size_t, phases + 1> first_batch{};  ///< of each phase; the last entry is the number of batches
  std::vector<std::int32_t> bodies;                   ///< that are bonded, ascending
  LaneVector<BodyImpulse> by_springs;                 ///< of all bodies, in a step; `rim` is the torque once more
  LaneVector<BondedBody> bonded;                      ///< of all bodies

  // loops compiled for what these bonds have
  Loop stretch = nullptr;        ///< springs, and strengths; null: no bond has springs
  Loop resist = nullptr;         ///< dashpots; null: no bond has some
  Loop count_opening = nullptr;  ///< likewise
  bool alone = true;             ///< no body has two bonds
  bool state_is_new = true;      ///< whether reached strengths are unknown since the state was set from outside

  [[nodiscard]] std::size_t bytes() const;
};

/// Pack the bonds of the system, with no impulse in the last step.
void pack_bonds(GrainSystem& system);
/// Switch the lane of a bond off or on, as it has broken or not, with no impulse in the last step; those of other bonds
/// do not change.
void pack_again(GrainSystem& system, const TiedPair& bond);
/// Take the images of all bonds.
void pack_images(GrainSystem& system);

/// Impulse of the dashpots of a bond in the last step.
BondModes last_impulse(const GrainSystem& system, const TiedPair& bond);
void take_last_impulse(GrainSystem& system, const TiedPair& bond, const BondModes& impulse);

}  // namespace equidem
