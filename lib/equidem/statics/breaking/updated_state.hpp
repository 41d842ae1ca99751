// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motions and contact forces of a network behind an updated factor, each part of the network as of some earlier
/// change, and what brings a part up to date.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/updated_cholesky.hpp"
#include "equidem/statics/breaking/kernels/breaking_contacts.hpp"
#include "equidem/statics/breaking/motion_blocks.hpp"
#include "equidem/statics/breaking/updated_equilibrium.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {

class UpdatedState {
 public:
  struct Held {
    std::int64_t component;  ///< disc * per_disc + k
    double stiffness;        ///< Pa
  };

  UpdatedState(const Assembly& assembly, const ContactSprings& springs, DegreesOfFreedom unknowns,
               std::vector<RightHandSide> cases, std::vector<ContactStrength> strengths,
               const UpdatedEquilibriumOptions& options);

  [[nodiscard]] SpringNetwork network() const { return {assembly, graph, springs, unknowns}; }
  [[nodiscard]] std::size_t components() const { return unknowns.held.size(); }

  /// Blocks from that of a contact up to its root.
  [[nodiscard]] std::vector<std::int32_t> blocks_above(std::size_t contact) const;
  /// Apply what the boundaries of blocks have moved since their last visit, and the forward solution of `path` where it
  /// passes through; what stands above must be up to date.
  void bring_up_to_date(std::span<const std::int32_t> blocks, const FactorPath* path);
  /// The motions that follow from a change. \param blocks above its contact, all up to date before it
  void follow(const FactorPath& path, std::span<const std::int32_t> blocks);
  void bring_all_up_to_date();
  /// Bound on the relative residual that rounding has left since the motions were last refined, as of the last visits
  /// (updated_state.cpp says how it is found).
  [[nodiscard]] double rounding() const;
  /// True where motions were refined after the last visit that found any.
  [[nodiscard]] bool is_refined() const { return visits_.fronts == 0; }
  [[nodiscard]] FirstToBreak critical(const LoadFactorSearch& search);
  /// Behind critical(), per contact: its key where its block was brought up to date, else the bound of its subtree.
  [[nodiscard]] std::vector<double> least_keys(const LoadFactorSearch& search) const;

  /// The factor with other springs of one contact. \param changes of them that there are, normal before tangential
  /// \param moments get what sum F_i l_j changes by where it is taken out, per right-hand side
  FactorPath change_factor(std::size_t contact, const SpringConstants& to, std::span<const RankOneChange> changes,
                           std::span<const UpdatedCholesky::Load> loads, std::span<Tensor2> moments);
  /// Stretch and slip of the ends of a contact, as of the last visit.
  [[nodiscard]] ContactDeformation deformation(std::size_t contact, std::size_t of_case) const;
  /// Takes a contact out of all later searches.
  void spare(std::size_t contact) {
    contacts_[slot_[contact]].strength = {};
    classes_[slot_[contact]] = never_breaks;
  }
  void set_contact(std::size_t contact, SpringConstants k, std::span<const ContactForce> forces);
  [[nodiscard]] ContactForce force_of(std::size_t contact, std::size_t of_case) const;
  [[nodiscard]] std::span<const Held> holds() const { return holds_; }
  /// Hold a component that nothing resists any more. \return the stiffness, Pa
  double hold(std::int64_t component);
  /// Since the motions were last refined, as of the last visit, m.
  [[nodiscard]] double moved_by(std::int64_t component, std::size_t of_case) const;

  /// Likewise for all components, where everything is up to date.
  [[nodiscard]] std::vector<double> moved(std::size_t of_case) const;

  /// A factor of the network as it is; components are held where it is singular. \return whether one was found
  bool factorize();
  /// Everything must be up to date: motions become those since the last refinement and those before it.
  void fold_motions();
  /// The part of the loads that the contact law does not balance at the motions of the last refinement, N/m.
  /// \return the largest over `scales`
  double residual(LargeVector<double>& left) const;
  /// Add the motions that balance what is left, which is lost.
  void correct_motions(LargeVector<double>& left);
  /// Forces of all contacts from their motions.
  void evaluate_contacts();
  [[nodiscard]] double bytes() const;

