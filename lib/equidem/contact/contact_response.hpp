// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// All that a contact answers to the motion of its bodies: the force of its springs, the moment of its bending spring,
/// and what the force that it carries at rest adds.
#pragma once

#include <cstddef>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/contact/prestress/prestress.hpp"

namespace equidem {

/// \param theta_i, theta_j rotations of the two bodies, rad
template <typename Number>
ContactResponse<Number> contact_response(const ContactSprings& springs, std::size_t contact,
                                         const DeformationOf<Number>& deformation, Number theta_i, Number theta_j) {
  ContactResponse<Number> response{.force = linear_spring_force(springs[contact], deformation)};
  if (springs.bends()) {
    const Number moment = bending_moment(springs.bending(contact), theta_i, theta_j);
    response.moment_i += moment;
    response.moment_j -= moment;
  }
  if (const ContactPrestress* const prestress = springs.prestress(contact))
    add_prestress(*prestress, deformation, theta_i, theta_j, response);
  return response;
}

}  // namespace equidem
