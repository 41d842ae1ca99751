// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A path of loading as a sequence of events: what brittle breakage and unbonded contacts have in common.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/path_numbers.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Rounding of motions, relative, that a spring takes for a force.
inline constexpr double rounded_motion = 1e-14;

struct BreakEvent {
  std::int64_t leg = 0;  ///< from 0
  double lambda = 0;
  std::int64_t contact = 0;
  BreakMode mode = BreakMode::tension;
  std::int64_t ties = 0;  ///< other contacts with an event at the same lambda
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
  std::vector<std::int32_t> loosened{};   ///< discs that leave the network with it and carry nothing behind it
  double friction = 0;                    ///< N, lost by slip so far where contacts have friction; else 0

  void pass(PathNumbers& n) {
    n.pass(leg, lambda, contact, mode, ties, gap, load, motion, stress, energy_before, energy_after, energy_released);
    n.pass(work, load_rate, motion_rate, unstable_modes, relative_residual, loosened, friction);
  }
};

/// The reason for which a path ended.
enum class PathEnd {
  none,             ///< it has not ended
  legs_done,        ///< lambda has gone along all legs
  never_breaks,     ///< no contact breaks at any lambda
  carries_nothing,  ///< no contact carries a force that grows with lambda
  load_moves_part,  ///< a load acts on a part that nothing holds, or drives a mechanism
  no_answer,        ///< no consistent state of contacts without a bond was found, or their states cycle
  not_balanced,     ///< forces no longer balance to 1e-12: the tangent stiffness of some discs is near singular
  most_events,      ///< LoadPath::max_events
  failed,           ///< the computation of the next event failed
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
                                                 {no_answer, "no_answer"},
                                                 {not_balanced, "not_balanced"},
                                                 {most_events, "most_events"},
                                                 {failed, "failed"}};
};

/// A point of the curve of load against motion beside the events: the start, the end of a leg.
struct LegPoint {
  std::int64_t events_before = 0;
  double lambda = 0, load = 0, motion = 0;
  double load_rate = 0, motion_rate = 0;  ///< of lambda, as it was reached
  std::optional<Tensor2> stress{};        ///< Pa; none: not known

  void pass(PathNumbers& n) { n.pass(events_before, lambda, load, motion, load_rate, motion_rate, stress); }
};

class EventPath {
 public:
  EventPath() = default;
  virtual ~EventPath() = default;
  EventPath(const EventPath&) = delete;
  EventPath& operator=(const EventPath&) = delete;

  /// Goes on to the next event, or to several that happen at once.
  /// \return false where the path has ended
  /// \throws Error (computation_failed) where what follows the last event cannot be computed, or of kind interrupted
  ///         where the user asked to stop; all that was found so far stays
  virtual bool advance() = 0;
  /// Ends the path behind its last event, since what follows cannot be computed.
  virtual void fail(std::string why) = 0;

  [[nodiscard]] virtual const std::vector<BreakEvent>& events() const = 0;
  [[nodiscard]] virtual PathEnd end() const = 0;
  /// A sentence on the end; empty where it has not come.
  [[nodiscard]] virtual const std::string& why() const = 0;
  /// The start, and the ends of the legs that are done.
  [[nodiscard]] virtual std::vector<LegPoint> leg_points() const = 0;
  /// 1 or -1: where lambda goes on a leg.
  [[nodiscard]] virtual double direction(std::int64_t leg) const = 0;
  /// Discs that carried nothing from the start.
  [[nodiscard]] virtual const std::vector<std::int32_t>& idle() const = 0;
  /// lambda of the last event, or where the path has ended.
  [[nodiscard]] virtual double lambda() const = 0;
  /// Whether contacts have friction: their forces depend on the path.
  [[nodiscard]] virtual bool has_history() const = 0;
  /// Whether a broken bond has yet to give up a part of its force, while lambda is held.
  [[nodiscard]] virtual bool releasing() const { return false; }
  /// The load that the network as it is carries at a motion (LoadPath).
  [[nodiscard]] virtual double load_left(double motion) const = 0;
  [[nodiscard]] virtual double elastic_energy() const = 0;  ///< N, at lambda()
  [[nodiscard]] virtual double released() const = 0;        ///< N, by all bonds that broke
  /// Work less everything that it went into, over the largest of these; where contacts have friction, the largest so
  /// far.
  [[nodiscard]] virtual double energy_error() const = 0;
};

}  // namespace equidem
