// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Properties that every law of the list has. tests/laws runs these tests for a longer list as well.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/contact/laws/normal_law.hpp"

#include "support/catch.hpp"
#include "support/contact_steps.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Calls test(std::type_identity<Law>()) for the laws of a kind.
template <class Test>
void for_each_force_law(const Test& test) {
  for (const LawDescription& law : normal_laws()) {
    visit_law(law.law, [&]<class Law>(std::type_identity<Law> type) {
      if constexpr (Law::facts.kind == LawKind::force) test(type);
    });
  }
}

}  // namespace

TEST_CASE("the_force_of_a_spring_is_the_derivative_of_its_energy") {
  for_each_force_law([]<class Law>(std::type_identity<Law>) {
    for (const double depth : {1e-6, 0.01, 1.0, 30.0}) {
      const double k = 7e4, h = 1e-4 * depth;
      const double slope = (Law::facts.energy(k, depth + h) - Law::facts.energy(k, depth - h)) / (2 * h);
      CAPTURE(Law::facts.name, depth, slope, Law::spring(k, depth));
      CHECK(slope == Approx(Law::spring(k, depth)).epsilon(1e-7));
      CHECK(Law::spring(k, depth) == Approx(k * depth * Law::facts.length_factor(depth)).epsilon(1e-14));
      CHECK(Law::spring(k, depth) == Approx(k * std::pow(depth, Law::facts.spring_power)).epsilon(1e-14));
    }
  });
}

TEST_CASE("an_elastic_impact_turns_the_energy_of_motion_into_that_of_the_spring_and_back") {
  const double k = 3e3, m = 0.2, v = 1.7;
  for (const LawDescription& law : normal_laws()) {
    const ElasticImpact impact = law.elastic_impact(k, m, v);
    CAPTURE(law.name, impact.overlap, impact.force, impact.duration);
    CHECK(law.energy(k, impact.overlap) == Approx(m * v * v / 2).epsilon(1e-12));
    CHECK(impact.force == Approx(k * impact.overlap * law.length_factor(impact.overlap)).epsilon(1e-12));
    const double stiffness = law.stiffness_from_overlap(impact.overlap, v, m, 0);
    CHECK(stiffness == Approx(k).epsilon(1e-12));
  }
  for_each_force_law([&]<class Law>(std::type_identity<Law>) {
    const ElasticImpact impact = Law::facts.elastic_impact(k, m, v);
    const int steps = 20000;
    const double dt = impact.duration / steps;
    double depth = 0, closing = v;
    for (int n = 0; n < steps; ++n) {
      depth += 0.5 * dt * closing;
      closing -= dt / m * Law::spring(k, std::max(depth, 0.0));
      depth += 0.5 * dt * closing;
    }
    CAPTURE(Law::facts.name, depth / impact.overlap, closing / v);
    CHECK(std::abs(depth) < 1e-6 * impact.overlap);
    CHECK(closing == Approx(-v).epsilon(1e-6));
  });
}

TEST_CASE("a_law_with_a_dashpot_gives_the_restitution_asked_for") {
  for_each_force_law([]<class Law>(std::type_identity<Law>) {
    if (!Law::facts.has_dashpot) return;
    for (const double e : {0.2, 0.7, 0.95}) {
      for (const ContactEnd end : {ContactEnd::at_zero_overlap, ContactEnd::at_zero_force}) {
        const double dt = 1e-4, a = dt * dt, c = Law::facts.dissipation(e, end) * dt;
        double depth = 1e-12, closing = dt;
        while (depth > 0) {
          const ContactStep step = force_step<Law>(depth, closing, a, c, end == ContactEnd::at_zero_overlap);
          closing += step.change;
          depth += closing;
        }
        CAPTURE(Law::facts.name, e, to_string(end), -closing / dt);
        CHECK(-closing / dt == Approx(e).margin(1e-3));
      }
    }
  });
}
