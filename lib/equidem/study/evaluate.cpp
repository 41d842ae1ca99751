// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/evaluate.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double error_floor = 1e-15;  // of rounding: errors below are shown as this, and are no part of an order

/// The line through all of these.
ObservedOrder fit(std::span<const Level> levels) {
  const auto n = static_cast<double>(levels.size());
  double x = 0, y = 0;
  for (const Level& level : levels) {
    x += std::log(level.h) / n;
    y += std::log(level.error) / n;
  }
  double xx = 0, xy = 0, left = 0;
  for (const Level& level : levels) {
    const double u = std::log(level.h) - x, v = std::log(level.error) - y;
    xx += u * u;
    xy += u * v;
  }
  ObservedOrder result{.order = xy / xx, .levels = levels.size()};
  for (const Level& level : levels) {
    const double off = std::log(level.error) - y - result.order * (std::log(level.h) - x);
    left += off * off;
  }
  const auto freedom = static_cast<std::int64_t>(levels.size()) - 2;
  result.uncertainty =
      freedom < 1 ? std::numeric_limits<double>::quiet_NaN()
                  : student_critical_value(0.95, freedom) * std::sqrt(left / (static_cast<double>(freedom) * xx));
  result.constant = std::exp(y - result.order * x);
  result.coarsest = levels.front().h;
  result.finest = levels.back().h;
  return result;
}

/// Where the orders between neighbouring levels approach a limit smoothly, each change of one sign and smaller than the
/// one before by `smooth`, there is no scatter but curvature: the last order, uncertain by its last change. Empty where
/// they do not.
std::optional<ObservedOrder> order_that_settles(std::span<const Level> levels) {
  constexpr std::size_t needed = 5;
  constexpr double smooth = 0.7;
  if (levels.size() < needed) return {};
  const auto finest = levels.last(needed);
  std::array<double, needed - 1> order{};
  for (std::size_t k = 0; k + 1 < needed; ++k) {
    if (finest[k].h == finest[k + 1].h) return {};
    order[k] = std::log(finest[k].error / finest[k + 1].error) / std::log(finest[k].h / finest[k + 1].h);
  }
  for (std::size_t k = 2; k + 1 < needed; ++k) {
    const double before = order[k - 1] - order[k - 2], now = order[k] - order[k - 1];
    if (!(now * before >= 0 && std::abs(now) <= smooth * std::abs(before))) return {};
  }
  ObservedOrder result = fit(finest.last(2));
  result.uncertainty = std::abs(order[needed - 2] - order[needed - 3]);
  result.levels = needed;
  result.coarsest = finest.front().h;
  return result;
}

/// Rows of the same method that are refined, from coarse to fine; none where the row is not.
std::vector<std::size_t> levels_of(const std::vector<StudyRow>& rows, const Setting& setting) {
  std::vector<std::size_t> levels;
  if (!std::isfinite(setting.resolution)) return levels;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Setting& s = rows[k].setting;
    if (s.method == setting.method && std::isfinite(s.resolution) && rows[k].value) levels.push_back(k);
  }
  std::stable_sort(levels.begin(), levels.end(), [&](std::size_t a, std::size_t b) {
    return rows[a].setting.resolution > rows[b].setting.resolution;
  });
  return levels;
}

/// The truth for a row; not a number where there is none.
double truth_of(const Study& study, const std::vector<StudyRow>& rows, const StudyRow& row) {
  if (study.truth == Truth::known) return study.true_value;
  const std::vector<std::size_t> levels = levels_of(rows, row.setting);
  if (levels.size() < 2) return unknown;
  const StudyRow& finest = rows[levels.back()];
  if (study.truth == Truth::finest) return &finest == &row ? unknown : *finest.value;
  if (!row.setting.order) return unknown;
  const StudyRow& coarser = rows[levels[levels.size() - 2]];
  return richardson_limit(coarser.setting.resolution, *coarser.value, finest.setting.resolution, *finest.value,
                          *row.setting.order);
}

