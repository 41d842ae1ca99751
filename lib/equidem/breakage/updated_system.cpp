// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/breakage/solved_states.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/breaking/updated_equilibrium.hpp"
#include "equidem/statics/hold_free_motions.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

/// \param held_free components that are held because nothing else holds their part
DegreesOfFreedom unknowns_of(const BreakableNetwork& network, std::vector<std::size_t>& held_free) {
  DegreesOfFreedom unknowns = number_unknowns(network.assembly, network.springs, network.effects, network.supports);
  held_free = hold_free_motions(network.assembly, ContactGraph(network.assembly), network.springs, unknowns).components;
  return unknowns;
}

class UpdatedSystem final : public SolvedStates {
 public:
  UpdatedSystem(BreakableNetwork network, std::vector<std::uint8_t> held)
      : SolvedStates(network.cases.size(), network.assembly.size()),
        network_(std::move(network)),
        unknowns_(unknowns_of(network_, held_free_)),
        graph_(network_.assembly),
        held_(std::move(held)),
        broken_(network_.assembly.contacts.size(), 0),
        equilibrium_(network_.assembly, network_.springs, unknowns_, network_.cases,
                     std::vector<ContactStrength>(network_.assembly.contacts.size())) {
    take();
    check_held_free();
    first_force_ = largest_force();
    measured(equilibrium_.relative_residual());
  }

  /// One after another, so that a computation that is resumed has the bits of one that was never stopped.
  std::vector<std::int32_t> remove(std::span<const std::size_t> contacts) override {
    std::vector<std::int32_t> gone;
    for (const std::size_t contact : contacts) {
      const std::vector<std::int32_t> loosened = remove(contact);
      gone.insert(gone.end(), loosened.begin(), loosened.end());
    }
    std::ranges::sort(gone);
    return gone;
  }

  [[nodiscard]] std::int64_t unstable_modes() const override { return 0; }
  [[nodiscard]] BreakableCounters counters() const override {
    const UpdateCounters& c = equilibrium_.counters();
    return {c.factorizations, c.updates, c.mended, largest_residual()};
  }
  [[nodiscard]] std::string solver_name() const override { return "multifrontal Cholesky, updated"; }

 private:
  std::vector<std::int32_t> remove(std::size_t contact) {
    broken_[contact] = 1;
    bool loose = parts(contact);
    for (const HeldMechanism& mechanism : equilibrium_.remove(contact)) {
      loose = true;
      for (std::size_t p = 0; p < states_.size(); ++p) judge(mechanism, p);
    }
    std::vector<std::int32_t> gone;
    if (loose) gone = leave();
    take();
    // Round-off is that of the forces of the last refinement, of which little may be left.
    constexpr double little = 1e-2, allowed = 1e-13;
    double residual = equilibrium_.relative_residual();
    if (residual > allowed || largest_force() < little * first_force_) {
      static_cast<void>(equilibrium_.refine());
      take();
      residual = equilibrium_.relative_residual();
    }
    // A load that moves a part away is balanced by nothing: its residual means nothing.
    if (std::ranges::all_of(states_, &State::carried)) measured(residual);
    return gone;
  }

  /// Loads that move a part which nothing holds show as forces of the components that are held in place of it.
  void check_held_free() const {
    constexpr double balanced = 1e-8;  // over the largest load: what rounding leaves where loads balance
    for (std::size_t p = 0; p < states_.size(); ++p) {
      double largest = 0;
      for (const double f : network_.cases[p].force) largest = std::max(largest, std::abs(f));
      for (const std::size_t k : held_free_) {
        if (std::abs(states_[p].reactions[k]) <= balanced * largest) continue;
        computation_failed("a load moves a part that nothing holds", "the updated factor holds it", "Factorize anew");
      }
    }
  }

  /// A support that a mechanism was given takes no force unless a load works on the mechanism.
  void judge(const HeldMechanism& mechanism, std::size_t p) {
    if (!mechanism.driven[p]) return;
    const auto disc = static_cast<std::size_t>(mechanism.component / unknowns_.per_disc);
    why_not_ =
        fmt::format("a load moves the part around {}, which nothing holds", describe_disc(network_.assembly, disc));
    states_[p].carried = false;
  }

  /// Whether discs may carry nothing any more without a contact that broke. No disc does that, and no part hangs by one
  /// contact or disc, where the discs of the contact have more than two others each and are joined by two ways that
  /// share nothing: the parts of the graph that no single disc divides are then the same. False only where that is
  /// found.
  [[nodiscard]] bool parts(std::size_t contact) {
    const Contact& c = network_.assembly.contacts[contact];
    for (const std::int32_t disc : {c.i, c.j}) {
      std::int64_t others = 0;
      for (const auto& edge : graph_.of(disc)) others += broken_[edge.contact] == 0 ? 1 : 0;
      if (others <= 2) return true;
    }
    way_.clear();
    return !(finds_way(c.i, c.j) && finds_way(c.i, c.j));
  }

