// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

#include "abe1996/abe1996.hpp"

namespace equidem::abe1996 {
namespace {

std::string table_of_ratios(const Reproduction& result) {
  std::string text =
      "Figs. 7 and 8: the tension test against theory\n"
      "  kT/kN    nu (35)   (1-r)/4   difference     (36)      (37)    difference  negative pivots\n";
  for (const RatioPoint& p : result.points) {
    const double nu = poisson_ratio_of_ratio(p.ratio), stiffness = hexagonal_stiffness_ratio(p.ratio);
    text += fmt::format(
        "  {:>5.2f}  {:>9.5f}  {:>8.5f}   {:>9.1e}  {:>9.5f}  {:>8.5f}   {:>9.1e}  {}\n", p.ratio, p.poisson_ratio, nu,
        p.poisson_ratio - nu, p.stiffness_ratio, stiffness, p.stiffness_ratio - stiffness,
        p.stable() ? fmt::format("{}, stable", p.negative_pivots)
                   : fmt::format("{}, UNSTABLE by {}", p.negative_pivots, counted(p.unstable_modes, "mode")));
  }
  return text;
}

std::string table_of_sizes(const Reproduction& result) {
  std::string text =
      "Error against size (n rows of n discs): nu against (22), and (36) against (37), relative\n  rows ";
  for (const Convergence& c : result.convergence) text += fmt::format("      kT/kN = {:<4.1f}     ", c.ratio);
  text += "\n";
  for (std::size_t k = 0; k < result.convergence.front().points.size(); ++k) {
    text += fmt::format("  {:>4} ", result.convergence.front().points[k].rows);
    for (const Convergence& c : result.convergence) {
      text += fmt::format("  {:>9.1e} {:>9.1e}  ", c.points[k].poisson_ratio_error, c.points[k].stiffness_ratio_error);
    }
    text += "\n";
  }
  text += "  slope";
  for (const Convergence& c : result.convergence) {
    const SizePoint &before = c.points[c.points.size() - 2], &last = c.points.back();
    const auto slope = [&](double e0, double e1) {
      return std::log(e1 / e0) / std::log(double(last.rows) / before.rows);
    };
    if (c.ratio == 0) {
      text += "   exact to round-off  ";
    } else {
      text += fmt::format("  {:>9.2f} {:>9.2f}  ", slope(before.poisson_ratio_error, last.poisson_ratio_error),
                          slope(before.stiffness_ratio_error, last.stiffness_ratio_error));
    }
  }
  return text + "\n";
}

std::string section_4(const StressCheck& s) {
  std::string text = "Section 4: macroscopic stress (50) of uniform strain on the periodic lattice, disc by disc\n";
  text +=
      fmt::format("  rotation free: differs from eq. (52) by at most {:.1e} of the largest stress\n", s.free_rotation);
  text += fmt::format("  rotation restrained: differs from eq. (55) (its first bracket completed) by at most {:.1e}\n",
                      s.restrained_rotation);
  text += fmt::format("  at kT/kN = {}, u_2,1 - u_1,2 = {}: s_12 - s_21 = {:.6g} Pa, eq. (55) gives {:.6g} Pa;\n",
                      s.ratio, s.spin, s.asymmetry, s.expected_asymmetry);
  text += fmt::format(
      "  the moments that hold the discs come to {:.6g} Pa (N m per m² and metre of depth): they are its "
      "cause\n",
      s.moment_density);
  text += fmt::format(
      "  eq. (53) matches displacements and waves, not the stress: the tension test with rotation restrained "
      "still\n"
      "  gives nu = {:.5f} at kT/kN = {}, near (1 - r)/4 = {:.5f}, where (53) would say {:.5f}\n",
      s.restrained_poisson_ratio, s.ratio, poisson_ratio_of_ratio(s.ratio),
      moduli_of({1, s.ratio}, Packing::hexagonal_restrained).poisson_ratio);
  return text;
}

}  // namespace

std::string report(const Reproduction& result) {
  const Block& b = result.block;
  std::string text = "Abe (1996): spring constants of discs and the continuum they stand for\n\n";
  text += fmt::format("Block: {} rows of {} and {} discs in turn, radius {} m, kN = {:g} Pa; s11 = {:g} Pa\n", b.rows,
                      b.columns, b.columns - 1, b.radius, b.kN, b.test.stress);
  text += fmt::format("Gauges A-B {:g} m along x and C-D {:g} m along y; height {:g} m = rows * sqrt3 a\n",
                      result.gauge_length, result.gauge_height, result.height);
  text += "(the paper prints neither the size of its block nor gauges and height)\n\n";
  text += table_of_ratios(result) + "\n";
  text += fmt::format(
      "Why the paper's points scatter below kT/kN = -1/3: there the infinite lattice itself gives way (at "
      "three points M\n"
      "of the Brillouin zone). This block with its free edges gives way sooner, at kT/kN = {:.6f}: below it "
      "the stiffness\n"
      "matrix has more negative eigenvalues than its rotations bring, one of them passing zero at each mode "
      "lost, and what\n"
      "the gauges read depends on how near a mode happens to be.\n\n",
      result.block_limit);
  text += table_of_sizes(result) + "\n" + section_4(result.stress);
  return text;
}

}  // namespace equidem::abe1996
