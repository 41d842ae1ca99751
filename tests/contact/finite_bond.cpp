// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The bond of two discs: an energy of finite motions with its derivatives, the motions that do not change it, and its
/// dashpots: their change of the rates in a step, and the limit of the step.
#include "equidem/contact/finite_bond.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "equidem/core/random.hpp"

#include "support/bond_rates.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;
using std::numbers::pi;

namespace {

using Real = long double;
using Motion = BondMotion<Real>;

/// Levers that add up to the branch, that do not, and that vanish.
struct Levers {
  std::string name;
  double share_i = 0, share_j = 0;  ///< of the branch
  [[nodiscard]] bool add_up() const { return share_i + share_j == 1; }
};
const std::array<Levers, 5> all_levers{
    {{"equal", 0.5, 0.5}, {"unequal", 0.25, 0.75}, {"one", 1, 0}, {"too short", 0.25, 0.5}, {"none", 0, 0}}};

FiniteBond bond_with(const Levers& levers, Random& random) {
  const double angle = random.uniform(-pi, pi), length = random.uniform(0.5, 2);
  return {{length * std::cos(angle), length * std::sin(angle)},
          levers.share_i * length,
          levers.share_j * length,
          {random.uniform(1, 3), random.uniform(-1, 3)}};
}

Motion random_motion(double size, Random& random) {
  const auto draw = [&] { return static_cast<Real>(size * random.uniform(-1, 1)); };
  return {draw(), draw(), draw(), draw()};
}

/// The branch turned by an angle, both bodies with it.
Motion turned(const FiniteBond& bond, Real angle) {
  const Real x = bond.branch.x, y = bond.branch.y, c = std::cos(angle) - 1, s = std::sin(angle);
  return {c * x - s * y, s * x + c * y, angle, angle};
}

Motion plus(const Motion& a, const Motion& b, Real factor = 1) {
  return {a.x + factor * b.x, a.y + factor * b.y, a.theta_i + factor * b.theta_i, a.theta_j + factor * b.theta_j};
}

Real largest_difference(const BondForces<Real>& a, const BondForces<Real>& b) {
  return std::max(
      {std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.moment_i - b.moment_i), std::abs(a.moment_j - b.moment_j)});
}

}  // namespace

TEST_CASE("bond_forces_are_the_derivatives_of_the_energy") {
  Random random(1);
  for (const Levers& levers : all_levers) {
    for (const double turns : {0.0, 0.3, 0.5, -17.8}) {
      for (int k = 0; k < 50; ++k) {
        const FiniteBond bond = bond_with(levers, random);
        const Motion motion = plus(turned(bond, 2 * pi * turns), random_motion(0.3, random));
        const auto derivative = [&](const Motion& direction) {
          const Real h = 1e-6L;
          return (bond_energy(bond, plus(motion, direction, h)) - bond_energy(bond, plus(motion, direction, -h))) /
                 (2 * h);
        };
        // Motion is that of j relative to i: the force on i is +dW/d(u_j - u_i), moments are -dW/dtheta.
        const BondForces<Real> differences{derivative({1, 0, 0, 0}), derivative({0, 1, 0, 0}),
                                           -derivative({0, 0, 1, 0}), -derivative({0, 0, 0, 1})};
        CAPTURE(levers.name, turns, k);
        CHECK(static_cast<double>(largest_difference(bond_forces(bond, motion), differences)) < 1e-9);
      }
    }
  }
}

TEST_CASE("rates_of_stretch_and_slip_are_their_derivatives_in_time") {
  Random random(2);
  for (const Levers& levers : all_levers) {
    for (int k = 0; k < 50; ++k) {
      const FiniteBond bond = bond_with(levers, random);
      const Motion motion = plus(turned(bond, random.uniform(-9, 9)), random_motion(0.3, random));
      const Motion velocity = random_motion(2, random);
      const Real h = 1e-6L;
      const DeformationOf<Real> after = bond_deformation(bond, plus(motion, velocity, h)),
                                before = bond_deformation(bond, plus(motion, velocity, -h)),
                                rate = bond_deformation_rate(bond, motion, velocity);
      CAPTURE(levers.name, k);
      CHECK(static_cast<double>(std::abs((after.normal - before.normal) / (2 * h) - rate.normal)) < 1e-9);
      CHECK(static_cast<double>(std::abs((after.tangential - before.tangential) / (2 * h) - rate.tangential)) < 1e-9);
    }
  }
}

