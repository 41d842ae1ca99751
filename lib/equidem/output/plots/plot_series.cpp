// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/plot_series.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>

#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/output/plots/gnuplot_text.hpp"

namespace equidem {
namespace {

/// Outwards to a multiple of a 1-2-5 step near a fiftieth of the span.
AxisRange rounded(double low, double high) {
  const double raw = (high - low) / 50;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = raw / power < 2 ? 2 * power : raw / power < 5 ? 5 * power : 10 * power;
  return {step * std::floor(low / step), step * std::ceil(high / step)};
}

/// The given bounds, else those of the data with a small margin, rounded outwards. Data that differ by round-off alone
/// are drawn as equal ones.
AxisRange range_of(const Axis& axis, const std::vector<Series>& series,
                   std::initializer_list<std::vector<double> Series::*> members) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Series& one : series) {
    for (const auto member : members) {
      for (const double v : one.*member) {
        if (!std::isfinite(v) || (axis.logarithmic && v <= 0)) continue;
        low = std::min(low, v);
        high = std::max(high, v);
      }
    }
  }
  if (axis.logarithmic) {
    const double margin = low < high ? std::pow(high / low, 0.05) : 2;
    low /= margin, high *= margin;
  } else {
    constexpr double round_off = 1e-12;  // relative
    const bool differ = high - low > round_off * std::max(std::abs(low), std::abs(high));
    const double margin = differ ? 0.05 * (high - low) : std::max(0.1 * std::abs(low), 1e-12);
    const AxisRange padded = rounded(low - margin, high + margin);
    low = padded.min, high = padded.max;
  }
  return {axis.min.value_or(low), axis.max.value_or(high)};
}

/// Place along an axis: 0 at its beginning, 1 at its end.
double share_of(double value, const Axis& axis, const AxisRange& range) {
  return axis.logarithmic ? std::log(value / range.min) / std::log(range.max / range.min)
                          : (value - range.min) / (range.max - range.min);
}

/// The value at a share of an axis.
double value_at(double share, const Axis& axis, const AxisRange& range) {
  return axis.logarithmic ? range.min * std::pow(range.max / range.min, share) : std::lerp(range.min, range.max, share);
}

bool has_markers(const Series& series) {
  return series.style == SeriesStyle::points || series.style == SeriesStyle::line_with_points;
}
bool has_line(const Series& series) {
  return series.style != SeriesStyle::points;
}

/// Points in the frame, from (0, 0) to (1, 1), of long series every n-th; not a number where a point is missing.
std::vector<Vec2> places_of(const Plot& plot, const Series& series, const PlotFrame& frame) {
  constexpr std::size_t most = 5000;
  const std::size_t stride = series.x.size() / most + 1;
  std::vector<Vec2> places;
  for (std::size_t k = 0; k < series.x.size(); k += stride)
    places.push_back({share_of(series.x[k], plot.x, frame.x), share_of(series.y[k], plot.y, frame.y)});
  return places;
}

/// The points, and four between each two.
std::vector<Vec2> along(const std::vector<Vec2>& points) {
  constexpr int pieces = 5;
  std::vector<Vec2> all;
  for (std::size_t k = 0; k + 1 < points.size(); ++k)
    for (int part = 0; part < pieces; ++part)
      all.push_back(points[k] + (static_cast<double>(part) / pieces) * (points[k + 1] - points[k]));
  if (!points.empty()) all.push_back(points.back());
  return all;
}

double distance_to_piece(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double length = dot(along, along);
  const double at = length > 0 ? std::clamp(dot(p - a, along) / length, 0.0, 1.0) : 0;
  return norm(p - (a + at * along));
}

/// Whether most points of the one lie on the other. Long series are sampled.
bool coincide(const std::vector<Vec2>& some, const std::vector<Vec2>& others, bool along_line) {
  constexpr double near = 0.005, most = 0.6;
  constexpr std::size_t samples = 60, pieces = 5000;
  const std::size_t stride = some.size() / samples + 1, other_stride = others.size() / pieces + 1;
  double tried = 0, found = 0;
  for (std::size_t k = 0; k < some.size(); k += stride) {
    const Vec2 p = some[k];
    if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1)) continue;
    tried += 1;
    bool on_it = false;
    for (std::size_t j = 0; j < others.size() && !on_it; j += other_stride) {
      const Vec2 end = along_line && j + other_stride < others.size() ? others[j + other_stride] : others[j];
      on_it = distance_to_piece(p, others[j], end) < near;
    }
    found += on_it ? 1 : 0;
  }
  return tried > 0 && found >= most * tried;
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

std::string dashes(int pattern) {
  constexpr const char* patterns[] = {" dt (8,5)", " dt (3,3)", " dt (12,4,2,4)"};
  return pattern == 0 ? "" : patterns[static_cast<std::size_t>(pattern - 1) % std::size(patterns)];
}

