// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_results.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

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

std::vector<Results> table_of(const StudyReport& report, const std::string& problem) {
  const std::vector<std::size_t> told = told_quantities(report, problem);
  std::vector<Results> rows;
  for (std::size_t k = 0; k < report.result.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[k];
    if (row.setting.problem != problem) continue;
    const Timing& time = row.time;
    Results& line = rows.emplace_back();
    line.add("", "  setting", (on_a_front(report, k) ? "* " : "  ") + row.setting.label());
    if (!row.refusal.empty() || time.repetitions == 0) {
      line.note(row.refusal.empty() ? "not timed" : row.refusal);
      continue;
    }
    line.add("", "time", readable_seconds(time.median))
        .add("", "spread", (time.upper_quartile - time.lower_quartile) / time.median, "", {Shown::percent, 2})
        .add("", "n", time.repetitions);
    if (report.study.pieces > 0)
      line.add("", "ns per " + report.study.piece,
               fmt::format("{:.3g}", 1e9 * time.processor_median / report.study.pieces));
    for (const std::size_t q : told) {
      const Quantity& quantity = report.study.quantities[q];
      line.add("", (quantity.fact ? "" : "err ") + quantity.name,
               cell(quantity.fact ? row.values[q] : row.errors[q], quantity.fact));
    }
  }
  return rows;
}

Results row_results(const StudyReport& report, const StudyRow& row) {
  Results setting, values, errors, assured;
  for (const auto& [name, value] : row.setting.values) setting.set(name, value);
  for (std::size_t q = 0; q < row.values.size(); ++q) {
    const Quantity& quantity = report.study.quantities[q];
    values.set(quantity.name, row.values[q]);
    if (quantity.fact) continue;
    errors.set(quantity.name, row.errors[q]);
    assured.set(quantity.name, row.assured[q]);
  }
  Results out;
  out.set("problem", row.setting.problem).set("method", row.setting.method).set("setting", setting);
  if (row.setting.size > 0) out.set("size", row.setting.size);
  out.set("resolution", row.setting.resolution)
      .set("seconds/median", row.time.median)
      .set("seconds/lower_quartile", row.time.lower_quartile)
      .set("seconds/upper_quartile", row.time.upper_quartile)
      .set("seconds/processor_median", row.time.processor_median)
      .set("seconds/processor_lower_quartile", row.time.processor_lower_quartile)
      .set("seconds/processor_upper_quartile", row.time.processor_upper_quartile)
      .set("seconds/repetitions", row.time.repetitions);
  out.set("values", values).set("errors", errors).set("assured_errors", assured);
  return row.refusal.empty() ? out : out.set("refusal", row.refusal);
}

Results curve_results(const StudyReport& report, const StudyCurve& curve) {
  const std::string& quantity = report.study.quantities[curve.quantity].name;
  Results out;
  out.set("problem", curve.problem).set("method", curve.method).set("quantity", quantity);
  out.set("observed_order", nullptr).set("theoretical_order", nullptr).set("cost_exponent", curve.cost_exponent);
  if (curve.expected) {
    out.set("theoretical_order", curve.expected->order).set("why", curve.expected->why).set("agrees", curve.agrees);
  }
  if (!curve.order) return out;
  const ObservedOrder& order = *curve.order;
  out.set("observed_order", order.order).set("uncertainty", order.uncertainty).set("levels", order.levels);
  out.set("range", std::vector{order.coarsest, order.finest});
  std::vector<std::string> curve_of;
  for (const std::string& part : {curve.problem, curve.method, quantity})
    if (!part.empty()) curve_of.push_back(part);
  std::string text =
      fmt::format("  {}: order {:.3f}{} over {} levels", joined(curve_of), order.order,
                  std::isfinite(order.uncertainty) ? fmt::format(" ± {:.2g}", order.uncertainty) : "", order.levels);
  if (curve.expected) {
    text += fmt::format("; theory {:g}, {}", curve.expected->order, curve.agrees ? "agrees" : "DIFFERS");
    if (!curve.expected->why.empty()) text += fmt::format(" ({})", curve.expected->why);
  }
  return out.block(text + fmt::format("; time as h^{:.2f}\n", -curve.cost_exponent));
}

Results quantity_results(const Study& study, const Quantity& quantity) {
  const std::string truth = to_string(study.truth);
  Results out;
  out.set("name", quantity.name).set("label", quantity.label).set("fact", quantity.fact);
  out.set("relative", quantity.relative).set("truth", truth).set("source", quantity.source);
  if (quantity.fact) return out;
  if (study.truth == Truth::known) out.set("true_value", quantity.truth);
  return out.line(quantity.name, (quantity.label.empty() ? "" : quantity.label + "; ") +
                                     "truth: " + (quantity.source.empty() ? truth : quantity.source));
}

