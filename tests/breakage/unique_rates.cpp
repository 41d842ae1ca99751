// SPDX-License-Identifier: GPL-3.0-or-later
// Rates that are proved to be unique, against all combinations of the statuses of contacts on limits.
#include <array>
#include <cmath>
#include <vector>

#include "breakage/limit_network.hpp"
#include "breakage/tied_disc.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

// What is not proved may still have one answer for these loads: the proof is of all loads, and fails where contacts
// that let go together hold nothing.
TEST_CASE("rates_that_are_proved_unique_have_no_other_combination_of_statuses") {
  std::int64_t loads = 0, found = 0, proved = 0, several = 0, usual = 0, usual_proved = 0;
  std::int64_t with_apex = 0, apex_proved = 0, apex_several = 0;  // some contact is at the apex
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    Random random(seed);
    const double friction = std::array{0.1, 0.3, 0.8, 2.0, 5.0}[seed % 5];
    const auto made = random_limit_network(seed, random, friction);
    LimitNetwork& network = *made;
    const std::size_t on_limits = network.limits().size();
    const bool at_apex =
        std::ranges::any_of(network.limits(), [](const LimitContact& at) { return at.limit == OnLimit::apex; });
    for (int k = 0; k < 4; ++k) {
      std::vector<double> force(network.components());
      for (double& f : force) f = random.uniform(-1, 1);
      const LimitNetwork::Answers answers = network.load(force);
      ++loads;
      found += answers.found ? 1 : 0;
      if (!answers.found || !answers.branches.all_tried) continue;
      CAPTURE(seed, friction, on_limits, answers.branches.others);
      proved += answers.proved ? 1 : 0;
      several += answers.branches.others > 0 ? 1 : 0;
      if (at_apex) {
        ++with_apex;
        apex_proved += answers.proved ? 1 : 0;
        apex_several += answers.branches.others > 0 ? 1 : 0;
      }
      if (friction < 0.5) ++usual, usual_proved += answers.proved ? 1 : 0;
      if (answers.proved) CHECK(answers.branches.others == 0);
    }
  }
  CAPTURE(loads, found, proved, several, usual, usual_proved, with_apex, apex_proved, apex_several);
  CHECK(found > 1000);  // other loads move discs that nothing holds, or have no answer
  CHECK(apex_proved > 100);
  CHECK(apex_several > 20);
  CHECK(proved > 300);
  CHECK(several > 50);
  CHECK(usual_proved > usual / 2);
}

TEST_CASE("one_contact_at_the_limit_of_friction_is_proved_unique_up_to_klarbrings_friction") {
  // The disc of where_friction_leaves_two_answers_both_are_told: the limit is mu = 1 in one direction, none in the
  // other.
  for (const double friction : {0.0, 0.5, 0.999, 1.001, 5.0}) {
    for (const double direction : {-1.0, 1.0}) {
      CAPTURE(friction, direction);
      LimitNetwork network(TiedDisc::assembly(), TiedDisc::springs(), TiedDisc::supports(), friction);
      network.bond(1);
      network.limit({0, OnLimit::friction, direction});
      std::vector<double> force(network.components());
      force[3] = -1;
      const LimitNetwork::Answers answers = network.load(force);
      const bool unique = friction < 1 || direction > 0;
      if (unique) REQUIRE(answers.found);
      CHECK(answers.proved == unique);
    }
  }
}
