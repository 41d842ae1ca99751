// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/shaking.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using std::numbers::pi;

double speed(const Schedule& s, double t, double h = 1e-6) {
  return (s.at(t + h) - s.at(t - h)) / (2 * h);
}
double acceleration(const Schedule& s, double t, double h = 1e-4) {
  return (s.at(t + h) - 2 * s.at(t) + s.at(t - h)) / (h * h);
}

/// Of an earthquake nothing but its look: bursts that do not add up to zero.
struct Record {
  std::vector<double> times, values;
  Record() {
    Random random(5);
    for (int k = 0; k <= 200; ++k) {
      times.push_back(2 + 0.01 * k + (k > 0 && k < 200 ? 0.004 * random.uniform() : 0));
      values.push_back(std::sin(0.016 * k) * random.uniform(-3, 4));
    }
  }
  [[nodiscard]] double at(double time) const {
    const Schedule linear{.kind = Schedule::Kind::table, .times = times, .values = values};
    return linear.at(time);
  }
};

}  // namespace

TEST_CASE("the_box_has_the_acceleration_asked_for_in_gal_and_in_si") {
  for (const double wanted : {400 * gal, 4.0, 0.5 * standard_gravity}) {
    const Schedule s = harmonic_shaking(wanted, 10, 0.3, 5);
    double most = 0;
    for (double t = 0.301; t < 0.799; t += 0.001) {
      CAPTURE(wanted, t);
      CHECK(acceleration(s, t) == Approx(wanted * std::cos(20 * pi * (t - 0.3))).margin(2e-5 * wanted));
      most = std::max(most, std::abs(acceleration(s, t)));
    }
    CHECK(most == Approx(wanted).epsilon(1e-4));
    CHECK(s.at(0.3) == 0);
    CHECK(s.at(1) == 0);
    for (const double end : {0.3, 0.8}) CHECK(std::abs(speed(s, end)) < 1e-5 * wanted);
  }
  CHECK(400 * gal == 4);
}

TEST_CASE("a_recorded_acceleration_is_that_of_the_box_but_for_the_straight_line_taken_away") {
  const Record record;
  for (const Baseline baseline : {Baseline::velocity, Baseline::rest}) {
    CAPTURE(static_cast<int>(baseline));
    const GroundMotion motion = integrate_motion(record.times, record.values, 0.5, baseline);
    const Schedule& s = motion.displacement;
    CHECK(s.at(0) == 0);
    CHECK(std::abs(speed(s, 0.5)) < 1e-4);
    CHECK(std::abs(speed(s, 2.5)) < 1e-4);
    CHECK(s.at(9) == motion.final_displacement);
    if (baseline == Baseline::rest) {
      CHECK(std::abs(motion.final_displacement) < 1e-12 * motion.peak_displacement);
    } else {
      CHECK(std::abs(motion.final_displacement) > 1e-3 * motion.peak_displacement);
    }
    // What is left of the record is a straight line, no steeper than the correction told.
    const auto taken = [&](double t) { return record.at(t + 1.5) - acceleration(s, t, 1e-4); };
    const double first = taken(0.505), last = taken(2.495);
    double peak = 0;
    for (std::size_t k = 0; k + 1 < record.times.size(); ++k) {
      const double t = 0.5 * (record.times[k] + record.times[k + 1]) - 1.5;  // no bend within the difference
      const double straight = first + (last - first) * (t - 0.505) / 1.99;
      CAPTURE(k, t);
      CHECK(taken(t) == Approx(straight).margin(2e-4));
      CHECK(std::abs(taken(t)) <= motion.correction + 2e-4);
    }
    for (double t = 0.5; t < 2.5; t += 1e-4) peak = std::max(peak, std::abs(speed(s, t, 1e-5)));
    CHECK(motion.peak_velocity == Approx(peak).epsilon(1e-3));
    CHECK(motion.correction > 0.01);
  }
}

