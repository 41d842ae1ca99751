// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/unbonded_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/breakage/unbonded/giving_way/end_sentence.hpp"
#include "equidem/breakage/unbonded/loose_discs.hpp"
#include "equidem/breakage/unbonded/rate_branches.hpp"
#include "equidem/breakage/unbonded/unbonded_scene.hpp"
#include "equidem/breakage/unbonded/unique_rates.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double ground = 1e-9;  // of the stiffest spring: holds what nothing resists
// The largest residual that a state may keep, over the largest force.
constexpr double balances_to = 1e-12;

}  // namespace

UnbondedRun::UnbondedRun(BreakageScene scene, const Effects& effects, std::span<const Support> supports,
                         UnbondedOptions options)
    : scene_(scene),
      effects_(effects),
      supports_(supports.begin(), supports.end()),
      options_(std::move(options)),
      unknowns_(number_unknowns(scene.assembly, scene.springs, effects, supports)),
      contacts_(scene.assembly, unknowns_),
      solver_(contacts_, ground * scene.springs.largest()),
      laws_(laws_of(scene, options_.friction, options_.rest)),
      affine_(contacts_.affine(scene.path.pattern.gradient)) {
  check_rubbing(scene_, options_.friction, options_.rest);
  state_ = std::make_unique<UnbondedState>(scene_.assembly, scene_.springs, scene_.path, unknowns_, contacts_, laws_,
                                           first_status(scene_, laws_));
  idle_ = untouched();
  dead_done_ = !scene_.path.dead;
  if (dead_done_) add_leg_point();
}

std::vector<std::int32_t> UnbondedRun::untouched() const {
  return untouched_discs(scene_.assembly, unknowns_, state_->status());
}

std::vector<std::int32_t> UnbondedRun::loose() const {
  return loose_discs(breakable_network(scene_, effects_, supports_), laws_, state_->status(), state_->carried());
}

double UnbondedRun::direction(std::int64_t leg) const {
  const std::vector<double>& legs = scene_.path.legs;
  const auto k = static_cast<std::size_t>(leg);
  if (k >= legs.size()) return 1;
  return legs[k] - (k == 0 ? 0 : legs[k - 1]) < 0 ? -1 : 1;
}

bool UnbondedRun::by_motion() const {
  return dead_done_ && scene_.path.driven_by == DrivenBy::loads && scene_.path.control == LoadControl::motion;
}

double UnbondedRun::load_left(double motion) const {
  const double slope = motion_rate_ != 0 ? load_rate_ / motion_rate_ : 0;
  return state_->load() + slope * (motion - state_->mean_motion());
}

UnbondedCounters UnbondedRun::counters() const {
  UnbondedCounters all = counters_;
  all.factorizations = solver_.factorizations();
  all.updates = solver_.updates();
  return all;
}

Driving UnbondedRun::driving() const {
  Driving d;
  const LoadPath& path = scene_.path;
  d.pattern = dead_done_ ? &path.pattern : &*path.dead;
  if (dead_done_) d.affine = affine_;
  d.by_motion = by_motion();
  if (releasing()) {
    d.beside = beside_;
  } else if (d.by_motion) {
    d.rate = direction(leg_) * path.size;
  } else {
    d.rate = dead_done_ ? direction(leg_) : 1;
  }
  return d;
}

bool UnbondedRun::find_rates() {
  if (releasing()) beside_ = state_->unreleased();
  const std::vector<LimitContact> limits = contacts_on_limits(*state_, laws_);
  const RateProblem problem{contacts_, laws_, limits, driving()};
  RateSearch search = search_rates(problem, solver_, state_->status());
  RateAnswer& answer = search.answer;
  if (!search.found) {
    if (answer.agrees) record_changes(answer.status);
    PathEnding ending = ending_of(scene_.assembly, problem, search, state_->status(),
                                  {!dead_done_, releasing(), state_->dead(), state_->lambda()});
    if (ending.end == PathEnd::no_answer) {
      if (search.tried > 0 && search.ties == 0) {
        ++counters_.no_answer;
      } else {
        count_unchecked(limits.size(), search.ties > 0);
      }
    }
    end(ending.end, std::move(ending.sentence));
    return false;
  }
  const std::size_t first = begun_;  // breaks at this state begin the increment too
  record_changes(answer.status);
  if (events_.size() > first || !checked_) look_for_branches(problem, answer, first);
  begun_ = events_.size();
  for (const LimitContact& at : limits) state_->set_status(at.contact, answer.status[at.contact]);
  rates_ = std::move(answer.rates);
  state_->settle(*rates_, !dead_done_, by_motion(), solver_);
  return true;
}

void UnbondedRun::count_unchecked(std::size_t limits, bool tie) {
  ++counters_.unchecked;
  if (tie) {
    ++counters_.ties;
    return;
  }
  counters_.most_unchecked_contacts = std::max(counters_.most_unchecked_contacts, static_cast<std::int64_t>(limits));
}

