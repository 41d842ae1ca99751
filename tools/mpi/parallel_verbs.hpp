// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The verbs of equidem-mpi on several processes: one report, one message, one end.
#pragma once

#include <array>
#include <functional>

#include "petsc/ranks.hpp"
#include "program.hpp"

namespace equidem {

/// Calls the verb on all ranks. Where all of them throw, rank 0 reports. A rank that throws alone, so that the others
/// wait for it, reports itself after a while and ends all.
Run on_all_ranks(const std::function<void(const petsc::Ranks&)>& verb);

Run declare_parallel_solve(CLI::App& command);
Run declare_parallel_homogenize(CLI::App& command);

inline constexpr std::array parallel_verbs{
    Verb{"solve", "equilibrium under supports and loads, or Abe's tension test", declare_parallel_solve},
    Verb{"homogenize", "effective stiffness and moduli of a periodic cell", declare_parallel_homogenize},
};

}  // namespace equidem
