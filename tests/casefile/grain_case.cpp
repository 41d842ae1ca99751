// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grains/grain_case.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"

#include "example.hpp"
#include "grain_example.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> example_files() {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(fs::path(EQUIDEM_SOURCE_DIR) / "data/cases")) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("grains_") && name.ends_with(".toml")) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

TEST_CASE("a_case_of_grains_says_what_its_file_says") {
  const GrainCase c = grains(grain_case);
  CHECK(c.body == Body::sphere);
  REQUIRE(c.scene.grains.size() == 3);
  CHECK(c.scene.grains[0].velocity == Vec2{1, -2});
  CHECK(c.scene.grains[0].spin == 3);
  CHECK(c.scene.grains[1].inertia.mass == inertia_of(0.02, 7800, Body::sphere).mass);
  CHECK(c.scene.grains[2].inertia.moment == inertia_of(0.03, 2500, Body::sphere).moment);
  CHECK(c.contacts.kinds == std::vector<std::string>{"grains", "steel", "walls", "floor"});
  CHECK(c.options.law == NormalLaw::linear_dashpot);
  CHECK(c.options.integrator == GrainOptions::Integrator::velocity_verlet);
  CHECK(c.duration == 0.5);
  CHECK(c.step.time_step == 1e-5);
  CHECK(c.scene.gravity == Vec2{0, -9.81});
  REQUIRE(c.scene.walls.size() == 3);
  CHECK(c.scene.walls[0].normal == Vec2{0, 1});
  CHECK(c.scene.walls[0].kind == 3);
  CHECK(c.scene.walls[1].kind == 2);
  CHECK(c.scene.walls[1].end == Vec2{-1, 1});
  CHECK_FALSE(c.scene.walls[0].moves());
  CHECK(c.scene.walls[1].move_x.value == Approx(0.06));
  CHECK(c.scene.walls[1].move_y.value == Approx(0.08));
  CHECK(c.scene.walls[1].move_y.frequency == 5);
  CHECK(c.scene.walls[2].shape == Wall::Shape::segment);
  CHECK(c.scene.walls[2].end == Vec2{4, 6});
  REQUIRE(c.probes.size() == 1);
  CHECK(c.probes[0].bodies == std::vector<std::int32_t>{0, 2});
  CHECK(c.probes[0].quantities == std::vector{ProbeQuantity::velocity, ProbeQuantity::spin});
  CHECK(c.output.probe_interval == 0.01);
}

TEST_CASE("later_tables_of_collisions_say_what_differs") {
  const GrainCase c = grains(grain_case);
  const PairProperties base = c.contacts.between(0, 1).properties, wall = c.contacts.between(0, 2).properties,
                       floor = c.contacts.between(0, 3).properties, steel = c.contacts.between(1, 3).properties;
  CHECK(base.restitution == 0.8);
  CHECK(base.friction == 0.3);
  CHECK(base.tangential_ratio == Approx(2.0 / 7));
  CHECK(base.end == ContactEnd::at_zero_force);
  CHECK(wall.restitution == 0.6);
  CHECK(wall.friction == 0.3);
  CHECK(wall == floor);
  CHECK(steel.restitution == 0.6);
  CHECK(steel.friction == 0);
  CHECK(steel.stiffness == 0);
  CHECK(c.contacts.between(1, 3).duration == 1e-3);
  for (int a = 0; a < c.contacts.kind_count(); ++a)
    for (int b = 0; b < c.contacts.kind_count(); ++b)
      CHECK(c.contacts.between(a, b).properties == c.contacts.between(b, a).properties);
  CHECK_NOTHROW(check(build_grain_scene(c, 1e-5), grain_options(c, 1e-5)));
}

TEST_CASE("an_automatic_step_gives_the_shortest_contact_the_steps_asked_for") {
  const std::string law = GENERATE("linear_dashpot", "five_case_map", "energy_map", "exact_flow", "hertz_dashpot");
  CAPTURE(law);
  std::string text = grain_case;
  text.erase(text.find("contact_duration"), 26);
  text.erase(text.find("integrator"), text.find("gravity") - text.find("integrator"));
  std::vector<std::string> overrides{"run.time_step=auto", "collisions.law=" + law, "collisions.closing_speed=1.5",
                                     "collisions.restitution=1", "collisions.walls.restitution=1"};
  const GrainTimeStep usual = choose_grain_step(grains(text, overrides));
  CHECK(usual.automatic);
  if (law == "exact_flow") CHECK(usual.omega_step == Approx(1));
  overrides.emplace_back("run.steps_per_contact=17");
  const GrainCase c = grains(text, overrides);
  const GrainTimeStep step = choose_grain_step(c);
  CHECK(step.steps_in_contact() == Approx(17));
  CHECK(step.contact == Approx(usual.contact));
  if (law == "hertz_dashpot") return;
  const double lightest = 1 / (1 / c.scene.grains[0].inertia.mass + 1 / c.scene.grains[1].inertia.mass);
  CHECK(step.contact == Approx(std::numbers::pi * std::sqrt(lightest / 1e5)));
}

TEST_CASE("a_hertz_stiffness_follows_from_the_moduli_for_every_pair_of_radii") {
  std::string text = changed(grain_case, "stiffness = 1.0e5", "young_modulus = 7e10\npoisson_ratio = 0.3");
  text.erase(text.find("contact_duration"), 26);
  const GrainCase c = grains(text, {"collisions.law=hertz_dashpot"});
  // kinds: one for each radius of each group, then walls
  REQUIRE(c.contacts.kinds == std::vector<std::string>{"grains", "steel", "grains", "walls", "floor"});
  const double contact_modulus = 7e10 / (2 * (1 - 0.09));
  const auto stiffness = [&](double r, double s) { return 4.0 / 3 * contact_modulus * std::sqrt(r * s / (r + s)); };
  CHECK(c.contacts.between(0, 1).properties.stiffness == Approx(stiffness(0.01, 0.02)));
  CHECK(c.contacts.between(0, 2).properties.stiffness == Approx(stiffness(0.01, 0.03)));
  CHECK(c.contacts.between(2, 3).properties.stiffness == Approx(4.0 / 3 * 7e10 / (1 - 0.09) * std::sqrt(0.03)));
  CHECK(c.contacts.between(0, 1).properties.end == ContactEnd::at_zero_overlap);
}

TEST_CASE("examples_of_grains_are_read_and_written_back") {
  const auto files = example_files();
  REQUIRE(files.size() >= 5);
  for (const fs::path& file : files) {
    CAPTURE(file);
    REQUIRE(describes_grains(casefile::read_document(file, {})));
    const GrainCase c = read_grain_case(file);
    const GrainTimeStep step = choose_grain_step(c);
    CHECK_NOTHROW(check(build_grain_scene(c, step.step), grain_options(c, step.step)));
    const std::string echo = to_toml(c.document, file.parent_path());
    const GrainCase again = parse_grain_case(echo, "echo.toml", file.parent_path());
    CHECK(to_toml(again.document, file.parent_path()) == echo);
    CHECK(again.scene.grains.size() == c.scene.grains.size());
  }
}

TEST_CASE("other_verbs_say_that_they_need_an_assembly") {
  const std::string sentence = error_of(grain_case);
  CAPTURE(sentence);
  CHECK(sentence.find("[assembly]") != std::string::npos);
  CHECK(sentence.find("equidem run") != std::string::npos);
}
