// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cases of grains that are refused, steps that are chosen beside what cannot be stepped, and boxes that are shaken.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"

#include "casefile/grain_example.hpp"
#include "example.hpp"
#include "grain_example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

namespace fs = std::filesystem;

TEST_CASE("a_wrong_case_of_grains_is_refused_with_line_key_and_remedy") {
  check_wrong(grain_case, case_text("grains.wrong.txt"), sentence_of);
}

TEST_CASE("an_automatic_step_that_cannot_be_known_is_asked_for") {
  const std::string text = changed(grain_case, "time_step = 1.0e-5", "time_step = \"auto\"");
  const std::string held = changed(text, "stiffness = 1.0e5", "dimensionless_stiffness = 0.1");
  CHECK(sentence_of(held).find("time_step") != std::string::npos);
  std::string hertz = text;
  hertz.erase(hertz.find("contact_duration"), 26);
  const std::string sentence = sentence_of(hertz, {"collisions.law=hertz_dashpot"});
  CAPTURE(sentence);
  CHECK(sentence.find("closing_speed") != std::string::npos);
}

TEST_CASE("a_file_of_grains_is_read_line_by_line") {
  const fs::path folder = fs::temp_directory_path() / "equidem_grain_file";
  const auto read = [&](const std::string& rows) {
    write_file(folder / "g.csv", rows, true);
    std::string text = grain_case;
    text.erase(text.find("[[grain]]"), text.find("[collisions]") - text.find("[[grain]]"));
    text = changed(text, "density = 2500.0", "density = 2500.0\npath = \"g.csv\"");
    return parse_grain_case(text, "a.toml", folder);
  };
  const std::string rest = "1,0.1,0.02,grains\n2,0.1,0.02,steel\n";
  const GrainCase c = read("# two\nx, y_m, radius, group\n" + rest);
  REQUIRE(c.scene.grains.size() == 2);
  CHECK(c.scene.grains[1].position == Vec2{2, 0.1});
  CHECK(c.contacts.kinds[1] == "steel");
  CHECK(c.densities[0] == 2500);
  struct Bad {
    std::string rows;
    std::vector<std::string> words;
  };
  for (const Bad& bad : {Bad{"x,y,group\n1,2,a\n", {":1:", "radius"}}, Bad{"x,y,radius,colour\n", {":1:", "colour"}},
                         Bad{"x,y,radius,group\n" + rest + "1,2\n", {":4:", "2 cells", "4 columns"}},
                         Bad{"x,y,radius\n1,2,three\n", {":2:", "three", "radius"}},
                         Bad{"x,y,radius\n1,2,-3\n", {":2:", "radius is -3 m", "> 0"}},
                         Bad{"x,y,radius,short_half_axis\n1,2,3,1\n", {":2:", "among spheres"}},
                         Bad{"x,y,discs\n1,2,0 0\n", {":2:", "no discs of a clump"}}, Bad{"", {"x, y and radius"}}}) {
    CAPTURE(bad.rows);
    const std::string sentence = test::refusal_of([&] { read(bad.rows); }).message;
    CAPTURE(sentence);
    CHECK(sentence.find("g.csv") != std::string::npos);
    for (const std::string& word : bad.words) CHECK(sentence.find(word) != std::string::npos);
  }
  fs::remove_all(folder);
}

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

namespace {

const std::string box = case_text("box_to_shake.toml");

std::string shaking(const std::string& keys) {
  return box + "[shaking]\n" + keys;
}

}  // namespace

TEST_CASE("all_walls_move_alike_with_the_acceleration") {
  const GrainCase resolved =
      grains(shaking("direction = [3.0, 4.0]\nacceleration = 0.4\nfrequency = 5.0\nstart = 0.25\ncycles = 3\n"));
  REQUIRE(resolved.shaking);
  CHECK(resolved.shaking->peak_acceleration == Approx(0.4));
  for (const Wall& wall : resolved.scene.walls) {
    const double t = 0.4, h = 1e-4;
    const auto x = [&](double time) { return wall.displacement(time); };
    const Vec2 a = (x(t + h) - 2 * x(t) + x(t - h)) / (h * h);
    const double wanted = 0.4 * std::cos(2 * 3.141592653589793 * 5 * 0.15);
    CAPTURE(wall.name, a.x, a.y, wanted);
    CHECK(a.x == Approx(0.6 * wanted).margin(1e-4));
    CHECK(a.y == Approx(0.8 * wanted).margin(1e-4));
    CHECK(x(0.25 + 0.6).x == 0);
  }
}

TEST_CASE("a_box_shakes_to_the_end_where_nothing_else_is_said_and_walls_may_stand_still") {
  const GrainCase resolved =
      grains(shaking("acceleration = 4.0\nfrequency = 5.0\nstart = 0.5\n"), {"wall.1.shaken=false"});
  CHECK(resolved.shaking->cycles == 8);
  CHECK(resolved.scene.walls[0].moves());
  CHECK_FALSE(resolved.scene.walls[1].moves());
  CHECK(grains(shaking("acceleration = 4.0\nfrequency = 5.0\nduration = 0.6\n")).shaking->cycles == 3);
  CHECK_FALSE(grains(box).shaking);
}

TEST_CASE("shakings_without_a_meaning_are_refused_with_their_line_and_a_way_out") {
  struct Bad {
    const char* keys;
    const char* word;
  };
  for (const Bad& bad : {
           Bad{"", "acceleration"},
           Bad{"acceleration = 4.0", "frequency"},
           Bad{"acceleration = -4.0\nfrequency = 1.0", "acceleration"},
           Bad{"acceleration = 4.0\nfrequency = 0.0", "frequency"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\nduration = 0.5", "1.5 cycles"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\nduration = 1.0\ncycles = 3", "duration does not apply"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\nstart = 2.5", "the run ends at 2 s"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\ndirection = [0.0, 0.0]", "direction of the shaking is zero"},
       }) {
    const std::string sentence = sentence_of(shaking(bad.keys));
    CAPTURE(bad.keys, sentence);
    CHECK(sentence.find(bad.word) != std::string::npos);
    CHECK(sentence.find("a.toml:") == 0);
  }
  const std::string ok = shaking("acceleration = 4.0\nfrequency = 3.0\n");
  CHECK(sentence_of(ok).empty());
  CHECK(sentence_of(ok, {"wall.0.shaken=false", "wall.1.shaken=false"}).find("no wall that shakes") !=
        std::string::npos);
  const std::string moves = "[[schedule]]\nname = \"up\"\nkind = \"ramp\"\nend = 1.0\n";
  CHECK(sentence_of(ok + moves, {"wall.0.displacement=0.1", "wall.0.schedule=up"}).find("moves by itself") !=
        std::string::npos);
  CHECK(sentence_of(box, {"measures.region=[0.0, 1.0, 1.0, 0.5]"}).find("no area") != std::string::npos);
  CHECK(sentence_of(box, {"grains.body=sphere", "measures.cell=0.2"}).find("spheres") != std::string::npos);
}
