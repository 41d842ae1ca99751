// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/neighbours/part_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/contact/shapes/ellipse_contact.hpp"

namespace equidem {

void place_parts(GrainSystem& system) {
  if (!has_shapes(system.scene)) return;
  for (const Grain& grain : system.scene.grains) {
    system.shapes.first_part.push_back(static_cast<std::int32_t>(system.shapes.parts.size()));
    const std::vector<GrainPart> parts = parts_of(grain, system.scene.clumps);
    const auto body = static_cast<std::int32_t>(system.shapes.first_part.size() - 1);
    system.shapes.parts.insert(system.shapes.parts.end(), parts.begin(), parts.end());
    system.shapes.body_of_part.insert(system.shapes.body_of_part.end(), parts.size(), body);
    if (grain.shape() != GrainShape::disc) system.shapes.shaped.push_back(body);
  }
  system.shapes.first_part.push_back(static_cast<std::int32_t>(system.shapes.parts.size()));
  system.shapes.axes.resize(system.bodies.motions.size(), {1, 0});
  turn_axes(system);
}

PartPair parts_of_discs(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  PartPair pair;
  if (system.shapes.parts.empty()) return pair;
  pair.i = system.shapes.first_part[static_cast<std::size_t>(i)];
  pair.j = system.shapes.first_part[static_cast<std::size_t>(j)];
  return pair;
}

double longest_turn(const GrainSystem& system) {
  const std::vector<std::int32_t>& shaped = system.shapes.shaped;
  std::vector<double> ways(system.bodies.blocks.count());
  system.bodies.blocks.each_piece(shaped.size(), [&](std::size_t begin, std::size_t end) {
    double longest = 0;
    for (std::size_t k = begin; k < end && longest == longest; ++k) {
      const auto i = static_cast<std::size_t>(shaped[k]);
      const double way =
          std::abs(system.bodies.next[i].angle - system.bodies.motions[i].angle) * system.bodies.constants[i].radius;
      if (way > longest || way != way) longest = way;
    }
    ways[system.bodies.blocks.of(begin)] = longest;
  });
  double longest = 0;
  for (const double way : ways) {
    if (way > longest || way != way) longest = way;
    if (way != way) break;
  }
  return longest;
}

std::vector<PartPair> near_parts(const GrainSystem& system, std::size_t i, std::size_t j) {
  std::vector<PartPair> near;
  for (std::int32_t p = system.shapes.first_part[i]; p < system.shapes.first_part[i + 1]; ++p) {
    for (std::int32_t q = system.shapes.first_part[j]; q < system.shapes.first_part[j + 1]; ++q) {
      const GrainPart& part_i = system.shapes.parts[static_cast<std::size_t>(p)];
      const GrainPart& part_j = system.shapes.parts[static_cast<std::size_t>(q)];
      const Vec2 branch = system.bodies.motions[j].position - system.bodies.motions[i].position +
                          (offset_of(part_j, system.shapes.axes[j]) - offset_of(part_i, system.shapes.axes[i]));
      const double reach = part_i.a + part_j.a + system.contacts.margin;
      if (!(dot(branch, branch) < reach * reach)) continue;
      PartPair pair{p, q, 0, {}, {}, {}};
      if (!part_i.is_round() || !part_j.is_round()) {
        const EllipseContact contact = contact_of_ellipses({part_i.a, part_i.b, system.shapes.axes[i]},
                                                           {part_j.a, part_j.b, system.shapes.axes[j]}, branch);
        if (contact.gap > system.contacts.margin) continue;
        pair.apart = contact.normal;
      }
      near.push_back(pair);
    }
  }
  return near;
}

std::vector<PartPair> near_parts_of_wall(const GrainSystem& system, std::size_t i, std::size_t wall) {
  std::vector<PartPair> near;
  for (std::int32_t p = system.shapes.first_part[i]; p < system.shapes.first_part[i + 1]; ++p) {
    const GrainPart& part = system.shapes.parts[static_cast<std::size_t>(p)];
    const Vec2 centre = system.bodies.motions[i].position + offset_of(part, system.shapes.axes[i]);
    const Wall& shape = system.scene.walls[wall];
    const WallContact contact = nearest(shape, system.walls.places[wall].displacement, centre);
    double reach = part.a;
    if (shape.shape == Wall::Shape::line)
      reach = support({part.a, part.b, system.shapes.axes[i]}, contact.normal).reach;
    if (contact.distance <= reach + system.contacts.margin) near.push_back({p, 0, 0, {}, {}, {}});
  }
  return near;
}

}  // namespace equidem
