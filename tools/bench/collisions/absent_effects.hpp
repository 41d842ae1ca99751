// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What is not there costs nothing: free flight, friction.
#pragma once

#include <string>

namespace equidem::bench {

/// Bodies that touch nothing, beside a loop by hand that moves points.
std::string compare_free_flight(int discs, int rounds);

/// A packed bed without friction beside a loop by hand that knows none, and with it.
std::string compare_friction(int columns, int rows, int rounds);

}  // namespace equidem::bench
