// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/dynamics/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/dynamics/driven_discs.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/layout.hpp"
#include "equidem/dynamics/scene_check.hpp"

namespace equidem {

/// Work to be done on one strip for one stage (counted through all steps): reads this strip and its neighbours as the
/// stage before left them.
using StripWork = std::function<void(std::int32_t strip, std::int64_t stage)>;

namespace {

/// Perform stages 0 .. stages - 1 on all strips, several at once while data are in the cache, on all threads. A stage
/// of a strip starts after this strip and both neighbours have completed the previous stage.
///
/// Stage s begins two waves after stage s - 1 and follows it from strip to strip: `depth` stages (as many per thread)
/// are in progress at a time, on data in the cache and on strips that are not adjacent, so that threads share them.
/// With fewer stages than threads the strips of one stage are divided among threads. The work and data of every strip
/// do not depend on threads or depth: results are bit-identical.
/// \param most largest number of threads: with few discs per strip, synchronization costs more than it gains
void step_strips(std::int32_t strips, std::int64_t stages, int depth, int most, const StripWork& work) {
  if (strips == 0 || stages == 0) return;
  run_together(most, [&](int thread, Team& team) {
    const int threads = team.size();
    if (stages < threads) {
      const auto begin = static_cast<std::int32_t>(static_cast<std::int64_t>(strips) * thread / threads);
      const auto end = static_cast<std::int32_t>(static_cast<std::int64_t>(strips) * (thread + 1) / threads);
      for (std::int64_t stage = 0; stage < stages; ++stage) {
        for (std::int32_t strip = begin; strip < end; ++strip) work(strip, stage);
        if (!team.wait()) return;
      }
      return;
    }
    // Stage s visits strip l in wave start + l; a new block of stages follows when the first stage of the last one is
    // through, so that no thread runs dry between blocks. Each thread has stages of a block that follow one another:
    // strips pass through its own cache before the next thread has them.
    const int in_block = (std::max(depth, 1) + threads - 1) / threads * threads;
    const std::int64_t block = std::max<std::int64_t>(strips, 2L * in_block);
    const std::int64_t waves = (stages - 1) / in_block * block + 2 * ((stages - 1) % in_block) + strips;
    struct UnderWay {
      std::int64_t stage = 0, start = 0;
      int of_block = 0;
    } first;
    const auto follow = [&](UnderWay& one) {
      ++one.stage;
      one.start += ++one.of_block < in_block ? 2 : block - 2 * (in_block - 1);
      if (one.of_block == in_block) one.of_block = 0;
    };
    for (std::int64_t wave = 0; wave < waves; ++wave) {
      while (first.stage < stages && wave - first.start >= strips) follow(first);
      for (UnderWay one = first; one.stage < stages && one.start <= wave; follow(one)) {
        const std::int64_t strip = wave - one.start;
        const bool own = static_cast<std::int64_t>(one.of_block) * threads / in_block == thread;
        if (strip < strips && own) work(static_cast<std::int32_t>(strip), one.stage);
      }
      if (!team.wait()) return;
    }
  });
}

constexpr int lane_count = DiscLayout::lanes;
constexpr int stages_in_flight = 12;  // strips of that many steps lie in the cache at a time

/// A motion after some time at a velocity.
DiscMotion after(const DiscMotion& motion, double time, const DiscMotion& velocity) {
  return {motion.u + time * velocity.u, motion.theta + time * velocity.theta};
}

double kinetic_energy(const Inertia& inertia, const DiscMotion& v) {
  return 0.5 * (inertia.mass * dot(v.u, v.u) + inertia.moment * v.theta * v.theta);
}

}  // namespace

struct Simulation::Implementation {
  Scene scene;
  SimulationOptions options;
  Effects effects;
  LoopKind kind;
  StepFunction step_function = nullptr;
  std::vector<Stage> stages;
  BodyArrays bodies;
  LaneVector<std::int32_t> first, neighbour;
  LaneVector<double> geometry, inverse_inertia;
  LoopData data;
  DrivenDiscs driven;
  std::vector<Dissipation> dissipation;  // per strip
  std::int64_t steps = 0;
  int parity = 0;
  EnergyLedger at_start;  // including sums that begin half a step before the start

  Implementation(const Scene& scene_in, const SimulationOptions& options_in)
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

  [[nodiscard]] bool staggered() const { return scheme_of(options.integrator).half_step_start; }
  [[nodiscard]] double time_at(std::int64_t step) const { return static_cast<double>(step) * options.time_step; }

