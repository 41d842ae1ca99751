// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A verb on several processes: one report, one message, one end.
#pragma once

#include <functional>

#include "petsc/ranks.hpp"
#include "program.hpp"

namespace equidem {

/// From here on only rank 0 writes to stdout and stderr.
void silence_other_ranks();

/// Calls the verb on all ranks. Where all of them throw, rank 0 reports. A rank that throws alone, so that the others
/// wait for it, reports itself after a while and ends all.
Run on_all_ranks(const std::function<void(const petsc::Ranks&)>& verb);

}  // namespace equidem
