// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Calibrated springs as a table of the parameters of other programs.
#pragma once

#include <optional>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// LAMMPS, YADE and PFC, with units, depth and what does not hold. Without a table where springs differ from contact to
/// contact or kT is negative.
/// \param bond_width as BendingOptions, of springs that bend
Results engine_springs_results(const Assembly& assembly, const ContactSprings& springs, const SpringConstants& k,
                               std::optional<double> bond_width);

}  // namespace equidem
