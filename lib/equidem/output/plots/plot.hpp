// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The program gnuplot as a child process.
/// Plots of curves, drawn by gnuplot from a script that stays beside the data for the user to edit and rerun.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace equidem {

/// Result of a run of gnuplot.
struct GnuplotRun {
  bool succeeded = false;
  std::string reason;  ///< reason of a failure: "gnuplot is not installed", or the first line of its error output
  bool timed_out = false;
};

/// Run `gnuplot script` in a folder, no shell between; it and what it has started are killed after `time_limit`
/// seconds. \param script a plain file name in the folder
/// \throws Error of kind interrupted where the user asked to stop
GnuplotRun run_gnuplot(const std::filesystem::path& folder, const std::string& script, double time_limit = 30);

/// How the points of a series are shown.
enum class SeriesStyle { line, dashed_line, points, line_with_points };
enum class Marker { circle, square, triangle, diamond };

/// The colour-blind-safe palette of Okabe and Ito (2008).
enum class PlotColour { black, orange, sky_blue, green, yellow, blue, vermilion, purple };

/// One curve. A point that is not finite is a gap.
struct Series {
  std::string label = {};      ///< in the legend; empty: not in the legend
  std::vector<double> x = {};  ///< one value per y
  std::vector<double> y = {};
  SeriesStyle style = SeriesStyle::line;
  PlotColour colour = PlotColour::black;
  Marker marker = Marker::circle;
  bool filled = true;       ///< markers: filled or open
  std::string column = {};  ///< its name in the data file; empty: made of the label

  /// A point behind the others.
  void add(double x_of_point, double y_of_point) { x.push_back(x_of_point), y.push_back(y_of_point); }
};

/// A vertical line across the plot with its label written along its upper end.
struct VerticalLine {
  double x = 0;
  std::string label = {};
  PlotColour colour = PlotColour::black;
};

/// One axis. The range is that of the data where a bound is not given; points outside it are not drawn.
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
  /// Texts use gnuplot's enhanced text: "k_T/k_N", "{/:Italic x}". Text that is the user's goes through literal();
  /// Greek as Unicode, since viewers of SVG lack the font of "{/Symbol n}".
  bool enhanced = false;
  bool places = false;  ///< x and y are places: both have one scale
};

/// Text for an enhanced plot that is drawn as it is, whatever characters it holds.
std::string literal(const std::string& text);
/// literal(), but the words kT and kN are written with subscripts, and "nu" as the Greek letter.
std::string with_symbols(const std::string& text);

/// The data of a plot: its file and where each series lies in it.
struct PlotData {
  struct Place {
    std::string x, y;                      ///< column names
    std::size_t first = 0;                 ///< row of its first point
    std::optional<std::size_t> last = {};  ///< row of its last point; none: all rows are of this series
  };
  std::string csv;
  std::vector<Place> places;  ///< per series
};

/// Where all series have the same x, a row for each x and a column for each series; else a row for each point: the name
/// of its series, which is that of the column in the other case, x and y. A value that is not finite is written "nan",
/// at which gnuplot breaks a line.
PlotData plot_data(const Plot& plot);

/// A script that reads NAME.csv and draws NAME.svg and NAME.png in the folder in which it runs.
std::string plot_script(const std::string& name, const Plot& plot, const PlotData& data);

/// Write NAME.csv (the data: plot_data), NAME.gp (the script; `gnuplot NAME.gp` in that folder draws
/// again) and, by gnuplot, NAME.svg and NAME.png (900 x 650 pixels). If gnuplot is absent or fails, data and script are
/// still written. The legend stands below the plot. The SVG draws at most 15,000
/// points of lines, every n-th.
/// \return a sentence that states why there is no picture; empty: there is
/// \throws Error (bad_input) on a plot that cannot be drawn (x and y of different length, no finite point, a value not
///         positive on a logarithmic axis, an empty range, a name that is no plain file name), and as write_file does
std::string write_plot(const std::filesystem::path& folder, const std::string& name, const Plot& plot, bool overwrite);

}  // namespace equidem
