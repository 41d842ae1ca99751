// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mass and moment of inertia against the integrals that define them.
#include "equidem/material/inertia.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;
using std::numbers::pi;

TEST_CASE("mass_and_moment_are_the_integrals_over_the_body") {
  // Cylindrical shells about the axis of rotation, 2 pi x times their height: 1 of the disc, 2 sqrt(r² - x²) of the
  // sphere. x = r sin t smooths the end.
  const Body body = GENERATE(Body::disc, Body::sphere);
  const double radius = GENERATE(0.005, 1.0, 112.5), density = GENERATE(1.0, 2480.0);
  double mass = 0, moment = 0;
  constexpr int shells = 4000;
  for (int k = 0; k < shells; ++k) {
    const double t = (k + 0.5) * pi / 2 / shells, x = radius * std::sin(t);
    const double height = body == Body::disc ? 1 : 2 * radius * std::cos(t);
    const double shell = density * 2 * pi * x * height * radius * std::cos(t) * (pi / 2 / shells);
    mass += shell;
    moment += shell * x * x;
  }
  const Inertia found = inertia_of(radius, density, body);
  CAPTURE(to_string(body), radius, density, mass, moment);
  CHECK(found.mass == Approx(mass).epsilon(1e-6));
  CHECK(found.moment == Approx(moment).epsilon(1e-6));
  CHECK(inertia_factor(body) == Approx(moment / (mass * radius * radius)).epsilon(1e-6));
}

TEST_CASE("mass_and_moment_of_an_ellipse_are_the_integrals_over_it") {
  const double a = GENERATE(0.01, 1.0, 20.0), b = GENERATE(0.01, 0.3, 1.0), density = GENERATE(1.0, 2480.0);
  double mass = 0, moment = 0;  // strips x = a sin t of height 2 b cos t
  constexpr int strips = 4000;
  for (int k = 0; k < strips; ++k) {
    const double t = -pi / 2 + (k + 0.5) * pi / strips, x = a * std::sin(t), half = b * std::cos(t);
    const double strip = density * 2 * half * a * std::cos(t) * pi / strips;
    mass += strip;
    moment += strip * (x * x + half * half / 3);
  }
  const Inertia found = inertia_of_ellipse(a, b, density);
  CAPTURE(a, b, density, mass, moment);
  CHECK(found.mass == Approx(mass).epsilon(1e-6));
  CHECK(found.moment == Approx(moment).epsilon(1e-6));
  const Inertia disc = inertia_of(a, density, Body::disc), round = inertia_of_ellipse(a, a, density);
  CHECK(round.mass == Approx(disc.mass).epsilon(1e-15));
  CHECK(round.moment == Approx(disc.moment).epsilon(1e-15));
  CHECK_THROWS_AS(inertia_of_ellipse(a, b, 0), Error);
}

TEST_CASE("every_disc_has_the_inertia_of_its_radius") {
  const std::vector<double> radii{0.5, 1, 2};
  for (const Body body : {Body::disc, Body::sphere}) {
    const std::vector<Inertia> all = inertia_of(radii, 3, body);
    REQUIRE(all.size() == radii.size());
    for (std::size_t d = 0; d < radii.size(); ++d) {
      CHECK(all[d].mass == inertia_of(radii[d], 3, body).mass);
      CHECK(all[d].moment == inertia_of(radii[d], 3, body).moment);
    }
  }
}

TEST_CASE("density_that_gives_no_mass_is_refused") {
  for (const double density : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CAPTURE(density);
    CHECK_THROWS_WITH(inertia_of(1, density, Body::disc), Catch::Contains("the density of the discs is"));
  }
}
