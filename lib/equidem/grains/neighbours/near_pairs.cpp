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
  for (const Grain& grain : scene.present()) met[grain.kind] = true;
  for (std::size_t k = 0; k < met.size(); ++k) met[k] = met[k] || !of_walls[k];
  std::vector<const PairProperties*> pairs;
  for (int a = 0; a < scene.kinds; ++a) {
    for (int b = 0; b < scene.kinds; ++b) {
      if (met[a] && met[b]) pairs.push_back(&scene.between(a, b));
    }
  }
  return pairs;
}

NewList<PairBlock> new_list(const GrainSystem& system, PairBlock& block, std::size_t b) {
  block.friction = system.friction;
  block.equal = system.contacts.near.equal;
  block.has_effects = system.has_effects();
  return {block, system.bodies.blocks.end(b), nullptr};
}

/// Set the constants of a new pair, which is apart.
void set_constants(const GrainSystem& system, PairBlock& block, std::size_t p) {
  const std::size_t k = p % lanes_of_pairs;
  const std::int32_t i = block.first(p), j = system.body_of(block.second(p));
  const ContactConstants constants = constants_of(system, i, j);
  const GrainBody &bi = system.bodies.constants[i], &bj = system.bodies.constants[j];
  PairGroup& group = block.groups.back();
  group.reach[k] = bi.radius + bj.radius;
  group.dashpot[k] = constants.dashpot() * system.dt();
  group.half_mobility[k] = 0.5 * (bi.inverse_mass + bj.inverse_mass);
  group.impulse[k] = 0;
  if (block.friction) {
    const double share_i = bi.radius / (bi.radius + bj.radius), share_j = bj.radius / (bi.radius + bj.radius);
    PairSlips& slips = block.slips.back();
    slips.half_turning[k] = 0.5 * (share_i * share_i * bi.inverse_moment + share_j * share_j * bj.inverse_moment);
    slips.dashpot[k] = constants.sliding.dashpot * system.dt();
    slips.stretch[k] = slips.impulse[k] = 0;
  }
  if (block.has_effects)
    block.effects.back().set(k, effects_between(system, i, j, constants.stiffness),
                             {bi.radius, bj.radius, bi.inverse_moment, bj.inverse_moment}, system.dt());
  if (block.equal) return;
  const PairLaw law = law_of(constants);
  PairLaws& laws = block.laws.back();
  laws.stiffness[k] = law.stiffness;
  laws.least[k] = law.least;
  laws.friction[k] = law.friction;
  laws.tangential_stiffness[k] = law.tangential_stiffness;
}

/// Whether a body of a periodic cell is bonded to another one, or to that image of it.
bool is_bonded_image(const GrainSystem& system, std::int32_t i, std::int32_t partner) {
  const std::int32_t j = system.body_of(partner);
  const auto bond = place_of_bond(system.bonds.tied, i, j);
  if (bond == system.bonds.tied.end() || bond->i != i || bond->j != j || bond->broken) return false;
  const PeriodicImage image = system.is_image(partner) ? system.image(partner) : PeriodicImage{};
  return bond->image.a == image.a && bond->image.b == image.b;
}

void find_pairs_of_block(GrainSystem& system, std::size_t b) {
  const NeighbourList& list = *system.contacts.near.outer;
  NearPairs& near = system.contacts.near;
  const BodyBlocks& blocks = system.bodies.blocks;
  PairBlock& block = near.blocks[b];
  NewList<PairBlock> pairs = new_list(system, block, b);
  const bool shapes = !system.shapes.parts.empty();
  std::size_t next_bond = first_bond_from(system.bonds.tied, static_cast<std::int32_t>(blocks.begin(b)));
  for (std::size_t i = blocks.begin(b); i < blocks.end(b); ++i) {
    const Vec2 centre = system.bodies.motions[i].position;
    const double own = system.bodies.constants[i].radius + near.margin + system.range;
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
      const bool is_near = dot(branch, branch) <= far * far;
      const auto first = static_cast<std::int32_t>(i);
      if (!pairs.keep_contact(first, partner) && !pairs.leave(is_near) && is_near)
        set_constants(system, block, pairs.add(first, partner));
    }
  }
  pairs.keep_others();
}

}  // namespace

PairBlock PairBlock::emptied() {
  PairBlock before = std::move(*this);
  *this = {};
  friction = before.friction;
  equal = before.equal;
  make_room(before);
  const std::size_t room = groups.capacity();
  if (friction) slips.reserve(room);
  if (!equal) laws.reserve(room);
  if (!before.records.empty()) records.reserve(room);
  return before;
}

void PairBlock::add_group() {
  add_columns();
  std::fill_n(groups.back().reach, lanes_of_pairs, -1.0);
  if (friction) slips.emplace_back();
  if (!equal) laws.emplace_back();
  if (records.capacity() > 0) records.emplace_back();
}

void PairBlock::copy(const PairBlock& other, std::size_t from, std::size_t to) {
  constexpr std::size_t numbers = sizeof(ContactGroup) / sizeof(PairLanes) - 1;  // and the first step
  const std::size_t g = from / lanes_of_pairs, k = from % lanes_of_pairs, lane = to % lanes_of_pairs;
  copy_lane(other.groups[g], k, group(to), lane, numbers);
  if (friction) copy_lane(other.slips[g], k, slips[to / lanes_of_pairs], lane);
  if (!equal) copy_lane(other.laws[g], k, laws[to / lanes_of_pairs], lane);
  copy_effects(other, from, to);
  if (!records.empty()) copy_lane(other.records[g], k, records[to / lanes_of_pairs], lane);
}

