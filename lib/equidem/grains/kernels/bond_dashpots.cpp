// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dashpots of bonds (contact/finite_bond.hpp).
///
/// The energy that they take in a step is -sum J (v + s (g0 + g)): J their impulses, v the rates at its start, g0 and g
/// what the impulses of others and those of dashpots add to the rates, s the share of all impulses that has acted. A
/// loop over one group after the other knows of each bond d, what the dashpots before it have added, and since
/// impulses that are given one after the other make together sum J g = sum J (2 d + J/m), needs no second pass.
#include <array>

#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/kernels/bond_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

constexpr int terms_of_mean = 14;

/// 1/(k + 1)!, the coefficients of (1 - e^-x)/x in -x.
constexpr auto coefficients_of_mean = [] {
  std::array<double, terms_of_mean> coefficient{};
  double factorial = 1;
  for (int k = 0; k < terms_of_mean; ++k) coefficient[k] = 1 / (factorial *= k + 1);
  return coefficient;
}();

/// (1 - e^-x)/x (Decay::mean) to 1e-15: the series of decay() at y = x/2^doublings <= 1/2, its even powers beside the
/// odd ones, doubled so many times by mean(2 y) = mean(y) (1 - y mean(y)/2).
template <int doublings, class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes mean_by_series(const Lanes& x) {
  const Lanes y = x * (1.0 / (1 << doublings)), square = y * y;
  Lanes even{}, odd{};
  for (std::size_t k = terms_of_mean; k > 0; k -= 2) {
    even = even * square + coefficients_of_mean[k - 2];
    odd = odd * square + coefficients_of_mean[k - 1];
  }
  Lanes mean = even - y * odd;
  for (int k = 0; k < doublings; ++k) mean *= 1 - (y * (0.5 * (1 << k))) * mean;
  return mean;
}

/// Likewise for x <= 1/8: the terms left out are below 1e-16. Short chains of operations: the loop waits for this.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes mean_of_little(const Lanes& x) {
  const auto& c = coefficients_of_mean;
  const Lanes x2 = x * x, x4 = x2 * x2;
  const Lanes low = (c[0] - c[1] * x) + x2 * (c[2] - c[3] * x), high = (c[4] - c[5] * x) + x2 * (c[6] - c[7] * x);
  return low + x4 * (high + x4 * (c[8] - c[9] * x));
}

/// Each lane by its own x alone; longer series only where one is large.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes mean_of_decay(const Lanes& x) {
  const Lanes mean = mean_of_little(x);
  const Bits<Lanes> more = negative(0.125 - x);
  if (!any(more)) return mean;
  const Bits<Lanes> large = negative(2 - x);
  const Lanes by_more = choose(more, mean_by_series<2>(x), mean);
  if (!any(large)) return by_more;
  return choose(large, choose(negative(40 - x), 1 / x, mean_by_series<7>(x)), by_more);
}

struct DashpotKind {
  bool exact = true, rolling = false, cell = false;
  bool alone = false;  ///< no body has two bonds
};

/// Directions of bonds, and of their rates.
template <class Lanes>
struct BondFrames {
  Lanes nx, ny;
  Lanes length, share;  ///< share: length over the sum of the radii
  Lanes normal, tangential, rolling;
};

/// Gains of eight bonds.
template <class Lanes>
struct BondGains {
  Lanes normal, tangential, rolling;
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE BondGains<Lanes> gains_of(const BondFrames<Lanes>& frame,
                                                const Row<Lanes> (&rows)[lanes_of_pairs]) {
  Lanes x, y, rims, spin;
  columns_of(rows, x, y, rims, spin);
  return {x * frame.nx + y * frame.ny, y * frame.nx - x * frame.ny - frame.share * rims, spin};
}

/// Velocities of j against i by that of a deforming cell.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_motion_of_cell(const GrainSystem& system, std::size_t g, BondNow<Lanes>& now) {
  const PackedBonds& packed = system.bonds.packed;
  const Tensor2& gradient = system.cell.gradient;
  Lanes x = now.x, y = now.y;
  if (packed.drifted) {
    const GrainMotion* before = system.bodies.next.data();
    const BondGroup& group = packed.groups[g];
    Row<Lanes> apart[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k)
      apart[k] = load<Row<Lanes>>(&before[group.j[k]]) - load<Row<Lanes>>(&before[group.i[k]]);
    Lanes u, v;
    columns_of(apart, x, y, u, v);
    const Vectors<Lanes> shift = shift_of<Lanes>(system.cell.before, packed.images[g]);
    x += shift.x;
    y += shift.y;
  }
  now.u += gradient.xx * x + gradient.xy * y;
  now.v += gradient.yx * x + gradient.yy * y;
}

