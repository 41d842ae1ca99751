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
  return with_symbols(problem.empty() ? study.title : study.title + ": " + problem);
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
  return literal(order.empty() ? method : method + ", " + order);
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
            .y = {.label = with_symbols(quantity.label), .logarithmic = true},
            .enhanced = true};
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

/// Time against the first value that is varied. A setting that varies nothing is a level.
Plot time_plot(const StudyReport& report, const std::string& problem) {
  Plot plot{.title = title_of(report.study, problem),
            .x = {.logarithmic = true},
            .y = {.label = "time of computing, s", .min = 0},
            .enhanced = true};
  double least = INFINITY, most = 0;
  for (const StudyRow& row : report.result.rows) {
    if (row.setting.problem != problem || row.setting.values.empty()) continue;
    plot.x.label = row.setting.values.front().first;
    least = std::min(least, row.setting.values.front().second);
    most = std::max(most, row.setting.values.front().second);
  }
  std::ranges::replace(plot.x.label, '_', ' ');
  std::size_t count = 0;
  for (const auto& [method, rows] : by_method(report, problem)) {
    Series series = series_of(count++, rows.size());
    series.label = method.empty() ? "median, bars from quartile to quartile" : literal(method);
    series.column = method.empty() ? "time" : method;
    const auto add = [&](double x, const Timing& time) {
      series.x.push_back(x);
      series.y.push_back(time.median);
      series.low.push_back(time.lower_quartile);
      series.high.push_back(time.upper_quartile);
    };
    for (const std::size_t k : rows) {
      const StudyRow& row = report.result.rows[k];
      if (!row.setting.values.empty()) {
        add(row.setting.values.front().second, row.time);
        continue;
      }
      series.style = SeriesStyle::dashed_line;
      Timing level;
      level.median = row.time.median;
      level.lower_quartile = level.upper_quartile = NAN;
      for (const double x : {least, most}) add(x, level);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

std::string size_plot_name(const Study& study, double error) {
  return fmt::format("{}_time_to_{}", study.name, plain(fmt::format("{:g}", error)));
}

/// Time of the cheapest setting of each method whose assured errors are at most `error`, against the size of the
/// problem.
Plot size_plot(const StudyReport& report, double error) {
  Plot plot{.title = title_of(report.study, fmt::format("time to an error of {:g}", error)),
            .x = {.label = report.study.size, .logarithmic = true},
            .y = {.label = "time of computing, s", .logarithmic = true},
            .enhanced = true};
  for (const std::string& problem : problems_of(report.study)) {
    for (const auto& [method, rows] : by_method(report, problem)) {
      const StudyRow* cheapest = nullptr;
      for (const std::size_t k : rows) {
        const StudyRow& row = report.result.rows[k];
        const bool reached = !std::ranges::any_of(row.assured, [error](double e) { return e > error; });
        if (reached && (cheapest == nullptr || row.time.median < cheapest->time.median)) cheapest = &row;
      }
      if (cheapest == nullptr) continue;
      auto series = std::ranges::find(plot.series, method, &Series::column);
      if (series == plot.series.end()) {
        plot.series.push_back(series_of(plot.series.size(), 2));
        series = plot.series.end() - 1;
        series->column = method;
        series->label = literal(method);
      }
      series->x.push_back(cheapest->setting.size);
      series->y.push_back(cheapest->time.median);
    }
  }
  return plot;
}

bool varies_nothing(const StudyReport& report, const std::string& problem) {
  return std::ranges::all_of(report.result.rows, [&](const StudyRow& row) {
    return row.setting.problem != problem || row.setting.values.empty();
  });
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
  for (const double error : study.compared) names.push_back(size_plot_name(study, error));
  return names;
}

std::vector<std::pair<std::string, Plot>> study_plots(const StudyReport& report) {
  std::vector<std::pair<std::string, Plot>> plots;
  for (const StudyFront& front : report.result.fronts)
    plots.emplace_back(name_of(report.study, front.problem, report.study.quantities[front.quantity].name),
                       error_plot(report, front));
  for (const double error : report.study.compared) {
    Plot plot = size_plot(report, error);
    if (!plot.series.empty()) plots.emplace_back(size_plot_name(report.study, error), std::move(plot));
  }
  if (!all_facts(report.study)) return plots;
  for (const std::string& problem : problems_of(report.study)) {
    if (by_method(report, problem).empty() || varies_nothing(report, problem)) continue;
    plots.emplace_back(name_of(report.study, problem, "time"), time_plot(report, problem));
  }
  return plots;
}

}  // namespace equidem
