// SPDX-License-Identifier: GPL-3.0-or-later
// Dead loads on contacts without bonds: they are borne to their limit, and the end of the path tells it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/breakage/unbonded/giving_way/nearest_in_cone.hpp"
#include "equidem/breakage/unbonded/giving_way/unborne_loads.hpp"
#include "equidem/breakage/unbonded/giving_way/unresisted_motion.hpp"
#include "equidem/core/text.hpp"

#include "breakage/all_statuses.hpp"
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
  return fmt::format("the contacts can carry {:.4g} % of the dead loads and no more", 100 * share);
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
        CHECK(borne.run().state().dead() == 1);
      }
      for (const double times : {1.1, -4.0, 1000.0}) {
        Unbonded turned = in_a_groove(angle, friction, {}, times * limit);
        turned.all();
        CAPTURE(angle, friction, times, turned.run().why());
        CHECK(turned.run().end() == PathEnd::load_moves_part);
        CHECK(turned.run().state().dead() == Approx(1 / std::abs(times)).epsilon(1e-9));
        CHECK(turned.run().lambda() == 0);
        CHECK_THAT(turned.run().why(), Catch::Contains(carried_share(1 / std::abs(times))));
        CHECK_THAT(turned.run().why(), Catch::Contains("disc 2 at (0, 0)"));
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
        CHECK(tilted.run().end() == PathEnd::load_moves_part);
        CHECK(tilted.run().state().dead() == Approx(1 / std::abs(times)).epsilon(1e-9));
        CHECK_THAT(tilted.run().why(), Catch::Contains(carried_share(1 / std::abs(times))));
        Unbonded borne = in_a_groove(angle, friction, {0.95 * times / std::abs(times) * limit, 0}, 0);
        CHECK(borne.all().run().end() == PathEnd::legs_done);
      }
    }
  }
}

// Without a weight no part of such loads is borne, and the end names them before anything else.
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
    CHECK(lifted.run().end() == PathEnd::load_moves_part);
    CHECK(lifted.run().state().dead() == 0);
    CHECK_THAT(lifted.run().why(), Catch::Contains("the contacts can carry no part of the dead loads"));
  }
}

// The tied disc rests on the other with N = -1 and is pushed along by F. With the stiffness K of contact and bond that
// stick, it slips where kT |u_y| = mu (1 - kN u_x), u = s K^-1 (0, F). Slip away from the bond relieves the contact:
// its stiffness loses the row of the tangential spring and has mu kN beside it, and det(K_slip) < 0 for mu > 1.
TEST_CASE("a_dead_load_ends_where_slip_that_relieves_its_own_contact_makes_the_state_unstable") {
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
  CHECK(disc.run().state().dead() == Approx(limit).epsilon(1e-9));
  CHECK(disc.run().end() == PathEnd::no_answer);
  CHECK_THAT(disc.run().why(),
             Catch::Contains(fmt::format("at {:.4g} % of the dead loads the equilibrium is unstable", 100 * limit)));
  // The root c > 0 of det(K_slip + c) = 0 with the rows (kN + half, half) and (half + mu kN, half).
  const double trace = kN + half + half, slipping_det = (kN + half) * half - half * (half + friction * kN);
  REQUIRE(slipping_det < 0);
  const double c = -trace / 2 + std::sqrt(trace * trace / 4 - slipping_det);
  double found = 0;
  for (const double direction : {1.0, -1.0}) {
    LimitNetwork one(TiedDisc::assembly(), TiedDisc::springs(), TiedDisc::supports(), friction);
    one.bond(1);
    one.limit({0, OnLimit::friction, direction});
    std::vector<double> force(one.components(), 0.0);
    force[force.size() / 3 + 1] = -1;  // the disc, along -y
    const RightHandSide pattern{.force = force, .prescribed = std::vector<double>(force.size(), 0.0)};
    if (const auto growing = unresisted_motion(one.problem_of(pattern), one.status())) found = growing->growth;
  }
  CHECK(found * TiedDisc::kN == Approx(c).epsilon(5e-3));
}

