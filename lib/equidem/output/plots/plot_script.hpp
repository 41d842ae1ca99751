// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The gnuplot script of a plot, and its data as columns.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "equidem/output/plots/plot.hpp"

namespace equidem {

/// The data of a plot: its file and where each series lies in it.
struct PlotData {
  struct Place {
    std::string x;  ///< column names
    std::string y;
    std::string low, high;                 ///< empty: no error bars
    std::size_t first = 0;                 ///< row of its first point
    std::optional<std::size_t> last = {};  ///< row of its last point; none: all rows are of this series
  };
  std::string csv;
  std::vector<Place> places;  ///< per series
};

/// Where all series have the same x, a row for each x and a column for each series; else a row for each point: the name
/// of its series, x, y and, where any series has error bars, their ends, empty for the others. The name is that of the
/// column in the other case. A value that is not finite is written "nan", at which gnuplot breaks a line.
PlotData plot_data(const Plot& plot);

/// A script that reads NAME.csv and draws NAME.svg and NAME.png in the folder in which it runs.
std::string plot_script(const std::string& name, const Plot& plot, const PlotData& data);

}  // namespace equidem
