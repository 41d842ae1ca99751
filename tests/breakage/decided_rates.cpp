// SPDX-License-Identifier: GPL-3.0-or-later
// The statuses of contacts on limits, beside closed forms.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "breakage/limit_network.hpp"
#include "breakage/tied_disc.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double normal_stiffness = TiedDisc::kN, tangential_stiffness = TiedDisc::kT;

/// A disc of radius 1 at the origin between two held ones. \param angles of the directions to them, rad
Assembly groove(double first, double second) {
  Assembly scene = chain_of_discs(3, 1);
  scene.centres = {2 * Vec2{std::cos(first), std::sin(first)}, {0, 0}, 2 * Vec2{std::cos(second), std::sin(second)}};
  scene.contacts = {{0, 1, 0, 0, 1, 1}, {1, 2, 0, 0, 1, 1}};
  scene.groups["held"] = {{0, 2}, {}};
  scene.groups["disc"] = {{1}, {}};
  return scene;
}

Unbonded pressed_into(double slope, double friction, bool turns) {
  LoadPathOptions options;
  const double down = -std::numbers::pi / 2;
  options.supports = {{"held", 0, 0, 0}};
  if (!turns) options.supports.push_back({"disc", {}, {}, 0});
  options.loads = {{"disc", LoadKind::per_disc, {0, -1}, 0}};
  options.control = LoadControl::load;
  options.legs = {1};
  return {groove(down - slope, down + slope), ContactSprings(SpringConstants{normal_stiffness, tangential_stiffness}),
          options, friction};
}

/// The tied disc, whose contact with the other one carries no force: every status gives the load as a linear function
/// of the motion.
struct TiedRates {
  /// \param spring_across spring of the bond at right angles to it
  explicit TiedRates(double mu, double spring_across = 0)
      : friction(mu),
        across(spring_across),
        network(TiedDisc::assembly(), TiedDisc::springs(spring_across), TiedDisc::supports(), mu) {
    network.bond(1);
    network.limit({0, OnLimit::apex, 1});
  }

  /// The load of the motion (n, t) with a status; K of the oblique bond has the entries (kN + kT)/2, (kN - kT)/2.
  [[nodiscard]] Vec2 load(ContactStatus status, Vec2 u) const {
    const double tie = 0.5 * normal_stiffness * (u.x + u.y), aside = 0.5 * across * (u.x - u.y);
    const double normal = status == ContactStatus::open ? 0 : normal_stiffness * u.x;
    const double along = status == ContactStatus::open    ? 0
                         : status == ContactStatus::stuck ? tangential_stiffness * u.y
                                                          : -direction_of(status) * friction * normal;
    return {tie + aside + normal, tie - aside + along};
  }
  [[nodiscard]] bool allows(ContactStatus status, Vec2 u) const {
    const double beyond = tangential_stiffness * std::abs(u.y) + friction * normal_stiffness * u.x;
    if (status == ContactStatus::open) return u.x > 0;
    if (status == ContactStatus::stuck) return beyond < 0;
    return u.x < 0 && beyond > 0 && direction_of(status) * u.y > 0;
  }
  /// Statuses whose motion under a load is one of theirs.
  [[nodiscard]] std::vector<ContactStatus> answers(Vec2 f) const {
    using enum ContactStatus;
    std::vector<ContactStatus> found;
    for (const ContactStatus status : {stuck, open, slips_forward, slips_backward}) {
      const Vec2 a = load(status, {1, 0}), b = load(status, {0, 1});
      const double det = a.x * b.y - b.x * a.y;
      if (std::abs(det) < 1e-9 * normal_stiffness * normal_stiffness)
        continue;  // the load of the open disc is along the spring alone
      if (allows(status, {(f.x * b.y - b.x * f.y) / det, (a.x * f.y - f.x * a.y) / det})) found.push_back(status);
    }
    return found;
  }
  [[nodiscard]] LimitNetwork::Answers under(Vec2 f) {
    std::vector<double> force(network.components());
    force[3] = f.x, force[4] = f.y;
    return network.load(force);
  }

  double friction, across;
  LimitNetwork network;
};

