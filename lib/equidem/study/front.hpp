// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The settings that nothing beats: error against time.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace equidem {

/// Cost and error of a setting.
struct CostPoint {
  double seconds = 0;
  double error = 0;  ///< not a number: it takes no part
};

/// The Pareto front: the points than which none is both faster and at least as accurate, in the order of time. Errors
/// fall along it.
std::vector<std::size_t> front_of(std::span<const CostPoint> points);

/// The fastest point with at most that error; empty where there is none.
std::optional<std::size_t> cheapest_within(std::span<const CostPoint> points, double error);

}  // namespace equidem
