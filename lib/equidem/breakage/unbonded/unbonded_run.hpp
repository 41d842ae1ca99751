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
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/unbonded/contact_events.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/breakage/unbonded/contact_rates.hpp"
#include "equidem/breakage/unbonded/rate_path.hpp"
#include "equidem/breakage/unbonded/standstill.hpp"
#include "equidem/breakage/unbonded/unbonded_state.hpp"

namespace equidem {

struct UnbondedOptions {
  double friction = 0;               ///< mu of contacts without a bond
  std::vector<ContactForce> rest{};  ///< N/m, per contact: forces at rest, balanced by loads that stay; empty: none
};

struct UnbondedCounters {
  std::int64_t factorizations = 0, updates = 0;
  double largest_residual = 0;  ///< of the states of the path, relative
};

class UnbondedRun : public EventPath {
 public:
  /// Contacts whose strengths are both 0 are no bonds from the start. All of the scene must outlive the run.
  /// A contact without a bond whose force at rest pulls, N_r > 0, begins open with the gap N_r/kN.
  /// \throws Error (bad_input) where the friction is not a finite number >= 0, forces at rest are beyond it, or the
  ///         control is none of those that a path with a history has
  UnbondedRun(BreakageScene scene, const Effects& effects, std::span<const Support> supports, UnbondedOptions options);

  /// A bond that breaks is an event, and so is what happens while it gives up its force; then to the end of that.
  bool advance() override;
  void fail(std::string why) override { end(PathEnd::failed, std::move(why)); }
  [[nodiscard]] const std::vector<BreakEvent>& events() const override { return events_; }
  [[nodiscard]] PathEnd end() const override { return end_; }
  [[nodiscard]] const std::string& why() const override { return why_; }
  [[nodiscard]] std::vector<LegPoint> leg_points() const override { return points_; }
  [[nodiscard]] double direction(std::int64_t leg) const override;
  /// Discs that touch nothing at first; contacts with a gap may close later.
  [[nodiscard]] const std::vector<std::int32_t>& idle() const override { return idle_; }
  /// Discs without a support of which every contact is open as it is now, ascending.
  [[nodiscard]] std::vector<std::int32_t> untouched() const;
  /// Rattlers, as in a network whose contacts are not frictional (unbonded_scene.hpp), those untouched among
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
  [[nodiscard]] bool releasing() const override { return !state_->releasing().empty(); }
  [[nodiscard]] UnbondedCounters counters() const;
  /// Everything between two calls of advance() that the scene does not say: a path that is restored goes on with the
  /// same bits.
  void pass(PathNumbers& n) {
    n.pass(events_, points_, breaking_, rates_, dead_done_, standstill_, steps_, leg_, load_rate_);
    n.pass(motion_rate_, share_, travelled_, end_, why_, counters_.largest_residual, *state_, solver_);
    if (n.restores() && end_ == PathEnd::most_events) end(PathEnd::none, {});  // this path may have more
  }

 private:
  [[nodiscard]] bool by_motion() const;
  [[nodiscard]] Driving driving() const;
  bool find_rates();
  void end_without_rates(const RateSearch& search, std::size_t on_limits);
  /// "at 37 % of the dead loads ", before a clause; nothing on the legs of lambda, whose place the report gives.
  [[nodiscard]] std::string at_dead_loads() const;
  [[nodiscard]] double stage_end() const;
  void step();
  /// \return false where the path ends
  bool move(double t);
  void finish_stage();
  void note_released();
  void add_leg_point();
  void break_bond(const NextContactEvent& next, double lambda_rate);
  BreakEvent event_of(std::size_t contact, BreakMode mode) const;
  void record_changes(std::span<const ContactStatus> after);
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
  std::vector<double> beside_;         // per component, of a release
  std::optional<Rates> rates_;
  bool dead_done_ = false;
  Standstill standstill_;
  std::int64_t steps_ = 0;  // of the release, or since the last event
  std::int64_t leg_ = 0;
  double load_rate_ = 0, motion_rate_ = 0, share_ = 0, travelled_ = 0;
  PathEnd end_ = PathEnd::none;
  std::string why_;
  UnbondedCounters counters_;
};

}  // namespace equidem
