// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene.hpp"

#include <algorithm>
#include <cmath>

namespace equidem::bench {
namespace {

ContactSprings springs_for(const Assembly& assembly, const Variant& variant) {
  if (!variant.own_springs) return ContactSprings(variant.springs);
  return ContactSprings(std::vector<SpringConstants>(assembly.contacts.size(), variant.springs));
}

Simulation simulation_of(const Assembly& assembly, const ContactSprings& springs, const Variant& variant) {
  Scene scene(assembly, springs, std::vector<Inertia>(assembly.size(), scene_inertia));
  scene.gravity = variant.gravity;
  if (variant.own_masses) {
    for (std::size_t d = 0; d < assembly.size(); ++d) scene.inertia[d].mass += 0.1 * static_cast<double>(d % 7);
  }
  if (variant.driven_sides) {
    scene.supports.push_back({.group = "left", .ux = Schedule{}, .uy = Schedule{}, .rotation = Schedule{}});
    scene.loads.push_back({.load = {.group = "right", .kind = LoadKind::per_disc, .force = {1e-3, 0}},
                           .factor = {.kind = Schedule::Kind::ramp, .value = 1, .start = 0, .end = 100}});
  }
  Simulation simulation(scene, variant.options);
  SavedState state = simulation.save();
  state["motions"] = state["previous"] = numbers_of(start_motions(assembly));
  simulation.restore(state);
  return simulation;
}

template <class Change>
Variant with(const char* name, Change change) {
  Variant variant{.name = name};
  change(variant);
  return variant;
}

}  // namespace

std::vector<DiscMotion> start_motions(const Assembly& assembly) {
  double width = 1;
  for (const Vec2 x : assembly.centres) width = std::max(width, x.x);
  std::vector<DiscMotion> motions(assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    const double phase = 6.0 * assembly.centres[d].x / width;
    motions[d] = {{0.01 * std::sin(phase), 0.01 * std::cos(phase)}, 0.001 * std::sin(phase)};
  }
  return motions;
}

const std::vector<Variant>& variants() {
  static const std::vector<Variant> list{
      {.name = "springs, rotation"},
      {.name = "normal springs only", .springs = {.kN = scene_springs.kN, .kT = 0}},
      with("rotation restrained", [](Variant& v) { v.options.rotation = Rotation::restrained; }),
      {.name = "springs of every contact", .own_springs = true},
      {.name = "masses of every disc", .own_masses = true},
      with("gravity", [](Variant& v) { v.gravity.y = -1e-6; }),
      with("mass damping", [](Variant& v) { v.options.damping.mass = 1e-3; }),
      with("local damping", [](Variant& v) { v.options.damping.local = 0.1; }),
      with("dashpots", [](Variant& v) { v.options.damping.stiffness = 1e-3; }),
      {.name = "driven sides", .driven_sides = true},
      with("fourth-order integrator", [](Variant& v) { v.options.integrator = Integrator::fourth_order; }),
      with("finite motions", [](Variant& v) { v.options.motion = LoopKind::Motion::finite; }),
      with("finite motions, dashpots", [](Variant& v) {
        v.options.motion = LoopKind::Motion::finite;
        v.options.damping.stiffness = 1e-3;
      })};
  return list;
}

Scenery::Scenery(const Assembly& assembly, const Variant& variant)
    : springs_(springs_for(assembly, variant)), simulation_(simulation_of(assembly, springs_, variant)) {}

}  // namespace equidem::bench
