// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/pack_bonds.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "equidem/grains/contacts/bond_breaking.hpp"
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
  [[nodiscard]] const TiedPair& tied(std::int32_t bond) const { return tied_[static_cast<std::size_t>(bond)]; }

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
      if (std::exchange(is_bonded[static_cast<std::size_t>(body)], char{1}) != 0) packed.alone = false;
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
    const GrainBody& i = system_.bodies.constants[static_cast<std::size_t>(bond.i)];
    const GrainBody& j = system_.bodies.constants[static_cast<std::size_t>(bond.j)];
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
    const auto set = [&](double dashpot, double inverse_mass, double& per_rate, double& per_gain) {
      const double mean = decay(dashpot * inverse_mass * dt).mean;
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
      const GrainBody& of = system.bodies.constants[static_cast<std::size_t>(body)];
      const double weights[] = {of.inverse_mass, of.inverse_mass, of.radius * of.inverse_moment, of.inverse_moment};
      std::ranges::copy(weights, packed.bonded[static_cast<std::size_t>(body)].weights);
    }
  }
  GroupWriter writer(system, packed);
  for (std::size_t g = 0; g < groups; ++g) {
    writer.write(g);
    for (std::size_t lane = 0; lane < lanes_of_pairs; ++lane)
      if (const std::int32_t bond = packed.lanes[g][lane]; bond >= 0)
        tied[static_cast<std::size_t>(bond)].packed = static_cast<std::int32_t>(g * lanes_of_pairs + lane);
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
      const PeriodicImage& image =
          system.bonds.tied[static_cast<std::size_t>(bond >= 0 ? bond : packed.lanes[g][0])].image;
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

}  // namespace equidem
