// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that open, close, slip and stick, and bonds that break and go on as such, event by event along a path of
/// loading: states of equilibrium without inertia.
///
/// The answer depends on the path: dead loads come first, then lambda goes along its legs. Between two events all
/// forces are linear in lambda. At an event the rates of all contacts on a limit of their law are found together
/// (contact_rates.hpp), and other answers of that problem are looked for (rate_branches.hpp). A bond that breaks gives
/// up its force in proportion while lambda is held; bonds that reach their strength meanwhile join it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/unbonded/contact_events.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/breakage/unbonded/contact_rates.hpp"
#include "equidem/breakage/unbonded/rate_search.hpp"
#include "equidem/breakage/unbonded/standstill.hpp"
#include "equidem/breakage/unbonded/unbonded_state.hpp"

namespace equidem {

struct UnbondedOptions {
  double friction = 0;               ///< mu of contacts without a bond
  std::vector<ContactForce> rest{};  ///< N/m, per contact: forces at rest, balanced by loads that stay; empty: none
};

struct UnbondedCounters {
  std::int64_t factorizations = 0, updates = 0;
  std::int64_t unique = 0;      ///< increments of which no other answer exists
  std::int64_t not_unique = 0;  ///< of which another answer was found
  std::int64_t no_answer = 0;   ///< of which no combination of states of contacts on limits balances
  std::int64_t unchecked = 0;   ///< neither proved to have one answer nor decided by all combinations of statuses
  std::int64_t ties = 0;        ///< of which all combinations were tried, and round-off decides on one of them
  std::int64_t most_unchecked_contacts = 0;  ///< on limits, of an increment with too many combinations
  /// Relative, of the rates of motion and of load of the first other answer.
  double largest_motion_difference = 0, largest_load_difference = 0;
  double largest_residual = 0;  ///< of the states of the path, relative

  /// Without those of the solver.
  void pass(PathNumbers& n) {
    n.pass(unique, not_unique, no_answer, unchecked, ties, most_unchecked_contacts);
    n.pass(largest_motion_difference, largest_load_difference, largest_residual);
  }
};

class UnbondedRun : public EventPath {
 public:
  /// Contacts whose strengths are both 0 are no bonds from the start. All of the scene must outlive the run.
  /// A contact without a bond whose force at rest pulls, N_r > 0, begins open with the gap N_r/kN.
  /// \throws Error (bad_input) where the friction is not a finite number >= 0, forces at rest are beyond it, or the
  ///         control is none of those that a path with a history has
  UnbondedRun(BreakageScene scene, const Effects& effects, std::span<const Support> supports, UnbondedOptions options);

  bool advance() override;
  [[nodiscard]] const std::vector<BreakEvent>& events() const override { return events_; }
  [[nodiscard]] PathEnd end() const override { return end_; }
  [[nodiscard]] const std::string& why() const override { return why_; }
  [[nodiscard]] std::vector<LegPoint> leg_points() const override { return points_; }
  [[nodiscard]] double direction(std::int64_t leg) const override;
  /// Discs that touch nothing at first; contacts with a gap may close later.
  [[nodiscard]] const std::vector<std::int32_t>& idle() const override { return idle_; }
  /// Discs without a support of which every contact is open as it is now, ascending.
  [[nodiscard]] std::vector<std::int32_t> untouched() const;
  /// Discs that have come loose, as in a network whose contacts do not rub (loose_discs.hpp), those untouched among
  /// them: contacts that have carried nothing since lambda last moved hold no disc.
  [[nodiscard]] std::vector<std::int32_t> loose() const;
  [[nodiscard]] double lambda() const override { return state_->lambda(); }
  [[nodiscard]] bool has_history() const override { return true; }
  /// At motions since the last event.
  [[nodiscard]] double load_left(double motion) const override;
  [[nodiscard]] double elastic_energy() const override { return state_->ledger().elastic; }
  [[nodiscard]] double released() const override { return state_->ledger().released; }
  [[nodiscard]] double energy_error() const override { return state_->ledger().error(); }
  [[nodiscard]] const UnbondedState& state() const { return *state_; }
  /// Whether the path is within the break of bonds, whose forces are partly given up.
  [[nodiscard]] bool releasing() const { return !state_->releasing().empty(); }
  [[nodiscard]] UnbondedCounters counters() const;
  /// Everything between two calls of advance() that the scene does not say: a path that is restored goes on with the
  /// same bits.
  void pass(PathNumbers& n) {
    n.pass(events_, points_, breaking_, begun_, rates_, dead_done_, checked_, standstill_, leg_, load_rate_);
    n.pass(motion_rate_, share_, travelled_, end_, why_, counters_, *state_, solver_);
    if (n.restores() && end_ == PathEnd::most_events) end(PathEnd::none, {});  // this path may have more
  }

 private:
  [[nodiscard]] bool by_motion() const;
  [[nodiscard]] Driving driving() const;
  bool find_rates();
  void look_for_branches(const RateProblem& problem, const RateAnswer& answer, std::size_t first);
  [[nodiscard]] double load_rate_of(const Rates& rates, std::span<const ContactStatus> status) const;
  [[nodiscard]] double stage_end() const;
  /// \return false where the path ends
  bool move(double t);
  void finish_stage();
  void tell_released();
  void add_leg_point();
  void break_bond(const NextContactEvent& next, double lambda_rate);
  BreakEvent event_of(std::size_t contact, BreakMode mode) const;
  void record_changes(std::span<const ContactStatus> after);
  void count_unchecked(std::size_t limits, bool tie);
  void end(PathEnd why, std::string sentence);

  BreakageScene scene_;
  Effects effects_;
  std::vector<Support> supports_;
  UnbondedOptions options_;
  DegreesOfFreedom unknowns_;
  ContactOperator contacts_;
  TangentSolver solver_;
  std::vector<UnbondedLaw> laws_;
  std::vector<ContactDeformation> affine_;
  std::unique_ptr<UnbondedState> state_;
  std::vector<BreakEvent> events_;
  std::vector<LegPoint> points_;
  std::vector<std::int32_t> idle_;
  std::vector<std::size_t> breaking_;  // events whose energy behind them is not known yet
  std::size_t begun_ = 0;              // events whose increment has begun
  std::vector<double> beside_;         // per component, of a release
  std::optional<Rates> rates_;
  bool dead_done_ = false, checked_ = false;
  Standstill standstill_;
  std::int64_t leg_ = 0;
  double load_rate_ = 0, motion_rate_ = 0, share_ = 0, travelled_ = 0;
  PathEnd end_ = PathEnd::none;
  std::string why_;
  UnbondedCounters counters_;
};

}  // namespace equidem
