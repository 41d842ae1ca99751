// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "equidem/core/text.hpp"

#include "study/study_results.hpp"

namespace equidem {
namespace {

/// An empty series of the k-th method: a line where it has several points.
Series series_of(std::size_t k, std::size_t points) {
  using enum PlotColour;
  struct Look {
    PlotColour colour;
    Marker marker;
    bool filled;
  };
  constexpr Look looks[] = {{blue, Marker::circle, true},     {vermilion, Marker::square, true},
                            {green, Marker::triangle, true},  {orange, Marker::diamond, true},
                            {purple, Marker::circle, false},  {sky_blue, Marker::square, false},
                            {black, Marker::triangle, false}, {black, Marker::diamond, true}};
  const Look& look = looks[k % std::size(looks)];
  return {.style = points > 1 ? SeriesStyle::line_with_points : SeriesStyle::points,
          .colour = look.colour,
          .marker = look.marker,
          .filled = look.filled};
}

/// A name for files.
std::string plain(const std::string& text) {
  std::string name;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (name.ends_with('_')) name.pop_back();
  return name;
}

std::string name_of(const Study& study, const std::string& problem, const std::string& quantity) {
  const std::string part = plain(problem);
  return study.name + (part.empty() ? "" : "_" + part) + "_" + quantity;
}

std::string title_of(const Study& study, const std::string& problem) {
  return problem.empty() ? study.title : study.title + ": " + problem;
}

/// "order 1.02 (theory 1)".
std::string order_text(const StudyReport& report, const std::string& problem, const std::string& method,
                       std::size_t quantity) {
  for (const StudyCurve& curve : report.result.curves) {
    if (curve.problem != problem || curve.method != method || curve.quantity != quantity || !curve.order) continue;
    return fmt::format("order {:.2f}{}", curve.order->order,
                       curve.expected ? fmt::format(" (theory {:.3g})", curve.expected->order) : "");
  }
  return "";
}

std::string legend_of(const std::string& method, const std::string& order) {
  if (method.empty()) return order.empty() ? "measured" : order;
  return order.empty() ? method : method + ", " + order;
}

/// The rows of a problem, method by method in the order of the study.
std::vector<std::pair<std::string, std::vector<std::size_t>>> by_method(const StudyReport& report,
                                                                        const std::string& problem) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> methods;
  for (std::size_t k = 0; k < report.result.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[k];
    if (row.setting.problem != problem || row.time.repetitions == 0) continue;
    auto at =
        std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.first == row.setting.method; });
    if (at == methods.end()) at = methods.insert(at, {row.setting.method, {}});
    at->second.push_back(k);
  }
  return methods;
}

Plot error_plot(const StudyReport& report, const StudyFront& front) {
  const Quantity& quantity = report.study.quantities[front.quantity];
  Plot plot{.title = title_of(report.study, front.problem),
            .x = {.label = "time of computing, s", .logarithmic = true},
            .y = {.label = quantity.label, .logarithmic = true}};
  Series line{.label = "front", .style = SeriesStyle::dashed_line, .colour = PlotColour::black, .column = "front"};
  for (std::size_t k = 0; k < front.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[front.rows[k]];
    if (k > 0) {  // until here nothing is better than the one before
      line.x.push_back(row.time.median);
      line.y.push_back(line.y.back());
    }
    line.x.push_back(row.time.median);
    line.y.push_back(row.assured[front.quantity]);
  }
  plot.series.push_back(std::move(line));
  std::size_t count = 0;
  for (const auto& [method, rows] : by_method(report, front.problem)) {
    Series series = series_of(count++, rows.size());
    series.label = legend_of(method, order_text(report, front.problem, method, front.quantity));
    series.column = method.empty() ? "error" : method;
    for (const std::size_t k : rows) {
      const StudyRow& row = report.result.rows[k];
      if (!std::isfinite(row.errors[front.quantity])) continue;
      series.x.push_back(row.time.median);
      series.y.push_back(row.errors[front.quantity]);
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

/// Time against the first value that is varied, or where none is, against the number of the setting.
Plot time_plot(const StudyReport& report, const std::string& problem) {
  Plot plot{.title = title_of(report.study, problem), .x = {}, .y = {.label = "time of computing, s", .min = 0}};
  std::size_t count = 0;
  double place = 0;
  for (const auto& [method, rows] : by_method(report, problem)) {
    Series series = series_of(count++, rows.size());
    series.label = method.empty() ? "median" : method;
    series.column = method.empty() ? "time" : method;
    for (const std::size_t k : rows) {
      const StudyRow& row = report.result.rows[k];
      const bool varied = !row.setting.values.empty();
      if (varied) {
        plot.x.label = row.setting.values.front().first;
        plot.x.logarithmic = true;
      }
      place += 1;
      series.x.push_back(varied ? row.setting.values.front().second : place);
      series.y.push_back(row.time.median);
    }
    plot.series.push_back(std::move(series));
  }
  if (plot.x.label.empty()) plot.x.label = "setting";
  if (plot.x.logarithmic) {
    // A setting that varies no key is a reference level.
    double least = INFINITY, most = 0;
    for (const StudyRow& row : report.result.rows) {
      if (row.setting.problem != problem || row.setting.values.empty()) continue;
      least = std::min(least, row.setting.values.front().second);
      most = std::max(most, row.setting.values.front().second);
    }
    std::size_t at = 0;
    for (const auto& [method, rows] : by_method(report, problem)) {
      Series& series = plot.series[at++];
      if (!report.result.rows[rows.front()].setting.values.empty()) continue;
      series.style = SeriesStyle::dashed_line;
      series.x = {least, most};
      series.y = {series.y.front(), series.y.front()};
    }
  }
  return plot;
}

bool all_facts(const Study& study) {
  return std::all_of(study.quantities.begin(), study.quantities.end(), [](const Quantity& q) { return q.fact; });
}

}  // namespace

std::vector<std::string> study_plot_names(const Study& study) {
  std::vector<std::string> names;
  for (const std::string& problem : problems_of(study)) {
    if (all_facts(study)) names.push_back(name_of(study, problem, "time"));
    for (const Quantity& quantity : study.quantities) {
      if (!quantity.fact) names.push_back(name_of(study, problem, quantity.name));
    }
  }
  return names;
}

std::vector<std::pair<std::string, Plot>> study_plots(const StudyReport& report) {
  std::vector<std::pair<std::string, Plot>> plots;
  for (const StudyFront& front : report.result.fronts)
    plots.emplace_back(name_of(report.study, front.problem, report.study.quantities[front.quantity].name),
                       error_plot(report, front));
  if (all_facts(report.study)) {
    for (const std::string& problem : problems_of(report.study)) {
      Plot plot = time_plot(report, problem);
      if (!plot.series.empty()) plots.emplace_back(name_of(report.study, problem, "time"), std::move(plot));
    }
  }
  return plots;
}

}  // namespace equidem
