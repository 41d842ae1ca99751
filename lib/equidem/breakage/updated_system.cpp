// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "equidem/breakage/disjoint_ways.hpp"
#include "equidem/breakage/network_response.hpp"
#include "equidem/breakage/solved_states.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/breaking/updated_network.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"

namespace equidem {
namespace {

/// \param held_free components that are held because nothing else holds their part
DegreesOfFreedom unknowns_of(const BreakableNetwork& network, std::vector<std::size_t>& held_free) {
  DegreesOfFreedom unknowns = number_unknowns(network.assembly, network.springs, network.effects, network.supports);
  held_free = hold_free_motions(network.assembly, ContactGraph(network.assembly), network.springs, unknowns).components;
  return unknowns;
}

/// Share of lambda, which is to have nine digits: an estimate needs one more.
constexpr double allowed_error = 1e-10;

class UpdatedSystem final : public SolvedStates {
 public:
  UpdatedSystem(BreakableNetwork network, std::vector<std::uint8_t> held)
      : SolvedStates(network.cases.size(), network.assembly.size()),
        network_(std::move(network)),
        unknowns_(unknowns_of(network_, held_free_)),
        graph_(network_.assembly),
        held_(std::move(held)),
        broken_(network_.assembly.contacts.size(), 0),
        ways_(network_.assembly, graph_, network_.springs, broken_, left_),
        equilibrium_(
            network_.assembly, network_.springs, unknowns_, network_.cases,
            {.memory_limit = network_.solver.memory_limit, .force_moments = area_of_stress(network_.assembly) > 0}) {
    check_held_free();
    for (const RightHandSide& given : network_.cases) energies_.push_back({.of_driving = energy_of_driving(given)});
    moved_ = std::ranges::all_of(network_.cases[0].force, [](double f) { return f == 0; });
    sum_up();
    for (Energies& energies : energies_) energies.first = energies.now;
    measured(equilibrium_.residual());
  }

  /// One after another, as where a computation is resumed.
  std::vector<std::int32_t> remove(std::span<const std::size_t> contacts) override {
    std::vector<std::int32_t> gone;
    for (; !contacts.empty(); contacts = contacts.subspan(1)) {
      if (!alone_ && !states_[0].carried) solve_alone();
      const std::vector<std::int32_t> loosened = alone_ ? alone_->remove(contacts) : remove(contacts.front());
      gone.insert(gone.end(), loosened.begin(), loosened.end());
      if (!alone_) continue;
      copy_alone();
      break;
    }
    std::ranges::sort(gone);
    return gone;
  }

  [[nodiscard]] std::optional<NextBreak> next_break(const ContactStrengths& strengths,
                                                    const LoadFactorSearch& search) override {
    if (!alone_ && !states_[0].carried) solve_alone();
    std::optional<NextBreak> found = SolvedStates::next_break(strengths, search);
    if (alone_) return found;
    const bool again = found && lambda_error(*found, strengths.friction) > allowed_error;
    if (again) refine();
    static_cast<void>(judge_residual());
    if (!states_[0].carried) return {};
    return again || alone_ ? SolvedStates::next_break(strengths, search) : found;
  }
  [[nodiscard]] const EquilibriumSums* sums() const override {
    return alone_ || !states_[0].carried ? nullptr : &sums_;
  }

  [[nodiscard]] std::span<const ContactForce> forces(std::size_t k) const override {
    if (!alone_ && states_[k].carried) return equilibrium_.forces(k);
    take();
    return SolvedStates::forces(k);
  }
  [[nodiscard]] std::span<const double> motion(std::size_t k) const override {
    take();
    return SolvedStates::motion(k);
  }
  [[nodiscard]] std::span<const double> reactions(std::size_t k) const override {
    take();
    return SolvedStates::reactions(k);
  }

