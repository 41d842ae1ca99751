// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include <equidem/assembly/lattices.hpp>
#include <equidem/homogenize/tension_test.hpp>

int main() {
  const equidem::Assembly block = equidem::hexagonal_lattice({.columns = 9, .rows = 9});
  const equidem::ContactSprings springs({.kN = 1e9, .kT = 0});
  const equidem::TensionTest test;
  const auto setup = equidem::tension_setup(block, test);
  const auto at_rest = equidem::solve_equilibrium(block, springs, setup.supports, setup.loads);
  const auto result = equidem::evaluate_tension(block, springs, test, setup, at_rest);
  std::printf("solid fraction %.6f, Poisson's ratio %.6f\n", block.solid_fraction(), result.poisson_ratio);
}
