// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/bond_step.hpp"

#include <limits>
#include <numeric>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

using Lanes = PackedBonds::Lanes;

constexpr Lanes unused_lanes = [] {
  Lanes lanes{};
  lanes.fill(-1);
  return lanes;
}();

/// Groups bonds so that no body is twice in a group, and seldom in groups that follow one another, which would wait for
/// one another: bonds of a tile, which stay in the cache, are coloured so that those of a colour share no body, and
/// grouped colour by colour.
class BondGrouping {
 public:
  BondGrouping(const std::vector<TiedPair>& tied, std::size_t bodies, std::vector<Lanes>& groups)
      : tied_(tied), colours_of_(bodies), groups_(groups) {}

  /// Add groups of these bonds, ascending numbers in `tied`.
  void add(const std::vector<std::int32_t>& bonds) {
    for (const std::int32_t bond : bonds) {
      std::uint64_t& of_i = colours_of_[at(tied(bond).i)];
      std::uint64_t& of_j = colours_of_[at(tied(bond).j)];
      if (tile_size_ == largest_tile || (of_i | of_j) == std::numeric_limits<std::uint64_t>::max()) end_tile();
      const auto colour = static_cast<std::size_t>(std::countr_one(of_i | of_j));
      of_i |= std::uint64_t{1} << colour;
      of_j |= std::uint64_t{1} << colour;
      if (colour >= tile_.size()) tile_.resize(colour + 1);
      tile_[colour].push_back(bond);
      ++tile_size_;
    }
    end_tile();
  }

 private:
  static constexpr std::size_t largest_tile = 512;

  static std::size_t at(std::int32_t body) { return static_cast<std::size_t>(body); }
  [[nodiscard]] const TiedPair& tied(std::int32_t bond) const { return tied_[bond]; }

  [[nodiscard]] bool shares_body(const Lanes& group, const TiedPair& bond) const {
    return std::ranges::any_of(group, [&](std::int32_t b) {
      if (b < 0) return false;
      const TiedPair& other = tied(b);
      return other.i == bond.i || other.i == bond.j || other.j == bond.i || other.j == bond.j;
    });
  }

  void end_tile() {
    std::vector<std::int32_t> left;
    for (std::vector<std::int32_t>& bonds : tile_) {
      const std::size_t whole = bonds.size() - bonds.size() % lanes_of_pairs;
      for (std::size_t k = 0; k < whole; k += lanes_of_pairs)
        std::copy_n(bonds.begin() + static_cast<std::ptrdiff_t>(k), lanes_of_pairs, groups_.emplace_back().begin());
      left.insert(left.end(), bonds.begin() + static_cast<std::ptrdiff_t>(whole), bonds.end());
      for (const std::int32_t bond : bonds) colours_of_[at(tied(bond).i)] = colours_of_[at(tied(bond).j)] = 0;
      bonds.clear();
    }
    const std::size_t first = groups_.size();
    for (const std::int32_t bond : left) {
      const auto group = std::find_if(groups_.begin() + static_cast<std::ptrdiff_t>(first), groups_.end(),
                                      [&](const Lanes& g) { return g.back() < 0 && !shares_body(g, tied(bond)); });
      Lanes& lanes = group == groups_.end() ? groups_.emplace_back(unused_lanes) : *group;
      *std::ranges::find(lanes, -1) = bond;
    }
    tile_size_ = 0;
  }

  const std::vector<TiedPair>& tied_;
  std::vector<std::uint64_t> colours_of_;  ///< of each body, the colours of its bonds in the tile as bits
  std::vector<Lanes>& groups_;
  std::vector<std::vector<std::int32_t>> tile_;  ///< bonds of each colour
  std::size_t tile_size_ = 0;
};

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
  BondGrouping grouping(tied, is_bonded.size(), packed.lanes);
  for (std::size_t k = 0; k < packed.batches.size(); ++k) {
    BondBatch& batch = packed.batches[k];
    batch.first_group = packed.lanes.size();
    grouping.add(bonds_of[k]);
    batch.end_group = packed.lanes.size();
    batch.first_body = batch.end_body = packed.bodies.size();
    if (k >= count) continue;
    for (std::size_t body = blocks.begin(k); body < blocks.end(k); ++body)
      if (is_bonded[body] != 0) packed.bodies.push_back(static_cast<std::int32_t>(body));
    batch.end_body = packed.bodies.size();
  }
}