void find_errors(const Study& study, std::vector<StudyRow>& rows) {
  for (StudyRow& row : rows) {
    row.error = unknown;
    if (!row.value) continue;
    const double truth = truth_of(study, rows, row);
    const double error = std::abs(*row.value - truth) / (study.relative ? std::abs(truth) : 1);
    if (std::isfinite(error)) row.error = std::max(error, error_floor);
  }
  for (StudyRow& row : rows) {
    row.assured = row.error;
    if (!std::isfinite(row.error)) continue;
    for (const std::size_t finer : levels_of(rows, row.setting)) {
      if (rows[finer].setting.resolution <= row.setting.resolution)
        row.assured = std::fmax(row.assured, rows[finer].error);
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

std::vector<StudyCurve> curves_of(const std::vector<StudyRow>& rows) {
  std::vector<StudyCurve> curves;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Setting& setting = rows[k].setting;
    const std::vector<std::size_t> levels = levels_of(rows, setting);
    if (levels.size() < 2 || levels.front() != k) continue;
    std::vector<Level> errors;
    for (const std::size_t row : levels) errors.push_back({rows[row].setting.resolution, rows[row].error});
    if (std::none_of(errors.begin(), errors.end(), [](const Level& l) { return std::isfinite(l.error); })) continue;
    StudyCurve curve{.method = setting.method, .rows = levels, .expected = setting.order};
    curve.order = observed_order(errors, error_floor);
    if (curve.order && curve.expected) {
      constexpr double allowed = 0.1;
      const double known_to = std::isfinite(curve.order->uncertainty) ? curve.order->uncertainty : 0;
      curve.agrees = std::abs(curve.order->order - *curve.expected) <= std::max(allowed, known_to);
    }
    curve.cost_exponent = cost_exponent_of(rows, levels);
    curves.push_back(std::move(curve));
  }
  return curves;
}

/// Time and assured error of the rows; those that were not timed take no part.
std::vector<CostPoint> points_of(const std::vector<StudyRow>& rows) {
  std::vector<CostPoint> points;
  for (const StudyRow& row : rows)
    points.push_back({row.time.median, row.time.repetitions > 0 ? row.assured : unknown});
  return points;
}

/// Cost, relative to a row, of an error `times` smaller: by the front where it reaches that far, else by
/// the order of the row's method.
std::string price_of_more(const StudyResult& result, const std::vector<CostPoint>& points, std::size_t row,
                          double times) {
  if (const auto better = cheapest_within(points, points[row].error / times)) {
    return fmt::format("{:g} times more accuracy costs {:.2g} times the time ({})", times,
                       points[*better].seconds / points[row].seconds, result.rows[*better].setting.label());
  }
  for (const StudyCurve& curve : result.curves) {
    if (curve.method == result.rows[row].setting.method && curve.order && curve.order->order > 0.1 &&
        curve.cost_exponent > 0 && points[row].error > error_floor * times)
      return fmt::format("{:g} times more accuracy would cost about {:.2g} times the time, by its order", times,
                         cost_of_accuracy(times, curve.cost_exponent, curve.order->order));
  }
  return fmt::format("no setting tried is {:g} times more accurate", times);
}

std::string advice_for(const StudyResult& result) {
  const std::vector<CostPoint> points = points_of(result.rows);
  const std::vector<std::size_t>& front = result.front;
  if (front.empty()) return "";
  const std::size_t last = front.back();
  std::string text = fmt::format("{} is the most accurate (error {:.2g}, {})", result.rows[last].setting.label(),
                                 points[last].error, readable_seconds(points[last].seconds));
  if (front.size() == 1) return text + "; nothing else is as fast.";
  const std::size_t first = front.front();
  text += fmt::format("; {} is the fastest (error {:.2g}, {}); from there {}.", result.rows[first].setting.label(),
                      points[first].error, readable_seconds(points[first].seconds),
                      price_of_more(result, points, first, 10));
  const auto slower = static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const CostPoint& p) {
    return std::isfinite(p.error) && p.seconds > points[last].seconds;
  }));
  if (slower > 0)
    text += fmt::format(" Beyond it errors stop falling: {} without being more accurate.",
                        slower == 1 ? "one setting takes longer" : fmt::format("{} settings take longer", slower));
  return text;
}

}  // namespace

