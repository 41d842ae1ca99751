// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Runs of bonded discs: what their tables mean, and the scenes that are built of them.
#include <algorithm>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("a_run_says_what_its_file_says") {
  const Case c = parsed(motion_case);
  REQUIRE(c.run);
  const RunCase& run = *c.run;

  CHECK(run.duration == 0.25);
  CHECK_FALSE(run.until_rest);
  CHECK(run.time_step.step == 2e-6);
  CHECK(run.time_step.rule == TimeStepRule::bound);
  CHECK(run.time_step.fraction == 0.5);
  CHECK(run.time_step.duration == 0.25);
  CHECK(run.time_step.allow_unstable);
  CHECK(run.integrator == Integrator::velocity_verlet);
  CHECK(run.motion == LoopKind::Motion::finite);
  CHECK(run.gravity == Vec2{0, -9.81});
  CHECK(run.damping.mass == 3);
  CHECK(run.damping.stiffness == 0);
  CHECK(run.damping.contact == 0.1);
  CHECK(run.damping.local == 0.2);
  REQUIRE(run.walls.size() == 2);
  CHECK(run.walls[0].name == "left");
  CHECK(run.walls[0].point == Vec2{-0.02, 0});
  CHECK(run.walls[0].kN == 2e9);
  CHECK_FALSE(run.walls[1].moves());
  REQUIRE(run.velocities.size() == 1);
  CHECK(run.velocities[0].group == "right");
  CHECK(run.velocities[0].velocity == Vec2{0.1, 0.0});
  CHECK(run.velocities[0].spin == -3);
  REQUIRE(run.probes.size() == 1);
  CHECK(run.probes[0].group == "right");
  CHECK(run.probes[0].quantities == std::vector{ProbeQuantity::velocity, ProbeQuantity::rotation});
  CHECK(c.output.frame_interval == 0.05);
  CHECK(c.output.probe_interval == 0.001);
  CHECK(c.output.checkpoint_interval == 30);
}

TEST_CASE("a_run_has_defaults_and_is_there_only_where_it_is_asked_for") {
  CHECK_FALSE(parsed(tension_case).run);
  CHECK_FALSE(parsed(tension_case).output.frame_interval);
  const Case c = parsed(tension_case, {"run.until_rest=1e-10"});
  REQUIRE(c.run);
  CHECK(c.run->until_rest == 1e-10);
  CHECK_FALSE(c.run->duration);
  CHECK_FALSE(c.run->time_step.step);
  CHECK(c.run->time_step.rule == TimeStepRule::lanczos);
  CHECK(c.run->time_step.fraction == 0.8);
  CHECK(c.run->time_step.duration == 0);
  CHECK_FALSE(c.run->time_step.allow_unstable);
  CHECK(c.run->integrator == Integrator::leapfrog);
  CHECK(c.run->motion == LoopKind::Motion::small);
  CHECK(c.run->gravity == Vec2{});
  CHECK(c.run->damping.mass + c.run->damping.stiffness + c.run->damping.contact + c.run->damping.local == 0);
  CHECK(c.output.checkpoint_interval == 60);
}

TEST_CASE("motions_and_loads_are_what_they_are_in_statics_times_their_schedule") {
  const Case c = parsed(motion_case);
  const RunCase& run = *c.run;
  REQUIRE(c.schedules.size() == 3);
  REQUIRE(run.supports.size() == c.supports.size());
  REQUIRE(run.loads.size() == c.load_cases.front().loads.size());
  const Schedule &ramp = c.schedules[0].schedule, &sine = c.schedules[1].schedule, &table = c.schedules[2].schedule;
  CHECK_FALSE(run.supports[0].rotation);
  for (double t = 0; t < 0.3; t += 0.01) {
    CAPTURE(t);
    CHECK(run.supports[0].ux->at(t) == *c.supports[0].ux * ramp.at(t));
    CHECK(run.supports[0].uy->at(t) == 0);
    CHECK(run.supports[1].uy->at(t) == *c.supports[1].uy);
    CHECK(run.loads[0].factor.at(t) == table.at(t));
    CHECK(run.loads[1].factor.at(t) == 1);
    CHECK(run.walls[0].displacement_along_normal(t) == Approx(2e-4 * sine.at(t)).epsilon(1e-14));
  }
  CHECK(run.loads[0].load.force == Vec2{10, 0});
  CHECK(run.loads[1].load.moment == 2);
  CHECK(ramp.at(1) == 1);
  CHECK(table.at(0.1) == 0.5);
}

