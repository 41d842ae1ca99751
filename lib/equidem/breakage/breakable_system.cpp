// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/breakable_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "equidem/breakage/disjoint_ways.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {

namespace {

/// A part of a network, with its numbers in the whole.
using Rest = LoadBearingNetwork::Part;

/// All discs, and the contacts that are not `gone` (per contact, 1).
Rest without(const BreakableNetwork& network, const std::vector<std::uint8_t>& gone) {
  const Assembly& whole = network.assembly;
  Rest rest{{}, network.springs, {}, {}};
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
    rest.contacts.push_back(static_cast<std::int32_t>(c));
    a.contacts.push_back(whole.contacts[c]);
    if (!whole.contact_arms.empty()) a.contact_arms.push_back(whole.contact_arms[c]);
    if (!network.springs.uniform()) springs.push_back(network.springs[c]);
  }
  if (!springs.empty()) rest.springs = ContactSprings(std::move(springs));
  rest.discs.resize(whole.size());
  std::iota(rest.discs.begin(), rest.discs.end(), 0);
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

/// The discs that can carry a force, and their contacts.
Rest load_bearing_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken) {
  Rest rest = without(network, broken);
  LoadBearingNetwork found =
      load_bearing_network(rest.assembly, rest.springs, network.effects, held_or_loaded(network));
  if (!found.part) return rest;
  for (std::int32_t& contact : found.part->contacts) contact = rest.contacts[static_cast<std::size_t>(contact)];
  return std::move(*found.part);
}

std::vector<std::uint8_t> discs_outside(const Rest& rest, std::size_t discs) {
  std::vector<std::uint8_t> outside(discs, 1);
  for (const std::int32_t disc : rest.discs) outside[static_cast<std::size_t>(disc)] = 0;
  return outside;
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
  return discs_outside(load_bearing_rest(network, broken), network.assembly.size());
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
      if (std::abs(reactions(p)[k]) > negligible_reaction * largest) return updated_.reset();
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
    if (mechanism.driven) driven = mechanism.component;
  }
  if (driven < 0 && loose) leave();
  const double residual = equilibrium.residual();
  if (driven < 0 && residual <= UpdatedNetworkOptions{}.claimed_residual) return measured(residual);
  std::vector<DiscMotion> motion = equilibrium.driven_mechanism(driven);
  if (motion.empty()) return stop_updating();
  for (State& state : states_) state.carried = false;
  leave();
  for (const std::int32_t disc : discs_set(left_)) motion[static_cast<std::size_t>(disc)] = {};
  why_not_ = describe_driven(motion);
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

/// \param motions 0 of discs that have left
std::string BreakableSystem::describe_driven(const std::vector<DiscMotion>& motions) const {
  std::vector<std::uint8_t> gone = broken_;
  for (std::size_t c = 0; c < gone.size(); ++c) {
    const Contact& contact = network_.assembly.contacts[c];
    if (left_[contact.i] != 0 || left_[contact.j] != 0) gone[c] = 1;
  }
  return "a load drives " + describe_motion(without(network_, gone).assembly, motions);
}

void BreakableSystem::solve_anew() {
  why_not_.clear();
  const Rest rest = load_bearing_rest(network_, broken_);
  left_ = discs_outside(rest, left_.size());
  for (State& state : states_) {
    state.forces.assign(network_.assembly.contacts.size(), {});
    state.motion.assign(network_.assembly.size() * per_disc_, 0.0);
    state.reactions = state.motion;
    state.carried = true;
  }
  measured(0);
  unstable_modes_ = 0;
  if (rest.discs.empty()) return;
  StageTimes times;
  ContactGraph graph(rest.assembly);
  DegreesOfFreedom unknowns = number_unknowns(rest.assembly, rest.springs, network_.effects, network_.supports);
  unknowns.rotation_scale = network_.assembly.mean_radius();
  const HeldMotions held = hold_free_motions(rest.assembly, graph, rest.springs, unknowns);
  StiffnessSolver solver(rest.assembly, rest.springs, std::move(graph), std::move(unknowns), network_.solver,
                         Mechanisms::hold, times);
  ++report_.factorizations;
  if (was_updated_) ++report_.mended;
  report_.name = solver.solver_name();
  unstable_modes_ = solver.unstable_modes();
  solve_cases(solver, held, rest, times);
}

void BreakableSystem::solve_cases(StiffnessSolver& solver, const HeldMotions& held, const Rest& rest,
                                  StageTimes& times) {
  std::vector<std::size_t> components;  // of the whole, per component of the rest
  for (const std::int32_t disc : rest.discs) {
    for (std::size_t k = 0; k < per_disc_; ++k) components.push_back(static_cast<std::size_t>(disc) * per_disc_ + k);
  }
  const auto of_rest = [&](const std::vector<double>& whole) {
    std::vector<double> part;
    for (std::size_t k = 0; k < components.size() && !whole.empty(); ++k) part.push_back(whole[components[k]]);
    return part;
  };
  const auto of_whole = [&](const std::vector<double>& part) {
    std::vector<double> whole(left_.size() * per_disc_, 0.0);
    for (std::size_t k = 0; k < components.size(); ++k) whole[components[k]] = part[k];
    return whole;
  };
  std::vector<RightHandSide> cases;
  std::vector<State*> states;
  for (std::size_t p = 0; p < states_.size(); ++p) {
    const RightHandSide& whole = network_.cases[p];
    RightHandSide given{.force = of_rest(whole.force), .prescribed = of_rest(whole.prescribed)};
    given.gradient = whole.gradient;
    const auto driven = solver.driven_mechanism(given.force);
    states_[p].carried = !driven;
    if (states_[p].carried) {
      cases.push_back(std::move(given));
      states.push_back(&states_[p]);
    } else {
      why_not_ = describe_driven(disc_motions(solver.unknowns(), of_whole(*driven)));
    }
  }
  if (cases.empty()) return;
  const std::vector<Solution> solutions = solver.solve(cases, times);
  double residual = 0;
  for (std::size_t p = 0; p < cases.size(); ++p) {
    residual = std::max(residual, solutions[p].relative_residual());
    State& state = *states[p];
    std::vector<ContactForce> forces(rest.contacts.size());
    for (std::size_t c = 0; c < forces.size(); ++c)
      forces[c] =
          linear_spring_force(rest.springs[c], solver.contact_motion(cases[p], solutions[p].motion, c).deformation);
    std::vector<double> reactions(components.size());
    internal_force(rest.assembly, solver.graph(), solver.unknowns(), forces, reactions);
    keep_reactions(solver.unknowns(), cases[p].force, reactions);
    for (const std::size_t component : held.components) {
      const bool loaded = std::abs(reactions[component]) > negligible_reaction * solutions[p].scale;
      if (!loaded) reactions[component] = 0;
      if (!loaded || !state.carried) continue;
      state.carried = false;
      why_not_ = fmt::format("a load moves the part around {}, which nothing holds",
                             describe_disc(network_.assembly, components[component] / per_disc_));
    }
    if (!state.carried) continue;
    for (std::size_t c = 0; c < forces.size(); ++c)
      state.forces[static_cast<std::size_t>(rest.contacts[c])] = forces[c];
    state.motion = of_whole(solutions[p].motion.high);
    state.reactions = of_whole(reactions);
  }
  measured(residual);
}

}  // namespace equidem
