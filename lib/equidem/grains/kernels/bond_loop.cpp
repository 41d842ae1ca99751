// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/kernels/bond_loop.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "equidem/core/simd.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/respond.hpp"

namespace equidem {
namespace {

using namespace eight;
using LanesOfBonds = PackedBonds::Lanes;

constexpr LanesOfBonds no_bonds = [] {
  LanesOfBonds lanes{};
  lanes.fill(-1);
  return lanes;
}();

bool share_body(const TiedPair& a, const TiedPair& b) {
  return a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j;
}

/// Add groups of the first bonds of some, ascending numbers in `tied`: no body is twice in a group, and seldom in
/// groups that follow one another, which would wait for one another. Bonds of a tile, which stay in the cache, are
/// coloured so that those of a colour share no body, and grouped colour by colour.
/// \param colours_of colours of the bonds of each body as bits; 0
/// \return the number of bonds in the tile
std::size_t add_tile(const std::vector<TiedPair>& tied, std::span<const std::int32_t> bonds,
                     std::vector<std::uint64_t>& colours_of, std::vector<LanesOfBonds>& groups) {
  constexpr std::size_t largest_tile = 512, colours = 64;
  std::vector<std::vector<std::int32_t>> of_colour;
  std::size_t count = 0;
  for (; count < std::min(bonds.size(), largest_tile); ++count) {
    const TiedPair& bond = tied[bonds[count]];
    std::uint64_t &of_i = colours_of[bond.i], &of_j = colours_of[bond.j];
    const auto colour = static_cast<std::size_t>(std::countr_one(of_i | of_j));
    if (colour == colours) break;
    of_i |= std::uint64_t{1} << colour;
    of_j |= std::uint64_t{1} << colour;
    if (colour >= of_colour.size()) of_colour.resize(colour + 1);
    of_colour[colour].push_back(bonds[count]);
  }
  std::vector<std::int32_t> left;
  for (const std::vector<std::int32_t>& same : of_colour) {
    const auto whole = static_cast<std::ptrdiff_t>(same.size() - same.size() % lanes_of_pairs);
    for (auto bond = same.begin(); bond != same.begin() + whole; bond += lanes_of_pairs)
      std::copy_n(bond, lanes_of_pairs, groups.emplace_back().begin());
    left.insert(left.end(), same.begin() + whole, same.end());
  }
  const std::size_t mixed = groups.size();
  for (const std::int32_t bond : left) {
    const auto has_room = [&](const LanesOfBonds& group) {
      return group.back() < 0 && std::ranges::none_of(group, [&](std::int32_t other) {
               return other >= 0 && share_body(tied[other], tied[bond]);
             });
    };
    const auto group = std::find_if(groups.begin() + static_cast<std::ptrdiff_t>(mixed), groups.end(), has_room);
    LanesOfBonds& lanes = group == groups.end() ? groups.emplace_back(no_bonds) : *group;
    *std::ranges::find(lanes, -1) = bond;
  }
  for (const std::int32_t bond : bonds.first(count)) colours_of[tied[bond].i] = colours_of[tied[bond].j] = 0;
  return count;
}

/// Find batches and their groups.
void find_batches(const GrainSystem& system, PackedBonds& packed) {
  const BodyBlocks& blocks = system.bodies.blocks;
  const std::size_t count = blocks.count(), seams = count - 1, even_seams = (seams + 1) / 2;
  packed.first_batch = {0, count, count + even_seams, count + seams, count + seams + 1};
  packed.batches.resize(packed.first_batch.back());
  const auto batch_of = [&](const TiedPair& bond) {
    const std::size_t of_i = blocks.of(static_cast<std::size_t>(bond.i)),
                      of_j = blocks.of(static_cast<std::size_t>(bond.j));
    if (of_i == of_j) return of_i;
    if (of_j > of_i + 1) return count + seams;
    return packed.first_batch[1 + of_i % 2] + of_i / 2;
  };
  const std::vector<TiedPair>& tied = system.bonds.tied;
  std::vector<std::vector<std::int32_t>> bonds_of(packed.batches.size());
  std::vector<char> is_bonded(system.bodies.constants.size());
  for (std::size_t b = 0; b < tied.size(); ++b) {
    bonds_of[batch_of(tied[b])].push_back(static_cast<std::int32_t>(b));
    for (const std::int32_t body : {tied[b].i, tied[b].j})
      if (std::exchange(is_bonded[body], char{1}) != 0) packed.alone = false;
  }
  std::vector<std::uint64_t> colours_of(is_bonded.size());
  for (std::size_t k = 0; k < packed.batches.size(); ++k) {
    BondBatch& batch = packed.batches[k];
    batch.first_group = packed.lanes.size();
    for (std::span<const std::int32_t> rest = bonds_of[k]; !rest.empty();)
      rest = rest.subspan(add_tile(tied, rest, colours_of, packed.lanes));
    batch.end_group = packed.lanes.size();
    batch.first_body = batch.end_body = packed.bodies.size();
    if (k >= count) continue;
    for (std::size_t body = blocks.begin(k); body < blocks.end(k); ++body)
      if (is_bonded[body] != 0) packed.bodies.push_back(static_cast<std::int32_t>(body));
    batch.end_body = packed.bodies.size();
  }
}

/// Call work(lane, bond, holds) for the lanes of a group. \tparam Work holds: whether the bond is the one of the lane
template <class Work>
void each_lane(const GrainSystem& system, std::size_t group, const Work& work) {
  const std::vector<TiedPair>& tied = system.bonds.tied;
  const LanesOfBonds& lanes = system.bonds.packed.lanes[group];
  const auto holds = [&](std::int32_t bond) { return bond >= 0 && !tied[bond].broken; };
  const auto first = std::ranges::find_if(lanes, holds);
  const std::int32_t other = first == lanes.end() ? lanes[0] : *first;
  for (std::size_t lane = 0; lane < lanes_of_pairs; ++lane) {
    const bool own = holds(lanes[lane]);
    work(lane, tied[own ? lanes[lane] : other], own);
  }
}

void write_images(const GrainSystem& system, PackedBonds& packed, std::size_t g) {
  each_lane(system, g, [&](std::size_t lane, const TiedPair& bond, bool) {
    packed.images[g].a[lane] = bond.image.a;
    packed.images[g].b[lane] = bond.image.b;
  });
}

/// Set the constants of a group.
void write_group(const GrainSystem& system, PackedBonds& packed, std::size_t g) {
  each_lane(system, g, [&](std::size_t lane, const TiedPair& bond, bool holds) {
    const GrainBody &i = system.bodies.constants[bond.i], &j = system.bodies.constants[bond.j];
    const double dt = holds ? system.dt() : 0;  // no impulse in no time
    const bool exact = system.options.bond_step == GrainOptions::BondStep::exact;
    BondGroup& group = packed.groups[g];
    group.i[lane] = bond.i;
    group.j[lane] = bond.j;
    group.per_reach[lane] = 1 / (i.radius + j.radius);
    group.share[lane] = bond.share;
    const FiniteBond& of = bond.springs;
    if (!packed.springs.empty()) {
      SpringGroup& spring = packed.springs[g];
      spring.rest_x[lane] = of.branch.x;
      spring.rest_y[lane] = of.branch.y;
      spring.levers[lane] = of.lever_i + of.lever_j;
      spring.angle_i[lane] = bond.angle_i;
      spring.angle_j[lane] = bond.angle_j;
      spring.normal[lane] = of.springs.kN * dt;
      spring.tangential[lane] = of.springs.kT * dt;
      spring.bending[lane] = of.kM * dt;
    }
    if (!packed.strengths.empty()) {
      constexpr double little = 1e-9, never = std::numeric_limits<double>::infinity();
      // what has no strength breaks under no load
      const auto within = [&](double strength) {
        return holds ? (1 - little) * dt * strength - std::numeric_limits<double>::min() : never;
      };
      packed.strengths[g].tension[lane] = within(bond.tension);
      packed.strengths[g].shear[lane] = within(bond.shear);
      packed.strengths[g].per_moment[lane] = moment_to_force(of.springs, of.kM);
    }
    if (packed.dashpots.empty()) return;
    const auto set = [&](double dashpot, double inverse_mass, double& per_rate, double& per_gain) {
      const double mean = exact ? decay(dashpot * inverse_mass * dt).mean : 1;
      per_rate = dashpot * dt * mean;
      per_gain = dashpot > 0 ? (1 - mean) / inverse_mass : 0;
    };
    DashpotGroup& dashpot = packed.dashpots[g];
    dashpot.mass[lane] = i.inverse_mass + j.inverse_mass;
    dashpot.turning[lane] = i.radius * i.radius * i.inverse_moment + j.radius * j.radius * j.inverse_moment;
    set(bond.dashpots.normal, dashpot.mass[lane], dashpot.normal[lane], dashpot.normal_gain[lane]);
    dashpot.tangential[lane] = bond.dashpots.tangential * dt;
    if (packed.rolling.empty()) return;
    RollingGroup& rolling = packed.rolling[g];
    rolling.mass[lane] = i.inverse_moment + j.inverse_moment;
    rolling.coupling[lane] = i.radius * i.inverse_moment - j.radius * j.inverse_moment;
    set(bond.dashpots.rolling, rolling.mass[lane], rolling.rolling[lane], rolling.rolling_gain[lane]);
  });
  if (!packed.images.empty()) write_images(system, packed, g);
}

/// The angle of (x, y), x > 0 in most lanes. By a short polynomial within 1/64 of the direction of x; a lane takes the
/// longer one by its own numbers alone.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes turn_of(const Lanes& x, const Lanes& y) {
  constexpr double near = 1.0 / 64;
  const Lanes t = y / x, z = t * t;
  const Lanes turn = small_arctangent(t, z);
  const Bits<Lanes> far = negative(near * near - z) | negative(x);
  if (!any(far)) return turn;
  return choose(far, angle_of(x, y), turn);
}

EQUIDEM_ALWAYS_INLINE Four two_and_two(const void* first, const void* second, const Four&) {
  return __builtin_shufflevector(load<Two>(first), load<Two>(second), 0, 1, 2, 3);
}
EQUIDEM_ALWAYS_INLINE Twice<Two> two_and_two(const void* first, const void* second, const Twice<Two>&) {
  return {load<Two>(first), load<Two>(second)};
}
/// (x, y, t, t) of a row (x, y, t, u).
EQUIDEM_ALWAYS_INLINE Four third_twice(const Four& row) {
  return __builtin_shufflevector(row, row, 0, 1, 2, 2);
}
EQUIDEM_ALWAYS_INLINE Twice<Two> third_twice(const Twice<Two>& row) {
  return {row.low, __builtin_shufflevector(row.high, row.high, 0, 0)};
}
/// (x, y, u, u) of a row (x, y, t, u).
EQUIDEM_ALWAYS_INLINE Four fourth_twice(const Four& row) {
  return __builtin_shufflevector(row, row, 0, 1, 3, 3);
}
EQUIDEM_ALWAYS_INLINE Twice<Two> fourth_twice(const Twice<Two>& row) {
  return {row.low, __builtin_shufflevector(row.high, row.high, 1, 1)};
}

/// Velocity, speed of the rim and spin of both bodies of a bond, or what these gain, as rates: differences of
/// velocities and spins, sum of the speeds of the rims.
template <class Numbers>
EQUIDEM_ALWAYS_INLINE Numbers between(const Numbers& of_i, const Numbers& of_j) {
  constexpr long long minus = std::numeric_limits<long long>::min();
  alignas(32) constexpr long long difference[4] = {minus, minus, 0, minus};
  return of_j + as<Numbers>(bits_of(of_i) ^ load<Bits<Numbers>>(difference));
}

/// (x, y, t, 0) of a row (x, y, t, u).
template <class Numbers>
EQUIDEM_ALWAYS_INLINE Numbers without_fourth(const Numbers& row) {
  alignas(32) constexpr long long three[4] = {-1, -1, -1, 0};
  return as<Numbers>(bits_of(row) & load<Bits<Numbers>>(three));
}

/// Sum over bonds of their impulses on images times the periods to these (ImageImpulses).
template <class Lanes>
struct ImageSums {
  Vectors<Lanes> a{}, b{};

