// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One stage of an integrator for small motions: every disc sums the forces of its contacts and moves.
///
/// One stage of an integrator for finite motions: normals and contact points follow the bodies, by the law of
/// contact/finite_bond.hpp.
///
/// The law takes two roots, two divisions and an arctangent. If the neighbour has turned by less than 1/64 rad relative
/// to the body, one division and short polynomials give the same values to rounding in less than half the time. A group
/// is summed in this way, and again by the full law if one of its contacts is further from rest.
#pragma once

#include <cstddef>
#include <cstdint>

#include "equidem/core/simd.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"

namespace equidem::lanes {

using Lanes = simd::Four;
using namespace simd;

/// The motions of four places as x, y(, theta) of four lanes.
template <int Width>
EQUIDEM_ALWAYS_INLINE void gather(const double* motion, const std::int32_t* place, Lanes& x, Lanes& y, Lanes& theta) {
  const double *a = motion + Width * static_cast<std::ptrdiff_t>(place[0]),
               *b = motion + Width * static_cast<std::ptrdiff_t>(place[1]),
               *c = motion + Width * static_cast<std::ptrdiff_t>(place[2]),
               *d = motion + Width * static_cast<std::ptrdiff_t>(place[3]);
  if constexpr (Width == 4) {
    x = load<Lanes>(a);
    y = load<Lanes>(b);
    theta = load<Lanes>(c);
    Lanes unused = load<Lanes>(d);
    transpose(x, y, theta, unused);
  } else {
    const Lanes ac = __builtin_shufflevector(load<Two>(a), load<Two>(c), 0, 1, 2, 3);
    const Lanes bd = __builtin_shufflevector(load<Two>(b), load<Two>(d), 0, 1, 2, 3);
    x = __builtin_shufflevector(ac, bd, 0, 4, 2, 6);
    y = __builtin_shufflevector(ac, bd, 1, 5, 3, 7);
    theta = Lanes{};
  }
}

/// The motions of a group, whose places follow one another.
template <int Width>
EQUIDEM_ALWAYS_INLINE void load_group(const double* motion, Lanes& x, Lanes& y, Lanes& theta) {
  constexpr std::int32_t place[] = {0, 1, 2, 3};
  gather<Width>(motion, place, x, y, theta);
}

template <int Width>
EQUIDEM_ALWAYS_INLINE void store_group(const Lanes& x, const Lanes& y, const Lanes& theta, double* motion) {
  if constexpr (Width == 4) {
    Lanes a = x, b = y, c = theta, d{};
    transpose(a, b, c, d);
    store(a, motion);
    store(b, motion + 4);
    store(c, motion + 8);
    store(d, motion + 12);
  } else {
    const Lanes even = __builtin_shufflevector(x, y, 0, 4, 2, 6), odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
    store(__builtin_shufflevector(even, odd, 0, 1, 4, 5), motion);
    store(__builtin_shufflevector(even, odd, 2, 3, 6, 7), motion + 4);
  }
}

/// Resultant force and moment on the discs of a group.
struct Resultant {
  Lanes x{}, y{}, moment{};
};

/// Sums of discs over their contacts. Equal springs are factored out of the sums: with d = u_j - u_i, l the branch, the
/// contact in its middle, and e the relative motion of the two bodies there (Abe 1996 (1)-(5): dn = n.d, ds = s.e, n.d
/// = n.e),
///   force on i = kN dn n + kT ds s = kT sum e + (kN - kT) sum (n.d) n,   moment on i = kT/2 sum l x e.
/// Where springs differ, x, y and moment are the resultant itself.
struct ContactSums {
  Lanes x{}, y{}, moment{};      ///< of e, and of l x e
  Lanes normal_x{}, normal_y{};  ///< of (n.d) n
};

/// Add one slot whose contacts have equal springs.
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE void add_equal(const double* geometry, const Lanes& dx, const Lanes& dy, const Lanes& theta_i,
                                     const Lanes& theta_j, ContactSums& sum) {
  const Lanes lx = load<Lanes>(geometry), ly = load<Lanes>(geometry + 4), over_square = load<Lanes>(geometry + 8);
  const Lanes normal = over_square * (lx * dx + ly * dy);
  sum.normal_x += normal * lx;
  sum.normal_y += normal * ly;
  if constexpr (kind.springs == LoopKind::Springs::rotation) {
    const Lanes turn = 0.5 * (theta_i + theta_j), ex = dx + turn * ly, ey = dy - turn * lx;
    sum.x += ex;
    sum.y += ey;
    sum.moment += lx * ey - ly * ex;
  } else if constexpr (kind.springs == LoopKind::Springs::tangential) {
    sum.x += dx;
    sum.y += dy;
  }
}

/// Add one slot whose contacts have springs of their own, lanes of kN, kT and kM at `springs`: F on i = kN dn n + kT
/// ds s, moment kT r_i ds + kM (theta_j - theta_i).
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE void add_own(const double* geometry, const double* springs, const Lanes& dx, const Lanes& dy,
                                   const Lanes& theta_i, const Lanes& theta_j, ContactSums& sum) {
  const Lanes nx = load<Lanes>(geometry), ny = load<Lanes>(geometry + 4), kn = load<Lanes>(springs);
  const Lanes normal = kn * (nx * dx + ny * dy);
  sum.x += normal * nx;
  sum.y += normal * ny;
  if constexpr (kind.springs != LoopKind::Springs::normal) {
    const Lanes lever_i = load<Lanes>(geometry + 8), lever_j = load<Lanes>(geometry + 12),
                kt = load<Lanes>(springs + 4);
    Lanes slip = nx * dy - ny * dx;
    if constexpr (kind.springs == LoopKind::Springs::rotation) slip -= lever_i * theta_i + lever_j * theta_j;
    const Lanes shear = kt * slip;
    sum.x -= shear * ny;
    sum.y += shear * nx;
    if constexpr (kind.springs == LoopKind::Springs::rotation) sum.moment += lever_i * shear;
  }
  if constexpr (kind.bending) {
    const Lanes km = load<Lanes>(springs + 8);
    sum.moment += km * (theta_j - theta_i);
  }
}

/// One slot of springs, or with velocities in place of motions one of dashpots, whose constants lie behind those of the
/// springs.
template <LoopKind kind, bool dashpots>
EQUIDEM_ALWAYS_INLINE void add_contact(const double* geometry, const Lanes& dx, const Lanes& dy, const Lanes& theta_i,
                                       const Lanes& theta_j, ContactSums& sum) {
  if constexpr (kind.equal_contacts) {
    add_equal<kind>(geometry, dx, dy, theta_i, theta_j, sum);
  } else {
    add_own<kind>(geometry, geometry + (!dashpots ? 16 : kind.bending ? 28 : 24), dx, dy, theta_i, theta_j, sum);
  }
}

/// \param kN, kT of equal contacts, of springs or of dashpots
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE Resultant resultant_of(const ContactSums& sum, double kN, double kT) {
  if constexpr (!kind.equal_contacts) {
    return {sum.x, sum.y, sum.moment};
  } else if constexpr (kind.springs == LoopKind::Springs::normal) {
    return {kN * sum.normal_x, kN * sum.normal_y, Lanes{}};
  } else {
    const double excess = kN - kT;
    return {kT * sum.x + excess * sum.normal_x, kT * sum.y + excess * sum.normal_y, 0.5 * kT * sum.moment};
  }
}

/// Cundall's non-viscous damping: a share of the resultant acts against the velocity.
EQUIDEM_ALWAYS_INLINE void damp_locally(double alpha, const Lanes& velocity, Lanes& force) {
  const Lanes along = with_sign(alpha * magnitude(force), velocity);
  force -= velocity != 0 ? along : Lanes{};
}

/// Energies dissipated on the discs of a group, by lane.
struct DissipationLanes {
  Lanes mass{}, contact{}, local{};
};

EQUIDEM_ALWAYS_INLINE double sum_of(const Lanes& lanes) {
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

/// The integrator's stage for one group, from the resultant of its springs and, separately, that of its dashpots.
/// Powers are computed with the mean of the velocities before and after, which makes the balance of leapfrog exact.
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE void advance(const LoopData& data, const Stage& stage, int parity, std::int32_t group, Lanes x,
                                   Lanes y, Lanes theta, Resultant force, const Resultant& dashpots,
                                   DissipationLanes& dissipation) {
  using Resistance = LoopKind::Resistance;
  constexpr bool rotation = kind.springs == LoopKind::Springs::rotation;
  constexpr int unknowns = rotation ? 3 : 2, width = rotation ? 4 : 2;
  Lanes inverse_mass{}, inverse_moment{};
  if constexpr (kind.equal_discs) {
    inverse_mass += data.inverse_mass;
    inverse_moment += data.inverse_moment;
  } else {
    const double* at = data.inverse_inertia + static_cast<std::ptrdiff_t>(group) * 8;
    inverse_mass = load<Lanes>(at);
    inverse_moment = load<Lanes>(at + 4);
  }
  double* velocity = data.velocity + static_cast<std::ptrdiff_t>(group) * 4 * unknowns;
  Lanes vx, vy, omega{};
  vx = load<Lanes>(velocity);
  vy = load<Lanes>(velocity + 4);
  if constexpr (rotation) omega = load<Lanes>(velocity + 8);
  const Lanes vx_before = vx, vy_before = vy, omega_before = omega;

  if constexpr (kind.resistance == Resistance::dashpot) {
    force.x += dashpots.x;
    force.y += dashpots.y;
    if constexpr (rotation) force.moment += dashpots.moment;
  }
  [[maybe_unused]] Lanes ax{}, ay{}, spin{}, ax_free{}, ay_free{}, spin_free{};
  if constexpr (kind.resistance == Resistance::none) {
    vx += stage.kick * inverse_mass * force.x;
    vy += stage.kick * inverse_mass * force.y;
    if constexpr (rotation) omega += stage.kick * inverse_moment * force.moment;
  } else {
    ax = inverse_mass * force.x, ay = inverse_mass * force.y, spin = inverse_moment * force.moment;
    ax += data.gravity_x;
    ay += data.gravity_y;
    ax_free = ax, ay_free = ay, spin_free = spin;
    if constexpr (kind.resistance == Resistance::local) {
      damp_locally(data.local_damping, vx, ax);
      damp_locally(data.local_damping, vy, ay);
      if constexpr (rotation) damp_locally(data.local_damping, omega, spin);
    }
    vx = stage.keep * vx + stage.kick * ax;
    vy = stage.keep * vy + stage.kick * ay;
    if constexpr (rotation) omega = stage.keep * omega + stage.kick * spin;
  }
  x += stage.drift * vx;
  y += stage.drift * vy;
  if constexpr (rotation) theta += stage.drift * omega;
  if (stage.drift_before != 0) {
    x += stage.drift_before * vx_before;
    y += stage.drift_before * vy_before;
    if constexpr (rotation) theta += stage.drift_before * omega_before;
  }
  if constexpr (kind.resistance != Resistance::none) {
    const Lanes mx = 0.5 * (vx_before + vx), my = 0.5 * (vy_before + vy), spun = 0.5 * (omega_before + omega);
    Lanes mass{}, moment{};
    if (kind.resistance == Resistance::local || data.mass_damping != 0) {
      mass = inverse_mass > 0 ? 1 / inverse_mass : Lanes{};
      moment = inverse_moment > 0 ? 1 / inverse_moment : Lanes{};
      dissipation.mass += data.mass_damping * stage.duration * (mass * (mx * mx + my * my) + moment * spun * spun);
    }
    if constexpr (kind.resistance == Resistance::local) {
      dissipation.local +=
          stage.duration * (mass * ((ax_free - ax) * mx + (ay_free - ay) * my) + moment * (spin_free - spin) * spun);
    }
    if constexpr (kind.resistance == Resistance::dashpot) {
      dissipation.contact -= stage.duration * (dashpots.x * mx + dashpots.y * my + dashpots.moment * spun);
      double* kept = data.dashpot + static_cast<std::ptrdiff_t>(group) * 4 * unknowns;
      store(dashpots.x, kept);
      store(dashpots.y, kept + 4);
      if constexpr (rotation) store(dashpots.moment, kept + 8);
    }
  }
  store(vx, velocity);
  store(vy, velocity + 4);
  if constexpr (rotation) store(omega, velocity + 8);
  const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(group) * 4 * width;
  store_group<width>(x, y, theta, data.motion[1 - parity] + at);
  if constexpr (kind.resistance == Resistance::dashpot) {
    store_group<width>(vx, vy, omega, data.velocity_at[1 - parity] + at);
  }
}

/// Add the sums of the lanes to those of a range.
EQUIDEM_ALWAYS_INLINE void add_dissipation(const DissipationLanes& lanes, Dissipation& sum) {
  sum.mass += sum_of(lanes.mass);
  sum.contact += sum_of(lanes.contact);
  sum.local += sum_of(lanes.local);
}

template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE void small_motion_step(const LoopData& data_in, const Stage& stage_in, int parity,
                                             std::int32_t begin, std::int32_t end, Dissipation& sum) {
  // Local copies: otherwise the compiler must assume that a store to a velocity may alias these data.
  const LoopData data = data_in;
  const Stage stage = stage_in;
  constexpr bool dashpot = kind.resistance == LoopKind::Resistance::dashpot;
  constexpr int width = kind.springs == LoopKind::Springs::rotation ? 4 : 2, slot = kind.slot_doubles() * 4;
  const double* motion = data.motion[parity];
  DissipationLanes dissipation;
  for (std::int32_t group = begin; group < end; ++group) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(group) * 4 * width;
    Lanes x, y, theta, vx, vy, omega;
    load_group<width>(motion + at, x, y, theta);
    if constexpr (dashpot) load_group<width>(data.velocity_at[parity] + at, vx, vy, omega);
    ContactSums springs, dashpots;
    for (std::int32_t k = data.first[group]; k < data.first[group + 1]; ++k) {
      const std::int32_t* place = data.neighbour + static_cast<std::ptrdiff_t>(k) * 4;
      const double* geometry = data.geometry + static_cast<std::ptrdiff_t>(k) * slot;
      Lanes xj, yj, theta_j;
      gather<width>(motion, place, xj, yj, theta_j);
      add_contact<kind, false>(geometry, xj - x, yj - y, theta, theta_j, springs);
      if constexpr (dashpot) {
        gather<width>(data.velocity_at[parity], place, xj, yj, theta_j);
        add_contact<kind, true>(geometry, xj - vx, yj - vy, omega, theta_j, dashpots);
      }
    }
    advance<kind>(data, stage, parity, group, x, y, theta, resultant_of<kind>(springs, data.kN, data.kT),
                  resultant_of<kind>(dashpots, data.cN, data.cT), dissipation);
  }
  if constexpr (kind.resistance != LoopKind::Resistance::none) add_dissipation(dissipation, sum);
}

constexpr double smallest = 1e-300;  // keeps lanes without a contact, where l = l0 = 0, from dividing by zero

/// A slot's contacts at rest.
struct BondAtRest {
  Lanes x, y;    ///< l0
  Lanes square;  ///< l0², 0: no contact
};

EQUIDEM_ALWAYS_INLINE BondAtRest load_bond(const double* geometry) {
  BondAtRest bond;
  bond.x = load<Lanes>(geometry);
  bond.y = load<Lanes>(geometry + 4);
  bond.square = load<Lanes>(geometry + 8);
  return bond;
}

/// Share of body i in the branch: r_i/L, L = r_i + r_j.
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE Lanes share_of(const double* geometry) {
  Lanes share = Lanes{} + 0.5;
  if constexpr (!kind.equal_contacts) share = load<Lanes>(geometry + 16);
  return share;
}

/// Present state of the contacts of a slot.
struct BondNow {
  Lanes x, y;     ///< l
  Lanes stretch;  ///< dn/|l|
  Lanes ratio;    ///< |l0|/|l|
  Lanes slip;     ///< ds/L = psi - theta
  Lanes twist;    ///< theta_j - theta_i, with bending springs
};

/// The law, for any motion d = u_j - u_i: with e = l² - l0² = d.(l0 + l), dn/|l| = e/(|l| (|l| + |l0|)), and psi the
/// angle from l0 to l. \param twist theta_j - theta_i
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE BondNow deform(const double* geometry, const Lanes& dx, const Lanes& dy, const Lanes& theta_i,
                                     const Lanes& twist) {
  const BondAtRest rest = load_bond(geometry);
  BondNow bond;
  bond.x = rest.x + dx;
  bond.y = rest.y + dy;
  const Lanes length = square_root(bond.x * bond.x + bond.y * bond.y), length_at_rest = square_root(rest.square);
  const Lanes lengths = length + length_at_rest, q = 1 / (length * lengths + smallest);
  bond.stretch = (dx * (rest.x + bond.x) + dy * (rest.y + bond.y)) * q;
  bond.ratio = length_at_rest * lengths * q;
  if constexpr (kind.springs != LoopKind::Springs::normal) {
    bond.slip = angle_of(rest.x * bond.x + rest.y * bond.y, rest.x * dy - rest.y * dx);
  }
  if constexpr (kind.springs == LoopKind::Springs::rotation) {
    bond.slip = without_whole_turns(bond.slip - (theta_i + twist - share_of<kind>(geometry) * twist));
  }
  if constexpr (kind.bending) bond.twist = twist;
  return bond;
}

/// A bond relative to body i: with p = l0 turned by theta_i, v = l - p, and m = p.l = l0² + p.v.
struct BondSeen {
  Lanes x, y;     ///< l
  Lanes stretch;  ///< (p.v)/m
  Lanes turn;     ///< (p x v)/m, the tangent of psi - theta_i
  Lanes ratio;    ///< l0²/m
  Lanes twist;    ///< theta_j - theta_i
};

/// \param turn of body i
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE BondSeen see(const double* geometry, const SineVersine<Lanes>& turn, const Lanes& dx,
                                   const Lanes& dy, const Lanes& twist) {
  const BondAtRest rest = load_bond(geometry);
  BondSeen bond;
  Lanes px = rest.x, py = rest.y, vx = dx, vy = dy;
  bond.x = rest.x + dx;
  bond.y = rest.y + dy;
  if constexpr (kind.springs == LoopKind::Springs::rotation) {
    vx = vx + turn.versine * rest.x + turn.sine * rest.y;
    vy = vy + turn.versine * rest.y - turn.sine * rest.x;
    px = bond.x - vx;
    py = bond.y - vy;
  }
  const Lanes along = px * vx + py * vy, over = 1 / (rest.square + (along + smallest));
  bond.stretch = along * over;
  bond.turn = (px * vy - py * vx) * over;
  bond.ratio = rest.square * over;
  bond.twist = twist;
  return bond;
}

/// The law for a neighbour that has turned little relative to body i: with t = tan(psi - theta_i), z = t², and C =
/// 1/sqrt(1 + z) = 1 - z Q(z),
///   |l0|/|l| = (l0²/m) C,   dn/|l| = 1 - |l0|/|l| = (p.v)/m + (l0²/m) z Q,   psi - theta_i = atan t.
/// \param far its signs are set where a lane is too far from rest
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE BondNow deform_little(const double* geometry, const BondSeen& seen, Bits<Lanes>& far) {
  constexpr double near = 1.0 / 64;
  BondNow bond;
  bond.x = seen.x;
  bond.y = seen.y;
  const Lanes z = seen.turn * seen.turn;
  bond.stretch = seen.stretch + seen.ratio * z * small_shortening(z);
  bond.ratio = 1 - bond.stretch;
  Lanes room = near * near - z;
  if constexpr (kind.springs != LoopKind::Springs::normal) bond.slip = small_arctangent(seen.turn, z);
  if constexpr (kind.springs == LoopKind::Springs::rotation) {
    room -= seen.twist * seen.twist;
    if constexpr (kind.equal_contacts) {
      bond.slip -= 0.5 * seen.twist;
    } else {
      bond.slip -= seen.twist - share_of<kind>(geometry) * seen.twist;
    }
  }
  if constexpr (kind.bending) bond.twist = seen.twist;
  far |= bits_of(room) | bits_of(seen.ratio);
  return bond;
}

/// Sums of discs over their contacts: forces f_N n + f_T L/|l| s and moments f_T r_i of stresses f_N and f_T, and those
/// of bending. With
/// equal springs, constants are factored out of the sums (L = |l0|).
struct BondSums {
  Lanes normal_x{}, normal_y{};  ///< f_N n, or dn n
  Lanes across_x{}, across_y{};  ///< f_T L/|l| s, or ds L/|l| s
  Lanes moment{};                ///< f_T r_i, or 2 ds r_i
};

/// Add one slot of springs, or with rates in place of stretch and slip one of dashpots, whose constants lie behind
/// those of the springs. \param stretch dn/|l| \param slip ds/L \param twist theta_j - theta_i, with bending springs
template <LoopKind kind, bool dashpots>
EQUIDEM_ALWAYS_INLINE void add_stress(const double* geometry, const BondNow& bond, Lanes stretch, Lanes slip,
                                      [[maybe_unused]] const Lanes& twist, BondSums& sum) {
  constexpr bool tangential = kind.springs != LoopKind::Springs::normal;
  if constexpr (!kind.equal_contacts) {
    const double* springs = geometry + (!dashpots ? 20 : kind.bending ? 32 : 28);
    const Lanes kn = load<Lanes>(springs), kt = load<Lanes>(springs + 4), levers = load<Lanes>(geometry + 12);
    stretch *= kn;
    if constexpr (tangential) slip *= kt * (levers * levers);
    if constexpr (kind.bending) {
      const Lanes km = load<Lanes>(springs + 8);
      sum.moment += km * twist;
    }
  }
  sum.normal_x += stretch * bond.x;
  sum.normal_y += stretch * bond.y;
  if constexpr (tangential) {
    const Lanes across = slip * (bond.ratio * bond.ratio);
    sum.across_x -= across * bond.y;
    sum.across_y += across * bond.x;
  }
  if constexpr (kind.springs == LoopKind::Springs::rotation) {
    Lanes square = load<Lanes>(geometry + 8);
    if constexpr (!kind.equal_contacts) square *= share_of<kind>(geometry);
    sum.moment += square * slip;
  }
}

/// \param kN, kT of equal contacts, of springs or of dashpots
template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE Resultant resultant_of(const BondSums& sum, double kN, double kT) {
  if constexpr (kind.equal_contacts) {
    return {kN * sum.normal_x + kT * sum.across_x, kN * sum.normal_y + kT * sum.across_y, 0.5 * kT * sum.moment};
  } else {
    return {sum.normal_x + sum.across_x, sum.normal_y + sum.across_y, sum.moment};
  }
}

/// The contacts of one group.
template <LoopKind kind>
struct GroupBonds {
  static constexpr std::int32_t most_seen = 16;
  static constexpr bool rotation = kind.springs == LoopKind::Springs::rotation;
  static constexpr bool dashpot = kind.resistance == LoopKind::Resistance::dashpot;

