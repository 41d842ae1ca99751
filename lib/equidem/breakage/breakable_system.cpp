// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/breakable_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/breakage/disjoint_ways.hpp"
#include "equidem/breakage/network_response.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {

/// Some contacts of a network, with all its discs.
struct RestOfNetwork {
  Assembly assembly;
  ContactSprings springs;
  std::vector<Support> supports;
  std::vector<std::size_t> contacts;  // of the whole, ascending
};

namespace {

constexpr double negligible = 1e-8;  // over the size of the terms: what rounding leaves where loads balance

/// Without the contacts `gone` (per contact, 1).
RestOfNetwork without(const BreakableNetwork& network, const std::vector<std::uint8_t>& gone) {
  const Assembly& whole = network.assembly;
  RestOfNetwork rest{{}, network.springs, network.supports, {}};
  Assembly& a = rest.assembly;
  a.kind = whole.kind;
  a.centres = whole.centres;
  a.radii = whole.radii;
  a.period = whole.period;
  a.groups = whole.groups;
  a.sections = whole.sections;
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < whole.contacts.size(); ++c) {
    if (gone[c] != 0) continue;
    rest.contacts.push_back(c);
    a.contacts.push_back(whole.contacts[c]);
    if (!whole.contact_arms.empty()) a.contact_arms.push_back(whole.contact_arms[c]);
    if (!network.springs.uniform()) springs.push_back(network.springs[c]);
  }
  if (!springs.empty()) rest.springs = ContactSprings(std::move(springs));
  return rest;
}

/// Discs that are held, and those on which a force acts, per disc: 1.
std::vector<std::uint8_t> held_or_loaded(const BreakableNetwork& network) {
  const Assembly& whole = network.assembly;
  const auto per_disc = static_cast<std::size_t>(network.effects.unknowns_per_disc());
  std::vector<std::uint8_t> held(whole.size(), 0);
  for (const Support& support : network.supports) {
    for (const std::int32_t disc : group(whole, support.group).discs) held[static_cast<std::size_t>(disc)] = 1;
  }
  for (const RightHandSide& given : network.cases) {
    for (std::size_t k = 0; k < given.force.size(); ++k) {
      if (given.force[k] != 0) held[k / per_disc] = 1;
    }
  }
  return held;
}

/// K u - f of held components, 0 of free ones, from K u.
void keep_reactions(const DegreesOfFreedom& unknowns, const std::vector<double>& load, std::vector<double>& internal) {
  for (std::size_t k = 0; k < internal.size(); ++k) {
    if (unknowns.held[k] == DegreesOfFreedom::free) {
      internal[k] = 0;
    } else if (!load.empty()) {
      internal[k] -= load[k];
    }
  }
}

void add(const UpdateCounters& more, SolverReport& to) {
  to.factorizations += more.factorizations;
  to.updates += more.updates;
  to.mended += more.mended;
  to.refinements += more.refinements;
}

/// Whether energies and lengths of residuals, which are made of squares of forces, stay in the range of numbers.
bool squares_fit(const BreakableNetwork& network, double stiffest) {
  constexpr double smallest = 1e-30, largest = 1e30;
  return std::ranges::all_of(network.cases, [&](const RightHandSide& given) {
    double force = 0, motion = 0;
    for (const double f : given.force) force = std::max(force, std::abs(f));
    for (const double u : given.prescribed) motion = std::max(motion, std::abs(u));
    if (given.gradient) {
      const Tensor2& g = *given.gradient;
      motion = std::max(motion, 2 * network.assembly.mean_radius() *
                                    std::max({std::abs(g.xx), std::abs(g.xy), std::abs(g.yx), std::abs(g.yy)}));
    }
    const double size = std::max(force, stiffest * motion);
    return size == 0 || (size >= smallest && size <= largest);
  });
}

}  // namespace

std::vector<std::uint8_t> idle_discs(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken) {
  const RestOfNetwork rest = without(network, broken);
  const LoadBearingNetwork found =
      load_bearing_network(rest.assembly, rest.springs, network.effects, held_or_loaded(network));
  std::vector<std::uint8_t> idle(network.assembly.size(), found.part ? 1 : 0);
  if (!found.part) return idle;
  for (const std::int32_t disc : found.part->discs) idle[static_cast<std::size_t>(disc)] = 0;
  return idle;
}

