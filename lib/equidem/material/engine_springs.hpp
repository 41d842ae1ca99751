// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The two springs of a contact in the parameters of other programs. Springs here are per metre of depth; the others
/// have springs in N/m, taken for a depth of 1 m: forces are then those per metre.
#pragma once

#include "equidem/material/spring_constants.hpp"

namespace equidem {

/// m: the depth for which other programs take the springs.
inline constexpr double engine_depth = 1;

/// `young` and `poisson` of the material of one body of YADE.
struct YadeMaterial {
  double young = 0;    ///< Pa
  double poisson = 0;  ///< there the ratio of the springs ks/kn
};

/// The material of a body of that radius with which contacts of any two bodies have these springs: young = kN depth /
/// radius, so that bodies of different radii have different materials. \param radius m
YadeMaterial yade_material(const SpringConstants& springs, double radius);

/// The springs, N/m over the depth, that YADE 2023.02 gives a contact (Ip2_FrictMat_FrictMat_FrictPhys and
/// Ip2_CohFrictMat_CohFrictMat_CohFrictPhys): kn = 2 E_i r_i E_j r_j / (E_i r_i + E_j r_j), ks likewise with E nu.
/// \param radius_i,radius_j m
SpringConstants yade_springs(const YadeMaterial& i, double radius_i, const YadeMaterial& j, double radius_j);

/// pb_kn and pb_ks, Pa/m, of a parallel bond of PFC 2D (radius multiplier 1): springs over its area, which is twice the
/// smaller radius times the depth. \param radius_i,radius_j m
SpringConstants pfc_parallel_bond(const SpringConstants& springs, double radius_i, double radius_j);

}  // namespace equidem