  EQUIDEM_ALWAYS_INLINE void add(const Lanes& x, const Lanes& y, const PairImages& images) {
    const auto along_a = load<Lanes>(images.a), along_b = load<Lanes>(images.b);
    a = {a.x + x * along_a, a.y + y * along_a};
    b = {b.x + x * along_b, b.y + y * along_b};
  }
  [[nodiscard]] EQUIDEM_ALWAYS_INLINE ImageImpulses sum() const {
    return {{add_up(a.x), add_up(a.y)}, {add_up(b.x), add_up(b.y)}};
  }
};

/// Bonds as they lie and move.
template <class Lanes>
struct BondNow {
  Lanes x, y, u, v;                        ///< branch and its rate
  Lanes spin_i, angle_i, spin_j, angle_j;  ///< where bodies turn
};

/// \tparam turns whether bodies turn \tparam cell whether bonds are with images
template <class Lanes, bool turns, bool cell>
EQUIDEM_ALWAYS_INLINE BondNow<Lanes> bonds_now(const GrainSystem& system, std::size_t g) {
  const BondGroup& group = system.bonds.packed.groups[g];
  const GrainMotion* motions = system.bodies.motions.data();
  Row<Lanes> apart[lanes_of_pairs], angles[lanes_of_pairs];
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const GrainMotion &i = motions[group.i[k]], &j = motions[group.j[k]];
    apart[k] = load<Row<Lanes>>(&j) - load<Row<Lanes>>(&i);  // position and velocity
    if constexpr (turns) angles[k] = two_and_two(&i.spin, &j.spin, Row<Lanes>{});
  }
  BondNow<Lanes> now{};
  columns_of(apart, now.x, now.y, now.u, now.v);
  if constexpr (turns) columns_of(angles, now.spin_i, now.angle_i, now.spin_j, now.angle_j);
  if constexpr (cell) {
    const Vectors<Lanes> shift = shift_of<Lanes>(system.cell.now, system.bonds.packed.images[g]);
    now.x += shift.x;
    now.y += shift.y;
  }
  return now;
}

