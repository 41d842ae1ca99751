// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

using std::numbers::pi;

Schedule ramp(double value, double start, double end) {
  return {.kind = Schedule::Kind::ramp, .value = value, .start = start, .end = end};
}
Schedule sine(double value, double start, double frequency) {
  return {.kind = Schedule::Kind::sine, .value = value, .start = start, .frequency = frequency};
}
Schedule table(std::vector<double> times, std::vector<double> values) {
  return {.kind = Schedule::Kind::table, .times = std::move(times), .values = std::move(values)};
}
Schedule cycles(double value, double start, double frequency, int count) {
  return {.kind = Schedule::Kind::cycles,
          .value = value,
          .start = start,
          .end = start + count / frequency,
          .frequency = frequency};
}
std::vector<Schedule> one_of_each() {
  return {Schedule{.value = 3}, ramp(-2, 0.5, 2.5), sine(0.7, 0.25, 3), table({0.5, 1, 3}, {1, -1, 4}),
          cycles(0.7, 0.25, 3, 4)};
}

std::string refusal(const Schedule& schedule) {
  try {
    check(schedule);
  } catch (const Error& error) {
    return error.kind() == ErrorKind::bad_input ? error.what() : "wrong kind";
  }
  return {};
}

}  // namespace

TEST_CASE("a_ramp_is_half_a_cosine_between_rest_and_rest") {
  const Schedule r = ramp(-2, 0.5, 2.5);
  double before = 0;
  for (double t = 0; t <= 3; t += 1.0 / 128) {
    CAPTURE(t);
    const double s = std::clamp((t - 0.5) / 2, 0.0, 1.0);
    CHECK(r.at(t) == Approx(-(1 - std::cos(pi * s))).epsilon(0).margin(2e-15));
    CHECK(r.at(t) <= before);
    before = r.at(t);
  }
  CHECK(r.at(2.5) == -2);
  // No jump in velocity: close to either end the motion left is that of a parabola.
  const double h = 1e-4;
  for (const double at : {0.5, 2.5}) {
    const double speed = (r.at(at + h) - r.at(at - h)) / (2 * h);
    CAPTURE(at, speed);
    CHECK(std::abs(speed) < pi * pi / 4 * h);
  }
}

TEST_CASE("a_sine_agrees_with_the_library_and_repeats_without_drift") {
  constexpr double start = 0.3125;  // 1.25 periods, exact in a double
  const Schedule s = sine(0.7, start, 4);
  Random random(1);
  double worst = 0;
  for (int k = 0; k < 10000; ++k) {
    const double t = start + 2 * random.uniform();
    worst = std::max(worst, std::abs(s.at(t) - 0.7 * std::sin(2 * pi * 4 * (t - start))));
  }
  CAPTURE(worst);
  CHECK(worst < 0.7 * 1e-14);
  CHECK(s.at(0) == 0);
  for (const double periods : {1.0, 1000.0, 1e9}) {
    CAPTURE(periods);
    CHECK(s.at(start + periods / 4) == 0);
    CHECK(s.at(start + (periods + 0.25) / 4) == Approx(0.7).epsilon(1e-15));
    CHECK(s.at(start + (periods + 0.75) / 4) == Approx(-0.7).epsilon(1e-15));
    CHECK(s.at(start + (periods + 1.0 / 12) / 4) == Approx(0.35).epsilon(1e-6));
  }
}

TEST_CASE("a_table_is_straight_between_its_points_and_constant_outside") {
  const Schedule t = table({0.5, 1, 3}, {1, -1, 4});
  CHECK(t.at(-1) == 1);
  CHECK(t.at(0.5) == 1);
  CHECK(t.at(0.75) == 0);
  CHECK(t.at(1) == -1);
  CHECK(t.at(2) == 1.5);
  CHECK(t.at(3) == 4);
  CHECK(t.at(1e9) == 4);
  CHECK(table({2}, {5}).at(0) == 5);
  CHECK(table({2}, {5}).at(3) == 5);
}

TEST_CASE("cycles_go_from_rest_to_rest_with_the_acceleration_of_a_cosine") {
  const Schedule s = cycles(0.7, 0.25, 4, 3);
  double worst = 0;
  for (double t = -0.1; t < 1.3; t += 1.0 / 512) {
    const bool inside = t > 0.25 && t < 1;
    worst = std::max(worst, std::abs(s.at(t) - (inside ? 0.7 * (1 - std::cos(8 * pi * (t - 0.25))) : 0)));
  }
  CAPTURE(worst);
  CHECK(worst < 1e-14);
  const double h = 1e-5;
  for (const double end : {0.25, 1.0}) {
    const double speed = (s.at(end + h) - s.at(end - h)) / (2 * h), most = 0.7 * 8 * pi;
    CAPTURE(end, speed);
    CHECK(std::abs(speed) < 1e-3 * most);
  }
}

