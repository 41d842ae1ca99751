// SPDX-License-Identifier: GPL-3.0-or-later
// The rule by which a path ends whose contacts change without end.
#include <algorithm>
#include <vector>

#include "equidem/breakage/unbonded/contact_events.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

using Statuses = std::vector<ContactStatus>;

/// Statuses of 16 contacts, other ones for every number.
Statuses numbered(int number) {
  Statuses statuses;
  for (int c = 0; c < 16; ++c) statuses.push_back((number >> c) % 2 == 0 ? ContactStatus::stuck : ContactStatus::open);
  return statuses;
}

/// Steps that a path makes until it is known to stand still, at most `most`.
/// \param t of step k \param statuses of step k
template <typename Way, typename StatusesOf>
int steps_until_still(Way t, StatusesOf statuses, int most) {
  Standstill standstill;
  for (int k = 0; k < most; ++k)
    if (!standstill.moved(t(k), 1) && standstill.again(statuses(k))) return k + 1;
  return most;
}

}  // namespace

TEST_CASE("statuses_that_come_again_without_any_motion_end_a_path") {
  const auto still = [](int) { return 0.0; };
  for (const int before : {0, 1, 5, 30}) {
    for (const int period : {1, 2, 3, 7, 20}) {
      const auto cycle = [&](int k) { return numbered(k < before ? 100 + k : k % period); };
      const int steps = steps_until_still(still, cycle, 1000);
      CAPTURE(before, period, steps);
      CHECK(steps > before + period - 1);
      CHECK(steps <= 3 * (before + period) + 1);  // Brent
    }
  }
  CHECK(steps_until_still(still, numbered, 1000) == 1000);
}

TEST_CASE("a_path_that_moves_stands_still_only_where_its_moves_stay_round_off") {
  const auto two_in_turn = [](int k) { return numbered(k % 2); };
  CHECK(steps_until_still([](int) { return 1e-11; }, two_in_turn, 1000) == 1000);
  CHECK(steps_until_still([](int k) { return k % 10 == 9 ? 1e-11 : 0; }, numbered, 1000) == 1000);
  // Two gaps that close in turn, each by a tenth of the other one, are gone before that is taken for an end.
  int k = 0;
  Standstill standstill;
  for (double gap = 1; gap > 1e-14; gap /= 10, ++k) {
    const bool ends = !standstill.moved(gap, 1) && standstill.again(two_in_turn(k));
    CHECK_FALSE(ends);
  }
  const int steps = steps_until_still([](int) { return 1e-14; }, two_in_turn, 1000);
  CAPTURE(steps);
  CHECK(steps > 20);
  CHECK(steps < 100);
}
