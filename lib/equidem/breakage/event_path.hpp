// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A path of loading as a sequence of events, with one ledger of energy, for networks of bonds that break and of
/// contacts with friction.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/break_search.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/breakage/path_numbers.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/contact_springs.hpp"
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
  /// N, what the crack takes: energy_before - energy_after and the work of the loads while it is released.
  double energy_released = 0;
  double work = 0;  ///< N, of everything from outside, from the unloaded state to behind this event
  double load_rate = 0, motion_rate = 0;         ///< of lambda, of the network with the contact
  std::optional<std::int64_t> unstable_modes{};  ///< of the network with the contact; none: not known
  double relative_residual = 0;                  ///< of the state at which it breaks
  std::vector<std::int32_t> loosened{};          ///< discs that leave the network with it and carry nothing behind it
  double friction = 0;                           ///< N, lost by slip so far where contacts have friction; else 0

  void pass(PathNumbers& n) {
    EQUIDEM_PASS(n, leg, lambda, contact, mode, ties, gap, load, motion, stress, energy_before, energy_after,
                 energy_released);
    EQUIDEM_PASS(n, work, load_rate, motion_rate, unstable_modes, relative_residual, loosened, friction);
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

  void pass(PathNumbers& n) { EQUIDEM_PASS(n, events_before, lambda, load, motion, load_rate, motion_rate, stress); }
};

/// Work of everything from outside, and where it went, N, from the start.
struct PathLedger {
  double work = 0;
  double elastic = 0;     ///< the energy of the springs, less that at rest
  double friction = 0;    ///< lost by slip
  double released = 0;    ///< by bonds that broke
  double negligible = 0;  ///< energy of forces that are round-off
  /// The largest term; where contacts have friction, so far: forces balance to a share of the largest so far, and so
  /// are limits met. Where all forces have vanished again, that share of an energy which is gone is missing.
  double largest = 0;

  /// All works of a step are in. \param elastic_now behind it
  void take(double elastic_now) {
    elastic = elastic_now;
    largest = std::max({largest, std::abs(work), std::abs(elastic), std::abs(friction), std::abs(released)});
  }
  void pass(PathNumbers& n) { EQUIDEM_PASS(n, work, elastic, friction, released, negligible, largest); }
  /// The sum that should vanish, N.
  [[nodiscard]] double missing() const { return work - elastic - friction - released; }
  /// missing() over the largest of its terms.
  [[nodiscard]] double error() const { return largest > negligible ? std::abs(missing()) / largest : 0; }
};

/// A network that breaks along a path; a path refers to it.
struct BreakageScene {
  const Assembly& assembly;
  const ContactSprings& springs;
  const ContactStrengths& strengths;
  const LoadPath& path;
};

/// The network for a BreakableSystem: the right-hand sides of the path, the pattern first.
BreakableNetwork breakable_network(const BreakageScene& scene, const Effects& effects, std::vector<Support> supports,
                                   const SolverOptions& solver = {});

/// The network behind the last event of a path, at its lambda.
struct PathState {
  std::vector<DiscMotion> motions;   ///< per disc, beside a mean strain
  std::vector<ContactForce> forces;  ///< N/m, per contact; 0 where it is broken or open
  std::vector<std::uint8_t> joined;  ///< per contact, whether it is neither
};

/// The events of a path, its curve and its end. Derived classes are the two networks: bonds that break
/// (breakage_run.hpp), and contacts that also open, close, slip and stick (unbonded/unbonded_run.hpp).
class EventPath {
 public:
  virtual ~EventPath() = default;
  EventPath(const EventPath&) = delete;
  EventPath& operator=(const EventPath&) = delete;

  /// Goes on to the next event, or to several that happen at once.
  /// \return false where the path has ended
  /// \throws Error (computation_failed) where what follows the last event cannot be computed, or of kind interrupted
  ///         where the user asked to stop; all that was found so far stays
  bool advance();
  /// Ends the path behind its last event, since what follows cannot be computed.
  void fail(std::string why) { end(PathEnd::failed, std::move(why)); }

  [[nodiscard]] const std::vector<BreakEvent>& events() const { return events_; }
  [[nodiscard]] PathEnd end() const { return end_; }
  /// A sentence on the end; empty where it has not come.
  [[nodiscard]] const std::string& why() const { return why_; }
  /// The start, and the ends of the legs that are done; none while dead loads are applied event by event.
  [[nodiscard]] const std::vector<LegPoint>& leg_points() const { return points_; }
  /// 1 or -1: where lambda goes on a leg.
  [[nodiscard]] double direction(std::int64_t leg) const;
  /// Discs that carried nothing from the start.
  [[nodiscard]] const std::vector<std::int32_t>& idle() const { return idle_; }
  /// lambda of the last event, or where the path has ended.
  [[nodiscard]] virtual double lambda() const = 0;
  /// Whether contacts have friction: their forces depend on the path.
  [[nodiscard]] virtual bool has_history() const = 0;
  /// Whether a broken bond has yet to give up a part of its force, while lambda is held.
  [[nodiscard]] virtual bool releasing() const { return false; }
  /// The load that the network as it is carries at a motion (LoadPath).
  [[nodiscard]] virtual double load_left(double motion) const = 0;
  [[nodiscard]] virtual PathLedger ledger() const = 0;  ///< at lambda()
  /// Work less everything that it went into, over the largest of these.
  [[nodiscard]] virtual double energy_error() const { return ledger().error(); }
  /// None where what is left of the network does not carry its loads, or is not known.
  [[nodiscard]] virtual std::optional<PathState> state() const = 0;
  [[nodiscard]] virtual SolverReport solver() const = 0;

 protected:
  explicit EventPath(const BreakageScene& scene) : scene_(scene) {}

  /// Goes on to the next event, to the end of a leg or to that of the path, whichever comes first.
  virtual void step() = 0;
  /// The network at lambda(), with the events so far before it.
  [[nodiscard]] virtual LegPoint point() const = 0;
  /// At point().
  [[nodiscard]] BreakEvent event_of(std::size_t contact, BreakMode mode) const;
  void add_leg_point() { points_.push_back(point()); }
  void end(PathEnd why, std::string sentence);
  /// A leg without an end has the end `none`.
  [[nodiscard]] std::optional<double> end_of_leg() const;

  BreakageScene scene_;
  std::vector<BreakEvent> events_;
  std::vector<LegPoint> points_;
  std::vector<std::int32_t> idle_;
  std::int64_t leg_ = 0;
  bool pauses_ = false;  ///< advance() returns without an event: a bond has given up its force
  PathEnd end_ = PathEnd::none;
  std::string why_;
};

}  // namespace equidem
