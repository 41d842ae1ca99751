// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe (1996), "Spring constants of distinct element in continuum analysis", computed again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/core/matrix.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/material/spring_constants.hpp"
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

/// nu of plane stress, -e22/e11, from that of plane strain, nu/(1 - nu): section 2 in the other direction.
constexpr double in_plane_stress(double poisson_ratio) {
  return poisson_ratio / (1 - poisson_ratio);
}

/// The tension test at one ratio on other blocks and under other loads: causes of the error of nu.
struct Variation {
  std::string name;
  double poisson_ratio = 0;
};
struct EdgeEffect {
  double ratio = 1;  ///< kT/kN
  std::vector<Variation> variations;
  /// Loads of the uniform state on the ends, over the mean load of a row: at long rows, short rows, the two corners.
  double long_row = 0, short_row = 0, corner = 0;
  double total = 0;  ///< of all rows
  int rows = 0;
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

/// Moduli gamma c² of the longitudinal and the transverse wave, Pa.
struct SheetWaves {
  double longitudinal = 0, transverse = 0;
};

/// The square lattice at one ratio, kN = 1 Pa: section 2.2.
struct SquarePoint {
  double ratio = 0;
  Matrix3 along_rows{};  ///< homogenized, axes along the rows
  Matrix3 turned{};      ///< axes at 45 degrees
  double anisotropy = 0;
  double nu_rows = 0, nu_diagonal = 0;  ///< of uniaxial stress, plane strain
  SheetWaves waves_rows, waves_diagonal;
};

/// The hexagonal lattice with rotation restrained and springs of eq. (53) for G = 1 Pa.
struct WavePoint {
  double wanted = 0;  ///< nu
  SpringConstants springs;
  double shear_modulus = 0, poisson_ratio = 0;  ///< from the speeds of long waves
  double deviation = 0;                         ///< largest over 12 directions, of G and K, relative
  double nu_of_tension = 0;                     ///< of a uniform uniaxial stress
};

/// Random assemblies of unequal discs under a uniaxial stress of 1 along x: end of section 4.2. Means over the samples.
struct UnequalPoint {
  static constexpr int discs = 400, samples = 12;
  static constexpr double ratio = 0.25;  ///< kT/kN
  double spread = 1;                     ///< largest over smallest radius
  MeanEstimate solid_fraction, coordination_number;
  MeanEstimate nu, shear_error, bulk_error;         ///< exact nu; mean field over exact, less 1
  MeanEstimate scatter_xx, scatter_yy, scatter_xy;  ///< standard deviation from disc to disc, V the cell of the disc
  MeanEstimate printed_mean, printed_scatter;       ///< of s11, V = pi r²/phi, eq. (50)
};

struct Reproduction {
  Block block;
  double height = 0;         ///< m, rows * sqrt3 a, on which the load acts
  double gauge_length = 0;   ///< m, A-B
  double gauge_height = 0;   ///< m, C-D
  double lattice_limit = 0;  ///< critical kT/kN of the infinite lattice, -1/3
  double block_limit = 0;    ///< critical kT/kN of this block
  std::vector<RatioPoint> points;
  std::vector<RatioPoint> large_points;  ///< of the block of large_rows rows
  std::vector<Convergence> convergence;
  EdgeEffect edges;
  StressCheck stress;
  std::vector<SquarePoint> square;
  std::vector<WavePoint> waves;
  std::vector<UnequalPoint> unequal;
  StageTimes times;
};

constexpr int large_rows = 129;

std::vector<SquarePoint> measure_square_lattice(const Block& block);
std::vector<WavePoint> measure_restrained_waves(const Block& block);
std::vector<UnequalPoint> measure_unequal_radii(const Block& block);

/// Compute everything; shows progress.
Reproduction reproduce(const Block& block);

/// The report for people.
std::string report(const Reproduction& result);

}  // namespace equidem::abe1996
