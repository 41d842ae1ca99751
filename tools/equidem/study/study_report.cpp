// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_report.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

#include "solve/report.hpp"

namespace equidem {
namespace {

std::string cell(double value, bool fact) {
  if (!std::isfinite(value)) return "-";
  return fact ? fmt::format("{:.6g}", value) : fmt::format("{:.3g}", value);
}

bool on_a_front(const StudyReport& report, std::size_t row) {
  return std::any_of(report.result.fronts.begin(), report.result.fronts.end(), [&](const StudyFront& front) {
    return std::find(front.rows.begin(), front.rows.end(), row) != front.rows.end();
  });
}

/// Quantities that some row of the problem has.
std::vector<std::size_t> told_quantities(const StudyReport& report, const std::string& problem) {
  std::vector<std::size_t> told;
  for (std::size_t q = 0; q < report.study.quantities.size(); ++q) {
    const bool any = std::any_of(report.result.rows.begin(), report.result.rows.end(), [&](const StudyRow& row) {
      return row.setting.problem == problem && !row.values.empty() && std::isfinite(row.values[q]);
    });
    if (any) told.push_back(q);
  }
  return told;
}

std::string table_of(const StudyReport& report, const std::string& problem) {
  const std::vector<std::size_t> told = told_quantities(report, problem);
  std::size_t width = 7;
  for (const StudyRow& row : report.result.rows) {
    if (row.setting.problem == problem) width = std::max(width, row.setting.label().size());
  }
  std::string text = problem.empty() ? "" : problem + "\n";
  text += fmt::format("  {:<{}}  {:>10}  {:>8}  {:>4}", "setting", width, "time", "spread", "n");
  for (const std::size_t q : told)
    text += fmt::format("  {:>18}", (report.study.quantities[q].fact ? "" : "err ") + report.study.quantities[q].name);
  text += "\n";
  for (std::size_t k = 0; k < report.result.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[k];
    if (row.setting.problem != problem) continue;
    const Timing& time = row.time;
    const std::string label = row.setting.label();
    text += fmt::format("{} {:<{}}", on_a_front(report, k) ? '*' : ' ', label, width);
    if (!row.refusal.empty()) {
      text += "  " + row.refusal + "\n";
      continue;
    }
    if (time.repetitions == 0) {
      text += "  not timed\n";
      continue;
    }
    text += fmt::format("  {:>10}  {:>6.1f} %  {:>4}", readable_seconds(time.median),
                        100 * (time.upper_quartile - time.lower_quartile) / time.median, time.repetitions);
    for (const std::size_t q : told) {
      const bool fact = report.study.quantities[q].fact;
      text += fmt::format("  {:>18}", cell(fact ? row.values[q] : row.errors[q], fact));
    }
    text += "\n";
  }
  return text;
}

std::string describe_orders(const StudyReport& report) {
  std::string text;
  for (const StudyCurve& curve : report.result.curves) {
    if (!curve.order) continue;
    const Quantity& quantity = report.study.quantities[curve.quantity];
    const ObservedOrder& order = *curve.order;
    std::string who = curve.problem;
    for (const std::string& part : {curve.method, quantity.name})
      who += (who.empty() || part.empty() ? "" : ", ") + part;
    text +=
        fmt::format("  {}: order {:.3f}{} over {} levels", who, order.order,
                    std::isfinite(order.uncertainty) ? fmt::format(" ± {:.2g}", order.uncertainty) : "", order.levels);
    if (curve.expected) {
      text += fmt::format("; theory {:g}, {}", curve.expected->order, curve.agrees ? "agrees" : "DIFFERS");
      if (!curve.expected->why.empty()) text += fmt::format(" ({})", curve.expected->why);
    }
    text += fmt::format("; time as h^{:.2f}\n", -curve.cost_exponent);
  }
  return text.empty() ? "" : "orders, errors as h^p over the finest levels (95 % interval)\n" + text + "\n";
}

JsonObject timing_json(const Timing& time) {
  JsonObject object;
  object.set("median", time.median).set("lower_quartile", time.lower_quartile);
  object.set("upper_quartile", time.upper_quartile).set("processor_median", time.processor_median);
  return object.set("repetitions", time.repetitions);
}

JsonObject row_json(const StudyReport& report, const StudyRow& row) {
  JsonObject object, values, measured, errors, assured;
  for (const auto& [name, value] : row.setting.values) values.set(name, value);
  for (std::size_t q = 0; q < row.values.size(); ++q) {
    const Quantity& quantity = report.study.quantities[q];
    measured.set(quantity.name, row.values[q]);
    if (quantity.fact) continue;
    errors.set(quantity.name, row.errors[q]);
    assured.set(quantity.name, row.assured[q]);
  }
  object.set("problem", row.setting.problem).set("method", row.setting.method).set("setting", values);
  object.set("resolution", row.setting.resolution).set("seconds", timing_json(row.time));
  object.set("values", measured).set("errors", errors).set("assured_errors", assured);
  if (!row.refusal.empty()) object.set("refusal", row.refusal);
  return object;
}

JsonObject curve_json(const StudyReport& report, const StudyCurve& curve) {
  JsonObject object;
  object.set("problem", curve.problem).set("method", curve.method);
  object.set("quantity", report.study.quantities[curve.quantity].name);
  if (curve.order) {
    object.set("observed_order", curve.order->order).set("uncertainty", curve.order->uncertainty);
    object.set("levels", curve.order->levels);
    object.set("range", std::vector<double>{curve.order->coarsest, curve.order->finest});
  } else {
    object.set_null("observed_order");
  }
  if (curve.expected)
    object.set("theoretical_order", curve.expected->order).set("why", curve.expected->why).set("agrees", curve.agrees);
  else
    object.set_null("theoretical_order");
  return object.set("cost_exponent", curve.cost_exponent);
}

const char* name_of(Truth truth) {
  return truth == Truth::known ? "known" : truth == Truth::finest ? "finest" : "richardson";
}

}  // namespace

std::string describe_study(const StudyReport& report) {
  std::string text = report.study.title + "\n\n";
  for (const Quantity& quantity : report.study.quantities) {
    if (!quantity.fact)
      text += report_line(quantity.name, (quantity.label.empty() ? "" : quantity.label + "; ") + "truth: " +
                                             (quantity.source.empty() ? name_of(report.study.truth) : quantity.source));
  }
  text += report_line("machine", report.machine.text());
  text += report_line("timing",
                      fmt::format("{} after one to warm up, all settings in an order drawn anew each time (seed {}); "
                                  "median, quartiles apart, number n",
                                  counted(report.result.rounds, "round"), report.options.seed));
  text += "\n";
  for (const std::string& problem : problems_of(report.study)) text += table_of(report, problem) + "\n";
  if (!report.result.fronts.empty()) text += "* on a front: nothing is both faster and as accurate\n\n";
  text += describe_orders(report);
  for (const std::string& advice : report.result.advice) text += advice + "\n";
  for (const Recommendation& recommendation : report.recommendations) text += recommendation.text + "\n";
  for (const std::string& note : report.study.notes) text += note + "\n";
  return text;
}

JsonObject study_json(const StudyReport& report, const std::string& text) {
  JsonObject object;
  object.set("status", report.result.complete ? "done" : "interrupted").set("report", text);
  object.set("version", report.machine.version).set("study", report.study.name).set("title", report.study.title);
  object.set("complete", report.result.complete).set("command", report.command).set("machine", report.machine.json());
  object.set("seed", static_cast<std::int64_t>(report.options.seed)).set("rounds", report.result.rounds);
  object.set("budget", report.options.budget).set("checksum", report.checksum);
  std::vector<JsonObject> quantities, rows, curves, fronts, recommendations;
  for (const Quantity& quantity : report.study.quantities) {
    JsonObject one;
    one.set("name", quantity.name).set("label", quantity.label).set("fact", quantity.fact);
    one.set("relative", quantity.relative).set("truth", name_of(report.study.truth));
    if (report.study.truth == Truth::known && !quantity.fact) one.set("true_value", quantity.truth);
    quantities.push_back(one.set("source", quantity.source));
  }
  for (const StudyRow& row : report.result.rows) rows.push_back(row_json(report, row));
  for (const StudyCurve& curve : report.result.curves) curves.push_back(curve_json(report, curve));
  for (const StudyFront& front : report.result.fronts) {
    JsonObject one;
    one.set("problem", front.problem).set("quantity", report.study.quantities[front.quantity].name);
    std::vector<std::string> labels;
    for (const std::size_t row : front.rows) labels.push_back(report.result.rows[row].setting.label());
    fronts.push_back(one.set("settings", labels));
  }
  for (const Recommendation& recommendation : report.recommendations) {
    JsonObject one;
    one.set("problem", recommendation.problem).set("text", recommendation.text).set("best_error", recommendation.best);
    if (recommendation.row)
      one.set("setting", row_json(report, report.result.rows[*recommendation.row]));
    else
      one.set_null("setting");
    recommendations.push_back(std::move(one));
  }
  object.set("quantities", quantities).set("settings", rows).set("orders", curves).set("fronts", fronts);
  object.set("advice", report.result.advice).set("notes", report.study.notes);
  if (report.accuracy) object.set("accuracy", *report.accuracy).set("recommendations", recommendations);
  return object;
}

Table study_table(const StudyReport& report) {
  const auto& rows = report.result.rows;
  const auto strings = [&](auto take) {
    std::vector<std::string> column;
    for (const StudyRow& row : rows) column.push_back(take(row));
    return column;
  };
  const auto numbers = [&](auto take) {
    std::vector<double> column;
    for (const StudyRow& row : rows) column.push_back(take(row));
    return column;
  };
  Table table;
  table.add("problem", strings([](const StudyRow& r) { return r.setting.problem; }));
  table.add("method", strings([](const StudyRow& r) { return r.setting.method; }));
  table.add("setting", strings([](const StudyRow& r) { return r.setting.label(); }));
  table.add("resolution", numbers([](const StudyRow& r) { return r.setting.resolution; }));
  table.add("median_s", numbers([](const StudyRow& r) { return r.time.median; }));
  table.add("lower_quartile_s", numbers([](const StudyRow& r) { return r.time.lower_quartile; }));
  table.add("upper_quartile_s", numbers([](const StudyRow& r) { return r.time.upper_quartile; }));
  table.add("processor_median_s", numbers([](const StudyRow& r) { return r.time.processor_median; }));
  table.add("repetitions", numbers([](const StudyRow& r) { return r.time.repetitions; }));
  for (std::size_t q = 0; q < report.study.quantities.size(); ++q) {
    const Quantity& quantity = report.study.quantities[q];
    const auto entry = [q](const std::vector<double>& of) { return of.empty() ? NAN : of[q]; };
    table.add(quantity.name, numbers([&](const StudyRow& r) { return entry(r.values); }));
    if (quantity.fact) continue;
    table.add(quantity.name + "_error", numbers([&](const StudyRow& r) { return entry(r.errors); }));
    table.add(quantity.name + "_assured_error", numbers([&](const StudyRow& r) { return entry(r.assured); }));
  }
  table.add("refusal", strings([](const StudyRow& r) { return r.refusal; }));
  return table;
}

}  // namespace equidem
