// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers of two doubles against those of 113 bits.
#include "equidem/statics/breaking/kernels/twofold.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

__extension__ using Wide = __float128;

Wide wide(const Twofold<double>& a) {
  return static_cast<Wide>(a.high) + a.low;
}

double off(const Twofold<double>& found, Wide truth, Wide scale) {
  const Wide error = (wide(found) - truth) / scale;
  return std::abs(static_cast<double>(error));
}

Twofold<double> random_twofold(Random& random) {
  const double high = random.uniform(-1, 1) * std::pow(2, std::floor(random.uniform(-20, 20)));
  return twofold::sum(high, high * random.uniform(-1, 1) * 0x1p-54);
}

}  // namespace

TEST_CASE("numbers_of_two_doubles_are_right_to_a_hundred_bits") {
  Random random(7);
  double sums = 0, products = 0, scaled = 0, inverses = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Twofold<double> a = random_twofold(random), b = random_twofold(random);
    // a sum loses what cancels: its error is relative to the larger number
    const Wide larger = std::max(std::abs(a.high), std::abs(b.high));
    sums = std::max({sums, off(a + b, wide(a) + wide(b), larger), off(a - b, wide(a) - wide(b), larger)});
    products = std::max(products, off(a * b, wide(a) * wide(b), wide(a) * wide(b)));
    scaled = std::max(scaled, off(a * b.high, wide(a) * b.high, wide(a) * b.high));
    inverses = std::max(inverses, off(inverse(a.high), 1 / static_cast<Wide>(a.high), 1 / static_cast<Wide>(a.high)));
  }
  CAPTURE(sums, products, scaled, inverses);
  CHECK(sums < 0x1p-100);
  CHECK(products < 0x1p-100);
  CHECK(scaled < 0x1p-100);
  CHECK(inverses < 0x1p-100);
}

TEST_CASE("sums_and_products_of_two_doubles_are_exact") {
  Random random(8);
  for (int trial = 0; trial < 20000; ++trial) {
    const double a = random_twofold(random).high, b = random_twofold(random).high;
    const Twofold<double> sum = twofold::sum(a, b), product = twofold::product(a, b);
    CAPTURE(a, b);
    CHECK(wide(sum) == static_cast<Wide>(a) + b);
    CHECK(wide(product) == static_cast<Wide>(a) * b);
  }
}