/// Set BondBatch::nearest.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void take_nearest(const Lanes& nearest, BondBatch& batch) {
  PairLanes least;
  store(nearest, least);
  batch.nearest = *std::min_element(std::begin(least), std::end(least));
}

/// Springs that bonds have; each one those before it, too.
enum class BondSprings { along, across, bending };

struct SpringKind {
  BondSprings springs = BondSprings::along;
  bool strengths = false;
  bool cell = false;
};

template <SpringKind kind>
struct Stretch {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, BondBatch& batch);
};

template <SpringKind kind>
template <class Lanes>
void Stretch<kind>::run(GrainSystem& system, BondBatch& batch) {
  constexpr bool turning = kind.springs != BondSprings::along, bending = kind.springs == BondSprings::bending;
  constexpr double little = 1e-9;  // for the rounding of loads
  PackedBonds& packed = system.bonds.packed;
  BodyImpulse* by_springs = packed.by_springs.data();
  for (std::size_t n = batch.first_body; n < batch.end_body; ++n) by_springs[packed.bodies[n]] = {};
  const bool deforms = kind.cell && system.cell.deforms;
  const double friction = system.bonds.friction;
  Lanes nearest = all<Lanes>(1);
  ImageSums<Lanes> on_images;
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    const SpringGroup& spring = packed.springs[g];
    const BondNow<Lanes> now = bonds_now<Lanes, turning, kind.cell>(system, g);
    const auto rest_x = load<Lanes>(spring.rest_x), rest_y = load<Lanes>(spring.rest_y);
    const auto levers = load<Lanes>(spring.levers);
    const Lanes length = square_root(now.x * now.x + now.y * now.y), lengths = length + levers;
    nearest = smaller(length * load<Lanes>(group.per_reach), nearest);
    const Lanes q = 1 / (length * lengths), inverse = lengths * q;
    const Lanes nx = now.x * inverse, ny = now.y * inverse, dx = now.x - rest_x, dy = now.y - rest_y;
    // |l| - |l0| = (l² - l0²)/(|l| + |l0|)
    const Lanes stretch = (dx * (rest_x + now.x) + dy * (rest_y + now.y)) * (length * q);
    const Lanes normal = load<Lanes>(spring.normal) * stretch;
    Lanes x = normal * nx, y = normal * ny;  // on i
    Lanes tangential{}, moment{};
    Row<Lanes> rows[lanes_of_pairs];
    if constexpr (turning) {
      const Lanes turn = turn_of(rest_x * now.x + rest_y * now.y, rest_x * dy - rest_y * dx);
      const Lanes tilt_i = now.angle_i - load<Lanes>(spring.angle_i),
                  tilt_j = now.angle_j - load<Lanes>(spring.angle_j);
      const auto share_i = load<Lanes>(group.share);
      const Lanes mean = tilt_j + share_i * (tilt_i - tilt_j);
      tangential = load<Lanes>(spring.tangential) * (levers * without_whole_turns(turn - mean));
      const Lanes turned = levers * tangential, across = turned * inverse;
      x -= across * ny;
      y += across * nx;
      Lanes moment_i = share_i * turned, moment_j = turned - moment_i;
      if constexpr (bending) {
        moment = load<Lanes>(spring.bending) * (tilt_j - tilt_i);
        moment_i += moment;
        moment_j -= moment;
      }
      rows_of(x, y, moment_i, -moment_j, rows);
    } else {
      rows_of(x, y, Lanes{}, Lanes{}, rows);
    }
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      add(&by_springs[group.i[k]], turning ? third_twice(rows[k]) : rows[k]);
      subtract(&by_springs[group.j[k]], turning ? fourth_twice(rows[k]) : rows[k]);
    }
    if constexpr (kind.cell) {
      if (deforms) on_images.add(-x, -y, packed.images[g]);
    }
    if constexpr (kind.strengths) {
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
  take_nearest(nearest, batch);
  batch.on_images = on_images.sum();
}

