// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Brittle breakage, event by event: a sequence of states of equilibrium without inertia. An event breaks one contact,
/// the next one is found in the network that is left (break_search.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/breakage/network_response.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

struct BreakEvent {
  std::int64_t leg = 0;  ///< from 0
  double lambda = 0;
  std::int64_t contact = 0;
  BreakMode mode = BreakMode::tension;
  std::int64_t ties = 0;  ///< other contacts that would have broken at the same lambda
  double gap = 0;         ///< of lambda, relative, to the next contact that would have broken; infinite: none
  double load = 0;        ///< LoadPath, as the contact breaks
  double motion = 0;      ///< LoadPath, likewise
  Tensor2 stress;         ///< Pa, likewise
  double energy_before = 0, energy_after = 0;  ///< N, elastic, at this lambda with and without the contact
  /// N, what the crack takes: energy_before - energy_after and the work of the loads while the contact lets go.
  double energy_released = 0;
  double work = 0;  ///< N, of everything from outside, from the unloaded state to behind this event
  double load_rate = 0, motion_rate = 0;  ///< of lambda, of the network with the contact
  std::int64_t unstable_modes = 0;        ///< of the network with the contact; -1: not known
  double relative_residual = 0;           ///< of the state at which it breaks
  std::vector<std::int32_t> loosened{};   ///< discs that leave the network with it: they carry nothing any more
  // Of contacts without a bond alone:
  double friction = 0;             ///< N, lost by slip so far
  std::int64_t other_answers = 0;  ///< found for the increment that begins here; -1: not known
  double motion_difference = 0, load_difference = 0;  ///< relative, of their rates
};

/// The reason for which a path ended.
enum class PathEnd {
  none,             ///< it has not ended
  legs_done,        ///< lambda has gone along all legs
  never_breaks,     ///< no contact breaks at any lambda
  carries_nothing,  ///< no contact carries a force that grows with lambda
  load_moves_part,  ///< a load acts on a part that nothing holds, or drives a mechanism
  most_events,      ///< LoadPath::max_events
};

template <>
struct EnumNames<PathEnd> {
  using enum PathEnd;
  static constexpr const char* what = "end of a path";
  static constexpr NamedValue<PathEnd> list[] = {{none, "not_ended"},
                                                 {legs_done, "legs_done"},
                                                 {never_breaks, "never_breaks"},
                                                 {carries_nothing, "carries_nothing"},
                                                 {load_moves_part, "load_moves_part"},
                                                 {most_events, "most_events"}};
};

/// A point of the curve of load against motion beside the events: the start, the end of a leg.
struct LegPoint {
  std::int64_t events_before = 0;
  double lambda = 0, load = 0, motion = 0;
};

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

class BreakageRun {
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
  bool advance();

  [[nodiscard]] const std::vector<BreakEvent>& events() const { return events_; }
  [[nodiscard]] PathEnd end() const { return end_; }
  /// A sentence on the end; empty where it has not come.
  [[nodiscard]] const std::string& why() const { return why_; }
  /// The start, and the ends of the legs that are done.
  [[nodiscard]] std::vector<LegPoint> leg_points() const;
  /// 1 or -1: where lambda goes on a leg.
  [[nodiscard]] double direction(std::int64_t leg) const;
  /// Discs that carried nothing from the start.
  [[nodiscard]] const std::vector<std::int32_t>& idle() const { return idle_; }
  /// lambda of the last event, or where the path has ended.
  [[nodiscard]] double lambda() const { return lambda_; }
  [[nodiscard]] const NetworkResponse& response() const { return response_; }
  /// Work minus elastic energy minus all that was released, over the largest of the three.
  [[nodiscard]] double energy_error() const;
  [[nodiscard]] double released() const;

 private:
  [[nodiscard]] bool leg_ends_before(double lambda) const;
  [[nodiscard]] double controlled_from() const;
  bool finish_leg(double from);
  [[nodiscard]] LegPoint point_at(double lambda, std::int64_t leg) const;
  void move_to(double lambda);
  void break_contact(const NextBreak& next);
  void end(PathEnd why, std::string sentence);
  [[nodiscard]] double held_quantity(double lambda) const;

  BreakageScene scene_;
  BreakableSystem& system_;
  std::vector<BreakEvent> events_;
  std::vector<std::int32_t> idle_;
  NetworkResponse response_;
  PathEnd end_ = PathEnd::none;
  std::string why_;
  std::int64_t leg_ = 0;
  double lambda_ = 0;
  double held_ = 0;              ///< the load or the motion that the control keeps from falling
  double work_ = 0;              ///< N
  double no_pattern_, no_dead_;  ///< N/m: forces below are round-off
  double no_rate_;               ///< likewise of the load or the motion that is held
};

}  // namespace equidem
