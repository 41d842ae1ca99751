// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How the series of a plot are drawn: ranges of the axes, and the parts of gnuplot's plot command.
#pragma once

#include <string>
#include <vector>

#include "equidem/output/plots/plot_script.hpp"

namespace equidem {

struct AxisRange {
  double min = 0, max = 1;
};

/// Ranges of both axes.
struct PlotFrame {
  AxisRange x, y;
};
PlotFrame frame_of(const Plot& plot);

/// Changes that keep a series visible where others coincide with it.
struct SeriesLook {
  int dash = 0;            ///< 0: solid; else the number of a pattern of dashes
  double marker_size = 1;  ///< over the usual one
};
/// Two series of one panel coincide where most points of either lie within 1/200 of the frame from the other. The later
/// one then has another dash pattern, and the earlier one larger markers.
std::vector<SeriesLook> looks_of(const Plot& plot, const PlotFrame& frame);

/// The parts of the plot command that draw one series. An open marker is a white face under an outline.
/// \param plain " noenhanced", or nothing
std::vector<std::string> plot_clauses(const Plot& plot, const Series& series, const PlotData::Place& place,
                                      const PlotFrame& frame, const SeriesLook& look, const std::string& plain);

/// A marker of the series lies above or below the frame and is shown at its edge.
bool has_points_outside(const Plot& plot, const Series& series, const PlotFrame& frame);

}  // namespace equidem
