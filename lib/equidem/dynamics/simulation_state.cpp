// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <utility>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/dynamics/simulation_implementation.hpp"

namespace equidem {

/// The velocities that a stage would make of `velocity` at `motion`.
std::vector<DiscMotion> Simulation::Implementation::velocities_after(const Stage& stage, std::vector<double> motion,
                                                                     std::vector<double> velocity,
                                                                     std::vector<double> relative) const {
  std::vector<double> moved(motion.size()), relative_after(relative.size());
  LoopData copy = data;
  copy.velocity = velocity.data();
  copy.motion[0] = motion.data();
  copy.motion[1] = moved.data();
  if (!relative.empty()) {
    copy.velocity_at[0] = relative.data();
    copy.velocity_at[1] = relative_after.data();
  }
  DrivenDiscs acting = driven;
  parallel_tasks(static_cast<std::size_t>(bodies.layout().strips()), [&](std::size_t task, int) {
    const auto strip = static_cast<std::int32_t>(task);
    Dissipation ignored;
    acting.before(strip, copy);
    step_function(copy, stage, 0, bodies.layout().strip_first[strip], bodies.layout().strip_first[strip + 1], ignored);
    acting.after(strip, copy, stage, 0, time_at(steps), time_at(steps) + stage.drift, ignored);
  });
  return bodies.disc_velocities(velocity);
}

/// Leapfrog: the mean of the velocities half a step before and after.
std::vector<DiscMotion> Simulation::Implementation::synchronous_velocities() const {
  std::vector<DiscMotion> v = bodies.disc_velocities(bodies.velocity);
  if (!staggered()) return v;
  const std::vector<DiscMotion> next =
      velocities_after(stages[0], bodies.motion[parity], bodies.velocity, bodies.velocity_at[parity]);
  for (std::size_t d = 0; d < v.size(); ++d) {
    v[d] = {0.5 * (v[d].u + next[d].u), 0.5 * (v[d].theta + next[d].theta)};
  }
  return v;
}

std::vector<DiscMotion> Simulation::Implementation::motions() const {
  std::vector<DiscMotion> result = bodies.discs_of(bodies.motion[parity]);
  const double ahead = first_drift(options.integrator, options.time_step);
  if (ahead == 0) return result;
  const std::vector<DiscMotion> v = bodies.disc_velocities(bodies.velocity);
  for (std::size_t d = 0; d < v.size(); ++d) {
    result[d] = {result[d].u - ahead * v[d].u, result[d].theta - ahead * v[d].theta};
  }
  return result;
}

EnergyLedger Simulation::Implementation::ledger() const {
  EnergyLedger result;
  const std::vector<DiscMotion> now = motions(), v = bodies.disc_velocities(bodies.velocity);
  const std::vector<DiscMotion> before = staggered() ? bodies.discs_of(bodies.motion[1 - parity]) : now;
  for (std::size_t d = 0; d < now.size(); ++d) {
    const Inertia& inertia = scene.inertia[d];
    result.kinetic += 0.5 * (inertia.mass * dot(v[d].u, v[d].u) + inertia.moment * v[d].theta * v[d].theta);
    result.potential -= 0.5 * inertia.mass * dot(options.gravity, now[d].u + before[d].u);
  }
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const Contact& contact = scene.assembly.contacts[c];
    const SpringConstants k = scene.springs[c];
    if (kind.motion == LoopKind::Motion::finite) {
      const FiniteBond bond = bond_of(scene.assembly, contact, k);
      result.elastic += 0.5 * (bond_energy(bond, now[contact.i], now[contact.j]) +
                               bond_energy(bond, before[contact.i], before[contact.j]));
      continue;
    }
    const ContactFrame frame = frame_of(scene.assembly, contact);
    const ContactDeformation d = deformation(frame, now[contact.i], now[contact.j]);
    const ContactDeformation e = deformation(frame, before[contact.i], before[contact.j]);
    result.elastic += 0.5 * (k.kN * d.normal * e.normal + k.kT * d.tangential * e.tangential);
  }
  result.elastic += 0.5 * (driven.wall_energy(bodies.motion[parity].data(), time_at(steps)) +
                           driven.wall_energy(bodies.motion[staggered() ? 1 - parity : parity].data(),
                                              time_at(staggered() ? steps - 1 : steps)));
  for (const Dissipation& of_strip : dissipation) {
    result.damped_mass += of_strip.mass;
    result.damped_contact += of_strip.contact;
    result.damped_local += of_strip.local;
  }
  const DrivingWork work = driven.work();
  result.work_of_loads = work.loads;
  result.work_of_supports = work.supports;
  result.work_of_walls = work.walls;
  result.potential -= initial_potential;
  result.initial = initial_energy;
  return result;
}