  void list_contacts() {
    ContactSlots slots = list_slots(scene.assembly, bodies.layout());
    first = std::move(slots.first);
    neighbour = std::move(slots.neighbour);
    const bool dashpots = kind.resistance == LoopKind::Resistance::dashpot;
    const int doubles = kind.slot_doubles();
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

  void keep_inertia() {
    if (kind.equal_discs) {
      data.inverse_mass = 1 / scene.inertia[0].mass;
      data.inverse_moment = 1 / scene.inertia[0].moment;
    } else {
      const std::vector<std::int32_t>& disc_at = bodies.layout().disc_at;
      inverse_inertia.assign(disc_at.size() * 2, 0.0);
      for (std::size_t place = 0; place < disc_at.size(); ++place) {
        const std::int32_t disc = disc_at[place];
        if (disc < 0) continue;
        double* const at = inverse_inertia.data() + place / lane_count * 2 * lane_count + place % lane_count;
        at[0] = 1 / scene.inertia[disc].mass;
        at[lane_count] = 1 / scene.inertia[disc].moment;
      }
      data.inverse_inertia = inverse_inertia.data();
    }
    data.gravity_x = scene.gravity.x;
    data.gravity_y = scene.gravity.y;
    data.local_damping = options.damping.local;
    data.mass_damping = options.damping.mass;
  }

  /// Velocities are given at time 0. Leapfrog needs them half a step earlier, the fourth-order scheme positions a
  /// little later.
  void start() {
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
      const std::vector<DiscMotion> now = bodies.discs_of(bodies.motion[0]),
                                    v = bodies.disc_velocities(bodies.velocity);
      std::vector<DiscMotion> previous(now.size());
      for (std::size_t d = 0; d < now.size(); ++d) previous[d] = after(now[d], -h, v[d]);
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

  void advance(std::int64_t count) {
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

  void do_strip(std::int32_t strip, const Stage& stage, int from, double time, double time_after) {
    driven.before(strip, data, from, time);
    step_function(data, stage, from, bodies.layout().strip_first[strip], bodies.layout().strip_first[strip + 1],
                  dissipation[strip]);
    driven.after(strip, data, stage, from, time, time_after, dissipation[strip]);
  }

  /// Velocities after a trial stage, and its contributions to the ledger.
  struct Trial {
    std::vector<DiscMotion> velocities;
    Dissipation dissipation;
    DrivingWork work;
  };
  /// \param relative velocities that dashpots read; empty without dashpots
  /// \param driven_too with supports, loads and walls
  [[nodiscard]] Trial try_stage(const Stage& stage, LaneVector<double> motion, LaneVector<double> velocity,
                                LaneVector<double> relative, bool driven_too = true) const {
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
    for (const Dissipation& of_strip : taken) trial.dissipation += of_strip;
    return trial;
  }

  /// Half the kick of leapfrog, from the velocities half a step behind to those of now.
  /// v_n is the mean of the velocities v-, v+ half a step before and after, and v- + 2 (v_n - v-) = v+ reaches the same
  /// positions as the whole step.
  [[nodiscard]] Trial half_kick() const {
    const Stage& whole = stages[0];
    const Stage half{.keep = 0.5 * (1 + whole.keep),
                     .kick = 0.5 * whole.kick,
                     .drift = 2 * whole.drift,
                     .drift_before = -whole.drift,
                     .duration = 0.5 * whole.duration};
    return try_stage(half, bodies.motion[parity], bodies.velocity, bodies.velocity_at[parity]);
  }

  /// Forces on the discs displaced by `motions`, dampers aside; of springs and gravity alone, or of all that acts.
  /// From rest no damper acts, and a kick of one second makes the acceleration of the velocity.
  [[nodiscard]] std::vector<DiscForce> forces_at(const std::vector<DiscMotion>& motions, bool driven_too) const {
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

  [[nodiscard]] std::vector<DiscMotion> synchronous_velocities() const {
    return staggered() ? half_kick().velocities : bodies.disc_velocities(bodies.velocity);
  }

  [[nodiscard]] std::vector<DiscMotion> motions() const {
    std::vector<DiscMotion> result = bodies.discs_of(bodies.motion[parity]);
    const double ahead = scheme_of(options.integrator).first_drift * options.time_step;
    if (ahead == 0) return result;
    const std::vector<DiscMotion> v = bodies.disc_velocities(bodies.velocity);
    for (std::size_t d = 0; d < v.size(); ++d) result[d] = after(result[d], -ahead, v[d]);
    return result;
  }

  [[nodiscard]] double elastic_energy(const std::vector<DiscMotion>& now) const {
    double energy = 0;
    for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
      const Contact& contact = scene.assembly.contacts[c];
      const DiscMotion &i = now[contact.i], &j = now[contact.j];
      if (kind.motion == LoopKind::Motion::finite) {
        energy += bond_energy(bond_of(scene.assembly, contact, scene.springs[c], scene.springs.bending(c)), i, j);
      } else {
        energy += linear_spring_energy(scene.springs[c], deformation(frame_of(scene.assembly, c), i, j));
        if (kind.bending) energy += bending_energy(scene.springs.bending(c), i.theta, j.theta);
      }
    }
    return energy + wall_pushes(scene, now, time_at(steps)).energy;
  }

  /// From the state that leapfrog keeps to the present, with v-, v the velocities half a step before and now, f the
  /// forces of springs, walls and gravity, g all others: m (v - v-) = h/2 (f + g), so that g works h/2 g.(v + v-)/2,
  /// and the energies then differ from those that leapfrog conserves, half a step behind, by h/4 f.(v - v-).
  void add_half_kick(const std::vector<DiscMotion>& now, EnergyLedger& ledger) const {
    const double h = options.time_step;
    const std::vector<DiscMotion> before = bodies.disc_velocities(bodies.velocity);
    const Trial half = half_kick();
    std::vector<DiscForce> forces = forces_at(now, false);
    const WallPushes pushes = wall_pushes(scene, now, time_at(steps));
    for (std::size_t d = 0; d < now.size(); ++d) {
      const Inertia& inertia = scene.inertia[d];
      const DiscMotion &v = half.velocities[d], &u = before[d];
      if (!pushes.forces.empty()) forces[d].force += pushes.forces[d];
      ledger.kinetic += kinetic_energy(inertia, v);
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

  [[nodiscard]] EnergyLedger raw_ledger() const {
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
    for (std::size_t d = 0; d < v.size(); ++d) result.kinetic += kinetic_energy(scene.inertia[d], v[d]);
    return result;
  }

  [[nodiscard]] EnergyLedger ledger() const {
    EnergyLedger result = raw_ledger();
    for (const EnergyTerm& term : energy_terms(BodyFamily::bonded)) {
      const bool of_state = term.value == &EnergyLedger::kinetic || term.value == &EnergyLedger::elastic_bonded;
      if (!of_state) result.*term.value -= at_start.*term.value;
    }
    result.initial = at_start.kinetic + at_start.elastic_bonded;
    return result;
  }
};

Simulation::Simulation(const Scene& scene, const SimulationOptions& options)
    : AnySimulation(BodyFamily::bonded, options.time_step),
      implementation_((check(scene, options), hidden<Implementation>(scene, options))) {}

void Simulation::advance(std::int64_t steps) {
  implementation_->advance(steps);
}
std::int64_t Simulation::step() const {
  return implementation_->steps;
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
                      .force = force_of(wall, gap),
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
    const Vec2 centre = s.scene.assembly.centres[disc] + motions[disc].u, on_wall = -force_of(wall, gap);
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

namespace {

constexpr auto dissipation_numbers = [](auto& d, const auto& visit) {
  visit(d.mass), visit(d.contact), visit(d.local);
};
constexpr auto work_numbers = [](auto& w, const auto& visit) { visit(w.loads), visit(w.supports), visit(w.walls); };

}  // namespace

SavedState Simulation::save() const {
  const Implementation& s = *implementation_;
  return {.step = s.steps,
          .arrays = {saved_rows("motions", s.bodies.discs_of(s.bodies.motion[s.parity]), motion_numbers),
                     saved_rows("previous", s.bodies.discs_of(s.bodies.motion[1 - s.parity]), motion_numbers),
                     saved_rows("velocities", s.bodies.disc_velocities(s.bodies.velocity), motion_numbers),
                     saved_rows("start", std::vector{s.at_start}, ledger_numbers(family())),
                     saved_rows("dissipation", s.dissipation, dissipation_numbers),
                     saved_rows("works", s.driven.sums(), work_numbers)}};
}

void Simulation::restore(const SavedState& state) {
  Implementation& s = *implementation_;
  const std::size_t discs = s.scene.assembly.size(), strips = s.dissipation.size();
  const auto motions = rows_in<DiscMotion>(state, "motions", motion_numbers),
             previous = rows_in<DiscMotion>(state, "previous", motion_numbers),
             velocities = rows_in<DiscMotion>(state, "velocities", motion_numbers);
  const auto at_start = rows_in<EnergyLedger>(state, "start", ledger_numbers(family()));
  auto dissipation = rows_in<Dissipation>(state, "dissipation", dissipation_numbers);
  auto works = rows_in<DrivingWork>(state, "works", work_numbers);
  if (motions.size() != discs || previous.size() != discs || velocities.size() != discs || at_start.size() != 1 ||
      dissipation.size() != strips || works.size() != strips) {
    bad_input(fmt::format("the saved state has {}", counted(static_cast<std::int64_t>(motions.size()), "disc")),
              fmt::format("this assembly has {}", discs), "Go on with the case that the state was saved from");
  }
  s.steps = state.step;
  s.parity = 0;
  s.bodies.put(motions, s.bodies.motion[0]);
  s.bodies.put(previous, s.bodies.motion[1]);
  s.bodies.put_velocities(velocities);
  s.at_start = at_start[0];
  s.dissipation = std::move(dissipation);
  s.driven.set_sums(std::move(works));
}

}  // namespace equidem
