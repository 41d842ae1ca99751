// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "breakage/dense_unbonded.hpp"
#include "breakage/random_packings.hpp"
#include "breakage/same_forces.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Packings where statuses have other names than those by dense matrices, or where several things happen at one lambda:
/// contacts that touch without a force, statuses passed through without a motion, ties, loose discs.
constexpr std::uint64_t other_names[] = {188,  469,  579,  620,  651,  1026, 1172, 1419, 1567, 1591, 1746, 1909,
                                         1955, 2222, 2251, 2270, 2346, 2371, 2379, 2551, 2599, 2825, 3171, 3331,
                                         3339, 3367, 3395, 3427, 4026, 4051, 4101, 4266, 4851, 4971, 4986, 4987,
                                         5130, 5148, 5154, 5166, 5211, 5284, 5431, 5466, 5571, 5754, 5791, 5835};

}  // namespace

TEST_CASE("random_packings_open_close_slip_and_break_as_complementarity_by_dense_matrices_says") {
  std::map<std::string, int> seen;
  std::map<ComparedUntil, int> until;
  std::size_t states = 0;
  double largest = 0;
  std::vector<std::uint64_t> seeds(160);
  std::iota(seeds.begin(), seeds.end(), 1);
  seeds.insert(seeds.end(), std::begin(other_names), std::end(other_names));
  for (const std::uint64_t seed : seeds) {
    const DrawnPacking d = draw_packing(seed);
    Unbonded ours(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    const DegreesOfFreedom unknowns = number_unknowns(ours.assembly(), ours.springs(), ours.effects(), d.path.supports);
    DenseUnbonded dense(ours.assembly(), ours.springs(), ours.strengths(), ours.path(), unknowns, d.unbonded.friction,
                        d.unbonded.rest);
    const ComparedPaths compared = compare_forces(ours, dense, 150);
    CAPTURE(d.name, ours.run().why(), compared.way, compared.difference, compared.states, compared.events);
    CHECK(compared.until != ComparedUntil::differs);
    CHECK(ours.run().counters().largest_residual < 1e-12);
    CHECK(ours.run().energy_error() < 1e-10);
    for (std::size_t k = 0; k < compared.events; ++k) ++seen[to_string(ours.event(k).mode)];
    ++until[compared.until];
    states += compared.states;
    largest = std::max(largest, compared.largest);
  }
  using enum ComparedUntil;
  CAPTURE(states, largest, seen, until[end], until[loose], until[several], until[no_dense], until[falling]);
  CHECK(until[end] > std::ssize(seeds) / 2);
  for (const char* mode : {"tension", "shear", "open", "close", "slip", "stick"}) CHECK(seen[mode] > 50);
}

// Behind the break of this bond a contact on the limit of its friction may stick or slip, as all combinations of the
// statuses by dense matrices show, with other forces either way.
TEST_CASE("an_increment_behind_a_break_that_has_two_answers_is_told_with_the_break") {
  const DrawnPacking d = draw_packing(5148);
  Unbonded path(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
  path.all();
  const auto broken = std::ranges::find_if(
      path.events(), [](const BreakEvent& event) { return event.contact == 7 && event.mode == BreakMode::tension; });
  REQUIRE(broken != path.events().end());
  CHECK(broken->other_answers == 1);
  CHECK(broken->motion_difference > 0);
  for (auto event = path.events().begin(); event != broken; ++event) CHECK(event->other_answers == 0);
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