/// Looks for other answers of an increment that begins with these events, and tells them.
void UnbondedRun::look_for_branches(const RateProblem& problem, const RateAnswer& answer, std::size_t first) {
  std::vector<std::size_t> fresh;
  for (const LimitContact& at : problem.limits) {
    if (!is_slipping(state_->status()[at.contact]) || answer.status[at.contact] != state_->status()[at.contact])
      fresh.push_back(at.contact);
  }
  checked_ = true;
  Branches branches;
  if (problem.limits.size() <= most_on_limits) {
    if (proved_unique(problem, solver_, answer.status)) {
      ++counters_.unique;
      return;
    }
    branches = find_branches(problem, solver_, answer, fresh);
  }
  if (branches.others > 0) {
    ++counters_.not_unique;
  } else if (branches.decided()) {
    ++counters_.unique;
  } else {
    count_unchecked(problem.limits.size(), branches.all_tried);
  }
  if (!branches.decided()) {
    for (std::size_t k = first; k < events_.size(); ++k) events_[k].other_answers = -1;
  }
  if (branches.others == 0) return;
  const Rates& other = branches.other.rates;
  double size = 0, change = 0;
  for (std::size_t k = 0; k < other.motion.size(); ++k) {
    size = std::max(size, std::abs(answer.rates.motion[k]));
    change = std::max(change, std::abs(other.motion[k] - answer.rates.motion[k]));
  }
  const double by_motion = size > 0 ? change / size : infinite;
  const double load = load_rate_of(answer.rates, answer.status),
               other_load = load_rate_of(other, branches.other.status);
  const double by_load = load != 0 ? std::abs(other_load / load - 1) : other_load != 0 ? infinite : 0;
  counters_.largest_motion_difference = std::max(counters_.largest_motion_difference, by_motion);
  counters_.largest_load_difference = std::max(counters_.largest_load_difference, by_load);
  for (std::size_t k = first; k < events_.size(); ++k) {
    events_[k].other_answers = branches.others;
    events_[k].motion_difference = by_motion;
    events_[k].load_difference = by_load;
  }
}

/// Rate of LoadPath::load.
double UnbondedRun::load_rate_of(const Rates& rates, std::span<const ContactStatus> status) const {
  const LoadPath& path = scene_.path;
  if (path.driven_by == DrivenBy::loads) return rates.lambda * path.size;
  std::vector<double> internal(contacts_.components(), 0.0);
  double sum = 0;
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    const ContactForce f = laws_[c].tangent(status[c]).rate(rates.deformation[c]);
    contacts_.add_internal(c, f, internal);
    if (!affine_.empty()) sum += f.normal * affine_[c].normal + f.tangential * affine_[c].tangential;
  }
  if (path.driven_by == DrivenBy::strain) return sum / (path.size * scene_.assembly.area());
  for (std::size_t k = 0; k < internal.size(); ++k) sum += path.pattern.prescribed[k] * internal[k];
  return sum / path.size;
}

double UnbondedRun::stage_end() const {
  if (releasing()) return 1;
  if (!dead_done_) return 1 - state_->dead();
  const auto k = static_cast<std::size_t>(leg_);
  if (k >= scene_.path.legs.size()) return infinite;
  const double left = scene_.path.legs[k] - state_->lambda();
  return left * rates_->lambda > 0 ? left / rates_->lambda : left * direction(leg_) <= 0 ? 0 : infinite;
}

BreakEvent UnbondedRun::event_of(std::size_t contact, BreakMode mode) const {
  const ContactLedger& ledger = state_->ledger();
  return {.leg = leg_,
          .lambda = state_->lambda(),
          .contact = static_cast<std::int64_t>(contact),
          .mode = mode,
          .gap = infinite,
          .load = state_->load(),
          .motion = state_->mean_motion(),
          .stress = state_->stress(),
          .energy_before = ledger.elastic,
          .energy_after = ledger.elastic,
          .work = ledger.work,
          .load_rate = load_rate_,
          .motion_rate = motion_rate_,
          .unstable_modes = -1,
          .relative_residual = state_->relative_residual(),
          .friction = ledger.friction};
}

void UnbondedRun::record_changes(std::span<const ContactStatus> after) {
  const std::size_t first = events_.size();
  for (std::size_t c = 0; c < after.size(); ++c) {
    const ContactStatus before = state_->status()[c];
    if (before == after[c]) continue;
    const BreakMode mode = after[c] == ContactStatus::open    ? BreakMode::open
                           : before == ContactStatus::open    ? BreakMode::close
                           : after[c] == ContactStatus::stuck ? BreakMode::stick
                                                              : BreakMode::slip;
    events_.push_back(event_of(c, mode));
  }
  for (std::size_t k = first; k < events_.size(); ++k)
    events_[k].ties = static_cast<std::int64_t>(events_.size() - first - 1);
}

