// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Simulation in time of bonded discs, with the assembly, springs and contact law of statics.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/names.hpp"
#include "equidem/dynamics/integrators.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/motion/schedule.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem {

template <>
struct EnumNames<LoopKind::Motion> {
  using enum LoopKind::Motion;
  static constexpr const char* what = "kind of motion";
  static constexpr NamedValue<LoopKind::Motion> list[] = {{small, "small"}, {finite, "finite"}};
};

/// Prescribed displacement (m, rad) of the discs of a group over time; a component without a schedule is free.
struct TimedSupport {
  std::string group;
  std::optional<Schedule> ux, uy, rotation;
};

/// A load times a factor that changes with time; a constant factor needs its value, 1.
struct TimedLoad {
  Load load;
  Schedule factor;
};

/// Initial velocity of the discs of a group, whose components are not prescribed; a spin needs rotations as unknowns.
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
  /// tau_N, tau_T, s: dashpots c_N = tau_N kN, c_T = tau_T kT at contacts, Kelvin-Voigt springs of different times.
  double normal_time = 0, tangential_time = 0;

  /// True where contacts have dashpots.
  [[nodiscard]] bool dashpots() const { return stiffness > 0 || contact > 0 || normal_time > 0 || tangential_time > 0; }
  /// Forces that depend on velocities, but for mass-proportional damping: all schemes evaluate them at least half a
  /// step late, which makes any of them one of order 1.
  [[nodiscard]] bool acts_late() const { return dashpots() || local > 0; }
};

struct SimulationOptions {
  LoopKind::Motion motion = LoopKind::Motion::small;
  Integrator integrator = Integrator::leapfrog;
  Rotation rotation = Rotation::from_scene;
  Damping damping = {};
  double time_step = 0;                 ///< s, > 0
  std::size_t discs_per_thread = 4000;  ///< with fewer discs per thread, synchronization takes longer than the work
};

/// Order of the motions in the time step.
inline int order_of(const SimulationOptions& options) {
  return options.damping.acts_late() ? 1 : scheme_of(options.integrator).order;
}

/// The scene of a simulation; the assembly and the springs must outlive the simulation.
struct Scene : AnyScene {
  Scene(const Assembly& assembly_in, const ContactSprings& springs_in, std::vector<Inertia> inertia_in)
      : assembly(assembly_in), springs(springs_in), inertia(std::move(inertia_in)) {}

  const Assembly& assembly;
  const ContactSprings& springs;
  std::vector<Inertia> inertia;  ///< per disc
  std::vector<TimedSupport> supports = {};
  std::vector<TimedLoad> loads = {};
  std::vector<InitialVelocity> velocities = {};
};

/// All bonds in the order of the assembly, then the walls that push, with the forces of their springs on discs
/// displaced by `motions`; arms and shifts are those of the start.
std::vector<BodyContact> bonded_contacts(const Scene& scene, LoopKind::Motion motion,
                                         const std::vector<DiscMotion>& motions, double time);

class Simulation final : public AnySimulation {
 public:
  /// Determines the effects, chooses the loop, lays out memory.
  /// \throws Error (bad_input) on a group that does not exist, motions prescribed twice, an initial velocity where the
  ///         motion is prescribed, a wall as check_wall, a mass that is not positive, a damping out of range or not
  ///         supported by the integrator
  Simulation(const Scene& scene, const SimulationOptions& options);

  [[nodiscard]] const Effects& effects() const override;
  /// Results are also bit-identical for every number of threads.
  void advance(std::int64_t steps) override;
  [[nodiscard]] std::int64_t step() const override;
  [[nodiscard]] std::vector<DiscMotion> motions() const override;
  /// Velocities at the time of motions() (leapfrog: the mean of half a step before and after).
  [[nodiscard]] std::vector<DiscMotion> velocities() const override;
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override;
  /// Kinetic energy of velocities(), elastic energy of motions().
  [[nodiscard]] EnergyLedger energy() const override;
  /// Forces of springs at motions(); impulses and works of single walls are not summed up.
  [[nodiscard]] std::vector<WallState> walls() const override;
  [[nodiscard]] double bytes_per_body() const override;
  /// Arrays: motions and previous (one step before), (n, 3); velocities as stored by the integrator (leapfrog: half a
  /// step behind), (n, 3); sums of losses and work of the loop.
  [[nodiscard]] SavedState save() const override;
  void restore(const SavedState& state) override;

  /// Resultant of contacts, loads, walls and gravity at the present time on every disc displaced by `motions`, without
  /// damping; 0 where the motion is prescribed.
  [[nodiscard]] std::vector<DiscForce> unbalanced_forces(const std::vector<DiscMotion>& motions) const;
  /// The first disc whose motion or velocity is not finite; -1: none.
  [[nodiscard]] std::int64_t first_runaway() const;

 private:
  struct Implementation;
  Hidden<Implementation> implementation_;
};

}  // namespace equidem
