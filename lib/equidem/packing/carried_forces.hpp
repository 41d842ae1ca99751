// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The forces that the contacts of a packing carry at rest.
#pragma once

#include <optional>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/material/spring_constants.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {

/// Bodies that fell carry the forces with which they came to rest; bodies that jammed -kN times the overlap, N/m, for
/// forces of equal springs balance there. Other packings carry none, for their overlaps balance nothing.
/// \param contacts of contacts_of(packing)
/// \param springs of every contact; none: of jammed bodies no forces are known
/// \return one for each contact, on its i (tension positive), or empty
std::vector<ContactForce> carried_forces(const GrainPacking& packing, const std::vector<PackingContact>& contacts,
                                         const std::optional<SpringConstants>& springs);

}  // namespace equidem
