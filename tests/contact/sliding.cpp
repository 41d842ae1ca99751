// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Friction in one step: Coulomb's limit, and the energy of spring and bodies together.
#include "equidem/contact/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/random.hpp"

#include "contact/numbers.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A contact, its state and what acts on it, of any size and sign.
struct Trial {
  Sliding law;
  double stretch, velocity, mass, normal_force, step;
};
Trial random_trial(Random& random, bool dashpot) {
  Trial t{};
  t.law = {magnitude(3, random), dashpot ? magnitude(3, random) : 0, random.below(4) == 0 ? 0 : magnitude(1, random)};
  t.stretch = random.uniform(-1, 1) * magnitude(1, random);
  t.velocity = random.uniform(-1, 1) * magnitude(1, random);
  t.mass = magnitude(2, random);
  t.normal_force = random.uniform(-0.2, 1) * magnitude(3, random);
  t.step = magnitude(1, random);
  return t;
}

/// A step with the mean force on the body whose slip velocity is given.
struct Resisted : SlidingStep<double> {
  double force = 0;
};

Resisted by_midpoint_rule(const Sliding& law, double stretch, double velocity, double inverse_mass, double normal_force,
                          double step) {
  const SlidingStep<double> found = slide(law, stretch, velocity, inverse_mass, normal_force * step, step);
  return {found, -found.impulse / step};
}

/// With the force of the step before equal to this one, so that the losses are those at the velocity given.
Resisted explicitly(const Sliding& law, double stretch, double velocity, double normal_force, double step) {
  using simd::One;
  const auto of = [&](double impulse_before) {
    return CoulombSpring::step<true, false>(sliding_law(One{law.coefficient}, One{law.stiffness}, step),
                                            One{law.dashpot * step}, One{stretch}, One{velocity}, One{velocity}, One{},
                                            One{impulse_before},
                                            One{law.coefficient * std::max(normal_force, 0.0) * step}, step);
  };
  const auto found = of(-of(0).impulse[0]);
  return {{found.impulse[0], found.stretch[0], found.slip_loss[0], found.dashpot_loss[0], found.slides[0] != 0},
          -found.impulse[0] / step};
}

double spring_energy(const Sliding& law, double stretch) {
  return law.stiffness * stretch * stretch / 2;
}

}  // namespace

TEST_CASE("the_midpoint_step_loses_what_it_says_and_never_gains") {
  const bool dashpot = GENERATE(false, true);
  Random random(1);
  int sticking = 0, sliding = 0;
  double worst = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Trial t = random_trial(random, dashpot);
    const Resisted step = by_midpoint_rule(t.law, t.stretch, t.velocity, 1 / t.mass, t.normal_force, t.step);
    const double after = t.velocity + step.force * t.step / t.mass;
    const double before_energy = t.mass * t.velocity * t.velocity / 2 + spring_energy(t.law, t.stretch);
    const double after_energy = t.mass * after * after / 2 + spring_energy(t.law, step.stretch);
    const double loss = step.slip_loss + step.dashpot_loss;
    // The change of the velocity may be much larger than the velocity: rounding is that of its energy.
    const double change = step.force * t.step / t.mass;
    // A stiff spring takes the mean velocity as a difference of the velocity: the stretch is rounded by that of v dt.
    const double way = std::abs(t.velocity) * t.step;
    const double size = before_energy + after_energy + t.mass * change * change + std::abs(loss) +
                        t.law.stiffness * (std::abs(t.stretch) + std::abs(step.stretch)) * way;
    worst = std::max(worst, std::abs(before_energy - after_energy - loss) / size);
    const double yield = t.law.coefficient * std::max(t.normal_force, 0.0);
    const double mean = t.velocity + change / 2;
    CAPTURE(dashpot, t.law.stiffness, t.law.dashpot, t.law.coefficient, t.stretch, t.velocity, t.mass, t.normal_force,
            t.step);
    CAPTURE(step.slides, step.force, step.stretch, step.slip_loss, step.dashpot_loss, before_energy, after_energy);
    const double round_off = 64 * epsilon * size;
    REQUIRE(std::abs(before_energy - after_energy - loss) <= round_off);
    REQUIRE(step.slip_loss >= -round_off);
    REQUIRE(step.dashpot_loss >= 0);
    REQUIRE(std::abs(step.force) <= yield + 4 * epsilon * yield);
    if (step.slides) {
      REQUIRE(t.law.stiffness * std::abs(step.stretch) <= yield * (1 + 2 * epsilon));
    } else {
      REQUIRE(step.slip_loss == 0);
      REQUIRE(std::abs(step.stretch - (t.stretch + mean * t.step)) <=
              1e-9 * (std::abs(t.stretch) + std::abs(t.velocity) * t.step));
    }
    (step.slides ? sliding : sticking) += 1;
  }
  CAPTURE(sticking, sliding, worst);
  CHECK(sticking > 1000);
  CHECK(sliding > 1000);
}

