// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "equidem/breakage/solved_states.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
namespace {

constexpr double negligible = 1e-8;  // over the size of the terms: what rounding leaves where loads balance

class RefactorizedSystem final : public SolvedStates {
 public:
  RefactorizedSystem(BreakableNetwork network, std::span<const std::size_t> broken)
      : SolvedStates(network.cases.size(), network.assembly.size()),
        network_(std::move(network)),
        per_disc_(static_cast<std::size_t>(network_.effects.unknowns_per_disc())),
        scale_(network_.assembly.mean_radius()),
        broken_(network_.assembly.contacts.size(), 0),
        held_(held_or_loaded(network_)) {
    network_.solver = factor_to_update(network_.solver);
    for (const std::size_t c : broken) broken_[c] = 1;
    solve();
  }

  std::vector<std::int32_t> remove(std::span<const std::size_t> contacts) override {
    for (const std::size_t c : contacts) broken_[c] = 1;
    const std::vector<std::uint8_t> before = left_;
    solve();
    std::vector<std::int32_t> gone;
    for (std::size_t d = 0; d < left_.size(); ++d) {
      if (left_[d] != 0 && before[d] == 0) gone.push_back(static_cast<std::int32_t>(d));
    }
    return gone;
  }

  [[nodiscard]] std::int64_t unstable_modes() const override { return unstable_modes_; }
  [[nodiscard]] BreakableCounters counters() const override { return counters_; }
  [[nodiscard]] std::string solver_name() const override { return solver_name_; }

 private:
  void solve();
  void solve_cases(const RestOfNetwork& rest, DegreesOfFreedom unknowns);
  RightHandSide on(const RestOfNetwork& rest, const RightHandSide& whole) const;
  bool drives_mechanism(const RightHandSide& given, const RestOfNetwork& rest, const StiffnessSolver& solver);
  void take(const RestOfNetwork& rest, const StiffnessSolver& solver, const HeldMotions& held,
            const RightHandSide& given, const Solution& solution, State& state);

  BreakableNetwork network_;
  std::size_t per_disc_;
  double scale_;
  std::vector<std::uint8_t> broken_, held_;
  std::string solver_name_;
  std::int64_t unstable_modes_ = 0;
  BreakableCounters counters_;
};

RightHandSide RefactorizedSystem::on(const RestOfNetwork& rest, const RightHandSide& whole) const {
  RightHandSide part;
  part.gradient = whole.gradient;
  const auto taken = [&](const std::vector<double>& from) {
    std::vector<double> to;
    if (from.empty()) return to;
    to.reserve(rest.discs.size() * per_disc_);
    for (const std::int32_t disc : rest.discs) {
      for (std::size_t k = 0; k < per_disc_; ++k) to.push_back(from[static_cast<std::size_t>(disc) * per_disc_ + k]);
    }
    return to;
  };
  part.force = taken(whole.force);
  part.prescribed = taken(whole.prescribed);
  return part;
}

void RefactorizedSystem::solve() {
  why_not_.clear();
  const RestOfNetwork rest = load_bearing_rest(network_, broken_, held_);
  left_ = discs_outside(rest, left_.size());
  for (State& state : states_) {
    state.forces.assign(network_.assembly.contacts.size(), {});
    state.motion.assign(network_.assembly.size() * per_disc_, 0.0);
    state.reactions.assign(state.motion.size(), 0.0);
    state.carried = true;
  }
  measured(0);
  unstable_modes_ = 0;
  if (rest.discs.empty()) return;
  DegreesOfFreedom unknowns = number_unknowns(rest.assembly, rest.springs, network_.effects, network_.supports);
  unknowns.rotation_scale = scale_;
  solve_cases(rest, std::move(unknowns));
}

void RefactorizedSystem::solve_cases(const RestOfNetwork& rest, DegreesOfFreedom unknowns) {
  StageTimes times;
  ContactGraph graph(rest.assembly);
  const HeldMotions held = hold_free_motions(rest.assembly, graph, rest.springs, unknowns);
  const StiffnessSolver solver(rest.assembly, rest.springs, std::move(graph), std::move(unknowns), network_.solver,
                               Mechanisms::hold, times);
  ++counters_.factorizations;
  solver_name_ = solver.solver_name();
  unstable_modes_ = solver.unstable_modes();
  std::vector<RightHandSide> cases;
  std::vector<std::size_t> of;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    RightHandSide given = on(rest, network_.cases[k]);
    states_[k].carried = !drives_mechanism(given, rest, solver);
    if (!states_[k].carried) continue;
    cases.push_back(std::move(given));
    of.push_back(k);
  }
  if (cases.empty()) return;
  const std::vector<Solution> solutions = solver.solve(cases, times);
  double residual = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    take(rest, solver, held, cases[k], solutions[k], states_[of[k]]);
    residual = std::max(residual, solutions[k].relative_residual());
  }
  measured(residual);
  counters_.largest_residual = largest_residual();
}

