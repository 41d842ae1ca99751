// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fujioka & Ushijima (2005), section 5, by a plain loop over the laws of contact: the impact of Figs. 6 and 7,
/// and the loss of the printed mode 2.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "support/contact_steps.hpp"

using namespace equidem;
using equidem::test::step_of;

namespace {

/// A law with its constants, e = 0.7; contact ends at zero overlap.
struct Law {
  NormalLaw law;
  double a = 0, restitution = 0.7;

  [[nodiscard]] ContactStep step(double depth, double closing) const {
    return step_of(law, depth, closing, a, restitution);
  }
};

constexpr double of_springs = 0.10, of_hertz = 4.62;  // dimensionless stiffness, not printed, deduced from Table 2

Law paper_law(NormalLaw law) {
  return {law, law == NormalLaw::hertz_dashpot ? of_hertz : of_springs};
}

/// Lengths in diameters, velocities in diameters per step; one body on a wall.
struct Ball {
  double depth = 0, closing = 0, largest_depth = 0;
  int steps = 0, last_mode = 0;

  /// Computes the first contact; gravity acts after the contact force.
  void fall_and_rebound(const Law& law, double gravity) {
    while (steps == 0 || depth > 0) {
      if (depth > 0) {
        const ContactStep step = law.step(depth, closing);
        closing += step.change;
        depth += step.shift;
        last_mode = step.mode;
        ++steps;
      }
      closing += gravity;
      depth += closing;
      largest_depth = std::max(largest_depth, depth);
    }
  }
};

nlohmann::json reference() {
  nlohmann::json numbers;
  std::ifstream(EQUIDEM_SOURCE_DIR "/data/reference/impact_traces.json") >> numbers;
  return numbers;
}

}  // namespace

TEST_CASE(
    "fujioka_2005_fast_impact_keeps_the_ratio_in_the_maps_and_passes_the_ball_through_itself_in_C") {  // section 5.4
  constexpr double closing = 0.444;  // diameters in the first step
  for (const NormalLaw law : {NormalLaw::five_case_map, NormalLaw::energy_map}) {
    for (double phase = 0.005; phase < 1; phase += 0.01) {
      Ball ball{.depth = (phase - 1) * closing, .closing = closing};
      double before = closing * closing;
      for (int hit = 0; hit < 20; ++hit) {
        ball.steps = 0;
        ball.fall_and_rebound(paper_law(law), 0);
        const double after = ball.closing * ball.closing;
        CAPTURE(describe(law).letter, phase, hit, after / before);
        CHECK(std::abs(after / before - 0.49) < 1e-14);
        before = after;
        ball.closing = -ball.closing;  // reversed in place
      }
    }
  }
  Ball ball{.depth = -closing / 2, .closing = closing};
  ball.fall_and_rebound(paper_law(NormalLaw::linear_dashpot), 0);
  CAPTURE(ball.largest_depth);
  CHECK(ball.largest_depth > 1);
}

TEST_CASE("fujioka_2005_mode_2_as_printed_would_lose_energy_beyond_a_slope") {
  const auto rows = reference()["mode2_literal_loss"];
  for (const auto& row : rows) {
    const double a = row["a"], slope = row["s_star"], e = 0.7;
    const auto last_mode = [&](double s) {
      Ball ball{.depth = 1 / s, .closing = 1};
      ball.fall_and_rebound({NormalLaw::energy_map, a, e}, 0);
      return ball.last_mode;
    };
    CAPTURE(a, slope);
    CHECK(last_mode(slope * (1 + 1e-9)) == 2);  // leaves by (23) in place of (21)
    CHECK(last_mode(slope * (1 - 1e-9)) == 4);
    CHECK(1 / slope == Approx(row["fraction_of_contacts"].get<double>()).epsilon(1e-12));

    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
      double depth = (i + 0.5) / 2000 / slope, closing = 1;
      for (int n = 0;; ++n) {
        const ContactStep step = step_of(NormalLaw::energy_map, depth, closing, a, e);
        if (step.mode == 2 && depth + closing + step.change <= 0) {
          const double printed =
              -(a * depth + std::sqrt(a * a * depth * depth + (1 + a) * closing * closing)) / (1 + a);
          worst = std::max(worst, 1 - printed * printed / (e * e));
          break;
        }
        closing += step.change;
        depth += step.shift + closing;
        REQUIRE(depth > 0);
      }
    }
    CHECK(worst == Approx(row["worst_relative_energy_loss"].get<double>()).epsilon(0.01));
  }
}

TEST_CASE("fujioka_2005_the_depth_of_equation_20_is_the_corrected_one") {
  // With d_j, as printed, the state does not keep the energy of (18).
  constexpr double a = of_springs, e = 0.7;
  for (double phase = 0.05; phase < 1; phase += 0.1) {
    const double s = 1 / phase, corrected = s * e / std::sqrt(s * s + a);  // sigma^ by (17), sigma = 1
    const auto energy_after = [&](double depth) {
      const double f = -depth / (1 + a) * ((1 + a) * s + a - std::sqrt((1 + a) * s * s + a * a));
      const double closing = corrected + f, overlap = corrected * phase + closing;
      return closing * closing + a * overlap * overlap;
    };
    const double kept = energy_after(corrected * phase), printed = energy_after(phase);
    CAPTURE(phase, kept, printed);
    CHECK(kept == Approx(e * e).epsilon(1e-13));
    CHECK(std::abs(printed - e * e) > 1e-3);
    const ContactStep step = step_of(NormalLaw::energy_map, phase, 1, a, e);
    const double closing = 1 + step.change, overlap = phase + step.shift + closing;
    CHECK(closing * closing + a * overlap * overlap == Approx(kept).epsilon(1e-13));
  }
}

TEST_CASE("fujioka_2005_statistics_over_the_phase_of_contact") {  // the reference: 4000 phases at random
  const nlohmann::json numbers = reference();
  for (const NormalLaw law : {NormalLaw::linear_dashpot, NormalLaw::five_case_map, NormalLaw::energy_map}) {
    const auto& expected = numbers[std::string("phase_") + describe(law).letter];
    double steps = 0, ratio = 0, smallest = 10, largest = 0;
    constexpr int phases = 4000;
    for (int i = 0; i < phases; ++i) {
      Ball ball{.depth = (i + 0.5) / phases, .closing = 1};
      ball.fall_and_rebound(paper_law(law), 0);
      const double r = ball.closing * ball.closing;
      steps += ball.steps;
      ratio += r;
      smallest = std::min(smallest, r);
      largest = std::max(largest, r);
    }
    CAPTURE(describe(law).letter, steps / phases, ratio / phases, smallest, largest, expected.dump());
    const double four_deviations = 4 / std::sqrt(phases);
    CHECK(std::abs(steps / phases - expected["steps_mean"].get<double>()) < 0.5 * four_deviations);
    if (law == NormalLaw::linear_dashpot) {
      CHECK(std::abs(ratio / phases - expected["e2_mean"].get<double>()) <
            expected["e2_sd"].get<double>() * four_deviations);
      CHECK(std::abs(smallest - expected["e2_min"].get<double>()) < 1e-3);
      CHECK(std::abs(largest - expected["e2_max"].get<double>()) < 1e-3);
    } else {
      CHECK(largest - smallest < 1e-14);
      CHECK(std::abs(ratio / phases - 0.49) < 1e-14);
    }
  }
}