/// Sets the lanes of a group by the bonds of the system.
class GroupWriter {
 public:
  GroupWriter(const GrainSystem& system, PackedBonds& packed) : system_(system), packed_(packed) {}

  void write(std::size_t group) {
    const Lanes& lanes = packed_.lanes[group];
    for (std::size_t lane = 0; lane < lanes_of_pairs; ++lane) {
      const bool used = lanes[lane] >= 0;
      write(static_cast<std::size_t>(used ? lanes[lane] : lanes[0]), used, group, lane);
    }
  }

 private:
  void write(std::size_t number, bool used, std::size_t g, std::size_t lane) {
    const TiedPair& bond = system_.bonds.tied[number];
    const GrainBody& i = system_.bodies.constants[bond.i];
    const GrainBody& j = system_.bodies.constants[bond.j];
    const double dt = system_.dt();
    BondGroup& group = packed_.groups[g];
    group.i[lane] = bond.i;
    group.j[lane] = bond.j;
    group.per_reach[lane] = 1 / (i.radius + j.radius);
    group.share[lane] = bond.share;
    const FiniteBond& of = bond.springs;
    if (!packed_.springs.empty()) {
      SpringGroup& spring = packed_.springs[g];
      spring.rest_x[lane] = of.branch.x;
      spring.rest_y[lane] = of.branch.y;
      spring.levers[lane] = of.lever_i + of.lever_j;
      spring.angle_i[lane] = bond.angle_i;
      spring.angle_j[lane] = bond.angle_j;
      spring.normal[lane] = used ? of.springs.kN * dt : 0;
      spring.tangential[lane] = used ? of.springs.kT * dt : 0;
      spring.bending[lane] = used ? of.kM * dt : 0;
    }
    if (!packed_.strengths.empty()) {
      constexpr double little = 1e-9, never = std::numeric_limits<double>::infinity();
      const BreakableBonds& breakable = *system_.bonds.breakable;
      const auto at = static_cast<std::size_t>(place_of_bond(breakable.all, bond.i, bond.j) - breakable.all.begin());
      // what has no strength breaks under no load
      const auto within = [&](double strength) {
        return used ? (1 - little) * dt * strength - std::numeric_limits<double>::min() : never;
      };
      packed_.strengths[g].tension[lane] = within(breakable.tension[at]);
      packed_.strengths[g].shear[lane] = within(breakable.shear[at]);
      packed_.strengths[g].per_moment[lane] = moment_to_force(of.springs, of.kM);
    }
    if (!packed_.images.empty()) write_image(bond, packed_.images[g], lane);
    if (!packed_.dashpots.empty()) write_dashpots(bond, i, j, used, g, lane);
  }

  static void write_image(const TiedPair& bond, BondImages& images, std::size_t lane) {
    images.a[lane] = bond.image.a;
    images.b[lane] = bond.image.b;
  }

  void write_dashpots(const TiedPair& bond, const GrainBody& i, const GrainBody& j, bool used, std::size_t g,
                      std::size_t lane) {
    const double dt = system_.dt();
    const bool exact = system_.options.bond_step == GrainOptions::BondStep::exact;
    const auto set = [&](double dashpot, double inverse_mass, double& per_rate, double& per_gain) {
      const double mean = exact ? decay(dashpot * inverse_mass * dt).mean : 1;
      per_rate = used ? dashpot * dt * mean : 0;
      per_gain = used && dashpot > 0 ? (1 - mean) / inverse_mass : 0;
    };
    DashpotGroup& dashpot = packed_.dashpots[g];
    dashpot.mass[lane] = i.inverse_mass + j.inverse_mass;
    dashpot.turning[lane] = i.radius * i.radius * i.inverse_moment + j.radius * j.radius * j.inverse_moment;
    set(bond.dashpots.normal, dashpot.mass[lane], dashpot.normal[lane], dashpot.normal_gain[lane]);
    dashpot.tangential[lane] = used ? bond.dashpots.tangential * dt : 0;
    dashpot.normal_impulse[lane] = dashpot.tangential_impulse[lane] = 0;
    if (packed_.rolling.empty()) return;
    RollingGroup& rolling = packed_.rolling[g];
    rolling.mass[lane] = i.inverse_moment + j.inverse_moment;
    rolling.coupling[lane] = i.radius * i.inverse_moment - j.radius * j.inverse_moment;
    set(bond.dashpots.rolling, rolling.mass[lane], rolling.rolling[lane], rolling.rolling_gain[lane]);
    rolling.impulse[lane] = 0;
  }

