// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How bonds lie, move and are stretched at the start of a step.
#include <algorithm>

#include "equidem/grains/kernels/bond_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

/// Springs that bonds have.
enum class BondSprings { none, along, across, bending };

struct LookKind {
  BondSprings springs = BondSprings::none;
  bool strengths = false;  ///< with all springs
  bool rates = false;
  bool cell = false;
};

/// Sum over the images of (x, y) times the way to them.
template <class Lanes>
struct ImageSums {
  Lanes xx{}, xy{}, yx{}, yy{};

  EQUIDEM_ALWAYS_INLINE void add(const Lanes& x, const Lanes& y, const Lanes& shift_x, const Lanes& shift_y) {
    xx += x * shift_x;
    xy += x * shift_y;
    yx += y * shift_x;
    yy += y * shift_y;
  }
  EQUIDEM_ALWAYS_INLINE Tensor2 sum() const { return {add_up(xx), add_up(xy), add_up(yx), add_up(yy)}; }
};

template <class Lanes>
struct Shift {
  Lanes x{}, y{};
};
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Shift<Lanes> shift_of(const Periods& periods, const BondImages& images) {
  const auto a = load<Lanes>(images.a), b = load<Lanes>(images.b);
  return {a * periods.a.x + b * periods.b.x, a * periods.a.y + b * periods.b.y};
}

/// Velocity of j against i by that of a deforming cell.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Shift<Lanes> motion_of_cell(const GrainSystem& system, const BondGroup& group,
                                                  const BondImages& images, Lanes x, Lanes y) {
  const Tensor2& g = system.cell.gradient;
  if (system.bonds.packed.drifted) {
    const GrainMotion* before = system.bodies.next.data();
    Row<Lanes> apart[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k)
      apart[k] = load<Row<Lanes>>(&before[group.j[k]]) - load<Row<Lanes>>(&before[group.i[k]]);
    Lanes u, v;
    columns_of(apart, x, y, u, v);
    const Shift<Lanes> shift = shift_of<Lanes>(system.cell.before, images);
    x += shift.x;
    y += shift.y;
  }
  return {g.xx * x + g.xy * y, g.yx * x + g.yy * y};
}

template <LookKind kind>
struct Look {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, BondBatch& batch);
};

