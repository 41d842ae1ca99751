// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/evaluate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Rows of the same problem and method that are refined, from coarse to fine; none where the row is not.
std::vector<std::size_t> levels_of(const std::vector<StudyRow>& rows, const Setting& setting) {
  std::vector<std::size_t> levels;
  if (!std::isfinite(setting.resolution)) return levels;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Setting& s = rows[k].setting;
    if (s.problem == setting.problem && s.method == setting.method && std::isfinite(s.resolution) &&
        !rows[k].values.empty())
      levels.push_back(k);
  }
  std::stable_sort(levels.begin(), levels.end(), [&](std::size_t a, std::size_t b) {
    return rows[a].setting.resolution > rows[b].setting.resolution;
  });
  return levels;
}

/// The truth of a quantity for a row; not a number where there is none.
double truth_of(const Study& study, const std::vector<StudyRow>& rows, const StudyRow& row, std::size_t quantity) {
  const Quantity& q = study.quantities[quantity];
  if (study.truth == Truth::known) return q.truth;
  const std::vector<std::size_t> levels = levels_of(rows, row.setting);
  if (levels.size() < 2) return unknown;
  const StudyRow& finest = rows[levels.back()];
  if (study.truth == Truth::finest) return &finest == &row ? unknown : finest.values[quantity];
  const ExpectedOrder* expected = study.expected(row.setting, q.name);
  if (expected == nullptr) return unknown;
  const StudyRow& coarser = rows[levels[levels.size() - 2]];
  return richardson_limit(coarser.setting.resolution, coarser.values[quantity], finest.setting.resolution,
                          finest.values[quantity], expected->order);
}

double error_of(const Quantity& quantity, double value, double truth) {
  const double error = std::abs(value - truth) / (quantity.relative ? std::abs(truth) : 1);
  return std::isfinite(error) ? std::max(error, quantity.rounding) : unknown;
}

void find_errors(const Study& study, std::vector<StudyRow>& rows) {
  const std::size_t quantities = study.quantities.size();
  for (StudyRow& row : rows) {
    if (row.values.empty()) continue;
    row.errors.assign(quantities, unknown);
    for (std::size_t q = 0; q < quantities; ++q) {
      if (!study.quantities[q].fact)
        row.errors[q] = error_of(study.quantities[q], row.values[q], truth_of(study, rows, row, q));
    }
  }
  for (StudyRow& row : rows) {
    row.assured = row.errors;
    if (row.errors.empty()) continue;
    for (const std::size_t finer : levels_of(rows, row.setting)) {
      if (rows[finer].setting.resolution > row.setting.resolution) continue;
      for (std::size_t q = 0; q < quantities; ++q) {
        if (std::isfinite(row.errors[q])) row.assured[q] = std::fmax(row.assured[q], rows[finer].errors[q]);
      }
    }
  }
}

/// Exponent of time over 1/h, from the finer half of the levels, at least two.
double cost_exponent_of(const std::vector<StudyRow>& rows, const std::vector<std::size_t>& levels) {
  std::vector<Level> times;
  for (std::size_t k = levels.size() < 4 ? 0 : levels.size() / 2; k < levels.size(); ++k)
    times.push_back({rows[levels[k]].setting.resolution, rows[levels[k]].time.median});
  const auto fit = observed_order(times);
  return fit ? -fit->order : 0;
}

