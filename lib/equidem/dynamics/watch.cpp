// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/watch.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double most_of_a_bond = 0.5;   // by which its discs move past each other in a step
constexpr double least_of_a_bond = 0.1;  // of its length at rest that is left

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

void RunawayWatch::look(const Simulation& run, const EnergyLedger& energy) {
  if (const std::int64_t disc = run.first_runaway(); disc >= 0) {
    stop(run, disc, fmt::format("the motion of disc {} is no finite number any more", disc));
  }
  // Loads and gravity first take energy and then give it back: what counts is the most that was there.
  given_ = std::max(given_, energy.initial + std::abs(energy.work_of_loads) + std::abs(energy.work_of_supports) +
                                std::abs(energy.work_of_walls) + std::abs(energy.potential));
  const double held = std::abs(energy.kinetic) + std::abs(energy.elastic());
  if (!std::isfinite(held) || held > limits_.growth * given_) {
    const std::int64_t disc = fastest_disc(scene_, run.velocities());
    stop(run, disc,
         fmt::format("energy ran away: {:.3g} N, when {:.3g} N was all that the run was given; disc {} is the fastest",
                     held, given_, disc));
  }
  if (options_.motion == LoopKind::Motion::finite) check_bonds(run);
  last_good_step_ = run.step();
}

void RunawayWatch::check_bonds(const Simulation& run) const {
  const std::vector<DiscMotion> motions = run.motions(), velocities = run.velocities();
  for (const Contact& contact : scene_.assembly.contacts) {
    const Vec2 branch = scene_.assembly.branch(contact), now = branch + motions[contact.j].u - motions[contact.i].u;
    const double length = norm(branch);
    const double moved = options_.time_step * norm(velocities[contact.j].u - velocities[contact.i].u) / length;
    const double left = norm(now) / length;
    if (moved <= most_of_a_bond && left >= least_of_a_bond) continue;
    computation_failed(
        moved > most_of_a_bond
            ? fmt::format("the bonded discs {} and {} move past each other by {:.3g} of their distance in a step",
                          contact.i, contact.j, moved)
            : fmt::format("the bonded discs {} and {} pass through each other: {:.3g} of their distance is left",
                          contact.i, contact.j, left),
        where(run, contact.i),
        "Lower velocities, loads or prescribed motions, or stiffen the springs; a shorter step helps where it is close "
        "to the critical one");
  }
}

std::string RunawayWatch::where(const Simulation& run, std::int64_t disc) const {
  const Vec2 centre = scene_.assembly.centres[disc];
  const std::string when = run.step() == 0 ? std::string("at the start")
                                           : fmt::format("step {}, t = {:.6g} s, all was well at step {}", run.step(),
                                                         run.time(), last_good_step_);
  return fmt::format("{}; disc {} lay at ({:.6g}, {:.6g}) m at first", when, disc, centre.x, centre.y);
}

void RunawayWatch::stop(const Simulation& run, std::int64_t disc, const std::string& problem) const {
  std::string why = where(run, disc), remedy;
  const double ratio = limits_.critical_step > 0 ? options_.time_step / limits_.critical_step : 0;
  if (limits_.growth_rate > 0) {
    why += fmt::format("; some kT is negative and motions grow at the rate {:.4g} 1/s", limits_.growth_rate);
    remedy = "Solve the stiffness matrix instead: kT < 0 is stable in statics only";
  } else if (ratio > 1) {
    why += fmt::format("; the time step is {:.4g} times the critical one", ratio);
    remedy = fmt::format("Take a step below {:.4g} s", limits_.critical_step);
  } else {
    if (ratio > 0) why += fmt::format("; the time step is {:.4g} of the critical one of the reference state", ratio);
    remedy = options_.motion == LoopKind::Motion::finite
                 ? "Contacts that are pulled or turned far are stiffer than at the start: halve the step, or apply "
                   "loads and prescribed motions more slowly"
                 : "Check the time step against the critical one, and loads and prescribed motions for jumps";
  }
  computation_failed(problem, why, remedy);
}

}  // namespace equidem