template <class Lanes, bool cell>
EQUIDEM_ALWAYS_INLINE BondFrames<Lanes> frames_of(const GrainSystem& system, std::size_t g) {
  const BondGroup& group = system.bonds.packed.groups[g];
  BondNow<Lanes> now = bonds_now<Lanes, true, cell>(system, g);
  if constexpr (cell) {
    if (system.cell.deforms) add_motion_of_cell(system, g, now);
  }
  BondFrames<Lanes> frame;
  frame.length = square_root(now.x * now.x + now.y * now.y);
  frame.share = frame.length * load<Lanes>(group.per_reach);
  const Lanes inverse = 1 / frame.length;
  frame.nx = now.x * inverse;
  frame.ny = now.y * inverse;
  frame.normal = now.u * frame.nx + now.v * frame.ny;
  frame.rolling = now.spin_j - now.spin_i;
  frame.tangential =
      now.v * frame.nx - now.u * frame.ny - frame.length * (now.spin_j - load<Lanes>(group.share) * frame.rolling);
  return frame;
}

/// Add the impulses of springs to those of the bodies of a block, and set what all these change.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void begin_bodies(GrainSystem& system, const BondBatch& batch, bool with_springs) {
  using Numbers = Row<Lanes>;
  PackedBonds& packed = system.bonds.packed;
  BodyImpulse* impulses = system.bodies.impulses.data();
  for (std::size_t n = batch.first_body; n < batch.end_body; ++n) {
    const auto b = static_cast<std::size_t>(packed.bodies[n]);
    auto impulse = load<Numbers>(&impulses[b]);
    if (with_springs) {
      impulse += without_fourth(load<Numbers>(&packed.by_springs[b]));
      store(impulse, &impulses[b]);
    }
    BondedBody& body = packed.bonded[b];
    store(third_twice(impulse) * load<Numbers>(body.weights), body.steady);
    store(Numbers{}, body.given);
  }
}

template <DashpotKind kind>
struct Resist {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, BondBatch& batch);
};

template <DashpotKind kind>
template <class Lanes>
void Resist<kind>::run(GrainSystem& system, BondBatch& batch) {
  PackedBonds& packed = system.bonds.packed;
  const bool verlet = system.options.verlet();
  if (!verlet && system.contacts.near.active && system.friction) {  // else no impulses are along rims
    for (std::size_t n = batch.first_body; n < batch.end_body; ++n) {
      const auto b = static_cast<std::size_t>(packed.bodies[n]);
      turn_rims(system.bodies.impulses[b], system.bodies.constants[b]);
    }
  }
  begin_bodies<Lanes>(system, batch, !packed.springs.empty());
  BondedBody* bodies = packed.bonded.data();
  const double share_acted = verlet ? 0.25 : 0.5;
  const bool deforms = kind.cell && system.cell.deforms;
  Lanes lost{}, nearest = all<Lanes>(1);
  ImageSums<Lanes> here, before;
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    DashpotGroup& dashpot = packed.dashpots[g];
    const BondFrames<Lanes> frame = frames_of<Lanes, kind.cell>(system, g);
    nearest = smaller(frame.share, nearest);
    Row<Lanes> rows[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k)
      rows[k] = between(load<Row<Lanes>>(bodies[group.i[k]].steady), load<Row<Lanes>>(bodies[group.j[k]].steady));
    const BondGains<Lanes> steady = gains_of(frame, rows);
    BondGains<Lanes> earlier{};
    if constexpr (!kind.alone) {
      for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
        const BondedBody &i = bodies[group.i[k]], &j = bodies[group.j[k]];
        rows[k] = between(load<Row<Lanes>>(i.given) * load<Row<Lanes>>(i.weights),
                          load<Row<Lanes>>(j.given) * load<Row<Lanes>>(j.weights));
      }
      earlier = gains_of(frame, rows);
    }
    const auto mass = load<Lanes>(dashpot.mass);
    const Lanes tangential_mass = mass + frame.share * frame.share * load<Lanes>(dashpot.turning);
    const auto across = load<Lanes>(dashpot.tangential);
    Lanes normal, tangential;
    if constexpr (kind.exact) {
      const Lanes mean = mean_of_decay(across * tangential_mass);
      normal = -load<Lanes>(dashpot.normal) * (frame.normal + earlier.normal) -
               load<Lanes>(dashpot.normal_gain) * steady.normal;
      tangential =
          -(across * mean) * (frame.tangential + earlier.tangential) - (1 - mean) / tangential_mass * steady.tangential;
    } else {
      normal = -load<Lanes>(dashpot.normal) * frame.normal;
      tangential = -across * frame.tangential;
    }
    store(normal, dashpot.normal_impulse);
    store(tangential, dashpot.tangential_impulse);
    const auto work = [&](const Lanes& impulse, const Lanes& rate, const Lanes& by_others, const Lanes& by_earlier,
                          const Lanes& inverse_mass) {
      return impulse * (rate + share_acted * (by_others + 2 * by_earlier + inverse_mass * impulse));
    };
    lost -= work(normal, frame.normal, steady.normal, earlier.normal, mass) +
            work(tangential, frame.tangential, steady.tangential, earlier.tangential, tangential_mass);
    const Lanes x = normal * frame.nx - tangential * frame.ny, y = normal * frame.ny + tangential * frame.nx;  // on j
    const Lanes lever_i = frame.length * load<Lanes>(group.share);
    // both rims are pushed the same way round
    Lanes torque_i = lever_i * tangential, torque_j = torque_i - frame.length * tangential;
    if constexpr (kind.rolling) {
      RollingGroup& rolls = packed.rolling[g];
      earlier.rolling += frame.share * tangential * load<Lanes>(rolls.coupling);
      Lanes rolling = -load<Lanes>(rolls.rolling) * frame.rolling;
      if constexpr (kind.exact) {
        rolling -= load<Lanes>(rolls.rolling) * earlier.rolling + load<Lanes>(rolls.rolling_gain) * steady.rolling;
      }
      store(rolling, rolls.impulse);
      lost -= work(rolling, frame.rolling, steady.rolling, earlier.rolling, load<Lanes>(rolls.mass));
      torque_i += rolling;
      torque_j += rolling;
    }
    rows_of(x, y, torque_i, torque_j, rows);
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      subtract(bodies[group.i[k]].given, third_twice(rows[k]));
      add(bodies[group.j[k]].given, fourth_twice(rows[k]));
    }
    if constexpr (kind.cell) {
      if (deforms) {
        const BondImages& images = packed.images[g];
        here.add(x, y, shift_of<Lanes>(system.cell.now, images));
        before.add(x, y, shift_of<Lanes>(system.cell.before, images));
      }
    }
  }
  batch.lost = (verlet ? 0.5 : 1) * add_up(lost);
  take_nearest(nearest, batch);
  batch.here += here.sum();
  batch.before += before.sum();
}

