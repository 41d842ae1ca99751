// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe (1996), "Spring constants of distinct element in continuum analysis", computed again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/core/stopwatch.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem::abe1996 {

/// The block of Fig. 6. The paper prints neither its size nor the positions of the gauges; these are chosen here.
struct Block {
  int columns = 21;  ///< discs in a long row
  int rows = 21;
  double radius = 0.005;  ///< m
  double kN = 1e9;        ///< Pa
  TensionTest test;
};

/// One tension test of Figs. 7 and 8.
struct RatioPoint {
  double ratio = 0;            ///< kT/kN
  double poisson_ratio = 0;    ///< eq. (35)
  double stiffness_ratio = 0;  ///< eq. (36)
  std::int64_t negative_pivots = 0;
  std::int64_t unstable_modes = 0;
  double relative_residual = 0;

  [[nodiscard]] bool stable() const { return unstable_modes == 0; }
};

/// The tension test on a block of n x n discs.
struct SizePoint {
  int rows = 0;
  double poisson_ratio_error = 0;    ///< against (22)
  double stiffness_ratio_error = 0;  ///< against (37), relative
};

/// Errors against size at one ratio.
struct Convergence {
  double ratio = 0;
  std::vector<SizePoint> points;
};

/// Section 4: macroscopic stress of uniform strain on the periodic lattice, largest deviation over discs, strains and
/// ratios, relative to the largest stress.
struct StressCheck {
  double free_rotation = 0;             ///< from eq. (52)
  double restrained_rotation = 0;       ///< from eq. (55)
  double ratio = 0;                     ///< kT/kN of the example below
  double spin = 0;                      ///< u_2,1 - u_1,2 of the example
  double asymmetry = 0;                 ///< s_12 - s_21 of the example, Pa
  double expected_asymmetry = 0;        ///< -sqrt3 kT (u_2,1 - u_1,2), Pa
  double moment_density = 0;            ///< restraining moments per area, Pa
  double restrained_poisson_ratio = 0;  ///< of the tension test with rotation restrained, at the same ratio
};

struct Reproduction {
  Block block;
  double height = 0;         ///< m, rows * sqrt3 a, on which the load acts
  double gauge_length = 0;   ///< m, A-B
  double gauge_height = 0;   ///< m, C-D
  double lattice_limit = 0;  ///< critical kT/kN of the infinite lattice, -1/3
  double block_limit = 0;    ///< critical kT/kN of this block
  std::vector<RatioPoint> points;
  std::vector<Convergence> convergence;
  StressCheck stress;
  StageTimes times;
};

/// Compute everything; shows progress.
Reproduction reproduce(const Block& block);

/// The report for people.
std::string report(const Reproduction& result);

}  // namespace equidem::abe1996
