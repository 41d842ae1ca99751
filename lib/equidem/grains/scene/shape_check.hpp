// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a scene with ellipses or clumps must hold to.
#pragma once

#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// \throws Error (bad_input): short half-axis not in (0, radius], a body that is ellipse and clump, a clump that is not
///         there, has no discs,
///         discs outside the radius or its centre of mass elsewhere than at the origin
void check_shape(const GrainScene& scene, std::size_t grain);

/// \throws Error (bad_input): laws that ellipses and clumps cannot have, spheres among them
void check_laws_of_shapes(const GrainScene& scene, const GrainOptions& options);

/// Whether a part of one grain has its centre in a part of the other, or ellipses run through one another: the lines
/// between the centres of curvature of their tips cross. Of discs: whether the centre of one is in the other.
bool are_inside_one_another(const GrainScene& scene, const Grain& a, const Grain& b);

/// Whether a centre of a part is behind a wall or on it.
bool is_behind(const GrainScene& scene, const Grain& grain, const Wall& wall);

}  // namespace equidem
