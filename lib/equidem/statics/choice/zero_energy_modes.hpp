// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The one decision about zero-energy modes of a network without negative springs, and about the work of loads on them.
///
/// A motion has no energy where no spring deforms. That depends on which springs there are, not on how stiff they are,
/// so that all are replaced by equal ones: the decision is the same for every kT/kN > 0, every unit and every rotation
/// of the assembly, and elimination does not have to tell the softest spring from the round-off of the stiffest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/linear/factorization.hpp"
#include "equidem/statics/choice/solver_choice.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {

/// The zero-energy modes of a system beside those that its unknowns hold, one for each of `components`, in which no
/// other can move once these are held.
class ZeroEnergyModes {
 public:
  /// By L D L^T of equal springs, until the components held leave no mode. \param system without negative springs
  /// \throws Error (computation_failed) where contacts deform in a motion that resists no more than round-off, or
  ///         memory does not suffice
  explicit ZeroEnergyModes(const System& system);

  [[nodiscard]] const std::vector<std::size_t>& components() const { return components_; }
  /// Of `components()[k]`, per component, to the rounding of a double: corrected by what contacts still resist. Not
  /// normalized.
  [[nodiscard]] std::vector<double> motion(std::size_t k) const;
  /// A copy of the unknowns of the system with `components()` held.
  [[nodiscard]] const DegreesOfFreedom& held_unknowns() const { return unknowns_; }

 private:
  /// A factorization, and the modes that it found: those of its zero pivots, or else the one of its softest pivot.
  struct Stage {
    DegreesOfFreedom unknowns;
    std::unique_ptr<Factorization> factor;
    std::size_t first = 0;
  };
  [[nodiscard]] std::vector<double> corrected(const Stage& stage, std::vector<double> motion) const;

  const Assembly& assembly_;
  const ContactGraph& graph_;
  ContactSprings equal_;
  DegreesOfFreedom unknowns_;
  std::vector<std::size_t> components_;
  std::vector<Stage> stages_;
};

/// Solves with a K that has zero-energy modes by holding one component for each. \param rest of K with these held
std::unique_ptr<Factorization> hold_modes(std::unique_ptr<Factorization> rest, ZeroEnergyModes modes);

/// Whether a load does work on a zero-energy mode: more than 1e-8 of the sizes of force and motion, disc by disc (those
/// of an angle of 1e-8 between them), and than 1e-12 of those of all, to which the mode is known where it should be at
/// rest. \param motion, force per component
bool does_work(std::span<const double> force, std::span<const double> motion, int per_disc);

}  // namespace equidem
