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

TEST_CASE("a_lattice_loses_its_stability_at_its_critical_ratio") {
  const double critical = lattices::hexagonal.critical_ratio;
  const double share = GENERATE(-1.0, 0.9, 1.1), ratio = share * critical;
  const Stability found = analyze_stability(periodic_hexagonal(2, 2), ContactSprings(SpringConstants{1, ratio}), {});
  CAPTURE(ratio, critical, found.critical.ratio, found.critical.searched, found.growth_rate());
  CHECK(found.status() == (share > 1 ? "unstable" : "stable"));
  CHECK(found.critical.ratio == Approx(critical).epsilon(1e-6));
  CHECK((found.growth_rate() > 0) == (ratio < 0));
  CHECK(found.cell_discs == 1);
}

TEST_CASE("frequencies_fall_with_the_root_of_the_density") {
  const Assembly cell = random_cell(30, 1);
  const ContactSprings springs(SpringConstants{1, 0.3});
  const Stability light = analyze_stability(cell, springs, {}),
                  heavy = analyze_stability(cell, springs, {}, {.density = 4});
  CHECK(heavy.highest.value == Approx(light.highest.value / 4).epsilon(1e-12));
  CHECK(heavy.rules.diagonal == Approx(2 * light.rules.diagonal).epsilon(1e-12));
  CHECK(heavy.critical.ratio == Approx(light.critical.ratio).epsilon(1e-9));
}
