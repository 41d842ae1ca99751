// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The scenes that are stepped (an assembly set in smooth motion), loops written by hand that the simulation is
/// compared with, and the limits of the machine.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem::bench {

/// kN, kT of every spring, mass of every disc (that of radius 1), and step; about a third of the critical step.
inline constexpr SpringConstants scene_springs = {.kN = 1.0, .kT = 0.5};
inline constexpr Inertia scene_inertia = {.mass = 1.0, .moment = 0.5};
inline constexpr double time_step = 0.2;

/// A wave as long as the assembly, of one hundredth of a radius.
std::vector<DiscMotion> start_motions(const Assembly& assembly);

/// A simulation of springs kN and kT with the springs that it refers to: "normal" has no kT, "tangential" restrains
/// rotation.
class Scenery {
 public:
  explicit Scenery(const Assembly& assembly, LoopKind::Springs springs = LoopKind::Springs::rotation);
  [[nodiscard]] Simulation& simulation() { return simulation_; }

 private:
  ContactSprings springs_;
  Simulation simulation_;
};

class Contender {
 public:
  Contender() = default;
  virtual ~Contender() = default;
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  virtual void advance(std::int64_t steps) = 0;
  /// Sum of the squares of all velocities, by which the motions of two loops are compared.
  [[nodiscard]] virtual double activity() const = 0;
};

/// The usual loop: springs with rotation, leapfrog, small motions. The force of each contact is added to both discs;
/// then all discs move.
std::unique_ptr<Contender> plain_loop(const Assembly& assembly);

/// The loop of the library for small motions, equal springs and discs, leapfrog, with its layout of memory and its
/// vectors, but without anything that a scene may switch on.
std::unique_ptr<Contender> loop_by_hand(const Assembly& assembly, LoopKind::Springs springs);

/// Limits of one core.
struct Limits {
  double bandwidth = 0;   ///< bytes/s of a_i = b_i + s c_i on arrays far larger than the caches, 24 bytes per i
  double arithmetic = 0;  ///< operations/s of multiply-adds on four doubles at once, each counted as two
};
Limits machine_limits();

}  // namespace equidem::bench