std::vector<std::int32_t> discs_set(const std::vector<std::uint8_t>& now, const std::vector<std::uint8_t>& before) {
  std::vector<std::int32_t> discs;
  for (std::size_t d = 0; d < now.size(); ++d) {
    if (now[d] != 0 && (before.empty() || before[d] == 0)) discs.push_back(static_cast<std::int32_t>(d));
  }
  return discs;
}

/// The network as long as its factor is updated.
struct BreakableSystem::Updated {
  std::vector<std::size_t> held_free;  // components that are held because nothing else holds their part
  DegreesOfFreedom unknowns;
  ContactGraph graph;
  DisjointWays ways;
  UpdatedNetwork equilibrium;

  Updated(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken,
          const std::vector<std::uint8_t>& left)
      : unknowns(number_unknowns(network.assembly, network.springs, network.effects, network.supports)),
        graph(network.assembly),
        ways(network.assembly, graph, network.springs, broken, left),
        equilibrium(
            network.assembly, network.springs, hold_rest(network), network.cases,
            {.memory_limit = network.solver.memory_limit, .force_moments = area_of_stress(network.assembly) > 0}) {}

 private:
  const DegreesOfFreedom& hold_rest(const BreakableNetwork& network) {
    held_free = hold_free_motions(network.assembly, graph, network.springs, unknowns).components;
    return unknowns;
  }
};

BreakableSystem::BreakableSystem(BreakableNetwork network, Factor factor, std::vector<std::uint8_t> broken)
    : network_(std::move(network)),
      per_disc_(static_cast<std::size_t>(network_.effects.unknowns_per_disc())),
      broken_(std::move(broken)),
      left_(network_.assembly.size(), 0),
      states_(network_.cases.size()) {
  network_.solver = factor_to_update(network_.solver);
  broken_.resize(network_.assembly.contacts.size(), 0);
  const bool whole = std::ranges::count(broken_, 0) == std::ssize(broken_);
  if (factor == Factor::updated && whole && can_be_updated()) update_from_here();
  if (updated_ == nullptr) solve_anew();
}

BreakableSystem::~BreakableSystem() = default;

bool BreakableSystem::can_be_updated() const {
  const ContactSprings& springs = network_.springs;
  if (network_.solver.method != SolverMethod::multifrontal || springs.any_negative() || network_.cases.size() > 2)
    return false;
  if (load_bearing_network(network_.assembly, springs, network_.effects, held_or_loaded(network_)).removed() > 0)
    return false;
  // Where springs are further apart, residuals that are refined to round-off of the loads leave the forces of the soft
  // ones uncertain.
  constexpr double most_apart = 1e6;
  double softest = std::numeric_limits<double>::infinity(), stiffest = 0;
  for (std::size_t c = 0; c < network_.assembly.contacts.size(); ++c) {
    for (const double k : {springs[c].kN, springs[c].kT}) {
      if (k > 0) softest = std::min(softest, k);
      stiffest = std::max(stiffest, k);
    }
  }
  return stiffest <= most_apart * softest && squares_fit(network_, stiffest);
}

/// Stays without a factor where discs that carry load take part in a mechanism, or where loads move a part that nothing
/// holds: these show as forces of the components that are held in place of it.
void BreakableSystem::update_from_here() {
  try {
    updated_ = std::make_unique<Updated>(network_, broken_, left_);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::computation_failed) throw;
    return;
  }
  for (std::size_t p = 0; p < states_.size(); ++p) {
    double largest = largest_force(forces(p));
    for (const double f : network_.cases[p].force) largest = std::max(largest, std::abs(f));
    for (const std::size_t k : updated_->held_free) {
      if (std::abs(reactions(p)[k]) > negligible * largest) return updated_.reset();
    }
  }
  was_updated_ = true;
  measured(updated_->equilibrium.residual());
}

std::vector<std::int32_t> BreakableSystem::remove(std::span<const std::size_t> contacts) {
  const std::vector<std::uint8_t> before = left_;
  for (const std::size_t contact : contacts) {
    broken_[contact] = 1;
    if (updated_ != nullptr && carries(0)) {
      take_out(contact);
    } else {
      stop_updating();
    }
  }
  if (updated_ == nullptr) solve_anew();
  return discs_set(left_, before);
}