template <BondSprings springs>
PackedBonds::Loop spring_loop_of(bool strengths, bool cell) {
  const auto compiled = []<bool breaks, bool repeats>() {
    return by_vector_width<Stretch<SpringKind{springs, breaks, repeats}>, GrainSystem&, BondBatch&>();
  };
  if (strengths) return cell ? compiled.template operator()<true, true>() : compiled.template operator()<true, false>();
  return cell ? compiled.template operator()<false, true>() : compiled.template operator()<false, false>();
}

/// The loop compiled for the springs of the system; null: it has none.
PackedBonds::Loop spring_loop(const GrainSystem& system) {
  const PackedBonds& packed = system.bonds.packed;
  const bool strengths = !packed.strengths.empty(), cell = system.cell.active;
  const auto any = [&](const auto& has) { return std::ranges::any_of(system.bonds.tied, has); };
  if (packed.springs.empty()) return nullptr;
  if (any([](const TiedPair& bond) { return bond.springs.kM > 0; }))
    return spring_loop_of<BondSprings::bending>(strengths, cell);
  if (any([](const TiedPair& bond) { return bond.springs.springs.kT > 0; }))
    return spring_loop_of<BondSprings::across>(strengths, cell);
  return spring_loop_of<BondSprings::along>(strengths, cell);
}

