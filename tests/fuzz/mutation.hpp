// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Inputs that are nearly valid.
#pragma once

#include <string>
#include <vector>

#include "equidem/core/random.hpp"

namespace equidem::fuzz {

/// One of the seeds, changed one to eight times, twice on average: bits and bytes altered, spans removed, repeated or
/// copied from another seed, lines exchanged, numbers and words replaced by extreme ones, the end cut off.
/// \param seeds at least one, none of them empty
std::string mutated(const std::vector<std::string>& seeds, Random& random);

}  // namespace equidem::fuzz
