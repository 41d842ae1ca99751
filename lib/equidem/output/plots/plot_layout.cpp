// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/plot_layout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace equidem {
namespace {

// Estimates in parts of the drawing area, for 900 x 650 pixels and the font of the script.
constexpr double character_width = 0.0108;
constexpr double legend_character_width = 0.0139;  // gnuplot keeps free more than it writes
constexpr double character_height = 0.045;
constexpr double label_width = 0.04;  // of a label turned by 90 degrees, with the gap to its line
constexpr double legend_sample_width = 0.085;
constexpr double gap = 0.012;
constexpr int samples_per_segment = 24;

struct Point {
  double x = 0;
  double y = 0;
};

struct Box {
  double left = 0, right = 0, bottom = 0, top = 0;

  [[nodiscard]] bool holds(Point p) const { return p.x >= left && p.x <= right && p.y >= bottom && p.y <= top; }
};

std::size_t characters(const std::string& utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

/// Outwards to a multiple of a 1-2-5 step near a fiftieth of the span.
AxisRange rounded(double low, double high) {
  const double raw = (high - low) / 50;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = raw / power < 2 ? 2 * power : raw / power < 5 ? 5 * power : 10 * power;
  return {step * std::floor(low / step), step * std::ceil(high / step)};
}

AxisRange range_of(const Axis& axis, const std::vector<const std::vector<double>*>& columns) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const auto* column : columns) {
    for (const double v : *column) {
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

double to_graph(double value, const AxisRange& range, bool logarithmic) {
  if (logarithmic) return std::log(value / range.min) / std::log(range.max / range.min);
  return (value - range.min) / (range.max - range.min);
}

/// Points that the legend and the labels must not cover: markers, and lines as dense points.
std::vector<Point> obstacles_of(const Plot& plot, const PlotLayout& layout) {
  std::vector<Point> obstacles;
  for (const Series& series : plot.series) {
    Point last{NAN, NAN};
    for (std::size_t k = 0; k < series.y.size(); ++k) {
      const Point p{to_graph(series.x[k], layout.x, plot.x.logarithmic),
                    std::clamp(to_graph(series.y[k], layout.y, plot.y.logarithmic), -1.0, 2.0)};
      obstacles.push_back(p);
      if (series.style != SeriesStyle::points && std::isfinite(last.x + last.y)) {
        for (int s = 1; s < samples_per_segment; ++s) {
          const double t = static_cast<double>(s) / samples_per_segment;
          obstacles.push_back({last.x + t * (p.x - last.x), last.y + t * (p.y - last.y)});
        }
      }
      last = p;
    }
  }
  return obstacles;
}

std::size_t covered(const Box& box, const std::vector<Point>& obstacles) {
  return static_cast<std::size_t>(
      std::count_if(obstacles.begin(), obstacles.end(), [&](Point p) { return box.holds(p); }));
}

void fill(std::vector<Point>& obstacles, const Box& box) {
  constexpr int steps = 20;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      obstacles.push_back(
          {box.left + (box.right - box.left) * i / steps, box.bottom + (box.top - box.bottom) * j / steps});
    }
  }
}

/// Ends and sides in order of preference; the first with the least covered points is taken.
LineLabelPlace place_label(const VerticalLine& line, double x, std::vector<Point>& obstacles) {
  const double length = character_width * 900 / 650 * static_cast<double>(characters(line.label));
  std::size_t least = std::numeric_limits<std::size_t>::max();
  LineLabelPlace best;
  Box taken;
  for (const LineLabelPlace place : {LineLabelPlace{true, false}, {true, true}, {false, false}, {false, true}}) {
    Box box;
    box.left = place.right ? x + 0.001 : x - 0.001 - label_width;
    box.right = box.left + label_width;
    box.top = place.top ? 1.0 : gap + length;
    box.bottom = place.top ? 1 - gap - length : 0.0;
    const std::size_t count = covered(box, obstacles);
    if (count < least) least = count, best = place, taken = box;
  }
  fill(obstacles, taken);
  return best;
}

std::string place_legend(const Plot& plot, const std::vector<Point>& obstacles) {
  std::size_t entries = 0;
  std::size_t longest = 0;
  for (const Series& series : plot.series) {
    if (series.label.empty()) continue;
    ++entries;
    longest = std::max(longest, characters(series.label));
  }
  const double width = legend_sample_width + legend_character_width * static_cast<double>(longest) + 2 * gap;
  const double height = character_height * (static_cast<double>(entries) + 0.6) + gap;
  const std::pair<const char*, Box> corners[] = {
      {"top right", {1 - width, 1, 1 - height, 1.1}},
      {"top left", {0, width, 1 - height, 1.1}},
      {"bottom right", {1 - width, 1, -0.1, height}},
      {"bottom left", {0, width, -0.1, height}},
  };
  for (const auto& [words, box] : corners) {
    if (covered(box, obstacles) == 0) return words;
  }
  return "below";
}

}  // namespace

PlotLayout lay_out(const Plot& plot) {
  std::vector<const std::vector<double>*> x_columns, y_columns;
  for (const Series& series : plot.series) {
    x_columns.push_back(&series.x);
    y_columns.push_back(&series.y);
  }
  PlotLayout layout;
  layout.x = range_of(plot.x, x_columns);
  layout.y = range_of(plot.y, y_columns);

  std::vector<Point> obstacles = obstacles_of(plot, layout);
  std::vector<double> positions;
  for (const VerticalLine& line : plot.vertical_lines) {
    positions.push_back(to_graph(line.x, layout.x, plot.x.logarithmic));
    for (int k = 0; k <= 100; ++k) obstacles.push_back({positions.back(), 0.01 * k});
  }
  for (std::size_t k = 0; k < positions.size(); ++k) {
    layout.line_labels.push_back(place_label(plot.vertical_lines[k], positions[k], obstacles));
  }
  layout.legend = place_legend(plot, obstacles);
  return layout;
}

}  // namespace equidem