TEST_CASE("a_wall_keeps_its_direction_whatever_the_length_of_its_normal") {
  for (const char* normal : {"[0.6, -0.8]", "[6e-9, -8e-9]", "[6e9, -8e9]", "[3, -4]"}) {
    CAPTURE(normal);
    const Case c = parsed(motion_case, {fmt::format("wall.1.normal={}", normal)});
    CHECK(c.run->walls[1].normal.x == Approx(0.6).epsilon(1e-15));
    CHECK(c.run->walls[1].normal.y == Approx(-0.8).epsilon(1e-15));
  }
}

TEST_CASE("a_run_reads_back_from_its_echo_bit_by_bit") {
  const Case first = parsed(motion_case, {"run.damping.mass=0.1", "schedule.0.end=0.30000000000000004"});
  const Case second = parsed(to_toml(first, "."));
  REQUIRE(second.run);
  CHECK(second.run->damping.mass == first.run->damping.mass);
  CHECK(second.run->walls[1].normal == first.run->walls[1].normal);
  REQUIRE(second.schedules.size() == first.schedules.size());
  for (std::size_t k = 0; k < first.schedules.size(); ++k) {
    CAPTURE(first.schedules[k].name);
    CHECK(second.schedules[k].name == first.schedules[k].name);
    CHECK(second.schedules[k].schedule == first.schedules[k].schedule);
  }
}

TEST_CASE("a_table_may_lie_in_a_file_beside_the_case") {
  const TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
  const std::string text =
      changed(motion_case, "times = [0.0, 0.2]\nvalues = [0.0, 1.0]\n", "path = \"own/shaking.csv\"\n");
  const auto table_of = [&](const std::string& content) {
    write_file(folder / "own/shaking.csv", content, true);
    return parse_case(text, "a.toml", folder, {}).schedules[2].schedule;
  };
  const auto sentence_of = [&](const std::string& content) -> std::string {
    return test::refusal_of([&] { static_cast<void>(table_of(content)); }).message;
  };
  const Schedule expected = parsed(motion_case).schedules[2].schedule;

  CHECK(table_of("0,0\n0.2,1\n") == expected);
  CHECK(table_of("time,value\n0.0, 0.0\n2e-1 ,1.0") == expected);
  CHECK(table_of("\xef\xbb\xbf# measured\r\ntime, value\r\n\r\n0,0\r\n0.2,1\r\n") == expected);

  const Case c = parse_case(text, "a.toml", folder, {});
  const std::string echoed = to_toml(c, folder / "results");
  CHECK(echoed.find("path = \"../own/shaking.csv\"") != std::string::npos);
  CHECK(parse_case(echoed, "b.toml", folder / "results", {}).schedules[2].schedule == expected);

  struct Bad {
    std::string content, line, word;
  };
  for (const Bad& bad : {
           Bad{"", "a.toml:", "has no points"},
           Bad{"time,value\n", "a.toml:", "has no points"},
           Bad{"t,v\n0,0\n", "shaking.csv:1: ", "the column 'value' is missing"},
           Bad{"0,0\ntime,value\n", "shaking.csv:2: ", "'time' is no time"},
           Bad{"0,0\n0.2\n", "shaking.csv:2: ", "the row has 1 cell"},
           Bad{"0,0\n0.2,1,2\n", "shaking.csv:2: ", "the row has 3 cells"},
           Bad{"0,0\n0.2,nan\n", "shaking.csv:2: ", "'nan' is no"},
           Bad{"0,0\n\n0.2;1\n", "shaking.csv:3: ", "the row has 1 cell"},
           Bad{"0,0\n0.2,1\n0.2,2\n", "shaking.csv:3: ", "0.2 s comes after 0.2 s"},
       }) {
    const std::string sentence = sentence_of(bad.content);
    CAPTURE(bad.content, sentence);
    CHECK(sentence.find(bad.line) != std::string::npos);
    CHECK(sentence.find(bad.word) != std::string::npos);
  }
  const std::string missing = error_of(text);
  CAPTURE(missing);
  CHECK(missing.starts_with(place_of(text, "path = \"own") + ": schedule.path: cannot read"));
}

