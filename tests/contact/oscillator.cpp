// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One step of a contact that neither begins nor ends, against the exponential of its matrix in many more digits.
#include <algorithm>
#include <array>
#include <cmath>

#include "equidem/contact/exact_contact.hpp"
#include "equidem/core/random.hpp"

#include "contact/numbers.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

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
