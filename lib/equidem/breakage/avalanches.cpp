// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/avalanches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace equidem {

Avalanches avalanches_by(const EventPath& run, double BreakEvent::*quantity) {
  constexpr double same = 1e-10;  // relative, of values that are equal but for round-off
  Avalanches result;
  double most = -std::numeric_limits<double>::infinity();
  std::int64_t leg = -1, size = 0;
  for (const BreakEvent& event : run.events()) {
    if (event.leg != leg) most = -std::numeric_limits<double>::infinity();
    leg = event.leg;
    const double value = run.direction(leg) * event.*quantity;
    if (value > most + same * std::abs(most) || std::isinf(most)) {
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

LoadCurve load_envelope(const EventPath& run) {
  const LegPoint start = run.leg_points().front();
  LoadCurve curve{{start.motion}, {start.load}};
  for (const std::int64_t k : avalanches_by(run, &BreakEvent::load).first) {
    curve.motion.push_back(run.events()[static_cast<std::size_t>(k)].motion);
    curve.load.push_back(run.events()[static_cast<std::size_t>(k)].load);
  }
  return curve;
}

LoadCurve motion_envelope(const EventPath& run) {
  const LegPoint start = run.leg_points().front();
  LoadCurve curve{{start.motion}, {start.load}};
  const std::vector<BreakEvent>& events = run.events();
  const Avalanches avalanches = avalanches_by(run, &BreakEvent::motion);
  for (std::size_t a = 0; a < avalanches.first.size(); ++a) {
    const BreakEvent& event = events[static_cast<std::size_t>(avalanches.first[a])];
    curve.motion.insert(curve.motion.end(), 2, event.motion);
    curve.load.push_back(event.load);
    // The network behind the avalanche is that in which the next one begins; at its end, what the last event leaves.
    if (a + 1 < avalanches.first.size()) {
      const BreakEvent& next = events[static_cast<std::size_t>(avalanches.first[a + 1])];
      const double slope = next.motion_rate > 0 ? next.load_rate / next.motion_rate : 0;
      curve.load.push_back(next.load + slope * (event.motion - next.motion));
    } else {
      curve.load.push_back(run.load_left(event.motion));
    }
  }
  return curve;
}

}  // namespace equidem
