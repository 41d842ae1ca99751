// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dashpots of bonds, by the rates that bond_look.cpp found.
///
/// The energy that they take in a step is -sum J (v + s (g0 + g)): J the impulses, v the rates at its start, g0 and g
/// what the impulses of others and of all dashpots add to these, s the share of all impulses that has acted. A loop
/// that steps one group after the other has for each bond d, what the dashpots before it have added, and as g works on
/// itself alone, sum J g = sum J (2 d + J/m).
#include "equidem/contact/viscous_bond.hpp"
#include "equidem/grains/contacts/move_bodies.hpp"
#include "equidem/grains/kernels/bond_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

/// (1 - e^-x)/x (Decay::mean) to 1e-15: the series of decay() at y = x/2^doublings <= 1/2, its even powers beside the
/// odd ones, doubled so many times by mean(2 y) = mean(y) (1 - y mean(y)/2).
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

/// What all impulses but those of dashpots change in the bodies of a block, springs among them.
void begin_bodies(GrainSystem& system, const BondBatch& batch) {
  PackedBonds& packed = system.bonds.packed;
  // in the other cases the loop over contacts has turned rims
  const bool turns_rims = system.contacts.near.active && system.friction && !system.options.verlet();
  for (std::size_t n = batch.first_body; n < batch.end_body; ++n) {
    const auto b = static_cast<std::size_t>(packed.bodies[n]);
    if (turns_rims) turn_rims(system.bodies.impulses[b], system.bodies.constants[b]);
    const BodyImpulse& all = system.bodies.impulses[b];
    BondedBody& body = packed.bonded[b];
    const double impulse[] = {all.impulse.x, all.impulse.y, all.torque, all.torque};
    for (std::size_t k = 0; k < 4; ++k) {
      body.steady[k] = body.weights[k] * impulse[k];
      body.given[k] = 0;
    }
  }
}

struct ResistKind {
  bool exact = true, rolling = false, cell = false;
};

template <ResistKind kind>
struct Resist {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, BondBatch& batch);
};

template <ResistKind kind>
template <class Lanes>
void Resist<kind>::run(GrainSystem& system, BondBatch& batch) {
  begin_bodies(system, batch);
  PackedBonds& packed = system.bonds.packed;
  BondedBody* bodies = packed.bonded.data();
  const bool verlet = system.options.verlet();
  const double share_acted = verlet ? 0.25 : 0.5;
  const bool deforms = kind.cell && system.cell.deforms;
  Lanes lost{};
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    const BondRates& rate = packed.rates[g];
    DashpotGroup& dashpot = packed.dashpots[g];
    Row<Lanes> rows[lanes_of_pairs], given[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      const BondedBody &i = bodies[group.i[k]], &j = bodies[group.j[k]];
      rows[k] = between(load<Row<Lanes>>(i.steady), load<Row<Lanes>>(j.steady));
      given[k] = between(load<Row<Lanes>>(i.given) * load<Row<Lanes>>(i.weights),
                         load<Row<Lanes>>(j.given) * load<Row<Lanes>>(j.weights));
    }
    const BondLanes<Lanes> steady = rates_of<Lanes>(rate, rows);
    BondLanes<Lanes> before = rates_of<Lanes>(rate, given);
    const auto mass = load<Lanes>(dashpot.mass), share = load<Lanes>(rate.share);
    const Lanes tangential_mass = mass + share * share * load<Lanes>(dashpot.turning);
    const auto normal_rate = load<Lanes>(rate.normal), tangential_rate = load<Lanes>(rate.tangential);
    const auto along = load<Lanes>(dashpot.tangential);
    Lanes normal, tangential;
    if constexpr (kind.exact) {
      const Lanes mean = mean_of_decay(along * tangential_mass);
      normal = -load<Lanes>(dashpot.normal) * (normal_rate + before.normal) -
               load<Lanes>(dashpot.normal_gain) * steady.normal;
      tangential =
          -(along * mean) * (tangential_rate + before.tangential) - (1 - mean) / tangential_mass * steady.tangential;
    } else {
      normal = -load<Lanes>(dashpot.normal) * normal_rate;
      tangential = -along * tangential_rate;
    }
    store(normal, dashpot.normal_impulse);
    store(tangential, dashpot.tangential_impulse);
    const auto loss = [&](const Lanes& impulse, const Lanes& rate_now, const Lanes& by_others, const Lanes& by_those,
                          const Lanes& inverse) {
      return impulse * (rate_now + share_acted * (by_others + 2 * by_those + inverse * impulse));
    };
    lost -= loss(normal, normal_rate, steady.normal, before.normal, mass) +
            loss(tangential, tangential_rate, steady.tangential, before.tangential, tangential_mass);
    const auto nx = load<Lanes>(rate.nx), ny = load<Lanes>(rate.ny);
    const Lanes x = normal * nx - tangential * ny, y = normal * ny + tangential * nx;  // on j
    // of both bodies the rim is pushed the same way round
    const Lanes rim = share * tangential;
    Lanes torque_i = rim * load<Lanes>(dashpot.radius_i), torque_j = -rim * load<Lanes>(dashpot.radius_j);
    if constexpr (kind.rolling) {
      RollingGroup& rolls = packed.rolling[g];
      before.rolling += rim * load<Lanes>(rolls.coupling);
      const auto rolling_rate = load<Lanes>(rate.rolling);
      Lanes rolling = -load<Lanes>(rolls.rolling) * rolling_rate;
      if constexpr (kind.exact)
        rolling = -load<Lanes>(rolls.rolling) * (rolling_rate + before.rolling) -
                  load<Lanes>(rolls.rolling_gain) * steady.rolling;
      store(rolling, rolls.impulse);
      lost -= loss(rolling, rolling_rate, steady.rolling, before.rolling, load<Lanes>(rolls.mass));
      torque_i += rolling;
      torque_j += rolling;
    }
    rows_of(x, y, torque_i, torque_j, rows);
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      subtract(bodies[group.i[k]].given, third_twice(rows[k]));
      add(bodies[group.j[k]].given, fourth_twice(rows[k]));
    }
    if constexpr (kind.cell) {
      if (!deforms) continue;
      double on_x[lanes_of_pairs], on_y[lanes_of_pairs];
      store(x, on_x);
      store(y, on_y);
      const BondImages& images = packed.images[g];
      for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
        const Vec2 on_j{on_x[k], on_y[k]};
        batch.here += outer(on_j, images.a[k] * system.cell.now.a + images.b[k] * system.cell.now.b);
        batch.before += outer(on_j, images.a[k] * system.cell.before.a + images.b[k] * system.cell.before.b);
      }
    }
  }
  batch.lost = (verlet ? 0.5 : 1) * add_up(lost);
}

