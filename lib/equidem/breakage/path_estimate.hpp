// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Work of a path of brittle breakage, before its events are known.
///
/// Measured on lattices of 2e3 to 1e4 discs. Samples under tension broke 1 to 10 % of their contacts, those under
/// compression up to half. Where contacts rub, a block of 449 discs with a crack had 1.5 further events for each break,
/// and events took as long as 0.3 to 0.5 solutions, in blocks of 449 and 1778 discs.
#pragma once

#include <cmath>
#include <cstdint>

namespace equidem {

/// Events where a tenth of the contacts breaks.
inline std::int64_t estimated_events(std::int64_t contacts) {
  constexpr double broken_share = 0.1;
  return std::llround(broken_share * static_cast<double>(contacts));
}

/// Events of contacts that rub: breaks, and contacts that open, close, slip and stick. Fourteen paths of 68 to 1817
/// discs, pressed or pulled, by motions or loads, hexagonal or random, with a crack or without, with bonds or without,
/// along one to three legs, had 0.007 (pulled, random) to 3.4 times (without bonds) as many, twelve of them 0.1 to 2.4
/// times.
inline std::int64_t estimated_rubbing_events(std::int64_t contacts) {
  constexpr double for_each_contact = 0.5;
  return std::llround(for_each_contact * static_cast<double>(contacts));
}

/// Time of the first state and of all events, in solutions with their error bound. An event of contacts that rub
/// took 0.5 to 5 solutions on those paths, the more the fewer discs and events there are, half of them 0.7 at most, and
/// 0.03 where no contact carries a force.
inline double solutions_of_path(std::int64_t events, bool rubs = false) {
  const double event = rubs ? 1.5 : 0.13;
  return 1 + event * static_cast<double>(events);
}

}  // namespace equidem