  const GrainSystem& system_;
  PackedBonds& packed_;
};

}  // namespace

std::size_t PackedBonds::bytes() const {
  const auto of = [](const auto&... vectors) { return (... + (vectors.capacity() * sizeof(vectors[0]))); };
  return of(lanes, groups, springs, strengths, images, dashpots, rolling, batches, bodies, by_springs, bonded);
}

void pack_bonds(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  packed = {};
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
  if (system.bonds.breakable) {
    packed.strengths.resize(groups);
    packed.friction = system.bonds.breakable->friction;
  }
  if (system.cell.active) packed.images.resize(groups);
  if (!packed.dashpots.empty()) {
    packed.bonded.resize(bodies);
    for (const std::int32_t body : packed.bodies) {
      const GrainBody& of = system.bodies.constants[body];
      const double weights[] = {of.inverse_mass, of.inverse_mass, of.radius * of.inverse_moment, of.inverse_moment};
      std::ranges::copy(weights, packed.bonded[body].weights);
    }
  }
  GroupWriter writer(system, packed);
  for (std::size_t g = 0; g < groups; ++g) {
    writer.write(g);
    for (std::size_t lane = 0; lane < lanes_of_pairs; ++lane)
      if (const std::int32_t bond = packed.lanes[g][lane]; bond >= 0)
        tied[bond].packed = static_cast<std::int32_t>(g * lanes_of_pairs + lane);
  }
  packed.stretch = spring_loop(system);
  packed.resist = dashpot_loop(system);
  packed.count_opening = opening_loop(system);
}

void pack_images(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  for (std::size_t g = 0; g < packed.images.size(); ++g) {
    for (std::size_t lane = 0; lane < lanes_of_pairs; ++lane) {
      const std::int32_t bond = packed.lanes[g][lane];
      const PeriodicImage& image = system.bonds.tied[bond >= 0 ? bond : packed.lanes[g][0]].image;
      packed.images[g].a[lane] = image.a;
      packed.images[g].b[lane] = image.b;
    }
  }
}

namespace {

struct PackedPlace {
  std::size_t group = 0, lane = 0;
};
PackedPlace place_in(const TiedPair& bond) {
  const auto packed = static_cast<std::size_t>(bond.packed);
  return {packed / lanes_of_pairs, packed % lanes_of_pairs};
}

}  // namespace

BondModes last_impulse(const GrainSystem& system, const TiedPair& bond) {
  const PackedBonds& packed = system.bonds.packed;
  if (packed.dashpots.empty()) return {};
  const auto [group, lane] = place_in(bond);
  const DashpotGroup& dashpot = packed.dashpots[group];
  return {dashpot.normal_impulse[lane], dashpot.tangential_impulse[lane],
          packed.rolling.empty() ? 0.0 : packed.rolling[group].impulse[lane]};
}

void take_last_impulse(GrainSystem& system, const TiedPair& bond, const BondModes& impulse) {
  PackedBonds& packed = system.bonds.packed;
  if (packed.dashpots.empty()) return;
  const auto [group, lane] = place_in(bond);
  packed.dashpots[group].normal_impulse[lane] = impulse.normal;
  packed.dashpots[group].tangential_impulse[lane] = impulse.tangential;
  if (!packed.rolling.empty()) packed.rolling[group].impulse[lane] = impulse.rolling;
}

BondRest rest_of(const GrainScene& scene, std::size_t i, std::size_t j) {
  const Grain &of_i = scene.grains.at(i), &of_j = scene.grains.at(j);
  Vec2 branch = of_j.position - of_i.position;
  if (scene.cell) {
    const Periods periods = periods_of(*scene.cell);
    branch += periods.shift(image_inside(periods, {}, branch));
  }
  return {branch, of_i.angle, of_j.angle};
}

