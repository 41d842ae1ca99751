// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Units that files name.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace equidem {

enum class Quantity { length, time, frequency, share, angle, speed, spin, density, mass, stress };

/// Value of a unit in SI: 1e-3 of "mm", 0.01 of "%"; none where it is no unit of the quantity, or of any.
std::optional<double> unit_factor(std::string_view unit, std::optional<Quantity> quantity = {});

/// "m, dm, cm, mm, um, nm, km": the units of a quantity, for messages.
std::string units_of(Quantity quantity);

/// Metres of a unit of length, or of a length such as "2.5 mm"; none where it is no length.
std::optional<double> length_unit(std::string_view text);

}  // namespace equidem
