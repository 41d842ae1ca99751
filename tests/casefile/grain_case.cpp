// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cases of grains: what their tables mean, and the defaults of the library where they are left out.
#include "equidem/casefile/grains/grain_case.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/material/spring_relations.hpp"

#include "example.hpp"
#include "grain_example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

namespace fs = std::filesystem;

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
  const auto files = cases_of_the_data_folder("grains_");
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

namespace {

std::string shortest_case(const std::string& law) {
  return "schema = \"equidem/1\"\n[grains]\ndensity = 2500.0\n[[grain]]\nposition = [0.0, 1.0]\nradius = 0.01\n"
         "[[grain]]\nposition = [0.0, 2.0]\nradius = 0.02\n[collisions]\n" +
         (law.empty() ? "" : "law = \"" + law + "\"\n") +
         "restitution = 0.8\nstiffness = 1e6\nclosing_speed = 1.0\nfriction = 0.3\n[[wall]]\nname = \"floor\"\n"
         "point = [0.0, 0.0]\nnormal = [0.0, 1.0]\n[run]\nduration = 1.0\n";
}

}  // namespace

TEST_CASE("defaults_of_cases_of_grains_are_those_of_the_options") {
  const std::string law = GENERATE("", "exact_flow", "linear_dashpot", "hertz_dashpot", "five_case_map", "energy_map");
  CAPTURE(law);
  const GrainCase given = parse_grain_case(shortest_case(law), "case.toml", {});

  GrainScene scene;
  for (const double height : {1.0, 2.0})
    scene.grains.push_back(
        {.position = {0, height}, .radius = 0.01 * height, .inertia = inertia_of(0.01 * height, 2500, Body::disc)});
  Wall floor;
  floor.name = "floor";
  floor.normal = {0, 1};
  scene.walls = {floor};
  GrainOptions options;
  if (!law.empty()) options.law = enum_from<NormalLaw>(law);
  const ContactTable contacts = set_kinds(
      scene, {},
      {.bodies = {.stiffness = SpringStiffness{1e6}, .rebound = Restitution{0.8}, .closing_speed = 1, .friction = 0.3}},
      options.law);
  const GrainTimeStep step = choose_time_step(scene, contacts, options, {.longest = 1});

  CHECK(given.options.law == options.law);
  CHECK(given.options.integrator == options.integrator);
  CHECK(given.options.ellipse_law == options.ellipse_law);
  CHECK(given.options.reference_length == options.reference_length);
  CHECK(given.scene.gravity == scene.gravity);
  CHECK(given.contacts.kinds == contacts.kinds);
  for (std::size_t k = 0; k < contacts.pairs.size(); ++k)
    CHECK(given.contacts.pairs[k].properties == contacts.pairs[k].properties);
  CHECK(given.scene.grains[1].inertia.mass == scene.grains[1].inertia.mass);
  CHECK(choose_grain_step(given).step == step.step);
  CHECK(choose_grain_step(given).limit == step.limit);
}

namespace {

const std::string soil = case_text("soil.toml");

std::string refused(const std::string& text) {
  return test::refusal_of([&] { parse_grain_case(text, "soil.toml", {}); }).message;
}

}  // namespace

TEST_CASE("grains_have_the_shapes_of_their_keys") {
  const GrainCase c = grains(soil);
  REQUIRE(c.scene.grains.size() == 3);
  CHECK(c.scene.grains[0].shape() == GrainShape::disc);
  CHECK(c.scene.grains[1].shape() == GrainShape::ellipse);
  CHECK(c.scene.grains[1].radius == 0.02);
  CHECK(c.scene.grains[1].short_half_axis == 0.01);
  CHECK(c.scene.grains[1].inertia.mass == Approx(2480 * std::numbers::pi * 0.02 * 0.01));
  CHECK(c.scene.grains[1].inertia.moment == Approx(c.scene.grains[1].inertia.mass * (0.02 * 0.02 + 0.01 * 0.01) / 4));
  REQUIRE(c.scene.grains[2].shape() == GrainShape::clump);
  const Clump& clump = c.scene.clumps[static_cast<std::size_t>(c.scene.grains[2].clump)];
  CHECK(clump.discs[0].offset.x == Approx(-0.0075));
  CHECK(clump.discs[1].offset.x == Approx(0.0075));
  CHECK(std::abs(clump.discs[1].offset.y) < 1e-15);
  CHECK(c.scene.grains[2].radius == Approx(0.0175));
  // Two discs without the lens that they share.
  const double r = 0.01, d = 0.015;
  const double lens = 2 * r * r * std::acos(d / (2 * r)) - 0.5 * d * std::sqrt(4 * r * r - d * d);
  CHECK(c.scene.grains[2].inertia.mass == Approx(2480 * (2 * std::numbers::pi * r * r - lens)));
}

