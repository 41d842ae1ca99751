// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Figs. 10 and 11: a sphere slides down between two others.
#include <algorithm>
#include <cmath>

#include "equidem/contact/laws/linear_dashpot.hpp"

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr double duration = 1.3 * exact_parting;

/// 1e-3 to 1e-6 s, four per decade; quick: to 1e-5 s, two per decade.
std::vector<double> steps_of(bool quick) {
  std::vector<double> steps;
  const int last = quick ? 20 : 24;
  for (int k = 12; k <= last; k += quick ? 2 : 1) steps.push_back(std::pow(10.0, -k / 4.0));
  return steps;
}

void set_errors(CurvePoint& point, double speed, double parting) {
  point.speed_error = std::abs(dimensionless_speed(speed) / exact_speed - 1);
  point.parting_error = std::abs(parting / exact_parting - 1);
}

CurvePoint slide(const Variant& variant, double step) {
  GrainSimulation run = start(stacked(variant.pair()), variant.law, step);
  const auto last = static_cast<std::int64_t>(std::ceil(duration / step));
  // an Euler step lists the contacts at its start, a step of X those at its end
  const std::int64_t late = variant.of_paper() ? 0 : 1;
  double parting = 0;
  while (run.step() < last) {
    run.advance(1);
    for (const GrainContact& contact : run.contacts()) {
      if (contact.i == 1 && contact.j == 2) parting = static_cast<double>(run.step() + late) * step;
    }
  }
  CurvePoint point{.step = step};
  set_errors(point, run.grains()[1].velocity.x, parting);
  point.sweeps = static_cast<double>(run.counters().sweeps) / static_cast<double>(last);
  return point;
}

double seconds_of(const Variant& variant, double step) {
  const auto steps = static_cast<std::int64_t>(std::ceil(exact_parting / step));
  double least = 1e300, all = 0;
  for (int round = 0; round < 3 || (all < 0.05 && round < 100); ++round) {
    GrainSimulation run = start(stacked(variant.pair()), variant.law, step);
    Stopwatch watch;
    run.advance(steps);
    least = std::min(least, watch.seconds());
    all += watch.seconds();
  }
  return least;
}

/// C in a separate loop of B and C, by symmetry: the closing speed is the change of overlap since the step before, not
/// the old velocity along the new normal.
CurvePoint slide_with_closing_from_overlap(double step) {
  constexpr double r = stacked_radius;
  const Variant law = variants(stiff)[0];
  const double dashpot = laws::LinearDashpot::dissipation(restitution, ContactEnd::at_zero_overlap) * std::sqrt(law.a);
  Vec2 b{r, r}, vb{};
  double c = (1 + std::sqrt(3.0)) * r, vc = 0;
  double pair_before = 0, floor_before = 0, parting = 0;
  const auto last = static_cast<std::int64_t>(std::ceil(duration / step));
  for (std::int64_t n = 1; n <= last; ++n) {
    const Vec2 branch = b - Vec2{0, c};
    const double pair = 2 * r - norm(branch), floor = r - b.y;
    const Vec2 normal = branch / norm(branch);
    Vec2 change{};
    double on_c = 0;
    if (pair > 0) {
      // change of the closing speed shared by two equal masses; A acts on C as the mirror image of B
      const double push =
          -0.5 * force_step<laws::LinearDashpot>(pair, pair - pair_before, law.a, dashpot, true).change / step;
      change += push * normal;
      on_c = -2 * push * normal.y;
      parting = static_cast<double>(n) * step;
    }
    if (floor > 0)
      change.y -= force_step<laws::LinearDashpot>(floor, floor - floor_before, law.a, dashpot, true).change / step;
    pair_before = pair;
    floor_before = floor;
    vb += change + Vec2{0, -gravity * step};
    vc += on_c - gravity * step;
    b += step * vb;
    c += step * vc;
  }
  CurvePoint point{.step = step};
  set_errors(point, vb.x, parting);
  return point;
}

/// Slope of log(error) over log(step), least squares over steps up to 1e-4 s.
double order(const std::vector<CurvePoint>& points, double CurvePoint::*error) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const CurvePoint& point : points) {
    if (point.step > 1.01e-4 || !(point.*error > 0)) continue;
    const double u = std::log(point.step), v = std::log(point.*error);
    n += 1;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

std::vector<Curve> slide_stacked(bool quick, Progress& progress) {
  const std::vector<double> steps = steps_of(quick);
  std::vector<Curve> all;
  const std::vector<Variant> laws = variants(stiff);
  for (const Variant& variant : laws) {
    Curve curve{.variant = variant, .label = variant.label, .points = {}};
    for (const double step : steps) {
      curve.points.push_back(slide(variant, step));
      curve.points.back().seconds = seconds_of(variant, step);
      stop_if_interrupted();
    }
    all.push_back(std::move(curve));
    progress.update(0.2 + 0.3 * static_cast<double>(all.size()) / static_cast<double>(laws.size()));
  }
  Curve corrected{.variant = laws[0], .label = "C, no lag", .points = {}};
  for (const double step : steps) corrected.points.push_back(slide_with_closing_from_overlap(step));
  all.push_back(std::move(corrected));
  for (Curve& curve : all) {
    curve.speed_order = order(curve.points, &CurvePoint::speed_error);
    curve.parting_order = order(curve.points, &CurvePoint::parting_error);
  }
  return all;
}

}  // namespace equidem::fujioka2005
