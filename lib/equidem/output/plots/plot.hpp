// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Plots of curves, drawn by gnuplot from a script that stays beside the data for the user to edit and rerun.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace equidem {

/// How the points of a series are shown.
enum class SeriesStyle { line, dashed_line, points, line_with_points };
enum class Marker { circle, square, triangle, diamond };

/// The colour-blind-safe palette of Okabe and Ito (2008).
enum class PlotColour { black, orange, sky_blue, green, yellow, blue, vermilion, purple };

/// One curve. A point that is not finite is a gap. A line that runs along an earlier one is drawn dashed over it, and
/// the markers of the earlier one are larger, so that both are seen.
struct Series {
  std::string label = {};      ///< in the legend; empty: not in the legend
  std::vector<double> x = {};  ///< one value per y
  std::vector<double> y = {};
  SeriesStyle style = SeriesStyle::line;
  PlotColour colour = PlotColour::black;
  Marker marker = Marker::circle;
  bool filled = true;       ///< markers: filled, or open with a white face
  std::string column = {};  ///< its name in the data file; empty: made of the label
  /// Ends of an error bar at each point; empty: none. A bar with an end that is not finite is left out.
  std::vector<double> low = {}, high = {};
  std::size_t panel = 0;  ///< where the plot has panels
};

/// A vertical line across the plot with its label written along its upper end.
struct VerticalLine {
  double x = 0;
  std::string label = {};
  PlotColour colour = PlotColour::black;
  bool label_left = false;  ///< label left of the line
};

/// A shaded range of x, behind all else.
struct Band {
  double from = 0;
  double to = 0;
  std::string label = {};  ///< written at its top; may be empty
};

/// One axis. The range is that of the data where a bound is not given.
struct Axis {
  std::string label = {};
  std::optional<double> min = {};
  std::optional<double> max = {};
  bool logarithmic = false;
};

/// Text is drawn as it is, whatever characters it holds.
struct Plot {
  std::string title = {};
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};  ///< later ones are drawn on top
  std::vector<VerticalLine> vertical_lines = {};
  std::vector<Band> bands = {};
  /// Texts use gnuplot's enhanced text: "k_T/k_N", "{/:Italic x}". Text that is the user's goes through literal();
  /// Greek as Unicode, since viewers of SVG lack the font of "{/Symbol n}".
  bool enhanced = false;
  /// A marker whose y lies outside the given range is shown as a small triangle at that edge, which the legend
  /// explains.
  bool mark_points_outside = true;
  /// Titles of panels beside and below each other, with axes of the same range; series name theirs. Empty: one plot.
  std::vector<std::string> panels = {};
};

/// Text for an enhanced plot that is drawn as it is, whatever characters it holds.
std::string literal(const std::string& text);
/// literal(), but the words kT and kN are written with subscripts, and "nu" as the Greek letter.
std::string with_symbols(const std::string& text);

/// Result of writing a plot.
struct PlotResult {
  bool drawn = false;        ///< the SVG and the PNG were written
  std::string message = {};  ///< one sentence: files written, or reason without a picture
  std::vector<std::filesystem::path> files = {};
};

/// Write NAME.csv (the data: plot_data of plot_script.hpp), NAME.gp (the script; `gnuplot NAME.gp` in that folder draws
/// again) and, by gnuplot, NAME.svg and NAME.png (900 x 650 pixels). If gnuplot is absent or fails, data and script are
/// still written and the result states the reason. The legend stands below the plot. The SVG draws at most 15,000
/// points of lines, every n-th.
/// \throws Error (bad_input) on a plot that cannot be drawn (x and y of different length, no finite point, a value not
///         positive on a logarithmic axis, an empty range, a name that is no plain file name), and as write_file does
PlotResult write_plot(const std::filesystem::path& folder, const std::string& name, const Plot& plot, bool overwrite);

}  // namespace equidem