  [[nodiscard]] std::int64_t unstable_modes() const override { return alone_ ? alone_->unstable_modes() : 0; }
  [[nodiscard]] BreakableCounters counters() const override {
    const UpdateCounters& c = equilibrium_.counters();
    const std::int64_t more = alone_ ? alone_->counters().factorizations : 0;
    return {c.factorizations + more, c.updates, c.mended + more, c.refinements, largest_residual()};
  }
  [[nodiscard]] std::string solver_name() const override {
    const std::string updated = "multifrontal Cholesky, updated";
    return alone_ ? fmt::format("{}; from where it did not serve: {}", updated, alone_->solver_name()) : updated;
  }

 private:
  std::vector<std::int32_t> remove(std::size_t contact) {
    broken_[contact] = 1;
    taken_ = false;
    bool loose = !ways_.around(contact) || found_late_;
    found_late_ = false;
    for (const HeldMechanism& mechanism : equilibrium_.remove(contact)) {
      loose = true;
      judge(mechanism);
    }
    if (driven_ >= 0) return give_up(loose);
    std::vector<std::int32_t> gone;
    if (loose) gone = leave();
    sum_up();
    if (digits_lost()) refine();
    const std::vector<std::int32_t> others = judge_residual();
    gone.insert(gone.end(), others.begin(), others.end());
    return gone;
  }

  void refine() {
    for (const HeldMechanism& mechanism : equilibrium_.refine()) {
      found_late_ = true;
      judge(mechanism);
    }
    taken_ = false;
    sum_up();
  }

  /// A residual moves a soft network further than a stiff one. Where motions drive, forces and energies fall as well,
  /// while residuals are relative to those of the unbroken network: products of two forces lose twice as many digits.
  [[nodiscard]] bool digits_lost() const {
    constexpr double allowed = 1e-12, very_soft = 100;
    const double share = energies_[0].now / energies_[0].first, softer = moved_ ? 1 / share : share;
    if (moved_) return !(softer < very_soft && softer * softer * equilibrium_.residual() < allowed);
    return softer * equilibrium_.residual() > allowed;
  }

  /// The share of lambda by which that of the critical contact may be wrong. A residual r leaves the motion K^-1 r of
  /// the energy r.K^-1 r/2, and no contact takes more than the whole of it. r is rho |f|, and taken as no more aligned
  /// with what is soft than the forces f that drive the motion are: r.K^-1 r <= rho² f.K^-1 f. This is an estimate;
  /// rounding, which has no direction, is less aligned. f.K^-1 f is twice the energy where loads act. Prescribed
  /// motions and mean strains drive the free components by forces whose f.K^-1 f is at most twice the sum of the energy
  /// that the rest at its first place would take and that which is left. With E that energy, the criterion g.F = N, or
  /// sign(T) T + mu N, is then wrong by rho sqrt(E) sqrt(2 (kN gN² + kT gT²)) at most, and lambda by that over its
  /// rate.
  [[nodiscard]] double lambda_error(const NextBreak& found, double friction) const {
    const double lambda = found.lambda;
    const ContactForce live = forces(0)[found.contact];
    const ContactForce dead = states_.size() > 1 ? forces(1)[found.contact] : ContactForce{};
    const bool sheared = found.mode == BreakMode::shear;
    const double sign = dead.tangential + lambda * live.tangential < 0 ? -1 : 1;
    const double normal = sheared ? friction : 1, tangential = sheared ? sign : 0;
    const SpringConstants k = network_.springs[found.contact];
    double driving = std::abs(lambda) * std::sqrt(energies_[0].now + energies_[0].of_driving);
    if (energies_.size() > 1) driving += std::sqrt(energies_[1].now + energies_[1].of_driving);
    const double wrong =
        equilibrium_.residual() * driving * std::sqrt(2 * (k.kN * normal * normal + k.kT * tangential * tangential));
    const double grows = std::abs(lambda * (normal * live.normal + tangential * live.tangential));
    return wrong > 0 ? wrong / grows : 0;
  }

