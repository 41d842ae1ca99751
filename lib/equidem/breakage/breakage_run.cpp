// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/breakage_run.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {
namespace {

constexpr double round_off = 1e-11;  // of the largest force of the network before anything broke

/// The round-off of forces that motions of this path can leave in contacts of parts that move rigidly, N/m: without it
/// the round-off itself would break a sample that is in pieces from the start.
double round_off_of_motions(const BreakageScene& scene) {
  const double length = scene.path.driven_by == DrivenBy::strain ? 2 * scene.assembly.mean_radius() : 1;
  return scene.path.driven_by == DrivenBy::loads ? 0
                                                 : rounded_motion * scene.springs.largest() * length * scene.path.size;
}

}  // namespace

BreakageRun::BreakageRun(const BreakageScene& scene, BreakableSystem& system)
    : EventPath(scene), system_(system), cut_(system.broken()) {
  idle_ = discs_set(system_.left());
  const bool dead = scene_.path.dead.has_value();
  if (!system_.carries()) {
    bad_input("the assembly cannot carry its loads before anything breaks", system_.why_not(),
              "Hold that part by a support, or take the load off it");
  }
  response_ = response_now();
  first_energy_ = response_.energy[2];
  no_pattern_ = std::max(round_off * largest_force(system_.forces(0)), round_off_of_motions(scene_));
  no_dead_ = dead ? round_off * largest_force(system_.forces(1)) : 0;
  no_rate_ = round_off * std::abs(scene_.path.control == LoadControl::load ? response_.load[1] : response_.motion[1]);
  work_ = 0.5 * response_.loads_by_motions[0];  // of the dead loads, applied in proportion
  held_ = held_quantity(0);
  add_leg_point();
}

