// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <utility>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/dynamics/simulation_implementation.hpp"
#include "equidem/dynamics/walls.hpp"

namespace equidem {
namespace {

/// Terms of the ledger that are counted from the start.
bool counts_from_start(const EnergyTerm& term) {
  return term.value != &EnergyLedger::kinetic && term.value != &EnergyLedger::elastic_bonded;
}

}  // namespace

Simulation::Implementation::Trial Simulation::Implementation::try_stage(const Stage& stage, LaneVector<double> motion,
                                                                        LaneVector<double> velocity,
                                                                        LaneVector<double> relative,
                                                                        bool driven_too) const {
  LaneVector<double> moved(motion.size()), relative_after(relative.size());
  LoopData copy = data;
  copy.velocity = velocity.data();
  copy.motion[0] = motion.data();
  copy.motion[1] = moved.data();
  if (!relative.empty()) {
    copy.velocity_at[0] = relative.data();
    copy.velocity_at[1] = relative_after.data();
  }
  const auto strips = static_cast<std::size_t>(bodies.layout().strips());
  DrivenDiscs acting = driven;
  acting.set_sums(std::vector<DrivingWork>(strips));
  std::vector<Dissipation> taken(strips);
  parallel_tasks(strips, [&](std::size_t task, int) {
    const auto strip = static_cast<std::int32_t>(task);
    if (driven_too) acting.before(strip, copy, 0, time_at(steps));
    step_function(copy, stage, 0, bodies.layout().strip_first[strip], bodies.layout().strip_first[strip + 1],
                  taken[task]);
    if (!driven_too) return;
    acting.after(strip, copy, stage, 0, time_at(steps), time_at(steps) + (stage.drift + stage.drift_before),
                 taken[task]);
  });
  Trial trial{.velocities = bodies.disc_velocities(velocity), .dissipation = {}, .work = acting.work()};
  for (const Dissipation& of_strip : taken) {
    trial.dissipation.mass += of_strip.mass;
    trial.dissipation.contact += of_strip.contact;
    trial.dissipation.local += of_strip.local;
  }
  return trial;
}

// v_n is the mean of the velocities v-, v+ half a step before and after, and v- + 2 (v_n - v-) = v+ reaches the same
// positions as the whole step.
Simulation::Implementation::Trial Simulation::Implementation::half_kick() const {
  const Stage& whole = stages[0];
  const Stage half{.keep = 0.5 * (1 + whole.keep),
                   .kick = 0.5 * whole.kick,
                   .drift = 2 * whole.drift,
                   .drift_before = -whole.drift,
                   .duration = 0.5 * whole.duration};
  return try_stage(half, bodies.motion[parity], bodies.velocity, bodies.velocity_at[parity]);
}

std::vector<DiscMotion> Simulation::Implementation::synchronous_velocities() const {
  return staggered() ? half_kick().velocities : bodies.disc_velocities(bodies.velocity);
}

std::vector<DiscMotion> Simulation::Implementation::motions() const {
  std::vector<DiscMotion> result = bodies.discs_of(bodies.motion[parity]);
  const double ahead = scheme_of(options.integrator).first_drift * options.time_step;
  if (ahead == 0) return result;
  const std::vector<DiscMotion> v = bodies.disc_velocities(bodies.velocity);
  for (std::size_t d = 0; d < v.size(); ++d) {
    result[d] = {result[d].u - ahead * v[d].u, result[d].theta - ahead * v[d].theta};
  }
  return result;
}

double Simulation::Implementation::elastic_energy(const std::vector<DiscMotion>& now) const {
  double energy = 0;
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const Contact& contact = scene.assembly.contacts[c];
    const DiscMotion &i = now[contact.i], &j = now[contact.j];
    if (kind.motion == LoopKind::Motion::finite) {
      energy += bond_energy(bond_of(scene.assembly, contact, scene.springs[c], scene.springs.bending(c)), i, j);
    } else {
      const ContactDeformation d = deformation(frame_of(scene.assembly, c), i, j);
      energy += 0.5 * (scene.springs[c].kN * d.normal * d.normal + scene.springs[c].kT * d.tangential * d.tangential);
      if (kind.bending) energy += bending_energy(scene.springs.bending(c), i.theta, j.theta);
    }
  }
  return energy + wall_pushes(scene, now, time_at(steps)).energy;
}