TEST_CASE("a_contact_that_sticks_swings_for_ever") {
  const Sliding law{.stiffness = 50, .coefficient = 1};
  const double mass = 0.3, step = GENERATE(1e-3, 0.05, 1.0);  // the last: far beyond the limit of explicit schemes
  double stretch = 0, velocity = 1;
  const double energy = mass / 2;
  double largest = 0;
  constexpr int steps = 100000;
  for (int i = 0; i < steps; ++i) {
    const Resisted result = by_midpoint_rule(law, stretch, velocity, 1 / mass, 1e6, step);
    REQUIRE_FALSE(result.slides);
    stretch = result.stretch;
    velocity += result.force * step / mass;
    largest = std::max(largest, std::abs(mass * velocity * velocity / 2 + spring_energy(law, stretch) - energy));
  }
  CAPTURE(step, largest / energy);
  CHECK(largest < steps * epsilon * energy);
}

TEST_CASE("a_body_that_slides_slows_by_mu_N_and_stops_on_its_spring") {
  const double mass = 2, normal_force = 5, mu = 0.4, start = 3, stiffness = 1e4;
  const double stop = mass * start / (mu * normal_force);
  const bool verlet = GENERATE(true, false);
  const Sliding law{.stiffness = stiffness, .coefficient = mu};
  const double step = 1e-4;
  double stretch = 0, velocity = start, travelled = 0, lost = 0;
  double at_half = 0;
  for (long i = 0; i < std::lround(1.5 * stop / step); ++i) {
    const Resisted result = verlet ? explicitly(law, stretch, velocity, normal_force, step)
                                   : by_midpoint_rule(law, stretch, velocity, 1 / mass, normal_force, step);
    stretch = result.stretch;
    lost += result.slip_loss;
    velocity += result.force * step / mass;
    travelled += velocity * step;
    if (i == std::lround(stop / step) / 2) at_half = velocity;
  }
  CAPTURE(verlet, travelled, lost, velocity, at_half);
  CHECK(at_half == Approx(start / 2).epsilon(1e-3));
  CHECK(travelled == Approx(start * stop / 2).epsilon(1e-3));
  // The spring keeps (mu N)²/2k and swings with it.
  const double kept = mu * mu * normal_force * normal_force / (2 * stiffness);
  CHECK(lost + kept == Approx(mass * start * start / 2).epsilon(1e-3));
  CHECK(std::abs(velocity) <= std::sqrt(2 * kept / mass) * 1.1);
}

TEST_CASE("without_spring_and_dashpot_a_slip_stops_and_stays") {
  const Sliding law{.coefficient = 0.5};
  const double mass = 2, normal_force = 3, step = 0.1;
  double velocity = GENERATE(1.0, -0.31);
  const double whole = mass * velocity * velocity / 2, direction = std::copysign(1, velocity);
  double lost = 0;
  for (int i = 0; i < 40; ++i) {
    const Resisted result = by_midpoint_rule(law, 0, velocity, 1 / mass, normal_force, step);
    CHECK(result.slides);
    CHECK(result.stretch == 0);
    const double after = velocity + result.force * step / mass;
    CHECK(after * direction >= 0);
    CHECK(std::abs(velocity - after) <= 0.5 * normal_force * step / mass * (1 + 4 * epsilon));
    velocity = after;
    lost += result.slip_loss;
  }
  CHECK(velocity == 0);
  CHECK(lost == Approx(whole).epsilon(1e-14));
}

TEST_CASE("a_steady_push_below_the_limit_leaves_a_slip_of_half_a_step") {
  const Sliding law{.coefficient = 0.5};
  const double mass = 2, normal_force = 3, push = 0.7 * 1.5, g = push / mass;
  for (const double step : {0.1, 0.01}) {
    double velocity = 0;
    for (int i = 0; i < 1000; ++i) {
      const double middle = velocity + g * step / 2;
      velocity += g * step + by_midpoint_rule(law, 0, middle, 1 / mass, normal_force, step).force * step / mass;
    }
    CAPTURE(step, velocity);
    CHECK(velocity == Approx(g * step / 2).epsilon(1e-12));
  }
}