TEST_CASE("runs_that_cannot_be_meant_are_refused_with_line_and_key") {
  REQUIRE(error_of(motion_case).empty());
  check_wrong(motion_case, case_text("motion.wrong.txt"), error_of);
}

TEST_CASE("what_acts_in_a_run_alone_is_not_passed_over_without_one") {
  const auto begin = motion_case.find("[run]"), end = motion_case.find("[[schedule]]");
  const std::string without = std::string(motion_case).erase(begin, end - begin);
  check_sentence(error_of(without), {place_of(without, "[[wall]]"), "wall", {"[run] is not", "Add [run]"}});
  const std::string bare = without.substr(0, without.find("[[wall]]"));
  CHECK(error_of(bare).empty());
  CHECK(parsed(bare).schedules.size() == 3);
}

TEST_CASE("the_description_fits_a_hundred_columns") {
  std::istringstream lines(describe_case_file());
  for (std::string line; std::getline(lines, line);) {
    CAPTURE(line);
    // Bytes that continue a character take no column.
    CHECK(std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xc0) != 0x80; }) <= 100);
  }
}

namespace {

/// The sentence with which the scene of a valid case is refused; empty where it stands.
std::string scene_error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const Case c = parsed(text, overrides);
  const Assembly assembly = build_assembly(c);
  const BuiltSprings springs = build_springs(c, assembly);
  const Refusal refused = refusal_of([&] { static_cast<void>(build_scene(c, assembly, springs.springs)); });
  return refused.kind == ErrorKind::bad_input ? refused.message : "wrong kind";
}

}  // namespace

TEST_CASE("a_scene_is_what_its_case_says") {
  const Case c = parsed(motion_case);
  const Assembly assembly = build_assembly(c);
  const BuiltSprings springs = build_springs(c, assembly);
  const Scene scene = build_scene(c, assembly, springs.springs);
  REQUIRE(scene.inertia.size() == assembly.size());
  const double a = assembly.radii[0], m = 2650 * std::numbers::pi * a * a;
  CHECK(scene.inertia[0].mass == Approx(m).epsilon(1e-14));
  CHECK(scene.inertia[0].moment == Approx(m * a * a / 2).epsilon(1e-14));
  CHECK(scene.supports.size() == 2);
  CHECK(scene.loads.size() == 2);
  CHECK(scene.walls.size() == 2);
  CHECK(scene.velocities.size() == 1);
  const SimulationOptions options = simulation_options(c, 1e-6);
  CHECK(options.time_step == 1e-6);
  CHECK(options.motion == LoopKind::Motion::finite);
  CHECK(options.integrator == Integrator::velocity_verlet);
  CHECK(scene.gravity.y == -9.81);
  CHECK(options.damping.local == 0.2);
}

