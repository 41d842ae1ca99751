// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/unbonded_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/breakage/breakable_system.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double ground = 1e-9;  // of the stiffest spring: holds what nothing resists
// The largest residual that a state may keep, over the largest force.
constexpr double balances_to = 1e-12;

bool is_bond(const ContactStrengths& strengths, std::size_t contact) {
  return strengths.tension[contact] > 0 || strengths.shear[contact] > 0;
}

/// Forces at rest that the law of contacts without a bond cannot carry.
void check_rest(const BreakageScene& scene, double friction, std::span<const ContactForce> rest) {
  constexpr double settled = 1e-6;  // of the largest: what bodies that came to rest leave beyond the law
  double largest = 0;
  for (const ContactForce& f : rest) largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
  for (std::size_t c = 0; c < rest.size(); ++c) {
    if (is_bond(scene.strengths, c)) continue;
    const ContactForce& f = rest[c];
    const double limit = friction * std::max(-f.normal, 0.0);
    if (std::abs(f.tangential) <= limit + settled * largest) continue;
    bad_input(
        fmt::format("contact {} has the forces at rest N = {:g}, T = {:g} N/m and no bond", c, f.normal, f.tangential),
        fmt::format("with the friction {:g} it carries |T| up to {:g} N/m", friction, limit),
        "Give the friction with which the bodies came to rest (strength.residual_friction), or a bond");
  }
}

/// \throws Error of scenes that cannot have a path with frictional contacts
std::vector<UnbondedLaw> laws_of(const BreakageScene& scene, const UnbondedOptions& options) {
  const double friction = options.friction;
  if (!(friction >= 0) || !std::isfinite(friction))
    bad_input(fmt::format("the friction of contacts without a bond is {}", friction),
              "it must be finite and not negative", "Correct it");
  check_control_with_friction(scene.path);
  check_rest(scene, friction, options.rest);
  std::vector<UnbondedLaw> laws;
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c)
    laws.push_back({scene.springs[c], friction, options.rest.empty() ? ContactForce{} : options.rest[c]});
  return laws;
}

/// A contact whose strengths are both 0 is no bond; it is open where its force at rest pulls.
std::vector<ContactStatus> first_status(const BreakageScene& scene, std::span<const UnbondedLaw> laws) {
  std::vector<ContactStatus> status;
  for (std::size_t c = 0; c < laws.size(); ++c) {
    status.push_back(is_bond(scene.strengths, c) ? ContactStatus::bonded
                     : laws[c].rest.normal > 0   ? ContactStatus::open
                                                 : ContactStatus::stuck);
  }
  return status;
}

}  // namespace

void check_control_with_friction(const LoadPath& path) {
  if (path.control == LoadControl::path) {
    bad_input("lambda may fall from event to event, and contacts close and slip",
              "their state depends on the path by which lambda falls, which this control leaves open",
              "Take control = \"load\" or \"motion\"");
  }
  if (path.control == LoadControl::load && path.driven_by != DrivenBy::loads) {
    bad_input("the load is held, and a motion is imposed", "the motion would have to follow the load, not lambda",
              "Take control = \"motion\", or drive by loads");
  }
}

UnbondedRun::UnbondedRun(const BreakageScene& scene, const Effects& effects, std::span<const Support> supports,
                         UnbondedOptions options)
    : EventPath(scene),
      effects_(effects),
      supports_(supports.begin(), supports.end()),
      unknowns_(number_unknowns(scene.assembly, scene.springs, effects, supports)),
      contacts_(scene.assembly, unknowns_),
      solver_(contacts_, ground * scene.springs.largest()),
      laws_(laws_of(scene, options)),
      state_(scene.assembly, scene.springs, scene.path, unknowns_, contacts_, laws_, first_status(scene, laws_)),
      dead_done_(!scene.path.dead) {
  idle_ = untouched();
  if (dead_done_) add_leg_point();
}

std::vector<std::int32_t> UnbondedRun::untouched() const {
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  std::vector<std::uint8_t> alone(scene_.assembly.size(), 1);
  for (std::size_t k = 0; k < unknowns_.held.size(); ++k) {
    if (unknowns_.held[k] == DegreesOfFreedom::supported) alone[k / b] = 0;
  }
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    if (state_.status()[c] == ContactStatus::open) continue;
    const Contact& contact = scene_.assembly.contacts[c];
    alone[static_cast<std::size_t>(contact.i)] = alone[static_cast<std::size_t>(contact.j)] = 0;
  }
  return discs_set(alone);
}

