// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Scenes that move: small blocks with what holds, pulls, damps and starts them.
#pragma once

#include <cmath>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem::test {

inline Schedule always(double value) {
  Schedule schedule;
  schedule.value = value;
  return schedule;
}

/// Supports of statics as motions that never change, each component of a disc once.
inline std::vector<TimedSupport> held_still(const Assembly& assembly, std::span<const Support> supports) {
  std::set<std::pair<std::int32_t, int>> held;
  std::vector<TimedSupport> timed;
  for (const Support& support : supports) {
    const DiscGroup& discs = group(assembly, support.group);
    TimedSupport one;
    one.group = support.group;
    const auto take = [&](const std::optional<double>& value, int component, std::optional<Schedule>& schedule) {
      if (!value) return;
      bool fresh = true;
      for (const std::int32_t disc : discs.discs) fresh = held.insert({disc, component}).second && fresh;
      if (fresh) schedule = always(*value);
    };
    take(support.ux, 0, one.ux);
    take(support.uy, 1, one.uy);
    take(support.rotation, 2, one.rotation);
    timed.push_back(one);
  }
  return timed;
}

inline std::vector<TimedLoad> lasting(const LoadCase& loads) {
  std::vector<TimedLoad> timed;
  for (const Load& load : loads) timed.push_back({load, always(1)});
  return timed;
}

/// Components per disc (u_x, u_y, rotation) at random in [-1, 1], the same for the same seed.
inline std::vector<DiscMotion> random_motions(std::size_t discs, std::uint64_t seed, double length, double angle) {
  Random random(seed);
  std::vector<DiscMotion> motions(discs);
  for (DiscMotion& m : motions) {
    m = {{length * random.uniform(-1, 1), length * random.uniform(-1, 1)}, angle * random.uniform(-1, 1)};
  }
  return motions;
}

/// Every disc in a group of its own, named by its number, beside the groups that are there.
inline Assembly with_each_disc_named(Assembly assembly) {
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    assembly.groups[std::to_string(d)] = {{static_cast<std::int32_t>(d)}, {}};
  }
  return assembly;
}

/// Gives each disc of an assembly whose discs are named its initial velocity; components that are prescribed, and spins
/// that are no unknowns, are left out.
inline void start_with(Scene& scene, std::vector<DiscMotion> velocities, Rotation rotation = Rotation::from_scene) {
  for (const TimedSupport& support : scene.supports) {
    for (const std::int32_t disc : group(scene.assembly, support.group).discs) {
      if (support.ux) velocities[disc].u.x = 0;
      if (support.uy) velocities[disc].u.y = 0;
      if (support.rotation) velocities[disc].theta = 0;
    }
  }
  const bool spins = derive_effects(scene.assembly, scene.springs, rotation).rotation;
  scene.velocities.clear();
  for (std::size_t d = 0; d < velocities.size(); ++d)
    scene.velocities.push_back({std::to_string(d), velocities[d].u, spins ? velocities[d].theta : 0});
}

inline Assembly hexagonal_block(int n) {
  return with_each_disc_named(hexagonal_lattice({.columns = n, .rows = n, .radius = 0.5}));
}
inline Assembly delaunay_block(std::int64_t discs, std::uint64_t seed, bool periodic = false) {
  DelaunayOptions options;
  options.discs = discs;
  options.seed = seed;
  options.radii = {0.4, 0.6};
  options.periodic = periodic;
  return with_each_disc_named(delaunay_assembly(options));
}

/// Let a run start from displaced discs at rest: leapfrog keeps velocities half a step behind, v = -M^-1 f h/2.
inline void displace(Simulation& run, const Scene& scene, double step, const std::vector<DiscMotion>& u) {
  SavedState state = run.save();
  const std::vector<DiscForce> f = run.unbalanced_forces(u);
  std::vector<DiscMotion> velocities(u.size()), previous(u.size());
  for (std::size_t d = 0; d < u.size(); ++d) {
    const Inertia& body = scene.inertia[d];
    const double turning = body.moment > 0 ? f[d].moment / body.moment : 0;
    velocities[d] = {-0.5 * step / body.mass * f[d].force, -0.5 * step * turning};
    previous[d] = {u[d].u - step * velocities[d].u, u[d].theta - step * velocities[d].theta};
  }
  state["motions"] = numbers_of(u);
  state["previous"] = numbers_of(previous);
  state["velocities"] = numbers_of(velocities);
  run.restore(state);
}

}  // namespace equidem::test