TEST_CASE("a_scaled_schedule_is_the_factor_times_it_at_every_time") {
  for (const Schedule& schedule : one_of_each()) {
    CHECK(refusal(schedule).empty());
    const Schedule twice = scaled(schedule, -4);
    CHECK(scaled(schedule, 1) == schedule);
    CHECK_FALSE(twice == schedule);
    for (double time = -0.5; time < 4; time += 0.03125) {
      CAPTURE(static_cast<int>(schedule.kind), time);
      CHECK(twice.at(time) == -4 * schedule.at(time));
    }
  }
}

TEST_CASE("schedules_without_a_meaning_are_refused_with_the_number_at_fault") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  struct Bad {
    Schedule schedule;
    const char* word;
  };
  for (const Bad& bad : {
           Bad{Schedule{.value = nan}, "value of a schedule is nan"},
           Bad{ramp(inf, 0, 1), "value of a schedule is inf"},
           Bad{ramp(1, nan, 1), "start of a schedule is nan"},
           Bad{ramp(1, 0, inf), "end of a schedule is inf"},
           Bad{ramp(1, 2, 1), "ends at 1 s and starts at 2 s"},
           Bad{ramp(1, 2, 2), "ends at 2 s and starts at 2 s"},
           Bad{sine(1, 0, 0), "frequency of a schedule is 0 Hz"},
           Bad{sine(1, 0, -3), "frequency of a schedule is -3 Hz"},
           Bad{sine(1, 0, inf), "frequency of a schedule is inf Hz"},
           Bad{cycles(1, 0, -3, 1), "frequency of a schedule is -3 Hz"},
           Bad{{.kind = Schedule::Kind::cycles, .value = 1, .end = 1.25, .frequency = 2}, "2.5 cycles"},
           Bad{{.kind = Schedule::Kind::cycles, .value = 1, .start = 1, .end = 1, .frequency = 2}, "0 cycles"},
           Bad{table({}, {}), "0 times"},
           Bad{table({1, 2}, {1}), "2 times and 1 value"},
           Bad{table({1, 1}, {0, 1}), "the time 1 s comes after 1 s"},
           Bad{table({2, 1}, {0, 1}), "the time 1 s comes after 2 s"},
           Bad{table({1, nan}, {0, 1}), "time of a schedule is nan"},
           Bad{table({1, 2}, {0, inf}), "value of a schedule is inf"},
       }) {
    const std::string sentence = refusal(bad.schedule);
    CAPTURE(bad.word, sentence);
    CHECK(sentence.find(bad.word) != std::string::npos);
  }
}

TEST_CASE("an_event_that_returns_within_a_step_is_missed_and_a_jump_is_not") {
  const double h = 1e-3;
  const auto missed = [&](const Schedule& schedule) { return missed_event(schedule, h, 1); };
  CHECK(missed(table({0.01, 0.0102, 0.0104}, {0, 1, 0})).share == Approx(1).epsilon(1e-12));
  CHECK(missed(table({0.01, 0.0102, 0.0104}, {0, -2, 0})).time == 0.0102);
  CHECK(missed(table({0.0104, 0.0105}, {0, 1})).share == 0);
  CHECK(missed(ramp(1, 0.0104, 0.0105)).share == 0);
  CHECK(missed(Schedule{.value = 3}).share == 0);
  CHECK(missed(table({2, 2.0002, 2.0004}, {0, 1, 0})).share == 0);  // after the end
  CHECK(missed(sine(1, 2, 900)).share == 0);
  // A triangle of half width w whose peak is in the middle of a step loses h/2 of w.
  for (const double width : {2 * h, 5 * h, 50 * h}) {
    CAPTURE(width);
    CHECK(missed(table({0.1005 - width, 0.1005, 0.1005 + width}, {0, 1, 0})).share ==
          Approx(h / 2 / width).epsilon(1e-9));
  }
  CHECK(missed(sine(1, 0, 1000)).share == 1);
  CHECK(missed(sine(1, 0, 500)).share == 1);
  CHECK(missed(cycles(1, 0, 500, 4)).share == 1);
  CHECK(missed(cycles(1, 0, 10, 4)).share < 1e-3);
  CHECK(missed(sine(1, 0, 100)).share == Approx(1 - std::cos(0.1 * pi)).epsilon(1e-12));
}

TEST_CASE("rows_of_a_file_become_the_points_of_a_table") {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "equidem_points.csv";
  write_file(file, "time,value\n0,1\n# halfway\n2,5\n", true);
  Schedule table{.kind = Schedule::Kind::table};
  read_points(file, table, "value");
  CHECK(table.at(1) == 3);
  write_file(file, "time_ms;value_mm\n0;1000\n2000;5e3\n", true);
  Schedule in_mm{.kind = Schedule::Kind::table};
  read_points(file, in_mm, "value");
  CHECK(in_mm.at(1) == Approx(3).epsilon(1e-15));
  Schedule other{.kind = Schedule::Kind::table};
  CHECK_THROWS_WITH(read_points(file, other, "acceleration"), Catch::Contains("equidem_points.csv:1: "));
  std::filesystem::remove(file);
}
