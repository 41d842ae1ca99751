// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The laws of normal contact, one body on a wall without gravity: against traces of an independent implementation,
/// against their own formulas in quadruple precision, and against their statements about the energy.

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "equidem/contact/restitution.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"

#include "contact/numbers.hpp"
#include "support/catch.hpp"
#include "support/contact_steps.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Quad root(Quad x) {
  if (x <= 0) return 0;
  Quad r = std::sqrt(static_cast<long double>(x));
  for (int i = 0; i < 3; ++i) r = (r + x / r) / 2;
  return r;
}

ContactStep map_step(NormalLaw law, double depth, double closing, double a, double e, bool first) {
  return step_of(law, depth, closing, a, e, ContactEnd::at_zero_overlap, first);
}

}  // namespace

TEST_CASE("each_law_follows_the_traces_of_the_independent_implementation") {
  nlohmann::json reference;
  std::ifstream(EQUIDEM_SOURCE_DIR "/data/reference/impact_traces.json") >> reference;
  REQUIRE(reference["traces"].size() >= 20);
  for (const auto& trace : reference["traces"]) {
    const std::string model = trace["model"];  // Pfix: P that leaves mode 2 by (23); P: the paper's letter, by (21)
    const double a = trace["a"], e = trace["e"];
    double depth = trace["path"][0]["d"], closing = trace["sigma0"];
    for (std::size_t i = 0; i < trace["path"].size(); ++i) {
      const auto& expected = trace["path"][i];
      CAPTURE(model, a, e, trace["s"].get<double>(), i, depth, closing);
      CHECK(std::abs(depth - expected["d"].get<double>()) < 1e-13);
      CHECK(std::abs(closing - expected["sigma"].get<double>()) < 1e-13);
      const NormalLaw law = model == "C"   ? NormalLaw::linear_dashpot
                            : model == "T" ? NormalLaw::hertz_dashpot
                            : model == "F" ? NormalLaw::five_case_map
                                           : NormalLaw::energy_map;
      const ContactStep step = step_of(law, depth, closing, a, e);
      const double corrected = depth + step.shift, after = closing + step.change;
      const double d_hat = expected["d_hat"], sigma_new = expected["sigma_new"];
      CAPTURE(step.mode, corrected, d_hat, after, sigma_new);
      CHECK(step.mode == (expected["mode"].is_null() ? 0 : expected["mode"].get<int>()));
      CHECK(std::abs(corrected - d_hat) < 1e-13);
      const bool leaves_by_21 = model == "P" && expected["mode"] == 2 && d_hat + sigma_new <= 0;
      const double wanted = leaves_by_21 ? -std::sqrt(closing * closing + a * depth * depth) : sigma_new;
      CHECK(std::abs(after - wanted) < 1e-13);
      closing = after;
      depth = corrected + after;
    }
    CHECK(depth <= 0);
  }
}

TEST_CASE("a_contact_without_restitution_stops_where_it_began") {
  for (const double a : {1e-12, 0.1, 1.0, 1e12}) {
    for (const double s : {1.0, 1.7, 1e9}) {
      const double sigma = 0.3, depth = sigma / s;
      const ContactStep step = step_of(NormalLaw::energy_map, depth, sigma, a, 0);
      CAPTURE(a, s, step.change, step.shift, step.loss);
      CHECK(sigma + step.change == 0);
      CHECK(depth + step.shift == 0);
      CHECK(step.loss == sigma * sigma / 2);
    }
  }
}

