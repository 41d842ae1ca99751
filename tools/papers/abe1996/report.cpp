// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

#include "abe1996/abe1996.hpp"
#include "tables.hpp"

namespace equidem::abe1996 {
namespace {

std::string table_of_ratios(const Reproduction& result) {
  TextTable table("kT/kN & nu (35) & (1-r)/4 & difference & (36) & (37) & difference & negative pivots & ");
  for (const RatioPoint& p : result.points) {
    const double nu = poisson_ratio_of_ratio(p.ratio), stiffness = hexagonal_stiffness_ratio(p.ratio);
    table.add("{:>5.2f} & {:.5f} & {:.5f} & {:.1e} & {:.5f} & {:.5f} & {:.1e} & {} & {}", p.ratio, p.poisson_ratio, nu,
              p.poisson_ratio - nu, p.stiffness_ratio, stiffness, p.stiffness_ratio - stiffness, p.negative_pivots,
              p.stable() ? "stable" : fmt::format("UNSTABLE by {}", counted(p.unstable_modes, "mode")));
  }
  return "Figs. 7 and 8: the tension test against theory\n" + table.text();
}

std::string table_of_sizes(const Reproduction& result) {
  const std::size_t sizes = result.convergence.front().points.size();
  std::string head = "rows", slopes = "slope";
  std::vector<std::string> rows;
  for (const SizePoint& p : result.convergence.front().points) rows.push_back(fmt::format("{:>5}", p.rows));
  for (const Convergence& c : result.convergence) {
    const SizePoint &before = c.points[sizes - 2], &last = c.points.back();
    head += fmt::format(" & kT/kN = {:.1f}: nu & (36)", c.ratio);
    for (const auto error : {&SizePoint::poisson_ratio_error, &SizePoint::stiffness_ratio_error}) {
      for (std::size_t k = 0; k < sizes; ++k) rows[k] += fmt::format(" & {:.1e}", c.points[k].*error);
      const double slope = std::log(last.*error / (before.*error)) / std::log(double(last.rows) / before.rows);
      slopes += c.ratio == 0 ? " & round-off" : fmt::format(" & {:.2f}", slope);
    }
  }
  TextTable table(head);
  for (const std::string& row : rows) table.add_row(row);
  table.add_row(slopes);
  return "Error against size (n rows of n discs): nu against (22), and (36) against (37), relative\n" + table.text();
}

std::string section_4(const StressCheck& s) {
  return fmt::format(
      "Section 4: macroscopic stress (50) of uniform strain on the periodic lattice, disc by disc\n"
      "  Rotation free: the difference from eq. (52) is at most {:.1e} of the largest stress.\n"
      "  Rotation restrained: the difference from eq. (55) (its first bracket completed) is at most {:.1e}.\n"
      "  At kT/kN = {}, u_2,1 - u_1,2 = {}: s_12 - s_21 = {:.6g} Pa, eq. (55) gives {:.6g} Pa. The cause is the\n"
      "  moments that restrain the rotation: {:.6g} Pa (N m per m² and metre of depth).\n"
      "  Eq. (53) matches displacements and waves, but not the stress: the tension test with rotation restrained\n"
      "  gives nu = {:.5f} at kT/kN = {}, near (1 - r)/4 = {:.5f}, where (53) gives {:.5f}.\n",
      s.free_rotation, s.restrained_rotation, s.ratio, s.spin, s.asymmetry, s.expected_asymmetry, s.moment_density,
      s.restrained_poisson_ratio, s.ratio, poisson_ratio_of_ratio(s.ratio),
      moduli_of({1, s.ratio}, lattices::hexagonal_restrained).poisson_ratio);
}

}  // namespace

std::string report(const Reproduction& result) {
  const Block& b = result.block;
  return fmt::format(
             "Abe (1996): spring constants of discs and the equivalent continuum\n\n"
             "Block: {} rows of {} and {} discs alternately, radius {} m, kN = {:g} Pa; s11 = {:g} Pa\n"
             "Gauges A-B {:g} m along x and C-D {:g} m along y; height {:g} m = rows * sqrt3 a\n"
             "(the paper prints neither the size of its block nor gauges and height)\n\n",
             b.rows, b.columns, b.columns - 1, b.radius, b.kN, b.test.stress, result.gauge_length, result.gauge_height,
             result.height) +
         table_of_ratios(result) +
         fmt::format(
             "\nThe paper's points scatter below kT/kN = -1/3 because the infinite lattice is unstable there (at three "
             "points M\n"
             "of the Brillouin zone). This block with its free edges becomes unstable sooner, at kT/kN = {:.6f}: below "
             "it the\n"
             "stiffness matrix has more negative eigenvalues than its rotations account for, an eigenvalue passes zero "
             "at\n"
             "each mode lost, and the strain at the gauges depends on the distance to the nearest such mode.\n\n",
             result.block_limit) +
         table_of_sizes(result) + "\n" + section_4(result.stress);
}

}  // namespace equidem::abe1996