/// In the half kick that opens a step of a Verlet scheme, at the mean rates of which a quarter of all impulses has
/// acted.
template <DashpotKind kind>
struct CountOpening {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, BondBatch& batch);
};

template <DashpotKind kind>
template <class Lanes>
void CountOpening<kind>::run(GrainSystem& system, BondBatch& batch) {
  begin_bodies<Lanes>(system, batch, false);
  const PackedBonds& packed = system.bonds.packed;
  const BondedBody* bodies = packed.bonded.data();
  Lanes lost{}, nearest = all<Lanes>(1);
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    const BondFrames<Lanes> frame = frames_of<Lanes, kind.cell>(system, g);
    nearest = smaller(frame.share, nearest);
    Row<Lanes> rows[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k)
      rows[k] = between(load<Row<Lanes>>(bodies[group.i[k]].steady), load<Row<Lanes>>(bodies[group.j[k]].steady));
    const BondGains<Lanes> gain = gains_of(frame, rows);
    const DashpotGroup& dashpot = packed.dashpots[g];
    lost -= load<Lanes>(dashpot.normal_impulse) * (frame.normal + 0.25 * gain.normal) +
            load<Lanes>(dashpot.tangential_impulse) * (frame.tangential + 0.25 * gain.tangential);
    if constexpr (kind.rolling) lost -= load<Lanes>(packed.rolling[g].impulse) * (frame.rolling + 0.25 * gain.rolling);
  }
  batch.lost = 0.5 * add_up(lost);
  take_nearest(nearest, batch);
}

/// Kernel<kind> for the dashpots of the system.
template <template <DashpotKind> class Kernel, bool exact>
PackedBonds::Loop loop_of(const GrainSystem& system) {
  const auto compiled = []<DashpotKind kind>() { return by_vector_width<Kernel<kind>, GrainSystem&, BondBatch&>(); };
  if (!system.bonds.packed.rolling.empty())
    return system.cell.active ? compiled.template operator()<DashpotKind{exact, true, true}>()
                              : compiled.template operator()<DashpotKind{exact, true, false}>();
  if (!system.cell.active && system.bonds.packed.alone)
    return compiled.template operator()<DashpotKind{exact, false, false, true}>();
  return system.cell.active ? compiled.template operator()<DashpotKind{exact, false, true}>()
                            : compiled.template operator()<DashpotKind{exact, false, false}>();
}

}  // namespace

PackedBonds::Loop dashpot_loop(const GrainSystem& system) {
  if (system.bonds.packed.dashpots.empty()) return nullptr;
  return system.options.bond_step == GrainOptions::BondStep::exact ? loop_of<Resist, true>(system)
                                                                   : loop_of<Resist, false>(system);
}

PackedBonds::Loop opening_loop(const GrainSystem& system) {
  return system.bonds.packed.dashpots.empty() ? nullptr : loop_of<CountOpening, true>(system);
}

}  // namespace equidem
