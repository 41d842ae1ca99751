// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/plot_script.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {
namespace {

constexpr std::array<const char*, 8> palette = {"#000000", "#E69F00", "#56B4E9", "#009E73",
                                                "#F0E442", "#0072B2", "#D55E00", "#CC79A7"};

struct AxisRange {
  double min = 0, max = 1;
};

/// Outwards to a multiple of a 1-2-5 step near a fiftieth of the span.
AxisRange rounded(double low, double high) {
  const double raw = (high - low) / 50;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = raw / power < 2 ? 2 * power : raw / power < 5 ? 5 * power : 10 * power;
  return {step * std::floor(low / step), step * std::ceil(high / step)};
}

/// The given bounds, else those of the data with a small margin, rounded outwards.
AxisRange range_of(const Axis& axis, const std::vector<Series>& series, std::vector<double> Series::*values) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Series& one : series) {
    for (const double v : one.*values) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  if (axis.logarithmic) {
    const double margin = low < high ? std::pow(high / low, 0.05) : 2;
    low /= margin, high *= margin;
  } else {
    const double margin = low < high ? 0.05 * (high - low) : std::max(0.1 * std::abs(low), 1e-12);
    const AxisRange padded = rounded(low - margin, high + margin);
    low = padded.min, high = padded.max;
  }
  return {axis.min.value_or(low), axis.max.value_or(high)};
}

const char* hex(PlotColour colour) {
  return palette[static_cast<std::size_t>(colour)];
}

/// A single-quoted string of gnuplot: nothing in it is expanded (no backslash, no backtick), a quote is doubled.
std::string gnuplot_string(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? ' ' : c;
  }
  return result + "'";
}

/// Letters and digits of a label, joined by single underscores.
std::string column_name(const std::string& label) {
  std::string name;
  for (const char c : label) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 0x80) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

/// gnuplot's point types: open and filled.
int point_type(Marker marker, bool filled) {
  switch (marker) {
    case Marker::circle:
      return filled ? 7 : 6;
    case Marker::square:
      return filled ? 5 : 4;
    case Marker::triangle:
      return filled ? 9 : 8;
    case Marker::diamond:
      return filled ? 13 : 12;
  }
  return 7;
}

bool has_markers(const Series& series) {
  return series.style == SeriesStyle::points || series.style == SeriesStyle::line_with_points;
}

/// The parts of the plot command that draw one series. An open marker is a white face under an outline.
std::vector<std::string> plot_clauses(const Plot& plot, const Series& series, const PlotData::Place& place,
                                      const AxisRange& y_range, const std::string& plain) {
  const std::string columns = fmt::format("data using \"{}\":\"{}\"", place.x, place.y);
  const std::string title = series.label.empty() ? "notitle" : "title " + gnuplot_string(series.label) + plain;
  const std::string face = fmt::format("with points pt {} ps marker", point_type(series.marker, true));
  const std::string outline = fmt::format("with points pt {} ps marker lw 1.6 lc rgb '{}'",
                                          point_type(series.marker, false), hex(series.colour));
  std::vector<std::string> clauses;
  if (series.style == SeriesStyle::line || series.style == SeriesStyle::dashed_line) {
    clauses.push_back(fmt::format("{} with lines lw 1.8{} lc rgb '{}' {}", columns,
                                  series.style == SeriesStyle::dashed_line ? " dt (8,5)" : "", hex(series.colour),
                                  title));
  }
  if (series.style == SeriesStyle::line_with_points) {
    clauses.push_back(fmt::format("{} with linespoints pt {} ps marker lw 1.6 lc rgb '{}' {}", columns,
                                  point_type(series.marker, series.filled), hex(series.colour), title));
    if (!series.filled) {
      clauses.push_back(fmt::format("{} {} lc rgb '#ffffff' notitle", columns, face));
      clauses.push_back(fmt::format("{} {} notitle", columns, outline));
    }
  } else if (series.style == SeriesStyle::points && series.filled) {
    clauses.push_back(fmt::format("{} {} lc rgb '{}' {}", columns, face, hex(series.colour), title));
  } else if (series.style == SeriesStyle::points) {
    clauses.push_back(fmt::format("{} {} lc rgb '#ffffff' notitle", columns, face));
    clauses.push_back(fmt::format("{} {} {}", columns, outline, title));
  }
  if (has_markers(series) && plot.mark_points_outside && !plot.y.logarithmic) {
    const double margin = 0.018 * (y_range.max - y_range.min);
    const auto outside = [&](bool above) {
      return std::any_of(series.y.begin(), series.y.end(),
                         [&](double y) { return std::isfinite(y) && (above ? y > y_range.max : y < y_range.min); });
    };
    const auto triangle = [&](const char* relation, double bound, double at, int type) {
      return fmt::format(
          "data using \"{}\":(column(\"{}\") {} {} ? {} : NaN) with points pt {} ps 0.8*marker lw 1.4 lc rgb "
          "'{}' "
          "notitle",
          place.x, place.y, relation, bound, at, type, hex(series.colour));
    };
    if (outside(true)) clauses.push_back(triangle(">", y_range.max, y_range.max - margin, series.filled ? 9 : 8));
    if (outside(false)) {
      clauses.push_back(triangle("<", y_range.min, y_range.min + margin, series.filled ? 11 : 10));
    }
  }
  return clauses;
}

