// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A sentence about ranks that die.
#pragma once

#include "petsc/ranks.hpp"

namespace equidem {

/// Where a rank dies, mpirun tells the others to end (SIGTERM) and kills them a second later, while they wait for it.
/// From here on the lowest rank that is left on the machine of a dead one names that in a sentence. Ranks of other
/// machines cannot know of it. What SIGTERM did before, it does behind that.
/// \param descriptor of the file that the sentence is written to
void tell_of_dead_ranks(const petsc::Ranks& ranks, int descriptor);

/// This rank comes to its end: from here on those that are gone have ended as it does.
void stop_telling_of_dead_ranks();

}  // namespace equidem
