// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Macroscopic stress from contact forces.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Stress of every disc, Pa: s_ij = (1/V) sum F_i l_j with l = r n from its centre to each contact point and
/// V its cell area (Abe 1996, eq. 50, in general form). Not symmetric where a moment holds the disc (eq. 55);
/// never made so here. \throws Error (bad_input) where the assembly has no cell areas
std::vector<Tensor2> disc_stresses(const Assembly& assembly, std::span<const ContactForce> forces);

/// Stress of a region, Pa: the average of disc stresses weighted by cell area over the discs that `inside`
/// accepts. \throws Error (bad_input) where the region holds no disc
Tensor2 average_stress(const Assembly& assembly, std::span<const Tensor2> stresses,
                       const std::function<bool(std::size_t disc)>& inside);

/// Stress of the whole assembly, Pa.
Tensor2 macroscopic_stress(const Assembly& assembly, std::span<const ContactForce> forces);

}  // namespace equidem