// From the state that leapfrog keeps to the present, with v-, v the velocities half a step before and now, f the forces
// of springs, walls and gravity, g all others: m (v - v-) = h/2 (f + g), so that g works h/2 g.(v + v-)/2, and the
// energies then differ from those that leapfrog conserves, half a step behind, by h/4 f.(v - v-).
void Simulation::Implementation::add_half_kick(const std::vector<DiscMotion>& now, EnergyLedger& ledger) const {
  const double h = options.time_step;
  const std::vector<DiscMotion> before = bodies.disc_velocities(bodies.velocity);
  const Trial half = half_kick();
  std::vector<DiscForce> forces = forces_at(now, false);
  const WallPushes pushes = wall_pushes(scene, now, time_at(steps));
  for (std::size_t d = 0; d < now.size(); ++d) {
    const Inertia& inertia = scene.inertia[d];
    const DiscMotion &v = half.velocities[d], &u = before[d];
    if (!pushes.forces.empty()) forces[d].force += pushes.forces[d];
    ledger.kinetic += 0.5 * (inertia.mass * dot(v.u, v.u) + inertia.moment * v.theta * v.theta);
    ledger.sway += h / 4 * (dot(forces[d].force, v.u - u.u) + forces[d].moment * (v.theta - u.theta));
    ledger.damped_mass += options.damping.mass * h / 4 *
                          (inertia.mass * dot(v.u, u.u + v.u) + inertia.moment * v.theta * (u.theta + v.theta));
  }
  ledger.damped_contact += half.dissipation.contact;
  ledger.damped_local += half.dissipation.local;
  ledger.work_of_loads += half.work.loads;
  ledger.work_of_supports += half.work.supports;
  ledger.work_of_walls += 0.5 * half.work.walls;  // of a whole step, which the motion of walls is given for
}

EnergyLedger Simulation::Implementation::raw_ledger() const {
  EnergyLedger result;
  const std::vector<DiscMotion> now = motions();
  const DrivingWork work = driven.work();
  result.work_of_loads = work.loads;
  result.work_of_supports = work.supports;
  result.work_of_walls = work.walls;
  for (const Dissipation& of_strip : dissipation) {
    result.damped_mass += of_strip.mass;
    result.damped_contact += of_strip.contact;
    result.damped_local += of_strip.local;
  }
  result.elastic_bonded = elastic_energy(now);
  for (std::size_t d = 0; d < now.size(); ++d) {
    result.potential -= scene.inertia[d].mass * dot(scene.gravity, now[d].u);
  }
  if (staggered()) {
    add_half_kick(now, result);
    return result;
  }
  const std::vector<DiscMotion> v = bodies.disc_velocities(bodies.velocity);
  for (std::size_t d = 0; d < v.size(); ++d) {
    const Inertia& inertia = scene.inertia[d];
    result.kinetic += 0.5 * (inertia.mass * dot(v[d].u, v[d].u) + inertia.moment * v[d].theta * v[d].theta);
  }
  return result;
}

EnergyLedger Simulation::Implementation::ledger() const {
  EnergyLedger result = raw_ledger();
  for (const EnergyTerm& term : energy_terms(BodyFamily::bonded))
    if (counts_from_start(term)) result.*term.value -= at_start.*term.value;
  result.initial = at_start.kinetic + at_start.elastic_bonded;
  return result;
}

// From rest no damper acts, and a kick of one second makes the acceleration of the velocity.
std::vector<DiscForce> Simulation::Implementation::forces_at(const std::vector<DiscMotion>& motions,
                                                             bool driven_too) const {
  LaneVector<double> motion(bodies.motion[0].size());
  bodies.put(motions, motion);
  const std::vector<DiscMotion> a =
      try_stage({.kick = 1}, std::move(motion), LaneVector<double>(bodies.velocity.size()),
                LaneVector<double>(bodies.velocity_at[0].size()), driven_too)
          .velocities;
  std::vector<DiscForce> forces(a.size());
  for (std::size_t d = 0; d < a.size(); ++d) {
    forces[d] = {scene.inertia[d].mass * a[d].u, scene.inertia[d].moment * a[d].theta};
  }
  return forces;
}

std::vector<DiscForce> Simulation::unbalanced_forces(const std::vector<DiscMotion>& motions) const {
  return implementation_->forces_at(motions, true);
}

