// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/plot_script.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/gnuplot_text.hpp"
#include "equidem/output/plots/plot_series.hpp"

namespace equidem {
namespace {

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

/// The format of labels of a linear axis: six digits, or as many as tell tics apart, of which there are up to ten.
std::string number_format(const AxisRange& range) {
  const double largest = std::max(std::abs(range.min), std::abs(range.max));
  const double wanted = std::floor(std::log10(largest / (range.max - range.min))) + 3;
  constexpr int usual = 6, most = 15;
  const int digits = std::isfinite(wanted) ? static_cast<int>(std::clamp<double>(wanted, usual, most)) : usual;
  return digits == usual ? "%g" : fmt::format("%.{}g", digits);
}

/// Scale and tic labels. A logarithmic axis shorter than two decades is labelled at 1, 2 and 5, a longer one at
/// powers of ten.
std::string axis_scale(char letter, const Axis& axis, const AxisRange& range) {
  if (!axis.logarithmic) return fmt::format("set format {} '{}'\n", letter, number_format(range));
  std::string text = fmt::format("set logscale {}\n", letter);
  if (std::log10(range.max / range.min) > 2 || range.min < 1e-4 || range.max > 1e5) {
    return text + fmt::format("set format {} '10^{{%T}}'\n", letter);
  }
  std::vector<std::string> tics;
  for (int decade = -5; decade <= 5; ++decade)
    for (const int digit : {1, 2, 5}) tics.push_back(fmt::format("{}e{}", digit, decade));
  return text + fmt::format("set format {0} '%g'\nset {0}tics ({1})\n", letter, joined(tics));
}

std::string shaded_band(const Band& band, const Axis& axis, const std::string& plain) {
  std::string text = fmt::format(
      "set object rectangle from first {}, graph 0 to first {}, graph 1 fc rgb '#eef2f6' fs solid noborder behind\n",
      band.from, band.to);
  if (!band.label.empty()) {
    text += fmt::format("set label {} at first {}, graph 0.965 center tc rgb '#666666'{}\n", gnuplot_string(band.label),
                        axis.logarithmic ? std::sqrt(band.from * band.to) : 0.5 * (band.from + band.to), plain);
  }
  return text;
}

/// Points of lines that the SVG leaves out, so that it has at most 15,000 of them, less than 300 kB.
std::size_t svg_stride(const Plot& plot) {
  std::size_t points = 0;
  for (const Series& series : plot.series)
    points += series.style == SeriesStyle::line || series.style == SeriesStyle::dashed_line ? series.x.size() : 0;
  return points / 15000 + 1;
}

std::string plot_command(const std::vector<std::string>& clauses) {
  return fmt::format("plot {}\n", joined(clauses, ", \\\n     "));
}

/// One plot with its legend below. An empty line under the label of the x axis keeps the legend clear of it.
std::string one_panel(const std::string& name, const Plot& plot, std::vector<std::string> clauses, bool outside,
                      const std::string& plain) {
  if (outside)
    clauses.emplace_back(
        "keyentry with points pt 8 ps 0.8*marker lw 1.4 lc rgb '#444444' title 'outside the frame, at its edge'");
  std::size_t longest = 0;
  for (const Series& series : plot.series) longest = std::max(longest, series.label.size());
  const double share = longest > 30 || plot.series.size() > 6 ? 0.82 : 1;  // of the font size
  return fmt::format("set xlabel {}.\"\\n \" offset 0,0.3{}\nset ylabel {}{}\n", gnuplot_string(plot.x.label), plain,
                     gnuplot_string(plot.y.label), plain) +
         draw_twice(
             name,
             [&](double font_size) {
               return fmt::format(
                          "set key below horizontal Left reverse samplen 2.2 spacing 1.2 width 1 height 0.4 font "
                          "',{:.3g}'{}\n",
                          share * font_size, plain) +
                      title_font(plot.title, font_size) + plot_command(clauses);
             },
             svg_stride(plot));
}

/// Panels beside and below each other; the axes are labelled once, at the left and below.
std::string all_panels(const std::string& name, const Plot& plot, const std::vector<std::vector<std::string>>& clauses,
                       const PlotFrame& frame, const std::string& plain) {
  const auto count = clauses.size();
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const std::size_t rows = (count + columns - 1) / columns;
  return "unset key\n" +
         draw_twice(
             name,
             [&](double font_size) {
               std::string text = fmt::format(
                   "set multiplot layout {},{} title {}{} margins 0.1,0.98,0.1,0.88 spacing 0.025,0.06\n"
                   "set tics font ',{:.3g}'\nset label 1 {} at screen 0.54,0.03 center{}\n"
                   "set label 2 {} at screen 0.025,0.49 center rotate by 90{}\n",
                   rows, columns, gnuplot_string(plot.title), plain, 0.75 * font_size, gnuplot_string(plot.x.label),
                   plain, gnuplot_string(plot.y.label), plain);
               for (std::size_t k = 0; k < count; ++k) {
                 text += fmt::format("set title {} offset 0,-0.6 font ',{:.3g}'{}\n", gnuplot_string(plot.panels[k]),
                                     0.85 * font_size, plain);
                 text += fmt::format("set format x '{}'\nset format y '{}'\n",
                                     k + columns >= count ? number_format(frame.x) : "",
                                     k % columns == 0 ? number_format(frame.y) : "");
                 text += clauses[k].empty() ? "plot NaN notitle\n" : plot_command(clauses[k]);
                 if (k == 0) text += "unset label 1\nunset label 2\n";
               }
               return text + "unset multiplot\n";
             },
             svg_stride(plot));
}

/// Names without repetition: "nu", "nu_2".
class UniqueNames {
 public:
  std::string add(const std::string& name, const char* fallback) {
    const std::string wanted = name.empty() ? fallback : name;
    std::string unique = wanted;
    for (int k = 2; std::ranges::find(names_, unique) != names_.end(); ++k) unique = fmt::format("{}_{}", wanted, k);
    names_.push_back(unique);
    return unique;
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::vector<std::string> names_;
};

std::string series_name(const Series& series) {
  return column_name(series.column.empty() ? series.label : series.column);
}

double finite_or_nan(double value) {
  return std::isfinite(value) ? value : NAN;
}

/// A row for each x.
PlotData wide_table(const Plot& plot) {
  PlotData data;
  UniqueNames names;
  std::vector<const std::vector<double>*> columns;
  const auto add = [&](const std::vector<double>& values, const std::string& name, const char* fallback) {
    columns.push_back(&values);
    return names.add(name, fallback);
  };
  for (const Series& series : plot.series) {
    PlotData::Place& place = data.places.emplace_back();
    place.x = columns.empty() ? add(series.x, column_name(plot.x.label), "x") : data.places.front().x;
    place.y = add(series.y, series_name(series), "y");
    if (series.low.empty()) continue;
    place.low = add(series.low, place.y + "_low", "low");
    place.high = add(series.high, place.y + "_high", "high");
  }
  const std::size_t rows = columns.empty() ? 0 : columns.front()->size();
  CsvText text(names.all(), rows);
  for (std::size_t row = 0; row < rows; ++row) {
    for (const auto* column : columns) text.cell(finite_or_nan((*column)[row]));
    text.end_row();
  }
  data.csv = text.text();
  return data;
}

/// A row for each point.
PlotData tidy_table(const Plot& plot) {
  PlotData data;
  UniqueNames columns, names;
  columns.add("series", "");
  const std::string x = columns.add(column_name(plot.x.label), "x"), y = columns.add(column_name(plot.y.label), "y");
  const bool bars = std::ranges::any_of(plot.series, [](const Series& series) { return !series.low.empty(); });
  const std::string low = bars ? columns.add("low", "") : "", high = bars ? columns.add("high", "") : "";
  std::size_t row = 0, total = 0;
  for (const Series& series : plot.series) total += series.x.size();
  CsvText text(columns.all(), total);
  for (const Series& series : plot.series) {
    const std::string name = names.add(series_name(series), "y");
    const bool has_bars = !series.low.empty();
    const std::size_t first = series.x.empty() ? total : row;  // behind all rows: no point
    row += series.x.size();
    data.places.push_back({x, y, has_bars ? low : "", has_bars ? high : "", first, series.x.empty() ? first : row - 1});
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      text.cell(name);
      text.cell(finite_or_nan(series.x[k]));
      text.cell(finite_or_nan(series.y[k]));
      for (const auto* end : {&series.low, &series.high}) {
        if (has_bars) text.cell(finite_or_nan((*end)[k]));
        if (bars && !has_bars) text.empty_cell();
      }
      text.end_row();
    }
  }
  data.csv = text.text();
  return data;
}

}  // namespace

PlotData plot_data(const Plot& plot) {
  const bool same_x = std::ranges::all_of(plot.series, [&](const Series& s) { return s.x == plot.series.front().x; });
  return same_x ? wide_table(plot) : tidy_table(plot);
}

std::string plot_script(const std::string& name, const Plot& plot, const PlotData& data) {
  const PlotFrame frame = frame_of(plot);
  const std::string plain = plot.enhanced ? "" : " noenhanced";
  std::string text = script_head(name, plot.title, plain);
  text += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", frame.x.min, frame.x.max, frame.y.min, frame.y.max);
  text += axis_scale('x', plot.x, frame.x) + axis_scale('y', plot.y, frame.y);
  for (const Band& band : plot.bands) text += shaded_band(band, plot.x, plain);
  for (const VerticalLine& line : plot.vertical_lines) text += vertical_line(line, plain);

  const std::vector<SeriesLook> looks = looks_of(plot, frame);
  std::vector<std::vector<std::string>> clauses(std::max<std::size_t>(plot.panels.size(), 1));
  bool outside = false;
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const Series& series = plot.series[k];
    std::ranges::move(plot_clauses(plot, series, data.places[k], frame, looks[k], plain),
                      std::back_inserter(clauses[series.panel]));
    outside = outside || has_points_outside(plot, series, frame);
  }
  return text + (plot.panels.empty() ? one_panel(name, plot, clauses.front(), outside, plain)
                                     : all_panels(name, plot, clauses, frame, plain));
}

}  // namespace equidem
