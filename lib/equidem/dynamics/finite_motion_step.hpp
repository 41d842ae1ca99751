// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One stage of an integrator for finite motions: normals and contact points follow the bodies, by the law of
/// contact/finite_bond.hpp.
///
/// The law takes two roots, two divisions and an arctangent. Where the neighbour has hardly moved as seen from the body, by
/// less than 1/64 of the branch and 1/64 rad, whatever the body itself has done, short polynomials give the same numbers to
/// rounding in half the time. A group is summed so, and anew by the law itself where one of its contacts is further from rest.
#pragma once

#include <cstddef>

#include "equidem/dynamics/lanes.hpp"
#include "equidem/dynamics/lanes_math.hpp"
#include "equidem/dynamics/small_motion_step.hpp"
#include "equidem/dynamics/step_kernel.hpp"

namespace equidem::lanes {

/// A slot's contacts at rest.
struct BondAtRest {
  Lanes x, y;           ///< l0
  Lanes over_square;    ///< 1/l0², 0: no contact
  Lanes square_levers;  ///< L², L = r_i + r_j
  Lanes share;          ///< r_i/L
  Lanes kN, kT;
};

template <LoopKind kind>
EQUIDEM_INLINE BondAtRest load_bond(const double* geometry, const LoopData& data) {
  BondAtRest bond;
  load(geometry, bond.x);
  load(geometry + 4, bond.y);
  load(geometry + 8, bond.over_square);
  if constexpr (kind.equal_contacts) {
    bond.square_levers = bond.x * bond.x + bond.y * bond.y;
    bond.share = Lanes{} + 0.5;
    bond.kN = Lanes{} + data.kN;
    bond.kT = Lanes{} + data.kT;
  } else {
    Lanes levers;
    load(geometry + 12, levers);
    bond.square_levers = levers * levers;
    load(geometry + 16, bond.share);
    load(geometry + 20, bond.kN);
    load(geometry + 24, bond.kT);
  }
  return bond;
}

/// The same contacts as they are now.
struct BondNow {
  Lanes x, y;         ///< l
  Lanes stretch;      ///< dn/|l|
  Lanes over_square;  ///< 1/l²
  Lanes slip;         ///< ds/L = psi - theta
};

/// The law, for any motion d = u_j - u_i: with e = l² - l0² = d.(l0 + l), dn/|l| = e/(|l| (|l| + |l0|)), and psi the angle
/// from l0 to l. The smallest number keeps lanes without a contact, where l = l0 = 0, from dividing by zero.
template <LoopKind kind>
EQUIDEM_INLINE BondNow deform(const BondAtRest& rest, const Lanes& dx, const Lanes& dy, const Lanes& theta_i,
                              const Lanes& theta_j) {
  constexpr double smallest = 1e-300;
  BondNow bond;
  bond.x = rest.x + dx;
  bond.y = rest.y + dy;
  const Lanes square = bond.x * bond.x + bond.y * bond.y, length = square_root(square);
  const Lanes lengths = length + square_root(rest.x * rest.x + rest.y * rest.y);
  const Lanes q = 1 / (square * lengths + smallest);
  bond.stretch = (dx * (rest.x + bond.x) + dy * (rest.y + bond.y)) * length * q;
  bond.over_square = lengths * q;
  if constexpr (kind.springs != LoopKind::Springs::normal) {
    bond.slip = angle_of(rest.x * bond.x + rest.y * bond.y, rest.x * dy - rest.y * dx);
  }
  if constexpr (kind.springs == LoopKind::Springs::rotation) {
    bond.slip = without_whole_turns(bond.slip - (theta_j + rest.share * (theta_i - theta_j)));
  }
  return bond;
}

/// The law for a neighbour near its place as body i sees it: with p = l0 turned by theta_i, v = l - p, w = 1/l0²,
///   e = v.(p + l) w = l²/l0² - 1,   dn/|l| = g = 1 - 1/sqrt(1 + e),   1/l² = w (1 - g)²,
///   psi - theta_i = asin((p x v) w (1 - g)).
/// First e for the stretch, (p x v) w for 1/l², and what theta is beyond theta_i for the slip: finish_near makes the rest.
/// \param far set where it does not hold
template <LoopKind kind>
EQUIDEM_INLINE BondNow begin_near(const BondAtRest& rest, const SineVersine& turn, const Lanes& dx, const Lanes& dy,
                                  const Lanes& theta_i, const Lanes& theta_j, Choice& far) {
  constexpr double near = 1.0 / 64;
  constexpr bool rotation = kind.springs == LoopKind::Springs::rotation;
  BondNow bond;
  Lanes px = rest.x, py = rest.y, vx = dx, vy = dy;
  if constexpr (rotation) {
    const Lanes back_x = turn.versine * rest.x + turn.sine * rest.y;
    const Lanes back_y = turn.versine * rest.y - turn.sine * rest.x;
    px -= back_x;
    py -= back_y;
    vx += back_x;
    vy += back_y;
  }
  bond.x = rest.x + dx;
  bond.y = rest.y + dy;
  bond.stretch = (vx * (px + bond.x) + vy * (py + bond.y)) * rest.over_square;
  bond.over_square = (px * vy - py * vx) * rest.over_square;
  Lanes distance = (vx * vx + vy * vy) * rest.over_square;
  if constexpr (rotation) {
    const Lanes twist = theta_j - theta_i;
    bond.slip = twist - rest.share * twist;
    distance += twist * twist;
  }
  far |= distance > near * near;
  return bond;
}

template <LoopKind kind>
EQUIDEM_INLINE void finish_near(BondNow& bond) {
  bond.stretch = small_shortening(bond.stretch);
  const Lanes ratio = 1 - bond.stretch;
  if constexpr (kind.springs != LoopKind::Springs::normal) {
    const Lanes angle = small_arcsine(bond.over_square * ratio);
    bond.slip = kind.springs == LoopKind::Springs::rotation ? angle - bond.slip : angle;
  }
  bond.over_square = ratio * ratio;
}

/// Forces f_N n + f_T L/|l| s and moments f_T r_i, given f_N/|l| and the couple f_T L.
template <LoopKind kind>
EQUIDEM_INLINE void add_stress(const BondNow& bond, const Lanes& normal_over_length, const Lanes& couple,
                               const Lanes& share, Resultant& sum) {
  sum.x += normal_over_length * bond.x;
  sum.y += normal_over_length * bond.y;
  if constexpr (kind.springs != LoopKind::Springs::normal) {
    const Lanes across = couple * bond.over_square;
    sum.x -= across * bond.y;
    sum.y += across * bond.x;
    if constexpr (kind.springs == LoopKind::Springs::rotation) sum.moment += share * couple;
  }
}

/// A group's own motion and velocity.
struct GroupState {
  Lanes x, y, theta, vx, vy, omega;
};

template <LoopKind kind>
EQUIDEM_INLINE GroupState load_state(const LoopData& data, int parity, std::int32_t group) {
  constexpr int width = kind.springs == LoopKind::Springs::rotation ? 4 : 2;
  const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(group) * 4 * width;
  GroupState own;
  load_group<width>(data.motion[parity] + at, own.x, own.y, own.theta);
  if constexpr (kind.resistance == LoopKind::Resistance::dashpot) {
    load_group<width>(data.velocity_at[parity] + at, own.vx, own.vy, own.omega);
  }
  return own;
}

/// The springs of a slot, and its dashpots: c_N and c_T times the rates of stretch and slip.
template <LoopKind kind>
EQUIDEM_INLINE void add_bond(const LoopData& data, int parity, std::int32_t slot, const GroupState& own,
                             const BondAtRest& rest, const BondNow& bond, Resultant& force, Resultant& dashpots) {
  constexpr bool tangential = kind.springs != LoopKind::Springs::normal;
  constexpr bool rotation = kind.springs == LoopKind::Springs::rotation;
  Lanes couple{};
  if constexpr (tangential) couple = rest.kT * rest.square_levers * bond.slip;
  add_stress<kind>(bond, rest.kN * bond.stretch, couple, rest.share, force);
  if constexpr (kind.resistance == LoopKind::Resistance::dashpot) {
    Lanes cN = Lanes{} + data.cN, cT = Lanes{} + data.cT;
    if constexpr (!kind.equal_contacts) {
      const double* geometry = data.geometry + static_cast<std::ptrdiff_t>(slot) * slot_doubles(kind) * 4;
      load(geometry + 28, cN);
      load(geometry + 32, cT);
    }
    Lanes dx, dy, omega_j;
    gather<rotation ? 4 : 2>(data.velocity_at[parity], data.neighbour + static_cast<std::ptrdiff_t>(slot) * 4, dx, dy,
                             omega_j);
    dx -= own.vx;
    dy -= own.vy;
    if constexpr (tangential) {
      Lanes rate = (bond.x * dy - bond.y * dx) * bond.over_square;
      if constexpr (rotation) rate -= omega_j + rest.share * (own.omega - omega_j);
      couple = cT * rest.square_levers * rate;
    }
    add_stress<kind>(bond, cN * (bond.x * dx + bond.y * dy) * bond.over_square, couple, rest.share, dashpots);
  }
}

/// Slots of a few groups, worked on stage by stage: each stage does the same to many slots that do not wait for one another,
/// which keeps the processor busy where the whole law for one slot after the other would not.
template <LoopKind kind>
struct FiniteMotionStep {
  static constexpr std::int32_t most_groups = 4, most_slots = 32;
  static constexpr bool rotation = kind.springs == LoopKind::Springs::rotation;

