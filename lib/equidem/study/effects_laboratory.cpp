// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The scenes of the study of effects that tests of the laboratory need: discs pressed in a box, in a periodic cell,
/// bonded to a rock.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "equidem/grains/scene/shaking.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"
#include "equidem/study/effects_scenes.hpp"

namespace equidem {
namespace {

constexpr double stiffness = 1e6, time_step = 1e-5;     // N/m, s
constexpr double row_overlap = 0.002 * effects_radius;  // of discs that press one another, m
constexpr std::int64_t steps_between_rows = 100;        // of histories

/// Rows of discs, each in the gaps of the one below, with their centres `spacing` apart.
std::vector<Grain> rows_of_discs(int side, double spacing) {
  const double rise = 0.5 * std::numbers::sqrt3 * spacing;
  std::vector<Grain> discs;
  for (int row = 0; row < side; ++row)
    for (int k = 0; k < side; ++k)
      discs.push_back(effects_disc({spacing * (0.5 + k + 0.5 * (row % 2)), 0.5 * spacing + rise * row}));
  return discs;
}

struct Box {
  double spacing = 2 * effects_radius - row_overlap;
  double width = 0, height = 0;  ///< m
  double stress = 0;             ///< of the rows, Pa
};

Box box_of(int side) {
  Box box;
  box.width = box.spacing * (side + 0.5);
  box.height = box.spacing * (1 + 0.5 * std::numbers::sqrt3 * (side - 1));
  // Three contacts a disc with the force k row_overlap and the branch s: p = 3 f s/(2 A), A = sqrt(3) s^2/2.
  box.stress = std::numbers::sqrt3 * stiffness * row_overlap / box.spacing;
  return box;
}

GrainScene pressed_discs(int side) {
  const Box box = box_of(side);
  GrainScene scene;
  scene.grains = rows_of_discs(side, box.spacing);
  scene.pairs = {{.stiffness = stiffness, .restitution = 0.5, .friction = 0.3, .tangential_ratio = 0.5}};
  scene.walls.resize(4);
  scene.walls[0].name = "floor";
  scene.walls[1].name = "lid", scene.walls[1].point = {0, box.height}, scene.walls[1].normal = {0, -1};
  scene.walls[2].name = "left", scene.walls[2].normal = {1, 0};
  scene.walls[3].name = "right", scene.walls[3].point = {box.width, 0}, scene.walls[3].normal = {-1, 0};
  return scene;
}

/// A scene is the one before with something more. An alternative stands in place of what the one before added; the next
/// scene does without it.
struct LaboratoryCase {
  const char* name;
  std::function<void(GrainScene&)> add;
  bool alternative = false;
  std::function<void(const GrainSimulation&)> read_row = nullptr;  ///< of histories
};

void add_case(Study& study, const char* problem, const LaboratoryCase& one, const GrainScene& scene,
              const GrainOptions& options) {
  const auto shared = std::make_shared<const GrainScene>(scene);
  const std::int64_t steps = effects_steps(scene.grains.size());
  study.tasks.push_back(task_on(
      {.problem = problem, .method = one.name}, [=] { return GrainSimulation(*shared, options); },
      [steps, read_row = one.read_row](GrainSimulation& run) {
        if (!read_row) return run.advance(steps);
        while (run.step() < steps) {
          run.advance(std::min(steps_between_rows, steps - run.step()));
          read_row(run);
        }
      },
      effects_values<GrainSimulation>(evaluations_per_disc_step)));
}

/// \return the scene with all that is no alternative
GrainScene add_cases(Study& study, const char* problem, std::span<const LaboratoryCase> cases, GrainScene scene,
                     const GrainOptions& options) {
  GrainScene before = scene;
  for (const LaboratoryCase& one : cases) {
    GrainScene with = one.alternative ? before : scene;
    one.add(with);
    add_case(study, problem, one, with, options);
    if (!one.alternative) before = std::exchange(scene, std::move(with));
  }
  return scene;
}

void keep_stress(Wall& wall, double stress, double length) {
  wall.servo = Servo{
      .direction = wall.normal, .wanted = {.value = stress}, .is_stress = true, .length = length, .max_speed = 0.1};
}

void add_stages(Study& study, const char* problem, const char* name, const std::vector<GrainStage>& stages,
                const GrainOptions& options) {
  const auto shared = std::make_shared<const std::vector<GrainStage>>(stages);
  const std::int64_t steps = effects_steps(stages[0].scene.grains.size());
  study.tasks.push_back(task_on(
      {.problem = problem, .method = name}, [=] { return StagedSimulation(*shared, options); },
      [steps](StagedSimulation& run) {
        while (run.step() < steps) run.advance(steps - run.step());
      },
      effects_values<StagedSimulation>(
          [](const StagedSimulation& run) { return evaluations_per_disc_step(run.present()); })));
}

void add_box(Study& study, int side) {
  constexpr const char* problem = "colliding discs, law C, pressed in a box";
  const GrainOptions options{.law = NormalLaw::linear_dashpot, .time_step = time_step};
  const Box box = box_of(side);
  const LaboratoryCase cases[] = {
      {"between four walls", [](GrainScene&) {}},
      {"+ a moving wall",
       [](GrainScene& s) {
         s.walls[1].move_y = {.kind = Schedule::Kind::sine, .value = 0.1 * row_overlap, .frequency = 50};
       }},
      {"or shaken: all walls move alike",
       [](GrainScene& s) {
         shake(s.walls, {1, 0}, harmonic_shaking(1, 50, 0, 5));
       },
       true},
      {"or two servo walls, which keep a stress",
       [box](GrainScene& s) {
         keep_stress(s.walls[1], box.stress, box.width);
         keep_stress(s.walls[3], box.stress, box.height);
       },
       true},
      {"+ histories of the walls, every 100 steps", [](GrainScene&) {}, false,
       [](const GrainSimulation& run) { static_cast<void>(run.walls()); }},
  };
  const GrainScene moved = add_cases(study, problem, cases, pressed_discs(side), options);
  const std::int64_t steps = effects_steps(moved.grains.size());
  GrainStage whole{.name = "all", .scene = moved, .steps = steps};
  add_stages(study, problem, "+ one stage", {whole}, options);
  GrainStage first = whole, second = whole;
  first.steps = second.steps = steps / 2;
  second.name = "second";
  add_stages(study, problem, "+ a second stage", {first, second}, options);
  second.bodies.removed = {{.box = Rectangle{{0, 0}, {box.spacing, box.spacing}}}};
  add_stages(study, problem, "+ a body removed where it begins", {first, second}, options);
}

void add_cell(Study& study, int side) {
  constexpr const char* problem = "colliding discs, law C, in a cell";
  const GrainOptions options{.law = NormalLaw::linear_dashpot,
                             .integrator = GrainOptions::Integrator::velocity_verlet,
                             .time_step = time_step};
  const Box box = box_of(side);
  const PeriodicCell whole{.width = box.spacing * side, .height = 0.5 * std::numbers::sqrt3 * box.spacing * side};
  const LaboratoryCase cases[] = {
      {"between four walls", [](GrainScene&) {}},
      {"or periodic along x, with floor and lid",
       [whole](GrainScene& s) {
         s.walls.resize(2);
         s.cell = PeriodicCell{.along = PeriodicCell::Along::x, .width = whole.width};
       },
       true},
      {"+ a cell in place of the walls",
       [whole](GrainScene& s) {
         s.walls.clear();
         s.cell = whole;
       }},
      {"+ shear at a constant rate", [](GrainScene& s) { s.cell->rate_xy = {.value = 1}; }},
      {"+ a stress that it keeps",
       [box](GrainScene& s) {
         s.cell->servo = CellServo{.stress_yy = Schedule{.value = -box.stress}, .max_rate = 10};
       }},
      {"+ histories of the cell, every 100 steps", [](GrainScene&) {}, false,
       [](const GrainSimulation& run) { static_cast<void>(run.cell()); }},
  };
  add_cases(study, problem, cases, pressed_discs(side), options);
}

/// Neighbours are bonded by springs along the line of their centres.
void bond_neighbours(GrainScene& scene, int side) {
  const auto add = [&](int i, int j) {
    scene.bonds.push_back(
        {.i = static_cast<std::size_t>(i), .j = static_cast<std::size_t>(j), .normal_spring = stiffness});
  };
  for (int row = 0; row < side; ++row) {
    for (int k = 0; k < side; ++k) {
      const int disc = row * side + k, above = disc + side, left = row % 2 == 0 ? -1 : 1;
      if (k + 1 < side) add(disc, disc + 1);
      if (row + 1 == side) continue;
      add(disc, above);
      if (k + left >= 0 && k + left < side) add(disc, above + left);
    }
  }
}

void add_rock(Study& study, int side) {
  constexpr const char* problem = "colliding discs, law C, bonded";
  const GrainOptions options{.law = NormalLaw::linear_dashpot, .time_step = time_step};
  const auto each_bond = [](auto change) {
    return [change](GrainScene& s) {
      for (GrainBond& bond : s.bonds) change(bond);
    };
  };
  const LaboratoryCase cases[] = {
      {"normal contacts, no bonds", [](GrainScene&) {}},
      {"+ bonds with springs along", [side](GrainScene& s) { bond_neighbours(s, side); }},
      {"+ springs across", each_bond([](GrainBond& bond) { bond.tangential_spring = 0.4 * stiffness; })},
      // A bond as wide as a disc: kM = kN w^2/12.
      {"+ a width: springs against bending",
       each_bond([](GrainBond& bond) { bond.bending_spring = stiffness * effects_radius * effects_radius / 3; })},
      {"+ dashpots along and across",
       each_bond([](GrainBond& bond) { bond.normal_dashpot = bond.tangential_dashpot = 10; })},
      {"+ strengths, of which none is reached",
       [](GrainScene& s) {
         s.strengths = ContactStrengths{.tension = std::vector<double>(s.bonds.size(), 1e9),
                                        .shear = std::vector<double>(s.bonds.size(), 1e9)};
       }},
  };
  GrainScene scene;
  scene.grains = rows_of_discs(side, 2 * effects_radius - row_overlap);
  scene.walls.emplace_back();
  scene.walls[0].name = "floor";
  scene.pairs = {{.stiffness = stiffness, .restitution = 0.5}};
  scene.gravity = {0, -9.8};
  add_cases(study, problem, cases, scene, options);
}

}  // namespace

void add_laboratory_effects(Study& study, int side) {
  add_box(study, side);
  add_cell(study, side);
  add_rock(study, side);
}

}  // namespace equidem