TEST_CASE("a_record_that_ends_at_rest_in_place_is_not_corrected") {
  // One period of a triangle wave, then the other way round.
  const std::vector<double> times{0, 1, 3, 4, 5, 7, 8}, values{0, 1, -1, 0, -1, 1, 0};
  const GroundMotion motion = integrate_motion(times, values, 0, Baseline::rest);
  CHECK(motion.correction < 1e-15);
  CHECK(motion.peak_acceleration == Approx(1));
  CHECK(motion.peak_velocity == Approx(1));
  CHECK(motion.peak_displacement == Approx(2));  // 1/6 + 1/2 and so on: the area under a parabola
}

TEST_CASE("a_recorded_displacement_is_followed_through_its_points_with_continuous_acceleration") {
  std::vector<double> times, values;
  for (int k = 0; k <= 80; ++k) {
    times.push_back(0.025 * k);
    values.push_back(0.3 + 0.01 * (1 - std::cos(2 * pi * times.back())));
  }
  const GroundMotion motion = follow_motion(times, values, 1);
  const Schedule& s = motion.displacement;
  double worst = 0, jump = 0;
  for (double t = 1; t < 3; t += 0.001)
    worst = std::max(worst, std::abs(s.at(t) - 0.01 * (1 - std::cos(2 * pi * (t - 1)))));
  for (std::size_t k = 1; k + 1 < times.size(); ++k) {
    const double at = s.times[k];
    CHECK(s.at(at) == Approx(values[k] - 0.3).margin(1e-15));
    jump = std::max(jump, std::abs(acceleration(s, at + 2e-4) - acceleration(s, at - 2e-4)));
  }
  CAPTURE(worst, jump);
  CHECK(worst < 1e-6 * 0.02 * 5);  // (pi h)^4/384 of the amplitude and less
  CHECK(jump < 2 * 4e-4 * 0.01 * std::pow(2 * pi, 3));
  CHECK(motion.peak_acceleration == Approx(0.01 * 4 * pi * pi).epsilon(0.01));
}

TEST_CASE("records_that_say_nothing_are_refused") {
  const std::vector<double> one{0}, two{0, 1}, back{1, 0};
  const std::vector<double> rest{1, -1};
  CHECK_THROWS_AS(integrate_motion(one, one, 0, Baseline::rest), Error);
  CHECK_THROWS_AS(integrate_motion(back, rest, 0, Baseline::rest), Error);
  CHECK_NOTHROW(integrate_motion(two, rest, 0, Baseline::rest));
  CHECK_THROWS_AS(harmonic_shaking(4, 0, 0, 5), Error);
  CHECK_THROWS_AS(harmonic_shaking(4, 10, 0, 0), Error);
  std::vector<Wall> walls{line("floor", {}, {0, 1})};
  shake(walls, {1, 0}, harmonic_shaking(4, 10, 0, 5));
  CHECK(walls[0].moves());
  CHECK_FALSE(walls[0].move_y.changes());
  CHECK_THROWS_AS(shake(walls, {1, 0}, harmonic_shaking(4, 10, 0, 5)), Error);
}

TEST_CASE("a_grain_that_friction_holds_follows_the_box_and_one_that_it_cannot_hold_stays_behind") {
  // Tangential springs hold while mu g > a (a block, not a roller: the spin meets a moment of inertia beyond all).
  for (const double acceleration : {2.0, 8.0}) {
    Grain block = ball({0, 0.01}, 0.01, {}, 0.5);
    block.inertia.moment = 1e6;
    PairProperties pair;
    pair.stiffness = 1e6;
    pair.restitution = 0.2;
    pair.friction = 0.5;
    pair.tangential_ratio = 0.5;
    pair.tangential_damping = 0.3;
    std::vector<Wall> walls{line("floor", {}, {0, 1})};
    shake(walls, {1, 0}, harmonic_shaking(acceleration, 5, 0.1, 4));
    GrainSimulation simulation(scene_of({block}, walls, pair, {0, -9.81}), options_of(NormalLaw::exact_flow, 2e-5));
    double behind = 0;
    while (simulation.time() < 1) {
      simulation.advance(100);
      behind = std::max(behind, std::abs(simulation.grains()[0].position.x - walls[0].move_x.at(simulation.time())));
    }
    CAPTURE(acceleration, behind);
    if (acceleration < 0.5 * 9.81) {
      CHECK(behind < 1e-5);
    } else {
      CHECK(behind > 1e-3);
    }
  }
}