/// Dashpots: the energy that they take in a step is -sum J (v + s (g0 + g)): J their impulses, v the rates at its
/// start, g0 and g what the impulses of others and those of dashpots add to the rates, s the share of all impulses that
/// has acted. A loop over one group after the other knows of each bond d, what the dashpots before it have added, and
/// since impulses that are given one after the other make together sum J g = sum J (2 d + J/m), needs no second pass.

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
  /// Only count the loss in the half kick that opens a step of a Verlet scheme, by the impulses of the last step, at
  /// the mean rates of which a quarter of all impulses has acted.
  bool opening = false;
  bool exact = true;  ///< else by the rates at the start of the step
  bool rolling = false, cell = false;
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

/// Velocities of j against i by that of a deforming cell. \tparam opening as in DashpotKind: bodies have not drifted
template <bool opening, class Lanes>
EQUIDEM_ALWAYS_INLINE void add_motion_of_cell(const GrainSystem& system, std::size_t g, BondNow<Lanes>& now) {
  const PackedBonds& packed = system.bonds.packed;
  const Tensor2& gradient = system.cell.gradient;
  Lanes x = now.x, y = now.y;
  if constexpr (!opening) {
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

template <DashpotKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE BondFrames<Lanes> frames_of(const GrainSystem& system, std::size_t g) {
  const BondGroup& group = system.bonds.packed.groups[g];
  BondNow<Lanes> now = bonds_now<Lanes, true, kind.cell>(system, g);
  if constexpr (kind.cell) {
    if (system.cell.deforms) add_motion_of_cell<kind.opening>(system, g, now);
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
  if (!verlet && !kind.opening && system.contacts.has(Between::discs) &&
      system.friction) {  // else no impulses are along rims
    for (std::size_t n = batch.first_body; n < batch.end_body; ++n) {
      const auto b = static_cast<std::size_t>(packed.bodies[n]);
      turn_rims(system.bodies.impulses[b], system.bodies.constants[b]);
    }
  }
  begin_bodies<Lanes>(system, batch, !kind.opening && !packed.springs.empty());
  BondedBody* bodies = packed.bonded.data();
  const double share_acted = verlet ? 0.25 : 0.5;
  const bool deforms = kind.cell && system.cell.deforms;
  Lanes lost{}, nearest = all<Lanes>(1);
  ImageSums<Lanes> on_images;
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    DashpotGroup& dashpot = packed.dashpots[g];
    const BondFrames<Lanes> frame = frames_of<kind, Lanes>(system, g);
    nearest = smaller(frame.share, nearest);
    Row<Lanes> rows[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k)
      rows[k] = between(load<Row<Lanes>>(bodies[group.i[k]].steady), load<Row<Lanes>>(bodies[group.j[k]].steady));
    const BondGains<Lanes> steady = gains_of(frame, rows);
    if constexpr (kind.opening) {
      lost -= load<Lanes>(dashpot.normal_impulse) * (frame.normal + 0.25 * steady.normal) +
              load<Lanes>(dashpot.tangential_impulse) * (frame.tangential + 0.25 * steady.tangential);
      if constexpr (kind.rolling)
        lost -= load<Lanes>(packed.rolling[g].impulse) * (frame.rolling + 0.25 * steady.rolling);
      continue;
    }
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
    Lanes normal = -load<Lanes>(dashpot.normal) * frame.normal, tangential = -across * frame.tangential;
    if constexpr (kind.exact) {
      const Lanes mean = mean_of_decay(across * tangential_mass);
      normal = -load<Lanes>(dashpot.normal) * (frame.normal + earlier.normal) -
               load<Lanes>(dashpot.normal_gain) * steady.normal;
      tangential =
          -(across * mean) * (frame.tangential + earlier.tangential) - (1 - mean) / tangential_mass * steady.tangential;
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
      if constexpr (kind.exact)
        rolling -= load<Lanes>(rolls.rolling) * earlier.rolling + load<Lanes>(rolls.rolling_gain) * steady.rolling;
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
      if (deforms) on_images.add(x, y, packed.images[g]);
    }
  }
  batch.lost = (verlet ? 0.5 : 1) * add_up(lost);
  take_nearest(nearest, batch);
  batch.on_images += on_images.sum();
}

/// The loop compiled for the dashpots of the system.
template <bool opening, bool exact>
PackedBonds::Loop dashpot_loop(const GrainSystem& system) {
  const auto compiled = []<bool rolling, bool cell, bool alone>() {
    return by_vector_width<Resist<DashpotKind{opening, exact, rolling, cell, alone}>, GrainSystem&, BondBatch&>();
  };
  const bool cell = system.cell.active;
  if (!system.bonds.packed.rolling.empty())
    return cell ? compiled.template operator()<true, true, false>()
                : compiled.template operator()<true, false, false>();
  if (cell) return compiled.template operator()<false, true, false>();
  return system.bonds.packed.alone ? compiled.template operator()<false, false, true>()
                                   : compiled.template operator()<false, false, false>();
}

struct PlaceOfLane {
  std::size_t group = 0, lane = 0;
};
PlaceOfLane lane_of(const TiedPair& bond) {
  const auto packed = static_cast<std::size_t>(bond.packed);
  return {packed / lanes_of_pairs, packed % lanes_of_pairs};
}

}  // namespace

std::size_t PackedBonds::bytes() const {
  const auto of = [](const auto&... vectors) { return (... + (vectors.capacity() * sizeof(vectors[0]))); };
  return of(lanes, groups, springs, strengths, images, dashpots, rolling, batches, bodies, by_springs, bonded);
}

void pack_bonds(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  std::vector<TiedPair>& tied = system.bonds.tied;
  if (tied.empty()) return;
  find_batches(system, packed);
  const std::size_t groups = packed.lanes.size(), bodies = system.bodies.constants.size();
  const auto resize_if_any = [&](auto& vector, const auto& has) {
    if (std::ranges::any_of(tied, has)) vector.resize(groups);
  };
  packed.groups.resize(groups);
  resize_if_any(packed.springs, [&](const TiedPair& bond) { return bond.has_springs() || system.bonds.breakable; });
  resize_if_any(packed.dashpots, [](const TiedPair& bond) { return bond.has_dashpots(); });
  resize_if_any(packed.rolling, [](const TiedPair& bond) { return bond.dashpots.rolling > 0; });
  if (!packed.springs.empty()) packed.by_springs.resize(bodies);
  if (system.bonds.breakable) packed.strengths.resize(groups);
  if (system.cell.active) packed.images.resize(groups);
  if (!packed.dashpots.empty()) {
    packed.bonded.resize(bodies);
    for (const std::int32_t body : packed.bodies) {
      const GrainBody& of = system.bodies.constants[body];
      const double weights[] = {of.inverse_mass, of.inverse_mass, of.radius * of.inverse_moment, of.inverse_moment};
      std::ranges::copy(weights, packed.bonded[body].weights);
    }
  }
  for (std::size_t g = 0; g < groups; ++g) {
    write_group(system, packed, g);
    for (std::size_t lane = 0; lane < lanes_of_pairs; ++lane)
      if (const std::int32_t bond = packed.lanes[g][lane]; bond >= 0)
        tied[bond].packed = static_cast<std::int32_t>(g * lanes_of_pairs + lane);
  }
  packed.stretch = spring_loop(system);
  if (packed.dashpots.empty()) return;
  const bool exact = system.options.bond_step == GrainOptions::BondStep::exact;
  packed.resist = exact ? dashpot_loop<false, true>(system) : dashpot_loop<false, false>(system);
  packed.count_opening = dashpot_loop<true, true>(system);
}

void pack_again(GrainSystem& system, const TiedPair& bond) {
  take_last_impulse(system, bond, {});
  write_group(system, system.bonds.packed, lane_of(bond).group);
}

void pack_images(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  for (std::size_t g = 0; g < packed.images.size(); ++g) write_images(system, packed, g);
}

BondModes last_impulse(const GrainSystem& system, const TiedPair& bond) {
  const PackedBonds& packed = system.bonds.packed;
  if (packed.dashpots.empty()) return {};
  const auto [group, lane] = lane_of(bond);
  const DashpotGroup& dashpot = packed.dashpots[group];
  return {dashpot.normal_impulse[lane], dashpot.tangential_impulse[lane],
          packed.rolling.empty() ? 0.0 : packed.rolling[group].impulse[lane]};
}

void take_last_impulse(GrainSystem& system, const TiedPair& bond, const BondModes& impulse) {
  PackedBonds& packed = system.bonds.packed;
  if (packed.dashpots.empty()) return;
  const auto [group, lane] = lane_of(bond);
  packed.dashpots[group].normal_impulse[lane] = impulse.normal;
  packed.dashpots[group].tangential_impulse[lane] = impulse.tangential;
  if (!packed.rolling.empty()) packed.rolling[group].impulse[lane] = impulse.rolling;
}

}  // namespace equidem
