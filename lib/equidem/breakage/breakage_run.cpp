// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/breakage_run.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double round_off = 1e-11;  // of the largest force of the network before anything broke

double sign_of(double x) {
  return x < 0 ? -1 : 1;
}

/// The round-off of forces that motions of this path can leave in contacts of parts that move rigidly, N/m: without it
/// the round-off itself would break a sample that is in pieces from the start.
double round_off_of_motions(const BreakageScene& scene) {
  const double length = scene.path.driven_by == DrivenBy::strain ? 2 * scene.assembly.mean_radius() : 1;
  return scene.path.driven_by == DrivenBy::loads ? 0
                                                 : rounded_motion * scene.springs.largest() * length * scene.path.size;
}

}  // namespace

BreakableNetwork breakable_network(const BreakageScene& scene, const Effects& effects, std::vector<Support> supports,
                                   const SolverOptions& solver) {
  BreakableNetwork network{scene.assembly, scene.springs, effects, std::move(supports), {scene.path.pattern}, solver};
  if (scene.path.dead) network.cases.push_back(*scene.path.dead);
  return network;
}

BreakageRun::BreakageRun(BreakageScene scene, BreakableSystem& system) : scene_(scene), system_(system) {
  for (std::size_t d = 0; d < system_.left().size(); ++d) {
    if (system_.left()[d] != 0) idle_.push_back(static_cast<std::int32_t>(d));
  }
  const bool dead = scene_.path.dead.has_value();
  if (!system_.carries(0) || (dead && !system_.carries(1))) {
    bad_input("the assembly cannot carry its loads before anything breaks", system_.why_not(),
              "Hold that part by a support, or take the load off it");
  }
  response_ = response_of(system_, scene_.assembly, scene_.springs, scene_.path);
  first_energy_ = response_.energy[2];
  no_pattern_ = std::max(round_off * largest_force(system_.forces(0)), round_off_of_motions(scene_));
  no_dead_ = dead ? round_off * largest_force(system_.forces(1)) : 0;
  no_rate_ = round_off * std::abs(scene_.path.control == LoadControl::load ? response_.load[1] : response_.motion[1]);
  work_ = 0.5 * response_.loads_by_motions[0];  // of the dead loads, applied in proportion
  held_ = held_quantity(0);
}

double BreakageRun::direction(std::int64_t leg) const {
  const std::vector<double>& legs = scene_.path.legs;
  const auto k = static_cast<std::size_t>(leg);
  if (k >= legs.size()) return 1;
  if (scene_.path.control == LoadControl::path) return sign_of(legs[k]);
  return sign_of(legs[k] - (k == 0 ? 0 : legs[k - 1]));
}

const std::array<double, 2>& BreakageRun::held_response() const {
  return scene_.path.control == LoadControl::load ? response_.load : response_.motion;
}

double BreakageRun::held_quantity(double lambda) const {
  return NetworkResponse::at(held_response(), lambda);
}

/// Keeps the quantity that the control holds from falling below `now`.
void BreakageRun::hold(double now) {
  const double way = direction(leg_);
  held_ = way * std::max(way * held_, way * now);
}

LegPoint BreakageRun::point_at(double lambda, std::int64_t leg) const {
  const auto next = std::ranges::find_if(events_, [&](const BreakEvent& event) { return event.leg > leg; });
  const std::int64_t before = next - events_.begin();
  if (next == events_.end()) {
    const NetworkResponse& r = response_;
    return {before,
            lambda,
            NetworkResponse::at(r.load, lambda),
            NetworkResponse::at(r.motion, lambda),
            r.load[1],
            r.motion[1],
            r.stress_at(lambda)};
  }
  const double on = lambda - next->lambda;
  LegPoint point{
      before,          lambda,           next->load + on * next->load_rate, next->motion + on * next->motion_rate,
      next->load_rate, next->motion_rate};
  // Without dead loads all is proportional to lambda; with them the event tells no more than its own stress.
  if (on == 0) point.stress = next->stress;
  if (!scene_.path.dead && next->lambda != 0) point.stress = (lambda / next->lambda) * next->stress;
  return point;
}

std::vector<LegPoint> BreakageRun::leg_points() const {
  std::vector<LegPoint> points{point_at(0, -1)};
  for (std::int64_t leg = 0; leg < leg_; ++leg) points.push_back(point_at(ends_[static_cast<std::size_t>(leg)], leg));
  return points;
}

