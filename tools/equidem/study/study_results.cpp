// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_results.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-";
}

std::vector<Results> table_of(const StudyReport& report) {
  std::vector<Results> rows;
  for (std::size_t k = 0; k < report.result.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[k];
    const Timing& time = row.time;
    const bool on_front = std::ranges::find(report.result.front, k) != report.result.front.end();
    Results& line = rows.emplace_back();
    line.add("", "  setting", (on_front ? "* " : "  ") + row.setting.label());
    if (!row.refusal.empty() || time.repetitions == 0) {
      line.note(row.refusal.empty() ? "not timed" : row.refusal);
      continue;
    }
    line.add("", "time", readable_seconds(time.median))
        .add("", "spread", (time.upper_quartile - time.lower_quartile) / time.median, "", {Shown::percent, 2})
        .add("", "n", time.repetitions)
        .add("", "err " + report.study.quantity, cell(row.error));
  }
  return rows;
}

Results row_results(const StudyReport& report, const StudyRow& row) {
  const std::string& quantity = report.study.quantity;
  Results setting;
  for (const auto& [name, value] : row.setting.values) setting.set(name, value);
  Results out;
  out.set("method", row.setting.method).set("setting", setting).set("resolution", row.setting.resolution);
  out.set("seconds/median", row.time.median)
      .set("seconds/lower_quartile", row.time.lower_quartile)
      .set("seconds/upper_quartile", row.time.upper_quartile)
      .set("seconds/processor_median", row.time.processor_median)
      .set("seconds/processor_lower_quartile", row.time.processor_lower_quartile)
      .set("seconds/processor_upper_quartile", row.time.processor_upper_quartile)
      .set("seconds/repetitions", row.time.repetitions);
  if (!row.refusal.empty()) return out.set("refusal", row.refusal);
  Results values, errors, assured;
  if (row.value) values.set(quantity, *row.value), errors.set(quantity, row.error), assured.set(quantity, row.assured);
  return out.set("values", values).set("errors", errors).set("assured_errors", assured);
}

Results curve_results(const StudyReport& report, const StudyCurve& curve) {
  const std::string& quantity = report.study.quantity;
  Results out;
  out.set("method", curve.method).set("quantity", quantity);
  out.set("observed_order", nullptr).set("theoretical_order", nullptr).set("cost_exponent", curve.cost_exponent);
  if (curve.expected) out.set("theoretical_order", *curve.expected).set("agrees", curve.agrees);
  if (!curve.order) return out;
  const ObservedOrder& order = *curve.order;
  out.set("observed_order", order.order).set("uncertainty", order.uncertainty).set("levels", order.levels);
  out.set("range", std::vector{order.coarsest, order.finest});
  std::string text = fmt::format(
      "  {}{}: order {:.3f}{} over {} levels", curve.method.empty() ? "" : curve.method + ", ", quantity, order.order,
      std::isfinite(order.uncertainty) ? fmt::format(" ± {:.2g}", order.uncertainty) : "", order.levels);
  if (curve.expected) text += fmt::format("; theory {:g}, {}", *curve.expected, curve.agrees ? "agrees" : "DIFFERS");
  return out.block(text + fmt::format("; time as h^{:.2f}\n", -curve.cost_exponent));
}

Results quantity_results(const Study& study) {
  Results out;
  out.set("name", study.quantity).set("label", study.label).set("relative", study.relative);
  out.set("truth", to_string(study.truth)).set("source", study.source);
  if (study.truth == Truth::known) out.set("true_value", study.true_value);
  return out.line("measured", study.label + "; truth: " + study.source);
}

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

/// "leapfrog, order 1.98 (theory 2)".
std::string legend_of(const StudyReport& report, const std::string& method) {
  std::string order;
  for (const StudyCurve& curve : report.result.curves) {
    if (curve.method != method || !curve.order) continue;
    order = fmt::format("order {:.2f}{}", curve.order->order,
                        curve.expected ? fmt::format(" (theory {:.3g})", *curve.expected) : "");
  }
  if (method.empty()) return order.empty() ? "measured" : order;
  return literal(order.empty() ? method : method + ", " + order);
}

/// The rows that were timed, method by method in the order of the study.
std::vector<std::pair<std::string, std::vector<std::size_t>>> by_method(const StudyReport& report) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> methods;
  for (std::size_t k = 0; k < report.result.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[k];
    if (row.time.repetitions == 0) continue;
    auto at =
        std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.first == row.setting.method; });
    if (at == methods.end()) at = methods.insert(at, {row.setting.method, {}});
    at->second.push_back(k);
  }
  return methods;
}

}  // namespace

