// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A contact solved exactly over a step, with any number of beginnings and ends within it, and without, against the
/// exponential of its matrix in many more digits.
#include "equidem/contact/exact_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"

#include "contact/numbers.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using std::numbers::pi;

/// A pair that is stepped, with its energy and its losses.
struct Pair {
  ExactPair law;
  double u = 0, v = 0;
  bool touching = false;
  double lost = 0;  ///< in dashpot and released
  int beginnings = 0;

  ExactStep step(double h0, double h1) {
    const ExactStep s = exact_step(law, u, v, touching, h0, h1);
    const double m = law.reduced_mass, dt = law.step;
    u += v * dt - s.moment / m + h0 * dt * dt / 2 + h1 * dt * dt * dt / 6;
    v += h0 * dt + h1 * dt * dt / 2 - s.impulse / m;
    touching = s.touching_at_end;
    lost += s.loss + s.released;
    beginnings += s.beginnings;
    return s;
  }
  [[nodiscard]] double energy() const {
    return law.reduced_mass * v * v / 2 + (touching ? law.stiffness * u * u / 2 : 0);
  }
};

/// Runge and Kutta's rule of fourth order in small steps, ends and beginnings found by bisection: the truth, slowly.
struct Oracle {
  using Real = long double;
  struct State {
    Real u = 0, v = 0, impulse = 0, moment = 0, loss = 0;
  };
  Real w = 0, zeta = 0, h0 = 0, h1 = 0;
  bool at_zero_force = false;

  [[nodiscard]] State rate(const State& s, Real t, bool contact) const {
    const Real force = contact ? w * w * s.u + 2 * zeta * w * s.v : 0;
    return {s.v, h0 + h1 * t - force, force, s.impulse, contact ? 2 * zeta * w * s.v * s.v : 0};
  }
  static State along(const State& s, Real t, const State& r) {
    return {s.u + t * r.u, s.v + t * r.v, s.impulse + t * r.impulse, s.moment + t * r.moment, s.loss + t * r.loss};
  }
  [[nodiscard]] State small_step(const State& s, Real t, Real dt, bool contact) const {
    const State a = rate(s, t, contact), b = rate(along(s, dt / 2, a), t + dt / 2, contact);
    const State c = rate(along(s, dt / 2, b), t + dt / 2, contact), d = rate(along(s, dt, c), t + dt, contact);
    State mean = along(along(along(a, 2, b), 2, c), 1, d);
    return along(s, dt / 6, mean);
  }
  /// Whether a state belongs to the mode: contact with f >= 0, or flight without.
  [[nodiscard]] bool belongs(const State& s, bool contact) const {
    const bool holds = s.u > 0 && (!at_zero_force || w * s.u + 2 * zeta * s.v > 0);
    return holds == contact;
  }
  State run(State s, Real dt, int count) const {
    Real t = 0;
    bool contact = belongs(s, true);
    while (t < dt) {
      const Real step = std::min(dt / count, dt - t);
      State next = small_step(s, t, step, contact);
      if (belongs(next, contact)) {
        t = dt - t <= step ? dt : t + step;
      } else {
        Real low = 0, high = step;
        for (int i = 0; i < 64; ++i)
          (belongs(small_step(s, t, (low + high) / 2, contact), contact) ? low : high) = (low + high) / 2;
        next = small_step(s, t, high, contact);
        t += high;
        contact = !contact;
      }
      s = next;
    }
    return s;
  }
};

double log_uniform(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

const ContactEnd ends[] = {ContactEnd::at_zero_force, ContactEnd::at_zero_overlap};

}  // namespace