  EQUIDEM_INLINE FiniteMotionStep(const LoopData& data_in, int parity_in) : data(data_in), parity(parity_in) {}

  const LoopData& data;
  const int parity;
  GroupState own[most_groups];
  SineVersine turn[most_groups];
  Choice far[most_groups];
  BondNow bonds[most_slots];

  EQUIDEM_INLINE BondAtRest at_rest(std::int32_t slot) const {
    return load_bond<kind>(data.geometry + static_cast<std::ptrdiff_t>(slot) * slot_doubles(kind) * 4, data);
  }
  EQUIDEM_INLINE void neighbours(std::int32_t slot, Lanes& x, Lanes& y, Lanes& theta) const {
    gather<rotation ? 4 : 2>(data.motion[parity], data.neighbour + static_cast<std::ptrdiff_t>(slot) * 4, x, y, theta);
  }

  /// Deform the bonds of groups [first, last).
  EQUIDEM_INLINE void deform_near(std::int32_t first, std::int32_t last) {
    if constexpr (rotation) {
      for (std::int32_t g = first; g < last; ++g) turn[g - first] = sine_versine(own[g - first].theta);
    }
    const std::int32_t first_slot = data.first[first], last_slot = data.first[last];
    for (std::int32_t g = first; g < last; ++g) {
      const GroupState& body = own[g - first];
      Choice any{};
      for (std::int32_t k = data.first[g]; k < data.first[g + 1]; ++k) {
        Lanes x, y, theta;
        neighbours(k, x, y, theta);
        bonds[k - first_slot] =
            begin_near<kind>(at_rest(k), turn[g - first], x - body.x, y - body.y, body.theta, theta, any);
      }
      far[g - first] = any;
    }
    for (std::int32_t k = first_slot; k < last_slot; ++k) finish_near<kind>(bonds[k - first_slot]);
  }

