// SPDX-License-Identifier: GPL-3.0-or-later
// Rate problems of contacts on their limits: an answer is found wherever there is one.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/lattices.hpp"

#include "breakage/all_statuses.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

// A random load of a random network has an answer in half of the cases. Elsewhere it moves discs although all contacts
// on limits stick, or none of all combinations of statuses agrees with its rates. Where the path from sticking contacts
// goes back, answers that exist are missed: some with much friction, hardly any with friction below 1.
TEST_CASE("rates_are_those_of_some_combination_of_statuses_and_hardly_any_is_missed") {
  std::int64_t loads = 0, found = 0, not_carried = 0, none = 0, several = 0;
  std::int64_t usual = 0, usual_missed = 0;  // friction below 1
  std::vector<std::uint64_t> missed;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    Random random(seed);
    const double friction = std::array{0.1, 0.3, 0.8, 2.0, 5.0}[seed % 5];
    // Half of them have no contact off its limits but bonds, and a third of these hardly any force.
    const auto network =
        seed % 2 == 0 ? random_limit_network(seed, random, friction)
                      : random_limit_network(seed, random, friction, 6, seed % 3 == 0 ? 0.7 : 0.3, {0, 0.5, 0.5});
    const AllStatuses all(*network);
    std::vector<double> force(network->components());
    for (double& f : force) f = random.uniform(-1, 1);
    const LimitNetwork::Answers answers = network->load(force);
    const AllStatuses::Count count = all.under(force);
    ++loads;
    found += answers.found ? 1 : 0;
    several += count.answers > 1 ? 1 : 0;
    CAPTURE(seed, friction, network->limits().size(), count.tried, count.answers, count.carried);
    if (!count.carried) {
      ++not_carried;
      CHECK(answers.driven);
    } else if (count.answers == 0) {
      ++none;
    } else if (!answers.found) {
      missed.push_back(seed);
    }
    if (friction < 1 && count.answers > 0) ++usual, usual_missed += answers.found ? 0 : 1;
    if (answers.found) CHECK(count.answers > 0);
  }
  CAPTURE(loads, found, not_carried, none, several, missed, usual, usual_missed);
  CHECK(std::ssize(missed) < loads / 50);
  CHECK(usual_missed <= usual / 50);
  CHECK(found > loads / 3);
  CHECK(not_carried > loads / 20);
  CHECK(none > loads / 10);
  CHECK(several > loads / 20);
}

namespace {

Unbonded pressed_lattice(int rows, double friction, std::vector<double> legs) {
  const Assembly block = hexagonal_lattice({.columns = rows, .rows = rows, .radius = 0.5});
  LoadPathOptions options;
  options.supports = {{"bottom", 0, 0, {}}, {"top", {}, -1e-3, {}}};
  options.control = LoadControl::motion;
  options.legs = std::move(legs);
  return {block, ContactSprings(SpringConstants{1e3, 3e2}), options, friction};
}

}  // namespace

// No contact carries a force at first, so that every one is at the apex of its law, and the forces are proportional to
// the way of the plate. Discs between those that carry it are pushed along without a force. On the way back a lattice
// may fall from one state to another.
//
// Forces that do not balance, r F at most of the largest force F, work on the motion: the energy misses by no more than
// r F times the sum of the ways of all components. Each step rounds works and energies by some units of round-off of
// the largest of them.
TEST_CASE("lattices_without_bonds_carry_a_plate_that_presses_them") {
  constexpr double units = 8 * std::numeric_limits<double>::epsilon();
  int whole = 0;
  double closest = 0;
  for (const int rows : {4, 7}) {
    for (const double friction : {0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 3.0, 10.0}) {
      Unbonded pressed = pressed_lattice(rows, friction, {1, 2, 0});
      const UnbondedState& state = pressed.run().contact_state();
      Way way(state.motion().high);
      bool back = false;
      double energy = 0;
      std::int64_t steps = 0;
      for (bool more = true; more; ++steps) {
        more = pressed.run().advance();
        const bool event_on_the_way_back = !pressed.events().empty() && pressed.events().back().leg == 2;
        if (!back && pressed.run().lambda() < 2 &&
            (event_on_the_way_back || pressed.run().end() == PathEnd::legs_done)) {
          way.go_to(pressed_lattice(rows, friction, {1, 2}).all().run().contact_state().motion().high);
          back = true;
        }
        way.go_to(state.motion().high);
        const PathLedger& l = state.ledger();
        energy = std::max({energy, std::abs(l.work), std::abs(l.elastic), std::abs(l.friction)});
        const double missing = std::abs(l.work - l.elastic - l.friction - l.released);
        const double residual = pressed.run().solver().largest_residual;
        const double unbalanced = residual * state.largest_force() * way.length();
        CAPTURE(rows, friction, steps, pressed.run().lambda(), missing, unbalanced, energy, residual);
        CHECK(residual < 1e-12);
        CHECK(missing <= unbalanced + units * static_cast<double>(steps + 1) * energy);
        closest = std::max(closest, unbalanced > 0 ? missing / unbalanced : 0);
      }
      CAPTURE(rows, friction, pressed.run().why(), pressed.run().lambda());
      const std::vector<LegPoint> points = pressed.run().leg_points();
      REQUIRE(points.size() >= 3);
      CHECK(points[1].load > 0.1);
      CHECK(points[2].load == Approx(2 * points[1].load).epsilon(1e-9));
      if (pressed.run().end() == PathEnd::legs_done) {
        ++whole;
        CHECK(std::abs(points[3].load) < 1e-9);
      } else {
        CHECK(pressed.run().end() == PathEnd::no_answer);
      }
    }
  }
  CAPTURE(whole, closest);
  CHECK(whole >= 18);
  CHECK(closest > 1e-3);  // a bound that is far off would show nothing
}