/// In the half kick that opens a step of a Verlet scheme, at the mean rates of which a quarter of all impulses has
/// acted.
template <bool rolling>
struct CountOpening {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, BondBatch& batch);
};

template <bool rolling>
template <class Lanes>
void CountOpening<rolling>::run(GrainSystem& system, BondBatch& batch) {
  begin_bodies(system, batch);
  const PackedBonds& packed = system.bonds.packed;
  const BondedBody* bodies = packed.bonded.data();
  Lanes lost{};
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    const BondRates& rate = packed.rates[g];
    Row<Lanes> rows[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k)
      rows[k] = between(load<Row<Lanes>>(bodies[group.i[k]].steady), load<Row<Lanes>>(bodies[group.j[k]].steady));
    const BondLanes<Lanes> gain = rates_of<Lanes>(rate, rows);
    const DashpotGroup& dashpot = packed.dashpots[g];
    lost -= load<Lanes>(dashpot.normal_impulse) * (load<Lanes>(rate.normal) + 0.25 * gain.normal) +
            load<Lanes>(dashpot.tangential_impulse) * (load<Lanes>(rate.tangential) + 0.25 * gain.tangential);
    if constexpr (rolling)
      lost -= load<Lanes>(packed.rolling[g].impulse) * (load<Lanes>(rate.rolling) + 0.25 * gain.rolling);
  }
  batch.lost = 0.5 * add_up(lost);
}

template <bool exact, bool rolling>
PackedBonds::Loop resist_loop(bool cell) {
  return cell ? by_vector_width<Resist<ResistKind{exact, rolling, true}>, GrainSystem&, BondBatch&>()
              : by_vector_width<Resist<ResistKind{exact, rolling, false}>, GrainSystem&, BondBatch&>();
}

}  // namespace

void choose_bond_loops(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  const bool dashpots = !packed.dashpots.empty(), rolling = !packed.rolling.empty();
  packed.look = look_loop(system, !packed.springs.empty(), dashpots);
  if (!dashpots) return;
  packed.look_at_rates = look_loop(system, false, true);
  const bool exact = system.options.bond_step == GrainOptions::BondStep::exact, cell = system.cell.active;
  packed.resist = exact ? (rolling ? resist_loop<true, true>(cell) : resist_loop<true, false>(cell))
                        : (rolling ? resist_loop<false, true>(cell) : resist_loop<false, false>(cell));
  packed.count_opening = rolling ? by_vector_width<CountOpening<true>, GrainSystem&, BondBatch&>()
                                 : by_vector_width<CountOpening<false>, GrainSystem&, BondBatch&>();
}

}  // namespace equidem
