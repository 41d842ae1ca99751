// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that open, close, slip and stick, and bonds that break and go on as such, event by event along a path of
/// loading: states of equilibrium without inertia.
///
/// The answer depends on the path: dead loads come first, then lambda goes along its legs. Between two events all
/// forces are linear in lambda. At an event the rates of all contacts on a limit of their law are found together
/// (rate_path.hpp); with friction they need not be unique, and those are taken which Newton's method reaches from the
/// present states. A bond that breaks gives up its force in proportion while lambda is held; bonds that reach their
/// strength meanwhile join it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/breakage/event_path.hpp"
#include "equidem/breakage/unbonded/contact_events.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/breakage/unbonded/contact_rates.hpp"
#include "equidem/breakage/unbonded/rate_path.hpp"
#include "equidem/breakage/unbonded/unbonded_state.hpp"

namespace equidem {

struct UnbondedOptions {
  double friction = 0;               ///< mu of contacts without a bond
  std::vector<ContactForce> rest{};  ///< N/m, per contact: forces at rest, balanced by loads that stay; empty: none
};

/// \throws Error (bad_input) where the control is none of those that a path with a history has
void check_control_with_friction(const LoadPath& path);

class UnbondedRun final : public EventPath {
 public:
  /// Contacts whose strengths are both 0 are no bonds from the start. All of the scene must outlive the run.
  /// A contact without a bond whose force at rest pulls, N_r > 0, begins open with the gap N_r/kN.
  /// \throws Error (bad_input) where the friction is not a finite number >= 0, forces at rest are beyond it, or
  ///         check_control_with_friction() says so
  UnbondedRun(const BreakageScene& scene, const Effects& effects, std::span<const Support> supports,
              UnbondedOptions options);

  /// Discs without a support of which every contact is open as it is now, ascending. Those at first are idle();
  /// contacts with a gap may close later.
  [[nodiscard]] std::vector<std::int32_t> untouched() const;
  /// Rattlers: discs that can carry no force (load_bearing.hpp) in the network of bonds and of contacts that carry one,
  /// ascending, those untouched among them. Contacts that have carried nothing since lambda last moved hold no disc.
  [[nodiscard]] std::vector<std::int32_t> loose() const;
  [[nodiscard]] double lambda() const override { return state_.lambda(); }
  [[nodiscard]] bool has_history() const override { return true; }
  /// At motions since the last event.
  [[nodiscard]] double load_left(double motion) const override;
  [[nodiscard]] PathLedger ledger() const override { return state_.ledger(); }
  [[nodiscard]] const UnbondedState& contact_state() const { return state_; }
  [[nodiscard]] bool releasing() const override { return !state_.releasing().empty(); }
  [[nodiscard]] std::optional<PathState> state() const override;
  [[nodiscard]] SolverReport solver() const override;
  /// Everything between two calls of advance() that the scene does not say: a path that is restored goes on with the
  /// same bits.
  void pass(PathNumbers& n) {
    EQUIDEM_PASS(n, events_, points_, breaking_, rates_, dead_done_, standstill_, steps_, leg_, load_rate_);
    EQUIDEM_PASS(n, motion_rate_, share_, travelled_, end_, why_, largest_residual_, state_, solver_);
    if (n.restores() && end_ == PathEnd::most_events) end(PathEnd::none, {});  // this path may have more
  }

 private:
  void step() override;
  [[nodiscard]] LegPoint point() const override;
  [[nodiscard]] bool by_motion() const;
  [[nodiscard]] Driving driving() const;
  bool find_rates();
  void end_without_rates(const RateSearch& search, std::size_t on_limits);
  /// "at 37 % of the dead loads ", before a clause; nothing on the legs of lambda, whose place the report gives.
  [[nodiscard]] std::string at_dead_loads() const;
  [[nodiscard]] double stage_end() const;
  void go_on();
  /// \return false where the path ends
  bool move(double t);
  void finish_stage();
  void note_released();
  [[nodiscard]] double strength_of(const NextContactEvent& next) const;
  void break_bond(const NextContactEvent& next, double lambda_rate);
  void record_changes(std::span<const ContactStatus> after);

  Effects effects_;
  std::vector<Support> supports_;
  DegreesOfFreedom unknowns_;
  ContactOperator contacts_;
  TangentSolver solver_;
  std::vector<UnbondedLaw> laws_;
  UnbondedState state_;
  std::vector<std::size_t> breaking_;  // events whose energy behind them is not known yet
  std::vector<double> beside_;         // per component, of a release
  std::optional<Rates> rates_;
  bool dead_done_ = false;
  Standstill standstill_;
  std::int64_t steps_ = 0;  // of the release, or since the last event
  double load_rate_ = 0, motion_rate_ = 0, share_ = 0, travelled_ = 0;
  double largest_residual_ = 0;
};

}  // namespace equidem
