// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "breakage/dense_unbonded.hpp"
#include "breakage/random_packings.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("random_packings_open_close_slip_and_break_as_complementarity_by_dense_matrices_says") {
  std::map<std::string, int> seen;
  std::int64_t compared = 0, ambiguous = 0, unknown = 0, not_found = 0, loose = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const DrawnPacking d = draw_packing(seed);
    CAPTURE(d.name);
    Unbonded ours(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    constexpr std::size_t most = 150;
    while (ours.events().size() < most && ours.run().advance()) {
    }
    CAPTURE(ours.run().why(), ours.events().size());
    CHECK(ours.run().counters().largest_residual < 1e-12);
    CHECK(ours.run().energy_error() < 1e-10);
    const DegreesOfFreedom unknowns = number_unknowns(ours.assembly(), ours.springs(), ours.effects(), d.path.supports);
    DenseUnbonded dense(ours.assembly(), ours.springs(), ours.strengths(), ours.path(), unknowns, d.unbonded.friction,
                        d.unbonded.rest);
    const bool found = dense.go(most);
    not_found += found ? 0 : 1;
    const std::size_t both = std::min({dense.events.size(), ours.events().size(), dense.determined});
    loose += dense.determined < dense.events.size() ? 1 : 0;
    for (std::size_t k = 0; k < both; ++k) {
      const BreakEvent& event = ours.event(k);
      // Where nothing is found to balance the loads, bonds break one after another as everything falls.
      if (!found && event.lambda >= ours.events().back().lambda * (1 - 1e-9)) break;
      if (event.other_answers > 0) ++ambiguous;
      if (event.other_answers < 0) ++unknown;
      // Pivots may find another one of several answers.
      if (event.other_answers != 0 && (event.contact != dense.events[k].contact || event.mode != dense.events[k].mode))
        break;
      CAPTURE(k, dense.events[k].lambda, event.lambda, event.ties, to_string(event.mode),
              to_string(dense.events[k].mode), event.contact, dense.events[k].contact, found);
      CHECK(event.lambda == Approx(dense.events[k].lambda).epsilon(1e-8).margin(1e-9));
      CHECK(event.contact == dense.events[k].contact);
      CHECK(event.mode == dense.events[k].mode);
      if (event.contact != dense.events[k].contact || event.mode != dense.events[k].mode) break;
      ++seen[to_string(event.mode)];
      ++compared;
    }
  }
  CAPTURE(compared, ambiguous, unknown, not_found, loose, seen);
  CHECK(compared > 900);
  for (const char* mode : {"tension", "shear", "open", "close", "slip", "stick"}) CHECK(seen[mode] > 20);
}

TEST_CASE("contacts_that_change_without_end_at_one_state_end_the_path_with_a_sentence") {
  // Cells in which every contact slips: whatever the rates choose, another contact reaches its limit at once.
  for (const std::uint64_t seed : {801, 3817, 4505}) {
    const DrawnPacking d = draw_packing(seed);
    CAPTURE(d.name);
    Unbonded ours(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    std::int64_t steps = 0;
    while (steps < 3000 && ours.run().advance()) ++steps;
    CAPTURE(steps, ours.run().why(), ours.run().lambda(), ours.run().state().relative_residual());
    CHECK(steps < 3000);
    const bool sentence = ours.run().end() == PathEnd::no_answer || ours.run().end() == PathEnd::not_balanced;
    CHECK(sentence);
    CHECK_FALSE(ours.run().why().empty());
    for (const BreakEvent& event : ours.events()) CHECK(event.relative_residual < 1e-9);
  }
}
