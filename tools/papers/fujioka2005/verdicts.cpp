// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The conclusions of the paper, each decided by the numbers of the reproduction.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include "equidem/core/text.hpp"

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr std::size_t impacts_of_paper = 10;

template <class Row>
const Row& of(const std::vector<Row>& rows, std::string_view label) {
  return *std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.variant.label == label; });
}

const char* decided(bool holds) {
  return holds ? "holds" : "does not hold here";
}

/// Largest |ratio - e²| of the impacts from the first-th to the last-th.
double worst(const std::vector<double>& ratios, std::size_t first, std::size_t last) {
  double most = 0;
  for (std::size_t n = first; n <= std::min(last, ratios.size()); ++n)
    most = std::max(most, std::abs(ratios[n - 1] - theory));
  return most;
}

/// Shares of the impacts of P whose states pass through the modes 1, 2 and 4, and that part from mode 2.
struct Passages {
  double by_1_2_4 = 0, from_mode_2 = 0;
};

Passages passages(const Impacts& law) {
  Passages shares;
  const double border = std::sqrt(1 - law.variant.a), one = 1 / static_cast<double>(law.paths.size());
  for (const auto& path : law.paths) {
    const auto slope = [&](std::size_t k) { return path[k].second / path[k].first; };
    if (path.size() < 2 || slope(0) < 1) continue;
    if (path.size() == 2 && slope(1) >= border) shares.from_mode_2 += one;
    if (path.size() == 3 && slope(1) > 0 && slope(1) < border && slope(2) < -border) shares.by_1_2_4 += one;
  }
  return shares;
}

std::string slow_impacts(const std::vector<Impacts>& slow) {
  struct Law {
    const Impacts& law;
    double all, late;
    explicit Law(const Impacts& one)
        : law(one),
          all(worst(one.ratio, 1, impacts_of_paper)),
          late(worst(one.ratio, impacts_of_paper / 2 + 1, impacts_of_paper)) {}
  };
  const Law c(of(slow, "C")), t(of(slow, "T")), f(of(slow, "F")), p(of(slow, "P"));
  const double flights_p = worst(p.law.flight_ratio, 1, impacts_of_paper),
               flights_f = worst(f.law.flight_ratio, 1, impacts_of_paper);
  return fmt::format(
      "5.2 \"F and P lie in a narrow range about 0.49, C and T do not\": {}. Worst of the first ten impacts: P {:.4f}, "
      "F {:.4f},\n"
      "    T {:.4f}, C {:.4f}.\n"
      "5.2 \"In late, slow impacts P is more accurate than F\": {}. Worst of the impacts 6 to 10: P {:.4f}, F {:.4f}.\n"
      "    From flight to flight it is {:.3f} of P and {:.3f} of F over ten impacts.\n",
      decided(std::max(p.all, f.all) < std::min(c.all, t.all)), p.all, f.all, t.all, c.all, decided(p.late < f.late),
      p.late, f.late, flights_p, flights_f);
}

std::string fast_impacts(const std::vector<Impacts>& fast) {
  const Impacts &c = of(fast, "C"), &t = of(fast, "T"), &soft = of(fast, "T soft"), &f = of(fast, "F"),
                &p = of(fast, "P");
  const auto [low, high] = std::minmax_element(soft.ratio.begin(), soft.ratio.end());
  const double f_worst = worst(f.ratio, 1, f.ratio.size()), p_worst = worst(p.ratio, 1, p.ratio.size());
  return fmt::format(
      "5.3 \"C passes through the wall at the second impact\": {}; it is {:.2f} diameters deep in the first impact "
      "(\"d exceeds 1\"\n"
      "    in Fig. 6 holds) and returns from the half space.\n"
      "5.3 \"T goes on, but its ratio is not constant\": {} at a = {:g} of Table 2, where it returns {:.1f} times the "
      "energy; at\n"
      "    a = {:g} {}: ratios from {:.2f} to {:.2f}.\n"
      "5.3 \"F and P are near the theory\": {}. Worst of {} impacts: P {:.0e}, F {:.0e}.\n"
      "5.3 \"P passes through modes 1, 2, 4\": in {:.0f} % of the impacts; {:.0f} % part from mode 2, where (21) is "
      "replaced by (23).\n",
      decided(c.ratio.size() < 2), c.deepest, decided(!t.ran_away), t.variant.a, t.ratio.front(), soft.variant.a,
      soft.ran_away ? "neither" : "it holds", *low, *high, decided(std::max(f_worst, p_worst) < 1e-3), p.ratio.size(),
      p_worst, f_worst, 100 * passages(p).by_1_2_4, 100 * passages(p).from_mode_2);
}