TEST_CASE("a_step_with_beginnings_and_ends_is_that_of_a_fine_integration") {
  Random random(41);
  int eventful = 0, twice = 0, resumed = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const ContactEnd end = ends[trial % 2];
    const double size = log_uniform(random, 0.01, 20);
    const double zeta = trial % 5 == 0 ? 0 : trial % 5 == 1 ? 1 : log_uniform(random, 1e-3, 5);
    const ExactPair law = exact_pair(1, size * size, zeta, end, 1);
    const double speed = std::min(1.0, size), push = log_uniform(random, 0.01, 100);
    double u = random.uniform(-0.5, 0.5), v = random.uniform(-1, 1) * (1 + push) * speed;
    const double h0 = push * random.uniform(-1, 1), h1 = 2 * push * random.uniform(-1, 1);
    if (trial % 7 == 0) u = -std::abs(u) / 10, v = std::abs(v);
    const Oracle oracle{law.frequency, zeta, h0, h1, end == ContactEnd::at_zero_force};
    const bool touching = oracle.belongs({u, v}, true);
    const ExactStep s = exact_step(law, u, v, touching, h0, h1);
    const Oracle::State truth = oracle.run({u, v}, 1, static_cast<int>(200 + 300 * size * (1 + 2 * zeta)));
    const double scale = std::abs(v) + std::abs(h0) + std::abs(h1) + size * std::abs(u);
    CAPTURE(trial, size, zeta, u, v, h0, h1, s.impulse, s.moment, s.loss, s.beginnings, s.released);
    CAPTURE(static_cast<double>(truth.impulse), static_cast<double>(truth.moment), static_cast<double>(truth.loss));
    CHECK(std::abs(s.impulse - static_cast<double>(truth.impulse)) < 1e-8 * scale);
    CHECK(std::abs(s.moment - static_cast<double>(truth.moment)) < 1e-8 * scale);
    CHECK(std::abs(s.loss - static_cast<double>(truth.loss)) < 1e-8 * scale * scale);
    eventful += s.beginnings > 0 || s.touching_at_end != touching;
    twice += s.beginnings > 1;
    resumed += s.beginnings > 0 && s.released < 0;
  }
  INFO("with events " << eventful << ", begun twice " << twice << ", resumed " << resumed);
  CHECK(eventful > 300);
  CHECK(twice > 5);
  CHECK(resumed > 5);
}

TEST_CASE("one_step_is_two_of_half_the_time") {
  Random random(17);
  for (int trial = 0; trial < 20000; ++trial) {
    const ContactEnd end = ends[trial % 2];
    const double size = log_uniform(random, 1e-3, 10), zeta = trial % 4 == 0 ? 0 : log_uniform(random, 1e-3, 10);
    const double h = 3 * random.uniform(-1, 1), h1 = trial % 3 == 0 ? 0 : random.uniform(-1, 1);
    Pair whole{exact_pair(1, size * size, zeta, end, 1), random.uniform(-1, 1), 3 * random.uniform(-1, 1)};
    whole.touching =
        whole.u > 0 && (end == ContactEnd::at_zero_overlap || zeta == 0 || size * whole.u + 2 * zeta * whole.v > 0);
    Pair parts = whole;
    parts.law = exact_pair(1, size * size, zeta, end, 0.5);
    const double before = whole.energy(), u = whole.u, v = whole.v;
    whole.step(h, h1);
    parts.step(h, h1);
    parts.step(h + h1 / 2, h1);
    CAPTURE(trial, size, zeta, h, h1, u, v, whole.u, parts.u, whole.v, parts.v, whole.lost, parts.lost, whole.touching);
    const double scale = 1 + size;
    REQUIRE(std::abs(whole.u - parts.u) < 1e-12 * scale);
    REQUIRE(std::abs(whole.v - parts.v) < 1e-12 * scale * scale);
    REQUIRE(std::abs(whole.lost - parts.lost) < 1e-11 * scale * scale * scale);
    REQUIRE(whole.beginnings == parts.beginnings);
    if (h1 != 0) continue;
    INFO("balance of energy");
    REQUIRE(std::abs(whole.energy() + whole.lost - before - h * (whole.u - u)) < 1e-12 * (1 + before) * scale);
  }
}