/// Where no spring is negative a mechanism deforms no contact, so that only loads can drive it.
bool RefactorizedSystem::drives_mechanism(const RightHandSide& given, const RestOfNetwork& rest,
                                          const StiffnessSolver& solver) {
  for (std::int64_t m = 0; !given.force.empty() && m < solver.factor().report().zero_pivots; ++m) {
    const std::vector<double> motion = solver.factor().null_motion(m);
    if (!does_work(given.force, motion, solver.unknowns().per_disc)) continue;
    const std::vector<DiscMotion> of_rest = disc_motions(solver.unknowns(), motion);
    std::vector<DiscMotion> motions(network_.assembly.size());
    for (std::size_t d = 0; d < of_rest.size(); ++d) motions[static_cast<std::size_t>(rest.discs[d])] = of_rest[d];
    why_not_ = describe_driven(network_, rest, std::move(motions));
    return true;
  }
  return false;
}

void RefactorizedSystem::take(const RestOfNetwork& rest, const StiffnessSolver& solver, const HeldMotions& held,
                              const RightHandSide& given, const Solution& solution, State& state) {
  std::vector<ContactForce> forces(rest.contacts.size());
  for (std::size_t c = 0; c < forces.size(); ++c)
    forces[c] = linear_spring_force(rest.springs[c], solver.contact_motion(given, solution.motion, c).deformation);
  std::vector<double> reactions(solution.motion.high.size());
  internal_force(rest.assembly, solver.graph(), solver.unknowns(), forces, reactions);
  for (std::size_t k = 0; k < reactions.size(); ++k) {
    if (solver.unknowns().held[k] == DegreesOfFreedom::free) {
      reactions[k] = 0;
    } else if (!given.force.empty()) {
      reactions[k] -= given.force[k];
    }
  }
  for (const std::size_t component : held.components) {
    if (std::abs(reactions[component]) <= negligible * solution.scale) {
      reactions[component] = 0;
      continue;
    }
    const auto disc = static_cast<std::size_t>(rest.discs[component / per_disc_]);
    why_not_ =
        fmt::format("a load moves the part around {}, which nothing holds", describe_disc(network_.assembly, disc));
    state.carried = false;
    return;
  }
  for (std::size_t c = 0; c < forces.size(); ++c) state.forces[static_cast<std::size_t>(rest.contacts[c])] = forces[c];
  for (std::size_t d = 0; d < rest.discs.size(); ++d) {
    for (std::size_t k = 0; k < per_disc_; ++k) {
      const std::size_t to = static_cast<std::size_t>(rest.discs[d]) * per_disc_ + k;
      state.motion[to] = solution.motion.high[d * per_disc_ + k];
      state.reactions[to] = reactions[d * per_disc_ + k];
    }
  }
}

}  // namespace

RestOfNetwork unbroken_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken) {
  const Assembly& whole = network.assembly;
  RestOfNetwork rest;
  Assembly& a = rest.assembly;
  a.kind = whole.kind;
  a.centres = whole.centres;
  a.radii = whole.radii;
  a.period = whole.period;
  a.groups = whole.groups;
  a.sections = whole.sections;
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < whole.contacts.size(); ++c) {
    if (broken[c] != 0) continue;
    rest.contacts.push_back(static_cast<std::int32_t>(c));
    a.contacts.push_back(whole.contacts[c]);
    if (!whole.contact_arms.empty()) a.contact_arms.push_back(whole.contact_arms[c]);
    if (!network.springs.uniform()) springs.push_back(network.springs[c]);
  }
  rest.springs = springs.empty() ? network.springs : ContactSprings(std::move(springs));
  rest.discs.resize(whole.size());
  std::iota(rest.discs.begin(), rest.discs.end(), 0);
  return rest;
}

RestOfNetwork load_bearing_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken,
                                const std::vector<std::uint8_t>& held) {
  RestOfNetwork rest = unbroken_rest(network, broken);
  LoadBearingNetwork found = load_bearing_network(rest.assembly, rest.springs, network.effects, held);
  if (!found.part) return rest;
  for (std::int32_t& contact : found.part->contacts) contact = rest.contacts[static_cast<std::size_t>(contact)];
  return {std::move(found.part->assembly), std::move(found.part->springs), std::move(found.part->discs),
          std::move(found.part->contacts)};
}

std::vector<std::uint8_t> discs_outside(const RestOfNetwork& rest, std::size_t discs) {
  std::vector<std::uint8_t> outside(discs, 1);
  for (const std::int32_t disc : rest.discs) outside[static_cast<std::size_t>(disc)] = 0;
  return outside;
}

std::string describe_driven(const BreakableNetwork& network, const RestOfNetwork& rest,
                            std::vector<DiscMotion> motions) {
  std::vector<std::uint8_t> without_force(network.assembly.contacts.size(), 1);
  for (const std::int32_t contact : rest.contacts) without_force[static_cast<std::size_t>(contact)] = 0;
  const std::vector<std::uint8_t> outside = discs_outside(rest, motions.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    if (outside[d] != 0) motions[d] = {};
  }
  return "a load drives " + describe_motion(unbroken_rest(network, without_force).assembly, motions);
}

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

std::unique_ptr<BreakableSystem> make_refactorized_rest(BreakableNetwork network, std::span<const std::size_t> broken) {
  return std::make_unique<RefactorizedSystem>(std::move(network), broken);
}

std::unique_ptr<BreakableSystem> make_refactorized_system(BreakableNetwork network) {
  return make_refactorized_rest(std::move(network), {});
}

}  // namespace equidem