std::size_t PairBlock::bytes() const {
  return GroupList::bytes() + slips.capacity() * sizeof(PairSlips) + laws.capacity() * sizeof(PairLaws) +
         records.capacity() * sizeof(PairRecords);
}

std::size_t NearPairs::bytes() const {
  std::size_t sum = bodies.capacity() * sizeof(PairBody);
  for (const PairBlock& block : blocks) sum += block.bytes();
  return sum;
}

std::optional<PairLaw> common_law(const GrainSystem& system) {
  const std::vector<const PairProperties*> pairs = pairs_of_grains(system.scene);
  const bool equal = std::all_of(pairs.begin(), pairs.end(), [&](const PairProperties* pair) {
    const bool plain = pair->stiffness > 0 && (!system.friction || pair->friction > 0);
    return plain && *pair == *pairs[0];
  });
  if (!equal || system.has_effects() || system.bodies.constants.size() < 2) return {};
  return law_of(constants_of(system, 0, 1));
}

double margin_of_near_pairs(const GrainSystem& system, double size, double reach) {
  const double wanted = std::max({least_margin * size, margin_of_mean * std::sqrt(reach * size), 4 * reach});
  return std::min(wanted, system.contacts.margin);
}

void prepare_near_pairs(GrainSystem& system) {
  NearPairs& near = system.contacts.near;
  const bool discs =
      std::ranges::any_of(system.scene.present(), [](const Grain& grain) { return grain.shape() == GrainShape::disc; });
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

void find_near_pairs_of(GrainSystem& system, std::vector<std::size_t> blocks) {
  std::ranges::sort(blocks);
  const auto twice = std::ranges::unique(blocks);
  blocks.erase(twice.begin(), twice.end());
  for (const std::size_t block : blocks) find_pairs_of_block(system, block);
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
      const double range = block.has_effects ? block.effects_of(p).range[p % lanes_of_pairs] : 0;
      if (!(geometry_of_grains(system.bodies.constants[i], system.bodies.constants[j], branch).overlap > -range))
        continue;
      block.since(p) = system.step + (verlet ? 0 : 1);
      ++system.counters.contacts;
    }
  }
}

ContactState state_of(const GrainSystem& system, const PairBlock& block, std::size_t p) {
  const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
  ContactState state{.i = block.first(p), .j = block.second(p), .steps = system.step + 1 - block.since(p)};
  state.impulse = block.groups[g].impulse[k];
  if (system.friction) {
    state.stretch = block.slips[g].stretch[k];
    state.tangential_impulse = block.slips[g].impulse[k];
  }
  if (block.has_effects) state.set_effects(block.effects[g], k);
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

std::pair<double, double> effects_of_near_pairs(const GrainSystem& system) {
  const std::vector<PairBlock>& blocks = system.contacts.near.blocks;
  if (blocks.empty() || !system.has_effects()) return {};
  const auto place_of = [&](std::int32_t j) {
    return system.position_of(j) - system.lag() * system.bodies.motions[system.body_of(j)].velocity;
  };
  return system.bodies.blocks.sum([&](std::size_t b) {
    const PairBlock& block = blocks[b];
    double rolling = 0, cohesion = 0;
    for (std::size_t p = 0; p < block.count; ++p) {
      if (!block.touching(p)) continue;
      const std::size_t k = p % lanes_of_pairs;
      const ContactEffects& effects = block.effects_of(p);
      rolling += effects.elastic(k);
      const double distance = norm(place_of(block.second(p)) - place_of(block.first(p)));
      cohesion -= effects.attraction[k] / system.dt() * (block.group(p).reach[k] - distance + effects.range[k]);
    }
    return std::pair(rolling, cohesion);
  });
}

void take_near_pairs(GrainSystem& system, std::vector<ContactState> contacts) {
  std::ranges::sort(contacts, {}, [](const ContactState& contact) { return std::pair(contact.i, contact.j); });
  const BodyBlocks& blocks = system.bodies.blocks;
  auto contact = contacts.begin();
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    PairBlock& block = system.contacts.near.blocks[b];
    block = {};
    block.records.resize(1);  // that there are some
    NewList<PairBlock> pairs = new_list(system, block, b);
    for (; contact != contacts.end() && blocks.of(static_cast<std::size_t>(contact->i)) == b; ++contact) {
      const std::size_t p = pairs.add(contact->i, contact->j), k = p % lanes_of_pairs;
      set_constants(system, block, p);
      block.since(p) = system.step + 1 - contact->steps;
      block.groups.back().impulse[k] = contact->impulse;
      PairRecords& records = block.records.back();
      records.overlap[k] = contact->overlap;
      records.closing[k] = contact->closing;
      records.normal_x[k] = contact->normal.x;
      records.normal_y[k] = contact->normal.y;
      if (block.has_effects) block.effects.back().set_state(k, contact->rolling_stretch, contact->rolling_impulse);
      if (!system.friction) continue;
      block.slips.back().stretch[k] = contact->stretch;
      block.slips.back().impulse[k] = contact->tangential_impulse;
    }
  }
}

}  // namespace equidem
