// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The law P with single equations as the paper prints them, beside the law that the program uses.
#include <algorithm>
#include <cmath>

#include "equidem/contact/laws/energy_map.hpp"

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

enum class Reading {
  mended,         ///< energy_map
  depth_printed,  ///< (20) with d_j in place of the corrected depth
  mode_2_printed  ///< (21) wherever 0 < s < 1, also where it gives d' <= 0
};

/// Change of the closing speed by (17) and (20), and of the depth by (15).
ContactStep first_step(double d, double closing, double a) {
  const double s = closing / d, corrected = s * restitution / std::sqrt(s * s + a) * closing;
  const double f = -d / (1 + a) * ((1 + a) * s + a - std::sqrt((1 + a) * s * s + a * a));
  ContactStep step;
  step.change = corrected - closing + f;
  step.shift = corrected / s - d;
  return step;
}

/// Energy after over energy before an impact on a wall without gravity.
/// \param phase depth at the contact step over the closing in a step
double ratio_of_impact(Reading reading, double a, double phase) {
  constexpr int most_steps = 1000;
  double depth = phase, closing = 1;
  for (int step = 0; step < most_steps && depth > 0; ++step) {
    const bool first = step == 0;
    const double s = closing / depth;
    ContactStep change = laws::EnergyMap::step(depth, closing, a, restitution, first);
    if (first && reading == Reading::depth_printed) change = first_step(depth, closing, a);
    if (!first && reading == Reading::mode_2_printed && s > 0)
      change.change = -depth / (1 + a) * ((1 + a) * s + a + std::sqrt((1 + a) * s * s + a * a));
    closing += change.change;
    depth += change.shift + closing;
  }
  return closing * closing;
}

PrintedRow row_of(const char* name, Reading reading, double a) {
  PrintedRow row{.name = name, .a = a, .mean = 0, .least = 1, .largest = 0};
  constexpr int phases = 4000;
  for (int k = 0; k < phases; ++k) {
    const double ratio = ratio_of_impact(reading, a, (k + 0.5) / phases);
    row.mean += ratio / phases;
    row.least = std::min(row.least, ratio);
    row.largest = std::max(row.largest, ratio);
  }
  return row;
}

}  // namespace

std::vector<PrintedRow> compare_printed() {
  std::vector<PrintedRow> rows;
  for (const double a : {stiffness_of(NormalLaw::energy_map), 0.9}) {
    rows.push_back(row_of("as used", Reading::mended, a));
    rows.push_back(row_of("(20) with d_j", Reading::depth_printed, a));
    rows.push_back(row_of("(21) in all of mode 2", Reading::mode_2_printed, a));
  }
  return rows;
}

}  // namespace equidem::fujioka2005
