// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The critical ratio by inertia and inverse iteration agrees with the waves, and with values computed independently.
#include "equidem/statics/critical_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/homogenize/tension_test.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const ContactSprings unit_springs(SpringConstants{1, 1});

}  // namespace

// The wave M is one of the motions that repeat with a cell of even size.
TEST_CASE("a_periodic_hexagonal_cell_gives_way_at_minus_one_third") {
  const auto [columns, rows] = GENERATE(std::pair{2, 2}, std::pair{6, 4}, std::pair{5, 8});
  const CriticalRatio found = find_critical_ratio(periodic_hexagonal(columns, rows), unit_springs, {});
  CAPTURE(columns, rows, found.ratio, found.factorizations);
  CHECK(std::abs(found.ratio + 1.0 / 3) < 1e-10);
  CHECK(found.mechanisms == 0);
}

TEST_CASE("the_square_cell_gives_way_at_zero") {
  for (const int n : {2, 3, 6}) {
    CAPTURE(n);
    const CriticalRatio found = find_critical_ratio(periodic_square(n, n), unit_springs, {});
    CHECK(std::abs(found.ratio) <= 1e-10);
  }
}

TEST_CASE("inertia_and_waves_agree_on_random_cells") {
  const Assembly cell = random_cell(GENERATE(6, 30), GENERATE(1, 2, 3));
  const bool rotation = GENERATE(true, false);
  const BlochWaves waves(given_cell(cell, unit_springs), unit_masses(cell), rotation);
  const Vec2 period = *cell.period;
  for (const auto& [x, y] :
       {std::pair{false, false}, std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
    const Vec2 q{x ? std::numbers::pi / period.x : 0, y ? std::numbers::pi / period.y : 0};
    const CriticalRatio found =
        find_critical_ratio(cell, unit_springs, {}, {.rotation = rotation, .antiperiodic_x = x, .antiperiodic_y = y});
    const double expected = waves.critical_ratio(q);
    CAPTURE(cell.size(), rotation, x, y, found.ratio, expected, found.factorizations);
    if (expected < -1) {
      CHECK(found.ratio == -std::numeric_limits<double>::infinity());
    } else {
      CHECK(std::abs(found.ratio - expected) < 2e-10);
    }
  }
}

TEST_CASE("springs_of_their_own_change_the_critical_ratio_as_they_change_the_waves") {
  const Assembly cell = random_cell(12, 4);
  std::vector<SpringConstants> each(cell.contacts.size());
  Random random(3);
  for (SpringConstants& k : each) k = {random.uniform(1, 5), random.below(4) == 0 ? 0.0 : 1.0};
  const ContactSprings springs(each);
  const BlochWaves waves(given_cell(cell, springs), unit_masses(cell), true);
  const CriticalRatio found = find_critical_ratio(cell, springs, {});
  CAPTURE(found.ratio, waves.critical_ratio({}));
  CHECK(std::abs(found.ratio - waves.critical_ratio({})) < 2e-10);
}

// Free edges lose stability before the lattice: values of the generalized eigenvalue problem, computed independently.
TEST_CASE("the_tension_test_loses_its_edges_first") {
  struct Known {
    int size;
    double ratio;
  };
  double before = -1;
  for (const Known& known : {Known{5, -0.3360}, Known{7, -0.2995}, Known{11, -0.2754}, Known{19, -0.2658}}) {
    const Assembly block = hexagonal_lattice({.columns = known.size, .rows = known.size});
    const TensionSetup setup = tension_setup(block, {});
    const CriticalRatio found = find_critical_ratio(block, unit_springs, setup.supports);
    CAPTURE(known.size, found.ratio, found.factorizations);
    CHECK(found.ratio == Approx(known.ratio).margin(5e-5));
    CHECK(found.factorizations < 20);
    CHECK(found.ratio > before);
    before = found.ratio;
    const CriticalRatio coarse = find_critical_ratio(block, unit_springs, setup.supports, {.tolerance = 1e-4});
    CHECK(std::abs(coarse.ratio - found.ratio) < 1e-4);
  }
}

TEST_CASE("a_free_body_gives_way_as_one_on_three_supports") {
  const Assembly block = hexagonal_lattice({.columns = 6, .rows = 6});
  const std::vector<Support> three{{"bottom_left", 0.0, 0.0, {}}, {"bottom_right", {}, 0.0, {}}};
  const ContactSprings equal(SpringConstants{1, 1});
  const double free = find_critical_ratio(block, equal, {}).ratio;
  const double held = find_critical_ratio(block, equal, three).ratio;
  CHECK(std::abs(free - held) < 2e-10);
}

// It hangs from one contact: three unknowns, and two springs that resist them for any ratio.
TEST_CASE("a_disc_on_one_contact_swings_freely_and_leaves_the_critical_ratio_as_it_is") {
  Assembly block = hexagonal_lattice({.columns = 5, .rows = 5});
  const std::vector<Support> three{{"bottom_left", 0.0, 0.0, {}}, {"bottom_right", {}, 0.0, {}}};
  const CriticalRatio alone = find_critical_ratio(block, unit_springs, three);
  const std::int32_t last = static_cast<std::int32_t>(block.size()) - 1;
  block.centres.push_back(block.centres[last] + Vec2{0, 2 * block.radii[last]});
  block.radii.push_back(block.radii[last]);
  block.cell_areas.clear();
  block.facet_lengths.clear();
  block.contacts.push_back({last, last + 1, 0, 0, block.radii[last], block.radii[last]});
  const CriticalRatio hung = find_critical_ratio(block, unit_springs, three);
  CAPTURE(alone.ratio, hung.ratio, hung.factorizations);
  CHECK(alone.mechanisms == 0);
  CHECK(hung.mechanisms == 1);
  CHECK(std::abs(hung.ratio - alone.ratio) < 2e-10);
  CHECK(hung.motion.empty());
}
