// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The springs of some of the contacts of an assembly.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/contact/contact_springs.hpp"

namespace equidem {

/// With their prestress, in the order of the numbers of the contacts.
ContactSprings chosen_springs(const ContactSprings& springs, const std::vector<std::int32_t>& contacts);

}  // namespace equidem
