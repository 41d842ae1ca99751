// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/build_run.hpp"

#include <cassert>
#include <map>
#include <set>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/walls.hpp"
#include "equidem/homogenize/tension_test.hpp"

namespace equidem {
namespace {

[[noreturn]] void fail(const std::string& where, const std::string& problem, const std::string& why,
                       const std::string& remedy) {
  throw Error(ErrorKind::bad_input, problem, why, remedy, where);
}

/// No two supports prescribe a component of a disc differently; the same motion twice is one.
void check_supports(const Case& resolved, const Assembly& assembly, const std::vector<TimedSupport>& supports) {
  struct Component {
    const char* name;
    std::optional<Schedule> TimedSupport::*motion;
  };
  for (const Component& component : {Component{"ux", &TimedSupport::ux}, Component{"uy", &TimedSupport::uy},
                                     Component{"rotation", &TimedSupport::rotation}}) {
    std::map<std::int32_t, std::size_t> prescribed;  // disc -> support
    for (std::size_t k = 0; k < supports.size(); ++k) {
      const auto& motion = supports[k].*component.motion;
      if (!motion) continue;
      for (const std::int32_t disc : group(assembly, supports[k].group).discs) {
        const auto [earlier, is_new] = prescribed.emplace(disc, k);
        if (is_new || supports[earlier->second].*component.motion == motion) continue;
        fail(resolved.where(fmt::format("support.{}.{}", k, component.name)),
             fmt::format("the support of '{}' prescribes {} of disc {} a second time", supports[k].group,
                         component.name, disc),
             fmt::format("that of '{}' gives it another motion", supports[earlier->second].group),
             "Prescribe each component of a disc once");
      }
    }
  }
}

void check_velocities(const Case& resolved, const Assembly& assembly) {
  std::map<std::int32_t, std::size_t> given;  // disc -> table
  const auto& velocities = resolved.run->velocities;
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    for (const std::int32_t disc : group(assembly, velocities[k].group).discs) {
      const auto [earlier, is_new] = given.emplace(disc, k);
      if (is_new) continue;
      fail(resolved.where(fmt::format("velocity.{}.group", k)),
           fmt::format("disc {} has two velocities at the start", disc),
           fmt::format("it is in '{}' and in '{}'", velocities[earlier->second].group, velocities[k].group),
           "Choose groups that share no disc");
    }
  }
}

/// No velocity is set where a support prescribes the motion, no spin where rotation is not an unknown.
void check_velocities_count(const Case& resolved, const Scene& scene) {
  struct Component {
    const char *name, *key;
    std::optional<Schedule> TimedSupport::*motion;
    double (*given)(const InitialVelocity&);
  };
  constexpr Component components[] = {
      {"ux", "velocity", &TimedSupport::ux, [](const InitialVelocity& v) { return v.velocity.x; }},
      {"uy", "velocity", &TimedSupport::uy, [](const InitialVelocity& v) { return v.velocity.y; }},
      {"rotation", "spin", &TimedSupport::rotation, [](const InitialVelocity& v) { return v.spin; }}};
  const auto& velocities = resolved.run->velocities;
  const bool turns = derive_effects(scene.assembly, scene.springs, resolved.rotation).rotation;
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    if (velocities[k].spin != 0 && !turns) {
      fail(
          resolved.where(fmt::format("velocity.{}.spin", k)),
          fmt::format("'{}' has a spin at the start, and rotations are no unknowns of this scene", velocities[k].group),
          scene.springs.any_tangential() ? "they are restrained" : "kT = 0 everywhere: the spin would change nothing",
          "Remove the spin");
    }
    const std::vector<std::int32_t>& moving = group(scene.assembly, velocities[k].group).discs;
    const std::set<std::int32_t> discs(moving.begin(), moving.end());
    for (const Component& component : components) {
      if (component.given(velocities[k]) == 0) continue;
      for (const TimedSupport& support : scene.supports) {
        if (!(support.*component.motion)) continue;
        for (const std::int32_t disc : group(scene.assembly, support.group).discs) {
          if (!discs.contains(disc)) continue;
          fail(resolved.where(fmt::format("velocity.{}.{}", k, component.key)),
               fmt::format("disc {} of '{}' has a velocity at the start, and its {} is prescribed", disc,
                           velocities[k].group, component.name),
               fmt::format("the support of '{}' says how it moves", support.group),
               "Choose a group without held discs, or release them");
        }
      }
    }
  }
}

void check_walls_of(const Case& resolved, const Assembly& assembly) {
  for (std::size_t k = 0; k < resolved.run->walls.size(); ++k) {
    try {
      check_wall(resolved.run->walls, k, assembly);
    } catch (const Error& error) {
      throw error.at(resolved.where(fmt::format("wall.{}", k)));
    }
  }
}

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
    fail(fmt::format("{}: run", resolved.document.where()), "missing table", "it says how long the run is",
         "Add [run] with duration = ... in s, or until_rest = 1e-10");
  }
  const std::optional<double> density = disc_density(resolved, assembly);
  if (!density) {
    fail(resolved.where("assembly"), "the density is missing", "motion needs the mass of the discs",
         "Add density = ... in kg/m³ to [assembly], or that of the continuum to [material]");
  }
  const RunCase& run = *resolved.run;
  Scene scene{.assembly = assembly,
              .springs = springs,
              .inertia = inertia_of(assembly, *density, resolved.assembly.body),
              .supports = run.supports,
              .loads = run.loads,
              .walls = run.walls,
              .velocities = run.velocities};
  if (resolved.test) add_test(resolved, assembly, scene);
  check_supports(resolved, assembly, scene.supports);
  check_velocities(resolved, assembly);
  check_velocities_count(resolved, scene);
  check_walls_of(resolved, assembly);
  return scene;
}

SimulationOptions simulation_options(const Case& resolved, double time_step) {
  assert(resolved.run && time_step > 0);
  const RunCase& run = *resolved.run;
  return {.motion = run.motion,
          .integrator = run.integrator,
          .rotation = resolved.rotation,
          .damping = run.damping,
          .gravity = run.gravity,
          .time_step = time_step};
}

}  // namespace equidem
