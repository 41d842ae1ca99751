// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Time per evaluation of the contact laws.
#pragma once

#include <string>

namespace equidem::bench {

/// The laws alone, on what they see in impacts of random speed and phase, in random order.
std::string compare_laws(int impacts, int rounds);

/// Discs in a box stepped by every law.
/// \param scene "gas": they keep colliding without loss; "bed": packed by gravity, all contacts last
std::string compare_in_simulation(const std::string& scene, int rounds);

}  // namespace equidem::bench
