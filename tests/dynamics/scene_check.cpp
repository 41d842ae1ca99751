// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contradictions in a scene of bonded discs.
#include "equidem/dynamics/scene_check.hpp"

#include "equidem/assembly/lattices.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

TEST_CASE("contradictions_of_a_scene_are_refused_with_their_place") {
  const Assembly assembly = hexagonal_lattice({.columns = 5, .rows = 5, .radius = 0.5});
  const ContactSprings springs(SpringConstants{1, 0.5});
  Scene good(assembly, springs, std::vector<Inertia>(assembly.size(), {1, 0.5}));
  good.supports = {{.group = "left", .ux = Schedule{.value = 0}, .uy = {}, .rotation = {}}};
  good.velocities = {{.group = "right", .velocity = {1, 0}, .spin = 1}};
  const auto refusal = [](const Scene& scene, Rotation rotation = Rotation::from_scene) -> std::string {
    return test::refusal_of([&] { check(scene, rotation, [](const std::string& path) { return "scene: " + path; }); })
        .message;
  };
  CHECK(refusal(good).empty());
  const auto changed = [&](auto&& change) {
    Scene scene = good;
    change(scene);
    return refusal(scene);
  };
  const auto twice = [](Scene& s) {
    s.supports.push_back({.group = "bottom_left", .ux = Schedule{.value = 1}, .uy = {}, .rotation = {}});
  };
  CHECK_THAT(changed(twice), Catch::Contains("scene: support.1.ux") && Catch::Contains("a second time"));
  Scene contradictory = good;
  twice(contradictory);
  CHECK_THROWS_WITH(Simulation(contradictory, {.time_step = 0.1}), Catch::Contains("support.1.ux"));
  const auto same_twice = [](Scene& s) {
    s.supports.push_back({.group = "bottom_left", .ux = Schedule{.value = 0}, .uy = {}, .rotation = {}});
  };
  CHECK(changed(same_twice).empty());
  const auto two_velocities = [](Scene& s) { s.velocities.push_back({.group = "top_right", .velocity = {}}); };
  CHECK_THAT(changed(two_velocities), Catch::Contains("scene: velocity.1.group") && Catch::Contains("two velocities"));
  const auto held = [](Scene& s) {
    s.supports.push_back({.group = "right", .ux = Schedule{.value = 0}, .uy = {}, .rotation = {}});
  };
  CHECK_THAT(changed(held), Catch::Contains("scene: velocity.0.velocity") && Catch::Contains("its ux is prescribed"));
  CHECK_THAT(refusal(good, Rotation::restrained), Catch::Contains("scene: velocity.0.spin"));
  const auto wall = [](Scene& s) { s.walls.push_back({.name = "inside", .point = {2, 0}, .normal = {1, 0}, .kN = 1}); };
  CHECK_THAT(changed(wall), Catch::Contains("scene: wall.0") && Catch::Contains("behind wall 'inside'"));
}
