// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Power cells along the sides of a rectangle.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/power_cells.hpp"

namespace equidem {

/// The groups left, right, bottom, top and bottom_left, ... of a free assembly in `domain`: along each side, the
/// power diagram of the plane is that of the points of the side, which is found afresh from the candidates. Adds the
/// part of each area that lies between centre and side, half of distance times length.
/// \param candidates discs of which cells may reach a side, ascending
std::map<std::string, DiscGroup> side_cells(const Assembly& assembly, std::span<const std::int32_t> candidates,
                                            const Rectangle& domain, std::vector<double>& areas);

}  // namespace equidem
