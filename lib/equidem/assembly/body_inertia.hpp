// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mass and moment of inertia of the bodies of an assembly.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// Inertia of every body: from its section where the assembly has sections, else that of the disc or sphere of its
/// radius. \throws Error (bad_input) as inertia_of a disc; on spheres where there are sections
std::vector<Inertia> inertia_of(const Assembly& assembly, double density, Body body);

}  // namespace equidem
