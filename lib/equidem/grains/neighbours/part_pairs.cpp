// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/neighbours/part_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/contact/shapes/ellipse_contact.hpp"

namespace equidem {

void place_parts(GrainSystem& system) {
  if (!has_shapes(system.scene)) return;
  for (const Grain& grain : system.scene.grains) {
    system.first_part.push_back(static_cast<std::int32_t>(system.parts.size()));
    const std::vector<GrainPart> parts = parts_of(grain, system.scene.clumps);
    const auto body = static_cast<std::int32_t>(system.first_part.size() - 1);
    system.parts.insert(system.parts.end(), parts.begin(), parts.end());
    system.body_of_part.insert(system.body_of_part.end(), parts.size(), body);
    if (grain.shape() != GrainShape::disc) system.shaped.push_back(body);
  }
  system.first_part.push_back(static_cast<std::int32_t>(system.parts.size()));
  system.axes.resize(system.motions.size(), {1, 0});
  turn_axes(system);
}

double longest_turn(const GrainSystem& system) {
  double longest = 0;
  for (const std::int32_t body : system.shaped) {
    const auto i = static_cast<std::size_t>(body);
    const double way = std::abs(system.next[i].angle - system.motions[i].angle) * system.bodies[i].radius;
    if (way > longest || way != way) longest = way;
    if (way != way) break;
  }
  return longest;
}

std::vector<PartPair> near_parts(const GrainSystem& system, std::size_t i, std::size_t j) {
  std::vector<PartPair> near;
  for (std::int32_t p = system.first_part[i]; p < system.first_part[i + 1]; ++p) {
    for (std::int32_t q = system.first_part[j]; q < system.first_part[j + 1]; ++q) {
      const GrainPart& part_i = system.parts[static_cast<std::size_t>(p)];
      const GrainPart& part_j = system.parts[static_cast<std::size_t>(q)];
      const Vec2 branch = system.motions[j].position - system.motions[i].position +
                          (offset_of(part_j, system.axes[j]) - offset_of(part_i, system.axes[i]));
      const double reach = part_i.a + part_j.a + system.margin;
      if (!(dot(branch, branch) < reach * reach)) continue;
      PartPair pair{p, q, 0, {}, {}, {}};
      if (!part_i.is_round() || !part_j.is_round()) {
        const EllipseContact contact =
            contact_of_ellipses({part_i.a, part_i.b, system.axes[i]}, {part_j.a, part_j.b, system.axes[j]}, branch);
        if (contact.gap > system.margin) continue;
        pair.apart = contact.normal;
      }
      near.push_back(pair);
    }
  }
  return near;
}

std::vector<PartPair> near_parts_of_wall(const GrainSystem& system, std::size_t i, std::size_t wall) {
  std::vector<PartPair> near;
  for (std::int32_t p = system.first_part[i]; p < system.first_part[i + 1]; ++p) {
    const GrainPart& part = system.parts[static_cast<std::size_t>(p)];
    const Vec2 centre = system.motions[i].position + offset_of(part, system.axes[i]);
    const Wall& shape = system.scene.walls[wall];
    const WallContact contact = nearest(shape, system.walls[wall].displacement, centre);
    double reach = part.a;
    if (shape.shape == Wall::Shape::line) reach = support({part.a, part.b, system.axes[i]}, contact.normal).reach;
    if (contact.distance <= reach + system.margin) near.push_back({p, 0, 0, {}, {}, {}});
  }
  return near;
}

}  // namespace equidem
