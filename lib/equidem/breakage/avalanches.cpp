// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/avalanches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace equidem {
namespace {

constexpr double same = 1e-10;  // relative, of values that are equal but for round-off

bool beyond(double value, double most) {
  return value > most + same * std::abs(most) || std::isinf(most);
}

}  // namespace

Avalanches avalanches_by(const EventPath& run, double BreakEvent::*quantity) {
  Avalanches result;
  double most = -std::numeric_limits<double>::infinity();
  std::int64_t leg = -1, size = 0;
  for (const BreakEvent& event : run.events()) {
    if (event.leg != leg) most = -std::numeric_limits<double>::infinity();
    leg = event.leg;
    const double value = run.direction(leg) * event.*quantity;
    if (beyond(value, most)) {
      most = value;
      result.first.push_back(std::ssize(result.number));
      size = 0;
    }
    result.number.push_back(result.count() - 1);
    result.largest = std::max(result.largest, ++size);
  }
  return result;
}

LoadCurve curve_of(const EventPath& run) {
  LoadCurve curve;
  const std::vector<LegPoint> points = run.leg_points();
  std::size_t next = 0;
  for (std::int64_t k = 0; k <= std::ssize(run.events()); ++k) {
    for (; next < points.size() && points[next].events_before == k; ++next) {
      curve.motion.push_back(points[next].motion);
      curve.load.push_back(points[next].load);
    }
    if (k == std::ssize(run.events())) break;
    curve.motion.push_back(run.events()[static_cast<std::size_t>(k)].motion);
    curve.load.push_back(run.events()[static_cast<std::size_t>(k)].load);
  }
  return curve;
}

namespace {

using Quantity = double BreakEvent::*;

/// The load of the network in which this point was reached, at another motion.
template <typename Point>
double load_back_from(const Point& point, double motion) {
  const double slope = point.motion_rate > 0 ? point.load_rate / point.motion_rate : 0;
  return point.load + slope * (motion - point.motion);
}

/// The first events of avalanches and the ends of legs that lie beyond them, with the start.
/// \param behind whether the load falls, at each event, to what is left when its avalanche is over
LoadCurve envelope(const EventPath& run, Quantity quantity, double LegPoint::*at_end, bool behind) {
  LoadCurve curve;
  const std::vector<LegPoint> points = run.leg_points();
  const std::vector<BreakEvent>& events = run.events();
  const std::vector<std::int64_t> first = avalanches_by(run, quantity).first;
  const auto event = [&](std::size_t a) -> const BreakEvent& { return events[static_cast<std::size_t>(first[a])]; };
  const auto add = [&](double motion, double load) {
    curve.motion.push_back(motion);
    curve.load.push_back(load);
  };
  if (!points.empty()) add(points.front().motion, points.front().load);
  std::size_t a = 0;
  for (std::int64_t leg = 0;; ++leg) {
    const bool ended = leg + 1 < std::ssize(points);
    const LegPoint end = ended ? points[static_cast<std::size_t>(leg) + 1] : LegPoint{};
    double most = -std::numeric_limits<double>::infinity();
    for (; a < first.size() && event(a).leg == leg; ++a) {
      const double motion = event(a).motion;
      most = run.direction(leg) * (event(a).*quantity);
      add(motion, event(a).load);
      // The network behind the avalanche is that in which the next one begins, or the leg ends.
      const bool another = a + 1 < first.size() && event(a + 1).leg == leg;
      if (!behind) continue;
      add(motion, another ? load_back_from(event(a + 1), motion)
                  : ended ? load_back_from(end, motion)
                          : run.load_left(motion));
    }
    if (!ended) return curve;
    if (beyond(run.direction(leg) * (end.*at_end), most)) add(end.motion, end.load);
  }
}

}  // namespace

LoadCurve load_envelope(const EventPath& run) {
  return envelope(run, &BreakEvent::load, &LegPoint::load, false);
}

LoadCurve motion_envelope(const EventPath& run) {
  return envelope(run, &BreakEvent::motion, &LegPoint::motion, true);
}

}  // namespace equidem