TEST_CASE("a_contact_at_rest_stays_at_rest") {
  const double zeta = GENERATE(0.0, 0.1, 3.0);
  const double size = GENERATE(1e-3, 0.2, 2.0, 50.0);
  const double h = 9.8;
  Pair pair{exact_pair(0.3, 0.3 * size * size, zeta, ContactEnd::at_zero_force, 1), h / (size * size)};
  pair.touching = true;
  const double rest = pair.u;
  double farthest = 0;
  for (int n = 0; n < 1000000; ++n) {
    pair.step(h, 0);
    farthest = std::max(farthest, std::abs(pair.u - rest));
  }
  CAPTURE(zeta, size, farthest / rest, pair.lost / pair.energy());
  CHECK(farthest < 1e-12 * rest * (1 + 1 / size));
  CHECK(pair.lost < 1e-20 * pair.energy() * (1 + 1 / size));
  CHECK(pair.touching);
}

TEST_CASE("a_step_of_more_events_than_are_followed_wins_no_energy") {
  Pair pair{exact_pair(1, 1e16, 0, ContactEnd::at_zero_overlap, 1), -1e-8, 0};
  const ExactStep s = pair.step(9.8, 0);
  CHECK(s.beginnings == 500);
  CHECK(pair.energy() - 9.8 * pair.u <= 9.8e-8 * (1 + 1e-9));
  CHECK(std::abs(pair.u) < 1e-7);
  CHECK(s.loss >= 0);
}

TEST_CASE("bodies_that_meet_without_speed_are_one_contact") {
  Random random(23);
  for (int trial = 0; trial < 2000; ++trial) {
    const double size = log_uniform(random, 1e-6, 100), zeta = trial % 2 == 0 ? 0 : log_uniform(random, 1e-3, 10);
    const ExactPair law = exact_pair(1, size * size, zeta, ends[trial / 2 % 2], 1);
    const double push = log_uniform(random, 1e-9, 1);
    CAPTURE(size, zeta, push);
    const ExactStep driven = exact_step(law, 0, 0, false, 0, push);
    CHECK(driven.beginnings == 1);
    CHECK(driven.touching_at_end);
    const ExactStep pulled_off = exact_step(law, 0, 0, false, push, -10);
    CHECK(pulled_off.beginnings == 1);
    CHECK(!pulled_off.touching_at_end);
    const ExactStep left_alone = exact_step(law, 0, 0, false, -push, 0);
    CHECK(left_alone.beginnings == 0);
    CHECK(left_alone.impulse == 0);
  }
}

TEST_CASE("a_contact_that_ended_resumes_only_with_what_it_has_left") {
  // parting under a strong push: the force ends, the bodies turn round while they overlap, the contact is taken up
  // again
  Pair pair{exact_pair(1, 1, 0.8, ContactEnd::at_zero_force, 0.01), 1, -0.7};
  pair.touching = false;
  const double before = pair.energy();
  double u = pair.u, work = 0;
  bool ended = false;
  for (int n = 0; n < 100; ++n) {
    pair.step(2, 0);
    work += 2 * (pair.u - u);
    u = pair.u;
    ended = ended || !pair.touching;
    CAPTURE(n, pair.u, pair.v, pair.touching);
    REQUIRE(pair.touching == (pair.u + 1.6 * pair.v >= 0));
    CHECK(pair.energy() + pair.lost == Approx(before + work).epsilon(1e-12));
  }
  CHECK(ended);
  CHECK(pair.touching);
  CHECK(pair.beginnings == 1);
}

