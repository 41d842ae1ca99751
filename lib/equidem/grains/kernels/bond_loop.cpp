// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/kernels/bond_loop.hpp"

#include <algorithm>
#include <cstddef>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"
#include "equidem/grains/kernels/vector_width.hpp"

namespace equidem {
namespace {

using namespace eight;

static_assert(sizeof(BodyImpulse) == sizeof(Four));

enum class BondTask { resist_exactly, resist_explicitly };

/// Decay::mean to 1e-15: the series of decay() at y = x/2^doublings <= 1/2, its even powers beside the odd ones,
/// doubled so many times by mean(2 y) = mean(y) (1 - y mean(y)/2).
template <int doublings, class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes mean_by_series(const Lanes& x) {
  const Lanes y = x * (1.0 / (1 << doublings)), square = y * y;
  Lanes even{}, odd{};
  double factorial = 1;
  double coefficient[14];
  for (int k = 0; k < 14; ++k) coefficient[k] = 1 / (factorial *= k + 1);
  for (int k = 12; k >= 0; k -= 2) {
    even = even * square + coefficient[k];
    odd = odd * square + coefficient[k + 1];
  }
  Lanes mean = even - y * odd;
  for (int k = 0; k < doublings; ++k) mean *= 1 - (y * (0.5 * (1 << k))) * mean;
  return mean;
}

/// Each lane by its own x alone; a second series only where one is large.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes mean_of_decay(const Lanes& x) {
  Lanes mean = mean_by_series<2>(x);
  const Bits<Lanes> large = negative(2 - x);
  if (any(large)) {
    mean = choose(large, choose(negative(40 - x), 1 / x, mean_by_series<7>(x)), mean);
  }
  return mean;
}

/// Bonds at the start of the step: the way they lie, rates, and what the impulses as they stand add to these.
template <class Lanes>
struct BondLanes {
  Lanes nx, ny, share;  ///< share: levers over radii
  Lanes normal_rate, tangential_rate, normal_gain, tangential_gain;
};

/// Contribution of the present impulses to the rates of bond k: along x, along y, to the speed of the rims by torques
/// and by impulses along them.
template <class Numbers>
EQUIDEM_ALWAYS_INLINE Numbers gain_by_impulses(const BondGroup& group, const BodyImpulse* impulses, std::size_t k) {
  return load<Numbers>(&impulses[group.i[k]]) * load<Numbers>(group.gain_i[k]) +
         load<Numbers>(&impulses[group.j[k]]) * load<Numbers>(group.gain_j[k]);
}

template <class Lanes>
struct BondFrames {
  Lanes nx, ny, share;
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE BondFrames<Lanes> frames_of(const BondGroup& group, const Lanes& bx, const Lanes& by) {
  const Lanes square = bx * bx + by * by;
  const Lanes distance = square_root(square), inverse = distance * (1 / square);
  return {bx * inverse, by * inverse, distance * load<Lanes>(group.per_reach)};
}

template <class Lanes>
EQUIDEM_ALWAYS_INLINE BondLanes<Lanes> look_at(const BondGroup& group, const BodyImpulse* impulses,
                                               const PairBody* bodies) {
  // differences j - i, sums of the speeds of the rims
  constexpr long long minus = std::numeric_limits<long long>::min();
  alignas(64) constexpr long long difference[lanes_of_pairs] = {minus, minus, minus, minus, 0, 0, 0, 0};
  const auto turned = load<Bits<Lanes>>(difference);
  Lanes m[lanes_of_pairs];
  Row<Lanes> row[lanes_of_pairs];
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const auto of_i = load<Lanes>(&bodies[group.i[k]].position.x);
    m[k] = load<Lanes>(&bodies[group.j[k]].position.x) + as<Lanes>(bits_of(of_i) ^ turned);
    row[k] = gain_by_impulses<Row<Lanes>>(group, impulses, k);
  }
  transpose(m);
  const Lanes &u = m[2], &v = m[3], &rims = m[4];
  Lanes gx, gy, by_torque, by_rim;
  columns_of(row, gx, gy, by_torque, by_rim);
  const auto [nx, ny, share] = frames_of(group, m[0], m[1]);
  return {nx,
          ny,
          share,
          u * nx + v * ny,
          v * nx - u * ny - share * rims,
          gx * nx + gy * ny,
          gy * nx - gx * ny - share * (by_torque + by_rim)};
}

/// In the half kick that opens a step of a Verlet scheme, at the mean rates of which a quarter of all impulses has
/// acted.
struct CountOpeningKicks {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system);
};