Vec2 branch_of(const GrainSystem& system, const TiedPair& bond) {
  const Vec2 branch = system.bodies.motions[bond.j].position - system.bodies.motions[bond.i].position;
  return system.cell.active ? branch + system.cell.now.shift(bond.image) : branch;
}

void find_images_of_bonds(GrainSystem& system) {
  if (!system.cell.active) return;
  const auto find = [&](std::vector<TiedPair>& bonds) {
    for (TiedPair& bond : bonds) {
      const Vec2 branch = system.bodies.motions[bond.j].position - system.bodies.motions[bond.i].position;
      bond.image = image_inside(system.cell.now, {}, branch);
    }
  };
  find(system.bonds.tied);
  if (system.bonds.breakable) find(system.bonds.breakable->all);
  pack_images(system);
  system.bonds.packed.state_is_new = true;
}

Tensor2 moment_of_bonds(const GrainSystem& system) {
  Tensor2 sum;
  for (const TiedPair& bond : system.bonds.tied)
    sum += outer((1 / system.dt()) * impulses_of_bond(system, bond)[1].impulse, branch_of(system, bond));
  return sum;
}

namespace {

InverseInertia inverse_of(const Grain& grain) {
  return {1 / grain.inertia.mass, 1 / grain.inertia.moment};
}

ContactFrame frame_of(Vec2 branch, double share) {
  const double distance = norm(branch);
  return {branch / distance, share * distance, distance - share * distance};
}

double share_of(const Grain& i, const Grain& j) {
  return i.radius / (i.radius + j.radius);
}

bool is_wide(const GrainSystem& system, const TiedPair& bond) {
  const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
  const double radii = system.bodies.constants[i].radius + system.bodies.constants[j].radius;
  return norm(branch_of(system, bond)) > nearest_centres_of_bonds * radii;
}

/// Step the batches of each phase on all threads, one phase after the other.
template <class Work>
void each_batch(PackedBonds& packed, const Work& work) {
  for (std::size_t phase = 0; phase < PackedBonds::phases; ++phase) {
    const std::size_t first = packed.first_batch[phase];
    parallel_shares(packed.first_batch[phase + 1] - first,
                    [&](std::size_t k, int) { work(packed.batches[first + k]); });
  }
}

/// Call work(body) for the bonded bodies of each block, on all threads.
template <class Work>
void each_bonded_body(PackedBonds& packed, const Work& work) {
  parallel_shares(packed.first_batch[1], [&](std::size_t k, int) {
    const BondBatch& batch = packed.batches[k];
    for (std::size_t n = batch.first_body; n < batch.end_body; ++n) work(static_cast<std::size_t>(packed.bodies[n]));
  });
}

/// Step all batches by a loop. \throws Error (computation_failed) if centres of bonded discs nearly coincide
void step_batches(GrainSystem& system, PackedBonds::Loop loop) {
  PackedBonds& packed = system.bonds.packed;
  each_batch(packed, [&](BondBatch& batch) { loop(system, batch); });
  for (const BondBatch& batch : packed.batches)
    if (batch.nearest <= nearest_centres_of_bonds) return refuse_crept_bonds(system);
}

void count_losses(GrainSystem& system) {
  for (const BondBatch& batch : system.bonds.packed.batches) system.lost.lost_bond += batch.lost;
}

/// The part of a bond in M^-1 C and M^-1 K of its discs.
struct Rates {
  double rate = 0, square = 0;
};

Rates rates_of(const GrainScene& scene, const GrainBond& bond) {
  const Grain &i = scene.grains[bond.i], &j = scene.grains[bond.j];
  const ContactFrame frame = frame_of((bond.rest ? *bond.rest : rest_of(scene, bond.i, bond.j)).branch, share_of(i, j));
  const auto largest = [&](const BondModes& c) { return largest_bond_rate(c, frame, inverse_of(i), inverse_of(j)); };
  return {largest({bond.normal_dashpot, bond.tangential_dashpot, bond.rolling_dashpot}),
          largest({bond.normal_spring, bond.tangential_spring, bond.bending_spring})};
}

/// Largest sums of the rates at a disc.
Rates largest_rates(const GrainScene& scene) {
  std::vector<Rates> of_grain(scene.grains.size());
  Rates largest;
  for (const GrainBond& bond : scene.bonds) {
    const Rates own = rates_of(scene, bond);
    for (const std::size_t grain : {bond.i, bond.j}) {
      Rates& sum = of_grain[grain];
      sum = {sum.rate + own.rate, sum.square + own.square};
      largest = {std::max(largest.rate, sum.rate), std::max(largest.square, sum.square)};
    }
  }
  return largest;
}

}  // namespace