TEST_CASE("contacts_coupled_by_impulse_and_moment_are_symplectic_and_of_fourth_order") {
  // all contacts alike: h0, h1 such that their impulse and moment over the step are -rho of the contact's own
  const double rho = GENERATE(0.25, 1.0, 2.0, 10.0);
  struct Map {
    double trace, determinant;
  };
  const auto map = [&](double size) {
    const ExactPair p = exact_pair(1, size * size, 0, ContactEnd::at_zero_overlap, 1);
    // [h0 + h1/2, h0/2 + h1/6] = -rho [J, M] = -rho (A [u, v] + B [h0, h1])
    const double a = 1 + rho * p.impulse[2], b = 0.5 + rho * p.impulse[3];
    const double c = 0.5 + rho * p.moment[2], d = 1.0 / 6 + rho * p.moment[3];
    double column[2][2];
    for (int k = 0; k < 2; ++k) {
      const double x = -rho * p.impulse[k], y = -rho * p.moment[k], det = a * d - b * c;
      const double h0 = (d * x - b * y) / det, h1 = (a * y - c * x) / det;
      const double u = k == 0, v = k == 1;
      column[k][0] =
          u + v - (p.moment[0] * u + p.moment[1] * v + p.moment[2] * h0 + p.moment[3] * h1) + h0 / 2 + h1 / 6;
      column[k][1] = v - (p.impulse[0] * u + p.impulse[1] * v + p.impulse[2] * h0 + p.impulse[3] * h1) + h0 + h1 / 2;
    }
    return Map{column[0][0] + column[1][1], column[0][0] * column[1][1] - column[0][1] * column[1][0]};
  };
  const auto frequency_error = [&](double size) {
    const double exact = size * std::sqrt(1 + rho);
    return 2 * std::asin(std::sqrt((2 - map(size).trace) / 4)) / exact - 1;
  };

  for (double size = 0.01; size < 3; size *= 1.1) CHECK(map(size).determinant == Approx(1).epsilon(1e-12));
  const double size = 0.1;
  CAPTURE(rho, frequency_error(size));
  CHECK(frequency_error(size) == Approx(-rho * (1 + rho) * std::pow(size, 4) / 1440).epsilon(0.01));

  const double half_period = pi / std::sqrt(1 + rho);
  double limit = 0.1;
  while (std::abs(map(limit).trace) <= 2) limit += 1e-4;
  CAPTURE(limit, half_period);
  CHECK(limit > half_period);
  CHECK(limit < 1.01 * half_period);
}

TEST_CASE("numbers_that_make_no_contact_are_refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto end = ContactEnd::at_zero_force;
  CHECK_THROWS_WITH(exact_pair(0, 1, 0, end, 1),
                    Catch::Contains("reduced mass of a contact is 0 kg (") && Catch::Contains("> 0"));
  CHECK_THROWS_AS(exact_pair(1, -1, 0, end, 1), Error);
  CHECK_THROWS_AS(exact_pair(1, 1, -0.1, end, 1), Error);
  CHECK_THROWS_AS(exact_pair(1, 1, nan, end, 1), Error);
  CHECK_THROWS_AS(exact_pair(1, 1, 0, end, nan), Error);
  CHECK_NOTHROW(exact_pair(1, 1, 0, end, 1));
}

namespace {

/// u, v, h, h1, impulse, moment, integral of u; dt = 1.
constexpr int states = 7;
using Matrix = std::array<std::array<Quad, states>, states>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int i = 0; i < states; ++i) {
    for (int k = 0; k < states; ++k) {
      if (a[i][k] == 0) continue;
      for (int j = 0; j < states; ++j) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}

/// Taylor's series of a small part of the time, squared again and again.
Matrix exponential(Matrix a) {
  Quad size = 1;
  for (const auto& row : a) {
    for (const Quad& x : row) size = std::max(size, x < 0 ? -x : x);
  }
  int squarings = 3;
  for (; size > 1; size /= 2) ++squarings;
  for (auto& row : a) {
    for (Quad& x : row) x /= static_cast<Quad>(std::ldexp(1.0, squarings));
  }
  Matrix sum{}, term{};
  for (int i = 0; i < states; ++i) sum[i][i] = term[i][i] = 1;
  for (int n = 1; n < 24; ++n) {
    term = product(term, a);
    for (int i = 0; i < states; ++i) {
      for (int j = 0; j < states; ++j) {
        term[i][j] /= n;
        sum[i][j] += term[i][j];
      }
    }
  }
  for (; squarings > 0; --squarings) sum = product(sum, sum);
  return sum;
}

Matrix contact_over_one_step(double frequency, double zeta) {
  const Quad w = frequency, c = 2 * static_cast<Quad>(zeta) * w;
  Matrix a{};
  a[0][1] = a[1][2] = a[2][3] = a[5][4] = a[6][0] = 1;
  a[1][0] = -w * w, a[1][1] = -c;
  a[4][0] = w * w, a[4][1] = c;
  return exponential(a);
}

const double dampings[] = {0,   1e-8,      1e-3,     0.1,      0.5, 0.9, 1 - 1e-3, 1 - 1e-8, 1 - 1e-12,
                           1.0, 1 + 1e-12, 1 + 1e-8, 1 + 1e-3, 1.1, 2,   10,       100,      1000};

}  // namespace

