// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mass and moment of inertia of the bodies of an assembly.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// Of the section of every body where the assembly has sections, else of the disc or sphere of its radius.
/// \throws Error (bad_input) as inertia_of a disc; on spheres where there are sections
std::vector<Inertia> inertia_of(const Assembly& assembly, double density, Body body);

}  // namespace equidem
