// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/affine.hpp"

#include "equidem/contact/linear_spring.hpp"

namespace equidem {

std::vector<ContactForce> affine_contact_forces(const Assembly& assembly, const ContactSprings& springs,
                                                const Tensor2& gradient, double rotation) {
  std::vector<ContactForce> forces(assembly.contacts.size());
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const DiscMotion i{.u = {}, .theta = rotation};
    const DiscMotion j{.u = gradient * assembly.branch(contact), .theta = rotation};
    forces[c] = linear_spring_force(springs[c], deformation(frame_of(assembly, contact), i, j));
  }
  return forces;
}

}  // namespace equidem
