// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Main quantities of a sweep over its first key.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sweep/sweep_table.hpp"

namespace equidem {

/// Names of the plots that a sweep may have; none where its keys have no curves: the first is a word or the seed, or
/// more than two vary independently.
std::vector<std::string> curve_names(const SweepPlan& plan);

/// Draws each main quantity that some point has against the first key: one line for each value of the second; of
/// several seeds the points and their mean. Points that are not stable are open and left out of the mean.
/// \param title of the plots; empty: what is varied
/// \throws Error (bad_input) as write_plot
void write_curves(const std::filesystem::path& folder, const SweepPlan& plan, std::span<const SweepPoint> points,
                  const std::string& title);

}  // namespace equidem