  const LoopData& data;
  const int parity;
  const std::int32_t first, last;  // slots
  Lanes x, y, theta, vx, vy, omega;
  BondSums springs, dashpots;

  EQUIDEM_ALWAYS_INLINE GroupBonds(const LoopData& data_in, int parity_in, std::int32_t group)
      : data(data_in), parity(parity_in), first(data_in.first[group]), last(data_in.first[group + 1]) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(group) * 4 * kind.width();
    load_group<kind.width()>(data.motion[parity] + at, x, y, theta);
    if constexpr (dashpot) load_group<kind.width()>(data.velocity_at[parity] + at, vx, vy, omega);
  }

  [[nodiscard]] EQUIDEM_ALWAYS_INLINE const double* geometry(std::int32_t slot) const {
    return data.geometry + static_cast<std::ptrdiff_t>(slot) * kind.slot_doubles() * 4;
  }
  [[nodiscard]] EQUIDEM_ALWAYS_INLINE const std::int32_t* places(std::int32_t slot) const {
    return data.neighbour + static_cast<std::ptrdiff_t>(slot) * 4;
  }

  EQUIDEM_ALWAYS_INLINE void add(std::int32_t slot, const BondNow& bond) {
    add_stress<kind, false>(geometry(slot), bond, bond.stretch, bond.slip, bond.twist, springs);
    if constexpr (dashpot) {
      Lanes dx, dy, spin, slip{};
      gather<kind.width()>(data.velocity_at[parity], places(slot), dx, dy, spin);
      dx -= vx;
      dy -= vy;
      const Lanes over_square = 1 / (bond.x * bond.x + bond.y * bond.y + smallest);
      if constexpr (kind.springs != LoopKind::Springs::normal) slip = (bond.x * dy - bond.y * dx) * over_square;
      if constexpr (rotation) slip -= spin + share_of<kind>(geometry(slot)) * (omega - spin);
      const Lanes rate = (bond.x * dx + bond.y * dy) * over_square;
      add_stress<kind, true>(geometry(slot), bond, rate, slip, kind.bending ? spin - omega : Lanes{}, dashpots);
    }
  }

