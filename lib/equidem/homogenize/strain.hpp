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

/// Elongation of a gauge along its own direction over its length.
double gauge_strain(const Assembly& assembly, std::span<const DiscMotion> motions, const StrainGauge& gauge);

/// The displacement gradient h_ij = du_i/dx_j that fits the motion of the chosen discs best (least squares,
/// each disc weighted by its cell area where known). \throws Error (bad_input) where the discs lie on one
/// line
Tensor2 fitted_displacement_gradient(const Assembly& assembly, std::span<const DiscMotion> motions,
                                     const std::function<bool(std::size_t disc)>& inside);

}  // namespace equidem