std::string vertical_line(const VerticalLine& line, const std::string& plain) {
  std::string text =
      fmt::format("set arrow from first {0}, graph 0 to first {0}, graph 1 nohead back lw 1.1 dt (5,4) lc rgb '{1}'\n",
                  line.x, hex(line.colour));
  if (!line.label.empty()) {
    text +=
        fmt::format("set label {} at first {}, graph 0.985 right rotate by 90 offset char {},0 tc rgb '{}' front{}\n",
                    gnuplot_string(line.label), line.x, line.label_left ? -1 : 1, hex(line.colour), plain);
  }
  return text;
}

/// Scale and tic labels. A logarithmic axis shorter than two decades is labelled at 1, 2 and 5, a longer one at
/// powers of ten.
std::string axis_scale(char letter, const Axis& axis, const AxisRange& range) {
  if (!axis.logarithmic) return fmt::format("set format {} '%g'\n", letter);
  std::string text = fmt::format("set logscale {}\n", letter);
  if (std::log10(range.max / range.min) > 2 || range.min < 1e-4 || range.max > 1e5) {
    return text + fmt::format("set format {} '10^{{%T}}'\n", letter);
  }
  std::vector<std::string> tics;
  for (int decade = -5; decade <= 5; ++decade)
    for (const int digit : {1, 2, 5}) tics.push_back(fmt::format("{}e{}", digit, decade));
  return text + fmt::format("set format {0} '%g'\nset {0}tics ({1})\n", letter, joined(tics));
}

}  // namespace

PlotData plot_data(const Plot& plot) {
  PlotData data;
  std::vector<std::string> names;
  std::vector<const std::vector<double>*> columns;
  const auto add = [&](const std::vector<double>& values, std::string name, const char* fallback) {
    if (name.empty()) name = fallback;
    std::string unique = name;
    for (int k = 2; std::find(names.begin(), names.end(), unique) != names.end(); ++k) {
      unique = fmt::format("{}_{}", name, k);
    }
    names.push_back(unique);
    columns.push_back(&values);
    return unique;
  };
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const Series& series = plot.series[k];
    PlotData::Place place;
    for (std::size_t earlier = 0; earlier < k && place.x.empty(); ++earlier) {
      if (plot.series[earlier].x == series.x) place.x = data.places[earlier].x;
    }
    if (place.x.empty()) place.x = add(series.x, column_name(plot.x.label), "x");
    place.y = add(series.y, column_name(series.column.empty() ? series.label : series.column), "y");
    data.places.push_back(place);
  }

  std::size_t rows = 0;
  for (const auto* column : columns) rows = std::max(rows, column->size());
  CsvText text(names, rows);
  for (std::size_t row = 0; row < rows; ++row) {
    for (const auto* column : columns) {
      if (row >= column->size()) {
        text.empty_cell();
      } else {
        text.cell(std::isfinite((*column)[row]) ? (*column)[row] : NAN);
      }
    }
    text.end_row();
  }
  data.csv = text.text();
  return data;
}

std::string plot_script(const std::string& name, const Plot& plot, const PlotData& data) {
  const AxisRange x = range_of(plot.x, plot.series, &Series::x), y = range_of(plot.y, plot.series, &Series::y);
  const std::string plain = plot.enhanced ? "" : " noenhanced";
  std::string text = fmt::format(
      "# Draws {0}.svg and {0}.png from {0}.csv. Edit it and run, in this folder:  gnuplot {0}.gp\n"
      "data = {1}\nset datafile separator comma\nset encoding utf8\n\n"
      "set border 3 lw 0.8 lc rgb '#333333'\nset tics out nomirror scale 0.7 tc rgb '#222222'\n"
      "set title {2} offset 0,-0.2{3}\nset xlabel {4} offset 0,0.3{3}\nset ylabel {5}{3}\n",
      name, gnuplot_string(name + ".csv"), gnuplot_string(plot.title), plain, gnuplot_string(plot.x.label),
      gnuplot_string(plot.y.label));
  text += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x.min, x.max, y.min, y.max);
  text += axis_scale('x', plot.x, x) + axis_scale('y', plot.y, y);
  text += fmt::format("set key below horizontal Left reverse samplen 2.2 spacing 1.25 width 1 height 0.7{}\n", plain);
  for (const Band& band : plot.bands) {
    text += fmt::format(
        "set object rectangle from first {}, graph 0 to first {}, graph 1 fc rgb '#eef2f6' fs solid noborder "
        "behind\n",
        band.from, band.to);
    if (!band.label.empty()) {
      text +=
          fmt::format("set label {} at first {}, graph 0.965 center tc rgb '#666666'{}\n", gnuplot_string(band.label),
                      plot.x.logarithmic ? std::sqrt(band.from * band.to) : 0.5 * (band.from + band.to), plain);
    }
  }
  for (const VerticalLine& line : plot.vertical_lines) text += vertical_line(line, plain);

  std::vector<std::string> clauses;
  for (std::size_t k = 0; k < plot.series.size(); ++k)
    std::ranges::move(plot_clauses(plot, plot.series[k], data.places[k], y, plain), std::back_inserter(clauses));
  // Each terminal of gnuplot has its own unit for the size of markers and fonts.
  text += fmt::format(
      "\nset terminal svg size 900,650 enhanced font 'sans-serif,16' background rgb 'white'\n"
      "set output {}\nmarker = 0.72\nplot {}\n",
      gnuplot_string(name + ".svg"), joined(clauses, ", \\\n     "));
  text += fmt::format(
      "\nset terminal pngcairo size 900,650 enhanced font 'sans-serif,13' background rgb 'white'\n"
      "set output {}\nmarker = 1.25\nreplot\nset output\n",
      gnuplot_string(name + ".png"));
  return text;
}

}  // namespace equidem