template <LookKind kind>
template <class Lanes>
void Look<kind>::run(GrainSystem& system, BondBatch& batch) {
  constexpr bool sprung = kind.springs != BondSprings::none, turning = kind.springs >= BondSprings::across;
  constexpr bool bending = kind.springs == BondSprings::bending;
  constexpr double little = 1e-9;  // for the rounding of loads
  PackedBonds& packed = system.bonds.packed;
  const GrainMotion* motions = system.bodies.motions.data();
  BodyImpulse* by_springs = packed.by_springs.data();
  const bool deforms = kind.cell && system.cell.deforms;
  [[maybe_unused]] const double friction = packed.friction;
  Lanes nearest = all<Lanes>(1);
  [[maybe_unused]] ImageSums<Lanes> here, before;
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    Row<Lanes> apart[lanes_of_pairs], turns[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      const GrainMotion &i = motions[group.i[k]], &j = motions[group.j[k]];
      apart[k] = load<Row<Lanes>>(&j) - load<Row<Lanes>>(&i);  // position and velocity
      if constexpr (turning || kind.rates) turns[k] = two_and_two(&i.spin, &j.spin, Row<Lanes>{});
    }
    Lanes x, y, u, v;
    columns_of(apart, x, y, u, v);
    [[maybe_unused]] Lanes spin_i, theta_i, spin_j, theta_j;
    if constexpr (turning || kind.rates) columns_of(turns, spin_i, theta_i, spin_j, theta_j);
    [[maybe_unused]] Shift<Lanes> shift;
    if constexpr (kind.cell) {
      shift = shift_of<Lanes>(system.cell.now, packed.images[g]);
      x += shift.x;
      y += shift.y;
    }
    const Lanes length = square_root(x * x + y * y);
    const Lanes share = length * load<Lanes>(group.per_reach);
    nearest = smaller(share, nearest);
    [[maybe_unused]] Lanes levers, inverse, stretch;
    if constexpr (sprung) {
      // |l| - |l0| = (l² - l0²)/(|l| + |l0|)
      const SpringGroup& spring = packed.springs[g];
      levers = load<Lanes>(spring.levers);
      const auto rest_x = load<Lanes>(spring.rest_x), rest_y = load<Lanes>(spring.rest_y);
      const Lanes lengths = length + levers, q = 1 / (length * lengths);
      inverse = lengths * q;
      stretch = ((x - rest_x) * (rest_x + x) + (y - rest_y) * (rest_y + y)) * (length * q);
    } else {
      inverse = 1 / length;
    }
    const Lanes nx = x * inverse, ny = y * inverse;
    if constexpr (kind.rates) {
      BondRates& rates = packed.rates[g];
      const DashpotGroup& dashpot = packed.dashpots[g];
      if constexpr (kind.cell) {
        if (deforms) {
          const Shift<Lanes> by_cell = motion_of_cell(system, group, packed.images[g], x, y);
          u += by_cell.x;
          v += by_cell.y;
        }
      }
      const Lanes rims = spin_i * load<Lanes>(dashpot.radius_i) + spin_j * load<Lanes>(dashpot.radius_j);
      store(nx, rates.nx);
      store(ny, rates.ny);
      store(share, rates.share);
      store(u * nx + v * ny, rates.normal);
      store(v * nx - u * ny - share * rims, rates.tangential);
      store(spin_j - spin_i, rates.rolling);
    }
    if constexpr (sprung) {
      const SpringGroup& spring = packed.springs[g];
      const Lanes normal = load<Lanes>(spring.normal) * stretch;
      Lanes on_x = normal * nx, on_y = normal * ny;  // on i
      [[maybe_unused]] Lanes tangential{}, moment{};
      Row<Lanes> rows[lanes_of_pairs];
      if constexpr (turning) {
        const auto rest_x = load<Lanes>(spring.rest_x), rest_y = load<Lanes>(spring.rest_y);
        const Lanes turn = turn_of(rest_x * x + rest_y * y, rest_x * (y - rest_y) - rest_y * (x - rest_x));
        const Lanes tilt_i = theta_i - load<Lanes>(spring.angle_i), tilt_j = theta_j - load<Lanes>(spring.angle_j);
        const auto share_i = load<Lanes>(spring.share);
        const Lanes mean = tilt_j + share_i * (tilt_i - tilt_j);
        tangential = load<Lanes>(spring.tangential) * (levers * lanes::without_whole_turns(turn - mean));
        const Lanes turned = levers * tangential, across = turned * inverse;
        on_x -= across * ny;
        on_y += across * nx;
        Lanes moment_i = share_i * turned, moment_j = turned - moment_i;
        if constexpr (bending) {
          moment = load<Lanes>(spring.bending) * (tilt_j - tilt_i);
          moment_i += moment;
          moment_j -= moment;
        }
        rows_of(on_x, on_y, moment_i, -moment_j, rows);
      } else {
        rows_of(on_x, on_y, Lanes{}, Lanes{}, rows);
      }
      for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
        if constexpr (turning) {
          add(&by_springs[group.i[k]], third_twice(rows[k]));
          subtract(&by_springs[group.j[k]], fourth_twice(rows[k]));
        } else {
          add(&by_springs[group.i[k]], rows[k]);
          subtract(&by_springs[group.j[k]], rows[k]);
        }
      }
      if constexpr (kind.cell) {
        if (deforms) {
          const Shift<Lanes> then = shift_of<Lanes>(system.cell.before, packed.images[g]);
          here.add(-on_x, -on_y, shift.x, shift.y);
          before.add(-on_x, -on_y, then.x, then.y);
        }
      }
      if constexpr (kind.strengths) {
        // bond_breaking.hpp
        const StrengthGroup& strength = packed.strengths[g];
        const Lanes by_moment = magnitude(moment) * load<Lanes>(strength.per_moment);
        const Lanes pulled = normal + by_moment + little * (magnitude(normal) + by_moment);
        const Lanes along = magnitude(tangential);
        const Lanes sheared = along + friction * normal + little * (along + friction * magnitude(normal));
        const Bits<Lanes> reached =
            negative(load<Lanes>(strength.tension) - pulled) | negative(load<Lanes>(strength.shear) - sheared);
        if (any(reached)) batch.reached.push_back(g);
      }
    }
  }
  PairLanes least;
  store(nearest, least);
  batch.nearest = *std::min_element(std::begin(least), std::end(least));
  if constexpr (kind.cell) {
    batch.here += here.sum();
    batch.before += before.sum();
  }
}

template <LookKind kind>
PackedBonds::Loop loop_of() {
  return by_vector_width<Look<kind>, GrainSystem&, BondBatch&>();
}

template <bool rates, bool cell>
PackedBonds::Loop loop_of(BondSprings springs, bool strengths) {
  if (strengths) return loop_of<{.springs = BondSprings::bending, .strengths = true, .rates = rates, .cell = cell}>();
  switch (springs) {
    case BondSprings::along:
      return loop_of<{.springs = BondSprings::along, .rates = rates, .cell = cell}>();
    case BondSprings::across:
      return loop_of<{.springs = BondSprings::across, .rates = rates, .cell = cell}>();
    case BondSprings::bending:
      return loop_of<{.springs = BondSprings::bending, .rates = rates, .cell = cell}>();
    case BondSprings::none:
      break;
  }
  return loop_of<{.rates = rates, .cell = cell}>();
}

BondSprings springs_of(const std::vector<TiedPair>& bonds) {
  BondSprings all = BondSprings::none;
  for (const TiedPair& bond : bonds) {
    const FiniteBond& of = bond.springs;
    all = std::max(all, of.kM > 0           ? BondSprings::bending
                        : of.springs.kT > 0 ? BondSprings::across
                        : of.springs.kN > 0 ? BondSprings::along
                                            : BondSprings::none);
  }
  return all;
}

}  // namespace

PackedBonds::Loop look_loop(const GrainSystem& system, bool springs, bool rates) {
  const PackedBonds& packed = system.bonds.packed;
  const BondSprings of = springs ? springs_of(system.bonds.tied) : BondSprings::none;
  const bool strengths = springs && !packed.strengths.empty(), cell = system.cell.active;
  if (rates) return cell ? loop_of<true, true>(of, strengths) : loop_of<true, false>(of, strengths);
  return cell ? loop_of<false, true>(of, strengths) : loop_of<false, false>(of, strengths);
}

}  // namespace equidem
