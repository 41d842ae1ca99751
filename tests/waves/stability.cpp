// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stability of assemblies without a case file.
#include "equidem/waves/stability.hpp"

#include <cmath>

#include "equidem/assembly/lattices.hpp"

#include "support/catch.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("frequencies_fall_with_the_root_of_the_density") {
  const Assembly cell = random_cell(30, 1);
  const ContactSprings springs(SpringConstants{1, 0.3});
  const Stability light = analyze_stability(cell, springs, {}),
                  heavy = analyze_stability(cell, springs, {}, {.density = 4});
  CHECK(heavy.highest.value == Approx(light.highest.value / 4).epsilon(1e-12));
  CHECK(heavy.rules.diagonal == Approx(2 * light.rules.diagonal).epsilon(1e-12));
  CHECK(heavy.critical.ratio == Approx(light.critical.ratio).epsilon(1e-9));
}
