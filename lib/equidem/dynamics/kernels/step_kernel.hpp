// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The compiled loops: one step of a range of groups. One loop is chosen for a scene before its first step.
#pragma once

#include <cstdint>

namespace equidem {

/// The properties of a scene that select the code of the loop; absent effects cost nothing.
struct LoopKind {
  enum class Motion : std::uint8_t {
    small,   ///< fixed normals and contact points: forces are linear in the motion, K u
    finite,  ///< normals and contact points follow the bodies
  } motion = Motion::small;
  enum class Springs : std::uint8_t {
    normal,      ///< kT = 0 everywhere; two unknowns
    tangential,  ///< kT, rotation restrained; two unknowns
    rotation,    ///< kT, rotation; three unknowns
  } springs = Springs::normal;
  bool bending = false;        ///< kM, only with rotation; contacts then are not equal, nor discs
  bool equal_contacts = true;  ///< one pair of springs for all, contact points in the middle: geometry in three numbers
  bool equal_discs = true;     ///< one mass and one moment of inertia for all; only without a resistance
  enum class Resistance : std::uint8_t {
    none,
    body,     ///< v' = keep v + ...: mass-proportional damping; gravity
    local,    ///< non-viscous (Cundall): a share of the resultant force, against the velocity; gravity
    dashpot,  ///< at contacts, from relative velocities; mass-proportional damping; gravity
  } resistance = Resistance::none;

  [[nodiscard]] constexpr int unknowns() const { return springs == Springs::rotation ? 3 : 2; }
  /// Doubles of a disc in the array of motions: (x, y) or (x, y, theta, 0).
  [[nodiscard]] constexpr int width() const { return springs == Springs::rotation ? 4 : 2; }
  /// Doubles of one slot and lane: LoopData::geometry.
  [[nodiscard]] constexpr int slot_doubles() const {
    const int of_springs = (equal_contacts ? 3 : motion == Motion::finite ? 7 : 6) + int{bending};
    return of_springs + (resistance == Resistance::dashpot && !equal_contacts ? 2 + int{bending} : 0);
  }

  bool operator==(const LoopKind&) const = default;
};

/// Arrays of a loop; lanes = 4, places in groups of four. Lengths in m, angles in rad.
struct LoopData {
  const std::int32_t* first = nullptr;      ///< slots of group g: first[g] .. first[g + 1]
  const std::int32_t* neighbour = nullptr;  ///< per slot and lane: place
  /// Per slot, lanes together, with l the branch at rest, r the lever of the disc and r' that of its neighbour. Small
  /// motions: l_x, l_y, 1/l² where contacts are equal, else n_x, n_y, r, r', kN, kT. Finite motions: l_x, l_y, l², and
  /// where contacts are not equal (r + r')/|l|, r/(r + r'), kN, kT. Bending springs append kM. Dashpots append c_N,
  /// c_T, and with bending springs c_M, where contacts are not equal.
  const double* geometry = nullptr;
  const double* inverse_inertia = nullptr;  ///< per group: 1/m, 1/I, lanes together; absent where discs are equal
  double* motion[2] = {nullptr, nullptr};   ///< places x width; a step reads one and writes the other
  double* velocity = nullptr;               ///< groups x unknowns x lanes
  double* velocity_at[2] = {nullptr,
                            nullptr};  ///< dashpots only: second copy of velocities, places x width, as motions
  double* dashpot = nullptr;           ///< dashpots only: their resultants, groups x unknowns x lanes
  double kN = 0, kT = 0;               ///< equal contacts
  double inverse_mass = 0, inverse_moment = 0;  ///< equal discs
  double cN = 0, cT = 0;                        ///< equal contacts with dashpots
  double gravity_x = 0, gravity_y = 0;          ///< m/s²
  double local_damping = 0;                     ///< share
  double mass_damping = 0;                      ///< alpha, 1/s, for the ledger; the damping itself is in Stage::keep
};

/// One stage of an integrator: v' = keep v + kick a(u), u' = u + drift v' + drift_before v.
struct Stage {
  double keep = 1;
  double kick = 0;          ///< s
  double drift = 0;         ///< s
  double drift_before = 0;  ///< s
  double duration = 0;      ///< s, over which forces act, for the ledger
};

/// Energy dissipated by dampers, N; counted only by loops with damping.
struct Dissipation {
  double mass = 0, contact = 0, local = 0;

  Dissipation& operator+=(const Dissipation& other) {
    mass += other.mass;
    contact += other.contact;
    local += other.local;
    return *this;
  }
};

/// Advance groups [begin, end) by one stage, from motion[parity] to motion[1 - parity].
using StepFunction = void (*)(const LoopData& data, const Stage& stage, int parity, std::int32_t begin,
                              std::int32_t end, Dissipation& dissipation);

/// The loop for a kind of scene, compiled for the widest vectors that this processor has.
StepFunction step_function(const LoopKind& kind);

}  // namespace equidem
