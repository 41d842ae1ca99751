// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The gnuplot script of a plot, and its data as columns.
#pragma once

#include <string>
#include <vector>

#include "equidem/output/plots/plot.hpp"

namespace equidem {

/// The data of a plot: the columns of its file and where each series finds its two.
struct PlotData {
  struct Place {
    std::string x;  ///< column names
    std::string y;
    std::string low, high;  ///< empty: no error bars
  };
  std::string csv;
  std::vector<Place> places;  ///< per series
};

/// Columns of different length are padded with empty cells; a value that is not finite is written "nan", at which
/// gnuplot breaks a line.
PlotData plot_data(const Plot& plot);

/// A script that reads NAME.csv and draws NAME.svg and NAME.png in the folder in which it runs.
std::string plot_script(const std::string& name, const Plot& plot, const PlotData& data);

}  // namespace equidem
