// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/block_step.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace equidem {
namespace {

void collide(GrainSystem& system, Between between, std::size_t block) {
  NearLists& lists = system.contacts.of(between);
  if (lists.active() && lists.blocks[block].count > 0) lists.loop(system, lists.blocks[block], block);
}

void collide_block(GrainSystem& system, std::size_t block, bool clear) {
  const BodyBlocks& blocks = system.bodies.blocks;
  if (clear) {
    BodyImpulse* impulses = system.bodies.impulses.data();
    std::memset(static_cast<void*>(impulses + blocks.begin(block)), 0,
                (blocks.end(block) - blocks.begin(block)) * sizeof *impulses);
  }
  for (const Between between : {Between::discs, Between::round_parts, Between::ellipses})
    collide(system, between, block);
}

void complete_impulses(GrainSystem& system, std::size_t block, bool turning) {
  std::vector<BodyImpulse>& impulses = system.bodies.impulses;
  for (const auto& [body, impulse] : system.bodies.inwards[block]) {
    BodyImpulse& sum = impulses[body];
    sum.impulse += impulse->impulse;
    sum.torque += impulse->torque;
    sum.rim += impulse->rim;
  }
  if (!turning) return;
  for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i)
    turn_rims(impulses[i], system.bodies.constants[i]);
}

/// The contacts of a block with walls.
void collide_with_walls(GrainSystem& system, std::size_t block) {
  const std::vector<NearList>& walls = system.contacts.of(Between::walls).blocks;
  if (walls.empty() || walls[block].count == 0) return;
  system.bodies.sums[block].on_walls.assign(system.walls.loads.size(), {});
  collide(system, Between::walls, block);
}

void count_sums(GrainSystem& system, BlockSums& sums) {
  for (const EnergyTerm& term : energy_terms(BodyFamily::colliding)) system.lost.*term.value += sums.lost.*term.value;
  system.counters.evaluations += sums.evaluations;
  system.counters.contacts += sums.contacts;
  system.deepest = std::max(system.deepest, sums.deepest);
  system.cell.on_images += sums.on_images;
  for (std::size_t w = 0; w < sums.on_walls.size(); ++w) system.walls.loads[w].add_in_step(sums.on_walls[w]);
  sums = {};
}

}  // namespace

void collide_bodies(GrainSystem& system, CandidateLoop loop, BlockMove move) {
  const bool keeps = !system.bodies.impulses_before.empty();
  if (keeps) system.bodies.impulses_before.swap(system.bodies.impulses);
  const bool clear = keeps || !system.bodies.at_zero;
  system.bodies.moved = move && system.contacts.has(Between::discs) && !keeps && !system.options.verlet() &&
                        system.shapes.parts.empty() && !system.cell.active;
  system.bodies.at_zero = system.bodies.moved && !system.contacts.record;
  if (clear) std::fill(system.bodies.moments.begin(), system.bodies.moments.end(), Vec2{});
  const bool turning = system.contacts.has(Between::discs) && system.friction && system.options.verlet();
  system.bodies.blocks.each_in_turn(
      system.bodies.earliest, [&](std::size_t block) { collide_block(system, block, clear); },
      [&](std::size_t block) {
        complete_impulses(system, block, turning);
        collide_with_walls(system, block);
        if (move) move(system, block);
      });
  if (loop) {
    BlockSums& sums = system.bodies.sums[0];
    sums.on_walls.assign(system.walls.loads.size(), {});
    loop(system, sums);
  }
  for (BlockSums& sums : system.bodies.sums) count_sums(system, sums);
}

void connect_blocks(GrainSystem& system) {
  const BodyBlocks& blocks = system.bodies.blocks;
  std::vector<std::vector<InwardImpulse>>& inwards = system.bodies.inwards;
  for (std::vector<InwardImpulse>& inward : inwards) inward.clear();
  std::vector<std::size_t>& earliest = system.bodies.earliest;
  std::iota(earliest.begin(), earliest.end(), std::size_t{0});
  const auto connect = [&](const OutwardImpulses& outward, std::size_t from) {
    for (std::size_t k = 0; k < outward.bodies.size(); ++k) {
      const std::int32_t body = outward.bodies[k];
      const std::size_t to = blocks.of(static_cast<std::size_t>(body));
      inwards[to].push_back({body, &outward.impulses[k]});
      earliest[to] = std::min(earliest[to], from);
    }
  };
  for (std::size_t from = 0; from < blocks.count(); ++from)
    for (const NearLists& lists : system.contacts.near)
      if (lists.active()) connect(lists.blocks[from].outward, from);
}

void take_longest_way(GrainSystem& system) {
  double longest = 0;
  for (const double way : system.bodies.ways) {
    if (way > longest || way != way) longest = way;  // a NaN persists: no number compares as larger
  }
  system.longest_way = longest;
}

}  // namespace equidem
