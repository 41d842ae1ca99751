// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The problem that solvers are compared on: a plate of discs, its left side held, its right side pulled.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem::bench {

/// kT/kN = 0.5, three unknowns per disc.
struct Problem {
  Assembly assembly;
  ContactSprings springs;
  DegreesOfFreedom unknowns;
  std::vector<double> load;  ///< N/m, discs x 3 components: (1, -1/4, 0) on each disc of the right side
};

/// The assemblies it can be set on: hexagonal, delaunay.
std::vector<std::string> problem_kinds();

/// \param discs wanted count; about as many rows as columns
/// \throws Error (bad_input) naming the kinds
Problem build_problem(const std::string& kind, std::int64_t discs);

}  // namespace equidem::bench
