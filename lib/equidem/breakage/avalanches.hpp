// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Avalanches and envelopes of a sequence of events: what a test sees that keeps the load, or the motion, from falling.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "equidem/breakage/event_path.hpp"

namespace equidem {

/// Everything up to the next rise of a quantity beyond all earlier values of its leg is one avalanche.
struct Avalanches {
  std::vector<std::int64_t> number;  ///< per event, from 0
  std::vector<std::int64_t> first;   ///< the event that begins each: the envelope
  std::int64_t largest = 0;          ///< events of the largest one

  [[nodiscard]] std::int64_t count() const { return static_cast<std::int64_t>(first.size()); }
};

/// \param quantity &BreakEvent::load or &BreakEvent::motion
Avalanches avalanches_by(const EventPath& run, double BreakEvent::*quantity);

/// Points of a curve of load against motion.
struct LoadCurve {
  std::vector<double> motion, load;
};
/// All events, the start and the ends of legs, in the order of the path.
LoadCurve curve_of(const EventPath& run);
/// The start, the first events of avalanches, and the ends of legs that lie beyond all events of their leg.
LoadCurve load_envelope(const EventPath& run);
/// Likewise; the load falls at each to what is left when its avalanche is over.
LoadCurve motion_envelope(const EventPath& run);

}  // namespace equidem