// From rest no damper acts, and a kick of one second makes the acceleration of the velocity.
std::vector<DiscForce> Simulation::unbalanced_forces(const std::vector<DiscMotion>& motions) const {
  const Implementation& s = *implementation_;
  std::vector<double> motion(s.bodies.motion[0].size());
  s.bodies.put(motions, motion);
  const std::vector<DiscMotion> a =
      s.velocities_after({.kick = 1}, std::move(motion), std::vector<double>(s.bodies.velocity.size()),
                         std::vector<double>(s.bodies.velocity_at[0].size()));
  std::vector<DiscForce> forces(a.size());
  for (std::size_t d = 0; d < a.size(); ++d) {
    forces[d] = {s.scene.inertia[d].mass * a[d].u, s.scene.inertia[d].moment * a[d].theta};
  }
  return forces;
}

std::vector<DiscMotion> Simulation::velocities() const {
  return implementation_->synchronous_velocities();
}

std::vector<DiscMotion> Simulation::motions() const {
  return implementation_->motions();
}

std::int64_t Simulation::first_runaway() const {
  const Implementation& s = *implementation_;
  const std::vector<DiscMotion> u = s.bodies.discs_of(s.bodies.motion[s.parity]);
  const std::vector<DiscMotion> v = s.bodies.disc_velocities(s.bodies.velocity);
  for (std::size_t d = 0; d < u.size(); ++d) {
    if (!std::isfinite(u[d].u.x + u[d].u.y + u[d].theta + v[d].u.x + v[d].u.y + v[d].theta)) {
      return static_cast<std::int64_t>(d);
    }
  }
  return -1;
}

SimulationState Simulation::save() const {
  const Implementation& s = *implementation_;
  SimulationState state{.step = s.steps,
                        .motions = s.bodies.discs_of(s.bodies.motion[s.parity]),
                        .previous = s.bodies.discs_of(s.bodies.motion[1 - s.parity]),
                        .velocities = s.bodies.disc_velocities(s.bodies.velocity),
                        .ledger = s.ledger(),
                        .sums = {s.initial_energy, s.initial_potential}};
  for (const Dissipation& d : s.dissipation) state.sums.insert(state.sums.end(), {d.mass, d.contact, d.local});
  for (const DrivingWork& w : s.driven.sums()) state.sums.insert(state.sums.end(), {w.loads, w.supports, w.walls});
  return state;
}

void Simulation::restore(const SimulationState& state) {
  Implementation& s = *implementation_;
  const std::size_t discs = s.scene.assembly.size(), strips = s.dissipation.size();
  if (state.motions.size() != discs || state.previous.size() != discs || state.velocities.size() != discs ||
      state.sums.size() != 2 + 6 * strips) {
    bad_input(format("the saved state has {}", counted(static_cast<std::int64_t>(state.motions.size()), "disc")),
              format("this assembly has {}", discs), "Go on with the case that the state was saved from");
  }
  s.steps = state.step;
  s.parity = 0;
  s.bodies.put(state.motions, s.bodies.motion[0]);
  s.bodies.put(state.previous, s.bodies.motion[1]);
  s.bodies.put_velocities(state.velocities);
  s.initial_energy = state.sums[0];
  s.initial_potential = state.sums[1];
  const double* sum = state.sums.data() + 2;
  for (Dissipation& d : s.dissipation) d = {sum[0], sum[1], sum[2]}, sum += 3;
  std::vector<DrivingWork> work(strips);
  for (DrivingWork& w : work) w = {sum[0], sum[1], sum[2]}, sum += 3;
  s.driven.set_sums(std::move(work));
}

}  // namespace equidem