  /// Loads that move a part which nothing holds show as forces of the components that are held in place of it.
  void check_held_free() const {
    take();
    constexpr double in_balance = 1e-8;  // over the largest force: what rounding leaves where loads balance
    for (std::size_t p = 0; p < states_.size(); ++p) {
      double largest = largest_force(forces(p));
      for (const double f : network_.cases[p].force) largest = std::max(largest, std::abs(f));
      for (const std::size_t k : held_free_) {
        if (std::abs(states_[p].reactions[k]) <= in_balance * largest) continue;
        computation_failed("a load moves a part that nothing holds", "the updated factor holds it", "Factorize anew");
      }
    }
  }

  /// Refinement with a new factor may not serve where hardly anything is left, and round-off of many changes may look
  /// like a mechanism that a load drives. \return discs that leave the network
  std::vector<std::int32_t> judge_residual() {
    if (driven_ >= 0 || !(equilibrium_.residual() <= UpdatedNetworkOptions{}.claimed_residual)) return give_up(false);
    measured(equilibrium_.residual());
    return {};
  }
  /// Where a mechanism is driven for certain, nothing is left to solve for.
  /// \param loose discs may have come loose
  std::vector<std::int32_t> give_up(bool loose) {
    std::vector<DiscMotion> motion = equilibrium_.driven_mechanism(driven_);
    if (motion.empty()) return solve_alone();
    taken_ = false;
    for (State& state : states_) state.carried = false;
    why_not_ = describe_driven(network_, load_bearing_rest(network_, broken_, held_), std::move(motion));
    measured(0);
    return loose ? leave() : std::vector<std::int32_t>{};
  }
  /// From here on every network is solved alone, with the refusals of its solver.
  std::vector<std::int32_t> solve_alone() {
    std::vector<std::size_t> contacts;
    for (std::size_t c = 0; c < broken_.size(); ++c) {
      if (broken_[c] != 0) contacts.push_back(c);
    }
    alone_ = make_refactorized_rest(network_, contacts);
    const std::vector<std::uint8_t> before = left_;
    copy_alone();
    std::vector<std::int32_t> gone;
    for (std::size_t d = 0; d < left_.size(); ++d) {
      if (left_[d] != 0 && before[d] == 0) gone.push_back(static_cast<std::int32_t>(d));
    }
    return gone;
  }
  void copy_alone() {
    const auto copied = [](auto& to, const auto& from) { to.assign(from.begin(), from.end()); };
    for (std::size_t p = 0; p < states_.size(); ++p) {
      copied(states_[p].forces, alone_->forces(p));
      copied(states_[p].motion, alone_->motion(p));
      copied(states_[p].reactions, alone_->reactions(p));
      states_[p].carried = alone_->carries(p);
    }
    taken_ = true;
    why_not_ = alone_->why_not();
    copied(left_, alone_->left());
    measured(alone_->relative_residual());
  }

  /// A support that a mechanism was given takes no force unless a load works on the mechanism.
  void judge(const HeldMechanism& mechanism) {
    if (std::ranges::any_of(mechanism.driven, [](std::uint8_t driven) { return driven != 0; }))
      driven_ = mechanism.component;
  }

  /// The elastic energy under each right-hand side, from the sums.
  void sum_up() {
    sums_ = equilibrium_.sums();
    energies_[0].now = 0.5 * (sums_.load_work[0][0] + sums_.imposed[0]);
    if (energies_.size() > 1) energies_[1].now = 0.5 * sums_.load_work[1][1];
  }

  /// The energy of the contacts where prescribed motions and a mean strain act and no free disc moves, N.
  [[nodiscard]] double energy_of_driving(const RightHandSide& given) const {
    if (given.prescribed.empty() && !given.gradient) return 0;
    PreciseMotion motion(unknowns_.held.size());
    for (std::size_t k = 0; k < given.prescribed.size(); ++k) {
      if (unknowns_.held[k] != DegreesOfFreedom::free) motion.high[k] = given.prescribed[k];
    }
    const SpringNetwork network{network_.assembly, graph_, network_.springs, unknowns_};
    return contact_sums<1>(network_.assembly.contacts.size(), [&](std::size_t c, std::array<double, 1>& sum) {
      sum[0] += linear_spring_energy_of(
          network_.springs[c],
          linear_spring_force(network_.springs[c], deformation_of(network, motion, given.gradient, c)));
    })[0];
  }

