// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a hostile user found in cases of grains.
#include <filesystem>
#include <string>
#include <vector>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"

#include "example.hpp"
#include "grain_example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

namespace fs = std::filesystem;

namespace {

std::string ball_with(const std::string& collisions, const std::string& run = "") {
  return "schema = \"equidem/1\"\n[grains]\ndensity = 2500.0\n[[grain]]\nposition = [0.0, 0.0101]\nradius = 0.01\n"
         "velocity = [0.0, -1.0]\n[collisions]\n" +
         collisions +
         "\n[[wall]]\nname = \"floor\"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\n[run]\nduration = 0.01\n" + run + "\n";
}

GrainCase case_of(const std::string& text) {
  return parse_grain_case(text, "case.toml", {});
}

}  // namespace

TEST_CASE("an_automatic_step_follows_strong_dashpots") {
  for (const char* law : {"linear_dashpot"}) {
    for (const double restitution : {0.1, 0.01, 0.001}) {
      const GrainCase given = case_of(ball_with(
          fmt::format("law = \"{}\"\nrestitution = {}\nstiffness = 1.0e6\nclosing_speed = 1.0", law, restitution)));
      const GrainTimeStep step = choose_grain_step(given);
      GrainSimulation simulation(build_grain_scene(given, step.step), grain_options(given, step.step));
      simulation.advance(count_steps(given, step.step));
      CAPTURE(law, restitution, step.step, step.omega_step, step.limit);
      CHECK(simulation.grains()[0].velocity.y == Approx(restitution).epsilon(0.05));
    }
  }
}

TEST_CASE("a_step_that_makes_hertz_contacts_gain_energy_is_refused") {
  const std::string contact = "law = \"hertz_dashpot\"\nrestitution = 0.5\nstiffness = 1.0e12\nclosing_speed = 1.0";
  const GrainCase given = case_of(ball_with(contact, "time_step = 1.0e-4"));
  test::check_refused([&] { choose_grain_step(given); }, {"limit of stability"});
  const GrainTimeStep known = choose_grain_step(case_of(ball_with(contact)));
  CHECK(known.omega_step < 0.2 * known.limit);
}

TEST_CASE("friction_of_the_maps_is_slip_unless_a_spring_is_asked_for") {
  for (const char* law : {"five_case_map", "energy_map", "exact_flow", "linear_dashpot"}) {
    CAPTURE(law);
    const std::string contact = fmt::format("law = \"{}\"\nrestitution = 0.9\nstiffness = 1.0e6\nfriction = 0.3", law);
    const double usual = std::string(law).ends_with("map") ? 0 : 2.0 / 7;
    CHECK(case_of(ball_with(contact)).contacts.between(0, 1).properties.tangential_ratio == usual);
    CHECK(case_of(ball_with(contact + "\ntangential_ratio = 0.5")).contacts.between(0, 1).properties.tangential_ratio ==
          0.5);
  }
}

TEST_CASE("restitutions_that_no_dashpot_resolves_are_refused_with_ways_out") {
  for (const char* restitution : {"0.0", "1e-300", "1e-13"}) {
    const std::string sentence =
        sentence_of(ball_with(fmt::format("restitution = {}\nstiffness = 1.0e6", restitution)));
    CAPTURE(sentence);
    CHECK(sentence.find("energy_map") != std::string::npos);
  }
}

TEST_CASE("errors_of_grains_name_the_line_of_the_grain") {
  const fs::path folder = fs::temp_directory_path() / "equidem_grains_attacked";
  write_file(folder / "g.csv", "x,y,radius\n0,1,0.1\n# and\n5,+1.0,0.1\n", true);
  const std::string text = ball_with("restitution = 0.5\nstiffness = 1.0e6");
  const GrainCase given =
      parse_grain_case(changed(text, "density = 2500.0", "density = 2500.0\npath = \"g.csv\""), "case.toml", folder);
  CHECK(given.scene.grains[1].position.y == 1);
  CHECK(given.where_grain(1) == (folder / "g.csv").string() + ":4");
  CHECK(given.where_grain(2) == "case.toml:5: grain");
}

TEST_CASE("columns_in_other_units_and_groups_that_mean_walls_are_refused") {
  const fs::path folder = fs::temp_directory_path() / "equidem_grains_attacked";
  const std::string text = changed(ball_with("restitution = 0.5\nstiffness = 1.0e6"), "density = 2500.0",
                                   "density = 2500.0\npath = \"wrong.csv\"");
  const std::vector<std::pair<std::string, std::string>> files{{"x_ft,y_ft,radius_ft\n0,1,1\n", "unit"},
                                                               {"x_mm,y_mm,radius\n0,1,1\n", "unit"},
                                                               {"x,y,radius,group\n0,1,0.1,walls\n", "walls"},
                                                               {"x,y,radius,group\n0,1,0.1,\"a, b\"\n", "letters"}};
  for (const auto& [content, word] : files) {
    write_file(folder / "wrong.csv", content, true);
    CAPTURE(content);
    const auto read = [&] { parse_grain_case(text, "case.toml", folder); };
    CHECK(test::check_refused(read, {word}).where.find("wrong.csv:") != std::string::npos);
  }
}
