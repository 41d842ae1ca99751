// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Loops written by hand that the simulation is compared with, and the limits of the machine.
#pragma once

#include <cstdint>
#include <memory>

#include "equidem/assembly/assembly.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"

namespace equidem::bench {

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

/// The usual loops: springs with rotation, leapfrog, small motions. Over neighbours each disc sums the forces of its
/// own contacts, so that each contact is computed twice.
std::unique_ptr<Contender> plain_loop_over_neighbours(const Assembly& assembly);
/// The force of each contact is added to both discs; then all discs move.
std::unique_ptr<Contender> plain_loop_over_pairs(const Assembly& assembly);

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
