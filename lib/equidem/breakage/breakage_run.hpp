// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Brittle breakage, event by event: a sequence of states of equilibrium without inertia. An event breaks one contact,
/// the next one is found in the network that is left (break_search.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/event_path.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/breakage/network_response.hpp"
#include "equidem/breakage/strengths.hpp"

namespace equidem {

/// The network of a BreakageRun, to which it refers.
struct BreakageScene {
  const Assembly& assembly;
  const ContactSprings& springs;
  const ContactStrengths& strengths;
  const LoadPath& path;
};

/// The network for a BreakableSystem: the right-hand sides of the path, the pattern first.
BreakableNetwork breakable_network(const BreakageScene& scene, const Effects& effects, std::vector<Support> supports,
                                   const SolverOptions& solver = {});

class BreakageRun : public EventPath {
 public:
  /// \param system with the right-hand sides of the path: the pattern and, where there are any, the dead loads
  /// \throws Error (bad_input) where the network, before anything breaks, cannot balance the pattern or the dead loads
  BreakageRun(BreakageScene scene, BreakableSystem& system);

  /// Goes on behind events of an earlier run of the same scene: their contacts are removed at once.
  /// \throws Error (bad_input) where a contact is none, or is there twice
  void resume(std::vector<BreakEvent> events);
  /// Breaks the next contact.
  /// \return false where the path has ended
  /// \throws Error (computation_failed) as BreakableSystem::remove
  bool advance() override;
  void fail(std::string why) override { end(PathEnd::failed, std::move(why)); }

  [[nodiscard]] const std::vector<BreakEvent>& events() const override { return events_; }
  [[nodiscard]] PathEnd end() const override { return end_; }
  [[nodiscard]] const std::string& why() const override { return why_; }
  [[nodiscard]] std::vector<LegPoint> leg_points() const override;
  [[nodiscard]] double direction(std::int64_t leg) const override;
  [[nodiscard]] const std::vector<std::int32_t>& idle() const override { return idle_; }
  [[nodiscard]] double lambda() const override { return lambda_; }
  [[nodiscard]] bool has_history() const override { return false; }
  [[nodiscard]] double load_left(double motion) const override;
  [[nodiscard]] double elastic_energy() const override { return response_.energy_at(lambda_); }
  [[nodiscard]] const NetworkResponse& response() const { return response_; }
  /// Work minus elastic energy minus all that was released, or the energy by works minus that of all springs
  /// (Clapeyron) as event 0, 1, 3, 7, ... happened, whichever is worse; over the largest of them.
  [[nodiscard]] double energy_error() const override;
  [[nodiscard]] double released() const override;

 private:
  [[nodiscard]] bool leg_ends_before(double lambda) const;
  [[nodiscard]] double controlled_from(const std::array<double, 2>& held) const;
  [[nodiscard]] double end_of_leg(double from) const;
  bool finish_leg(double from);
  void end_without_load();
  [[nodiscard]] LegPoint point_at(double lambda, std::int64_t leg) const;
  void move_to(double lambda);
  void break_contact(const NextBreak& next);
  /// The elastic energy by the forces of all contacts, N: response_ has it by works and by the contacts that opened.
  [[nodiscard]] double energy_of_springs() const;
  /// Whether forces that grow with lambda are more than round-off. Those of a network that nothing stiffens, or that is
  /// soft beyond the digits of its solution, are as large as its stiffness and motions make round-off; but half of the
  /// work of what drives them is not their energy.
  [[nodiscard]] bool carries_pattern();
  void end(PathEnd why, std::string sentence);
  /// The coefficients of 1 and lambda of the quantity that the control holds, of the network as it is.
  [[nodiscard]] const std::array<double, 2>& held_response() const;
  [[nodiscard]] double held_quantity(double lambda) const;
  void hold(double now);

  BreakageScene scene_;
  BreakableSystem& system_;
  std::vector<BreakEvent> events_;
  std::vector<std::int32_t> idle_;
  NetworkResponse response_;
  PathEnd end_ = PathEnd::none;
  std::string why_;
  std::int64_t leg_ = 0;
  std::vector<double> ends_;  ///< lambda at the ends of the legs that are done
  double lambda_ = 0;
  double held_ = 0;              ///< the load or the motion that the control keeps from falling
  double work_ = 0;              ///< N
  double clapeyron_ = 0;         ///< of the energies by springs and by works so far, relative
  double first_energy_ = 0;      ///< N, by the pattern, before anything broke
  double no_pattern_, no_dead_;  ///< N/m: forces below are round-off
  double no_rate_;               ///< likewise of the load or the motion that is held
};

}  // namespace equidem
