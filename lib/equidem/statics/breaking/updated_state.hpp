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
#include "equidem/statics/breaking/kernels/precise_forces.hpp"
#include "equidem/statics/breaking/motion_blocks.hpp"
#include "equidem/statics/breaking/updated_equilibrium.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {

/// Gradients of motions whose works are the sums F_i l_j over contacts.
constexpr std::array<Tensor2, 4> moment_gradients = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

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
  void bring_all_up_to_date() { bring_all_up_to_date(Forces::follow); }
  /// Likewise, but forces of contacts are as before: evaluate() has to follow.
  void bring_motions_up_to_date() { bring_all_up_to_date(Forces::stay); }
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

  /// A factor of the network as it is; components are held where it is singular. \return whether one was found
  bool factorize();
  /// Behind bring_motions_up_to_date(): evaluate the forces of all contacts by the contact law in extended precision,
  /// and what part of the loads they do not balance. Motions from here on are kept apart.
  /// \return the relative residual, the largest of all right-hand sides
  double evaluate();
  /// Behind evaluate(): the part of the load on a component that is not balanced, N/m.
  [[nodiscard]] double unbalanced(std::int64_t component, std::size_t of_case) const;
  /// Behind evaluate(), once: solve L y = r for what is not balanced. Blocks get the motions that balance it when they
  /// are next brought up to date.
  /// \return the energy of the correction over that of the state, the root of it, the largest of all right-hand sides
  double correct();
  /// Behind evaluate() and correct(): from here on motions may grow in proportion to what they are now
  /// (updated_sums.cpp).
  void follow_bases();
  /// The largest factor by which motions have grown in proportion since they were last refined.
  [[nodiscard]] double grown() const;
  /// Directly behind evaluate() or correct(): of the motions, with their correction where there is one.
  [[nodiscard]] EquilibriumSums sums() const;
  /// As UpdatedEquilibrium::driven_mechanism.
  [[nodiscard]] std::vector<DiscMotion> driven_mechanism(std::int64_t component) const;
  /// Motions of all components, everything brought up to date.
  [[nodiscard]] PreciseMotion motion(std::size_t of_case);
  [[nodiscard]] double bytes() const;

  const Assembly& assembly;
  ContactGraph graph;
  ContactSprings springs;
  const ContactSprings first_springs;
  DegreesOfFreedom unknowns;
  std::vector<RightHandSide> cases;
  UpdatedEquilibriumOptions options;
  UpdateCounters counters;
  std::vector<double> scales;  ///< per right-hand side, N/m: reference of relative residuals
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
    /// Likewise for the correction of its interior with the boundary at rest, as of the last refinement.
    std::array<double, 2> corrected{};
    std::array<double, 2> more{};  ///< UpdatedState::more_ at its last visit
    bool to_correct = false;       ///< since the last refinement it was not visited
    bool open = false;             ///< of the search at hand: its children are looked at one by one
  };
  /// Whether forces of contacts follow as motions are brought up to date.
  enum class Forces : std::uint8_t { follow, stay };

  [[nodiscard]] std::span<double> column(LargeVector<double>& of, std::size_t of_case) const {
    return std::span(of).subspan(of_case * components(), components());
  }
  [[nodiscard]] std::span<const double> column(const LargeVector<double>& of, std::size_t of_case) const {
    return std::span(of).subspan(of_case * components(), components());
  }
  /// Motion of the boundary of a block since its last visit beside that of the base, of each right-hand side.
  /// \return whether there was any
  bool boundary_motion(std::size_t block, std::vector<double>& motion) const;
  /// Likewise, with that of the base.
  bool whole_boundary_motion(std::size_t block, std::vector<double>& motion) const;
  /// By how much of the base motions have grown since the last visit of a block.
  [[nodiscard]] double grown_since_visit(std::size_t block, std::size_t of_case) const {
    return more_[of_case] - states_[block].more[of_case];
  }
  /// Lets motions grow in proportion, by the share of the base that leaves the least beside it of what follows from a
  /// change.
  void grow_by(const FactorPath& path);
  Visit visit(std::size_t block, const FactorPath* path, int worker, Forces forces = Forces::follow);
  void bring_all_up_to_date(Forces forces);
  /// K u - f of a component that is held, N/m, behind evaluate().
  [[nodiscard]] double reaction(std::size_t component, std::size_t of_case) const;
  void account(const Visit& visit);
  /// Adds to what has reached the subtrees beside the path of a change.
  void reach_beside(const FactorPath& path);
  /// Number of columns of followed_ before those of the right-hand sides: of the sums F_i l_j.
  [[nodiscard]] std::size_t moments() const { return options.force_moments ? moment_gradients.size() : 0; }
  /// L^-1 h, with the forces h that drive the free discs.
  [[nodiscard]] std::span<const double> of_loads(std::size_t of_case) const {
    return column(followed_, moments() + of_case);
  }
  /// L^-1 K u of the base u.
  [[nodiscard]] std::span<double> of_base(std::size_t of_case) {
    return column(followed_, moments() + cases.size() + of_case);
  }
  /// Loads that were not balanced when motions were last refined, r, or y of L y = r.
  [[nodiscard]] std::span<double> left(std::size_t of_case) {
    return column(followed_, moments() + 2 * cases.size() + of_case);
  }
  [[nodiscard]] std::span<const double> left(std::size_t of_case) const {
    return column(followed_, moments() + 2 * cases.size() + of_case);
  }
  /// Right-hand sides whose products with a motion are works and the sums F_i l_j, solved for with L.
  void solve_followed();
  /// Writes the forces of what holds components, moved by the base, into of_base(), N/m.
  void force_holds();
  /// Prescribed motions, all free components at rest.
  [[nodiscard]] PreciseMotion driving_motion(std::size_t of_case) const;
  /// The stretch and slip of a contact by these and the mean strain.
  [[nodiscard]] ContactDeformation driving_deformation(std::size_t contact, std::size_t of_case) const;
  [[nodiscard]] MotionLayout layout() const { return {symbolic_->block, unknowns.rotation_scale}; }
  [[nodiscard]] PreciseColumn base(std::size_t of_case) const {
    const PreciseMotion& motion = base_[of_case];
    return {motion.high.data(), motion.low.empty() ? nullptr : motion.low.data()};
  }
  [[nodiscard]] ContactOffsets offsets_of(std::int32_t slot) const {
    return offsets_.empty() ? ContactOffsets{} : offsets_[slot];
  }
  [[nodiscard]] std::span<const ContactOffsets> offsets(std::size_t begin, std::size_t count) const {
    return offsets_.empty() ? std::span<const ContactOffsets>{} : std::span(offsets_).subspan(begin, count);
  }
  [[nodiscard]] ContactDeformation affine_deformation_of(std::size_t contact, std::size_t of_case) const;
  [[nodiscard]] double rate_of(const BreakingContact& contact) const;
  void class_contacts();
  void evaluate_block(std::size_t block);
  void evaluate_blocks();
  void include_subtrees();
  /// Everything is up to date: motions since the last refinement are added to those before it.
  void fold_motions();
  /// \return sum N²/kN + T²/kT, N
  double evaluate_forces(std::size_t of_case);
  /// Residual of the forces of a right-hand side, into left_. \return its length, N/m
  double balance(std::size_t of_case);
  /// Utilizations at worst of the children of a block that is up to date.
  void bound_children(std::size_t block);
  /// The least key of the contacts of a block, and the least that does not tie with it.
  [[nodiscard]] std::array<double, 2> keys_of(std::size_t block, const LoadFactorSearch& search) const;
  [[nodiscard]] BreakingMoment moment_of(std::int64_t slot, const LoadFactorSearch& search) const {
    const ProportionalForce force{forces_.size() > 1 ? forces_[1][slot] : ContactForce{}, forces_[0][slot]};
    return breaking_moment(force, contacts_[slot].strength, options.friction, search);
  }
  /// The first to break among the contacts of open blocks with keys up to `limit`.
  [[nodiscard]] FirstToBreak first_of_open(const LoadFactorSearch& search, double limit) const;

  std::shared_ptr<const SymbolicFactor> symbolic_;
  std::unique_ptr<MotionBlocks> blocks_;
  std::vector<BlockState> states_;                 // per block
  std::vector<BreakingContact> contacts_;          // in the order of blocks
  std::vector<ContactOffsets> offsets_;            // of contacts_; empty where all contacts are on the lines of centres
  std::vector<std::vector<ContactForce>> forces_;  // of contacts_, per right-hand side
  std::vector<std::uint8_t> classes_;              // of contacts_, rate_class or never_breaks
  double largest_rate_ = 0;                        // utilization_rate
  std::vector<std::int32_t> slot_;                 // of each contact in contacts_
  LargeVector<double> moved_;        // since then, beside the base, in the order of elimination, case by case
  LargeVector<double> followed_;     // solutions with L, likewise: of_loads() and others, then of_base(), then left()
  std::vector<double> boundary_;     // moved_ of the boundary of each block at its last visit
  std::vector<PreciseMotion> base_;  // when motions were last refined, in the order of elimination
  // Motions are (1 + more_) times the base and moved_. Right-hand sides of loads alone; others do not grow.
  std::array<double, most_right_sides> more_{};
  std::array<bool, most_right_sides> grows_{};
  std::array<double, most_right_sides> work_of_base_{};  // of the loads on the base, N
  std::array<double, most_right_sides> twice_energy_{};  // behind evaluate(), N
  bool corrected_ = false;                               // since evaluate()
  bool held_solved_ = false;                             // of_base() holds L^-1 of the forces of holds_ on the base
  std::vector<ForceRemainder> remainders_;               // of the forces of contacts_
  std::vector<std::int32_t> path_offset_;                // into FactorPath::values, per front; -1: not on the path
  std::vector<LargeVector<double>> scratch_;             // per worker: motion since the last visit
  std::vector<std::int32_t> open_;                       // blocks, parents first
  LoadFactorSearch search_;                              // of which the utilizations of blocks are
  std::vector<Held> holds_;
  Visit visits_;       // all since the last refinement
  double growth_ = 1;  // of the squares of errors of the factor since it was made
};

}  // namespace equidem
