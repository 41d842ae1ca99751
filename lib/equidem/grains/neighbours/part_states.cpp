// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies as the loops over near parts read them, and the contacts that these loops keep.
#include <utility>

#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/neighbours/near_parts.hpp"

namespace equidem {
namespace {

using PartColumn = PartGroup::Column;

}  // namespace

void load_part_bodies(GrainSystem& system) {
  NearParts& near = system.contacts.near_parts;
  if (!near.active) return;
  system.bodies.blocks.each_piece(system.bodies.motions.size(), [&](std::size_t begin, std::size_t end_body) {
    for (std::size_t b = begin; b < end_body; ++b) {
      const GrainMotion& motion = system.bodies.motions[b];
      const GrainBody& body = system.bodies.constants[b];
      const BodyImpulse& push = system.bodies.impulses[b];
      const auto end_part = static_cast<std::size_t>(system.shapes.first_part[b + 1]);
      for (auto k = static_cast<std::size_t>(system.shapes.first_part[b]); k < end_part; ++k) {
        if (near.met[k] == 0) continue;
        const GrainPart& part = system.shapes.parts[k];
        PartBody& seen = near.bodies[k];
        seen.turned = part.is_round() ? offset_of(part, system.shapes.axes[b]) : system.shapes.axes[b];
        seen.centre = part.is_round() ? motion.position + seen.turned : motion.position;
        seen.velocity = motion.velocity;
        if (system.cell.deforms)  // as in the drift before
          seen.velocity += system.cell.gradient * (system.bodies.next[b].position - system.cell.centre);
        seen.middle_velocity = seen.velocity + (0.5 * body.inverse_mass) * push.impulse;
        seen.spin = motion.spin;
        seen.middle_spin = motion.spin + 0.5 * body.inverse_moment * push.torque;
      }
    }
  });
}

void touch_near_parts(GrainSystem& system) {
  for (NearParts::Block& block : system.contacts.near_parts.blocks) {
    for (NearParts::List& list : block.lists) {
      for (std::size_t p = 0; p < list.count; ++p) {
        auto [candidate, pair] = candidate_of(system, list, p);
        if (!(geometry_of_parts(system, candidate, pair).overlap > 0)) continue;
        PartGroup& group = list.groups[p / lanes_of_pairs];
        const std::size_t k = p % lanes_of_pairs;
        group.since[k] = system.step + (system.options.verlet() ? 0 : 1);
        group.numbers[PartGroup::normal_x][k] = group.numbers[PartGroup::normal_y][k] = 0;
        ++system.counters.contacts;
      }
    }
  }
}

std::pair<Candidate, PartPair> candidate_of(const GrainSystem& system, const NearParts::List& list, std::size_t p) {
  const PartGroup& group = list.groups[p / lanes_of_pairs];
  const std::size_t k = p % lanes_of_pairs;
  const auto number = [&](PartColumn column) { return group.numbers[column][k]; };
  const Vec2 normal{number(PartGroup::normal_x), number(PartGroup::normal_y)};
  Candidate candidate;
  candidate.i = system.shapes.body_of_part[static_cast<std::size_t>(group.i[k])];
  candidate.j = system.shapes.body_of_part[static_cast<std::size_t>(group.j[k])];
  set_constants(system, candidate);
  PartPair pair;
  pair.i = group.i[k];
  pair.j = group.j[k];
  pair.tangential_damping = number(PartGroup::tangential_damping);
  candidate.touching = list.touching(p);
  if (!candidate.touching) {
    pair.apart = normal;
    return {candidate, pair};
  }
  candidate.steps = system.step + 1 - group.since[k];
  candidate.normal = normal;
  candidate.impulse = number(PartGroup::impulse);
  candidate.tangential_impulse = number(PartGroup::tangential_impulse);
  candidate.stretch = number(PartGroup::stretch);
  candidate.overlap = number(PartGroup::overlap);
  candidate.closing = number(PartGroup::closing);
  pair.arm_i = {number(PartGroup::arm_i_x), number(PartGroup::arm_i_y)};
  pair.arm_j = {number(PartGroup::arm_j_x), number(PartGroup::arm_j_y)};
  return {candidate, pair};
}

}  // namespace equidem
