// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cost of each effect of the motion, from plain scenes to full ones.
#include <functional>
#include <memory>
#include <tuple>
#include <utility>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/clump.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

constexpr double disc_steps = 1e5;

/// Runs 100,000 disc-steps.
/// \param evaluations of a contact per disc and step
template <class Run>
StudyTask task_of(const std::string& problem, const std::string& method, std::size_t discs, std::function<Run()> start,
                  std::function<double(const Run&)> evaluations) {
  const auto steps = static_cast<std::int64_t>(disc_steps / static_cast<double>(discs));
  return task_on(
      {.problem = problem, .method = method}, std::move(start), [steps](Run& run) { run.advance(steps); },
      [evaluations = std::move(evaluations)](const Run& run) {
        return std::vector{run.bytes_per_body(), run.effects().rotation ? 3.0 : 2.0, evaluations(run)};
      });
}

/// A scene is the one before with something more. An alternative is to the one before; the next scene does without it.
struct BondedCase {
  const char* name;
  std::function<void(SimulationOptions&, AnyScene&)> add;
  double kT = 0.5;
  bool alternative = false;
};

struct CollidingCase {
  const char* name;
  std::function<void(GrainScene&)> add;
};

constexpr double disc_radius = 0.01, disc_density = 2480;

/// Discs in touch on a floor.
GrainScene bed(int side) {
  GrainScene scene;
  scene.walls.emplace_back();
  scene.pairs = {{.stiffness = 1e6, .restitution = 0.5}};
  scene.gravity = {0, -9.8};
  for (int k = 0; k < side * side; ++k) {
    const int row = k / side;
    scene.grains.push_back(
        {.position = {disc_radius * (2 * (k % side) + row % 2), disc_radius * (0.999 + 1.7315 * row)},
         .radius = disc_radius,
         .inertia = inertia_of(disc_radius, disc_density, Body::disc)});
  }
  return scene;
}

/// Discs that fly about in a box and collide mostly in pairs, as the maps require: in a dense bed the maps give wrong
/// energies. A contact lasts 20 steps.
GrainScene colliding_discs(int side) {
  const double spacing = 2.1 * disc_radius, width = spacing * side;
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
                .radius = disc_radius,
                .inertia = inertia_of(disc_radius, disc_density, Body::disc)};
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
    grain.short_half_axis = 0.8 * disc_radius;
    grain.inertia = inertia_of_ellipse(disc_radius, 0.8 * disc_radius, disc_density);
  });
}

void add_clumps(GrainScene& scene) {
  scene.clumps = {
      centred_clump({{{-0.3 * disc_radius, 0}, 0.7 * disc_radius}, {{0.3 * disc_radius, 0}, 0.7 * disc_radius}})};
  change_every_tenth(scene, 5, [&](Grain& grain) {
    grain.clump = 0;
    grain.radius = radius_of(scene.clumps[0]);
    grain.inertia = inertia_of_clump(scene.clumps[0], disc_density);
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

void add_bonded(Study& study, int side) {
  const BondedCase scenes[] = {
      {"normal springs", [](SimulationOptions&, AnyScene&) {}, 0},
      {"+ tangential springs, no rotation", [](SimulationOptions& o, AnyScene&) { o.rotation = Rotation::restrained; }},
      {"+ rotation", [](SimulationOptions& o, AnyScene&) { o.rotation = Rotation::from_scene; }},
      {"+ gravity",
       [](SimulationOptions&, AnyScene& s) {
         s.gravity = {0, -1e-3};
       }},
      {"+ a wall",
       [](SimulationOptions&, AnyScene& s) {
         s.walls = {{.name = "floor", .point = {0, 0}, .normal = {0, 1}, .kN = 1}};
       }},
      {"+ damping by mass", [](SimulationOptions& o, AnyScene&) { o.damping.mass = 0.01; }},
      {"+ dashpots at contacts", [](SimulationOptions& o, AnyScene&) { o.damping.contact = 0.1; }},
      {"or local damping, without dashpots",
       [](SimulationOptions& o, AnyScene&) {
         o.damping.contact = 0;
         o.damping.local = 0.1;
       },
       0.5, true},
      {"+ finite motion", [](SimulationOptions& o, AnyScene&) { o.motion = LoopKind::Motion::finite; }},
  };
  const auto lattice =
      std::make_shared<const Assembly>(hexagonal_lattice({.columns = side, .rows = side, .radius = 0.5}));
  SimulationOptions options{.time_step = 0.05};
  AnyScene around;
  for (const BondedCase& one : scenes) {
    const std::pair before{options, around};
    one.add(options, around);
    const auto springs = std::make_shared<const ContactSprings>(SpringConstants{1, one.kT});
    study.tasks.push_back(task_of<Simulation>(
        "bonded discs", one.name, lattice->size(),
        [lattice, springs, options, around] {
          Scene scene(*lattice, *springs, inertia_of(lattice->radii, 1, Body::disc));
          static_cast<AnyScene&>(scene) = around;
          return Simulation(scene, options);
        },
        [lattice](const Simulation&) { return 0.5 * lattice->coordination_number(); }));
    if (one.alternative) std::tie(options, around) = before;
  }
}

void add_colliding(Study& study, int side) {
  const CollidingCase scenes[] = {
      {"normal contacts, a floor, gravity", [](GrainScene&) {}},
      {"+ friction, sliding", [](GrainScene& s) { s.pairs[0].friction = 0.3; }},
      {"+ tangential springs", [](GrainScene& s) { s.pairs[0].tangential_ratio = 0.5; }},
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
      study.tasks.push_back(task_of<GrainSimulation>(
          problem, map && &one == scenes ? "normal contacts" : one.name, scene.grains.size(),
          [=] { return GrainSimulation(*shared, options); },
          [](const GrainSimulation& run) {
            return static_cast<double>(run.counters().evaluations) /
                   static_cast<double>(run.step() * std::ssize(run.motions()));
          }));
    }
  }
}

}  // namespace

Study effects_study(bool quick) {
  const int side = quick ? 20 : 50;
  Study study{
      .name = "effects",
      .title = fmt::format("{} discs", side * side),
      .quantities = {{.name = "bytes_per_disc", .label = "bytes per disc", .fact = true},
                     {.name = "unknowns", .label = "unknowns per disc", .fact = true},
                     {.name = "evaluations", .label = "evaluations of a contact per disc and step", .fact = true}},
      .tasks = {},
      .notes = {"Each scene is the one above it with something more; one with 'or' is an alternative to the one "
                "above it, and the next scene does without it."},
      .pieces = disc_steps,
      .piece = "disc-step"};
  add_bonded(study, side);
  add_colliding(study, side);
  return study;
}

}  // namespace equidem