bool outside(const Series& series, const AxisRange& range, bool above) {
  return std::any_of(series.y.begin(), series.y.end(),
                     [&](double y) { return std::isfinite(y) && (above ? y > range.max : y < range.min); });
}

}  // namespace

PlotFrame frame_of(const Plot& plot) {
  return {range_of(plot.x, plot.series, {&Series::x}),
          range_of(plot.y, plot.series, {&Series::y, &Series::low, &Series::high})};
}

std::vector<SeriesLook> looks_of(const Plot& plot, const PlotFrame& frame) {
  std::vector<SeriesLook> looks;
  std::vector<std::vector<Vec2>> places;
  for (const Series& series : plot.series) {
    looks.push_back({.dash = series.style == SeriesStyle::dashed_line ? 1 : 0});
    places.push_back(places_of(plot, series, frame));
  }
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const Series& series = plot.series[k];
    for (std::size_t j = 0; j < k; ++j) {
      const Series& earlier = plot.series[j];
      const bool lines = has_line(series) && has_line(earlier), markers = has_markers(series) && has_markers(earlier);
      if (series.panel != earlier.panel) continue;
      const auto either = [&](const std::vector<Vec2>& one, const std::vector<Vec2>& other, bool along_line) {
        return coincide(one, other, along_line) || coincide(other, one, along_line);
      };
      if (lines && looks[k].dash <= looks[j].dash && either(along(places[k]), along(places[j]), true))
        looks[k].dash = looks[j].dash + 1;
      if (markers && either(places[k], places[j], false)) looks[j].marker_size += 0.45;
    }
  }
  return looks;
}

bool has_points_outside(const Plot& plot, const Series& series, const PlotFrame& frame) {
  return has_markers(series) && plot.mark_points_outside &&
         (outside(series, frame.y, true) || outside(series, frame.y, false));
}

std::vector<std::string> plot_clauses(const Plot& plot, const Series& series, const PlotData::Place& place,
                                      const PlotFrame& frame, const SeriesLook& look, const std::string& plain) {
  const std::string rows = place.last ? fmt::format("::{}::{}", place.first, *place.last) : "";
  const std::string data = rows.empty() ? "data" : "data every " + rows;
  const std::string columns = fmt::format("{} using \"{}\":\"{}\"", data, place.x, place.y);
  const std::string colour = hex(series.colour);
  const std::string title = series.label.empty() ? "notitle" : "title " + gnuplot_string(series.label) + plain;
  const std::string size = fmt::format("{:g}*marker", look.marker_size);
  const std::string face = fmt::format("with points pt {} ps {}", point_type(series.marker, true), size);
  const std::string outline =
      fmt::format("with points pt {} ps {} lw 1.6 lc rgb '{}'", point_type(series.marker, false), size, colour);
  std::vector<std::string> clauses;
  if (!series.low.empty()) {
    clauses.push_back(
        fmt::format("{} using \"{}\":\"{}\":\"{}\":\"{}\" with yerrorbars pt -1 ps 0.6 lw 1.2 lc rgb '{}' notitle",
                    data, place.x, place.y, place.low, place.high, colour));
  }
  if (series.style == SeriesStyle::line || series.style == SeriesStyle::dashed_line)
    clauses.push_back(fmt::format("data every stride{} using \"{}\":\"{}\" with lines lw 1.8{} lc rgb '{}' {}", rows,
                                  place.x, place.y, dashes(look.dash), colour, title));
  if (series.style == SeriesStyle::line_with_points) {
    clauses.push_back(fmt::format("{} with linespoints pt {} ps {} lw 1.6{} lc rgb '{}' {}", columns,
                                  point_type(series.marker, series.filled), size, dashes(look.dash), colour, title));
    if (!series.filled) {
      clauses.push_back(fmt::format("{} {} lc rgb '#ffffff' notitle", columns, face));
      clauses.push_back(fmt::format("{} {} notitle", columns, outline));
    }
  } else if (series.style == SeriesStyle::points && series.filled) {
    clauses.push_back(fmt::format("{} {} lc rgb '{}' {}", columns, face, colour, title));
  } else if (series.style == SeriesStyle::points) {
    clauses.push_back(fmt::format("{} {} lc rgb '#ffffff' notitle", columns, face));
    clauses.push_back(fmt::format("{} {} {}", columns, outline, title));
  }
  if (!has_points_outside(plot, series, frame)) return clauses;
  const auto triangle = [&](const char* relation, double bound, double share, int type) {
    clauses.push_back(
        fmt::format("{} using \"{}\":(column(\"{}\") {} {} ? {} : NaN) with points pt {} ps 0.8*marker lw 1.4 lc rgb "
                    "'{}' notitle",
                    data, place.x, place.y, relation, bound, value_at(share, plot.y, frame.y), type, colour));
  };
  if (outside(series, frame.y, true)) triangle(">", frame.y.max, 0.982, series.filled ? 9 : 8);
  if (outside(series, frame.y, false)) triangle("<", frame.y.min, 0.018, series.filled ? 11 : 10);
  return clauses;
}

}  // namespace equidem
