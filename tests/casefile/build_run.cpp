// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/build.hpp"

#include "example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

namespace fs = std::filesystem;

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
  const std::vector<Wrong> wrongs = {
      {"density = 2650.0\n", "", "[assembly]", "assembly", {"density is missing", "[material]"}},
      {"\"bottom_right\"", "\"bottom_left\"", "uy = 1e-5", "support.1.uy", {"uy of disc", "a second time", "'left'"}},
      {"group = \"right\"\nvelocity = [0.1, 0.0]",
       "group = \"right\"\n[[velocity]]\ngroup = \"top\"",
       "group = \"top\"\nspin",
       "velocity.1.group",
       {"two velocities", "'right' and in 'top'"}},
      {"normal = [2.0, 0.0]", "normal = [-2.0, 0.0]", "[[wall]]", "wall.0", {"behind wall 'left'"}},
      {"point = [0.1, 0.0]", "point = [-0.03, 0.0]", "[[wall]]", "wall.0", {"'left' and 'right' cross"}},
  };
  for (const Wrong& wrong : wrongs) {
    const std::string text = changed(motion_case, wrong.what, wrong.by);
    check_sentence(text, scene_error_of(text), wrong);
  }
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

TEST_CASE("every_case_of_the_data_folder_with_a_run_makes_a_scene") {
  int runs = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(EQUIDEM_SOURCE_DIR) / "data/cases")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".toml") || name.starts_with("grains_") || name.starts_with("pack_") ||
        name.starts_with("study_"))
      continue;
    const Case c = read_case(entry.path());
    if (!c.run) continue;
    CAPTURE(entry.path());
    const Assembly assembly = build_assembly(c);
    const BuiltSprings springs = build_springs(c, assembly);
    CHECK(build_scene(c, assembly, springs.springs).inertia.size() == assembly.size());
    ++runs;
  }
  CHECK(runs >= 4);
}

TEST_CASE("a_velocity_that_would_be_dropped_is_refused") {
  constexpr const char* text = R"(schema = "equidem/1"
[assembly]
kind = "hexagonal"
columns = 4
rows = 4
radius = 0.5
density = 1.0
[springs]
kN = 1.0
kT = 0.5
[run]
duration = 1.0
[[support]]
group = "bottom"
uy = 0.0
[[velocity]]
group = "bottom"
velocity = [1.0, 0.0]
spin = 2.0
)";
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
