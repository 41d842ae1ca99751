// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Layout of a plot: ranges of the axes, legend, labels of vertical lines.
#pragma once

#include <string>
#include <vector>

#include "equidem/output/plots/plot.hpp"

namespace equidem {

struct AxisRange {
  double min = 0;
  double max = 1;
};

/// Position of the label of a vertical line.
struct LineLabelPlace {
  bool top = true;    ///< at the upper or the lower end of the line
  bool right = true;  ///< right or left of it
};

struct PlotLayout {
  AxisRange x, y;
  std::string legend;  ///< gnuplot's words: "top right", ..., or "below" where every corner is crowded
  std::vector<LineLabelPlace> line_labels;
};

/// Ranges that were not given are those of the data with a small margin, rounded outwards; the legend takes the
/// corner, and each label the end and side of its line, under which fewest points lie. Widths of text are estimated.
PlotLayout lay_out(const Plot& plot);

}  // namespace equidem
