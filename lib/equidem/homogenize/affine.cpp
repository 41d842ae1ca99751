// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/affine.hpp"

#include "equidem/contact/linear_spring.hpp"

namespace equidem {

std::vector<ContactDeformation> affine_deformations(const Assembly& assembly, const Tensor2& gradient,
                                                    double rotation) {
  std::vector<ContactDeformation> result(assembly.contacts.size());
  for (std::size_t c = 0; c < result.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const DiscMotion i{.u = {}, .theta = rotation};
    const DiscMotion j{.u = gradient * assembly.branch(contact), .theta = rotation};
    result[c] = deformation(frame_of(assembly, c), i, j);
  }
  return result;
}

std::vector<ContactForce> affine_contact_forces(const Assembly& assembly, const ContactSprings& springs,
                                                const Tensor2& gradient, double rotation) {
  const std::vector<ContactDeformation> deformations = affine_deformations(assembly, gradient, rotation);
  std::vector<ContactForce> forces(deformations.size());
  for (std::size_t c = 0; c < forces.size(); ++c) forces[c] = linear_spring_force(springs[c], deformations[c]);
  return forces;
}

}  // namespace equidem