TEST_CASE("a_tension_test_acts_from_the_start_of_a_run") {
  const Case c = parsed(tension_case, {"run.duration=1", "assembly.density=1"});
  const Assembly assembly = build_assembly(c);
  const BuiltSprings springs = build_springs(c, assembly);
  const Scene scene = build_scene(c, assembly, springs.springs);
  const TensionSetup test = tension_setup(assembly, *c.test);
  REQUIRE(scene.supports.size() == test.supports.size());
  REQUIRE(scene.loads.size() == test.loads.size());
  for (std::size_t k = 0; k < test.loads.size(); ++k) {
    CHECK(scene.loads[k].load.force == test.loads[k].force);
    CHECK(scene.loads[k].factor.at(0) == 1);
  }
}

TEST_CASE("scenes_that_cannot_be_built_say_where") {
  REQUIRE(scene_error_of(motion_case).empty());
  check_wrong(motion_case, R"(
density = 2650.0\n => | @[assembly] | assembly | density is missing | [material]
"bottom_right" => "bottom_left" | @uy = 1e-5 | support.1.uy | uy of disc | a second time | 'left'
group = "right"\nvelocity = [0.1, 0.0] => group = "right"\n[[velocity]]\ngroup = "top" | velocity.1.group
  | two velocities | 'right' and in 'top'
normal = [2.0, 0.0] => normal = [-2.0, 0.0] | @[[wall]] | wall.0 | behind wall 'left'
point = [0.1, 0.0] => point = [-0.03, 0.0] | @[[wall]] | wall.0 | 'left' and 'right' cross
)",
              scene_error_of);
  const std::string no_run = scene_error_of(tension_case);
  CAPTURE(no_run);
  CHECK(no_run.starts_with("a.toml:1: run: missing table"));
}

TEST_CASE("the_same_motion_twice_is_one_motion") {
  // The corner disc belongs to both sides.
  CHECK(scene_error_of(changed(motion_case, "\"bottom_right\"\nuy = 1e-5", "\"bottom_left\"\nuy = true")).empty());
}

TEST_CASE("velocities_and_probes_need_a_group_that_exists") {
  for (const std::string table : {"velocity", "probe"}) {
    const Case c = parsed(motion_case, {table + ".0.group=nowhere"});
    check_refused([&] { static_cast<void>(build_assembly(c)); },
                  {table + ".0.group: the assembly has no group 'nowhere'"});
  }
}

TEST_CASE("a_probe_records_a_group_or_discs_by_their_numbers") {
  const Case by_group = parsed(motion_case);
  const Assembly assembly = build_assembly(by_group);
  CHECK(build_probes(by_group, assembly)[0].bodies == group(assembly, "right").discs);
  const Case by_number = parsed(motion_case, {"probe.0.group=none", "probe.0.bodies=[2, 0]"});
  CHECK(build_probes(by_number, assembly)[0].bodies == std::vector<std::int32_t>{2, 0});
  const Case beyond = parsed(motion_case, {"probe.0.group=none", "probe.0.bodies=[2, 99]"});
  check_refused([&] { static_cast<void>(build_probes(beyond, assembly)); }, {"probe.bodies: there is no body 99"});
}

TEST_CASE("a_velocity_that_would_be_dropped_is_refused") {
  const std::string text = test::case_text("sliding_block.toml");
  CHECK(scene_error_of(text).empty());
  const std::string held = scene_error_of(text, {"velocity.0.velocity=[1,-1]"});
  CAPTURE(held);
  CHECK(held.find("its uy is prescribed") != std::string::npos);
  CHECK(held.find("velocity.0") != std::string::npos);
  CHECK(scene_error_of(text, {"velocity.0.velocity=[1,-1]", "velocity.0.group=top"}).empty());
  CHECK(scene_error_of(text, {"support.0.rotation=0"}).find("its rotation is prescribed") != std::string::npos);
  for (const char* option : {"springs.kT=0", "effects.rotation=restrained"}) {
    CAPTURE(option);
    CHECK(scene_error_of(text, {option}).find("rotations are no unknowns") != std::string::npos);
    CHECK(scene_error_of(text, {option, "velocity.0.spin=0"}).empty());
  }
}