/// A support that a mechanism was given takes no force unless a load works on the mechanism. Where one does for
/// certain, nothing is left to solve for. Refinement with a new factor may not serve where hardly anything is left, and
/// round-off of many changes may look like such a mechanism: from there on every network is solved alone.
void BreakableSystem::take_out(std::size_t contact) {
  UpdatedNetwork& equilibrium = updated_->equilibrium;
  read_ = false;
  bool loose = !updated_->ways.around(contact);
  std::int64_t driven = -1;  // component held in place of a mechanism on which a load seems to work
  for (const HeldMechanism& mechanism : equilibrium.remove(contact)) {
    loose = true;
    if (std::ranges::any_of(mechanism.driven, [](std::uint8_t by_load) { return by_load != 0; }))
      driven = mechanism.component;
  }
  if (driven < 0 && loose) leave();
  const double residual = equilibrium.residual();
  if (driven < 0 && residual <= UpdatedNetworkOptions{}.claimed_residual) return measured(residual);
  std::vector<DiscMotion> motion = equilibrium.driven_mechanism(driven);
  if (motion.empty()) return stop_updating();
  for (State& state : states_) state.carried = false;
  leave();
  for (const std::int32_t disc : discs_set(left_)) motion[static_cast<std::size_t>(disc)] = {};
  why_not_ = "a load drives " + describe_motion(rest().assembly, motion);
  measured(0);
}

/// Discs that can carry no force any more leave the network.
void BreakableSystem::leave() {
  const std::vector<std::uint8_t> before = std::exchange(left_, idle_discs(network_, broken_));
  std::vector<std::size_t> idle;
  for (const std::int32_t disc : discs_set(left_, before)) {
    for (const auto& edge : updated_->graph.of(disc)) idle.push_back(static_cast<std::size_t>(edge.contact));
  }
  updated_->equilibrium.spare(idle);
}

std::optional<EquilibriumSums> BreakableSystem::sums() const {
  if (updated_ == nullptr || !carries(0)) return {};
  return updated_->equilibrium.sums();
}

std::span<const ContactForce> BreakableSystem::forces(std::size_t of_case) const {
  return updated_ != nullptr && carries(of_case) ? updated_->equilibrium.forces(of_case) : state(of_case).forces;
}

bool BreakableSystem::carries() const {
  return std::ranges::all_of(states_, &State::carried);
}

const BreakableSystem::State& BreakableSystem::state(std::size_t of_case) const {
  for (std::size_t p = 0; updated_ != nullptr && !read_ && p < states_.size(); ++p) read_state(states_[p], p);
  read_ = true;
  return states_[of_case];
}

void BreakableSystem::read_state(State& state, std::size_t of_case) const {
  const DegreesOfFreedom& unknowns = updated_->unknowns;
  state.reactions.assign(unknowns.held.size(), 0.0);
  if (!state.carried) {
    state.forces.assign(network_.assembly.contacts.size(), {});
    state.motion = state.reactions;
    return;
  }
  state.motion = updated_->equilibrium.motion(of_case).high;
  for (std::size_t k = 0; k < state.motion.size(); ++k) {
    if (left_[k / per_disc_] != 0) state.motion[k] = 0;
  }
  internal_force(network_.assembly, updated_->graph, unknowns, updated_->equilibrium.forces(of_case), state.reactions);
  keep_reactions(unknowns, network_.cases[of_case].force, state.reactions);
}

SolverReport BreakableSystem::report() const {
  SolverReport all = report_;
  if (was_updated_) {
    const std::string updated = "multifrontal Cholesky, updated";
    all.name =
        updated_ != nullptr ? updated : fmt::format("{}; from where it did not serve: {}", updated, report_.name);
  }
  if (updated_ != nullptr) add(updated_->equilibrium.counters(), all);
  return all;
}

/// From here on every network is factorized anew.
void BreakableSystem::stop_updating() {
  if (updated_ != nullptr) add(updated_->equilibrium.counters(), report_);
  updated_.reset();
}

void BreakableSystem::measured(double residual) {
  residual_ = residual;
  report_.largest_residual = std::max(report_.largest_residual, residual);
}

