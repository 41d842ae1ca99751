// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/dynamics/layout.hpp"
#include "equidem/dynamics/loop_choice.hpp"
#include "equidem/dynamics/simulation_implementation.hpp"
#include "equidem/dynamics/slot_geometry.hpp"
#include "equidem/dynamics/stepper.hpp"

namespace equidem {
namespace {

constexpr int lane_count = DiscLayout::lanes;
constexpr int stages_in_flight = 12;  // strips of that many steps lie in the cache at a time

}  // namespace

Simulation::Implementation::Implementation(const Scene& scene_in, const SimulationOptions& options_in)
    : scene(scene_in),
      options(options_in),
      effects(effects_of(scene, options)),
      kind(loop_for(scene, options, effects)),
      step_function(equidem::step_function(kind)),
      stages(scheme_of(options.integrator).stages(options.time_step, options.damping.mass)),
      bodies(lay_out(scene.assembly), kind),
      driven(scene, bodies.layout(), kind),
      dissipation(static_cast<std::size_t>(bodies.layout().strips())) {
  list_contacts();
  keep_inertia();
  bodies.connect(data);
  start();
}

void Simulation::Implementation::list_contacts() {
  ContactSlots slots = list_slots(scene.assembly, bodies.layout());
  first = std::move(slots.first);
  neighbour = std::move(slots.neighbour);
  const bool dashpots = kind.resistance == LoopKind::Resistance::dashpot;
  const int doubles = lanes::slot_doubles(kind);
  geometry.assign(slots.contact.size() * static_cast<std::size_t>(doubles), 0.0);
  for (std::size_t k = 0; k < slots.contact.size(); ++k) {
    const std::int32_t signed_contact = slots.contact[k];
    double* slot = geometry.data() + k / lane_count * lane_count * static_cast<std::size_t>(doubles);
    const int lane = static_cast<int>(k % lane_count);
    if (signed_contact == 0) continue;
    const auto c = static_cast<std::size_t>(std::abs(signed_contact) - 1);
    const Contact& contact = scene.assembly.contacts[c];
    const bool as_i = signed_contact > 0;
    const Vec2 branch = as_i ? scene.assembly.branch(contact) : -scene.assembly.branch(contact);
    const SpringConstants k_contact = scene.springs[c];
    fill_geometry(kind, branch, as_i ? contact.lever_i : contact.lever_j, as_i ? contact.lever_j : contact.lever_i,
                  k_contact, scene.springs.bending(c), slot, lane);
    if (!dashpots || kind.equal_contacts) continue;
    const Inertia &of_i = scene.inertia[contact.i], &of_j = scene.inertia[contact.j];
    const SpringConstants c_contact = dashpots_of(options.damping, k_contact, of_i.mass, of_j.mass);
    double* const constants = slot + lane_count * (doubles - (kind.bending ? 3 : 2)) + lane;
    constants[0] = c_contact.kN;
    constants[lane_count] = c_contact.kT;
    if (kind.bending) {
      constants[2 * lane_count] =
          bending_dashpot_of(options.damping, scene.springs.bending(c), of_i.moment, of_j.moment);
    }
  }
  data.first = first.data();
  data.neighbour = neighbour.data();
  data.geometry = geometry.data();
  if (kind.equal_contacts && !scene.assembly.contacts.empty()) {
    data.kN = scene.springs[0].kN;
    data.kT = scene.springs[0].kT;
    if (dashpots) {
      const SpringConstants c =
          dashpots_of(options.damping, scene.springs[0], scene.inertia[0].mass, scene.inertia[0].mass);
      data.cN = c.kN;
      data.cT = c.kT;
    }
  }
}

void Simulation::Implementation::keep_inertia() {
  if (kind.equal_discs) {
    data.inverse_mass = 1 / scene.inertia[0].mass;
    data.inverse_moment = 1 / scene.inertia[0].moment;
  } else {
    const std::vector<std::int32_t>& disc_at = bodies.layout().disc_at;
    inverse_inertia.assign(disc_at.size() * 2, 0.0);
    for (std::size_t place = 0; place < disc_at.size(); ++place) {
      const std::int32_t disc = disc_at[place];
      if (disc < 0) continue;
      inverse_inertia[place / lane_count * 2 * lane_count + place % lane_count] = 1 / scene.inertia[disc].mass;
      inverse_inertia[place / lane_count * 2 * lane_count + lane_count + place % lane_count] =
          1 / scene.inertia[disc].moment;
    }
    data.inverse_inertia = inverse_inertia.data();
  }
  data.gravity_x = scene.gravity.x;
  data.gravity_y = scene.gravity.y;
  data.local_damping = options.damping.local;
  data.mass_damping = options.damping.mass;
}

// Velocities are given at time 0. Leapfrog needs them half a step earlier, the fourth-order scheme positions a little
// later.
void Simulation::Implementation::start() {
  std::vector<DiscMotion> given(scene.assembly.size());
  for (const InitialVelocity& initial : scene.velocities) {
    for (const std::int32_t disc : group(scene.assembly, initial.group).discs) {
      given[disc] = {initial.velocity, initial.spin};
    }
  }
  bodies.put_velocities(given);
  driven.prescribe(bodies.motion[0].data(), 0);
  bodies.motion[1] = bodies.motion[0];
  const double h = options.time_step;
  if (staggered()) {
    const Stage back{.keep = 1 + options.damping.mass * h / 2, .kick = -h / 2, .drift = 0, .duration = 0};
    for (std::int32_t strip = 0; strip < bodies.layout().strips(); ++strip) do_strip(strip, back, 0, 0, 0);
    const std::vector<DiscMotion> now = bodies.discs_of(bodies.motion[0]), v = bodies.disc_velocities(bodies.velocity);
    std::vector<DiscMotion> previous(now.size());
    for (std::size_t d = 0; d < now.size(); ++d) previous[d] = {now[d].u - h * v[d].u, now[d].theta - h * v[d].theta};
    bodies.put(previous, bodies.motion[1]);
    driven.prescribe(bodies.motion[1].data(), -h);
    // A prescribed motion overrules the velocity given.
    const std::vector<DiscMotion> earlier = bodies.discs_of(bodies.motion[1]);
    for (std::size_t d = 0; d < now.size(); ++d) {
      previous[d] = {1 / h * (now[d].u - earlier[d].u), (now[d].theta - earlier[d].theta) / h};
    }
    bodies.put_velocities(previous);
  } else {
    const Stage ahead{.kick = 0, .drift = scheme_of(options.integrator).first_drift * h};
    for (std::int32_t strip = 0; strip < bodies.layout().strips(); ++strip) do_strip(strip, ahead, 0, 0, ahead.drift);
    bodies.motion[0] = bodies.motion[1];
  }
  std::fill(dissipation.begin(), dissipation.end(), Dissipation{});
  driven.set_sums(std::vector<DrivingWork>(static_cast<std::size_t>(bodies.layout().strips())));
  at_start = raw_ledger();
}

void Simulation::Implementation::do_strip(std::int32_t strip, const Stage& stage, int from, double time,
                                          double time_after) {
  driven.before(strip, data, from, time);
  step_function(data, stage, from, bodies.layout().strip_first[strip], bodies.layout().strip_first[strip + 1],
                dissipation[strip]);
  driven.after(strip, data, stage, from, time, time_after, dissipation[strip]);
}

void Simulation::Implementation::advance(std::int64_t count) {
  const auto per_step = static_cast<std::int64_t>(stages.size());
  std::vector<double> times(stages.size() + 1,
                            scheme_of(options.integrator).first_drift * options.time_step);  // of positions
  for (std::size_t k = 0; k < stages.size(); ++k) times[k + 1] = times[k] + stages[k].drift + stages[k].drift_before;
  const auto threads = static_cast<int>(
      std::min<std::size_t>(scene.assembly.size() / std::max<std::size_t>(1, options.discs_per_thread), 1024));
  step_strips(bodies.layout().strips(), count * per_step, stages_in_flight, threads,
              [&](std::int32_t strip, std::int64_t stage) {
                const std::int64_t step = steps + stage / per_step;
                const auto k = static_cast<std::size_t>(stage % per_step);
                const double begin = time_at(step);
                // The end of a step and the beginning of the next are the same number.
                const double after = k + 1 == stages.size() ? time_at(step + 1) + times[0] : begin + times[k + 1];
                do_strip(strip, stages[k], static_cast<int>((parity + stage) % 2), begin + times[k], after);
              });
  steps += count;
  parity = static_cast<int>((parity + count * per_step) % 2);
}

Simulation::Simulation(const Scene& scene, const SimulationOptions& options)
    : AnySimulation(BodyFamily::bonded, options.time_step),
      implementation_((check(scene, options), hidden<Implementation>(scene, options))) {}

void Simulation::advance(std::int64_t steps) {
  implementation_->advance(steps);
}
std::int64_t Simulation::step() const {
  return implementation_->steps;
}
const LoopKind& Simulation::loop() const {
  return implementation_->kind;
}
const Effects& Simulation::effects() const {
  return implementation_->effects;
}
EnergyLedger Simulation::energy() const {
  return implementation_->ledger();
}
double Simulation::bytes_per_body() const {
  const Implementation& s = *implementation_;
  const DiscLayout& layout = s.bodies.layout();
  const std::size_t doubles = s.geometry.size() + s.inverse_inertia.size() + 2 * s.bodies.motion[0].size() +
                              s.bodies.velocity.size() + s.bodies.dashpot.size() + 2 * s.bodies.velocity_at[0].size();
  const std::size_t integers = s.first.size() + s.neighbour.size() + layout.disc_at.size() + layout.place_of.size();
  return (8.0 * static_cast<double>(doubles) + 4.0 * static_cast<double>(integers) +
          static_cast<double>(s.driven.bytes())) /
         static_cast<double>(s.scene.assembly.size());
}

}  // namespace equidem