void UnbondedRun::break_bond(const NextContactEvent& next, double lambda_rate) {
  BreakEvent event = event_of(next.contact, *next.breaks);
  event.ties = next.ties;
  // The gap of t, as one of lambda.
  if (!releasing()) event.gap = next.gap * next.t * std::abs(lambda_rate / state_->lambda());
  const std::size_t c = next.contact;
  const double n = state_->normal_coordinate(c), t = state_->forces()[c].tangential;
  ContactStatus status = ContactStatus::stuck;
  if (n >= 0) {
    status = ContactStatus::open;
  } else if (laws_[c].rough() && std::abs(t) > -laws_[c].friction * n) {
    status = slipping(t);
  }
  state_->break_bond(c, status);
  breaking_.push_back(events_.size());
  events_.push_back(event);
  share_ = 1;
  checked_ = false;
}

void UnbondedRun::add_leg_point() {
  points_.push_back({std::ssize(events_), state_->lambda(), state_->load(), state_->mean_motion(), load_rate_,
                     motion_rate_, state_->stress()});
}

void UnbondedRun::finish_stage() {
  rates_.reset();
  checked_ = false;
  standstill_.begin();
  if (releasing()) {
    state_->end_release();
    tell_released();
    breaking_.clear();
    return;
  }
  if (!dead_done_) {
    dead_done_ = true;
    travelled_ = 0;
    add_leg_point();
    return;
  }
  add_leg_point();
  if (++leg_ == std::ssize(scene_.path.legs))
    end(PathEnd::legs_done, fmt::format("lambda has reached {:g}", state_->lambda()));
}

/// Tells with their events what the bonds that are breaking have given up so far.
void UnbondedRun::tell_released() {
  for (const std::size_t k : breaking_) {
    events_[k].energy_after = state_->ledger().elastic;
    events_[k].energy_released = state_->released_by(static_cast<std::size_t>(events_[k].contact));
    events_[k].work = state_->ledger().work;
  }
}

void UnbondedRun::end(PathEnd why, std::string sentence) {
  tell_released();
  end_ = why;
  why_ = std::move(sentence);
}

bool UnbondedRun::move(double t) {
  if (!releasing()) travelled_ += t;
  if (!standstill_.moved(t, releasing() ? 1 : travelled_) && standstill_.again(state_->status())) {
    end(PathEnd::no_answer,
        fmt::format("contacts change without end at lambda = {:g}: no states of theirs last", state_->lambda()));
    return false;
  }
  if (t == 0) return true;
  const double load = state_->load(), motion = state_->mean_motion(), lambda = state_->lambda();
  if (releasing()) state_->release_to(share_ * (1 - t));
  state_->move(t, *rates_, !dead_done_, by_motion(), solver_);
  if (releasing()) share_ *= 1 - t;
  const double by = state_->lambda() - lambda;
  load_rate_ = by != 0 ? (state_->load() - load) / by : 0;
  motion_rate_ = by != 0 ? (state_->mean_motion() - motion) / by : 0;
  if (state_->relative_residual() > balances_to) {
    end(PathEnd::not_balanced,
        fmt::format(
            "at lambda = {:g} the forces balance to {:.1e} of the largest, not to {:g}: hardly anything resists "
            "the motion of some discs",
            state_->lambda(), state_->relative_residual(), balances_to));
    return false;
  }
  counters_.largest_residual = std::max(counters_.largest_residual, state_->relative_residual());
  return true;
}

bool UnbondedRun::advance() {
  const std::size_t before = events_.size();
  std::int64_t steps = 0;
  const std::int64_t most_steps = 1000 + 20 * std::ssize(laws_);  // a release may go on by ever smaller parts
  while (end_ == PathEnd::none) {
    if (!releasing() && events_.size() > before) return true;
    if (scene_.path.max_events > 0 && std::ssize(events_) >= scene_.path.max_events && !releasing()) {
      end(PathEnd::most_events,
          fmt::format("{} are done, as many as asked for", counted(scene_.path.max_events, "event")));
      break;
    }
    if (!rates_) {
      if (!find_rates()) break;
      if (!releasing() && events_.size() > before) return true;
    }
    const double stage = stage_end();
    const NextContactEvent next = next_contact_event(*state_, laws_, scene_.strengths, *rates_, stage);
    const double t = std::min(stage, next.t);
    if (t == infinite) {
      if (by_motion() && rates_->lambda == 0) {
        end(PathEnd::carries_nothing, "the motion grows without a load, and no contact changes any more");
      } else {
        end(PathEnd::never_breaks, "no contact changes any more at any lambda");
      }
      break;
    }
    if (++steps > most_steps) {
      end(PathEnd::no_answer,
          fmt::format("contacts change {} times before lambda = {:g} is left", steps - 1, state_->lambda()));
      break;
    }
    if (!move(t)) break;
    const double lambda_rate = rates_->lambda;
    rates_.reset();
    if (next.t <= stage && next.breaks) {
      break_bond(next, lambda_rate);
    } else if (stage <= next.t) {
      finish_stage();
    }
  }
  return events_.size() > before;
}

}  // namespace equidem
