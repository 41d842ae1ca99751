// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/bonded_contacts.hpp"

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/dynamics/walls.hpp"

namespace equidem {

std::vector<BodyContact> bonded_contacts(const Scene& scene, LoopKind::Motion motion,
                                         const std::vector<DiscMotion>& motions, double time) {
  const Assembly& assembly = scene.assembly;
  std::vector<BodyContact> result;
  result.reserve(assembly.contacts.size());
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const DiscMotion &i = motions[contact.i], &j = motions[contact.j];
    if (motion == LoopKind::Motion::small) {
      const ContactDeformation d = deformation(frame_of(assembly, c), i, j);
      result.push_back(bonded_contact(assembly, c, linear_spring_force(scene.springs[c], d)));
    } else {
      const FiniteBond bond = bond_of(assembly, contact, scene.springs[c]);
      const BondMotion<double> moved = bond_motion(i, j);
      const ContactForce force = linear_spring_force(bond.springs, bond_deformation(bond, moved));
      const BondForces<double> on_i = bond_forces(bond, moved, force);
      result.push_back(bonded_contact(assembly, c, force));
      result.back().force = {on_i.x, on_i.y};
    }
  }
  for (const auto& [w, disc, gap] : wall_contacts(scene, motions, time)) {
    const Wall& wall = scene.walls[w];
    result.push_back({.i = static_cast<std::int32_t>(disc),
                      .j = ~static_cast<std::int32_t>(w),
                      .arm = -scene.assembly.radii[disc] * wall.normal,
                      .force = -wall.kN * gap * wall.normal,
                      .normal_force = wall.kN * gap});
  }
  return result;
}

}  // namespace equidem
