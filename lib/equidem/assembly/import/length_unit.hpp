// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Units of length of files.
#pragma once

#include <optional>
#include <string_view>

namespace equidem {

/// Metres of a unit: "m", "cm", "mm", "um", "nm", or a length such as "2.5 mm"; none where it is no length.
std::optional<double> length_unit(std::string_view text);

/// Metres of the unit of length of LAMMPS' systems of units: si, cgs, micro, nano; none of others, whose length is the
/// user's (lj) or not that of grains.
std::optional<double> lammps_length_unit(std::string_view units);

}  // namespace equidem
