// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The verbs of equidem-mpi.
#pragma once

#include <array>

#include "program.hpp"

namespace equidem {

Run declare_parallel_solve(CLI::App& command);
Run declare_parallel_homogenize(CLI::App& command);

inline constexpr std::array parallel_verbs{
    Verb{"solve", "equilibrium under supports and loads, or Abe's tension test", declare_parallel_solve},
    Verb{"homogenize", "effective stiffness and moduli of a periodic cell", declare_parallel_homogenize},
};

}  // namespace equidem
