// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dashpots between two discs: their change of the rates in a step, and the limit of the step.
#include <array>
#include <cmath>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/core/random.hpp"

#include "support/bond_rates.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

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