TEST_CASE("a_common_rigid_motion_costs_nothing_however_many_turns") {
  Random random(3);
  for (const Levers& levers : all_levers) {
    for (const double angle : {0.0, 1.0, pi, -3.0, 2 * pi, 100.0, -12345.6}) {
      const FiniteBond bond = bond_with(levers, random);
      const Motion motion = turned(bond, angle);
      const BondForces<Real> forces = bond_forces(bond, motion);
      CAPTURE(levers.name, angle);
      // 1e-19 of a long double, times the turns that are taken away.
      CHECK(static_cast<double>(bond_energy(bond, motion)) < 1e-28);
      CHECK(static_cast<double>(largest_difference(forces, {})) < 1e-14);
    }
  }
}

TEST_CASE("discs_that_roll_on_one_another_cost_nothing") {
  const FiniteBond bond{{2, 0}, 0.5, 1.5, {1, 1}};
  for (const double angle : {0.1, 1.0, 3.0, 3.3, 10.0, 1000.0}) {
    const Motion rolled{0, 0, Real(angle) / 0.5L, -Real(angle) / 1.5L};
    CAPTURE(angle);
    CHECK(static_cast<double>(bond_energy(bond, rolled)) < 1e-28);
  }
}

TEST_CASE("small_motions_follow_the_linear_law_to_first_order") {
  Random random(5);
  for (const Levers& levers : all_levers) {
    if (!levers.add_up()) continue;
    for (int k = 0; k < 20; ++k) {
      const FiniteBond bond = bond_with(levers, random);
      const Motion direction = random_motion(1, random);
      const double length = norm(bond.branch);
      const ContactFrame frame{bond.branch / length, bond.lever_i, bond.lever_j};
      const auto difference = [&](Real size) {
        const Motion motion = plus({}, direction, size);
        const auto d =
            deformation(frame, motion.x, motion.y, frame.lever_i * motion.theta_i + frame.lever_j * motion.theta_j);
        const ForceOf<Real> f = linear_spring_force(bond.springs, d);
        const Vec2 n = frame.normal, s = frame.tangent();
        const BondForces<Real> linear{f.normal * n.x + f.tangential * s.x, f.normal * n.y + f.tangential * s.y,
                                      frame.lever_i * f.tangential, frame.lever_j * f.tangential};
        return largest_difference(bond_forces(bond, motion), linear);
      };
      const double order = static_cast<double>(std::log2(difference(1e-4L) / difference(0.5e-4L)));
      CAPTURE(levers.name, k, static_cast<double>(difference(1e-4L)));
      CHECK(order == Approx(2).margin(0.01));
    }
  }
}

namespace {

/// A bond of discs that are not alike.
struct Example {
  ContactFrame frame;
  InverseInertia i, j;
  BondModes c;
};

Example random_example(Random& random) {
  const double angle = random.uniform(-3, 3);
  const auto number = [&] { return std::pow(10, random.uniform(-1, 1)); };
  return {{{std::cos(angle), std::sin(angle)}, number(), number()},
          {number(), number()},
          {number(), number()},
          {number(), number(), number()}};
}

}  // namespace

TEST_CASE("the_decay_of_a_dashpot_is_the_exponential") {
  for (double x = 1e-12; x < 1e8; x *= 1.37) {
    const Decay left = decay(x);
    const long double y = x;
    CAPTURE(x);
    CHECK(left.keep == Approx(static_cast<double>(std::exp(-y))).epsilon(2e-14).margin(1e-17));
    CHECK(left.mean == Approx(static_cast<double>(-std::expm1(-y) / y)).epsilon(4e-16));
  }
  CHECK(decay(0).keep == 1);
  CHECK(decay(0).mean == 1);
}