  /// Two passes, each over independent slots, for instruction-level parallelism. \return whether all contacts are near
  /// rest; if not, the sums are invalid
  EQUIDEM_ALWAYS_INLINE bool sum_near() {
    if (last - first > most_seen) return false;
    BondSeen seen[most_seen];
    SineVersine<Lanes> turn;
    if constexpr (rotation) turn = sine_versine(theta);
    for (std::int32_t k = first; k < last; ++k) {
      Lanes xj, yj, theta_j;
      gather<kind.width()>(data.motion[parity], places(k), xj, yj, theta_j);
      seen[k - first] = see<kind>(geometry(k), turn, xj - x, yj - y, theta_j - theta);
    }
    Bits<Lanes> far{};
    for (std::int32_t k = first; k < last; ++k) add(k, deform_little<kind>(geometry(k), seen[k - first], far));
    return (far[0] | far[1] | far[2] | far[3]) >= 0;
  }

  EQUIDEM_ALWAYS_INLINE void sum_far() {
    springs = dashpots = {};
    for (std::int32_t k = first; k < last; ++k) {
      Lanes xj, yj, theta_j;
      gather<kind.width()>(data.motion[parity], places(k), xj, yj, theta_j);
      add(k, deform<kind>(geometry(k), xj - x, yj - y, theta, theta_j - theta));
    }
  }
};

template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE void finite_motion_step(const LoopData& data_in, const Stage& stage_in, int parity,
                                              std::int32_t begin, std::int32_t end, Dissipation& sum) {
  // Copies, as in small_motion_step.
  const LoopData data = data_in;
  const Stage stage = stage_in;
  DissipationLanes dissipation;
  for (std::int32_t group = begin; group < end; ++group) {
    GroupBonds<kind> bonds(data, parity, group);
    if (!bonds.sum_near()) bonds.sum_far();
    advance<kind>(data, stage, parity, group, bonds.x, bonds.y, bonds.theta,
                  resultant_of<kind>(bonds.springs, data.kN, data.kT),
                  resultant_of<kind>(bonds.dashpots, data.cN, data.cT), dissipation);
  }
  if constexpr (kind.resistance != LoopKind::Resistance::none) add_dissipation(dissipation, sum);
}

}  // namespace equidem::lanes
