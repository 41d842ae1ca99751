// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/neighbours/near_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/neighbours/near_parts.hpp"

namespace equidem {
namespace {

/// Margin of the pairs: of the smallest body; and a multiple of the mean of that and the way in a step, where pairs too
/// many cost as much as lists found anew.
constexpr double least_margin = 0.02, margin_of_mean = 2.5;

PairLaw law_of(const ContactConstants& constants) {
  return {constants.stiffness, constants.least, constants.sliding.coefficient, constants.sliding.stiffness};
}

/// All kinds except those of walls only.
std::vector<const PairProperties*> pairs_of_grains(const GrainScene& scene) {
  std::vector<bool> of_walls(static_cast<std::size_t>(scene.kinds)), met(of_walls);
  for (const Wall& wall : scene.walls) of_walls[wall.kind] = true;
  for (const Grain& grain : scene.grains) met[grain.kind] = true;
  for (std::size_t k = 0; k < met.size(); ++k) met[k] = met[k] || !of_walls[k];
  std::vector<const PairProperties*> pairs;
  for (int a = 0; a < scene.kinds; ++a) {
    for (int b = 0; b < scene.kinds; ++b) {
      if (met[a] && met[b]) pairs.push_back(&scene.between(a, b));
    }
  }
  return pairs;
}

/// The lists of a block as they come to be, from lanes of the lists before and from new pairs.
class PairLists {
 public:
  PairLists(const GrainSystem& system, PairBlock& block, std::size_t end)
      : system_(system),
        near_(block),
        equal_(system.contacts.near.equal),
        end_(static_cast<std::int32_t>(end)),
        groups_(std::move(near_.groups)),
        slips_(std::move(near_.slips)),
        laws_(std::move(near_.laws)),
        records_(std::move(near_.records)),
        count_(near_.count) {
    near_.groups.clear();
    near_.slips.clear();
    near_.laws.clear();
    near_.records.clear();
    near_.outward.clear();
    const std::size_t room = groups_.size() + groups_.size() / 16 + 8;
    near_.groups.reserve(room);
    if (system.friction) near_.slips.reserve(room);
    if (!equal_) near_.laws.reserve(room);
    if (!records_.empty()) near_.records.reserve(room);
    near_.count = 0;
    near_.first_outward = std::numeric_limits<std::size_t>::max();
  }

  /// Pairs of the list before up to (i, j): contacts stay until the loop has seen them end.
  void keep_contacts_before(std::int32_t i, std::int32_t j) {
    for (; at_ < count_ && std::pair(old().i[lane()], old().j[lane()]) < std::pair(i, j); ++at_) {
      if (old().since[lane()] > PairGroup::apart) keep();
    }
  }
  void see(std::int32_t i, std::int32_t j, bool near) {
    keep_contacts_before(i, j);
    if (at_ < count_ && old().i[lane()] == i && old().j[lane()] == j) {
      if (near || old().since[lane()] > PairGroup::apart) keep();
      ++at_;
    } else if (near) {
      add(i, j);
    }
  }
  /// A new pair.
  void add(std::int32_t i, std::int32_t j) {
    const std::int32_t other = system_.body_of(j);
    const ContactConstants constants = constants_of(system_, i, other);
    const std::size_t k = make_room(i, j);
    near_.groups.back().since[k] = PairGroup::apart;
    near_.groups.back().reach[k] = system_.bodies.constants[i].radius + system_.bodies.constants[other].radius;
    near_.groups.back().dashpot[k] = constants.dashpot() * system_.dt();
    const GrainBody &bi = system_.bodies.constants[i], &bj = system_.bodies.constants[other];
    near_.groups.back().half_mobility[k] = 0.5 * (bi.inverse_mass + bj.inverse_mass);
    near_.groups.back().impulse[k] = 0;
    if (system_.friction) {
      const double share_i = bi.radius / (bi.radius + bj.radius), share_j = bj.radius / (bi.radius + bj.radius);
      PairSlips& slips = near_.slips.back();
      slips.half_turning[k] = 0.5 * (share_i * share_i * bi.inverse_moment + share_j * share_j * bj.inverse_moment);
      slips.dashpot[k] = constants.sliding.dashpot * system_.dt();
      slips.stretch[k] = slips.impulse[k] = 0;
    }
    if (!equal_) {
      const PairLaw law = law_of(constants);
      PairLaws& laws = near_.laws.back();
      laws.stiffness[k] = law.stiffness;
      laws.least[k] = law.least;
      laws.friction[k] = law.friction;
      laws.tangential_stiffness[k] = law.tangential_stiffness;
    }
  }

