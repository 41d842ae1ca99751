// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Springs from arrays.
#pragma once

#include "equidem/contact/contact_springs.hpp"

#include "module.hpp"

namespace equidem::python {

/// \param springs (2): kN and kT of all contacts; (contacts, 2): of each; Pa
ContactSprings springs_of(const Floats& springs);

}  // namespace equidem::python