TEST_CASE("roots_of_the_maps_lose_no_digits") {
  Random random(2);
  std::array<int, 12> seen{};
  std::array<double, 12> worst{};
  for (int trial = 0; trial < 20000; ++trial) {
    const double a = magnitude(12, random);
    const double e = trial % 4 == 0 ? 1 - magnitude(15, random) * 1e-16 : random.uniform();
    const double depth = magnitude(6, random);
    const bool first = trial % 2 == 0;
    const double sign = !first && random.uniform() < 0.5 ? -1 : 1;
    const double slope = first       ? 1 + magnitude(12, random)
                         : trial % 3 ? sign * random.uniform()
                                     : sign * magnitude(12, random);
    const double closing = slope * depth;
    if (e < 0 || e > 1) continue;
    const Quad A = a, E = e, d = depth, sigma = closing, s = sigma / d;
    // The formulas as printed keep 32 digits of closing and depth in quadruple precision.
    const double floor = 1e-32 * (std::abs(closing) + depth);
    const auto compare = [&](int mode, double value, Quad exact, Quad condition) {
      const double error = std::abs(static_cast<double>(Quad(value) - exact));
      const double size = std::abs(value) * static_cast<double>(condition);
      const auto m = static_cast<std::size_t>(mode);
      ++seen[m];
      if (floor < 1e-3 * epsilon * size) worst[m] = std::max(worst[m], error / size);
      CAPTURE(a, e, depth, closing, first, mode, value, static_cast<double>(exact), error);
      if (!(error <= 8 * epsilon * size + floor)) CHECK(error == 0);
    };
    const ContactStep P = map_step(NormalLaw::energy_map, depth, closing, a, e, first);
    if (first) {
      const Quad f_hat = (s * E / root(s * s + A) - 1) * sigma, sigma_hat = sigma + f_hat, d_hat = sigma_hat / s;
      const Quad f20 = -d_hat / (1 + A) * ((1 + A) * s + A - root(A * A + (1 + A) * s * s));
      compare(P.mode, P.change, f_hat + f20, 1);
      compare(0, P.shift, d_hat - d, 1);
      const ContactStep F = map_step(NormalLaw::five_case_map, depth, closing, a, e, first);
      const Quad square = A * A * d * d - (1 + A) * (A * d * d - E * E * sigma * sigma);
      if (E * sigma >= d) {
        compare(F.mode, F.change, -(1 + E) * sigma, 1);
      } else if (square > 0) {
        compare(F.mode, F.change, (-A * d - root(square)) / (1 + A) - sigma,
                1 + (A * d * d + E * E * sigma * sigma) / square);
      }
    } else {
      const Quad f21 = -d / (1 + A) * ((1 + A) * s + A + root(A * A + (1 + A) * s * s));
      const Quad f23 = -d * (s + root(s * s + A));
      const bool stays = s * s < 1 - A;
      compare(P.mode, P.change, stays ? f21 : f23, 1);
      CHECK(P.mode == (s > 0 ? 2 : stays ? 3 : 4));
      CHECK((depth + closing + P.change > 0) == (stays || std::abs(static_cast<double>(f21 / d + s + 1)) < epsilon));
    }
  }
  for (const std::size_t mode : {0, 1, 2, 3, 4, 10, 11}) {  // 0: the shift
    CAPTURE(mode, seen[mode], worst[mode]);
    CHECK(seen[mode] > 100);
    CHECK(worst[mode] > 0);
  }
}

TEST_CASE("maps_are_continuous_where_their_modes_meet") {
  const double a = GENERATE(1e-9, 0.01, 0.1, 0.5, 0.99);
  const double near = 1e-12;
  const auto after = [&](double closing) {
    return closing + map_step(NormalLaw::energy_map, 1, closing, a, 0.7, false).change;
  };
  for (const double s : {0.0, std::sqrt(1 - a), -std::sqrt(1 - a)}) {
    CAPTURE(a, s, after(s - near), after(s + near));
    CHECK(std::abs(after(s + near) - after(s - near)) < 1e-11);
  }
  for (const double e : {0.75, 0.9, 0.99}) {
    if (e * e < a / (1 + a)) continue;
    const double depth = 1;
    const auto parting = [&](double closing) {
      return closing + map_step(NormalLaw::five_case_map, depth, closing, a, e, true).change;
    };
    CAPTURE(a, e);
    CHECK(step_of(NormalLaw::five_case_map, depth, (1 + near) / e, a, e).mode == 10);
    CHECK(step_of(NormalLaw::five_case_map, depth, (1 - near) / e, a, e).mode == 11);
    CHECK(std::abs(parting((1 + near) / e) - parting((1 - near) / e)) < 1e-11);
  }
}