 private:
  [[nodiscard]] const PairGroup& old() const { return groups_[at_ / lanes_of_pairs]; }
  [[nodiscard]] std::size_t lane() const { return at_ % lanes_of_pairs; }

  std::size_t make_room(std::int32_t i, std::int32_t j) {
    const std::size_t k = near_.count % lanes_of_pairs;
    if (k == 0) {
      near_.groups.emplace_back();
      // unused lanes have bodies of this block, to which they give nothing
      std::fill_n(near_.groups.back().i, lanes_of_pairs, i);
      std::fill_n(near_.groups.back().j, lanes_of_pairs, i);
      std::fill_n(near_.groups.back().since, lanes_of_pairs, PairGroup::unused);
      std::fill_n(near_.groups.back().reach, lanes_of_pairs, -1.0);
      if (system_.friction) near_.slips.emplace_back();
      if (!equal_) near_.laws.emplace_back();
      if (!records_.empty()) near_.records.emplace_back();
    }
    ++near_.count;
    near_.groups.back().i[k] = i;
    near_.groups.back().j[k] = j;
    if (j >= end_) {
      near_.first_outward = std::min(near_.first_outward, near_.groups.size() - 1);
      near_.outward.add(j);
    }
    return k;
  }

  void keep() {
    const PairGroup& before = old();
    const std::size_t g = at_ / lanes_of_pairs, from = lane(), to = make_room(before.i[from], before.j[from]);
    PairGroup& group = near_.groups.back();
    group.since[to] = before.since[from];
    copy(before, from, group, to, &PairGroup::reach, &PairGroup::dashpot, &PairGroup::half_mobility,
         &PairGroup::impulse);
    if (system_.friction) {
      copy(slips_[g], from, near_.slips.back(), to, &PairSlips::half_turning, &PairSlips::dashpot, &PairSlips::stretch,
           &PairSlips::impulse);
    }
    if (!equal_) {
      copy(laws_[g], from, near_.laws.back(), to, &PairLaws::stiffness, &PairLaws::least, &PairLaws::friction,
           &PairLaws::tangential_stiffness);
    }
    if (!records_.empty()) {
      copy(records_[g], from, near_.records.back(), to, &PairRecords::overlap, &PairRecords::closing,
           &PairRecords::normal_x, &PairRecords::normal_y);
    }
  }

  /// A lane of columns that both have.
  template <class Group, class... Column>
  static void copy(const Group& group, std::size_t from, Group& to_group, std::size_t to, Column... columns) {
    (((to_group.*columns)[to] = (group.*columns)[from]), ...);
  }