RestOfNetwork BreakableSystem::rest() const {
  std::vector<std::uint8_t> gone = broken_;
  for (std::size_t c = 0; c < gone.size(); ++c) {
    const Contact& contact = network_.assembly.contacts[c];
    if (left_[contact.i] != 0 || left_[contact.j] != 0) gone[c] = 1;
  }
  RestOfNetwork rest = without(network_, gone);
  const char* const outside = "outside the network";  // a group that no case can name
  rest.assembly.groups[outside].discs = discs_set(left_);
  if (!rest.assembly.groups[outside].discs.empty()) rest.supports.push_back({outside, 0.0, 0.0, 0.0});
  return rest;
}

void BreakableSystem::solve_anew() {
  why_not_.clear();
  left_ = idle_discs(network_, broken_);
  for (State& state : states_) {
    state.forces.assign(network_.assembly.contacts.size(), {});
    state.motion.assign(network_.assembly.size() * per_disc_, 0.0);
    state.reactions = state.motion;
    state.carried = true;
  }
  measured(0);
  unstable_modes_ = 0;
  if (std::ranges::count(left_, 0) == 0) return;
  const RestOfNetwork rest = this->rest();
  StageTimes times;
  ContactGraph graph(rest.assembly);
  DegreesOfFreedom unknowns = number_unknowns(rest.assembly, rest.springs, network_.effects, rest.supports);
  const HeldMotions held = hold_free_motions(rest.assembly, graph, rest.springs, unknowns);
  const StiffnessSolver solver(rest.assembly, rest.springs, std::move(graph), std::move(unknowns), network_.solver,
                               Mechanisms::hold, times);
  ++report_.factorizations;
  if (was_updated_) ++report_.mended;
  report_.name = solver.solver_name();
  unstable_modes_ = solver.unstable_modes();
  solve_cases(solver, held, rest, times);
}

void BreakableSystem::solve_cases(const StiffnessSolver& solver, const HeldMotions& held, const RestOfNetwork& rest,
                                  StageTimes& times) {
  std::vector<RightHandSide> cases;
  std::vector<State*> of;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    states_[k].carried = !drives_mechanism(network_.cases[k], solver, rest.assembly);
    if (!states_[k].carried) continue;
    cases.push_back(network_.cases[k]);
    of.push_back(&states_[k]);
  }
  if (cases.empty()) return;
  const std::vector<Solution> solutions = solver.solve(cases, times);
  double residual = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    take(rest, solver, held, cases[k], solutions[k], *of[k]);
    residual = std::max(residual, solutions[k].relative_residual());
  }
  measured(residual);
}

/// Where no spring is negative a mechanism deforms no contact, so that only loads can drive it.
bool BreakableSystem::drives_mechanism(const RightHandSide& given, const StiffnessSolver& solver,
                                       const Assembly& rest) {
  for (std::int64_t m = 0; !given.force.empty() && m < solver.factor().report().zero_pivots; ++m) {
    const std::vector<double> motion = solver.factor().null_motion(m);
    if (!does_work(given.force, motion, solver.unknowns().per_disc)) continue;
    why_not_ = "a load drives " + describe_motion(rest, disc_motions(solver.unknowns(), motion));
    return true;
  }
  return false;
}

void BreakableSystem::take(const RestOfNetwork& rest, const StiffnessSolver& solver, const HeldMotions& held,
                           const RightHandSide& given, const Solution& solution, State& state) {
  std::vector<ContactForce> forces(rest.contacts.size());
  for (std::size_t c = 0; c < forces.size(); ++c)
    forces[c] = linear_spring_force(rest.springs[c], solver.deformation(given, solution.motion, c));
  std::vector<double> reactions(solution.motion.high.size());
  internal_force(rest.assembly, solver.graph(), solver.unknowns(), forces, reactions);
  keep_reactions(solver.unknowns(), given.force, reactions);
  for (const std::size_t component : held.components) {
    if (std::abs(reactions[component]) <= negligible * solution.scale) {
      reactions[component] = 0;
      continue;
    }
    why_not_ = fmt::format("a load moves the part around {}, which nothing holds",
                           describe_disc(network_.assembly, component / per_disc_));
    state.carried = false;
    return;
  }
  for (std::size_t c = 0; c < forces.size(); ++c) state.forces[rest.contacts[c]] = forces[c];
  state.motion = solution.motion.high;
  state.reactions = std::move(reactions);
}

}  // namespace equidem
