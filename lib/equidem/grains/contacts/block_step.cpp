// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/block_step.hpp"

#include <algorithm>

#include "equidem/grains/contacts/move_bodies.hpp"

namespace equidem {
namespace {

void collide_block(GrainSystem& system, std::size_t block, bool clear) {
  const BodyBlocks& blocks = system.bodies.blocks;
  if (clear) {
    const auto impulse = [&](std::size_t body) {
      return system.bodies.impulses.begin() + static_cast<std::ptrdiff_t>(body);
    };
    std::fill(impulse(blocks.begin(block)), impulse(blocks.end(block)), BodyImpulse{});
  }
  if (system.contacts.near.active) system.contacts.near.loop(system, block);
  NearParts& parts = system.contacts.near_parts;
  for (std::size_t l = 0; parts.active && l < parts.loops.size(); ++l) {
    NearParts::List& list = parts.blocks[block].lists[l];
    if (list.count > 0) parts.loops[l](system, list, block);
  }
}

void complete_impulses(GrainSystem& system, std::size_t block, bool turning) {
  std::vector<BodyImpulse>& impulses = system.bodies.impulses;
  for (const auto& [body, impulse] : system.bodies.inwards[block]) {
    BodyImpulse& sum = impulses[static_cast<std::size_t>(body)];
    sum.impulse += impulse->impulse;
    sum.torque += impulse->torque;
    sum.rim += impulse->rim;
  }
  if (!turning) return;
  for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i)
    turn_rims(impulses[i], system.bodies.constants[i]);
}

void count_sums(GrainSystem& system) {
  for (BlockSums& sums : system.bodies.sums) {
    for (const EnergyTerm& term : energy_terms(BodyFamily::colliding)) system.lost.*term.value += sums.lost.*term.value;
    system.counters.evaluations += sums.evaluations;
    system.counters.contacts += sums.contacts;
    if (sums.evaluations > 0) system.free_flight = false;
    system.deepest = std::max(system.deepest, sums.deepest);
    system.touch_impulses.insert(system.touch_impulses.end(), sums.touch_impulses.begin(), sums.touch_impulses.end());
    sums = {};
  }
}

}  // namespace

void collide_near(GrainSystem& system, bool clear) {
  if (!system.cell.images.empty()) place_images(system);
  const bool turning = system.contacts.near.active && system.friction && system.options.verlet();
  system.bodies.blocks.each([&](std::size_t block) { collide_block(system, block, clear); });
  if (turning || system.bodies.blocks.count() > 1 || !system.cell.images.empty())
    system.bodies.blocks.each([&](std::size_t block) { complete_impulses(system, block, turning); });
  count_sums(system);
}

void connect_blocks(GrainSystem& system) {
  const BodyBlocks& blocks = system.bodies.blocks;
  std::vector<std::vector<InwardImpulse>>& inwards = system.bodies.inwards;
  for (std::vector<InwardImpulse>& inward : inwards) inward.clear();
  const auto connect = [&](const OutwardImpulses& outward) {
    for (std::size_t k = 0; k < outward.bodies.size(); ++k) {
      const std::int32_t body = system.body_of(outward.bodies[k]);
      inwards[blocks.of(static_cast<std::size_t>(body))].push_back({body, &outward.impulses[k]});
    }
  };
  for (std::size_t block = 0; block < blocks.count(); ++block) {
    if (system.contacts.near.active) connect(system.contacts.near.blocks[block].outward);
    if (!system.contacts.near_parts.active) continue;
    for (const NearParts::List& list : system.contacts.near_parts.blocks[block].lists) connect(list.outward);
  }
}

}  // namespace equidem