Results study_results(const StudyReport& report) {
  const Study& study = report.study;
  const StudyResult& result = report.result;
  Results out;
  out.set("study", study.name).set("title", study.title).set("complete", result.complete);
  out.set("command", report.command).set("machine", report.machine.results());
  out.set("seed", report.options.seed).set("rounds", result.rounds).set("budget", report.options.budget);
  out.set("checksum", report.checksum).block(study.title + "\n\n");
  std::vector<Results> settings, curves, fronts, recommendations;
  for (const StudyRow& row : result.rows) settings.push_back(row_results(report, row));
  for (const StudyCurve& curve : result.curves) curves.push_back(curve_results(report, curve));
  std::vector<std::string> labels;
  for (const std::size_t row : result.front) labels.push_back(result.rows[row].setting.label());
  if (!labels.empty()) fronts.push_back(Results().set("quantity", study.quantity).set("settings", labels));
  if (report.recommendation) {
    const Recommendation& one = *report.recommendation;
    Results& told = recommendations.emplace_back();
    told.set("text", one.text).set("best_error", one.best).block(one.text + "\n").set("setting", nullptr);
    if (one.row) told.set("setting", row_results(report, result.rows[*one.row]));
  }

  out.list("quantities", {quantity_results(study)}).line("machine", report.machine.text());
  out.line("timing", fmt::format("{} after one to warm up, all settings in an order drawn anew each time (seed {}); "
                                 "median, quartiles apart, number n",
                                 counted(result.rounds, "round"), report.options.seed));
  out.block("\n").table("", table_of(report));
  if (!fronts.empty()) out.block("\n* on a front: nothing is both faster and as accurate\n");
  if (std::ranges::any_of(result.curves, [](const StudyCurve& curve) { return curve.order.has_value(); }))
    out.block("\norders, errors as h^p over the finest levels (95 % interval)\n");
  out.list("orders", std::move(curves));
  out.block("\n" + (result.advice.empty() ? "" : result.advice + "\n"));
  if (report.accuracy) out.set("accuracy", *report.accuracy).list("recommendations", std::move(recommendations));
  for (const std::string& note : study.notes) out.block(note + "\n");
  out.set("settings", settings).set("fronts", fronts);
  return out.set("advice", result.advice).set("notes", study.notes);
}

Table study_table(const StudyReport& report) {
  const auto& rows = report.result.rows;
  const std::string& quantity = report.study.quantity;
  Table table;
  table.add("method", rows, [](const StudyRow& r) { return r.setting.method; });
  table.add("setting", rows, [](const StudyRow& r) { return r.setting.label(); });
  table.add("resolution", rows, [](const StudyRow& r) { return r.setting.resolution; });
  table.add("median_s", rows, [](const StudyRow& r) { return r.time.median; });
  table.add("lower_quartile_s", rows, [](const StudyRow& r) { return r.time.lower_quartile; });
  table.add("upper_quartile_s", rows, [](const StudyRow& r) { return r.time.upper_quartile; });
  table.add("processor_median_s", rows, [](const StudyRow& r) { return r.time.processor_median; });
  table.add("repetitions", rows, [](const StudyRow& r) { return static_cast<double>(r.time.repetitions); });
  table.add(quantity, rows, [](const StudyRow& r) { return r.value.value_or(NAN); });
  table.add(quantity + "_error", rows, &StudyRow::error);
  table.add(quantity + "_assured_error", rows, &StudyRow::assured);
  return table.add("refusal", rows, &StudyRow::refusal);
}

Plot study_plot(const StudyReport& report) {
  Plot plot{.title = with_symbols(report.study.title),
            .x = {.label = "time of computing, s", .logarithmic = true},
            .y = {.label = with_symbols(report.study.label), .logarithmic = true},
            .enhanced = true};
  Series line{.label = "front", .style = SeriesStyle::dashed_line, .colour = PlotColour::black, .column = "front"};
  for (const std::size_t k : report.result.front) {
    const StudyRow& row = report.result.rows[k];
    if (!line.x.empty()) {  // until here nothing is better than the one before
      line.x.push_back(row.time.median);
      line.y.push_back(line.y.back());
    }
    line.x.push_back(row.time.median);
    line.y.push_back(row.assured);
  }
  plot.series.push_back(std::move(line));
  std::size_t count = 0;
  for (const auto& [method, rows] : by_method(report)) {
    Series series = series_of(count++, rows.size());
    series.label = legend_of(report, method);
    series.column = method.empty() ? "error" : method;
    for (const std::size_t k : rows) {
      const StudyRow& row = report.result.rows[k];
      if (!std::isfinite(row.error)) continue;
      series.x.push_back(row.time.median);
      series.y.push_back(row.error);
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

std::string study_plot_name(const Study& study) {
  return study.name + "_" + study.quantity;
}

}  // namespace equidem
