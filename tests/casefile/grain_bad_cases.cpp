// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <string>
#include <vector>

#include "equidem/core/file.hpp"

#include "example.hpp"
#include "grain_example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

namespace fs = std::filesystem;

TEST_CASE("a_wrong_case_of_grains_is_refused_with_line_key_and_remedy") {
  const std::vector<Wrong> cases{
      {"restitution = 0.8", "restitution = 1.2", "restitution = 1.2", "collisions.restitution", {"from 0 to 1"}},
      {"restitution = 0.8", "restitution = 0.0", "restitution = 0.0", "collisions.restitution", {"infinite"}},
      {"restitution = 0.8\n", "", "[collisions]", "collisions.restitution", {"rebound", "damping"}},
      {"restitution = 0.8", "restitution = 0.8\ndamping = 0.3", "damping", "collisions.damping", {"both given"}},
      {"stiffness = 1.0e5",
       "shear_wave_speed = 150.0",
       "shear_wave_speed",
       "collisions.shear_wave_speed",
       {"without poisson_ratio"}},
      {"stiffness = 1.0e5",
       "shear_wave_speed = 150.0\npoisson_ratio = 0.25",
       "shear_wave_speed",
       "collisions.shear_wave_speed",
       {"body = \"disc\""}},
      {"friction = 0.3\n[c",
       "friction = 0.3\nellipse_contact = \"enlarged\"\n[c",
       "ellipse_contact",
       "collisions.ellipse_contact",
       {"without ellipses"}},
      {"friction = 0.3\n[c",
       "friction = 0.3\nrolling_ratio = 0.3\n[c",
       "rolling_ratio",
       "collisions.rolling_ratio",
       {"without rolling_friction"}},
      {"friction = 0.3\n[c",
       "friction = 0.3\ncohesion_range = 1e-3\n[c",
       "cohesion_range",
       "collisions.cohesion_range",
       {"without cohesion"}},
      {"radius = 0.01", "half_axes = [0.02, 0.01]", "half_axes", "grain.half_axes", {"body = \"disc\""}},
      {"radius = 0.01", "radius = 0.01\ndiscs = [[0, 0, 1]]", "discs", "grain.discs", {"both given"}},
      {"radius = 0.01", "discs = [[0, 0]]", "discs", "grain.discs", {"3 of them"}},
      {"radius = 0.01", "discs = [[0, 0, -1.0]]", "discs", "grain.discs", {"> 0"}},
      {"radius = 0.01", "discs = [0, 0, 1]", "discs", "grain.discs", {"[[0.0, 0.0, 0.01]"}},
      {"radius = 0.01\n", "", "[[grain]]", "grain", {"half_axes", "discs"}},
      {"restitution = 0.8", "restituton = 0.8", "restituton", "collisions.restituton", {"restitution"}},
      {"stiffness = 1.0e5\n", "", "[collisions]", "collisions.stiffness", {"contact_duration", "largest_overlap"}},
      {"stiffness = 1.0e5",
       "stiffness = 1.0e5\ncontact_duration = 1e-3",
       "contact_duration = 1e-3",
       "collisions.contact_duration",
       {"both given"}},
      {"stiffness = 1.0e5",
       "largest_overlap = 1e-4",
       "largest_overlap",
       "collisions.largest_overlap",
       {"closing_speed"}},
      {"law = \"linear_dashpot\"", "law = \"P\"", "law = \"P\"", "collisions.law", {"Write law = \"energy_map\""}},
      {"law = \"linear_dashpot\"", "law = \"energy_map\"", "integrator", "run.integrator", {"step of its own"}},
      {"stiffness = 1.0e5", "young_modulus = 1e9", "young_modulus", "collisions.young_modulus", {"hertz_dashpot"}},
      {"friction = 0.3", "friction = 0.3\ncohesion = 1.0", "cohesion", "collisions.cohesion", {"cohesion_range"}},
      {"friction = 0.3", "friction = -0.3", "friction = -0.3", "collisions.friction", {">= 0"}},
      {"with = \"floor\"", "with = \"flor\"", "with = \"flor\"", "collisions.pair.with", {"Did you mean \"floor\""}},
      {"group = \"steel\"\nwith",
       "group = \"floor\"\nwith",
       "group = \"floor\"",
       "collisions.pair.group",
       {"no group of grains"}},
      {"normal = [0.0, 2.0]", "normal = [0.0, 0.0]", "normal", "wall.normal", {"zero"}},
      {"end = [-1.0, 1.0]", "end = [-1.0, 0.0]", "end = ", "wall.end", {"length"}},
      {"normal = [0.0, 2.0]", "normal = [0.0, 2.0]\nend = [1.0, 0.0]", "end = [1.0", "wall.end", {"segment"}},
      {"direction = [3.0, 4.0]\n", "", "displacement", "wall.displacement", {"direction"}},
      {"schedule = \"shake\"", "schedule = \"shaek\"", "schedule = \"shaek\"", "wall.schedule", {"\"shake\""}},
      {"density = 2500.0\n", "", "[[grain]]", "grain.density", {"[grains]"}},
      {"radius = 0.01", "radius = 0.0", "radius = 0.0", "grain.radius", {"> 0"}},
      {"position = [0.5, 0.1]", "position = [0.5]", "position = [0.5]", "grain.position", {"two numbers"}},
      {"time_step = 1.0e-5",
       "time_step = 0.1",
       "time_step = 0.1",
       "run.time_step",
       {"limit of stability", "exact_flow"}},
      {"time_step = 1.0e-5", "time_step = 1.0", "time_step = 1.0", "run.time_step", {"longer than the run"}},
      {"time_step = 1.0e-5",
       "time_step = 1.0e-5\nsteps_per_contact = 20",
       "steps_per_contact",
       "run.steps_per_contact",
       {"both given"}},
      {"duration = 0.5\n", "", "[run]", "run.duration", {"missing key"}},
      {"group = \"grains\"\nq", "group = \"gravel\"\nq", "group = \"gravel\"", "probe.group", {"no grains"}},
      {"group = \"grains\"\nq", "bodies = [3]\nq", "bodies = [3]", "probe.bodies", {"0 to 2"}},
      {"group = \"grains\"\nq", "group = \"grains\"\nbox = [0.0, 1.0, 1.0, 0.5]\nq", "box", "probe.box", {"is empty"}},
      {"\"velocity\", \"spin\"", "\"stress\"", "quantities", "probe.quantities", {"and no box", "Add box"}},
      {"quantities = [\"velocity\", \"spin\"]",
       "box = [0.0, 0.0, 1.0, 1.0]\nquantities = [\"stress\"]",
       "quantities",
       "probe.quantities",
       {"of spheres"}},
      {"integrator = ", "scheme = ", "scheme", "run.scheme", {"earlier version", "Write integrator"}},
      {"group = \"grains\"\nq", "grains = [0]\nq", "grains = [0]", "probe.grains", {"Write bodies"}},
      {"schedule = \"shake\"\n", "", "displacement", "wall.displacement", {"without schedule", "its point"}},
      {"name = \"floor\"", "name = \"steel\"", "name = \"steel\"", "wall.name", {"both called"}},
      {"[collisions.walls]", "[collisions.wall]", "[collisions.wall]", "collisions.wall", {"collisions"}},
      {"probe_interval = 0.01", "vtk = true", "vtk = true", "output.vtk", {"earlier version", "files"}},
  };
  for (const Wrong& wrong : cases) {
    const std::string text = changed(grain_case, wrong.what, wrong.by);
    check_sentence(text, sentence_of(text), wrong);
  }
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