TEST_CASE("dashpots_do_not_feel_rigid_motions_nor_discs_that_roll_on_one_another") {
  Random random(3);
  for (int k = 0; k < 50; ++k) {
    const Example e = random_example(random);
    const Vec2 velocity{random.uniform(-1, 1), random.uniform(-1, 1)};
    const double spin = random.uniform(-1, 1);
    const Vec2 branch = (e.frame.lever_i + e.frame.lever_j) * e.frame.normal;
    const BondModes rigid = bond_rates(e.frame, {velocity, spin}, {velocity + spin * perpendicular(branch), spin});
    const BondModes rolling = bond_rates(e.frame, {{}, spin / e.frame.lever_i}, {{}, -spin / e.frame.lever_j});
    CAPTURE(k, spin, rigid.normal, rigid.tangential, rigid.rolling, rolling.tangential);
    CHECK(std::abs(rigid.normal) + std::abs(rigid.tangential) + std::abs(rigid.rolling) < 1e-13);
    CHECK(std::abs(rolling.normal) + std::abs(rolling.tangential) < 1e-15);
    CHECK(rolling.rolling != 0);
  }
}

TEST_CASE("the_largest_rate_of_a_bond_is_that_of_its_matrix") {
  // B C B^T M^-1 by its columns: a unit impulse in each mode, and what it does to all rates; power iteration
  Random random(5);
  for (int k = 0; k < 50; ++k) {
    const Example e = random_example(random);
    const auto& [frame, i, j, c] = e;
    const auto applied = [&frame = frame, &i = i, &j = j, &c = c](const BondModes& v) {
      const BondModes f{c.normal * v.normal, c.tangential * v.tangential, c.rolling * v.rolling};
      const Vec2 on_j = f.normal * frame.normal + f.tangential * frame.tangent();
      const double turn_i = -frame.lever_i * f.tangential - f.rolling;
      const double turn_j = -frame.lever_j * f.tangential + f.rolling;
      return bond_rates(frame, {-i.mass * on_j, i.moment * turn_i}, {j.mass * on_j, j.moment * turn_j});
    };
    double largest = 0;
    BondModes v{1, 1, 0.7};
    for (int sweep = 0; sweep < 2000; ++sweep) {
      v = applied(v);
      largest = std::hypot(std::hypot(v.normal, v.tangential), v.rolling);
      v = {v.normal / largest, v.tangential / largest, v.rolling / largest};
    }
    CAPTURE(k, largest);
    CHECK(largest_bond_rate(c, frame, i, j) == Approx(largest).epsilon(1e-6));
  }
}

TEST_CASE("a_step_below_the_limit_is_stable_and_one_above_is_not") {
  // semi-implicit Euler of one mode, dashpot at the start of the step
  const auto [rate, square] =
      GENERATE(std::pair{3.0, 0.0}, std::pair{0.0, 7.0}, std::pair{2.0, 7.0}, std::pair{9.0, 7.0});
  const auto growth = [rate = rate, square = square](double dt) {
    double q = 1, v = 0.5;
    for (int k = 0; k < 1000; ++k) {
      v -= dt * (square * q + rate * v);
      q += dt * v;
    }
    return square > 0 ? std::hypot(q, v) : std::abs(v);
  };
  const double limit = bond_step_limit(rate, square);
  CAPTURE(rate, square, limit, growth(0.99 * limit), growth(1.01 * limit));
  CHECK(growth(0.99 * limit) < 30);
  CHECK(growth(1.01 * limit) > 1e6);
}

TEST_CASE("the_limits_of_the_thesis_hold_for_two_equal_discs") {
  // dt < 2 m/C_n and dt < 2 m/(3 C_s), m the reduced mass
  const double mass = 0.8, radius = 0.3, c = 5;
  const InverseInertia disc{1 / mass, 2 / (mass * radius * radius)};
  const ContactFrame frame{{0, 1}, radius, radius};
  const double reduced = 0.5 * mass;
  CHECK(bond_step_limit(largest_bond_rate({c, 0, 0}, frame, disc, disc), 0) == Approx(2 * reduced / c));
  CHECK(bond_step_limit(largest_bond_rate({0, c, 0}, frame, disc, disc), 0) == Approx(2 * reduced / (3 * c)));
}