TEST_CASE("the_explicit_step_is_the_printed_one") {  // Sukegawa (2.9)-(2.16)
  Random random(2);
  int sticking = 0, sliding = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Trial t = random_trial(random, true);
    const Resisted step = explicitly(t.law, t.stretch, t.velocity, t.normal_force, t.step);
    const double yield = t.law.coefficient * std::max(t.normal_force, 0.0);
    const double spring = t.law.stiffness * (t.stretch + t.velocity * t.step), dashpot = t.law.dashpot * t.velocity;
    const double expected = std::clamp(spring + dashpot, -yield, yield);
    CAPTURE(t.law.stiffness, t.law.dashpot, yield, t.stretch, t.velocity, t.step, step.force, expected, step.slides);
    REQUIRE(std::abs(step.force + expected) <= 8 * epsilon * (std::abs(spring) + std::abs(dashpot)));
    const double work = -step.force * t.velocity * t.step;
    const double round_off = 64 * epsilon *
                             (std::abs(work) + spring_energy(t.law, t.stretch) +
                              std::abs(spring * t.velocity) * t.step + std::abs(dashpot * t.velocity) * t.step);
    REQUIRE(step.slip_loss >= -round_off);
    REQUIRE(step.dashpot_loss >= 0);
    if (step.slides) {
      const double stored = spring_energy(t.law, step.stretch) - spring_energy(t.law, t.stretch);
      REQUIRE(std::abs(work - stored - step.slip_loss - step.dashpot_loss) <= round_off);
    }
    (step.slides ? sliding : sticking) += 1;
  }
  CHECK(sticking > 1000);
  CHECK(sliding > 1000);
}

TEST_CASE("several_contacts_slide_as_each_of_them_alone") {
  Random random(3);
  using simd::Four;
  using simd::One;
  for (int trial = 0; trial < 2000; ++trial) {
    double law[3][4], state[5][4];
    for (std::size_t k = 0; k < 4; ++k) {
      const Trial t = random_trial(random, true);
      const double numbers[] = {t.law.coefficient, t.law.stiffness, t.law.dashpot},
                   of_state[] = {t.stretch, t.velocity, 0.5 / t.mass, t.normal_force, random.uniform(-1, 1)};
      for (std::size_t c = 0; c < 3; ++c) law[c][k] = numbers[c];
      for (std::size_t c = 0; c < 5; ++c) state[c][k] = of_state[c];
    }
    const double dt = magnitude(1, random);
    const auto by = [&]<class Number>(std::size_t k, auto scheme) {
      const auto at = [&](const double(&column)[4]) { return simd::load<Number>(column + k); };
      const Number yield = at(law[0]) * simd::larger(at(state[3]), Number{});
      return CoulombSpring::step<decltype(scheme)::value, false>(sliding_law(at(law[0]), at(law[1]), dt), at(law[2]),
                                                                 at(state[0]), at(state[1]), at(state[1]), at(state[2]),
                                                                 at(state[4]), yield, dt);
    };
    const auto compare = [&](auto scheme) {
      const auto all = by.template operator()<Four>(0, scheme);
      for (std::size_t k = 0; k < 4; ++k) {
        const auto one = by.template operator()<One>(k, scheme);
        CAPTURE(trial, k, decltype(scheme)::value);
        REQUIRE(one.impulse[0] == all.impulse[k]);
        REQUIRE(one.stretch[0] == all.stretch[k]);
        REQUIRE(one.slip_loss[0] == all.slip_loss[k]);
        REQUIRE(one.dashpot_loss[0] == all.dashpot_loss[k]);
        REQUIRE(one.slides[0] == all.slides[k]);
      }
    };
    compare(std::false_type());
    compare(std::true_type());
  }
}

TEST_CASE("no_friction_without_a_coefficient_or_a_pushing_normal_force") {
  for (const bool pulled : {false, true}) {
    const Sliding law{.stiffness = 10, .coefficient = pulled ? 0.5 : 0.0};
    const double normal_force = pulled ? -2 : 2;
    for (const Resisted& step :
         {explicitly(law, 0.1, 1, normal_force, 0.01), by_midpoint_rule(law, 0.1, 1, 1.0 / 3, normal_force, 0.01)}) {
      CHECK(step.force == 0);
      CHECK(step.stretch == 0);
      CHECK(step.slip_loss == Approx(10 * 0.1 * 0.1 / 2));  // what the spring held
      CHECK(step.slides);
    }
  }
}