std::vector<StudyCurve> curves_of(const Study& study, const std::vector<StudyRow>& rows) {
  std::vector<StudyCurve> curves;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::vector<std::size_t> levels = levels_of(rows, rows[k].setting);
    if (levels.size() < 2 || levels.front() != k) continue;
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
      std::vector<Level> errors;
      for (const std::size_t row : levels) errors.push_back({rows[row].setting.resolution, rows[row].errors[q]});
      if (std::none_of(errors.begin(), errors.end(), [](const Level& l) { return std::isfinite(l.error); })) continue;
      StudyCurve curve{
          .problem = rows[k].setting.problem, .method = rows[k].setting.method, .quantity = q, .rows = levels};
      curve.order = observed_order(errors, study.quantities[q].rounding);
      if (const ExpectedOrder* expected = study.expected(rows[k].setting, study.quantities[q].name))
        curve.expected = *expected;
      if (curve.order && curve.expected) {
        constexpr double allowed = 0.1;
        const double known_to = std::isfinite(curve.order->uncertainty) ? curve.order->uncertainty : 0;
        curve.agrees = std::abs(curve.order->order - curve.expected->order) <= std::max(allowed, known_to);
      }
      curve.cost_exponent = cost_exponent_of(rows, levels);
      curves.push_back(std::move(curve));
    }
  }
  return curves;
}

/// Time and assured error of the rows of a problem; others take no part. The largest over all quantities where none is
/// given.
std::vector<CostPoint> points_of(const Study& study, const std::vector<StudyRow>& rows, const std::string& problem,
                                 std::optional<std::size_t> quantity) {
  std::vector<CostPoint> points;
  for (const StudyRow& row : rows) {
    CostPoint point{row.time.median, unknown};
    if (row.setting.problem == problem && row.time.repetitions > 0) {
      for (std::size_t q = 0; q < study.quantities.size(); ++q) {
        if ((!quantity || *quantity == q) && !row.assured.empty()) point.error = std::fmax(point.error, row.assured[q]);
      }
    }
    points.push_back(point);
  }
  return points;
}

/// Cost, relative to a row, of an error `times` smaller: by the front where it reaches that far, else by
/// the order of the row's method.
std::string price_of_more(const Study& study, const StudyResult& result, const std::vector<CostPoint>& points,
                          std::size_t row, double times) {
  const double wanted = points[row].error / times;
  if (const auto better = cheapest_within(points, wanted)) {
    return fmt::format("{:g} times more accuracy costs {:.2g} times the time ({})", times,
                       points[*better].seconds / points[row].seconds, result.rows[*better].setting.label());
  }
  double price = 0;
  for (const StudyCurve& curve : result.curves) {
    const Setting& s = result.rows[row].setting;
    const bool mine = curve.problem == s.problem && curve.method == s.method && curve.order &&
                      curve.order->order > 0.1 && curve.cost_exponent > 0 &&
                      points[row].error > study.quantities[curve.quantity].rounding * times;
    if (mine) price = std::max(price, cost_of_accuracy(times, curve.cost_exponent, curve.order->order));
  }
  if (price > 0)
    return fmt::format("{:g} times more accuracy would cost about {:.2g} times the time, by its order", times, price);
  return fmt::format("no setting tried is {:g} times more accurate", times);
}

std::string advice_for(const Study& study, const StudyResult& result, const std::string& problem) {
  const std::vector<CostPoint> points = points_of(study, result.rows, problem, {});
  const std::vector<std::size_t> front = front_of(points);
  const std::string head = problem.empty() ? "" : problem + ": ";
  if (front.empty()) return "";
  const std::size_t last = front.back();
  std::string text =
      fmt::format("{}{} is the most accurate (error {:.2g}, {})", head, result.rows[last].setting.label(),
                  points[last].error, readable_seconds(points[last].seconds));
  if (front.size() == 1) return text + "; nothing else is as fast.";
  const std::size_t first = front.front();
  text += fmt::format("; {} is the fastest (error {:.2g}, {}); from there {}.", result.rows[first].setting.label(),
                      points[first].error, readable_seconds(points[first].seconds),
                      price_of_more(study, result, points, first, 10));
  const auto slower = static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const CostPoint& p) {
    return std::isfinite(p.error) && p.seconds > points[last].seconds;
  }));
  if (slower > 0)
    text += fmt::format(" Beyond it errors stop falling: {} without being more accurate.",
                        slower == 1 ? "one setting takes longer" : fmt::format("{} settings take longer", slower));
  return text;
}

}  // namespace