/// The value of lambda at which the control holds a network; infinite where no lambda reaches what is held.
/// \param held of the network: the quantity that is held is held[0] + lambda held[1]
double BreakageRun::controlled_from(const std::array<double, 2>& held) const {
  const LoadPath& path = scene_.path;
  if (path.control == LoadControl::path) return 0;
  if (path.controls_lambda()) return lambda_;
  const auto& [rest, slope] = held;
  if (!(slope > no_rate_)) return direction(leg_) * std::numeric_limits<double>::infinity();
  return (held_ - rest) / slope;
}

/// Where a load is held, contacts that broke may have driven lambda beyond the end of the leg.
double BreakageRun::end_of_leg(double from) const {
  const double to = scene_.path.legs[static_cast<std::size_t>(leg_)], way = direction(leg_);
  return scene_.path.control == LoadControl::path ? to : way * std::max(way * to, way * from);
}

bool BreakageRun::leg_ends_before(double lambda) const {
  const std::vector<double>& legs = scene_.path.legs;
  const auto k = static_cast<std::size_t>(leg_);
  if (k >= legs.size()) return false;
  return scene_.path.control == LoadControl::path ? std::abs(lambda) > std::abs(legs[k])
                                                  : direction(leg_) * (lambda - legs[k]) > 0;
}

void BreakageRun::move_to(double lambda) {
  work_ += response_.work(lambda_, lambda);
  lambda_ = lambda;
}

void BreakageRun::end(PathEnd why, std::string sentence) {
  end_ = why;
  why_ = std::move(sentence);
}

bool BreakageRun::carries_pattern() {
  constexpr double soft = 1e-6, closes = 1e-6;
  const bool first = events_.empty();
  if (!first && response_.energy[2] > soft * first_energy_) return true;
  if (!first) response_ = response_of(system_, scene_.assembly, scene_.springs, scene_.path);
  const double by_springs = response_.energy[2], by_work = response_.pattern_energy_by_work();
  if (by_springs < std::numeric_limits<double>::min()) return true;  // squares of forces vanish: neither is known
  return std::abs(by_springs - by_work) <= closes * by_springs;
}

bool BreakageRun::advance() {
  const LoadPath& path = scene_.path;
  const bool dead = path.dead.has_value();
  while (end_ == PathEnd::none) {
    if (path.max_events > 0 && std::ssize(events_) >= path.max_events) {
      end(PathEnd::most_events, fmt::format("{} are done, as many as asked for", counted(path.max_events, "event")));
      break;
    }
    if (!system_.carries(0) || (dead && !system_.carries(1))) {
      end(PathEnd::load_moves_part, system_.why_not());
      break;
    }
    const double from = controlled_from(held_response());
    if (!std::isfinite(from)) {
      end(PathEnd::carries_nothing, "what is left cannot take the load that is held");
      break;
    }
    const std::optional<NextBreak> next =
        system_.next_break(scene_.strengths, {.from = from,
                                              .direction = direction(leg_),
                                              .by_least_load = path.control != LoadControl::path,
                                              .no_live = no_pattern_,
                                              .no_dead = no_dead_});
    if (!system_.carries(0) || (dead && !system_.carries(1))) continue;
    // The search may have refined the motions.
    if (const EquilibriumSums* const sums = system_.sums())
      response_ = response_of(*sums, scene_.path, area_of_stress(scene_.assembly));
    if (next && !carries_pattern()) {
      end_without_load();
      break;
    }
    if (next && !leg_ends_before(next->lambda)) {
      break_contact(*next);
      return true;
    }
    if (!finish_leg(from)) break;
  }
  return false;
}

void BreakageRun::end_without_load() {
  end(PathEnd::carries_nothing,
      "no contact carries a force that grows with lambda beyond round-off: the network carries no load");
}

/// \return whether another leg follows
bool BreakageRun::finish_leg(double from) {
  const std::vector<double>& legs = scene_.path.legs;
  if (largest_force(system_.forces(0)) <= no_pattern_) {
    end_without_load();
    return false;
  }
  if (legs.empty()) {
    end(PathEnd::never_breaks, "no contact breaks at any lambda");
    return false;
  }
  move_to(end_of_leg(from));
  ends_.push_back(lambda_);
  held_ = held_quantity(lambda_);
  if (++leg_ < std::ssize(legs)) return true;
  end(PathEnd::legs_done, fmt::format("lambda has reached {:g}", lambda_));
  return false;
}

