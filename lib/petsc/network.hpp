// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A part of an assembly with its springs, effects and unknowns: what the statics of one rank refers to.
#pragma once

#include <span>
#include <vector>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/loads.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {

/// The effects of the whole scene, the same on all ranks.
Effects effects_of(const Ranks& ranks, const Part& part, const ContactSprings& springs, Rotation rotation);

/// Refers to what it is made of, which must outlive it and not move.
struct Network {
  /// \throws Error (bad_input) on all ranks, as number_unknowns
  Network(const Ranks& all, const Part& own, const Whole& sums, const ContactSprings& of_part, const Effects& of_whole,
          std::span<const Support> supports);

  [[nodiscard]] std::size_t block() const { return static_cast<std::size_t>(unknowns.per_disc); }
  /// Components of discs that this rank owns, and of these and their ghosts.
  [[nodiscard]] std::size_t owned() const { return static_cast<std::size_t>(part.owned) * block(); }
  [[nodiscard]] std::size_t size() const { return assembly.size() * block(); }
  [[nodiscard]] SpringNetwork local() const { return {assembly, graph, springs, unknowns}; }

  /// Hold components at zero: the name of a disc times 3 plus the component. The same on all ranks.
  void hold(std::span<const std::int64_t> components);
  /// f - f_int(motion) on free components of owned discs by the contact law in extended precision, 0 elsewhere.
  /// \param f per component, 0 for ghosts; empty: no load
  /// \param gradient of the mean displacement; none: 0
  void residual(const PreciseMotion& motion, const std::optional<Tensor2>& gradient, std::span<const double> f,
                std::span<double> result) const;
  /// f_int on owned discs, held or not: the negative of what contacts exert.
  [[nodiscard]] std::vector<double> internal(const PreciseMotion& motion) const;
  /// 2-norm over the owned discs of all ranks.
  [[nodiscard]] double norm(std::span<const double> x) const;

  const Ranks& ranks;
  const Part& part;
  const Assembly& assembly;  ///< of the part
  const Whole& whole;
  const ContactSprings& springs;
  const Effects& effects;
  Halo halo;
  ContactGraph graph;
  DegreesOfFreedom unknowns;
  bool may_be_indefinite;       ///< by a negative spring or by prestress, on any rank
  double stiffest;              ///< Pa: the largest spring of all ranks
  std::int64_t free_count = 0;  ///< unknowns of all ranks

 private:
  void apply(const Support& support);
  void hold_inert_rotations();
  void count();
};

/// Refuse supports that leave a rigid motion of the assembly free, or discs that can counter-rotate on a square
/// lattice. \throws Error (bad_input) on all ranks
void check_held(const Network& network);

}  // namespace equidem::petsc