TEST_CASE("a_step_in_contact_is_exact_for_every_damping_and_stiffness") {
  Random random(5);
  for (const double zeta : dampings) {
    for (double w = 1e-8; w < 2000; w *= 3.7) {
      const ExactPair pair = exact_pair(1, w * w, zeta, ContactEnd::at_zero_force, 1);
      const Matrix exact = contact_over_one_step(pair.frequency, zeta);
      CAPTURE(zeta, w);
      for (int k = 0; k < 4; ++k) {
        const double impulse = static_cast<double>(exact[4][k]), moment = static_cast<double>(exact[5][k]);
        CAPTURE(k, pair.impulse[k], impulse, pair.moment[k], moment);
        // the response to an overlap swings about 0 where it rings on, and fades: as a part of its swing
        const double swing = std::max({std::abs(impulse), w * 1e-10, zeta < 1 ? w * std::exp(-zeta * w) : 0.0});
        const double error = std::abs(pair.impulse[k] - impulse) / (k == 0 ? swing : std::abs(impulse));
        REQUIRE(error < 2e-13);
        REQUIRE(std::abs(pair.moment[k] / moment - 1) < 2e-13);
      }
      if (zeta == 0) continue;
      for (int trial = 0; trial < 4; ++trial) {
        // the energy that is gone: with h = h0 + h1 t the outside force does h0 (u' - u) + h1 (u' dt - integral of u)
        double y[4];
        for (double& x : y) x = random.uniform(-1, 1);

        y[0] /= std::max(1.0, w);
        Quad end[states] = {};
        for (int i = 0; i < states; ++i) {
          for (int k = 0; k < 4; ++k) end[i] += exact[i][k] * static_cast<Quad>(y[k]);
        }
        const Quad u = y[0], v = y[1], ww = static_cast<Quad>(pair.frequency) * pair.frequency;
        const Quad gone = (v * v - end[1] * end[1] + ww * (u * u - end[0] * end[0])) / 2 + y[2] * (end[0] - u) +
                          y[3] * (end[0] - end[6]);
        const double b = static_cast<double>(y[2] - ww * u);
        const double* q = pair.loss;
        const double terms[] = {q[0] * y[1] * y[1], q[1] * b * b,       q[2] * y[3] * y[3],
                                q[3] * y[1] * b,    q[4] * y[1] * y[3], q[5] * b * y[3]};
        double loss = 0, size = 0;
        for (const double t : terms) loss += t, size += std::abs(t);
        CAPTURE(trial, size, (loss - static_cast<double>(gone)) / size);
        REQUIRE(std::abs(loss - static_cast<double>(gone)) < 5e-13 * size);
      }
    }
  }
}

TEST_CASE("the_response_solves_its_equation") {
  const double zeta = GENERATE(0.0, 0.3, 1.0, 4.0, 300.0);
  for (double x = 1e-6; x < 1e3; x *= 3) {
    const Response r = response(zeta, x);
    CAPTURE(zeta, x, r.slope, r.g[0], r.g[1], r.g[2], r.g[3], r.g[4]);
    CHECK(r.slope + 2 * zeta * r.g[0] + r.g[1] == Approx(1).epsilon(1e-13));
    double power = x;  // x^(k+1)/(k+1)!
    for (int k = 0; k < 3; ++k) {
      CHECK(r.g[k + 2] + 2 * zeta * r.g[k + 1] + r.g[k] == Approx(power).epsilon(1e-13));
      power *= x / (k + 2);
    }
  }
}
