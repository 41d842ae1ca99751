// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/plot.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>
#include <system_error>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/page/drawn_figures.hpp"
#include "equidem/output/plots/gnuplot.hpp"
#include "equidem/output/plots/plot_script.hpp"

namespace equidem {
namespace {

/// gnuplot takes a file name that begins with '<' or '|' as a command, so only plain names pass.
void check_name(const std::string& name) {
  const bool plain = !name.empty() && name.front() != '-' && name.front() != '.' &&
                     std::all_of(name.begin(), name.end(), [](unsigned char c) {
                       return c >= 0x80 || std::isalnum(c) != 0 ||
                              (c != 0 && std::string("_-+.=, ").find(static_cast<char>(c)) != std::string::npos);
                     });
  if (!plain) {
    bad_input(fmt::format("'{}' cannot name the files of a plot", name),
              "it must be made of letters, digits and _ - + . = , or spaces, and not begin with - or .",
              "Choose a plain name");
  }
}

void check_axis(const Axis& axis, const char* letter) {
  for (const auto& bound : {axis.min, axis.max}) {
    if (!bound) continue;
    if (!std::isfinite(*bound) || (axis.logarithmic && *bound <= 0)) {
      bad_input(fmt::format("the {} axis of a plot has the bound {}", letter, *bound),
                axis.logarithmic ? "a logarithmic axis has positive, finite bounds" : "bounds are finite",
                "Give another bound, or none");
    }
  }
  if (axis.min && axis.max && !(*axis.min < *axis.max)) {
    bad_input(fmt::format("the {} axis of a plot goes from {} to {}", letter, *axis.min, *axis.max),
              "the first bound is the smaller one", "Exchange them");
  }
}

/// \return whether it has a finite point
bool check_series(const Series& series, const Plot& plot) {
  if (series.x.size() != series.y.size()) {
    bad_input(fmt::format("series '{}' of a plot has {} of x and {} of y", series.label,
                          counted(series.x.size(), "value"), counted(series.y.size(), "value")),
              "each point has both", "Give as many x as y");
  }
  if (series.low.size() != series.high.size() || (!series.low.empty() && series.low.size() != series.y.size())) {
    bad_input(fmt::format("series '{}' of a plot has {} with {} and {} of error bars", series.label,
                          counted(series.y.size(), "point"), counted(series.low.size(), "lower end"),
                          counted(series.high.size(), "upper end")),
              "each bar has a point and two ends", "Give as many of each, or no bars");
  }
  if (series.panel >= std::max<std::size_t>(plot.panels.size(), 1)) {
    bad_input(fmt::format("series '{}' of a plot is in panel {}", series.label, series.panel),
              fmt::format("panels are counted from 0, and there are {}", plot.panels.size()),
              "Name another panel, or add it");
  }
  bool any_point = false;
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    if (!std::isfinite(series.x[k]) || !std::isfinite(series.y[k])) continue;
    any_point = true;
    if ((plot.x.logarithmic && series.x[k] <= 0) || (plot.y.logarithmic && series.y[k] <= 0)) {
      bad_input(fmt::format("point {} of series '{}' of a plot is ({}, {})", k, series.label, series.x[k], series.y[k]),
                "a logarithmic axis shows positive values only", "Leave it out, or use a linear axis");
    }
  }
  return any_point;
}

void check_plot(const Plot& plot) {
  check_axis(plot.x, "x");
  check_axis(plot.y, "y");
  bool any_point = false;
  for (const Series& series : plot.series) any_point = check_series(series, plot) || any_point;
  if (!any_point) bad_input("a plot has no finite point", "there is nothing to draw", "Give it a series");
}

/// A label without the signs of gnuplot's enhanced text.
std::string without_markup(const std::string& label) {
  std::string text;
  for (std::size_t k = 0; k < label.size(); ++k) {
    if (label[k] == '\\' && k + 1 < label.size()) {
      text += label[++k];
    } else if (std::string_view("{}_^").find(label[k]) == std::string_view::npos) {
      text += label[k];
    }
  }
  return text;
}

/// Write data and script, and let gnuplot draw.
PlotResult draw(const std::filesystem::path& folder, const std::string& name, const std::string& title,
                const std::string& csv, const std::string& script, bool overwrite) {
  const auto path = [&](const char* extension) { return folder / (name + extension); };
  for (const char* extension : {".csv", ".gp", ".svg", ".png"}) check_writable(path(extension), overwrite);

  write_file(path(".csv"), csv, overwrite);
  write_file(path(".gp"), script, overwrite);
  PlotResult result;
  result.files = {path(".csv"), path(".gp")};
  // A picture of earlier data must not stay beside new data where gnuplot fails.
  std::error_code ignored;
  for (const char* extension : {".svg", ".png"}) std::filesystem::remove(path(extension), ignored);

  const GnuplotRun run = DrawnFigures::gnuplot_hangs() ? GnuplotRun{false, "gnuplot did not end at the plot before"}
                                                       : run_gnuplot(folder, name + ".gp");
  result.drawn =
      run.succeeded && std::filesystem::exists(path(".svg"), ignored) && std::filesystem::exists(path(".png"), ignored);
  if (result.drawn) {
    result.files.insert(result.files.end(), {path(".svg"), path(".png")});
    result.message = fmt::format("The plot is in '{}' and '{}'.", path(".svg").string(), path(".png").string());
  } else {
    for (const char* extension : {".svg", ".png"}) std::filesystem::remove(path(extension), ignored);
    result.message = fmt::format("No picture was drawn ({}): data and script are in '{}' and '{}'.",
                                 run.reason.empty() ? "gnuplot wrote no file" : run.reason, path(".csv").string(),
                                 path(".gp").string());
  }
  DrawnFigures::add({.name = name,
                     .title = title,
                     .svg = result.drawn ? path(".svg") : std::filesystem::path(),
                     .missing = result.drawn ? "" : result.message,
                     .timed_out = run.timed_out});
  return result;
}

}  // namespace

PlotResult write_plot(const std::filesystem::path& folder, const std::string& name, const Plot& plot, bool overwrite) {
  check_name(name);
  check_plot(plot);
  const PlotData data = plot_data(plot);
  const std::string title =
      fmt::format("{}{}{} against {}", plot.title, plot.title.empty() ? "" : ": ", plot.y.label, plot.x.label);
  return draw(folder, name, plot.enhanced ? without_markup(title) : title, data.csv, plot_script(name, plot, data),
              overwrite);
}

}  // namespace equidem