  const GrainSystem& system_;
  PairBlock& near_;
  bool equal_;
  std::int32_t end_;  ///< of the bodies of the block
  LaneVector<PairGroup> groups_;
  LaneVector<PairSlips> slips_;
  LaneVector<PairLaws> laws_;
  LaneVector<PairRecords> records_;
  std::size_t count_, at_ = 0;
};

/// Whether a body of a periodic cell is bonded to another one, or to that image of it.
bool is_bonded_image(const GrainSystem& system, std::int32_t i, std::int32_t partner) {
  const std::int32_t j = system.body_of(partner);
  const auto bond = place_of_bond(system.bonds.tied, i, j);
  if (bond == system.bonds.tied.end() || bond->i != i || bond->j != j) return false;
  const PeriodicImage image = system.is_image(partner) ? system.image(partner) : PeriodicImage{};
  return bond->image.a == image.a && bond->image.b == image.b;
}

void find_pairs_of_block(GrainSystem& system, std::size_t b) {
  const NeighbourList& list = *system.contacts.near.outer;
  NearPairs& near = system.contacts.near;
  const BodyBlocks& blocks = system.bodies.blocks;
  PairLists lists(system, near.blocks[b], blocks.end(b));
  const bool shapes = !system.shapes.parts.empty();
  std::size_t next_bond = first_bond_from(system.bonds.tied, static_cast<std::int32_t>(blocks.begin(b)));
  for (std::size_t i = blocks.begin(b); i < blocks.end(b); ++i) {
    const Vec2 centre = system.bodies.motions[i].position;
    const double own = system.bodies.constants[i].radius + near.margin;
    for (std::int64_t p = list.begin[i]; p < list.begin[i + 1]; ++p) {
      const std::int32_t partner = list.partner[p];
      if (system.cell.active ? is_bonded_image(system, static_cast<std::int32_t>(i), partner)
                             : are_tied(system.bonds.tied, next_bond, static_cast<std::int32_t>(i), partner))
        continue;
      if (shapes && !are_discs(system, static_cast<std::int32_t>(i), partner)) continue;
      const std::int32_t other = system.body_of(partner);
      if (other != partner && other <= static_cast<std::int32_t>(i)) continue;  // listed with the other one, or itself
      const Vec2 branch = system.position_of(partner) - centre;
      const double far = own + system.bodies.constants[other].radius;
      lists.see(static_cast<std::int32_t>(i), partner, dot(branch, branch) <= far * far);
    }
  }
  lists.keep_contacts_before(std::numeric_limits<std::int32_t>::max(), 0);
}

}  // namespace

std::size_t NearPairs::bytes() const {
  std::size_t sum = bodies.capacity() * sizeof(PairBody);
  for (const PairBlock& block : blocks) {
    sum += block.groups.capacity() * sizeof(PairGroup) + block.slips.capacity() * sizeof(PairSlips) +
           block.laws.capacity() * sizeof(PairLaws) + block.records.capacity() * sizeof(PairRecords) +
           block.outward.bytes();
  }
  return sum;
}

std::optional<PairLaw> common_law(const GrainSystem& system) {
  const std::vector<const PairProperties*> pairs = pairs_of_grains(system.scene);
  const bool equal = std::all_of(pairs.begin(), pairs.end(), [&](const PairProperties* pair) {
    const bool plain = pair->stiffness > 0 && (!system.friction || pair->friction > 0);
    return plain && *pair == *pairs[0];
  });
  if (!equal || system.bodies.constants.size() < 2) return {};
  return law_of(constants_of(system, 0, 1));
}

double margin_of_near_pairs(const GrainSystem& system, double size, double reach) {
  const double wanted = std::max({least_margin * size, margin_of_mean * std::sqrt(reach * size), 4 * reach});
  return std::min(wanted, system.contacts.margin);
}

void prepare_near_pairs(GrainSystem& system) {
  NearPairs& near = system.contacts.near;
  const std::vector<Grain>& grains = system.scene.grains;
  const bool discs = std::ranges::any_of(grains, [](const Grain& grain) { return grain.shape() == GrainShape::disc; });
  if (!discs || !gives_force(system.options.law)) return;
  near.active = true;
  if (const std::optional<PairLaw> law = common_law(system)) {
    near.equal = true;
    near.law = *law;
  }
  near.loop = near_pair_loop(system);
  near.bodies.resize(system.bodies.constants.size());
  near.blocks.resize(system.bodies.blocks.count());
  load_pair_bodies(system);
}

void find_near_pairs(GrainSystem& system, double reach) {
  NearPairs& near = system.contacts.near;
  near.margin = margin_of_near_pairs(system, system.smallest_radius, reach);
  near.moved = 0;
  system.bodies.blocks.each([&](std::size_t block) { find_pairs_of_block(system, block); });
  connect_blocks(system);
}

void refresh_near_pairs(GrainSystem& system, double reach) {
  NearPairs& near = system.contacts.near;
  if (2 * (near.moved + reach) > near.margin) find_near_pairs(system, reach);
  near.moved += reach;
}

void load_pair_bodies(GrainSystem& system) {
  for (std::size_t i = 0; i < system.bodies.constants.size(); ++i) {
    const GrainBody& body = system.bodies.constants[i];
    const GrainMotion& motion = system.bodies.motions[i];
    const BodyImpulse& push = system.bodies.impulses[i];
    system.contacts.near.bodies[i] =
        pair_body(body, motion, body.inverse_mass * push.impulse, body.inverse_moment * push.torque);
  }
}

void touch_near_pairs(GrainSystem& system) {
  const bool verlet = system.options.verlet();
  for (PairBlock& block : system.contacts.near.blocks) {
    for (std::size_t p = 0; p < block.count; ++p) {
      const auto i = static_cast<std::size_t>(block.first(p));
      const auto j = static_cast<std::size_t>(system.body_of(block.second(p)));
      const Vec2 branch = system.position_of(block.second(p)) - system.bodies.motions[i].position;
      if (!(geometry_of_grains(system.bodies.constants[i], system.bodies.constants[j], branch).overlap > 0)) continue;
      block.groups[p / lanes_of_pairs].since[p % lanes_of_pairs] = system.step + (verlet ? 0 : 1);
      ++system.counters.contacts;
    }
  }
}

ContactState state_of(const GrainSystem& system, const PairBlock& block, std::size_t p) {
  const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
  ContactState state{.i = block.first(p), .j = block.second(p), .steps = system.step + 1 - block.groups[g].since[k]};
  state.impulse = block.groups[g].impulse[k];
  if (system.friction) {
    state.stretch = block.slips[g].stretch[k];
    state.tangential_impulse = block.slips[g].impulse[k];
  }
  const double radius = system.bodies.constants[state.i].radius, sum = block.groups[g].reach[k];
  if (g < block.records.size()) {
    const PairRecords& records = block.records[g];
    state.overlap = records.overlap[k];
    state.closing = records.closing[k];
    state.normal = {records.normal_x[k], records.normal_y[k]};
  }
  const double distance = sum - state.overlap, lever = radius / sum * distance;
  state.arm_i = lever * state.normal;
  state.arm_j = (lever - distance) * state.normal;
  if (!system.shapes.parts.empty()) {
    state.part_i = system.shapes.first_part[state.i];
    state.part_j = system.shapes.first_part[state.j];
  }
  resolve_image(system, state);
  return state;
}

void take_near_pairs(GrainSystem& system, std::vector<ContactState> contacts) {
  std::ranges::sort(contacts, {}, [](const ContactState& contact) { return std::pair(contact.i, contact.j); });
  const BodyBlocks& blocks = system.bodies.blocks;
  auto contact = contacts.begin();
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    PairBlock& block = system.contacts.near.blocks[b];
    block.groups.clear();
    block.slips.clear();
    block.laws.clear();
    block.count = 0;
    block.records.resize(1);  // that there are some
    PairLists lists(system, block, blocks.end(b));
    for (; contact != contacts.end() && blocks.of(static_cast<std::size_t>(contact->i)) == b; ++contact) {
      lists.add(contact->i, contact->j);
      const std::size_t k = (block.count - 1) % lanes_of_pairs;
      block.groups.back().since[k] = system.step + 1 - contact->steps;
      block.groups.back().impulse[k] = contact->impulse;
      PairRecords& records = block.records.back();
      records.overlap[k] = contact->overlap;
      records.closing[k] = contact->closing;
      records.normal_x[k] = contact->normal.x;
      records.normal_y[k] = contact->normal.y;
      if (!system.friction) continue;
      block.slips.back().stretch[k] = contact->stretch;
      block.slips.back().impulse[k] = contact->tangential_impulse;
    }
  }
}

}  // namespace equidem
