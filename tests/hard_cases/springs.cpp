// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Springs of very different size, and tangential springs near the ratio at which an assembly gives way.
#include <cmath>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/critical_ratio.hpp"

#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double kN = 1e9;

Assembly hexagonal_cell() {
  return hexagonal_lattice({.columns = 4, .rows = 4, .periodic = true});
}
Assembly random_cell(std::uint64_t seed) {
  return delaunay_assembly({.discs = 60, .seed = seed, .periodic = true});
}

/// The left side held, the discs of the right side pulled.
Problem pulled_at_right(Assembly block, ContactSprings k) {
  return {std::move(block),
          std::move(k),
          {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}},
          {{.group = "right", .kind = LoadKind::per_disc, .force = {1000, 300}}}};
}

/// How many contacts join the halves; the first are as stiff as all others.
struct Joints {
  std::size_t strong = 0, weak = 100;
};

/// The contacts across `middle` made `weak` times as stiff.
std::pair<Assembly, ContactSprings> joined(Assembly assembly, double middle, double weak, double ratio, Joints joints) {
  std::vector<SpringConstants> k;
  std::size_t met = 0;
  std::erase_if(assembly.contacts, [&](const Contact& c) {
    const bool joint = c.shift_x == 0 && (assembly.centres[c.i].x < middle) != (assembly.centres[c.j].x < middle);
    if (joint && ++met > joints.strong + joints.weak) return true;
    const double stiffness = joint && met > joints.strong ? weak * kN : kN;
    k.push_back({stiffness, ratio * stiffness});
    return false;
  });
  assembly.facet_lengths.clear();
  return {std::move(assembly), ContactSprings(std::move(k))};
}

}  // namespace

TEST_CASE("tangential_springs_of_any_size_are_right") {
  HardCase table(
      {.name = "kT/kN from 1e-8 to 1e8",
       .why = "the condition of K grows with the ratio either way; discs roll freely, or are locked to each other"});
  for (int exponent = -8; exponent <= 8; ++exponent) {
    const double ratio = std::pow(10.0, exponent);
    CAPTURE(exponent);
    table.right("solve", solve(pulled_at_right(hexagonal_lattice({.columns = 5, .rows = 6}), springs_of(ratio))), 1e-8);
    table.right("solve", solve(pulled_at_right(delaunay_assembly({.discs = 60}), springs_of(ratio))), 1e-8);
    table.right("homogenize", homogenize(hexagonal_cell(), springs_of(ratio)), 1e-13);
    table.right("homogenize", homogenize(random_cell(1), springs_of(ratio)), 1e-13);
  }
}

TEST_CASE("small_negative_tangential_springs_are_right") {
  HardCase table({.name = "kT/kN from -1e-2 to -1e-10",
                  .why = "K is indefinite by a hair: every rotation brings a small negative eigenvalue"});
  for (const double ratio : {-1e-2, -1e-4, -1e-6, -1e-8, -1e-10}) {
    CAPTURE(ratio);
    table.right("solve", solve(pulled_at_right(hexagonal_lattice({.columns = 5, .rows = 6}), springs_of(ratio))), 1e-7);
    table.right("homogenize", homogenize(random_cell(1), springs_of(ratio)), 1e-13);
  }
}

TEST_CASE("a_millionth_from_the_limit_of_stability_the_answer_is_right_and_beyond_it_called_unstable") {
  HardCase table(
      {.name = "hexagonal cell near kT/kN = -1/3",
       .why = "at -1/3 three waves lose all stiffness; K is singular there and has more negative eigenvalues beyond"});
  const Assembly cell = hexagonal_cell();
  const Answer above = homogenize(cell, springs_of(-1.0 / 3 + 1e-6));
  CHECK(above.unstable_modes == 0);
  table.right("homogenize at -1/3 + 1e-6", above, 1e-13);
  const Answer below = homogenize(cell, springs_of(-1.0 / 3 - 1e-6));
  CHECK(below.unstable_modes == 3);
  table.note("homogenize at -1/3 - 1e-6", "reported unstable",
             fmt::format("{} unstable modes", below.unstable_modes.value()));
  table.refused("homogenize at -1/3", homogenize(cell, springs_of(-1.0 / 3)), {"limit of stability", "another kT/kN"});
}

TEST_CASE("free_edges_near_their_own_limit_of_stability_are_right_above_it_and_called_unstable_below") {
  HardCase table({.name = "a free block near its critical kT/kN",
                  .why = "an edge gives way before the bulk does, and K without rotations has long lost definiteness"});
  const Assembly block = hexagonal_lattice({.columns = 11, .rows = 11});
  const Problem problem = pulled_at_right(block, springs_of(1));
  const double limit = find_critical_ratio(block, ContactSprings(SpringConstants{1, 1}), problem.supports).ratio;
  CAPTURE(limit);
  CHECK(limit > -0.3);
  for (const double off : {1e-2, 1e-4, 1e-6}) {
    CAPTURE(off);
    const Answer above = solve(pulled_at_right(block, springs_of(limit + off)));
    CHECK(above.unstable_modes == 0);
    table.right("solve down to 1e-6 above", above, 1e-7);
  }
  const Answer below = solve(pulled_at_right(block, springs_of(limit - 1e-6)));
  CHECK(below.unstable_modes == 1);
  table.note("solve 1e-6 below", "reported unstable",
             fmt::format("{} unstable mode at {:.8f}", below.unstable_modes.value(), limit - 1e-6));
}

TEST_CASE("two_halves_joined_by_nearly_nothing_are_right_to_the_digits_left_or_refused") {
  HardCase table({.name = "halves joined by contacts 1e-10 as stiff",
                  .why = "the halves move on a spring that is all but lost in the round-off of the others"});
  const Assembly block = hexagonal_lattice({.columns = 6, .rows = 4});
  for (const double ratio : {0.5, -0.05}) {
    for (const double weak : {1e-4, 1e-8, 1e-10}) {
      CAPTURE(ratio, weak);
      const auto [halves, k] = joined(block, 0.027, weak, ratio, {});
      table.right("solve", solve(pulled_at_right(halves, k)), 1e-6);
    }
  }
  const auto [hinged, with_one] = joined(block, 0.027, 1e-10, 0.5, {.weak = 1});
  table.refused("solve, joined by one contact", solve(pulled_at_right(hinged, with_one)), {"a motion of", "Hold"});
  const auto [hanging, with_two] = joined(block, 0.027, 1e-10, 0.5, {.strong = 1, .weak = 1});
  table.right("solve, joined by a stiff one and one 1e-10 as stiff", solve(pulled_at_right(hanging, with_two)), 1e-4);
  for (const double weak : {1e-16, 1e-18}) {
    CAPTURE(weak);
    const auto [halves, k] = joined(block, 0.027, weak, 0.5, {});
    table.refused("solve, 1e-16 as stiff", solve(pulled_at_right(halves, k)),
                  {"springs differ by a factor", "within a factor of 1e10"});
  }
  const Assembly cell = random_cell(1);
  for (const double weak : {1e-4, 1e-8, 1e-10}) {
    const auto [halves, k] = joined(cell, 0.5 * cell.period->x, weak, 0.5, {});
    table.right("homogenize", homogenize(halves, k), 1e-13);
  }
  const auto [halves, k] = joined(cell, 0.5 * cell.period->x, 1e-15, 0.5, {});
  table.refused("homogenize, 1e-15 as stiff", homogenize(halves, k),
                {"springs differ by a factor", "within a factor of 1e10"});
}