template <class Lanes>
void CountOpeningKicks::run(GrainSystem& system) {
  const GrainMotion* motions = system.bodies.motions.data();
  const GrainBody* bodies = system.bodies.constants.data();
  const BodyImpulse* impulses = system.bodies.impulses.data();
  Lanes lost{};
  for (const BondGroup& group : system.bonds.packed.groups) {
    Row<Lanes> apart[lanes_of_pairs], gain[lanes_of_pairs];
    PairLanes speeds;
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      const std::int32_t i = group.i[k], j = group.j[k];
      // position and velocity
      apart[k] = load<Row<Lanes>>(&motions[j]) - load<Row<Lanes>>(&motions[i]);
      gain[k] = 0.25 * gain_by_impulses<Row<Lanes>>(group, impulses, k);
      speeds[k] = motions[i].spin * bodies[i].radius + motions[j].spin * bodies[j].radius;
    }
    Lanes bx, by, u, v, gx, gy, by_torque, by_rim;
    columns_of(apart, bx, by, u, v);
    columns_of(gain, gx, gy, by_torque, by_rim);
    const auto [nx, ny, share] = frames_of(group, bx, by);
    u += gx;
    v += gy;
    const Lanes rims = (load<Lanes>(speeds) + by_torque) + by_rim;
    lost -= load<Lanes>(group.normal_impulse) * (u * nx + v * ny) +
            load<Lanes>(group.tangential_impulse) * (v * nx - u * ny - share * rims);
  }
  system.lost.lost_bond += 0.5 * add_up(lost);
}

template <BondTask task>
struct Resist {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system);
};

template <BondTask task>
template <class Lanes>
void Resist<task>::run(GrainSystem& system) {
  const PairBody* seen = system.contacts.near.bodies.data();
  BodyImpulse* impulses = system.bodies.impulses.data();
  const bool verlet = system.options.verlet();
  const double half = verlet ? 0.25 : 0.5;  // share of all impulses of a step that has acted
  Lanes lost{}, nearest = all<Lanes>(1);
  for (BondGroup& group : system.bonds.packed.groups) {
    const BondLanes<Lanes> bond = look_at<Lanes>(group, impulses, seen);
    nearest = smaller(bond.share, nearest);
    const auto mass = load<Lanes>(group.mass), tangential_dashpot = load<Lanes>(group.tangential);
    const Lanes tangential_mass = mass + bond.share * bond.share * load<Lanes>(group.turning);
    Lanes normal = -load<Lanes>(group.normal) * bond.normal_rate, tangential;
    if constexpr (task == BondTask::resist_exactly) {
      const Lanes mean = mean_of_decay(tangential_dashpot * tangential_mass);
      normal -= load<Lanes>(group.normal_gain) * bond.normal_gain;
      tangential =
          -(tangential_dashpot * mean) * bond.tangential_rate - (1 - mean) / tangential_mass * bond.tangential_gain;
    } else {
      tangential = -tangential_dashpot * bond.tangential_rate;
    }
    store(normal, group.normal_impulse);
    store(tangential, group.tangential_impulse);
    lost -= normal * (bond.normal_rate + half * (bond.normal_gain + mass * normal)) +
            tangential * (bond.tangential_rate + half * (bond.tangential_gain + tangential_mass * tangential));
    // of both bodies the rim is pushed the same way round, and its lever is the radius
    const Lanes x = normal * bond.nx - tangential * bond.ny, y = normal * bond.ny + tangential * bond.nx;
    const Lanes rim = bond.share * tangential;
    Row<Lanes> on_i[lanes_of_pairs], on_j[lanes_of_pairs];
    if (verlet) {
      rows_of(x, y, rim * load<Lanes>(group.radius_i), Lanes{}, on_i);
      rows_of(x, y, rim * -load<Lanes>(group.radius_j), Lanes{}, on_j);
    } else {  // the move of bodies turns rims
      rows_of(x, y, Lanes{}, rim, on_i);
      rows_of(x, y, Lanes{}, -rim, on_j);
    }
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      subtract(&impulses[group.i[k]], on_i[k]);
      add(&impulses[group.j[k]], on_j[k]);
    }
  }
  const double sum = add_up(lost);
  PairLanes least;
  store(nearest, least);
  system.lost.lost_bond += verlet ? 0.5 * sum : sum;
  if (*std::min_element(std::begin(least), std::end(least)) <= nearest_centres_of_bonds) refuse_crept_bonds(system);
}

void put_row(const GrainBody& body, double sign, BondGroup::Row& row) {
  const double turn = body.radius * body.inverse_moment;
  const double numbers[] = {sign * body.inverse_mass, sign * body.inverse_mass, turn, body.radius * turn};
  std::copy(std::begin(numbers), std::end(numbers), row);
}