TEST_CASE("a_vector_is_outside_of_a_cone_where_a_plane_separates_them") {
  int inside = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const std::size_t n = 3 + seed % 20, edges = 1 + seed % 37, lines = seed % 4;
    const auto draw = [&] {
      std::vector<double> x(n);
      for (double& a : x) a = random.uniform(-1, 1);
      return x;
    };
    Cone cone;
    for (std::size_t k = 0; k < edges; ++k) cone.edges.push_back(draw());
    for (std::size_t k = 0; k < lines; ++k) cone.lines.push_back(draw());
    std::vector<double> within(n, 0.0), any = draw();
    for (std::size_t m = 0; m < n; ++m) {
      for (std::size_t k = 0; k < edges; k += 2) within[m] += (1 + static_cast<double>(k % 3)) * cone.edges[k][m];
      for (const auto& line : cone.lines) within[m] -= 2 * line[m];
    }
    CAPTURE(seed, n, edges, lines);
    CHECK(remainder_outside(cone, within).share < 1e-9);
    const ConeRemainder beside = remainder_outside(cone, any);
    if (beside.share > 1e-9) CHECK(beside.beyond < 1e-9);
    double work = 0, square = 0;
    for (std::size_t m = 0; m < n; ++m) {
      work += beside.remainder[m] * any[m];
      square += beside.remainder[m] * beside.remainder[m];
    }
    CHECK(work == Approx(square).margin(1e-12));
    (beside.share < 1e-9 ? inside : outside) += 1;
  }
  CAPTURE(inside, outside);
  CHECK(inside > 30);
  CHECK(outside > 100);
}

// All combinations of statuses by dense matrices: loads that contacts cannot bear have no answer, and loads that have
// one are borne. Where forces that balance the load exist and no statuses answer it, contacts do not resist some
// motion.
TEST_CASE("loads_without_an_answer_are_more_than_contacts_bear_or_drive_a_motion_that_they_do_not_resist") {
  std::int64_t unborne = 0, borne = 0, unanswered = 0, unstable = 0, mechanisms = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Random random(seed);
    const double friction = std::array{0.1, 0.3, 0.8, 2.0, 5.0}[seed % 5];
    const auto network = seed % 2 == 0 ? random_limit_network(seed, random, friction)
                                       : random_limit_network(seed, random, friction, 6, 0.5, {0, 0.5, 0.5});
    std::vector<double> force(network->components());
    for (double& f : force) f = random.uniform(-1, 1);
    const RightHandSide pattern{.force = force, .prescribed = std::vector<double>(force.size(), 0.0)};
    const RateProblem problem = network->problem_of(pattern);
    const AllStatuses::Count count = AllStatuses(*network).under(force);
    const bool shown = unborne_loads(problem, network->status()).has_value();
    CAPTURE(seed, friction, count.answers, count.carried);
    if (!count.carried) CHECK(shown);
    if (shown) CHECK(count.answers == 0);
    (shown ? unborne : borne) += 1;
    if (shown || count.answers > 0 || !count.ties.empty()) continue;
    ++unanswered;
    const auto motion = unresisted_motion(problem, network->status());
    if (!motion) continue;
    (motion->growth > 0 ? unstable : mechanisms) += 1;
    // The law alone: with the statuses that the motion asks for, its forces are those of springs that push it on.
    const std::vector<double>& w = motion->motion;
    double fastest = 0, missing = 0, stiffest = 0;
    for (const double x : w) fastest = std::max(fastest, std::abs(x));
    std::vector<ContactStatus> status = network->status();
    for (const LimitContact& at : network->limits()) {
      const ContactDeformation d = problem.contacts.deformation(at.contact, w);
      status[at.contact] = status_after(network->laws()[at.contact], at, d, status[at.contact], 0);
    }
    std::vector<double> internal(w.size(), 0.0);
    for (std::size_t c = 0; c < network->contacts(); ++c) {
      const UnbondedLaw& law = network->laws()[c];
      stiffest = std::max({stiffest, law.k.kN, law.k.kT});
      problem.contacts.add_internal(c, law.tangent(status[c]).rate(problem.contacts.deformation(c, w)), internal);
    }
    for (std::size_t k = 0; k < w.size(); ++k) {
      if (network->unknowns().held[k] != 0) continue;
      missing = std::max(missing, std::abs(internal[k] + motion->growth * stiffest * w[k]));
    }
    CAPTURE(missing / (stiffest * fastest), motion->growth);
    CHECK(missing < (motion->growth > 0 ? 0.005 * motion->growth : 1e-3) * stiffest * fastest);
  }
  CAPTURE(unborne, borne, unanswered, unstable, mechanisms);
  CHECK(unborne > 50);
  CHECK(borne > 50);
  CHECK(unanswered > 10);
  CHECK(unstable > 10);
  CHECK(mechanisms > 10);
  CHECK(unstable + mechanisms > 0.9 * static_cast<double>(unanswered));
}
