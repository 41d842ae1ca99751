// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The gnuplot script of a chart of bars, and its data.
#pragma once

#include <string>

#include "equidem/output/plots/plot.hpp"

namespace equidem {

/// One row per bar: label, value, low, high.
std::string bar_data(const BarChart& chart);

/// A script that reads NAME.csv and draws NAME.svg and NAME.png in the folder in which it runs.
std::string bar_script(const std::string& name, const BarChart& chart);

}  // namespace equidem