  const Assembly& assembly;
  ContactGraph graph;
  ContactSprings springs;
  const ContactSprings first_springs;
  DegreesOfFreedom unknowns;
  std::vector<RightHandSide> cases;
  UpdatedEquilibriumOptions options;
  UpdateCounters counters;
  std::vector<double> scales;       ///< per right-hand side, N/m: reference of relative residuals
  std::vector<PreciseMotion> base;  ///< per right-hand side, when motions were last refined
  std::unique_ptr<UpdatedCholesky> factor;

 private:
  /// Sums of squares from which the rounding of a visit of a block is bounded, per right-hand side, N²/m².
  struct Visit {
    std::int64_t fronts = 0;              ///< swept back through
    std::array<double, 2> moved{};        ///< stiffness times motion since the visit before
    std::array<double, 2> accumulated{};  ///< stiffness times motion since the last refinement
  };
  struct BlockState {
    ClassedUtilization own;       ///< of the contacts of the block, as of its last visit
    ClassedUtilization subtree;   ///< at worst, as of its last visit
    ClassedUtilization at_worst;  ///< of its subtree now, where its parent is up to date
    double rate = 0;              ///< the largest utilization_rate of its subtree
    double pressed = 0;           ///< the largest friction / shear of its contacts, m/N
    /// Per right-hand side, square root of N: at most the root of sum N²/kN + T²/kT over the changes of forces in its
    /// subtree since its last visit, by breaks outside it.
    std::array<double, 2> reached{};
    bool open = false;  ///< of the search at hand: its children are looked at one by one
  };

  [[nodiscard]] std::span<double> column(LargeVector<double>& of, std::size_t of_case) const {
    return std::span(of).subspan(of_case * components(), components());
  }
  /// Motion of the boundary of a block since its last visit, of each right-hand side. \return whether there was any
  bool boundary_motion(std::size_t block, std::vector<double>& motion) const;
  Visit visit(std::size_t block, const FactorPath* path, int worker);
  void account(const Visit& visit);
  /// Adds to what has reached the subtrees beside the path of a change.
  void reach_beside(const FactorPath& path);
  /// The right-hand sides whose products with a motion are sum F_i l_j, solved for with L.
  void solve_moments();
  [[nodiscard]] double rate_of(const BreakingContact& contact) const;
  void class_contacts();
  void evaluate_block(std::size_t block);
  void evaluate_blocks();
  /// Utilizations at worst of the children of a block that is up to date, sharper where keys up to `limit` may be among
  /// them.
  void bound_children(std::size_t block, const LoadFactorSearch& search, double limit);
  /// The least key of the contacts of a block, and the least that does not tie with it.
  [[nodiscard]] std::array<double, 2> keys_of(std::size_t block, const LoadFactorSearch& search) const;
  [[nodiscard]] BreakingMoment moment_of(std::int64_t slot, const LoadFactorSearch& search) const {
    return breaking_moment(contacts_[slot].force, contacts_[slot].strength, options.friction, search);
  }
  /// The first to break among the contacts of open blocks with keys up to `limit`.
  [[nodiscard]] FirstToBreak first_of_open(const LoadFactorSearch& search, double limit) const;

  std::shared_ptr<const SymbolicFactor> symbolic_;
  std::unique_ptr<MotionBlocks> blocks_;
  std::vector<BlockState> states_;            // per block
  std::vector<BreakingContact> contacts_;     // in the order of blocks
  std::vector<std::uint8_t> classes_;         // of contacts_, rate_class or never_breaks
  double largest_rate_ = 0;                   // utilization_rate
  std::vector<std::int32_t> slot_;            // of each contact in contacts_
  LargeVector<double> moved_;                 // since the last refinement, in the order of elimination, case by case
  LargeVector<double> moments_;               // z of L z = q, xx, xy, yx, yy, in the order of elimination
  std::vector<double> boundary_;              // moved_ of the boundary of each block at its last visit
  std::vector<std::int32_t> path_offset_;     // into FactorPath::values, per front; -1: not on the path
  std::vector<LargeVector<double>> scratch_;  // per worker: motion since the last visit
  std::vector<std::int32_t> open_;            // blocks, parents first
  LoadFactorSearch search_;                   // of which the utilizations of blocks are
  std::vector<Held> holds_;
  Visit visits_;       // all since the last refinement
  double growth_ = 1;  // of the squares of errors of the factor since it was made
};

}  // namespace equidem