  EQUIDEM_INLINE void sum_near(std::int32_t first_slot, std::int32_t group, const GroupState& body, Resultant& force,
                               Resultant& dashpots) const {
    for (std::int32_t k = data.first[group]; k < data.first[group + 1]; ++k) {
      const BondAtRest rest = at_rest(k);
      BondNow bond = bonds[k - first_slot];
      bond.over_square *= rest.over_square;
      add_bond<kind>(data, parity, k, body, rest, bond, force, dashpots);
    }
  }

  EQUIDEM_INLINE void sum_far(std::int32_t group, const GroupState& body, Resultant& force, Resultant& dashpots) const {
    for (std::int32_t k = data.first[group]; k < data.first[group + 1]; ++k) {
      Lanes x, y, theta;
      neighbours(k, x, y, theta);
      const BondAtRest rest = at_rest(k);
      add_bond<kind>(data, parity, k, body, rest, deform<kind>(rest, x - body.x, y - body.y, body.theta, theta), force,
                     dashpots);
    }
  }
};

template <LoopKind kind>
EQUIDEM_INLINE void finite_motion_step(const LoopData& data, const Stage& stage, int parity, std::int32_t begin,
                                       std::int32_t end, Dissipation& sum) {
  using Step = FiniteMotionStep<kind>;
  Step step(data, parity);
  DissipationLanes dissipation;
  for (std::int32_t first = begin; first < end;) {
    std::int32_t last = first + 1;
    while (last < end && last - first < Step::most_groups &&
           data.first[last + 1] - data.first[first] <= Step::most_slots) {
      ++last;
    }
    const bool fits = data.first[last] - data.first[first] <= Step::most_slots;
    for (std::int32_t g = first; g < last; ++g) step.own[g - first] = load_state<kind>(data, parity, g);
    if (fits) step.deform_near(first, last);
    for (std::int32_t g = first; g < last; ++g) {
      Resultant force, dashpots;
      const Choice& far = step.far[g - first];
      const GroupState& own = step.own[g - first];
      if (fits && (far[0] | far[1] | far[2] | far[3]) == 0) {
        step.sum_near(data.first[first], g, own, force, dashpots);
      } else {
        step.sum_far(g, own, force, dashpots);
      }
      advance<kind>(data, stage, parity, g, own.x, own.y, own.theta, force, dashpots, dissipation);
    }
    first = last;
  }
  if constexpr (kind.resistance != LoopKind::Resistance::none) add_dissipation(dissipation, sum);
}

}  // namespace equidem::lanes
