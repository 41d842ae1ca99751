// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Zero-energy modes are counted as by theory.
#include "equidem/statics/mechanisms.hpp"

#include <cmath>

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

MechanismReport mechanisms_of(const Assembly& assembly, SpringConstants springs, std::span<const Support> supports = {},
                              Rotation rotation = Rotation::from_scene) {
  return find_mechanisms(assembly, ContactSprings(springs), rotation, supports);
}

}  // namespace

TEST_CASE("a_square_cell_turns_like_gears_where_both_sides_are_even") {
  const auto [columns, rows] = GENERATE(std::pair{2, 2}, std::pair{4, 6}, std::pair{3, 4}, std::pair{3, 3});
  const MechanismReport report = mechanisms_of(periodic_square(columns, rows), {1, 0.5});
  CAPTURE(columns, rows, report.sentences);
  CHECK(report.gears == (columns % 2 == 0 && rows % 2 == 0 ? 1 : 0));
  CHECK(report.count() == report.gears);
  CHECK(report.rigid_motions == 2);
}

// Without tangential springs every row and every column of a square cell slides on the next.
TEST_CASE("rows_and_columns_of_a_square_cell_slide_without_tangential_springs") {
  const auto [columns, rows] = GENERATE(std::pair{3, 3}, std::pair{4, 6});
  const MechanismReport report = mechanisms_of(periodic_square(columns, rows), {1, 0});
  CAPTURE(columns, rows, report.sentences);
  CHECK(report.others == columns + rows - 2);
  CHECK(report.sentences.size() == 1);
}

TEST_CASE("chains_that_span_one_direction_slide_past_their_images") {
  const auto [columns, rows] = GENERATE(std::pair{1, 1}, std::pair{3, 1}, std::pair{4, 3});
  const bool across = GENERATE(false, true);
  Assembly chains = periodic_square(columns, rows);
  std::erase_if(chains.contacts, [across = across](const Contact& c) { return (across ? c.shift_x : c.shift_y) != 0; });
  chains.facet_lengths.clear();
  const MechanismReport report = mechanisms_of(chains, {1, 0.5});
  CAPTURE(columns, rows, across, report.sentences);
  CHECK(report.unjoined == 1);
  CHECK(report.count() > 0);
  CHECK(mechanisms_of(periodic_square(columns, rows), {1, 0.5}).unjoined == 0);
}

TEST_CASE("a_triangulated_body_has_no_mechanism_but_three_rigid_motions") {
  const Assembly block = hexagonal_lattice({.columns = 5, .rows = 5});
  for (const double kT : {0.0, 0.5, -0.2}) {
    const MechanismReport free = mechanisms_of(block, {1, kT});
    CAPTURE(kT, free.sentences);
    CHECK(free.count() == 0);
    CHECK(free.rigid_motions == 3);
    const std::vector<Support> pin{{"bottom_left", 0.0, 0.0, {}}};
    const MechanismReport pinned = mechanisms_of(block, {1, kT}, pin);
    CHECK(pinned.count() == 1);  // it swings about the pin
    CHECK(pinned.rigid_motions == 0);
  }
}

TEST_CASE("inertia_counts_one_negative_pivot_for_each_rotation_of_a_stable_cell") {
  const Assembly cell = periodic_hexagonal(4, 6);
  const auto at = [&](double ratio) {
    return find_inertia(cell, ContactSprings(SpringConstants{1, ratio}), Rotation::free, {});
  };
  CHECK(at(0.5).negative_pivots == 0);
  CHECK(at(-0.3).negative_pivots == 24);
  CHECK(at(-0.3).unstable_modes == 0);
  CHECK(at(-0.34).unstable_modes > 0);
}