std::vector<std::int32_t> UnbondedRun::loose() const {
  const std::vector<ContactStatus>& status = state_.status();
  std::vector<std::uint8_t> without(status.size(), 0);
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < status.size(); ++c) {
    const bool bonded = status[c] == ContactStatus::bonded;
    without[c] = bonded || (status[c] != ContactStatus::open && state_.carried()[c] != 0) ? 0 : 1;
    springs.push_back({laws_[c].k.kN, bonded || laws_[c].rough() ? laws_[c].k.kT : 0});
  }
  const ContactSprings as_they_are(std::move(springs));
  const BreakableNetwork network =
      breakable_network({scene_.assembly, as_they_are, scene_.strengths, scene_.path}, effects_, supports_);
  return discs_set(idle_discs(network, without));
}

bool UnbondedRun::by_motion() const {
  return dead_done_ && scene_.path.driven_by == DrivenBy::loads && scene_.path.control == LoadControl::motion;
}

double UnbondedRun::load_left(double motion) const {
  const double slope = motion_rate_ != 0 ? load_rate_ / motion_rate_ : 0;
  return state_.load() + slope * (motion - state_.mean_motion());
}

std::optional<PathState> UnbondedRun::state() const {
  PathState state{disc_motions(unknowns_, state_.motion().high),
                  {state_.forces().begin(), state_.forces().end()},
                  std::vector<std::uint8_t>(laws_.size(), 1)};
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    if (state_.status()[c] == ContactStatus::open) state.joined[c] = 0;
  }
  return state;
}

SolverReport UnbondedRun::solver() const {
  return {.name = "UMFPACK LU, updated",
          .factorizations = solver_.factorizations(),
          .updates = solver_.updates(),
          .largest_residual = largest_residual_};
}

Driving UnbondedRun::driving() const {
  Driving d;
  const LoadPath& path = scene_.path;
  d.pattern = dead_done_ ? &path.pattern : &*path.dead;
  if (dead_done_) d.affine = state_.affine();
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
  if (releasing()) beside_ = state_.unreleased();
  const std::vector<LimitContact> limits = contacts_on_limits(state_, laws_);
  const RateProblem problem{contacts_, laws_, limits, driving()};
  RateSearch search = search_rates(problem, solver_, state_.status());
  RateAnswer& answer = search.answer;
  if (search.found || answer.agrees) record_changes(answer.status);
  if (!search.found) {
    end_without_rates(search, limits.size());
    return false;
  }
  for (const LimitContact& at : limits) state_.set_status(at.contact, answer.status[at.contact]);
  rates_ = std::move(answer.rates);
  state_.settle(*rates_, !dead_done_, by_motion(), solver_);
  return true;
}

std::string UnbondedRun::at_dead_loads() const {
  if (dead_done_) return "";
  return state_.dead() > 0 ? fmt::format("at {:.4g} % of the dead loads ", 100 * state_.dead())
                           : "before any of the dead loads acts ";
}

void UnbondedRun::end_without_rates(const RateSearch& search, std::size_t on_limits) {
  const std::string at = at_dead_loads() + (releasing() ? "while a broken bond gives up its force " : "");
  if (search.answer.agrees) {
    const std::vector<DiscMotion> motions = disc_motions(unknowns_, search.answer.rates.motion);
    end(PathEnd::load_moves_part, fmt::format("{}nothing resists a motion any more that the path drives: {}", at,
                                              describe_motion(scene_.assembly, motions)));
    return;
  }
  end(PathEnd::no_answer, fmt::format("{}no consistent contact state found: {} on a limit of the law", at,
                                      counted(static_cast<std::int64_t>(on_limits), "contact is", "contacts are")));
}

double UnbondedRun::stage_end() const {
  if (releasing()) return 1;
  if (!dead_done_) return 1 - state_.dead();
  const std::optional<double> to = end_of_leg();
  if (!to) return infinite;
  const double left = *to - state_.lambda();
  return left * rates_->lambda > 0 ? left / rates_->lambda : left * direction(leg_) <= 0 ? 0 : infinite;
}

LegPoint UnbondedRun::point() const {
  return {std::ssize(events_), state_.lambda(), state_.load(),  state_.mean_motion(),
          load_rate_,          motion_rate_,    state_.stress()};
}

void UnbondedRun::record_changes(std::span<const ContactStatus> after) {
  const std::size_t first = events_.size();
  for (std::size_t c = 0; c < after.size(); ++c) {
    const ContactStatus before = state_.status()[c];
    if (before == after[c]) continue;
    const BreakMode mode = after[c] == ContactStatus::open    ? BreakMode::open
                           : before == ContactStatus::open    ? BreakMode::close
                           : after[c] == ContactStatus::stuck ? BreakMode::stick
                                                              : BreakMode::slip;
    events_.push_back(event_of(c, mode));
    events_.back().relative_residual = state_.relative_residual();
  }
  if (events_.size() > first && !releasing()) steps_ = 0;
  for (std::size_t k = first; k < events_.size(); ++k)
    events_[k].ties = static_cast<std::int64_t>(events_.size() - first - 1);
}