void BreakageRun::break_contact(const NextBreak& next) {
  move_to(next.lambda);
  BreakEvent event{.leg = leg_,
                   .lambda = lambda_,
                   .contact = static_cast<std::int64_t>(next.contact),
                   .mode = next.mode,
                   .ties = next.ties,
                   .gap = next.gap,
                   .load = NetworkResponse::at(response_.load, lambda_),
                   .motion = NetworkResponse::at(response_.motion, lambda_),
                   .stress = response_.stress_at(lambda_),
                   .energy_before = response_.energy_at(lambda_),
                   .load_rate = response_.load[1],
                   .motion_rate = response_.motion[1],
                   .unstable_modes = system_.unstable_modes(),
                   .relative_residual = system_.relative_residual()};
  // A check of each costs as much as a pass over all contacts, of few states nothing.
  if (std::has_single_bit(events_.size() + 1)) {
    const double largest = std::max(std::abs(work_), std::abs(event.energy_before));
    if (largest > 0) clapeyron_ = std::max(clapeyron_, std::abs(energy_of_springs() - event.energy_before) / largest);
  }
  const double moved_before = NetworkResponse::at(response_.loads_by_motions, lambda_);
  if (scene_.path.control != LoadControl::path) hold(held_quantity(lambda_));
  event.loosened = system_.remove({&next.contact, 1});
  if (const EquilibriumSums* const sums = system_.sums()) {
    response_ = response_of(*sums, scene_.path, area_of_stress(scene_.assembly));
  } else {
    response_ = response_of(system_, scene_.assembly, scene_.springs, scene_.path);
  }
  event.energy_after = response_.energy_at(lambda_);
  const double moved = NetworkResponse::at(response_.loads_by_motions, lambda_);
  // Loads on parts that move away do work without end: none is counted.
  const bool carried = system_.carries(0) && (!scene_.path.dead || system_.carries(1));
  const double work = carried ? moved - moved_before : 0;
  work_ += work;
  event.energy_released = event.energy_before - event.energy_after + work;
  event.work = work_;
  if (!std::isfinite(event.load) || !std::isfinite(event.energy_released) || !std::isfinite(event.work)) {
    computation_failed(fmt::format("the energy of the break of contact {} is not a number", event.contact),
                       "springs, strengths and loads together leave the range of numbers", "Scale one of them");
  }
  events_.push_back(std::move(event));
}

void BreakageRun::resume(std::vector<BreakEvent> events) {
  if (events.empty()) return;
  std::vector<std::uint8_t> gone(scene_.assembly.contacts.size(), 0);
  std::vector<std::size_t> contacts;
  for (const BreakEvent& event : events) {
    const auto c = static_cast<std::size_t>(event.contact);
    if (event.contact < 0 || c >= gone.size() || gone[c] != 0) {
      bad_input(fmt::format("the events to go on from break contact {}", event.contact),
                "there is no such contact, or it is broken already", "Begin anew, without --resume");
    }
    gone[c] = 1;
    contacts.push_back(c);
  }
  system_.remove(contacts);
  response_ = response_of(system_, scene_.assembly, scene_.springs, scene_.path);
  events_ = std::move(events);
  work_ = events_.back().work;
  // The legs again: each ended in the network in which the first event of a later leg broke.
  const bool load = scene_.path.control == LoadControl::load;
  const LegPoint start = point_at(0, -1);
  held_ = load ? start.load : start.motion;
  auto event = events_.begin();
  const auto held_at = [&] { return load ? event->load : event->motion; };
  for (leg_ = 0;; ++leg_) {
    for (; event != events_.end() && event->leg == leg_; ++event) {
      lambda_ = event->lambda;
      hold(held_at());
    }
    if (event == events_.end()) return;
    const double rate = load ? event->load_rate : event->motion_rate, rest = held_at() - event->lambda * rate;
    lambda_ = end_of_leg(controlled_from({rest, rate}));
    ends_.push_back(lambda_);
    held_ = rest + lambda_ * rate;
  }
}

double BreakageRun::load_left(double motion) const {
  const NetworkResponse& r = response_;
  return r.motion[1] > 0 ? NetworkResponse::at(r.load, (motion - r.motion[0]) / r.motion[1]) : 0;
}

double BreakageRun::released() const {
  double sum = 0;
  for (const BreakEvent& event : events_) sum += event.energy_released;
  return sum;
}

double BreakageRun::energy_of_springs() const {
  return response_of(system_, scene_.assembly, scene_.springs, scene_.path).energy_at(lambda_);
}

double BreakageRun::energy_error() const {
  const double elastic = response_.energy_at(lambda_), crack = released();
  const double largest = std::max({std::abs(work_), std::abs(elastic), std::abs(crack)});
  return std::max(clapeyron_, largest > 0 ? std::abs(work_ - elastic - crack) / largest : 0);
}

}  // namespace equidem
