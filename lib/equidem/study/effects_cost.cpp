// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cost of each effect of the motion, from plain scenes to full ones; the scenes of bonded discs.
#include <functional>
#include <memory>
#include <tuple>
#include <utility>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/study/built_in.hpp"
#include "equidem/study/effects_scenes.hpp"

namespace equidem {
namespace {

/// A scene is the one before with something more. An alternative is to the one before; the next scene does without it.
struct BondedCase {
  const char* name;
  std::function<void(SimulationOptions&, AnyScene&)> add;
  double kT = 0.5;
  bool alternative = false;
};

}  // namespace

void add_bonded_effects(Study& study, int side) {
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
    study.tasks.push_back(task_on(
        {.problem = "bonded discs", .method = one.name},
        [lattice, springs, options, around] {
          Scene scene(*lattice, *springs, inertia_of(lattice->radii, 1, Body::disc));
          static_cast<AnyScene&>(scene) = around;
          return Simulation(scene, options);
        },
        [steps = effects_steps(lattice->size())](Simulation& run) { run.advance(steps); },
        effects_values<Simulation>([lattice](const Simulation&) { return 0.5 * lattice->coordination_number(); })));
    if (one.alternative) std::tie(options, around) = before;
  }
}

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
      .pieces = effects_disc_steps,
      .piece = "disc-step"};
  add_bonded_effects(study, side);
  add_colliding_effects(study, side);
  add_laboratory_effects(study, side);
  return study;
}

}  // namespace equidem