Vec2 direction(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

// By symmetry the disc does not turn and moves down by d: N = normal_stiffness d cos(slope) at each contact, and T =
// tangential_stiffness d sin(slope) where they stick, |T| = mu N where they slip. Neither contact carries a force at
// first, and one alone, or none, does not carry the disc: combinations with an open contact leave motions free, as does
// that of two slips if the disc turns.
TEST_CASE("a_disc_pressed_into_a_groove_slips_on_both_sides_or_sticks_on_both_from_the_first_load_on") {
  for (const double slope : {0.3, 0.7, 1.2}) {
    for (const double friction : {0.0, 0.05, 0.1, 0.25, 0.5, 0.9, 2.0, 9.0}) {
      for (const bool turns : {false, true}) {
        Unbonded disc = pressed_into(slope, friction, turns);
        disc.all();
        CAPTURE(slope, friction, turns, disc.run().why());
        REQUIRE(disc.run().end() == PathEnd::legs_done);
        const double share =
            std::min(friction, friction > 0 ? tangential_stiffness / normal_stiffness * std::tan(slope) : 0);
        const double normal = -1 / (2 * (std::cos(slope) + share * std::sin(slope)));
        for (const ContactForce& f : disc.run().contact_state().forces()) {
          CHECK(f.normal == Approx(normal).epsilon(1e-12));
          CHECK(std::abs(f.tangential) == Approx(-share * normal).epsilon(1e-12).margin(1e-15));
        }
      }
    }
  }
}

// A wedge that does not turn between two planes with different angles of friction: where both slip, N n + T t of both
// balance the load; each T has the side on which its plane is passed.
TEST_CASE("a_wedge_pressed_between_two_planes_slips_on_those_whose_friction_it_exceeds") {
  const double down = -std::numbers::pi / 2;
  for (const double slope : {1.0, 1.35}) {
    for (const std::array<double, 2> friction :
         {std::array{0.1, 0.2}, {0.1, 5.0}, {5.0, 0.1}, {5.0, 5.0}, {0.3, 0.0}}) {
      LimitNetwork wedge(groove(down - slope, down + slope),
                         ContactSprings(SpringConstants{normal_stiffness, tangential_stiffness}),
                         {{"held", 0, 0, 0}, {"disc", {}, {}, 0}}, 0);
      for (std::size_t c = 0; c < 2; ++c) {
        wedge.friction(c, friction[c]);
        wedge.limit({c, OnLimit::apex, 1});
      }
      std::vector<double> force(wedge.components());
      force[4] = -1;
      const LimitNetwork::Answers answers = wedge.load(force);
      CAPTURE(slope, friction[0], friction[1]);
      REQUIRE(answers.found);
      // The forces on the disc: compression from both sides, friction upwards along the planes.
      double up = 0, aside = 0;
      for (std::size_t c = 0; c < 2; ++c) {
        const double n = -answers.force[c].normal, t = std::abs(answers.force[c].tangential), side = c == 0 ? 1 : -1;
        up += n * std::cos(slope) + t * std::sin(slope);
        aside += side * (n * std::sin(slope) - t * std::cos(slope));
        const bool slips = is_slipping(answers.status[wedge.limits()[c].contact]) || friction[c] == 0;
        CHECK(slips == (friction[c] < 1));
        if (slips) CHECK(t == Approx(friction[c] * n).margin(1e-14));
        CHECK(t <= friction[c] * n + 1e-12);
      }
      CHECK(up == Approx(1).epsilon(1e-12));
      CHECK(aside == Approx(0).margin(1e-12));
    }
  }
}

TEST_CASE("a_contact_without_force_opens_sticks_or_slips_as_the_load_is_directed") {
  std::array<int, 5> with_answers{};
  for (const double friction : {0.2, 0.8, 1.5, 4.0}) {
    TiedRates disc(friction);
    for (int k = 0; k < 180; ++k) {
      const Vec2 f = direction(0.01 + std::numbers::pi * k / 90);
      const std::vector<ContactStatus> expected = disc.answers(f);
      const LimitNetwork::Answers answers = disc.under(f);
      CAPTURE(friction, k, expected.size(), answers.found);
      ++with_answers[expected.size()];
      CHECK(answers.found == !expected.empty());
      if (!answers.found) continue;
      CHECK(std::ranges::count(expected, answers.status[0]) == 1);
    }
  }
  CAPTURE(with_answers);
  CHECK(with_answers[0] > 100);  // the load leads to a motion that opens, which the spring alone does not carry
  CHECK(with_answers[1] > 100);
  CHECK(with_answers[2] > 2);
}

// The limits are the loads of motions on the borders between statuses: u = (0, +-1) between slip and opening,
// u = (-tangential_stiffness, +-mu normal_stiffness) between sticking and slip.
TEST_CASE("statuses_change_at_the_loads_at_which_theory_says_so") {
  using enum ContactStatus;
  for (const double friction : {0.2, 0.8}) {
    TiedRates disc(friction);
    for (const double side : {1.0, -1.0}) {
      const Vec2 sliding = disc.load(stuck, {-tangential_stiffness, side * friction * normal_stiffness});
      const double at = std::atan2(sliding.y, sliding.x);
      for (const double by : {1e-2, 1e-6, 1e-8}) {
        CAPTURE(friction, side, by);
        const bool before = disc.under(direction(at - by)).status[0] == stuck;
        const bool behind = disc.under(direction(at + by)).status[0] == stuck;
        CHECK(before != behind);
        for (const double angle : {at - by, at + by}) {
          const LimitNetwork::Answers answers = disc.under(direction(angle));
          CHECK(answers.status[0] == disc.answers(direction(angle)).front());
        }
      }
      // On the border both statuses have the same forces, which are one answer.
      const LimitNetwork::Answers border = disc.under(direction(at));
      CHECK(border.found);
      CHECK(std::abs(border.force[0].tangential) == Approx(-friction * border.force[0].normal).epsilon(1e-12));
    }
  }
}