double ObservedOrder::error_at(double h) const {
  return constant * std::pow(h, order);
}

std::optional<ObservedOrder> observed_order(std::span<const Level> levels, double floor) {
  std::vector<Level> usable;
  for (const Level& level : levels) {
    if (level.h > 0 && std::isfinite(level.h) && std::isfinite(level.error) && level.error > std::max(floor, 0.0))
      usable.push_back(level);
  }
  std::sort(usable.begin(), usable.end(), [](const Level& a, const Level& b) { return a.h > b.h; });
  const auto same = [](const Level& a, const Level& b) { return a.h == b.h && a.error == b.error; };
  usable.erase(std::unique(usable.begin(), usable.end(), same), usable.end());
  if (usable.size() < 2 || usable.front().h == usable.back().h) return {};
  std::vector<ObservedOrder> fits;  // of ever more levels
  for (std::size_t count = std::min<std::size_t>(usable.size(), 4); count <= usable.size(); ++count) {
    const auto finest = std::span<const Level>(usable).last(count);
    if (finest.front().h != finest.back().h) fits.push_back(fit(finest));
  }
  if (fits.empty()) return {};
  double least = fits.front().uncertainty;
  for (const ObservedOrder& one : fits) least = std::min(least, one.uncertainty);
  ObservedOrder best = fits.front();
  for (const ObservedOrder& one : fits) {
    if (one.uncertainty <= 2 * least) best = one;
  }
  const auto settling = order_that_settles(usable);
  return settling && settling->uncertainty < best.uncertainty ? settling : best;
}

double richardson_limit(double coarse_h, double coarse, double fine_h, double fine, double order) {
  return fine + (fine - coarse) / (std::pow(coarse_h / fine_h, order) - 1);
}

std::optional<double> order_of_three(std::span<const double, 3> h, std::span<const double, 3> values) {
  const double wanted = (values[0] - values[1]) / (values[1] - values[2]);
  if (!(wanted > 0) || !std::isfinite(wanted) || !(h[0] > h[1] && h[1] > h[2] && h[2] > 0)) return {};
  const double up = h[0] / h[1], down = h[2] / h[1];
  const auto ratio = [&](double p) { return (std::pow(up, p) - 1) / (1 - std::pow(down, p)); };  // rises with p
  double low = 0.05, high = 20;
  if (wanted < ratio(low) || wanted > ratio(high)) return {};
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (ratio(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double cost_of_accuracy(double factor, double cost_exponent, double order) {
  return std::pow(factor, cost_exponent / order);
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
                           .value = of_task.value,
                           .refusal = of_task.refusal});
  }
  find_errors(study, result.rows);
  result.curves = curves_of(result.rows);
  result.front = front_of(points_of(result.rows));
  result.advice = advice_for(result);
  return result;
}

std::optional<Recommendation> recommend(const StudyResult& result, double accuracy) {
  if (result.front.empty()) return {};
  const std::vector<CostPoint> points = points_of(result.rows);
  const std::size_t last = result.front.back();
  Recommendation one{.row = cheapest_within(points, accuracy), .best = points[last].error, .text = {}};
  if (one.row) {
    one.text = fmt::format("the cheapest setting that reaches {:g} is {} (error {:.2g}, {}); {}.", accuracy,
                           result.rows[*one.row].setting.label(), points[*one.row].error,
                           readable_seconds(points[*one.row].seconds), price_of_more(result, points, *one.row, 10));
  } else {
    one.text = fmt::format("no setting reaches {:g}; the best, {}, reaches {:.2g} in {}.", accuracy,
                           result.rows[last].setting.label(), one.best, readable_seconds(points[last].seconds));
  }
  return one;
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
