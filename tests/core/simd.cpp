// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Root, angles and the short series of the loop against the standard library.

#include "equidem/core/simd.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"

namespace equidem::simd {
namespace {

using std::numbers::pi;
using Lanes = Four;
using Real = long double;

/// |value - truth| in units of the last place of the truth.
double ulps(double value, Real truth) {
  const double size = std::abs(static_cast<double>(truth));
  const double ulp = std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
  return static_cast<double>(std::abs(value - truth) / ulp);
}

using Drawn = std::array<double, 4>;

Drawn draw(Random& random, double low, double high) {
  Drawn x;
  for (double& value : x) value = random.uniform(low, high);
  return x;
}

/// Numbers of either sign and all sizes from 1e-15 to 1.
Drawn draw_sizes(Random& random) {
  Drawn x;
  for (double& value : x) value = std::pow(10, random.uniform(-15, 0)) * (random.uniform() < 0.5 ? -1 : 1);
  return x;
}

/// The largest error(x, f(x)) over many draws; f takes lanes and writes lanes.
template <typename Draw, typename Function, typename Error>
double worst_over(Draw draw_input, Function f, Error error) {
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const Drawn x = draw_input();
    Lanes input, output;
    input = load<Lanes>(x.data());
    f(input, output);
    for (int lane = 0; lane < 4; ++lane) worst = std::max(worst, error(x[lane], output[lane]));
  }
  return worst;
}

}  // namespace

TEST_CASE("square_root_is_that_of_the_standard_library_to_the_bit") {
  Random random(1);
  const double wrong = worst_over([&] { return draw_sizes(random); },
                                  [](const Lanes& x, Lanes& root) { root = square_root(x * x * x * x); },
                                  [](double x, double root) { return root == std::sqrt(x * x * x * x) ? 0.0 : 1.0; });
  CHECK(wrong == 0);
}

TEST_CASE("angle_of_is_atan2_to_two_ulp_all_around") {
  Random random(2);
  double worst = 0;
  for (int k = 0; k < 40000; ++k) {
    const Drawn xs = k % 2 == 0 ? draw(random, -1, 1) : draw_sizes(random);
    const Drawn ys = k % 2 == 0 ? draw(random, -1, 1) : draw_sizes(random);
    const Lanes x = load<Lanes>(xs.data()), y = load<Lanes>(ys.data());
    const Lanes angle = angle_of(x, y);
    for (int lane = 0; lane < 4; ++lane) {
      worst = std::max(worst, ulps(angle[lane], std::atan2(static_cast<Real>(ys[lane]), static_cast<Real>(xs[lane]))));
    }
  }
  CAPTURE(worst);
  CHECK(worst < 2);
  const Lanes axes = angle_of(Lanes{1, 0, -1, 0}, Lanes{0, 1, 0, -1});
  CHECK(axes[0] == 0);
  CHECK(axes[1] == pi / 2);
  CHECK(axes[2] == pi);
  CHECK(axes[3] == -pi / 2);
  const Lanes nowhere = angle_of(Lanes{}, Lanes{});
  CHECK(nowhere[0] == 0);
}

TEST_CASE("whole_turns_are_taken_away") {
  Random random(3);
  for (const double size : {1.0, 1e3, 1e6}) {
    const double worst = worst_over(
        [&] { return draw(random, -size, size); },
        [](const Lanes& angle, Lanes& rest) { rest = without_whole_turns(angle); },
        [](double angle, double rest) {
          // Around the circle: just beside half a turn either end is right.
          const Real difference = std::remainder(rest - static_cast<Real>(angle), 2 * std::numbers::pi_v<Real>);
          return static_cast<double>(std::abs(difference)) + (std::abs(rest) > pi * (1 + 1e-9) ? 1 : 0);
        });
    CAPTURE(size, worst);
    CHECK(worst < 3e-16 * size);
  }
}

TEST_CASE("sine_and_versine_are_those_of_the_standard_library") {
  Random random(4);
  const auto sine = [](const Lanes& angle, Lanes& result) { result = sine_versine(angle).sine; };
  const auto versine = [](const Lanes& angle, Lanes& result) { result = sine_versine(angle).versine; };
  const auto true_sine = [](double angle) { return std::sin(static_cast<Real>(angle)); };
  const auto true_versine = [&](double angle) { return 2 * true_sine(angle / 2) * true_sine(angle / 2); };
  const auto worst = [&](double size, const auto& f, const auto& truth) {
    return worst_over([&] { return draw(random, -size, size); }, f,
                      [&](double x, double value) { return static_cast<double>(std::abs(value - truth(x))); });
  };
  // Whole turns are known to 1e-16 of the angle.
  for (const double size : {pi, 1000.0}) {
    const double of_sine = worst(size, sine, true_sine), of_versine = worst(size, versine, true_versine);
    CAPTURE(size, of_sine, of_versine);
    CHECK(of_sine < 5e-16 + 3e-16 * size);
    CHECK(of_versine < 5e-16 + 3e-16 * size);
  }
  // Small angles keep their digits.
  const auto in_ulps = [&](const auto& f, const auto& truth) {
    return worst_over([&] { return draw_sizes(random); }, f,
                      [&](double x, double value) { return ulps(value, truth(x)); });
  };
  const double of_sine = in_ulps(sine, true_sine), of_versine = in_ulps(versine, true_versine);
  CAPTURE(of_sine, of_versine);
  CHECK(of_sine < 6);
  CHECK(of_versine < 6);
}

TEST_CASE("short_series_hold_up_to_their_bounds") {
  Random random(5);
  for (const double size : {1e-6, 1.0}) {
    const double near = size / 64;
    const double arctangent =
        worst_over([&] { return draw(random, -near, near); },
                   [](const Lanes& t, Lanes& angle) { angle = small_arctangent(t, t * t); },
                   [](double t, double angle) { return ulps(angle, std::atan(static_cast<Real>(t))); });
    const double shortening = worst_over([&] { return draw(random, 0, near * near); },
                                         [](const Lanes& z, Lanes& q) { q = small_shortening(z); },
                                         [](double z, double q) {
                                           const Real root = std::sqrt(1 + static_cast<Real>(z));
                                           return ulps(q, 1 / (root * (1 + root)));  // without a difference
                                         });
    CAPTURE(size, arctangent, shortening);
    CHECK(arctangent < 1);
    CHECK(shortening < 2);
  }
}

TEST_CASE("numbers_in_two_vectors_give_the_same_bits_as_in_one") {
  using Halves = Twice<Two>;
  Random random(6);
  for (int k = 0; k < 1000; ++k) {
    const Drawn xs = draw_sizes(random), ys = draw_sizes(random);
    const Lanes x = load<Lanes>(xs.data()), y = load<Lanes>(ys.data());
    const Halves x_2 = load<Halves>(xs.data()), y_2 = load<Halves>(ys.data());
    Drawn one, two;
    store(angle_of(x, y), one.data());
    store(angle_of(x_2, y_2), two.data());
    CHECK(one == two);
    store(sine_versine(x).versine, one.data());
    store(sine_versine(x_2).versine, two.data());
    CHECK(one == two);
    store(choose(negative(x), y, square_root(magnitude(x))), one.data());
    store(choose(negative(x_2), y_2, square_root(magnitude(x_2))), two.data());
    CHECK(one == two);
  }
}

}  // namespace equidem::simd