std::string cost(const Table1& table) {
  const Table1Row &c = of(table.rows, "C"), &p = of(table.rows, "P");
  const double more = p.evaluation_nanoseconds / c.evaluation_nanoseconds - 1;
  return fmt::format(
      "5.4 \"An evaluation of P costs 4 % more\": {}, see Table 1. \"The whole run is shorter, since there are fewer "
      "evaluations\":\n"
      "    {}; {:.3g} of P, {:.3g} of C, {:.3g} and {:.3g} s.\n",
      decided(more < 0.1), decided(p.run_seconds < c.run_seconds && p.evaluations < c.evaluations),
      static_cast<double>(p.evaluations), static_cast<double>(c.evaluations), p.run_seconds, c.run_seconds);
}

std::string stacked(const std::vector<Curve>& curves) {
  const auto &c = of(curves, "C").points, &t = of(curves, "T").points, &f = of(curves, "F").points,
             &p = of(curves, "P").points;
  std::size_t speed = 0, parting = 0, fine = 0, f_better = 0;
  double apart = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto better = [&](double CurvePoint::*error) {
      return std::max(p[k].*error, f[k].*error) < std::min(c[k].*error, t[k].*error);
    };
    if (better(&CurvePoint::speed_error)) ++speed;
    if (better(&CurvePoint::parting_error)) ++parting;
    if (f[k].speed_error < p[k].speed_error) ++f_better;
    if (p[k].step > 1.01e-4) continue;
    ++fine;
    apart = std::max(apart, std::abs(f[k].speed_error / p[k].speed_error - 1));
  }
  const auto last = [](const std::vector<CurvePoint>& points) { return points.back().speed_error; };
  return fmt::format(
      "5.6 \"P and F are more accurate than C and T\": {} at the smallest step, {:.0e} s: errors of d' P {:.0e}, F "
      "{:.0e}, T {:.0e},\n"
      "    C {:.0e}; at {} of {} steps in d', at {} in T0: not where errors change sign, nor at steps near 1e-3 s.\n"
      "5.6 \"F is often the more accurate of the two\": at {} of {} steps, but the errors of d' differ by at most "
      "{:.0e} of\n"
      "    themselves at the {} steps up to 1e-4 s.\n",
      decided(std::max(last(p), last(f)) < std::min(last(c), last(t))), p.back().step, last(p), last(f), last(t),
      last(c), speed, p.size(), parting, f_better, p.size(), apart, fine);
}

}  // namespace

std::string verdicts(const Reproduction& r) {
  constexpr std::array<std::array<std::int64_t, 3>, 4> printed{{{9, 10, 10}, {14, 23, 37}, {2, 1, 1}, {3, 3, 3}}};
  int agree = 0;
  for (std::size_t k = 0; k < printed.size(); ++k)
    for (std::size_t step = 0; step < 3; ++step) agree += r.table2[k].steps[step] == printed[k][step] ? 1 : 0;
  return "The conclusions of the paper\n" + slow_impacts(r.slow) + fast_impacts(r.fast) + cost(r.table1) +
         fmt::format(
             "5.5 Table 2, steps in contact: {}. {} of 12 counts agree; those of C, F and P do not grow as the step "
             "falls, with a\n"
             "    held fixed. With the spring held fixed (k in N/m), C would take ten times the steps for a tenth of "
             "the step.\n",
             decided(agree == 12), agree) +
         stacked(r.stacked);
}

}  // namespace equidem::fujioka2005
