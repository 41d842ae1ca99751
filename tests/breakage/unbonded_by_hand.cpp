// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts without bonds against closed forms.
#include <cmath>
#include <vector>

#include "breakage/unbonded_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const ContactSprings pair_of_springs(SpringConstants{1000, 300});

/// A disc on a held one, pressed down by 1 N/m and pushed sideways by lambda.
Unbonded on_the_ground(double friction, std::vector<double> legs, LoadControl control = LoadControl::load) {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", {}, {}, 0}};
  options.dead_loads = {{"last", LoadKind::per_disc, {-1, 0}, 0}};
  options.loads = {{"last", LoadKind::per_disc, {0, 1}, 0}};
  options.control = control;
  options.legs = std::move(legs);
  return {chain_of_discs(2, 1), pair_of_springs, options, friction};
}

}  // namespace

TEST_CASE("a_disc_slips_where_the_tangent_of_the_slope_is_the_friction") {
  for (const double friction : {0.1, 0.5, 3.0}) {
    CAPTURE(friction);
    Unbonded disc = on_the_ground(friction, {10});
    disc.all();
    REQUIRE(disc.events().size() == 1);
    CHECK(disc.event(0).mode == BreakMode::slip);
    CHECK(disc.event(0).lambda == Approx(friction).epsilon(1e-12));
    CHECK(disc.run().end() == PathEnd::load_moves_part);
  }
}

TEST_CASE("a_contact_that_is_pulled_opens") {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", 1e-3, 0, 0}};
  options.control = LoadControl::motion;
  options.legs = {-1, 1};
  Unbonded pair(chain_of_discs(2, 1), pair_of_springs, options, 0.5);
  pair.all();
  REQUIRE(pair.events().size() == 1);
  CHECK(pair.event(0).mode == BreakMode::open);
  CHECK(pair.event(0).lambda == Approx(0).margin(1e-12));
  CHECK(pair.run().end() == PathEnd::legs_done);
}
