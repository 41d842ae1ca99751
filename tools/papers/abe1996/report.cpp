// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

#include "abe1996/abe1996.hpp"
#include "tables.hpp"

namespace equidem::abe1996 {
namespace {

/// Without the sign of a number that is zero to five digits.
double shown(double value) {
  return std::abs(value) < 5e-6 ? 0 : value;
}

std::string table_of_ratios(const Reproduction& result) {
  TextTable table(
      "kT/kN & nu (35) & (1-r)/4 & difference & plane stress & (1-r)/(3+r) & (36) & (37) & difference & negative "
      "pivots "
      "& ");
  for (const RatioPoint& p : result.points) {
    const double nu = poisson_ratio_of_ratio(p.ratio), stiffness = hexagonal_stiffness_ratio(p.ratio);
    table.add("{:>5.2f} & {:.5f} & {:.5f} & {:.1e} & {:.5f} & {:.5f} & {:.5f} & {:.5f} & {:.1e} & {} & {}", p.ratio,
              p.poisson_ratio, nu, p.poisson_ratio - nu, in_plane_stress(p.poisson_ratio), in_plane_stress(nu),
              p.stiffness_ratio, stiffness, p.stiffness_ratio - stiffness, p.negative_pivots,
              p.stable() ? "stable" : fmt::format("UNSTABLE by {}", counted(p.unstable_modes, "mode")));
  }
  return "Figs. 7 and 8: the tension test against theory; nu of plane stress is -e22/e11\n" + table.text() +
         "In plane stress the relation nu = (1 - r)/4, whose nu the paper replaces by nu/(1 + nu), reads\n"
         "nu = (1 - r)/(3 + r): at most 1/3 for kT >= 0.\n";
}

std::string causes_of_error(const EdgeEffect& edges) {
  const double theory = poisson_ratio_of_ratio(edges.ratio);
  TextTable table(" & nu & difference from theory");
  for (const Variation& v : edges.variations)
    table.add("{} & {:.5f} & {:.1e}", v.name, shown(v.poisson_ratio), v.poisson_ratio - theory);
  return fmt::format("Why nu at kT/kN = {} lies off the line of Fig. 7 (theory {:.5f})\n", edges.ratio, theory) +
         table.text() +
         fmt::format(
             "The ends are the cause, not the relation. A uniform state needs {:.3f} of the load of a row at the ends "
             "of long\n"
             "rows, {:.3f} at those of short rows, {:.3f} at the corners, where the diagonal contacts of one side are "
             "missing, and\n"
             "{:.3f} rows' load in all; the paper's loads are equal, on {} rows. The difference between long and short "
             "rows decays\n"
             "within a spacing. The excess load strains the block uniformly: it is the error of (36) of a long strip "
             "and "
             "does not\n"
             "change nu. The rest is too large at the outer rows and too small between them; it balances itself and\n"
             "decays within about one height, in which the gauges of a square block lie: an error of order 1/rows. It "
             "vanishes\n"
             "with kT, with the length of the block, with its size, and with the loads of the uniform state.\n",
             edges.long_row, edges.short_row, edges.corner, edges.total, edges.rows);
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
      "Sections 4.1 and 4.3: macroscopic stress (50) of uniform strain on the periodic lattice, disc by disc\n"
      "  Rotation free: the difference from eq. (52) is at most {:.1e} of the largest stress.\n"
      "  Rotation restrained: the difference from eq. (55) (its first bracket completed) is at most {:.1e}.\n"
      "  At kT/kN = {}, u_2,1 - u_1,2 = {}: s_12 - s_21 = {:.6g} Pa, eq. (55) gives {:.6g} Pa. The cause is the\n"
      "  moments that restrain the rotation: {:.6g} Pa (N m per m² and metre of depth).\n"
      "  Eq. (53) matches displacements and waves, but not the stress: the tension test with rotation restrained\n"
      "  gives nu = {:.5f} at kT/kN = {}, near (1 - r)/4 = {:.5f}, where (53) gives {:.5f}. Conclusion (f) holds.\n",
      s.free_rotation, s.restrained_rotation, s.ratio, s.spin, s.asymmetry, s.expected_asymmetry, s.moment_density,
      s.restrained_poisson_ratio, s.ratio, poisson_ratio_of_ratio(s.ratio),
      moduli_of({1, s.ratio}, lattices::hexagonal_restrained).poisson_ratio);
}

std::string square_lattice_text(const std::vector<SquarePoint>& points) {
  TextTable table(
      "kT/kN & C11/kN & C12/kN & C66/kN & at 45°: C11/kN & C12/kN & C66/kN & anisotropy & nu, rows & nu, 45° & waves, "
      "rows: L & T & waves, 45°: L & T");
  double worst = 0;
  for (const SquarePoint& p : points) {
    const Matrix3 &c = p.along_rows, &t = p.turned;
    table.add(
        "{:.2f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & {:.4f} & "
        "{:.4f} & {:.4f}",
        p.ratio, c[0][0], shown(c[0][1]), c[2][2], t[0][0], shown(t[0][1]), t[2][2], p.anisotropy, shown(p.nu_rows),
        shown(p.nu_diagonal), p.waves_rows.longitudinal, p.waves_rows.transverse, p.waves_diagonal.longitudinal,
        p.waves_diagonal.transverse);
    const double r = p.ratio;
    for (const double error : {c[0][0] - 1, c[0][1], c[2][2] - r / 2, t[0][0] - (1 + r) / 2, t[0][1] - (1 - r) / 2,
                               t[2][2] - 0.5, p.waves_rows.longitudinal - 1, p.waves_rows.transverse - r / 2,
                               p.waves_diagonal.longitudinal - (1 + r) / 2, p.waves_diagonal.transverse - 0.5})
      worst = std::max(worst, std::abs(error));
  }
  return "Section 2.2: the square lattice (periodic, homogenized; waves: gamma c²/kN of long waves)\n" + table.text() +
         fmt::format(
             "  (29): the coefficients 4 gamma/(pi rho) kN = kN and 2 gamma/(pi rho) kT = kT/2 of its operator, with "
             "gamma/rho =\n"
             "  pi/4, are C11 and C66, by stress and by waves; C12 = 0. At 45 degrees C11 = (kN + kT)/2, C12 = (kN - "
             "kT)/2,\n"
             "  C66 = kN/2. The largest difference from these formulas is {:.0e} kN.\n"
             "  (30), (31): isotropic at kN = kT = E alone, where nu = 0 in every direction.\n"
             "  The 45 degree remark gives equally spaced contacts as the reason why the lattice has no direction: "
             "true of\n"
             "  tensors of second order, C'_ij, not of the stiffness. Pulled along the diagonal it contracts with nu = "
             "(1 - r)/2\n"
             "  (at kT/kN = {:g}: {:.3f}), along the rows it does not.\n"
             "  Conclusion (d) holds: for nu other than 0 the lattice is no isotropic body at any kT/kN.\n",
             worst, points.front().ratio, points.front().nu_diagonal);
}

std::string waves_text(const std::vector<WavePoint>& points) {
  TextTable table(
      "nu wanted & kN/G (53) & kT/G (53) & waves: G & nu & largest deviation & uniaxial stress: nu & (1-r)/4");
  for (const WavePoint& p : points)
    table.add("{:.2f} & {:.5f} & {:.5f} & {:.5f} & {:.5f} & {:.0e} & {:.5f} & {:.5f}", p.wanted, p.springs.kN,
              p.springs.kT, p.shear_modulus, shown(p.poisson_ratio), p.deviation, p.nu_of_tension,
              poisson_ratio_of_ratio(p.springs.ratio()));
  return "Eq. (53): the hexagonal lattice with rotation restrained, springs for G = 1 Pa and nu; long waves in 12 "
         "directions\n" +
         table.text() +
         "  From gamma c² of long waves, G (transverse) and K + G (longitudinal), nu = (K - G)/(2 K): the waves have "
         "the "
         "wanted\n"
         "  moduli in all directions. A uniform uniaxial stress has the nu of free rotation.\n";
}

std::string unequal_text(const std::vector<UnequalPoint>& points) {
  TextTable table(
      "radii & phi & z & nu & mean field: G & K & s11, sd & s22, sd & s12, sd & with pi r²/phi: mean s11 & sd");
  for (const UnequalPoint& p : points)
    table.add(
        "1 to {:g} & {:.4f} & {:.3f} & {:.4f} ± {:.4f} & {:+.1f} % & {:+.1f} % & {:.3f} & {:.3f} & {:.3f} & {:.3f} & "
        "{:.3f}",
        p.spread, p.solid_fraction.mean, p.coordination_number.mean, p.nu.mean, p.nu.standard_error,
        100 * p.shear_error.mean, 100 * p.bulk_error.mean, p.scatter_xx.mean, p.scatter_yy.mean, p.scatter_xy.mean,
        p.printed_mean.mean, p.printed_scatter.mean);
  return fmt::format(
             "End of section 4.2: unequal radii. {} periodic Delaunay cells of {} discs for each range of radii, "
             "Poisson-disc\n"
             "points, equal springs, kT/kN = {}, mean uniaxial stress s11 = 1; mean field: (21), (22), over exact, "
             "less "
             "1\n",
             UnequalPoint::samples, UnequalPoint::discs, UnequalPoint::ratio) +
         table.text() +
         fmt::format(
             "  The paper's remark, some scatter but a fair value, holds: the mean of (50) over the discs is the "
             "applied "
             "stress, with V\n"
             "  the cell of each disc and with V = pi r²/phi as printed. The stress of single discs scatters by {:.0f} "
             "% of s11 where radii\n"
             "  are equal and by {:.0f} % where they differ up to a factor of {:g}: the random contacts are the cause, "
             "more than the radii.\n"
             "  With V = pi r²/phi the scatter is {:.0f} % and {:.0f} %. Theory of nu: (1 - r)/4 = {:.4f}.\n",
             100 * points.front().scatter_xx.mean, 100 * points.back().scatter_xx.mean, points.back().spread,
             100 * points.front().printed_scatter.mean, 100 * points.back().printed_scatter.mean,
             poisson_ratio_of_ratio(UnequalPoint::ratio));
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
         table_of_sizes(result) + "\n" + causes_of_error(result.edges) + "\n" + square_lattice_text(result.square) +
         "\n" + section_4(result.stress) + "\n" + waves_text(result.waves) + "\n" + unequal_text(result.unequal);
}

}  // namespace equidem::abe1996
