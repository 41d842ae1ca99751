// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What each effect costs where it is on, and that it costs nothing where it is off.
#include <functional>
#include <memory>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

constexpr double work = 1e5;  // disc-steps

/// Runs 100,000 disc-steps; a millisecond is 10 ns per disc-step.
template <class Run>
StudyTask task_of(const std::string& problem, const std::string& method, std::size_t discs, std::function<Run()> start,
                  double (Run::*bytes)() const) {
  const auto steps = static_cast<std::int64_t>(work / static_cast<double>(discs));
  return {{.problem = problem, .method = method}, [=] {
            const auto run = std::make_shared<Run>(start());
            return Trial{.work = [=] { run->advance(steps); }, .values = [=] { return std::vector{(*run.*bytes)()}; }};
          }};
}

struct Bonded {
  const char* name;
  double kT;
  std::function<void(SimulationOptions&)> set;
};

struct Bodies {
  const char* name;
  std::function<void(GrainScene&, GrainOptions&)> set;
};

/// Discs in touch on a floor.
GrainScene bed(int side) {
  GrainScene scene;
  scene.walls.emplace_back();
  constexpr double r = 0.01;
  scene.pairs = {{.stiffness = 1e6, .restitution = 0.5}};
  for (int k = 0; k < side * side; ++k) {
    const int row = k / side;
    scene.grains.push_back({.position = {r * (2 * (k % side) + row % 2), r * (0.999 + 1.7315 * row)},
                            .radius = r,
                            .inertia = inertia_of(r, 2480, Body::disc)});
  }
  return scene;
}

}  // namespace

Study effects_study(bool quick) {
  const int side = quick ? 20 : 50;
  Study study{.name = "effects",
              .title = format("{} discs, 100,000 disc-steps: 1 ms is 10 ns per disc-step", side * side),
              .quantities = {{.name = "bytes_per_disc", .label = "bytes per disc", .fact = true}},
              .tasks = {}};
  const auto lattice = std::make_shared<const Assembly>(
      hexagonal_lattice({.columns = side, .rows = side, .radius = 0.5, .periodic = true}));
  const Bonded bonded[] = {
      {"normal springs", 0, [](SimulationOptions&) {}},
      {"and tangential, no rotation", 0.5, [](SimulationOptions& o) { o.rotation = Rotation::restrained; }},
      {"and rotation", 0.5, [](SimulationOptions&) {}},
      {"and gravity", 0.5,
       [](SimulationOptions& o) {
         o.gravity = {0, -1e-3};
       }},
      {"and damping by mass", 0.5, [](SimulationOptions& o) { o.damping.mass = 0.01; }},
      {"and dashpots", 0.5, [](SimulationOptions& o) { o.damping.contact = 0.1; }},
      {"and local damping", 0.5, [](SimulationOptions& o) { o.damping.local = 0.1; }},
      {"and finite motion", 0.5, [](SimulationOptions& o) { o.motion = LoopKind::Motion::finite; }},
  };
  for (const Bonded& one : bonded) {
    SimulationOptions options;
    options.time_step = 0.05;
    one.set(options);
    const auto springs = std::make_shared<const ContactSprings>(SpringConstants{1, one.kT});
    study.tasks.push_back(task_of<Simulation>(
        "bonded discs", one.name, lattice->size(),
        [=] {
          Scene scene{.assembly = *lattice, .springs = *springs, .inertia = inertia_of(lattice->radii, 1, Body::disc)};
          return Simulation(scene, options);
        },
        &Simulation::bytes_per_disc));
  }
  const Bodies bodies[] = {
      {"contacts", [](GrainScene&, GrainOptions&) {}},
      {"and gravity",
       [](GrainScene& s, GrainOptions&) {
         s.gravity = {0, -9.8};
       }},
      {"and friction",
       [](GrainScene& s, GrainOptions&) {
         s.gravity = {0, -9.8};
         s.pairs[0].friction = 0.3;
       }},
      {"and tangential springs",
       [](GrainScene& s, GrainOptions&) {
         s.gravity = {0, -9.8};
         s.pairs[0].friction = 0.3;
         s.pairs[0].tangential_ratio = 0.5;
       }},
  };
  for (const NormalLaw law : {NormalLaw::linear_dashpot, NormalLaw::energy_map}) {
    for (const Bodies& one : bodies) {
      GrainScene scene = bed(side);
      GrainOptions options{.law = law, .time_step = 1e-5};
      one.set(scene, options);
      const auto shared = std::make_shared<const GrainScene>(std::move(scene));
      study.tasks.push_back(task_of<GrainSimulation>(
          "colliding discs", format("{} {}", letter_of(law), one.name), shared->grains.size(),
          [=] { return GrainSimulation(*shared, options); }, &GrainSimulation::bytes_per_grain));
    }
  }
  return study;
}

}  // namespace equidem