std::vector<std::string> problems_of(const Study& study) {
  std::vector<std::string> problems;
  for (const StudyTask& task : study.tasks) {
    if (std::find(problems.begin(), problems.end(), task.setting.problem) == problems.end())
      problems.push_back(task.setting.problem);
  }
  return problems;
}

std::string readable_seconds(double seconds) {
  if (seconds < 1e-6) return fmt::format("{:.3g} ns", 1e9 * seconds);
  if (seconds < 1e-3) return fmt::format("{:.3g} µs", 1e6 * seconds);
  if (seconds < 1) return fmt::format("{:.3g} ms", 1e3 * seconds);
  return fmt::format("{:.3g} s", seconds);
}

StudyResult evaluate(const Study& study, const StudySamples& samples) {
  assert(samples.tasks.size() == study.tasks.size());
  StudyResult result;
  result.rounds = samples.rounds();
  result.complete = !samples.stopped;
  for (std::size_t k = 0; k < study.tasks.size(); ++k) {
    const TaskSamples& of_task = samples.tasks[k];
    result.rows.push_back({.setting = study.tasks[k].setting,
                           .time = summarize(of_task.times),
                           .values = of_task.values,
                           .errors = {},
                           .assured = {},
                           .refusal = of_task.refusal});
    for (std::size_t q = 0; q < of_task.values.size(); ++q)
      if (study.quantities[q].resolution) result.rows.back().setting.resolution = of_task.values[q];
  }
  find_errors(study, result.rows);
  result.curves = curves_of(study, result.rows);
  for (const std::string& problem : problems_of(study)) {
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
      StudyFront front{problem, q, front_of(points_of(study, result.rows, problem, q))};
      if (!front.rows.empty()) result.fronts.push_back(std::move(front));
    }
    const std::string advice = advice_for(study, result, problem);
    if (!advice.empty()) result.advice.push_back(advice);
  }
  return result;
}

std::vector<Recommendation> recommend(const Study& study, const StudyResult& result, double accuracy) {
  std::vector<Recommendation> all;
  for (const std::string& problem : problems_of(study)) {
    const std::vector<CostPoint> points = points_of(study, result.rows, problem, {});
    const std::vector<std::size_t> front = front_of(points);
    if (front.empty()) continue;
    Recommendation one{
        .problem = problem, .row = cheapest_within(points, accuracy), .best = points[front.back()].error, .text = {}};
    const std::string head = problem.empty() ? "" : problem + ": ";
    if (one.row) {
      one.text =
          fmt::format("{}the cheapest setting that reaches {:g} is {} (error {:.2g}, {}); {}.", head, accuracy,
                      result.rows[*one.row].setting.label(), points[*one.row].error,
                      readable_seconds(points[*one.row].seconds), price_of_more(study, result, points, *one.row, 10));
    } else {
      one.text = fmt::format("{}no setting reaches {:g}; the best, {}, reaches {:.2g} in {}.", head, accuracy,
                             result.rows[front.back()].setting.label(), one.best,
                             readable_seconds(points[front.back()].seconds));
    }
    all.push_back(std::move(one));
  }
  return all;
}

std::vector<std::size_t> front_of(std::span<const CostPoint> points) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (std::isfinite(points[k].seconds) && std::isfinite(points[k].error)) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const CostPoint &p = points[a], &q = points[b];
    return p.seconds != q.seconds ? p.seconds < q.seconds : p.error < q.error;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t k : order) {
    if (points[k].error >= least) continue;
    least = points[k].error;
    front.push_back(k);
  }
  return front;
}

std::optional<std::size_t> cheapest_within(std::span<const CostPoint> points, double error) {
  for (const std::size_t k : front_of(points)) {
    if (points[k].error <= error) return k;
  }
  return {};
}

}  // namespace equidem
