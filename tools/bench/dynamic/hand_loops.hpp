// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The loops of the library written by hand without anything that a scene may switch on: what an absent effect must not
/// cost.
#pragma once

#include <memory>

#include "equidem/assembly/assembly.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"

#include "contender.hpp"

namespace equidem::bench {

/// Small motions, equal springs, equal discs, leapfrog; the layout of memory and the vectors are the library's.
std::unique_ptr<Contender> loop_by_hand(const Assembly& assembly, LoopKind::Springs springs);

}  // namespace equidem::bench
