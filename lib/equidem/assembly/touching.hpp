// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts of discs that touch.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// The pairs of discs, and of discs and images across the period, that overlap or whose gap is at most 1e-9 of the
/// smaller radius; each once, ascending by i, then j (i <= j), then shift. The contact point is the midpoint of the
/// branch.
/// \throws Error (bad_input) where a disc is many times wider than the period or lies too many periods away
std::vector<Contact> touching_discs(const Assembly& assembly);

}  // namespace equidem