  /// The network without discs that can carry no force any more.
  std::vector<std::int32_t> leave() {
    std::vector<std::uint8_t> left = discs_outside(load_bearing_rest(network_, broken_, held_), left_.size());
    std::vector<std::int32_t> gone;
    for (std::size_t d = 0; d < left.size(); ++d) {
      if (left[d] != 0 && left_[d] == 0) gone.push_back(static_cast<std::int32_t>(d));
    }
    left_ = std::move(left);
    std::vector<std::size_t> idle;
    for (const std::int32_t disc : gone) {
      for (const auto& edge : graph_.of(disc)) idle.push_back(static_cast<std::size_t>(edge.contact));
    }
    equilibrium_.spare(idle);
    return gone;
  }

  void take() const {
    if (taken_) return;
    taken_ = true;
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    for (std::size_t p = 0; p < states_.size(); ++p) {
      State& state = states_[p];
      state.reactions.assign(unknowns_.held.size(), 0.0);
      if (!state.carried) {
        state.forces.assign(network_.assembly.contacts.size(), {});
        state.motion = state.reactions;
        continue;
      }
      state.motion = equilibrium_.motion(p).high;
      for (std::size_t k = 0; k < state.motion.size(); ++k) {
        if (left_[k / b] != 0) state.motion[k] = 0;
      }
      internal_force(network_.assembly, graph_, unknowns_, equilibrium_.forces(p), state.reactions);
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
  DisjointWays ways_;
  bool moved_ = false;  // the first right-hand side, by imposed motions or a mean strain alone
  UpdatedNetwork equilibrium_;
  EquilibriumSums sums_;
  mutable bool taken_ = false;                // whether states_ are those of the network as it is
  std::unique_ptr<BreakableSystem> alone_{};  // that solves every network alone, where the factor does not serve
  bool found_late_ = false;                   // mechanisms by the last search
  std::int64_t driven_ = -1;                  // component held in place of a mechanism on which a load seems to work
  struct Energies {
    double now = 0, first = 0;
    double of_driving = 0;  // energy_of_driving
  };
  std::vector<Energies> energies_;  // N, per right-hand side
};

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

std::unique_ptr<BreakableSystem> make_breakable_system(BreakableNetwork network) {
  const SolverOptions solver = factor_to_update(network.solver);
  const bool asked_for = solver.method == SolverMethod::multifrontal;
  if (!asked_for || network.springs.any_negative() || network.cases.size() > 2)
    return make_refactorized_system(std::move(network));
  std::vector<std::uint8_t> held = held_or_loaded(network);
  const LoadBearingNetwork found = load_bearing_network(network.assembly, network.springs, network.effects, held);
  if (found.part || found.removed() > 0) return make_refactorized_system(std::move(network));
  // Where springs are further apart, residuals that are refined to round-off of the loads leave the forces of the soft
  // ones uncertain.
  constexpr double most_apart = 1e6;
  double softest = std::numeric_limits<double>::infinity(), stiffest = 0;
  for (std::size_t c = 0; c < network.assembly.contacts.size(); ++c) {
    for (const double k : {network.springs[c].kN, network.springs[c].kT}) {
      if (k > 0) softest = std::min(softest, k);
      stiffest = std::max(stiffest, k);
    }
  }
  if (stiffest > most_apart * softest || !squares_fit(network, stiffest))
    return make_refactorized_system(std::move(network));
  try {
    return std::make_unique<UpdatedSystem>(network, std::move(held));
  } catch (const Error& error) {  // a mechanism that discs take part in which carry load, or that a load moves
    if (error.kind() != ErrorKind::computation_failed) throw;
  }
  return make_refactorized_system(std::move(network));
}

}  // namespace equidem
