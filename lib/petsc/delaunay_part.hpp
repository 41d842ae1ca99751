// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of a random assembly that a rank makes by itself: one strip of its triangulation.
#pragma once

#include "equidem/assembly/delaunay.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {

/// The strip of a rank with its ghosts, of the assembly that delaunay_assembly makes. Every rank draws all points,
/// since each follows from those before it, and drops them when its strip is triangulated.
/// \throws Error (bad_input) on all ranks as delaunay_assembly; where there are more ranks than discs
Part delaunay_part(const Ranks& ranks, const DelaunayOptions& options);

}  // namespace equidem::petsc