Results recommendation_results(const StudyReport& report, const Recommendation& recommendation) {
  Results out;
  out.set("problem", recommendation.problem).set("text", recommendation.text).set("best_error", recommendation.best);
  out.block(recommendation.text + "\n").set("setting", nullptr);
  return recommendation.row ? out.set("setting", row_results(report, report.result.rows[*recommendation.row])) : out;
}

std::string lines_of(const std::vector<std::string>& sentences) {
  return joined(
      sentences, [](const std::string& sentence) { return sentence + "\n"; }, "");
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
  if (study.pieces > 0) out.set("pieces", study.pieces).set("piece", study.piece);
  std::vector<Results> quantities, settings, curves, fronts, recommendations;
  for (const Quantity& quantity : study.quantities) quantities.push_back(quantity_results(study, quantity));
  for (const StudyRow& row : result.rows) settings.push_back(row_results(report, row));
  for (const StudyCurve& curve : result.curves) curves.push_back(curve_results(report, curve));
  for (const StudyFront& front : result.fronts) {
    const auto label = [&](std::size_t row) { return result.rows[row].setting.label(); };
    std::vector<std::string> labels;
    for (const std::size_t row : front.rows) labels.push_back(label(row));
    fronts.push_back(Results()
                         .set("problem", front.problem)
                         .set("quantity", study.quantities[front.quantity].name)
                         .set("settings", labels));
  }
  for (const Recommendation& one : report.recommendations)
    recommendations.push_back(recommendation_results(report, one));

  out.list("quantities", std::move(quantities)).line("machine", report.machine.text());
  out.line("timing", fmt::format("{} after one to warm up, all settings in an order drawn anew each time (seed {}); "
                                 "median, quartiles apart, number n",
                                 counted(result.rounds, "round"), report.options.seed));
  for (const std::string& problem : problems_of(study))
    out.block("\n" + (problem.empty() ? "" : problem + "\n")).table("", table_of(report, problem));
  if (!fronts.empty()) out.block("\n* on a front: nothing is both faster and as accurate\n");
  if (std::ranges::any_of(result.curves, [](const StudyCurve& curve) { return curve.order.has_value(); }))
    out.block("\norders, errors as h^p over the finest levels (95 % interval)\n");
  out.list("orders", std::move(curves)).block("\n" + lines_of(result.advice));
  if (report.accuracy) out.set("accuracy", *report.accuracy).list("recommendations", std::move(recommendations));
  out.block(lines_of(study.notes)).set("settings", settings).set("fronts", fronts);
  return out.set("advice", result.advice).set("notes", study.notes);
}

Table study_table(const StudyReport& report) {
  const auto& rows = report.result.rows;
  Table table;
  table.add("problem", rows, [](const StudyRow& r) { return r.setting.problem; });
  table.add("method", rows, [](const StudyRow& r) { return r.setting.method; });
  table.add("setting", rows, [](const StudyRow& r) { return r.setting.label(); });
  table.add("resolution", rows, [](const StudyRow& r) { return r.setting.resolution; });
  table.add("median_s", rows, [](const StudyRow& r) { return r.time.median; });
  table.add("lower_quartile_s", rows, [](const StudyRow& r) { return r.time.lower_quartile; });
  table.add("upper_quartile_s", rows, [](const StudyRow& r) { return r.time.upper_quartile; });
  table.add("processor_median_s", rows, [](const StudyRow& r) { return r.time.processor_median; });
  table.add("repetitions", rows, [](const StudyRow& r) { return static_cast<double>(r.time.repetitions); });
  for (std::size_t q = 0; q < report.study.quantities.size(); ++q) {
    const Quantity& quantity = report.study.quantities[q];
    const auto add = [&](const std::string& name, std::vector<double> StudyRow::*values) {
      table.add(name, rows, [&](const StudyRow& r) { return (r.*values).empty() ? NAN : (r.*values)[q]; });
    };
    add(quantity.name, &StudyRow::values);
    if (quantity.fact) continue;
    add(quantity.name + "_error", &StudyRow::errors);
    add(quantity.name + "_assured_error", &StudyRow::assured);
  }
  return table.add("refusal", rows, &StudyRow::refusal);
}

}  // namespace equidem
