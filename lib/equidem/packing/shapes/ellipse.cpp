// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/packing_shape.hpp"

namespace equidem {

UnitBody unit_ellipse(const PackingShape& shape) {
  const double aspect = shape.aspect;
  constexpr double longest = 1000;
  if (!(aspect >= 1 && aspect <= longest)) {
    bad_input(fmt::format("the aspect of the ellipses is {}", aspect),
              fmt::format("it is the long half-axis over the short one, from 1 to {}", longest), "Correct it");
  }
  const double a = std::sqrt(aspect), b = 1 / a;
  return {.a = a,
          .b = b,
          .reach = a,
          .lever = lever_of(a - b, a),
          .area = std::numbers::pi,
          .gyration = 0.25 * (a * a + b * b)};
}

}  // namespace equidem
