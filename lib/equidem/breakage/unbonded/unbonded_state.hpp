// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The state of a network with unbonded contacts: motions, and the history of each contact that its force depends on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/event_path.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/breakage/unbonded/contact_operator.hpp"
#include "equidem/breakage/unbonded/contact_rates.hpp"
#include "equidem/breakage/unbonded/tangent_solver.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {

class UnbondedState {
 public:
  /// Forces at rest are balanced by loads that stay. All arguments must outlive the state.
  UnbondedState(const Assembly& assembly, const ContactSprings& springs, const LoadPath& path,
                const DegreesOfFreedom& unknowns, const ContactOperator& contacts, std::span<const UnbondedLaw> laws,
                std::vector<ContactStatus> status);

  /// Everything moves on by t of these rates, with the statuses as they are, and is corrected until forces balance.
  /// \param dead whether lambda of the rates multiplies the dead loads
  void move(double t, const Rates& rates, bool dead, bool by_motion, TangentSolver& solver);
  /// The share of what broken bonds still carry falls from 1 to this.
  void release_to(double share) { share_ = share; }
  void set_status(std::size_t contact, ContactStatus status);
  /// Forces balance again where that of a contact has jumped with its status, since round-off had left it overlapped or
  /// pulled, while the control is held. The energy that its spring takes or gives is missing in the ledger.
  void settle(const Rates& rates, bool dead, bool by_motion, TangentSolver& solver);
  /// A bond breaks: it keeps its force beside the law of an unbonded contact until it is released.
  void break_bond(std::size_t contact, ContactStatus status);
  /// Nothing is left of the forces of broken bonds.
  void end_release();
  /// All that the constructor does not find.
  void pass(PathNumbers& n) {
    EQUIDEM_PASS(n, status_, slip_, motion_.high, motion_.low, lambda_, dead_, releasing_, kept_, share_, kept_share_);
    EQUIDEM_PASS(n, released_by_, deformation_, forces_, carried_, internal_, ledger_, residual_, force_scale_,
                 round_off_force_);
  }

  [[nodiscard]] const std::vector<ContactStatus>& status() const { return status_; }
  /// Per contact, N/m, those of broken bonds included.
  [[nodiscard]] std::span<const ContactForce> forces() const { return forces_; }
  /// Without what a broken bond has yet to give up, N/m.
  [[nodiscard]] ContactForce law_force(std::size_t contact) const {
    return laws_[contact].force(status_[contact], deformation_[contact], slip_[contact]);
  }
  /// Per contact: 1, whether it carries a force, or did where lambda began to move last.
  [[nodiscard]] const std::vector<std::uint8_t>& carried() const { return carried_; }
  /// N_r + kN dn of a contact: its normal force where it is closed, kN times its gap where it is open.
  [[nodiscard]] double normal_coordinate(std::size_t contact) const;
  /// Forces that broken bonds have yet to give up, per component, N/m, and the contacts that they belong to.
  [[nodiscard]] std::vector<double> unreleased() const;
  [[nodiscard]] const std::vector<std::size_t>& releasing() const { return releasing_; }
  [[nodiscard]] double released_by(std::size_t contact) const { return released_by_[contact]; }

  /// Deformation of each contact by the mean gradient of the pattern; empty: there is none.
  [[nodiscard]] const std::vector<ContactDeformation>& affine() const { return affine_; }
  [[nodiscard]] const PreciseMotion& motion() const { return motion_; }
  [[nodiscard]] double lambda() const { return lambda_; }
  [[nodiscard]] double dead() const { return dead_; }
  [[nodiscard]] double load() const;         ///< LoadPath
  [[nodiscard]] double mean_motion() const;  ///< LoadPath::motion
  [[nodiscard]] Tensor2 stress() const;      ///< Pa; 0 where the area is not known
  [[nodiscard]] const PathLedger& ledger() const { return ledger_; }
  /// The largest unbalanced force over the largest contact force or load so far; 0 as long as none of these is above
  /// 1e-9 of the largest motion times the stiffest spring: what acts is round-off.
  [[nodiscard]] double relative_residual() const { return residual_; }
  /// N/m, of contacts and loads so far.
  [[nodiscard]] double largest_force() const { return force_scale_; }
  /// Whether some force has been more than round-off of the stiffness times the motions.
  [[nodiscard]] bool carries() const;
  /// N/m: forces, and gaps times kN, below are round-off.
  [[nodiscard]] double negligible_force() const;

 private:
  void evaluate();
  void measure_residual(std::vector<double>& residual);
  void correct(bool by_motion, TangentSolver& solver);
  [[nodiscard]] double outside(std::size_t component) const;
  [[nodiscard]] double elastic_energy() const;
  /// The largest motion, or deformation by the mean strain, m.
  [[nodiscard]] double farthest() const;
  /// Forces that rounding of the motions so far may leave, N/m: slip keeps what it was added up with.
  [[nodiscard]] double round_off_force() const { return round_off_force_; }

  const Assembly& assembly_;
  const ContactSprings& springs_;
  const LoadPath& path_;
  const DegreesOfFreedom& unknowns_;
  const ContactOperator& contacts_;
  std::span<const UnbondedLaw> laws_;
  ContactGraph graph_;
  std::vector<ContactDeformation> affine_;
  std::vector<ContactStatus> status_;
  // Discs that nothing resists move far, and forces are small differences of deformation and slip.
  std::vector<DoubleDouble> slip_;  // m, plastic, per contact
  PreciseMotion motion_;
  double lambda_ = 0, dead_ = 0;
  std::vector<double> rest_load_;  // per component: what balances the forces at rest
  std::vector<std::size_t> releasing_;
  std::vector<ContactForce> kept_;     // of broken bonds, times share_
  double share_ = 0, kept_share_ = 0;  // as it is, and before the last move
  std::vector<double> released_by_;    // N, per contact
  std::vector<PreciseDeformation> deformation_;
  std::vector<ContactForce> forces_;
  std::vector<std::uint8_t> carried_;
  std::vector<double> internal_;
  PathLedger ledger_;
  double rest_energy_ = 0, residual_ = 0, force_scale_ = 0, round_off_force_ = 0;
  bool unsettled_ = false;
};

}  // namespace equidem