  /// A short way over contacts and discs that no earlier way of the same pair takes.
  bool finds_way(std::int32_t from, std::int32_t to) {
    constexpr std::size_t most_discs = 300;
    struct Step {
      std::int32_t disc, before, contact;
    };
    std::vector<Step> reached = {{from, -1, -1}};
    const auto taken = [&](std::int32_t disc) {
      return std::any_of(reached.begin(), reached.end(), [&](const Step& step) { return step.disc == disc; }) ||
             std::any_of(way_.begin(), way_.end(), [&](const auto& on) { return on.first == disc && disc != to; });
    };
    for (std::size_t next = 0; next < reached.size() && reached.size() < most_discs; ++next) {
      for (const auto& edge : graph_.of(reached[next].disc)) {
        const bool used =
            std::any_of(way_.begin(), way_.end(), [&](const auto& on) { return on.second == edge.contact; });
        if (broken_[edge.contact] != 0 || used || taken(edge.other)) continue;
        reached.push_back({edge.other, static_cast<std::int32_t>(next), edge.contact});
        if (edge.other != to) continue;
        for (std::int32_t k = static_cast<std::int32_t>(reached.size()) - 1; reached[k].before >= 0;
             k = reached[k].before)
          way_.emplace_back(reached[k].disc, reached[k].contact);
        return true;
      }
    }
    return false;
  }

  /// The largest force of a contact under the first right-hand side, N/m.
  [[nodiscard]] double largest_force() const {
    double largest = 0;
    for (const ContactForce& f : states_[0].forces)
      largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
    return largest;
  }

  /// The network without discs that can carry no force any more.
  std::vector<std::int32_t> leave() {
    const Assembly& whole = network_.assembly;
    Assembly rest;
    rest.centres = whole.centres;
    rest.radii = whole.radii;
    rest.period = whole.period;
    rest.sections = whole.sections;
    std::vector<SpringConstants> springs;
    for (std::size_t c = 0; c < whole.contacts.size(); ++c) {
      if (broken_[c] != 0) continue;
      rest.contacts.push_back(whole.contacts[c]);
      if (!whole.contact_arms.empty()) rest.contact_arms.push_back(whole.contact_arms[c]);
      springs.push_back(network_.springs[c]);
    }
    const LoadBearingNetwork found =
        load_bearing_network(rest, ContactSprings(std::move(springs)), network_.effects, held_);
    if (!found.part && found.removed() == 0) return {};
    std::vector<std::uint8_t> left(whole.size(), 1);
    if (found.part) {
      for (const std::int32_t disc : found.part->discs) left[static_cast<std::size_t>(disc)] = 0;
    }
    std::vector<std::int32_t> gone;
    for (std::size_t d = 0; d < left.size(); ++d) {
      if (left[d] != 0 && left_[d] == 0) gone.push_back(static_cast<std::int32_t>(d));
    }
    left_ = std::move(left);
    return gone;
  }

  void take() {
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    for (std::size_t p = 0; p < states_.size(); ++p) {
      State& state = states_[p];
      state.forces = equilibrium_.forces(p);
      state.motion = equilibrium_.motion(p).high;
      state.reactions.assign(state.motion.size(), 0.0);
      if (!state.carried) {
        std::fill(state.forces.begin(), state.forces.end(), ContactForce{});
        std::fill(state.motion.begin(), state.motion.end(), 0.0);
        continue;
      }
      for (std::size_t c = 0; c < state.forces.size(); ++c) {
        const Contact& contact = network_.assembly.contacts[c];
        if (left_[contact.i] != 0 || left_[contact.j] != 0) state.forces[c] = {};
      }
      for (std::size_t k = 0; k < state.motion.size(); ++k) {
        if (left_[k / b] != 0) state.motion[k] = 0;
      }
      internal_force(network_.assembly, graph_, unknowns_, state.forces, state.reactions);
      const std::vector<double>& load = network_.cases[p].force;
      for (std::size_t k = 0; k < state.reactions.size(); ++k) {
        if (unknowns_.held[k] == DegreesOfFreedom::free) {
          state.reactions[k] = 0;
        } else if (!load.empty()) {
          state.reactions[k] -= load[k];
        }
      }
    }
  }

  BreakableNetwork network_;
  std::vector<std::size_t> held_free_;
  DegreesOfFreedom unknowns_;
  ContactGraph graph_;
  std::vector<std::uint8_t> held_, broken_;
  UpdatedEquilibrium equilibrium_;
  std::vector<std::pair<std::int32_t, std::int32_t>> way_;  // discs with the contacts by which they were reached
  double first_force_ = 0;
};

}  // namespace

std::unique_ptr<BreakableSystem> make_breakable_system(BreakableNetwork network) {
  const SolverOptions& solver = network.solver;
  const bool asked_for = (solver.method == SolverMethod::automatic || solver.method == SolverMethod::multifrontal) &&
                         solver.precision != FactorPrecision::single_precision;
  if (!asked_for || network.springs.any_negative() || network.cases.size() > 2)
    return make_refactorized_system(std::move(network));
  std::vector<std::uint8_t> held = held_or_loaded(network);
  const LoadBearingNetwork found = load_bearing_network(network.assembly, network.springs, network.effects, held);
  if (found.part || found.removed() > 0) return make_refactorized_system(std::move(network));
  try {
    return std::make_unique<UpdatedSystem>(network, std::move(held));
  } catch (const Error& error) {  // a mechanism that discs take part in which carry load, or that a load moves
    if (error.kind() != ErrorKind::computation_failed) throw;
  }
  return make_refactorized_system(std::move(network));
}

}  // namespace equidem
