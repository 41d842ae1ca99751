// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The name that a misspelt one was meant to be.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace equidem {

/// Number of letters to insert, delete, replace or swap with their neighbour to turn one word into the other (optimal
/// string alignment), upper and lower case taken as equal.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `name`; none where even that is further than a third of its letters (at least one, two
/// from four letters on). The first of equally near ones.
std::optional<std::string> nearest(std::string_view name, std::span<const std::string> candidates);

}  // namespace equidem
