// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Double-double arithmetic against quadruple precision.

#include "equidem/core/double_double.hpp"

#include <algorithm>
#include <cmath>

#include "contact/numbers.hpp"
#include "support/catch.hpp"

namespace equidem {
namespace {

#ifdef __SIZEOF_FLOAT128__
using test::magnitude;
using test::Quad;

double draw(Random& random) {
  return magnitude(8, random) * (random.uniform() < 0.5 ? -1 : 1);
}

Quad wide(const DoubleDouble& x) {
  return Quad{x.high()} + Quad{x.low()};
}

double size(Quad x) {
  return std::abs(static_cast<double>(x));
}

/// Numbers that cancel in part or whole are among them.
DoubleDouble draw_pair(Random& random, const DoubleDouble& beside) {
  const double far = draw(random);
  const auto apart = DoubleDouble::sum(far, 0x1p-53 * draw(random));
  return random.uniform() < 0.3 ? -beside + 0x1p-60 * apart : apart;
}

TEST_CASE("sums_and_products_of_two_doubles_lose_nothing") {
  Random random(5);
  for (int k = 0; k < 20000; ++k) {
    const double a = draw(random), b = random.uniform() < 0.2 ? -a * (1 + 0x1p-50 * draw(random)) : draw(random);
    CAPTURE(a, b);
    const auto sum = DoubleDouble::sum(a, b), product = DoubleDouble::product(a, b);
    REQUIRE(sum.high() == a + b);
    REQUIRE(size(wide(sum) - (Quad{a} + Quad{b})) == 0);
    REQUIRE(product.high() == a * b);
    REQUIRE(size(wide(product) - Quad{a} * Quad{b}) == 0);
  }
}

TEST_CASE("operations_on_double_doubles_err_by_2^-104_of_what_enters") {
  Random random(6);
  double worst_sum = 0, worst_product = 0, worst_quotient = 0;
  for (int k = 0; k < 20000; ++k) {
    const DoubleDouble a = draw_pair(random, {}), b = draw_pair(random, a);
    const double c = draw(random);
    const auto largest = [](double& worst, double error) { worst = std::max(worst, 0x1p104 * error); };
    const double enters = size(wide(a)) + size(wide(b));
    largest(worst_sum, size(wide(a + b) - (wide(a) + wide(b))) / enters);
    largest(worst_sum, size(wide(a - b) - (wide(a) - wide(b))) / enters);
    largest(worst_product, size(wide(c * a) - Quad{c} * wide(a)) / size(Quad{c} * wide(a)));
    largest(worst_quotient, size(wide(a / c) - wide(a) / Quad{c}) / size(wide(a) / Quad{c}));
    for (const DoubleDouble& x : {a + b, c * a, a / c}) REQUIRE(x.high() == x.high() + x.low());
  }
  CAPTURE(worst_sum, worst_product, worst_quotient);
  CHECK(worst_sum < 1);
  CHECK(worst_product < 1);
  CHECK(worst_quotient < 1);
}
#endif

}  // namespace
}  // namespace equidem
