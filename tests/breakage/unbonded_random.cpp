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

/// Packings with an increment that has several answers, as all combinations of the states of its contacts show: dense
/// matrices may take another one.
constexpr std::uint64_t several_answers[] = {83, 5148};

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
    const bool several = std::ranges::find(several_answers, seed) != std::end(several_answers);
    CHECK((several || compared.until != ComparedUntil::differs));
    CHECK(ours.run().solver().largest_residual < 1e-12);
    CHECK(ours.run().energy_error() < 1e-10);
    for (std::size_t k = 0; k < compared.events; ++k) ++seen[to_string(ours.event(k).mode)];
    ++until[compared.until];
    states += compared.states;
    largest = std::max(largest, compared.largest);
  }
  using enum ComparedUntil;
  CAPTURE(states, largest, seen, until[end], until[loose], until[differs], until[no_dense], until[falling]);
  CHECK(until[end] > std::ssize(seeds) / 2);
  for (const char* mode : {"tension", "shear", "open", "close", "slip", "stick"}) CHECK(seen[mode] > 50);
}

// Loose discs leave closed contacts pulled by round-off, and open ones overlapped; or they rattle between two gaps that
// close in turn, in ever shorter steps. Dense matrices decide on no state of these: some disc is loose from the start.
TEST_CASE("contacts_that_round_off_pulls_or_overlaps_open_and_close_and_the_path_goes_on") {
  std::size_t states = 0, events = 0;
  for (const std::uint64_t seed : {801, 3817, 4505, 24, 456, 1659, 2184, 3129, 3384, 3459}) {
    const DrawnPacking d = draw_packing(seed);
    Unbonded path(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    const UnbondedState& state = path.run().contact_state();
    while (path.run().advance()) {
      const double none = 10 * state.negligible_force();
      if (none > 4e-4 * state.largest_force()) continue;  // all forces are round-off
      ++states;
      for (std::size_t c = 0; c < state.status().size(); ++c) {
        const ContactStatus status = state.status()[c];
        if (status == ContactStatus::bonded) continue;
        const double n = state.normal_coordinate(c), t = state.law_force(c).tangential;
        CAPTURE(d.name, path.events().size(), c, n, t, none);
        // Round-off of forces moves loose discs far, and overlaps are no forces of open contacts.
        CHECK((status == ContactStatus::open ? n >= -1e-6 * state.largest_force() : n <= none));
        CHECK(std::abs(t) <= d.unbonded.friction * std::max(-n, 0.0) + none);
      }
    }
    const PathLedger& ledger = state.ledger();
    CAPTURE(d.name, path.run().why(), path.events().size(), ledger.missing(), ledger.largest, ledger.negligible);
    CHECK(path.run().end() == PathEnd::legs_done);
    CHECK(path.run().lambda() == Approx(2).epsilon(1e-15));
    CHECK(path.run().solver().largest_residual < 1e-12);
    CHECK(std::abs(ledger.missing()) <= 1e-12 * ledger.largest + 1e-5 * ledger.negligible);
    events += path.events().size();
  }
  CAPTURE(states, events);
  CHECK(states > events / 10);
}