TEST_CASE("the_settings_of_a_packing_are_those_of_a_run") {
  const GrainCase c = grains(soil);
  const SpringConstants springs = springs_of_wave_speeds(2480, wave_speeds_from_shear(150, 0.25));
  for (const bool at_wall : {false, true}) {
    CAPTURE(at_wall);
    const PairProperties& pair = c.contacts.between(0, at_wall ? 1 : 0).properties;
    // Dashpots 2 h sqrt(m k) (2.27); m/2 moves along the normal, at a wall m; a third of it along the tangent of a
    // disc.
    const double mass = 3.0, moved = at_wall ? mass : mass / 2;
    const double zeta = dashpot_of(0.3, mass, springs.kN) / (2 * std::sqrt(moved * springs.kN));
    CHECK(damping_ratio_of(pair.restitution, pair.end) == Approx(zeta));
    CHECK(pair.tangential_damping ==
          Approx(dashpot_of(0.3, mass, springs.kT) / (2 * std::sqrt(moved / 3 * springs.kT))));
    CHECK(pair.stiffness == springs.kN);
    CHECK(pair.tangential_ratio == Approx(springs.kT / springs.kN));
    CHECK(pair.friction == (at_wall ? 0.25 : 0.17));
    CHECK(pair.end == ContactEnd::at_zero_force);
  }
}

TEST_CASE("an_automatic_step_follows_needles_that_turn") {
  const std::string heavy = changed(changed(changed(soil, "radius = 0.01", "radius = 0.1"),
                                            "[[1.0, 2.0, 0.01], [1.015, 2.0, 0.01]]", "[[0.0, 0.0, 0.1]]"),
                                    "damping = 0.3", "restitution = 1.0");
  const auto step_of = [&](const std::string& shape) {
    return choose_grain_step(grains(changed(heavy, "half_axes = [0.02, 0.01]", shape))).step;
  };
  // The masses are equal: the needle turns away under a push near its tip.
  const double round = step_of("half_axes = [0.02, 0.02]"), needle = step_of("half_axes = [0.2, 0.002]");
  CAPTURE(round, needle);
  CHECK(needle < 0.6 * round);
}

TEST_CASE("springs_of_wave_speeds_need_one_density_and_no_other_ratio") {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {changed(soil, "angle = 0.5", "density = 1000.0"), "densities from 1000 to 2480"},
      {changed(soil, "damping = 0.3", "damping = 0.3\ntangential_ratio = 0.5"), "tangential_ratio"},
      {changed(soil, "poisson_ratio = 0.25", "poisson_ratio = 0.5"), "0.5"},
      {changed(soil, "shear_wave_speed = 150.0\n", "stiffness = 1e6\n"), "without shear_wave_speed"},
      {changed(soil, "law = \"linear_dashpot\"", "law = \"energy_map\""), "no use for damping"},
      {changed(soil, "[0.02, 0.01]", "[0.01, 0.02]"), "Exchange them"}};
  for (const auto& [text, words] : wrong) {
    const std::string sentence = refused(text);
    CAPTURE(sentence, words);
    CHECK(sentence.find(words) != std::string::npos);
  }
}

TEST_CASE("ellipses_meet_by_the_test_asked_for") {
  using enum GrainOptions::EllipseLaw;
  CHECK(grains(soil).options.ellipse_law == exact);
  for (const auto& [word, law] : {std::pair{"exact", exact}, {"enlarged", enlarged}}) {
    const GrainCase c = grains(soil, {fmt::format("collisions.ellipse_contact={}", word)});
    CAPTURE(word);
    CHECK(grain_options(c, 1e-6).ellipse_law == law);
  }
}

TEST_CASE("clumps_of_one_shape_are_kept_once_and_stay_where_they_are_centred") {
  GrainShapes shapes(Body::disc);
  std::vector<Grain> made(3);
  shapes.make_clump(made[0], {{{3, 1}, 0.5}, {{3.7, 1}, 0.3}}, 1000);
  shapes.make_clump(made[1], {{{3, 1}, 0.5}, {{3.7, 1}, 0.3}}, 2000);
  CHECK(made[0].clump == made[1].clump);
  CHECK(made[1].inertia.mass == Approx(2 * made[0].inertia.mass));
  const auto centred = shapes.clumps()[0].discs;
  shapes.make_clump(made[2], centred, 1000);
  const auto& again = shapes.clumps()[static_cast<std::size_t>(made[2].clump)].discs;
  for (std::size_t d = 0; d < centred.size(); ++d) CHECK(again[d].offset == centred[d].offset);
}
