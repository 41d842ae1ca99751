// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe's numerical test (1996, section 3, Fig. 6): uniaxial tension of a block along x.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem {

/// Two discs between which an elongation is read.
struct StrainGauge {
  std::int32_t first = 0;
  std::int32_t second = 0;
};

/// Elongation of a gauge along its own direction over its length: (u_second - u_first) . l / l². The centres must
/// differ. Across a period the motion of images is not known: on a periodic cell the branch is the one inside it.
double gauge_strain(const Assembly& assembly, std::span<const DiscMotion> motions, const StrainGauge& gauge);

/// The displacement gradient h_ij = du_i/dx_j that fits the motion of the chosen discs best (least squares, each disc
/// weighted by its cell area where known). Exact for any uniform gradient.
/// \param sum_up adds to each of the numbers those of other parts of the sample; none: the assembly is the whole
/// \throws Error (bad_input) where fewer than three discs are chosen or all lie on one line
Tensor2 fitted_displacement_gradient(const Assembly& assembly, std::span<const DiscMotion> motions,
                                     const std::function<bool(std::size_t disc)>& inside,
                                     const std::function<void(std::span<double>)>& sum_up = {});

/// Places of the two strain gauges A-B (along x) and C-D (along y). On the lattices A and B are discs of the middle
/// row (of two middle rows of a hexagonal block, the one with a disc in its middle), the nearest pair symmetric about
/// its middle that is at least as far out as wanted. C and D share one x, that of the disc in or next to the middle,
/// and lie as many rows above as below the middle one; `ends` leaves out the last of an even number of hexagonal
/// rows, since only every other row has discs at the same x. Elsewhere all four are the discs nearest to the points
/// wanted, one spacing being the mean branch length.
enum class GaugePlacement {
  centre,   ///< discs two spacings (rows) either side of the middle
  quarter,  ///< discs a quarter of the block either side of the middle
  ends,     ///< from side to side through the middle
};

template <>
struct EnumNames<GaugePlacement> {
  static constexpr const char* what = "placement of strain gauges";
  static constexpr NamedValue<GaugePlacement> list[] = {
      {GaugePlacement::centre, "centre"}, {GaugePlacement::quarter, "quarter"}, {GaugePlacement::ends, "ends"}};
};

struct TensionTest {
  double stress = 1e6;  ///< s11, Pa; not zero
  GaugePlacement gauge = GaugePlacement::centre;
};

/// Loads, supports and gauges of the test on an assembly with a free boundary: the traction s11 on the discs of the
/// left and right sides by their tributary length (equal loads on a lattice), the bottom row held vertically, the
/// bottom-left disc held both ways.
struct TensionSetup {
  std::vector<Support> supports;
  LoadCase loads;
  StrainGauge horizontal;  ///< A-B
  StrainGauge vertical;    ///< C-D
  double height = 0;       ///< m, by which the total load is divided: the tributary height, rows * sqrt3 a on the
                           ///< hexagonal lattice
};

/// \throws Error (bad_input) where the assembly is periodic, too small for the gauges (with the least size) or has no
///         sides to pull at, or where the stress is zero or not finite
TensionSetup tension_setup(const Assembly& assembly, const TensionTest& test);

/// The supports and loads of the test, and its height, without gauges.
/// \throws Error (bad_input) where the stress is zero or not finite, or the heights of the sides differ
TensionSetup tension_loads(const TensionTest& test, double left_height, double right_height);

/// Place the gauges at the discs nearest to the points wanted.
/// \param extents of the centres \param spacing mean branch length, m
/// \param nearest the disc nearest to a point
/// \throws Error (bad_input) where the block is too small
void place_nearest_gauges(const Rectangle& extents, double spacing, GaugePlacement placement,
                          const std::function<std::int32_t(Vec2 point)>& nearest, TensionSetup& setup);

struct TensionResult {
  double poisson_ratio = 0;         ///< nu = -e22/(e11 - e22), plane strain, eq. (35), from the two gauges
  double stiffness_ratio = 0;       ///< 2G/((1 - nu) kN) = s11/(kN e11), eq. (36); kN is the mean over contacts
  Voigt strain;                     ///< gauges: e11, e22; shear from the fitted field
  Voigt stress;                     ///< s11 = total load / height
  Tensor2 fitted_gradient;          ///< displacement gradient fitted to the inner half of the block, at least one
                                    ///< spacing either side of its middle
  double fitted_poisson_ratio = 0;  ///< eq. (35) from the fitted field
};

/// The region of the fitted field: the inner half of the block, at least one spacing either side of its middle.
Rectangle inner_half(const Rectangle& extents, double spacing);

/// \param e11, e22 of the gauges
TensionResult tension_result(const TensionTest& test, double e11, double e22, double mean_kN,
                             const Tensor2& fitted_gradient);

TensionResult evaluate_tension(const Assembly& assembly, const ContactSprings& springs, const TensionTest& test,
                               const TensionSetup& setup, const Equilibrium& equilibrium);

}  // namespace equidem