/// Sets lane `from`; lane 0 also sets the others as unused, with its bodies and zero impulse coefficients.
void put(const GrainSystem& system, const TiedPair& bond, BondGroup& group, std::size_t from) {
  const GrainBody& i = system.bodies.constants[static_cast<std::size_t>(bond.i)];
  const GrainBody& j = system.bodies.constants[static_cast<std::size_t>(bond.j)];
  const double dt = system.dt(), inverse_mass = i.inverse_mass + j.inverse_mass;
  const bool exact = system.options.bond_step == GrainOptions::BondStep::exact;
  const double mean = exact ? decay(bond.dashpots.normal * inverse_mass * dt).mean : 1;
  for (std::size_t k = from; k < (from == 0 ? lanes_of_pairs : from + 1); ++k) {
    const bool used = k == from;
    group.i[k] = bond.i;
    group.j[k] = bond.j;
    put_row(i, -1, group.gain_i[k]);
    put_row(j, 1, group.gain_j[k]);
    group.radius_i[k] = i.radius;
    group.radius_j[k] = j.radius;
    group.per_reach[k] = 1 / (i.radius + j.radius);
    group.mass[k] = inverse_mass;
    group.turning[k] = i.radius * i.radius * i.inverse_moment + j.radius * j.radius * j.inverse_moment;
    group.normal[k] = used ? bond.dashpots.normal * dt * mean : 0;
    group.normal_gain[k] = used ? (1 - mean) / inverse_mass : 0;
    group.tangential[k] = used ? bond.dashpots.tangential * dt : 0;
    group.normal_impulse[k] = group.tangential_impulse[k] = 0;
  }
}

}  // namespace

void pack_bonds(GrainSystem& system) {
  std::vector<int> bonds_of(system.bodies.constants.size());
  for (const TiedPair& bond : system.bonds.tied) {
    ++bonds_of[static_cast<std::size_t>(bond.i)];
    ++bonds_of[static_cast<std::size_t>(bond.j)];
  }
  std::int32_t packed = 0;
  for (std::size_t b = 0; b < system.bonds.tied.size(); ++b) {
    TiedPair& bond = system.bonds.tied[b];
    if (bond.has_springs()) system.bonds.packed.sprung.push_back(b);
    if (!bond.has_dashpots()) continue;
    const bool alone =
        bonds_of[static_cast<std::size_t>(bond.i)] == 1 && bonds_of[static_cast<std::size_t>(bond.j)] == 1;
    if (!system.contacts.near.active || !alone || bond.dashpots.rolling > 0 || system.cell.active) {
      system.bonds.packed.one_by_one.push_back(b);
      continue;
    }
    bond.packed = packed++;
    const std::size_t lane = static_cast<std::size_t>(bond.packed) % lanes_of_pairs;
    if (lane == 0) system.bonds.packed.groups.emplace_back();
    put(system, bond, system.bonds.packed.groups.back(), lane);
  }
}

void push_packed_bonds(GrainSystem& system) {
  if (system.bonds.packed.groups.empty()) return;
  if (system.options.bond_step == GrainOptions::BondStep::exact) {
    by_vector_width<Resist<BondTask::resist_exactly>, GrainSystem&>()(system);
  } else {
    by_vector_width<Resist<BondTask::resist_explicitly>, GrainSystem&>()(system);
  }
}

void count_opening_kick_of_packed_bonds(GrainSystem& system) {
  if (system.bonds.packed.groups.empty()) return;
  by_vector_width<CountOpeningKicks, GrainSystem&>()(system);
}

BondModes last_impulse(const GrainSystem& system, const TiedPair& bond) {
  if (bond.packed < 0) return bond.impulse;
  const auto p = static_cast<std::size_t>(bond.packed);
  const BondGroup& group = system.bonds.packed.groups[p / lanes_of_pairs];
  return {group.normal_impulse[p % lanes_of_pairs], group.tangential_impulse[p % lanes_of_pairs], 0};
}

void take_last_impulse(GrainSystem& system, TiedPair& bond, const BondModes& impulse) {
  bond.impulse = impulse;
  if (bond.packed < 0) return;
  const auto p = static_cast<std::size_t>(bond.packed);
  BondGroup& group = system.bonds.packed.groups[p / lanes_of_pairs];
  group.normal_impulse[p % lanes_of_pairs] = impulse.normal;
  group.tangential_impulse[p % lanes_of_pairs] = impulse.tangential;
}

}  // namespace equidem
