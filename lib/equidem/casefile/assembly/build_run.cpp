// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/build_run.hpp"

#include <cassert>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/scene_check.hpp"
#include "equidem/homogenize/tension_test.hpp"

namespace equidem {
namespace {

void add_test(const Case& resolved, const Assembly& assembly, Scene& scene) {
  const auto constant = [](const std::optional<double>& value) -> std::optional<Schedule> {
    if (!value) return {};
    return Schedule{.value = *value};
  };
  try {
    const TensionSetup test = tension_setup(assembly, *resolved.test);
    for (const Support& support : test.supports)
      scene.supports.push_back({support.group, constant(support.ux), constant(support.uy), constant(support.rotation)});
    for (const Load& load : test.loads) scene.loads.push_back({.load = load, .factor = {.value = 1}});
  } catch (const Error& error) {
    throw error.at(resolved.where("test"));
  }
}

}  // namespace

Scene build_scene(const Case& resolved, const Assembly& assembly, const ContactSprings& springs) {
  if (!resolved.run) {
    bad_input_at(fmt::format("{}: run", resolved.document.where()), "missing table", "it says how long the run is",
                 "Add [run] with duration = ... in s, or until_rest = 1e-10");
  }
  const std::optional<double> density = disc_density(resolved, assembly);
  if (!density) {
    bad_input_at(resolved.where("assembly"), "the density is missing", "motion needs the mass of the discs",
                 "Add density = ... in kg/m³ to [assembly], or that of the continuum to [material]");
  }
  const RunCase& run = *resolved.run;
  Scene scene(assembly, springs, inertia_of(assembly, *density, resolved.assembly.body));
  scene.supports = run.supports;
  scene.loads = run.loads;
  scene.velocities = run.velocities;
  scene.walls = run.walls;
  scene.gravity = run.gravity;
  if (resolved.test) add_test(resolved, assembly, scene);
  check(scene, resolved.rotation, [&](const std::string& path) { return resolved.where(path); });
  return scene;
}

std::vector<Probe> build_probes(const Case& resolved, const Assembly& assembly) {
  std::vector<Probe> probes = resolved.run->probes;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    check_bodies(resolved.document.find("probe")->items[k], probes[k], assembly.size());
    if (probes[k].bodies.empty()) probes[k].bodies = group(assembly, probes[k].group).discs;
  }
  return probes;
}

SimulationOptions simulation_options(const Case& resolved, double time_step) {
  assert(resolved.run && time_step > 0);
  const RunCase& run = *resolved.run;
  return {.motion = run.motion,
          .integrator = run.integrator,
          .rotation = resolved.rotation,
          .damping = run.damping,
          .time_step = time_step};
}

}  // namespace equidem