double UnbondedRun::strength_of(const NextContactEvent& next) const {
  const ContactStrengths& strengths = scene_.strengths;
  return (*next.breaks == BreakMode::tension ? strengths.tension : strengths.shear)[next.contact];
}

void UnbondedRun::break_bond(const NextContactEvent& next, double lambda_rate) {
  BreakEvent event = event_of(next.contact, *next.breaks);
  event.relative_residual = state_.relative_residual();
  event.ties = next.ties;
  // The gap of t, as one of lambda.
  if (!releasing() && state_.lambda() != 0) event.gap = next.gap * next.t * std::abs(lambda_rate / state_.lambda());
  const std::size_t c = next.contact;
  const double n = state_.normal_coordinate(c), t = state_.forces()[c].tangential;
  ContactStatus status = ContactStatus::stuck;
  if (n >= 0) {
    status = ContactStatus::open;
  } else if (laws_[c].rough() && std::abs(t) > -laws_[c].friction * n) {
    status = slipping(t);
  }
  state_.break_bond(c, status);
  breaking_.push_back(events_.size());
  events_.push_back(event);
  share_ = 1;
}

void UnbondedRun::finish_stage() {
  rates_.reset();
  standstill_.begin();
  steps_ = 0;
  if (releasing()) {
    state_.end_release();
    note_released();
    breaking_.clear();
    pauses_ = true;
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
    end(PathEnd::legs_done, fmt::format("lambda has reached {:g}", state_.lambda()));
}

/// Notes, with the events of the breaking bonds, the energy that these have released so far.
void UnbondedRun::note_released() {
  for (const std::size_t k : breaking_) {
    events_[k].energy_after = state_.ledger().elastic;
    events_[k].energy_released = state_.released_by(static_cast<std::size_t>(events_[k].contact));
    events_[k].work = state_.ledger().work;
  }
}

bool UnbondedRun::move(double t) {
  if (!releasing()) travelled_ += t;
  if (!standstill_.moved(t, releasing() ? 1 : travelled_) && standstill_.again(state_.status())) {
    end(PathEnd::no_answer, fmt::format("{}contact states cycle at lambda = {:g}: no consistent contact state found",
                                        at_dead_loads(), state_.lambda()));
    return false;
  }
  if (t == 0) return true;
  const double load = state_.load(), motion = state_.mean_motion(), lambda = state_.lambda();
  if (releasing()) state_.release_to(share_ * (1 - t));
  state_.move(t, *rates_, !dead_done_, by_motion(), solver_);
  if (releasing()) share_ *= 1 - t;
  const double by = state_.lambda() - lambda;
  load_rate_ = by != 0 ? (state_.load() - load) / by : 0;
  motion_rate_ = by != 0 ? (state_.mean_motion() - motion) / by : 0;
  if (state_.relative_residual() > balances_to) {
    end(PathEnd::not_balanced,
        fmt::format(
            "at lambda = {:g} the forces balance to {:.1e} of the largest, not to {:g}: the tangent stiffness of some "
            "discs is near singular",
            state_.lambda(), state_.relative_residual(), balances_to));
    return false;
  }
  largest_residual_ = std::max(largest_residual_, state_.relative_residual());
  return true;
}

void UnbondedRun::step() {
  const std::size_t before = events_.size();
  if (rates_ || (find_rates() && events_.size() == before)) go_on();
  note_released();
}

/// To the next event, or to the end of the stage.
void UnbondedRun::go_on() {
  const double stage = stage_end();
  const NextContactEvent next = next_contact_event(state_, laws_, scene_.strengths, *rates_, stage);
  const double t = std::min(stage, next.t);
  if (t == infinite && by_motion() && rates_->lambda == 0)
    return end(PathEnd::carries_nothing, "the motion grows without a load, and no contact changes any more");
  if (t == infinite) return end(PathEnd::never_breaks, "no contact changes any more at any lambda");
  const std::int64_t most_steps = 1000 + 20 * std::ssize(laws_);  // a release may go on by ever smaller parts
  if (++steps_ > most_steps) {
    end(PathEnd::no_answer,
        fmt::format("{}contacts change {} times before lambda = {:g} is left: no consistent contact state found",
                    at_dead_loads(), steps_ - 1, state_.lambda()));
    return;
  }
  if (!move(t)) return;
  const double lambda_rate = rates_->lambda;
  rates_.reset();
  if (next.t <= stage && next.breaks && !state_.carries() && strength_of(next) > 0) {
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
