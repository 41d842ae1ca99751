// SPDX-License-Identifier: GPL-3.0-or-later
// Dead loads on contacts without bonds: they are carried to their limit, which the end of the path reports.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"

#include "breakage/tied_disc.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double radius = 0.5, weight = 2;
const ContactSprings groove_springs(SpringConstants{1e4, 3e3});

/// A disc, 2, on two held ones, whose contacts have their normals at an angle from the vertical; it rests under its
/// weight, which stays.
Unbonded in_a_groove(double angle, double friction, const Vec2& force, double moment) {
  Assembly groove;
  groove.kind = "groove";
  const Vec2 to_right = 2 * radius * Vec2{std::sin(angle), -std::cos(angle)};
  groove.centres = {{-to_right.x, to_right.y}, to_right, {0, 0}};
  groove.radii.assign(3, radius);
  groove.contacts = {{0, 2, 0, 0, radius, radius}, {1, 2, 0, 0, radius, radius}};
  groove.groups["held"] = {{0, 1}, {}};
  groove.groups["disc"] = {{2}, {}};
  LoadPathOptions options;
  options.supports = {{"held", 0, 0, 0}};
  options.dead_loads = {{"disc", LoadKind::per_disc, force, moment}};
  options.loads = {{"disc", LoadKind::per_disc, {0, -1e-3 * weight}, 0}};
  options.control = LoadControl::load;
  options.legs = {1};
  const ContactForce rest{-weight / (2 * std::cos(angle)), 0};
  return {groove, groove_springs, equal_strengths(groove, 0, 0), options, {friction, {rest, rest}}};
}

std::string carried_share(double share) {
  return fmt::format("at {:.4g} % of the dead loads ", 100 * share);
}

/// Loads drive what nothing resists, or no states of the contacts balance them.
bool not_carried(PathEnd end) {
  return end == PathEnd::load_moves_part || end == PathEnd::no_answer;
}

}  // namespace

// With the angle of friction phi below the angle beta of the normals both contacts slip at the limit, and their forces
// are turned by phi: M = W r sin(phi) cos(phi)/cos(beta).
TEST_CASE("a_moment_turns_a_disc_in_a_groove_where_friction_ends_on_both_of_its_sides") {
  for (const double angle : {0.6, std::numbers::pi / 4, 1.0}) {
    for (const double friction : {0.1, 0.3, 0.5}) {
      const double phi = std::atan(friction);
      const double limit = weight * radius * std::sin(phi) * std::cos(phi) / std::cos(angle);
      for (const double times : {0.9, -0.9}) {
        Unbonded borne = in_a_groove(angle, friction, {}, times * limit);
        borne.all();
        CAPTURE(angle, friction, times, borne.run().why());
        CHECK(borne.run().end() == PathEnd::legs_done);
        CHECK(borne.run().contact_state().dead() == 1);
      }
      for (const double times : {1.1, -4.0, 1000.0}) {
        Unbonded turned = in_a_groove(angle, friction, {}, times * limit);
        turned.all();
        CAPTURE(angle, friction, times, turned.run().why());
        CHECK(not_carried(turned.run().end()));
        CHECK(turned.run().contact_state().dead() == Approx(1 / std::abs(times)).epsilon(1e-9));
        CHECK(turned.run().lambda() == 0);
        CHECK_THAT(turned.run().why(), Catch::Contains(carried_share(1 / std::abs(times))));
        CHECK(turned.run().energy_error() < 1e-10);
      }
    }
  }
}

// A force across tilts the weight until both together point at the lower contact: H = W tan(beta), whatever the
// friction below tan(beta).
TEST_CASE("a_disc_leaves_its_groove_where_the_force_on_it_points_at_its_lower_contact") {
  for (const double angle : {0.3, 0.6, 1.0}) {
    for (const double friction : {0.0, 0.1, 0.25}) {
      for (const double times : {1.25, -2.0, 50.0}) {
        const double limit = weight * std::tan(angle);
        Unbonded tilted = in_a_groove(angle, friction, {times * limit, 0}, 0);
        tilted.all();
        CAPTURE(angle, friction, times, tilted.run().why(), tilted.events().size());
        CHECK(not_carried(tilted.run().end()));
        CHECK(tilted.run().contact_state().dead() == Approx(1 / std::abs(times)).epsilon(1e-9));
        CHECK_THAT(tilted.run().why(), Catch::Contains(carried_share(1 / std::abs(times))));
        Unbonded borne = in_a_groove(angle, friction, {0.95 * times / std::abs(times) * limit, 0}, 0);
        CHECK(borne.all().run().end() == PathEnd::legs_done);
      }
    }
  }
}

// Without a weight no part of such loads is carried.
TEST_CASE("contacts_that_rest_without_a_force_carry_no_part_of_a_dead_load_that_lifts") {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", {}, {}, 0}};
  options.dead_loads = {{"last", LoadKind::per_disc, {1, 0.1}, 0}};
  options.loads = {{"last", LoadKind::per_disc, {-1, 0}, 0}};
  options.control = LoadControl::load;
  options.legs = {1};
  for (const double friction : {0.0, 0.5}) {
    Unbonded lifted(chain_of_discs(2, 1), ContactSprings(SpringConstants{1000, 300}), options, friction);
    lifted.all();
    CAPTURE(friction, lifted.run().why());
    CHECK(not_carried(lifted.run().end()));
    CHECK(lifted.run().contact_state().dead() == 0);
    CHECK_THAT(lifted.run().why(), Catch::Contains("before any of the dead loads acts"));
  }
}

// The tied disc rests on the other with N = -1 and is pushed along by F. With the stiffness K of contact and bond that
// stick, it slips where kT |u_y| = mu (1 - kN u_x), u = s K^-1 (0, F). Slip away from the bond relieves the contact:
// its stiffness loses the row of the tangential spring and has mu kN beside it, and det(K_slip) < 0 for mu > 1.
TEST_CASE("a_dead_load_ends_where_slip_that_relieves_its_own_contact_leaves_no_consistent_state") {
  constexpr double friction = 2, kN = TiedDisc::kN, kT = TiedDisc::kT, half = kN / 2, load = 5;
  const double det = (kN + half) * (kT + half) - half * half;
  const double ux = half * load / det, uy = -(kN + half) * load / det;  // at the whole load, along -y
  const double limit = friction / (kT * std::abs(uy) + friction * kN * ux);
  LoadPathOptions options;
  options.supports = TiedDisc::supports();
  options.dead_loads = {{"disc", LoadKind::per_disc, {0, -load}, 0}};
  options.loads = {{"disc", LoadKind::per_disc, {0, 1e-3}, 0}};
  options.control = LoadControl::load;
  options.legs = {1};
  Unbonded disc(TiedDisc::assembly(), TiedDisc::springs(), TiedDisc::strengths(), options,
                {friction, {{-1, 0}, {0, 0}}});
  disc.all();
  CAPTURE(disc.run().why());
  CHECK(disc.run().contact_state().dead() == Approx(limit).epsilon(1e-9));
  CHECK(disc.run().end() == PathEnd::no_answer);
  CHECK_THAT(disc.run().why(), Catch::Contains(fmt::format(
                                   "at {:.4g} % of the dead loads no consistent contact state found", 100 * limit)));
}
