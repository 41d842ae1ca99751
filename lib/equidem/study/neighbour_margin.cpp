// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Lists with a wide margin last long but hold pairs that do not touch. The motion is the same for every margin: time
/// is all that changes.
#include <memory>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

constexpr double flying_radius = 0.01, flying_speed = 0.5, flying_step = 2e-5;  // m, m/s, s
constexpr int flying_steps = 500;

/// Discs flying about between four walls.
GrainScene flying_discs(int side) {
  GrainScene scene;
  scene.pairs = {{.stiffness = 1e6, .restitution = 0.9}};
  const double spacing = 2.3 * flying_radius, width = spacing * side;
  for (const auto& [point, normal] :
       {std::pair{Vec2{0, 0}, Vec2{1, 0}}, std::pair{Vec2{0, 0}, Vec2{0, 1}},
        std::pair{Vec2{width, width}, Vec2{-1, 0}}, std::pair{Vec2{width, width}, Vec2{0, -1}}}) {
    Wall wall;
    wall.point = point;
    wall.normal = normal;
    scene.walls.push_back(wall);
  }
  Random random(1);
  for (int k = 0; k < side * side; ++k) {
    scene.grains.push_back(
        {.position = {spacing * (0.5 + k % side), spacing * (0.5 + k / side)},
         .radius = flying_radius,
         .inertia = inertia_of(flying_radius, 2480, Body::disc),
         .velocity = {random.uniform(-flying_speed, flying_speed), random.uniform(-flying_speed, flying_speed)}});
  }
  return scene;
}

}  // namespace

Study neighbour_margin_study(bool quick) {
  const int side = quick ? 20 : 60;
  const auto scene = std::make_shared<const GrainScene>(flying_discs(side));
  Study study{.name = "neighbour_margin",
              .title = fmt::format("{} flying discs, {} steps", side * side, flying_steps),
              .quantities = {{.name = "rebuilds", .label = "lists made", .fact = true},
                             {.name = "energy", .label = "kinetic energy at the end, N", .fact = true}},
              .tasks = {}};
  for (const double margin : {0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6}) {
    Setting setting{.method = margin > 0 ? "" : "chosen by the program", .values = {{"margin_over_radius", margin}}};
    if (margin == 0) setting.values.clear();
    const GrainOptions options{
        .law = NormalLaw::linear_dashpot, .time_step = flying_step, .margin = margin * flying_radius};
    study.tasks.push_back(task_on(
        std::move(setting), [=] { return GrainSimulation(*scene, options); },
        [](GrainSimulation& run) { run.advance(flying_steps); },
        [](const GrainSimulation& run) {
          return std::vector{static_cast<double>(run.counters().rebuilds), run.energy().kinetic};
        }));
  }
  study.notes = {"The energy at the end is the same for every margin: no list misses a contact."};
  return study;
}

}  // namespace equidem