std::vector<BodyContact> bonded_contacts(const Scene& scene, LoopKind::Motion motion,
                                         const std::vector<DiscMotion>& motions, double time) {
  const Assembly& assembly = scene.assembly;
  std::vector<BodyContact> result;
  result.reserve(assembly.contacts.size());
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const DiscMotion &i = motions[contact.i], &j = motions[contact.j];
    if (motion == LoopKind::Motion::small) {
      const ContactDeformation d = deformation(frame_of(assembly, c), i, j);
      result.push_back(bonded_contact(assembly, c, linear_spring_force(scene.springs[c], d)));
    } else {
      const FiniteBond bond = bond_of(assembly, contact, scene.springs[c]);
      const BondMotion<double> moved = bond_motion(i, j);
      const ContactForce force = linear_spring_force(bond.springs, bond_deformation(bond, moved));
      const BondForces<double> on_i = bond_forces(bond, moved, force);
      result.push_back(bonded_contact(assembly, c, force));
      result.back().force = {on_i.x, on_i.y};
    }
    result.back().bending_moment = bending_moment(scene.springs.bending(c), i.theta, j.theta);
  }
  for (const auto& [w, disc, gap] : wall_contacts(scene, motions, time)) {
    const Wall& wall = scene.walls[w];
    result.push_back({.i = static_cast<std::int32_t>(disc),
                      .j = ~static_cast<std::int32_t>(w),
                      .arm = -scene.assembly.radii[disc] * wall.normal,
                      .force = -wall.kN * gap * wall.normal,
                      .normal_force = wall.kN * gap});
  }
  return result;
}

std::vector<BodyContact> Simulation::body_contacts() const {
  const Implementation& s = *implementation_;
  return bonded_contacts(s.scene, s.kind.motion, s.motions(), s.time_at(s.steps));
}

std::vector<WallState> Simulation::walls() const {
  const Implementation& s = *implementation_;
  const double now = s.time_at(s.steps), next = s.time_at(s.steps + 1);
  std::vector<WallState> walls;
  for (const Wall& wall : s.scene.walls) {
    const Vec2 moved = wall.displacement(now);
    walls.push_back(
        {.name = wall.name, .place = wall.point + moved, .velocity = (wall.displacement(next) - moved) / (next - now)});
  }
  const std::vector<DiscMotion> motions = s.motions();
  for (const auto& [w, disc, gap] : wall_contacts(s.scene, motions, now)) {
    const Wall& wall = s.scene.walls[w];
    const Vec2 centre = s.scene.assembly.centres[disc] + motions[disc].u, on_wall = wall.kN * gap * wall.normal;
    walls[w].force += on_wall;
    walls[w].moment += cross(centre - s.scene.assembly.radii[disc] * wall.normal - walls[w].place, on_wall);
  }
  return walls;
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

SavedState Simulation::save() const {
  const Implementation& s = *implementation_;
  std::vector<double> sums;
  for (const EnergyTerm& term : energy_terms(BodyFamily::bonded)) sums.push_back(s.at_start.*term.value);
  for (const Dissipation& d : s.dissipation) sums.insert(sums.end(), {d.mass, d.contact, d.local});
  for (const DrivingWork& w : s.driven.sums()) sums.insert(sums.end(), {w.loads, w.supports, w.walls});
  return {.step = s.steps,
          .arrays = {{"motions", 3, numbers_of(s.bodies.discs_of(s.bodies.motion[s.parity]))},
                     {"previous", 3, numbers_of(s.bodies.discs_of(s.bodies.motion[1 - s.parity]))},
                     {"velocities", 3, numbers_of(s.bodies.disc_velocities(s.bodies.velocity))},
                     {"sums", 1, std::move(sums)}}};
}

void Simulation::restore(const SavedState& state) {
  Implementation& s = *implementation_;
  const std::size_t discs = s.scene.assembly.size(), strips = s.dissipation.size();
  const std::vector<DiscMotion> motions = motions_of(state["motions"]), previous = motions_of(state["previous"]),
                                velocities = motions_of(state["velocities"]);
  const std::vector<double>& sums = state["sums"];
  if (motions.size() != discs || previous.size() != discs || velocities.size() != discs ||
      sums.size() != energy_terms(BodyFamily::bonded).size() + 6 * strips) {
    bad_input(fmt::format("the saved state has {}", counted(static_cast<std::int64_t>(motions.size()), "disc")),
              fmt::format("this assembly has {}", discs), "Go on with the case that the state was saved from");
  }
  s.steps = state.step;
  s.parity = 0;
  s.bodies.put(motions, s.bodies.motion[0]);
  s.bodies.put(previous, s.bodies.motion[1]);
  s.bodies.put_velocities(velocities);
  const double* sum = sums.data();
  for (const EnergyTerm& term : energy_terms(BodyFamily::bonded)) s.at_start.*term.value = *sum++;
  for (Dissipation& d : s.dissipation) d = {sum[0], sum[1], sum[2]}, sum += 3;
  std::vector<DrivingWork> work(strips);
  for (DrivingWork& w : work) w = {sum[0], sum[1], sum[2]}, sum += 3;
  s.driven.set_sums(std::move(work));
}

}  // namespace equidem
