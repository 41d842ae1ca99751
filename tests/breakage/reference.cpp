// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "equidem/assembly/files.hpp"

#include "breakage/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using equidem::test::Broken, equidem::test::Factor;

TEST_CASE("sequences_of_an_independent_implementation_come_out_event_by_event") {
  const Factor factor = GENERATE(Factor::anew, Factor::updated);
  const std::string folder = std::string(EQUIDEM_SOURCE_DIR) + "/data/reference/";
  const Assembly cell = read_assembly(folder + "perturbed_hexagonal_400.json");
  nlohmann::json reference;
  std::ifstream(folder + "perturbed_hexagonal_400_breakage.json") >> reference;
  ContactStrengths strengths;
  strengths.tension = reference["tension_strength"].get<std::vector<double>>();
  strengths.shear = reference["shear_strength"].get<std::vector<double>>();
  strengths.friction = reference["friction"];
  const ContactSprings springs(SpringConstants{reference["kN"], reference["kT"]});
  REQUIRE(reference["results"].size() == 3);
  for (const auto& result : reference["results"]) {
    LoadPathOptions options;
    options.strain = Voigt{result["strain"][0], result["strain"][1], result["strain"][2]};
    Broken broken(cell, springs, strengths, options, Rotation::from_scene, factor);
    double worst_lambda = 0, worst_stress = 0, worst_residual = 0, largest_stress = 0;
    for (const auto& expected : result["breaks"]) {
      CAPTURE(broken.events().size());
      REQUIRE(broken.run().advance());
      const BreakEvent& event = broken.events().back();
      REQUIRE(event.contact == expected["contact"].get<std::int64_t>());
      REQUIRE(to_string(event.mode) == expected["mode"].get<std::string>());
      CHECK(event.ties == 0);
      CHECK(event.gap == Approx(expected["gap_to_next"].get<double>()).epsilon(1e-6));
      const double lambda = expected["lambda"];
      const auto stress = expected["stress_at_lambda"].get<std::vector<double>>();
      // The last two events are those of a cell of 1/400 of its stiffness, where the dense factorizations of the
      // reference leave 4.4e-9: refined in extended precision they give lambda = 98.43151304239 for the last one.
      const double error = std::abs(event.lambda / lambda - 1);
      worst_lambda = std::max(worst_lambda, lambda > 50 ? 0.1 * error : error);
      const double ours[] = {event.stress.xx, event.stress.yx, event.stress.xy, event.stress.yy};
      for (const double s : stress) largest_stress = std::max(largest_stress, std::abs(s));
      for (std::size_t k = 0; k < 4; ++k) {
        const double off = std::abs(ours[k] - stress[k]) / largest_stress;
        worst_stress = std::max(worst_stress, lambda > 50 ? 0.1 * off : off);
      }
      worst_residual = std::max(worst_residual, event.relative_residual);
    }
    CAPTURE(worst_lambda, worst_stress, worst_residual);
    CHECK(worst_lambda < 1e-9);
    CHECK(worst_stress < 1e-9);
    CHECK(worst_residual < 1e-12);
    CHECK(broken.run().energy_error() < 1e-10);
    if (result["breaks"].size() == 88) {  // the others were stopped
      CHECK(broken.events().back().lambda == Approx(98.43151304239005).epsilon(factor == Factor::anew ? 1e-13 : 1e-11));
      CHECK_FALSE(broken.run().advance());
      CHECK(broken.run().end() == PathEnd::carries_nothing);
    }
  }
}
