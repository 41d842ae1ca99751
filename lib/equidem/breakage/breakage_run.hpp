// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Brittle breakage, event by event: a sequence of states of equilibrium without inertia. An event breaks one contact,
/// the next one is found in the network that is left (break_search.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/event_path.hpp"
#include "equidem/breakage/load_path.hpp"

namespace equidem {

class BreakageRun final : public EventPath {
 public:
  /// \param system with the right-hand sides of the path: the pattern and, where there are any, the dead loads
  /// \throws Error (bad_input) where the network, before anything breaks, cannot balance the pattern or the dead loads
  BreakageRun(const BreakageScene& scene, BreakableSystem& system);

  /// Goes on behind events of an earlier run of the same scene: their contacts are removed at once.
  /// \throws Error (bad_input) where a contact is none, or is there twice
  void resume(std::vector<BreakEvent> events);

  [[nodiscard]] double lambda() const override { return lambda_; }
  [[nodiscard]] bool has_history() const override { return false; }
  [[nodiscard]] double load_left(double motion) const override;
  [[nodiscard]] PathLedger ledger() const override;
  [[nodiscard]] const NetworkResponse& response() const { return response_; }
  /// Likewise, or the energy by works minus that of all springs (Clapeyron) as event 0, 1, 3, 7, ... happened,
  /// whichever is worse.
  [[nodiscard]] double energy_error() const override { return std::max(clapeyron_, ledger().error()); }
  /// Where the path has failed the system is within the next event: solved for anew.
  [[nodiscard]] std::optional<PathState> state() const override;
  [[nodiscard]] SolverReport solver() const override { return system_.report(); }

 private:
  void step() override;
  [[nodiscard]] LegPoint point() const override;
  [[nodiscard]] bool leg_ends_before(double lambda) const;
  [[nodiscard]] double controlled_from(const std::array<double, 2>& held) const;
  [[nodiscard]] double leg_end_from(double from) const;
  void finish_leg(double from);
  void end_without_load();
  void move_to(double lambda);
  void break_contact(const NextBreak& next);
  /// By works and sums that the system has, else by all springs.
  [[nodiscard]] NetworkResponse response_now() const;
  /// Whether forces that grow with lambda are more than round-off. Those of a network that nothing stiffens, or that is
  /// soft beyond the digits of its solution, are as large as its stiffness and motions make round-off; but half of the
  /// work of what drives them is not their energy.
  [[nodiscard]] bool carries_pattern();
  /// The coefficients of 1 and lambda of the quantity that the control holds, of the network as it is.
  [[nodiscard]] const std::array<double, 2>& held_response() const;
  [[nodiscard]] double held_quantity(double lambda) const;
  void hold(double now);
  [[nodiscard]] std::optional<PathState> state_in(const BreakableSystem& system,
                                                  const std::vector<std::uint8_t>& broken) const;

  BreakableSystem& system_;
  std::vector<std::uint8_t> cut_;  ///< per contact, 1: without a bond from the start
  NetworkResponse response_;
  double lambda_ = 0;
  double held_ = 0;                 ///< the load or the motion that the control keeps from falling
  double work_ = 0, released_ = 0;  ///< N
  double clapeyron_ = 0;            ///< of the energies by springs and by works so far, relative
  double first_energy_ = 0;         ///< N, by the pattern, before anything broke
  double no_pattern_, no_dead_;     ///< N/m: forces below are round-off
  double no_rate_;                  ///< likewise of the load or the motion that is held
};

}  // namespace equidem
