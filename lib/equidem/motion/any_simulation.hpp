// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What every simulation in time offers: run loops, files and reports work with this alone.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/saved_state.hpp"

namespace equidem {

/// Simulation (bonded discs) and GrainSimulation (colliding bodies). Bodies are in the caller's order.
class AnySimulation {
 public:
  virtual ~AnySimulation() = default;

  [[nodiscard]] virtual BodyFamily family() const = 0;
  /// Active effects, and why the others are not.
  [[nodiscard]] virtual const Effects& effects() const = 0;
  /// Make steps. The same bits however they are cut into calls.
  virtual void advance(std::int64_t steps) = 0;
  [[nodiscard]] virtual std::int64_t step() const = 0;
  [[nodiscard]] virtual double time() const = 0;  ///< s
  /// Displacements and rotations of bonded discs, positions and angles of colliding bodies; m, rad.
  [[nodiscard]] virtual std::vector<DiscMotion> motions() const = 0;
  [[nodiscard]] virtual std::vector<DiscMotion> velocities() const = 0;  ///< m/s, rad/s
  [[nodiscard]] virtual EnergyLedger energy() const = 0;
  /// Bytes of all arrays of the loop, per body.
  [[nodiscard]] virtual double bytes_per_body() const = 0;

  [[nodiscard]] virtual SavedState save() const = 0;
  /// \throws Error (bad_input) where the state is of another number of bodies
  virtual void restore(const SavedState& state) = 0;

 protected:
  AnySimulation() = default;
  AnySimulation(const AnySimulation&) = default;
  AnySimulation& operator=(const AnySimulation&) = default;
};

}  // namespace equidem
