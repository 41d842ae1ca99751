// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Macroscopic strain from the motion of discs.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Two discs between which an elongation is read.
struct StrainGauge {
  std::int32_t first = 0;
  std::int32_t second = 0;
};

/// Distance of the two centres, m.
double gauge_length(const Assembly& assembly, const StrainGauge& gauge);

/// Elongation of a gauge along its own direction over its length: (u_second - u_first) . l / l². The centres must
/// differ. Across a period the motion of images is not known: on a periodic cell the branch is the one inside it.
double gauge_strain(const Assembly& assembly, std::span<const DiscMotion> motions, const StrainGauge& gauge);

/// The displacement gradient h_ij = du_i/dx_j that fits the motion of the chosen discs best (least squares, each disc
/// weighted by its cell area where known). Exact for any uniform gradient.
/// \throws Error (bad_input) where fewer than three discs are chosen or all lie on one line
Tensor2 fitted_displacement_gradient(const Assembly& assembly, std::span<const DiscMotion> motions,
                                     const std::function<bool(std::size_t disc)>& inside);

}  // namespace equidem
