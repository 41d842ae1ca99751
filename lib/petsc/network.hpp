// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A part of an assembly with its springs, effects and unknowns: what the statics of one rank refers to.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/supports.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {

/// The effects of the whole scene, the same on all ranks.
/// \throws Error (bad_input) where contacts have bending springs
Effects effects_of(const Ranks& ranks, const Part& part, const ContactSprings& springs, Rotation rotation);

/// Refers to the part and the springs, which must outlive it and not move.
class Network {
 public:
  /// \throws Error (bad_input) on all ranks, as number_unknowns
  Network(const Ranks& ranks, const Part& part, const Whole& whole, const ContactSprings& springs,
          const Effects& effects, std::span<const Support> supports);

  [[nodiscard]] const Ranks& ranks() const { return ranks_; }
  [[nodiscard]] const Part& part() const { return part_; }
  [[nodiscard]] const Whole& whole() const { return whole_; }
  [[nodiscard]] const Assembly& assembly() const { return part_.assembly; }
  [[nodiscard]] const ContactSprings& springs() const { return springs_; }
  [[nodiscard]] const DegreesOfFreedom& unknowns() const { return unknowns_; }
  [[nodiscard]] const ContactGraph& graph() const { return graph_; }
  [[nodiscard]] const Halo& halo() const { return halo_; }
  [[nodiscard]] std::size_t block() const { return static_cast<std::size_t>(unknowns_.per_disc); }
  /// Components of discs that this rank owns, and of these and their ghosts.
  [[nodiscard]] std::size_t owned() const { return static_cast<std::size_t>(part_.owned) * block(); }
  [[nodiscard]] std::size_t size() const { return assembly().size() * block(); }
  [[nodiscard]] bool any_negative() const { return any_negative_; }
  /// Pa: the largest spring of all ranks.
  [[nodiscard]] double stiffest() const { return stiffest_; }
  /// Unknowns of all ranks.
  [[nodiscard]] std::int64_t free_count() const { return free_count_; }
  [[nodiscard]] std::int64_t free_rotations() const { return free_rotations_; }

  /// Hold components at zero: the name of a disc times 3 plus the component. The same on all ranks.
  void hold(std::span<const std::int64_t> components);
  /// f - f_int(motion) on free components of owned discs by the contact law in extended precision, 0 elsewhere.
  /// \param f per component, 0 for ghosts; empty: no load
  /// \param gradient of the mean displacement; none: 0
  void residual(const PreciseMotion& motion, const std::optional<Tensor2>& gradient, std::span<const double> f,
                std::span<double> result) const;
  /// Forces of contacts on owned discs, held or not, negative: f_int.
  [[nodiscard]] std::vector<double> internal(std::span<const ContactForce> forces) const;
  /// 2-norm over the owned discs of all ranks.
  [[nodiscard]] double norm(std::span<const double> x) const;

 private:
  void apply(const Support& support, const Effects& effects);
  void hold_inert_rotations();
  void count();

  const Ranks& ranks_;
  const Part& part_;
  const Whole& whole_;
  const ContactSprings& springs_;
  Halo halo_;
  ContactGraph graph_;
  DegreesOfFreedom unknowns_;
  bool any_negative_ = false;
  double stiffest_ = 0;
  std::int64_t free_count_ = 0, free_rotations_ = 0;
};

/// Refuse supports that leave a rigid motion of the assembly free, or discs that can counter-rotate on a square
/// lattice. \throws Error (bad_input) on all ranks
void check_held(const Network& network, const Effects& effects);

}  // namespace equidem::petsc
