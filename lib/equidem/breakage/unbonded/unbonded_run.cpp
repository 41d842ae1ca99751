// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/unbonded_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/breakage/unbonded/unbonded_scene.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"
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
  if (search.found || answer.agrees) record_changes(answer.status);
  if (!search.found) {
    end_without_rates(search, limits.size());
    return false;
  }
  for (const LimitContact& at : limits) state_->set_status(at.contact, answer.status[at.contact]);
  rates_ = std::move(answer.rates);
  state_->settle(*rates_, !dead_done_, by_motion(), solver_);
  return true;
}

std::string UnbondedRun::at_dead_loads() const {
  if (dead_done_) return "";
  return state_->dead() > 0 ? fmt::format("at {:.4g} % of the dead loads ", 100 * state_->dead())
                            : "before any of the dead loads acts ";
}

void UnbondedRun::end_without_rates(const RateSearch& search, std::size_t on_limits) {
  const std::string at = at_dead_loads() + (releasing() ? "while a broken bond gives up its force " : "");
  if (search.answer.agrees) {
    const std::vector<double>& rate = search.answer.rates.motion;
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    std::vector<DiscMotion> motions(scene_.assembly.size());
    for (std::size_t d = 0; d < motions.size(); ++d) {
      motions[d].u = {rate[d * b], rate[d * b + 1]};
      if (b > 2) motions[d].theta = rate[d * b + 2] / unknowns_.rotation_scale;
    }
    end(PathEnd::load_moves_part, fmt::format("{}nothing resists a motion any more that the path drives: {}", at,
                                              describe_motion(scene_.assembly, motions)));
    return;
  }
  end(PathEnd::no_answer, fmt::format("{}no consistent contact state found: {} on a limit of the law", at,
                                      counted(static_cast<std::int64_t>(on_limits), "contact is", "contacts are")));
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
}

void UnbondedRun::add_leg_point() {
  points_.push_back({std::ssize(events_), state_->lambda(), state_->load(), state_->mean_motion(), load_rate_,
                     motion_rate_, state_->stress()});
}

void UnbondedRun::finish_stage() {
  rates_.reset();
  standstill_.begin();
  steps_ = 0;
  if (releasing()) {
    state_->end_release();
    note_released();
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

/// Notes, with the events of the breaking bonds, the energy that these have released so far.
void UnbondedRun::note_released() {
  for (const std::size_t k : breaking_) {
    events_[k].energy_after = state_->ledger().elastic;
    events_[k].energy_released = state_->released_by(static_cast<std::size_t>(events_[k].contact));
    events_[k].work = state_->ledger().work;
  }
}

void UnbondedRun::end(PathEnd why, std::string sentence) {
  note_released();
  end_ = why;
  why_ = std::move(sentence);
}

bool UnbondedRun::move(double t) {
  if (!releasing()) travelled_ += t;
  if (!standstill_.moved(t, releasing() ? 1 : travelled_) && standstill_.again(state_->status())) {
    end(PathEnd::no_answer, fmt::format("{}contact states cycle at lambda = {:g}: no consistent contact state found",
                                        at_dead_loads(), state_->lambda()));
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
            "at lambda = {:g} the forces balance to {:.1e} of the largest, not to {:g}: the tangent stiffness of some "
            "discs is near singular",
            state_->lambda(), state_->relative_residual(), balances_to));
    return false;
  }
  counters_.largest_residual = std::max(counters_.largest_residual, state_->relative_residual());
  return true;
}

bool UnbondedRun::advance() {
  const std::size_t before = events_.size();
  const std::int64_t most = scene_.path.max_events;
  if (!releasing()) steps_ = 0;
  bool released = false;
  while (end_ == PathEnd::none && events_.size() == before && !released) {
    stop_if_interrupted();
    if (most > 0 && std::ssize(events_) >= most) {
      end(PathEnd::most_events,
          fmt::format("{} are done, as many as asked for{}", counted(std::ssize(events_), "event"),
                      releasing() ? ", while a broken bond gives up its force" : ""));
      break;
    }
    if (!rates_) {
      if (!find_rates() || events_.size() > before) break;
    }
    const bool was_releasing = releasing();
    step();
    released = was_releasing && !releasing();
  }
  note_released();
  return events_.size() > before || end_ == PathEnd::none;
}

/// To the next event, or to the end of the stage.
void UnbondedRun::step() {
  const double stage = stage_end();
  const NextContactEvent next = next_contact_event(*state_, laws_, scene_.strengths, *rates_, stage);
  const double t = std::min(stage, next.t);
  if (t == infinite) {
    if (by_motion() && rates_->lambda == 0) {
      end(PathEnd::carries_nothing, "the motion grows without a load, and no contact changes any more");
    } else {
      end(PathEnd::never_breaks, "no contact changes any more at any lambda");
    }
    return;
  }
  const std::int64_t most_steps = 1000 + 20 * std::ssize(laws_);  // a release may go on by ever smaller parts
  if (++steps_ > most_steps) {
    end(PathEnd::no_answer,
        fmt::format("{}contacts change {} times before lambda = {:g} is left: no consistent contact state found",
                    at_dead_loads(), steps_ - 1, state_->lambda()));
    return;
  }
  if (!move(t)) return;
  const double lambda_rate = rates_->lambda;
  rates_.reset();
  if (next.t <= stage && next.breaks && !state_->carries()) {
    end(PathEnd::carries_nothing, "no contact carries more than round-off: the network carries no load");
    return;
  }
  if (next.t <= stage && next.breaks) {
    break_bond(next, lambda_rate);
  } else if (stage <= next.t) {
    finish_stage();
  }
}

}  // namespace equidem