NetworkResponse BreakageRun::response_now() const {
  if (const auto sums = system_.sums()) return response_of(*sums, scene_.path, area_of_stress(scene_.assembly));
  return response_of(system_, scene_.assembly, scene_.springs, scene_.path);
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

LegPoint BreakageRun::point() const {
  const NetworkResponse& r = response_;
  return {std::ssize(events_),
          lambda_,
          NetworkResponse::at(r.load, lambda_),
          NetworkResponse::at(r.motion, lambda_),
          r.load[1],
          r.motion[1],
          r.stress_at(lambda_)};
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
double BreakageRun::leg_end_from(double from) const {
  const double to = *end_of_leg(), way = direction(leg_);
  return scene_.path.control == LoadControl::path ? to : way * std::max(way * to, way * from);
}

bool BreakageRun::leg_ends_before(double lambda) const {
  const std::optional<double> to = end_of_leg();
  if (!to) return false;
  return scene_.path.control == LoadControl::path ? std::abs(lambda) > std::abs(*to)
                                                  : direction(leg_) * (lambda - *to) > 0;
}

void BreakageRun::move_to(double lambda) {
  work_ += response_.work(lambda_, lambda);
  lambda_ = lambda;
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

void BreakageRun::step() {
  if (!system_.carries()) return end(PathEnd::load_moves_part, system_.why_not());
  const double from = controlled_from(held_response());
  if (!std::isfinite(from)) return end(PathEnd::carries_nothing, "what is left cannot take the load that is held");
  const bool dead = scene_.path.dead.has_value();
  const std::optional<NextBreak> next =
      next_break(system_.forces(0), dead ? system_.forces(1) : std::span<const ContactForce>{}, scene_.strengths,
                 {.from = from,
                  .direction = direction(leg_),
                  .by_least_load = scene_.path.control != LoadControl::path,
                  .no_live = no_pattern_,
                  .no_dead = no_dead_});
  if (next && !carries_pattern()) return end_without_load();
  if (next && !leg_ends_before(next->lambda)) return break_contact(*next);
  finish_leg(from);
}

void BreakageRun::end_without_load() {
  end(PathEnd::carries_nothing,
      "no contact carries a force that grows with lambda beyond round-off: the network carries no load");
}

void BreakageRun::finish_leg(double from) {
  if (largest_force(system_.forces(0)) <= no_pattern_) return end_without_load();
  if (!end_of_leg()) return end(PathEnd::never_breaks, "no contact breaks at any lambda");
  move_to(leg_end_from(from));
  add_leg_point();
  held_ = held_quantity(lambda_);
  if (++leg_ == std::ssize(scene_.path.legs)) end(PathEnd::legs_done, fmt::format("lambda has reached {:g}", lambda_));
}

void BreakageRun::break_contact(const NextBreak& next) {
  move_to(next.lambda);
  BreakEvent event = event_of(next.contact, next.mode);
  event.ties = next.ties;
  event.gap = next.gap;
  event.unstable_modes = system_.unstable_modes();
  event.relative_residual = system_.relative_residual();
  // A check of each costs as much as a pass over all contacts, of few states nothing.
  if (std::has_single_bit(events_.size() + 1)) {
    const double largest = std::max(std::abs(work_), std::abs(event.energy_before));
    const double by_springs = response_of(system_, scene_.assembly, scene_.springs, scene_.path).energy_at(lambda_);
    if (largest > 0) clapeyron_ = std::max(clapeyron_, std::abs(by_springs - event.energy_before) / largest);
  }
  const double moved_before = NetworkResponse::at(response_.loads_by_motions, lambda_);
  if (scene_.path.control != LoadControl::path) hold(held_quantity(lambda_));
  event.loosened = system_.remove({&next.contact, 1});
  response_ = response_now();
  event.energy_after = response_.energy_at(lambda_);
  const double moved = NetworkResponse::at(response_.loads_by_motions, lambda_);
  // Loads on parts that move away do work without end: none is counted.
  const double work = system_.carries() ? moved - moved_before : 0;
  work_ += work;
  event.energy_released = event.energy_before - event.energy_after + work;
  event.work = work_;
  if (!std::isfinite(event.load) || !std::isfinite(event.energy_released) || !std::isfinite(event.work)) {
    computation_failed(fmt::format("the energy of the break of contact {} is not a number", event.contact),
                       "springs, strengths and loads together leave the range of numbers", "Scale one of them");
  }
  released_ += event.energy_released;
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
  for (const BreakEvent& event : events_) released_ += event.energy_released;
  // The legs again: each ended in the network in which the first event of a later leg broke.
  const bool load = scene_.path.control == LoadControl::load;
  held_ = load ? points_.front().load : points_.front().motion;
  auto event = events_.begin();
  const auto held_at = [&] { return load ? event->load : event->motion; };
  for (leg_ = 0;; ++leg_) {
    for (; event != events_.end() && event->leg == leg_; ++event) {
      lambda_ = event->lambda;
      hold(held_at());
    }
    if (event == events_.end()) return;
    const double rate = load ? event->load_rate : event->motion_rate, rest = held_at() - event->lambda * rate;
    lambda_ = leg_end_from(controlled_from({rest, rate}));
    held_ = rest + lambda_ * rate;
    const double on = lambda_ - event->lambda;
    points_.push_back({event - events_.begin(), lambda_, event->load + on * event->load_rate,
                       event->motion + on * event->motion_rate, event->load_rate, event->motion_rate});
    // Without dead loads all is proportional to lambda; with them the event has no more than its own stress.
    if (on == 0) points_.back().stress = event->stress;
    if (!scene_.path.dead && event->lambda != 0) points_.back().stress = (lambda_ / event->lambda) * event->stress;
  }
}

double BreakageRun::load_left(double motion) const {
  const NetworkResponse& r = response_;
  return r.motion[1] > 0 ? NetworkResponse::at(r.load, (motion - r.motion[0]) / r.motion[1]) : 0;
}

PathLedger BreakageRun::ledger() const {
  PathLedger now{.work = work_, .released = released_};
  now.take(response_.energy_at(lambda_));
  return now;
}

std::optional<PathState> BreakageRun::state() const {
  if (end() != PathEnd::failed) return state_in(system_, system_.broken());
  std::vector<std::uint8_t> broken = cut_;
  for (const BreakEvent& event : events_) broken[static_cast<std::size_t>(event.contact)] = 1;
  try {
    const BreakableSystem rest(system_.network(), BreakableSystem::Factor::anew, broken);
    return state_in(rest, broken);
  } catch (const std::exception&) {
    return {};
  }
}

std::optional<PathState> BreakageRun::state_in(const BreakableSystem& system,
                                               const std::vector<std::uint8_t>& broken) const {
  if (!system.carries()) return {};
  const bool dead = scene_.path.dead.has_value();
  PathState state;
  for (std::size_t c = 0; c < broken.size(); ++c) {
    const ContactForce a = dead ? system.forces(1)[c] : ContactForce{}, b = system.forces(0)[c];
    const ContactForce whole{a.normal + lambda_ * b.normal, a.tangential + lambda_ * b.tangential};
    state.joined.push_back(broken[c] != 0 ? 0 : 1);
    state.forces.push_back(broken[c] != 0 ? ContactForce{} : whole);
  }
  std::vector<double> motion(system.motion(0).begin(), system.motion(0).end());
  for (std::size_t k = 0; k < motion.size(); ++k) motion[k] = lambda_ * motion[k] + (dead ? system.motion(1)[k] : 0.0);
  DegreesOfFreedom unknowns;
  unknowns.per_disc = system.network().effects.unknowns_per_disc();
  unknowns.rotation_scale = scene_.assembly.mean_radius();
  state.motions = disc_motions(unknowns, motion);
  return state;
}

}  // namespace equidem
