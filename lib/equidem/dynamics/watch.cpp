// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/watch.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The disc with the most kinetic energy.
std::int64_t fastest_disc(const Scene& scene, const std::vector<DiscMotion>& velocities) {
  std::int64_t fastest = 0;
  double most = -1;
  for (std::size_t d = 0; d < velocities.size(); ++d) {
    const DiscMotion& v = velocities[d];
    const double energy = scene.inertia[d].mass * dot(v.u, v.u) + scene.inertia[d].moment * v.theta * v.theta;
    if (energy > most) most = energy, fastest = static_cast<std::int64_t>(d);
  }
  return fastest;
}

}  // namespace

RunawayWatch::RunawayWatch(const Scene& scene, const SimulationOptions& options, const RunawayLimits& limits)
    : scene_(scene), options_(options), limits_(limits) {}

void RunawayWatch::look(const Simulation& run) {
  if (const std::int64_t disc = run.first_runaway(); disc >= 0) {
    stop(run, disc, format("the motion of disc {} is no finite number any more", disc));
  }
  const EnergyLedger energy = run.energy();
  // Loads and gravity first take energy and then give it back: what counts is the most that was there.
  given_ = std::max({given_, energy.initial + std::abs(energy.work_of_loads) + std::abs(energy.work_of_supports) +
                                 std::abs(energy.work_of_walls) + std::abs(energy.potential)});
  const double held = std::abs(energy.kinetic) + std::abs(energy.elastic);
  if (!std::isfinite(held) || held > limits_.growth * given_) {
    const std::int64_t disc = fastest_disc(scene_, run.velocities());
    stop(run, disc,
         format("energy ran away: {:.3g} N, when {:.3g} N was all that the run was given; disc {} is the fastest", held,
                given_, disc));
  }
  last_good_step_ = run.step();
}

void RunawayWatch::stop(const Simulation& run, std::int64_t disc, const std::string& problem) const {
  const Vec2 centre = scene_.assembly.centres[disc];
  const std::string where =
      format("step {}, t = {:.6g} s, all was well at step {}; the disc lies at ({:.6g}, {:.6g}) m", run.step(),
             run.time(), last_good_step_, centre.x, centre.y);
  const double ratio = limits_.critical_step > 0 ? options_.time_step / limits_.critical_step : 0;
  if (limits_.growth_rate > 0) {
    computation_failed(
        problem, format("{}; some kT is negative and motions grow at the rate {:.4g} 1/s", where, limits_.growth_rate),
        "Solve the stiffness matrix instead: kT < 0 is stable in statics only");
  }
  if (ratio > 1) {
    computation_failed(problem, format("{}; the time step is {:.4g} times the critical one", where, ratio),
                       format("Take a step below {:.4g} s", limits_.critical_step));
  }
  const std::string known =
      ratio > 0 ? format("; the time step is {:.4g} of the critical one of the reference state", ratio) : std::string();
  if (options_.motion == LoopKind::Motion::finite) {
    computation_failed(problem, where + known,
                       "Contacts that are pulled or turned far are stiffer than at the start: halve the step, or apply "
                       "loads and prescribed motions more slowly");
  }
  computation_failed(problem, where + known,
                     "Check the time step against the critical one, and loads and prescribed motions for jumps");
}

}  // namespace equidem