TEST_CASE("nothing_overflows_or_divides_by_zero_at_the_edges") {
  const double a = GENERATE(1e-12, 0.5, 1.0, 1e12);
  for (const double depth : {5e-324, 1e-200, 1.0}) {
    for (const double closing : {-1.0, -1e-200, -5e-324, 0.0, 5e-324, 1e-200, 1.0}) {
      for (const bool first : {false, true}) {
        for (const double e : {0.0, 0.5, 1.0}) {
          const ContactStep step = map_step(NormalLaw::energy_map, depth, closing, a, e, first);
          CAPTURE(a, depth, closing, first, e, step.mode, step.change, step.shift);
          CHECK(std::isfinite(step.change));
          CHECK(std::isfinite(step.shift));
          CHECK(step.change <= 0);
        }
      }
    }
  }
}

TEST_CASE("the_five_cases_are_refused_where_they_have_no_answer") {
  for (const double a : {0.05, 0.1, 0.2, 0.5, 3.0}) {
    const double least = std::sqrt(a / (1 + a));
    CHECK_NOTHROW(laws::FiveCaseMap::check_range(a, least * (1 + 1e-12)));
    CHECK_NOTHROW(laws::FiveCaseMap::check_range(a, 1));
    CHECK_THROWS_WITH(laws::FiveCaseMap::check_range(a, 0.99 * least),
                      Catch::Contains("a/(1 + a)") && Catch::Contains("energy_map"));
    CHECK_THROWS_AS(laws::FiveCaseMap::check_range(a, 0), Error);
  }
  nlohmann::json reference;
  std::ifstream(EQUIDEM_SOURCE_DIR "/data/reference/impact_traces.json") >> reference;
  for (const auto& [a, least] : reference["F_min_e"].items()) {
    CHECK_NOTHROW(laws::FiveCaseMap::check_range(std::stod(a), least.get<double>() + 1e-15));
    CHECK_THROWS_AS(laws::FiveCaseMap::check_range(std::stod(a), least.get<double>() - 1e-12), Error);
  }
}

TEST_CASE("forces_of_contact_push_only_where_they_are_cut_at_zero") {
  Random random(3);
  int cut = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    const double depth = random.uniform(), closing = random.uniform(-1, 1), a = magnitude(2, random);
    const double dissipation = random.uniform(0, 4);
    const bool hertz = trial % 2;
    const auto step_with = [&](bool attraction) {
      const double c = dissipation * std::sqrt(a);
      return hertz ? force_step<laws::HertzDashpot>(depth, closing, a, c, attraction)
                   : force_step<laws::LinearDashpot>(depth, closing, a, c, attraction);
    };
    const ContactStep whole = step_with(true), pushing = step_with(false);
    CAPTURE(hertz, depth, closing, a, dissipation, whole.change, pushing.change);
    CHECK(pushing.change == std::min(whole.change, 0.0));
    CHECK(whole.loss >= 0);
    CHECK(pushing.loss >= 0);
    cut += whole.change > 0;
  }
  CHECK(cut > 500);
}

TEST_CASE("every_normal_law_has_a_name_and_a_letter_of_its_own") {
  std::set<std::string> names, letters;
  for (const LawDescription& law : normal_laws()) {
    CAPTURE(law.name);
    CHECK(enum_from<NormalLaw>(law.name) == law.law);
    CHECK(&describe(law.law) == &law);
    CHECK(names.insert(law.name).second);
    CHECK(letters.insert(std::string{law.letter}).second);
  }
  CHECK_THROWS_WITH(enum_from<NormalLaw>("hooke"), Catch::Contains("linear_dashpot") && Catch::Contains("energy_map"));
}