BondMotion<double> motion_of_bond(const GrainSystem& system, const TiedPair& bond) {
  const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
  const GrainMotion &mi = system.bodies.motions[i], &mj = system.bodies.motions[j];
  const Vec2 way = branch_of(system, bond) - bond.springs.branch;
  return {way.x, way.y, mi.angle - bond.angle_i, mj.angle - bond.angle_j};
}

std::array<BodyImpulse, 2> impulses_of_bond(const GrainSystem& system, const TiedPair& bond) {
  const ContactFrame frame = frame_of(branch_of(system, bond), bond.share);
  const BondModes last = last_impulse(system, bond);
  const BondForces<double> force = bond_forces(bond.springs, motion_of_bond(system, bond));
  const double dt = system.dt();
  const Vec2 on_i = dt * Vec2{force.x, force.y} - last.normal * frame.normal - last.tangential * frame.tangent();
  return {BodyImpulse{on_i, dt * force.moment_i - frame.lever_i * last.tangential - last.rolling},
          BodyImpulse{-on_i, dt * force.moment_j - frame.lever_j * last.tangential + last.rolling}};
}

std::vector<std::size_t> tie_bonds(GrainSystem& system, const GrainScene& scene) {
  std::vector<TiedPair> pairs;
  for (const GrainBond& bond : scene.bonds) {
    TiedPair pair;
    pair.i = system.bodies.place_of_grain[bond.i], pair.j = system.bodies.place_of_grain[bond.j];
    BondRest rest = bond.rest ? *bond.rest : rest_of(scene, bond.i, bond.j);
    if (pair.j < pair.i) {
      std::swap(pair.i, pair.j);
      rest = {-rest.branch, rest.angle_j, rest.angle_i};
    }
    const Grain& i = system.scene.grains[pair.i];
    const Grain& j = system.scene.grains[pair.j];
    pair.dashpots = {bond.normal_dashpot, bond.tangential_dashpot, bond.rolling_dashpot};
    pair.share = share_of(i, j);
    pair.angle_i = rest.angle_i, pair.angle_j = rest.angle_j;
    const ContactFrame frame = frame_of(rest.branch, pair.share);
    pair.springs = {rest.branch,
                    frame.lever_i,
                    frame.lever_j,
                    {.kN = bond.normal_spring, .kT = bond.tangential_spring},
                    bond.bending_spring};
    pairs.push_back(pair);
  }
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t bond) { return std::pair(pairs[bond].i, pairs[bond].j); });
  for (const std::size_t bond : order) system.bonds.tied.push_back(pairs[bond]);
  find_images_of_bonds(system);
  return order;
}

void refuse_crept_bonds(const GrainSystem& system) {
  for (const TiedPair& bond : system.bonds.tied) {
    if (is_wide(system, bond)) continue;
    computation_failed(fmt::format("step {}: the centres of the bonded grains {} and {} have crept together",
                                   system.step, system.bodies.grain_of[bond.i], system.bodies.grain_of[bond.j]),
                       "dashpots alone give way to a steady force, N/C_n, and bonded discs do not collide",
                       "Use larger dashpots, give normal_spring, or tie the discs as a clump");
  }
}

void push_springs(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  for (BondBatch& batch : packed.batches) {
    batch.here = batch.before = {};
    batch.reached.clear();
  }
  packed.state_is_new = false;
  if (packed.stretch) step_batches(system, packed.stretch);
}

void add_bond_impulses(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  std::vector<BodyImpulse>& impulses = system.bodies.impulses;
  if (packed.resist) {
    packed.drifted = true;
    step_batches(system, packed.resist);
    each_bonded_body(packed, [&](std::size_t body) {
      const double* given = packed.bonded[body].given;
      impulses[body].impulse += {given[0], given[1]};
      impulses[body].torque += given[2];
    });
    count_losses(system);
  } else {
    each_bonded_body(packed, [&](std::size_t body) {
      impulses[body].impulse += packed.by_springs[body].impulse;
      impulses[body].torque += packed.by_springs[body].torque;
    });
  }
  for (const BondBatch& batch : packed.batches) {
    system.cell.bond_sums.here += batch.here;
    system.cell.bond_sums.before += batch.before;
  }
}

