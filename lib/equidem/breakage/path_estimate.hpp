// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Work of a path of brittle breakage, before its events are known.
///
/// Measured on lattices of 2e3 to 1e4 discs. Samples under tension broke 1 to 10 % of their contacts, those under
/// compression up to half.
#pragma once

#include <cmath>
#include <cstdint>

namespace equidem {

/// Events where a tenth of the contacts breaks.
inline std::int64_t estimated_events(std::int64_t contacts) {
  constexpr double broken_share = 0.1;
  return std::llround(broken_share * static_cast<double>(contacts));
}

/// Time of the first state and of all events, in solutions with their error bound.
inline double solutions_of_path(std::int64_t events) {
  constexpr double event = 0.13;
  return 1 + event * static_cast<double>(events);
}

}  // namespace equidem
