// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The scenes of colliding bodies on a floor and in flight of the study of effects.
#include <functional>
#include <memory>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/study/effects_scenes.hpp"

namespace equidem {
namespace {

struct CollidingCase {
  const char* name;
  std::function<void(GrainScene&)> add;
};

/// Discs in touch on a floor.
GrainScene bed(int side) {
  GrainScene scene;
  scene.walls.emplace_back();
  scene.pairs = {{.stiffness = 1e6, .restitution = 0.5}};
  scene.gravity = {0, -9.8};
  for (int k = 0; k < side * side; ++k) {
    const int row = k / side;
    scene.grains.push_back(
        {.position = {effects_radius * (2 * (k % side) + row % 2), effects_radius * (0.999 + 1.7315 * row)},
         .radius = effects_radius,
         .inertia = inertia_of(effects_radius, effects_density, Body::disc)});
  }
  return scene;
}

/// Discs that fly about in a box and collide mostly in pairs, as the maps require: in a dense bed the maps give wrong
/// energies. A contact lasts 20 steps.
GrainScene colliding_discs(int side) {
  const double spacing = 2.1 * effects_radius, width = spacing * side;
  GrainScene scene;
  scene.walls.resize(4);
  scene.walls[1].point = {width, width}, scene.walls[1].normal = {0, -1};
  scene.walls[2].normal = {1, 0};
  scene.walls[3].point = {width, width}, scene.walls[3].normal = {-1, 0};
  for (std::size_t k = 0; k < scene.walls.size(); ++k) scene.walls[k].name = fmt::format("wall {}", k + 1);
  scene.pairs = {{.stiffness = 1e8, .restitution = 0.9}};
  Random random(1);
  for (int k = 0; k < side * side; ++k) {
    Grain grain{.position = {spacing * (0.5 + k % side), spacing * (0.5 + k / side)},
                .radius = effects_radius,
                .inertia = inertia_of(effects_radius, effects_density, Body::disc)};
    grain.velocity.x = random.uniform(-4, 4), grain.velocity.y = random.uniform(-4, 4);
    scene.grains.push_back(grain);
  }
  return scene;
}

/// Every tenth disc in the circle of one becomes something else.
template <class Change>
void change_every_tenth(GrainScene& scene, std::size_t from, Change change) {
  for (std::size_t k = from; k < scene.grains.size(); k += 10) change(scene.grains[k]);
}

void add_moving_floor(GrainScene& scene) {
  scene.walls[0].move_y = {.kind = Schedule::Kind::sine, .value = 1e-4, .frequency = 50};
}

void add_ellipses(GrainScene& scene) {
  change_every_tenth(scene, 0, [](Grain& grain) {
    grain.short_half_axis = 0.8 * effects_radius;
    grain.inertia = inertia_of_ellipse(effects_radius, 0.8 * effects_radius, effects_density);
  });
}

void add_clumps(GrainScene& scene) {
  scene.clumps = {centred_clump(
      {{{-0.3 * effects_radius, 0}, 0.7 * effects_radius}, {{0.3 * effects_radius, 0}, 0.7 * effects_radius}})};
  change_every_tenth(scene, 5, [&](Grain& grain) {
    grain.clump = 0;
    grain.radius = radius_of(scene.clumps[0]);
    grain.inertia = inertia_of_clump(scene.clumps[0], effects_density);
  });
}

/// Contacts between neighbours in a row.
void add_bonds(GrainScene& scene) {
  for (std::size_t k = 2; k + 1 < scene.grains.size(); k += 10) {
    GrainBond bond{.i = k, .j = k + 1};
    bond.normal_dashpot = bond.tangential_dashpot = 10;
    bond.normal_spring = bond.tangential_spring = 1e5;
    scene.bonds.push_back(bond);
  }
}

}  // namespace

void add_colliding_effects(Study& study, int side) {
  const CollidingCase scenes[] = {
      {"normal contacts, a floor, gravity", [](GrainScene&) {}},
      {"+ friction with tangential springs",
       [](GrainScene& s) { s.pairs[0].friction = 0.3, s.pairs[0].tangential_ratio = 0.5; }},
      {"+ tangential dashpots", [](GrainScene& s) { s.pairs[0].tangential_damping = 0.1; }},
      {"+ a moving wall", add_moving_floor},
      {"+ a tenth ellipses", add_ellipses},
      {"+ a tenth clumps", add_clumps},
      {"+ bonds, two in ten", add_bonds},
  };
  for (const NormalLaw law : {NormalLaw::linear_dashpot, NormalLaw::energy_map}) {
    const bool map = law == NormalLaw::energy_map;
    GrainScene scene = map ? colliding_discs(side) : bed(side);
    const std::string problem = fmt::format("colliding discs, law {}{}", letter_of(law),
                                            map ? ", flying about in a box" : ", at rest on a floor");
    const GrainOptions options{.law = law, .time_step = 1e-5};
    for (const CollidingCase& one : scenes) {
      one.add(scene);
      const bool discs_alone = scene.grains[0].shape() == GrainShape::disc;  // what maps can do
      if (map && !discs_alone) break;
      const auto shared = std::make_shared<const GrainScene>(scene);
      study.tasks.push_back(task_on(
          {.problem = problem, .method = map && &one == scenes ? "normal contacts" : one.name},
          [=] { return GrainSimulation(*shared, options); },
          [steps = effects_steps(scene.grains.size())](GrainSimulation& run) { run.advance(steps); },
          effects_values<GrainSimulation>(evaluations_per_disc_step)));
    }
  }
}

}  // namespace equidem