void count_opening_kick(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  if (!packed.count_opening) return;
  packed.drifted = false;
  step_batches(system, packed.count_opening);
  count_losses(system);
}

double elastic_of_bonds(const GrainSystem& system) {
  double sum = 0;
  for (const TiedPair& bond : system.bonds.tied) {
    if (bond.has_springs()) sum += bond_energy(bond.springs, motion_of_bond(system, bond));
  }
  return sum;
}

std::vector<BodyContact> contacts_of_bonds(const GrainSystem& system) {
  std::vector<BodyContact> result;
  for (const TiedPair& bond : system.bonds.tied) {
    const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
    const ContactFrame frame = frame_of(branch_of(system, bond), bond.share);
    const Vec2 shift = system.cell.active ? system.cell.now.shift(bond.image) : Vec2{};
    const BondModes impulse = last_impulse(system, bond);
    Vec2 on_i = -1 / system.dt() * (impulse.normal * frame.normal + impulse.tangential * frame.tangent());
    double bending = 0;
    if (bond.has_springs()) {
      const BondMotion<double> motion = motion_of_bond(system, bond);
      const BondForces<double> springs = bond_forces(bond.springs, motion);
      on_i += {springs.x, springs.y};
      bending = bending_moment(bond.springs.kM, motion.theta_i, motion.theta_j);
    }
    const bool same = system.bodies.grain_of[i] < system.bodies.grain_of[j];
    const auto first = static_cast<std::int32_t>(system.bodies.grain_of[same ? i : j]),
               second = static_cast<std::int32_t>(system.bodies.grain_of[same ? j : i]);
    result.push_back({.i = first,
                      .j = second,
                      .arm = same ? frame.lever_i * frame.normal : -frame.lever_j * frame.normal,
                      .shift = same ? shift : -shift,
                      .force = same ? on_i : -on_i,
                      .normal_force = dot(on_i, frame.normal),
                      .tangential_force = dot(on_i, frame.tangent()),
                      .bending_moment = same ? bending : -bending});
  }
  std::ranges::sort(result, {}, [](const BodyContact& c) { return std::pair(c.i, c.j); });
  return result;
}

double bond_step_limit(const GrainScene& scene, GrainOptions::BondStep bond_step) {
  if (bond_step == GrainOptions::BondStep::explicit_euler) return explicit_step_limit(scene);
  return bond_step_limit(0, largest_rates(scene).square);
}

double explicit_step_limit(const GrainScene& scene) {
  const Rates largest = largest_rates(scene);
  return bond_step_limit(largest.rate, largest.square);
}

void check_law_of_bonds(const GrainScene& scene, NormalLaw law) {
  if (is_simultaneous(law)) {
    bad_input(fmt::format("bonds are asked for with the law \"{}\"", to_string(law)),
              "it solves all contacts together and knows no bonds", "Use the law linear_dashpot");
  }
  if (scene.strengths && !gives_force(law)) {
    bad_input(fmt::format("bonds that break are asked for with the law \"{}\"", to_string(law)),
              "the discs of a bond that broke may overlap, and the law takes them for an impact",
              "Use the law linear_dashpot");
  }
}

void check_bonds(const GrainScene& scene, const GrainOptions& options) {
  if (scene.bonds.empty()) return;
  check_law_of_bonds(scene, options.law);
  check_bonds(scene);
  const double limit = bond_step_limit(scene, options.bond_step);
  if (options.time_step < limit) return;
  bad_input(fmt::format("the step of {:.6g} s is {:.4g} times the limit of {:.6g} s that the bonds impose",
                        options.time_step, options.time_step / limit, limit),
            "bonded discs would swing ever faster",
            bond_step_limit(scene, GrainOptions::BondStep::exact) > options.time_step
                ? "Stay below it, use smaller dashpots, or make the step of bonds exact, which dashpots do not limit"
                : "Stay below it, or use smaller springs");
}

}  // namespace equidem
