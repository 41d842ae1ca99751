// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts of colliding bodies as callers see them.
#include <algorithm>
#include <tuple>
#include <utility>

#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/neighbours/part_pairs.hpp"

namespace equidem {
namespace {

/// As they were in the last step.
std::pair<Vec2, Vec2> arms_of_discs(const GrainSystem& system, const Candidate& candidate) {
  const double radius = system.bodies.constants[static_cast<std::size_t>(candidate.i)].radius;
  if (candidate.j < 0) return {radius * candidate.normal, {}};
  const double sum = radius + system.bodies.constants[static_cast<std::size_t>(system.body_of(candidate.j))].radius;
  const double lever = radius / sum * (sum - candidate.overlap);
  return {lever * candidate.normal, (lever - (sum - candidate.overlap)) * candidate.normal};
}

std::pair<Vec2, Vec2> arms_of(const GrainSystem& system, std::size_t c) {
  if (system.shapes.parts.empty()) return arms_of_discs(system, system.contacts.candidates[c]);
  return {system.contacts.part_pairs[c].arm_i, system.contacts.part_pairs[c].arm_j};
}

}  // namespace

std::vector<GrainContact> GrainSimulation::contacts() const {
  const GrainSystem& system = implementation_->system;
  std::vector<GrainContact> contacts;
  const auto add = [&](const Candidate& candidate, std::pair<Vec2, Vec2> arms) {
    if (!candidate.touching || candidate.steps == 0) return;
    GrainContact contact;
    std::tie(contact.arm_i, contact.arm_j) = arms;
    contact.i = static_cast<std::int32_t>(system.bodies.grain_of[static_cast<std::size_t>(candidate.i)]);
    contact.overlap = candidate.overlap;
    contact.closing = candidate.closing;
    contact.normal = candidate.normal;
    contact.normal_force = candidate.impulse / system.dt();
    contact.tangential_force = candidate.tangential_impulse / system.dt();
    contact.mode = candidate.mode;
    contact.steps = candidate.steps;
    if (candidate.j < 0) {
      contact.j = ~static_cast<std::int32_t>(system.walls.wall_of[static_cast<std::size_t>(~candidate.j)]);
    } else {
      const std::int32_t other = system.body_of(candidate.j);
      contact.j = static_cast<std::int32_t>(system.bodies.grain_of[static_cast<std::size_t>(other)]);
      if (contact.j < contact.i) {
        std::swap(contact.i, contact.j);
        contact.normal = -contact.normal;
        std::swap(contact.arm_i, contact.arm_j);
      }
    }
    contacts.push_back(contact);
  };
  for (const PairBlock& block : system.contacts.near.blocks) {
    for (std::size_t p = 0; p < block.count; ++p) {
      const Candidate candidate = candidate_of(system, block, p);
      add(candidate, arms_of_discs(system, candidate));
    }
  }
  each_list_of_parts(system.contacts.near_parts, [&](const NearParts::List& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      const auto [candidate, pair] = candidate_of(system, list, p);
      add(candidate, {pair.arm_i, pair.arm_j});
    }
  });
  for (std::size_t c = 0; c < system.contacts.candidates.size(); ++c)
    add(system.contacts.candidates[c], arms_of(system, c));
  std::stable_sort(contacts.begin(), contacts.end(), [](const GrainContact& a, const GrainContact& b) {
    return std::pair(a.i, a.j) < std::pair(b.i, b.j);
  });
  return contacts;
}

std::vector<BodyContact> GrainSimulation::body_contacts() const {
  const GrainSystem& system = implementation_->system;
  const auto shift_of = [&](const GrainContact& c) {
    if (!system.cell.active || c.j < 0) return Vec2{};
    const auto place = [&](std::int32_t grain) {
      return system.bodies
          .motions[static_cast<std::size_t>(system.bodies.place_of_grain[static_cast<std::size_t>(grain)])]
          .position;
    };
    const Vec2 apart = place(c.j) - place(c.i);
    return system.cell.now.shift(image_inside(system.cell.now, {}, apart));
  };
  std::vector<BodyContact> result;
  for (const GrainContact& c : contacts()) {
    const Vec2 on_j = c.normal_force * c.normal + c.tangential_force * perpendicular(c.normal);
    result.push_back({.i = c.i,
                      .j = c.j,
                      .arm = c.arm_i,
                      .shift = shift_of(c),
                      .force = -on_j,
                      .normal_force = c.normal_force,
                      .tangential_force = c.tangential_force});
  }
  const std::vector<BodyContact> bonds = contacts_of_bonds(system);
  result.insert(result.end(), bonds.begin(), bonds.end());
  return result;
}

}  // namespace equidem
