// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Checks of scenes with ellipses or clumps.
#pragma once

#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// \throws Error (bad_input): short half-axis not in (0, radius], a body that is both ellipse and clump, a clump that
///         does not exist, has no discs, has discs outside the radius or its centre of mass not at the origin
void check_shape(const GrainScene& scene, std::size_t grain);

/// \throws Error (bad_input): laws that do not support ellipses and clumps; spheres in the scene
void check_laws_of_shapes(const GrainScene& scene, const GrainOptions& options);

/// Whether a part of one grain has its centre in a part of the other, or ellipses intersect so deeply that the lines
/// between the centres of curvature of their tips cross. For discs: whether the centre of one is in the other.
bool are_inside_one_another(const GrainScene& scene, const Grain& a, const Grain& b);

/// Whether the centre of a part is behind a wall or on it.
bool is_behind(const GrainScene& scene, const Grain& grain, const Wall& wall);

}  // namespace equidem
