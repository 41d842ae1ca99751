// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The same assembly, springs and contact law as statics, stepped in time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/dynamics/integrator.hpp"
#include "equidem/dynamics/schedule.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

/// Prescribed displacement (m, rad) of the discs of a group over time; a component without a schedule is free.
struct TimedSupport {
  std::string group;
  std::optional<Schedule> ux, uy, rotation;
};

/// A load times a factor that changes with time; give a constant factor its value, 1.
struct TimedLoad {
  Load load;
  Schedule factor;
};

/// A straight wall, the half plane behind the line through `point` with the unit normal that points to the discs;
/// pushes discs that enter it, kN per m of overlap; without friction.
struct Wall {
  std::string name;
  Vec2 point;             ///< m
  Vec2 normal;            ///< unit, towards the discs
  double kN = 0;          ///< Pa, > 0
  Schedule displacement;  ///< m, along the normal
};

/// Velocity at the start of the discs of a group; a prescribed motion overrules it, and where rotations are no unknowns
/// no spin is kept.
struct InitialVelocity {
  std::string group;
  Vec2 velocity;    ///< m/s
  double spin = 0;  ///< rad/s
};

struct Damping {
  double mass = 0;       ///< alpha, 1/s: force -alpha m v
  double stiffness = 0;  ///< beta, s: force -beta K v, dashpots c = beta k at contacts
  double contact =
      0;  ///< zeta: dashpots c_N = 2 zeta sqrt(m kN), c_T = 2 zeta sqrt(m |kT|) at contacts, m the reduced mass
  double local = 0;  ///< in [0, 1): share of the resultant force that acts against the velocity (Cundall)
};

struct SimulationOptions {
  LoopKind::Motion motion = LoopKind::Motion::small;
  Integrator integrator = Integrator::leapfrog;
  Rotation rotation = Rotation::from_scene;
  Damping damping = {};
  Vec2 gravity = {};                    ///< m/s²
  double time_step = 0;                 ///< s, > 0
  std::size_t discs_per_thread = 4000;  ///< with fewer, threads wait longer for one another than they work
};

/// What is simulated; the assembly and the springs must outlive the simulation.
struct Scene {
  const Assembly& assembly;
  const ContactSprings& springs;
  std::vector<Inertia> inertia;  ///< per disc
  std::vector<TimedSupport> supports = {};
  std::vector<TimedLoad> loads = {};
  std::vector<Wall> walls = {};
  std::vector<InitialVelocity> velocities = {};
};

/// Resultant of all that acts on a disc.
struct DiscForce {
  Vec2 force;         ///< N/m
  double moment = 0;  ///< N
};

/// Energies at time(), J per m per m of depth = N; kinetic energy of velocities(), elastic energy of motions().
///
/// Leapfrog does not keep their sum, it lets it sway: by sway = h²/8 f.a, f the forces of springs, walls and gravity, a
/// the accelerations (free vibration: h²/8 a.M a, the share (omega h)²/4 of the elastic energy of a mode). With it the
/// balance is exact but for rounding where forces are linear in the motion; for finite motions and discs that meet
/// walls it closes to the order of the integrator, work of loads and supports to the second.
struct EnergyLedger {
  double kinetic = 0;
  double elastic = 0;                                            ///< contacts and walls
  double potential = 0;                                          ///< gravity, 0 at the start
  double sway = 0;                                               ///< 0 at the start; 0 for other integrators
  double damped_mass = 0, damped_contact = 0, damped_local = 0;  ///< dissipated since the start
  double work_of_loads = 0, work_of_supports = 0, work_of_walls = 0;
  double initial = 0;  ///< kinetic + elastic at the start
  [[nodiscard]] double dissipated() const { return damped_mass + damped_contact + damped_local; }
  [[nodiscard]] double input() const { return work_of_loads + work_of_supports + work_of_walls; }
  /// What the balance lacks: kinetic + elastic + potential - sway + dissipated - input - initial.
  [[nodiscard]] double error() const { return kinetic + elastic + potential - sway + dissipated() - input() - initial; }
};

/// Everything that a run needs to go on with the same bits: arrays per disc, independent of how they lie in memory.
struct SimulationState {
  std::int64_t step = 0;
  std::vector<DiscMotion> motions;     ///< now
  std::vector<DiscMotion> previous;    ///< one step before
  std::vector<DiscMotion> velocities;  ///< as the integrator keeps them (leapfrog: half a step behind)
  EnergyLedger ledger;                 ///< at this time
  std::vector<double> sums;            ///< what the ledger is summed up from, as the loop keeps it
};

class Simulation {
 public:
  /// Decide the effects, pick the loop, lay out memory.
  /// \throws Error (bad_input) on a group that does not exist, motions prescribed twice, a mass that is not positive, a
  ///         damping out of
  ///         range or not known to the integrator
  Simulation(const Scene& scene, const SimulationOptions& options);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Make steps. The same bits however they are cut into calls and for every number of threads.
  void advance(std::int64_t steps);

  [[nodiscard]] std::int64_t step() const;
  [[nodiscard]] double time() const;
  [[nodiscard]] std::vector<DiscMotion> motions() const;
  /// Velocities at the time of motions() (leapfrog: the mean of half a step before and after).
  [[nodiscard]] std::vector<DiscMotion> velocities() const;
  /// What contacts, loads, walls and gravity leave unbalanced now on every disc displaced by `motions`, dampers aside;
  /// 0 where the motion is prescribed.
  [[nodiscard]] std::vector<DiscForce> unbalanced_forces(const std::vector<DiscMotion>& motions) const;
  [[nodiscard]] EnergyLedger energy() const;
  /// The loop that was picked, active effects and why others are not.
  [[nodiscard]] const LoopKind& loop() const;
  [[nodiscard]] const Effects& effects() const;
  /// Bytes of all arrays of the loop, per disc.
  [[nodiscard]] double bytes_per_disc() const;
  /// The first disc whose motion or velocity is not finite; -1: none.
  [[nodiscard]] std::int64_t first_runaway() const;

  [[nodiscard]] SimulationState save() const;
  /// \throws Error (bad_input) where the state is of another number of discs
  void restore(const SimulationState& state);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace equidem
