// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/updated_equilibrium.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/kernels/panel_change.hpp"
#include "equidem/statics/breaking/updated_state.hpp"

namespace equidem {

struct UpdatedEquilibrium::Implementation {
  UpdatedState state;
  int unwatched = 0;  // changes since the residual was looked at
  int altered = 0;    // contacts since the factor was made
  int interval = 4;   // changes after which it is looked at again
  bool carried = true;
  bool lost_digits = true;   // since the last refinement: nothing is claimed before another one
  double measured = 0;       // relative residual after the last refinement
  double reacted = 0;        // the largest reaction since then of what holds a mechanism, over the load
  double contraction = 1;    // of residual and energy, by the last correction behind which they were evaluated
  double seen_softness = 0;  // relative error in energy of that correction over the residual
  int unseen = 0;            // corrections since then
  double caution = 1;        // factor on what rounding is taken to leave, from residuals that were found
  std::optional<OpenedContact> opened{};
  std::optional<EquilibriumSums> sums{};

  [[nodiscard]] double claimed() const {
    constexpr double of_measuring = 4 * std::numeric_limits<double>::epsilon();
    return measured * state.grown() + of_measuring + reacted + caution * state.rounding();
  }
  std::vector<HeldMechanism> change(std::size_t contact, SpringConstants springs);
  /// \param least_steps done however small the residual is
  /// \param found gets the mechanisms that a new factorization came across
  /// The residual found is held against that claimed, but where digits were lost.
  double refine(int least_steps, std::vector<HeldMechanism>* found = nullptr);
};

namespace {

constexpr double left_of_reactions = 1e-8;  // over the size of the load: what round-off leaves of a reaction

/// Derivatives of stretch and slip by the motions of two discs, 0 for components that are held.
struct MaskedGradient {
  RankOneChange normal, tangential;
};

MaskedGradient masked_gradient(const SpringNetwork& network, std::size_t number) {
  const auto b = static_cast<std::size_t>(network.unknowns.per_disc);
  const Contact& contact = network.assembly.contacts[number];
  const DeformationGradient g =
      deformation_gradient(frame_of(network.assembly, number), network.unknowns.rotation_scale);
  const auto masked = [&](std::int32_t disc, std::array<double, 3> x) {
    for (std::size_t r = 0; r < 3; ++r) {
      if (r >= b || network.unknowns.held[disc * b + r] != 0) x[r] = 0;
    }
    return x;
  };
  return {{0, contact.i, contact.j, masked(contact.i, g.normal_i), masked(contact.j, g.normal_j)},
          {0, contact.i, contact.j, masked(contact.i, g.tangential_i), masked(contact.j, g.tangential_j)}};
}

void check_network(const ContactSprings& springs, std::size_t contacts, std::size_t cases, std::size_t strengths) {
  if (springs.any_negative()) {
    bad_input("a contact has a negative tangential spring",
              "the factor that is updated is that of a positive definite matrix",
              "Factorize anew after each removal, or take kT >= 0");
  }
  if (cases < 1 || cases > most_right_sides) {
    bad_input(fmt::format("there are {} right-hand sides", cases), "one grows with the load factor, one may be dead",
              "Give one or two");
  }
  if (strengths != contacts) {
    bad_input(fmt::format("there are {} strengths for {} contacts", strengths, contacts), "",
              "Give one for each contact");
  }
}

}  // namespace

std::vector<HeldMechanism> UpdatedEquilibrium::Implementation::change(std::size_t number, SpringConstants springs) {
  const SpringConstants before = state.springs[number], most = state.first_springs[number];
  if (!(springs.kN >= 0 && springs.kT >= 0 && springs.kN <= most.kN && springs.kT <= most.kT)) {
    bad_input(fmt::format("the springs of contact {} are to be {} and {} Pa", number, springs.kN, springs.kT),
              "bounds on motions hold for springs that are at most as stiff as at first, and not negative",
              "Weaken springs, or begin with the stiff ones");
  }
  const bool grows = springs.kN > before.kN || springs.kT > before.kT;
  if (grows) refine(0);
  const std::vector<std::int32_t> path_blocks = state.blocks_above(number);
  for (auto block = path_blocks.rbegin(); block != path_blocks.rend(); ++block) {
    state.bring_up_to_date({&*block, 1}, nullptr);  // by the factor as it is
  }
  std::vector<ContactForce> after;
  std::vector<UpdatedCholesky::Load> loads;
  const MaskedGradient g = masked_gradient(state.network(), number);
  const std::size_t cases = state.cases.size();
  for (std::size_t p = 0; p < cases; ++p) {
    const ContactForce now = state.force_of(number, p);
    ContactForce then{before.kN > 0 ? now.normal * (springs.kN / before.kN) : 0,
                      before.kT > 0 ? now.tangential * (springs.kT / before.kT) : 0};
    if (grows) {
      then = linear_spring_force(springs, state.deformation(number, p));
    }
    after.push_back(then);
    UpdatedCholesky::Load load;
    for (std::size_t r = 0; r < 3; ++r) {
      const double n = now.normal - then.normal, t = now.tangential - then.tangential;
      load.at_i[r] = n * g.normal.at_i[r] + t * g.tangential.at_i[r];
      load.at_j[r] = n * g.normal.at_j[r] + t * g.tangential.at_j[r];
    }
    loads.push_back(load);
  }
  std::vector<RankOneChange> changes;
  const auto add = [&](RankOneChange spring, double stiffness) {
    spring.stiffness = stiffness;
    if (stiffness != 0) changes.push_back(spring);
  };
  add(g.normal, springs.kN - before.kN);
  add(g.tangential, springs.kT - before.kT);
  if (changes.empty()) return {};
  ++state.counters.updates;
  OpenedContact let_go;
  for (std::size_t p = 0; p < cases; ++p) let_go.force[p] = state.force_of(number, p);
  const FactorPath path = state.change_factor(number, springs, changes, loads, let_go.moment);
  state.set_contact(number, springs, after);

  std::vector<HeldMechanism> mechanisms;
  std::vector<double> anchors;
  for (const std::int64_t component : path.held) {
    mechanisms.push_back({component, state.hold(component), std::vector<double>(cases), {}});
    for (std::size_t p = 0; p < cases; ++p) anchors.push_back(state.moved_by(component, p));
  }
  state.follow(path, path_blocks);
  for (std::size_t p = 0; p < cases; ++p) let_go.opening[p] = state.deformation(number, p);
  opened.reset();
  sums.reset();
  for (std::size_t m = 0; m < mechanisms.size(); ++m) {
    for (std::size_t p = 0; p < cases; ++p) {
      double& reaction = mechanisms[m].reaction[p];
      reaction = mechanisms[m].stiffness * (anchors[m * cases + p] - state.moved_by(mechanisms[m].component, p));
      mechanisms[m].driven.push_back(std::abs(reaction) > left_of_reactions * state.scales[p] ? 1 : 0);
      if (mechanisms[m].driven[p] != 0) {
        carried = false;
      } else if (state.scales[p] > 0) {
        reacted = std::max(reacted, std::abs(reaction) / state.scales[p]);
      }
    }
  }
  ++unwatched;
  ++altered;
  constexpr double delicate = 1e-3;  // share of the determinant: digits that are lost
  if (path.share < delicate || path.share > 1 / delicate || !path.held.empty()) {
    lost_digits = true;
    caution = std::max(caution, 1.0);  // residuals found before say nothing about such a factor
  }
  if (carried && (lost_digits || claimed() > state.options.watched_residual || unwatched >= interval)) {
    refine(0, &mechanisms);
  } else if (carried && springs.kN == 0 && springs.kT == 0) {
    opened = let_go;
  }
  if (carried) state.counters.largest_residual = std::max(state.counters.largest_residual, claimed());
  return mechanisms;
}

double UpdatedEquilibrium::Implementation::refine(int least_steps, std::vector<HeldMechanism>* found) {
  const auto& options = state.options;
  state.bring_motions_up_to_date();
  const double expected = claimed(), rounding = state.rounding();
  const double before = state.evaluate();
  ++state.counters.refinements;
  const double found_over_claimed = lost_digits ? 0 : before / expected;
  state.counters.most_over_claimed = std::max(state.counters.most_over_claimed, found_over_claimed);
  // The last correction is left to the next visits of blocks, where what it leaves is known from the one that was
  // evaluated last. Motions are corrected to round-off of the energy: a soft network answers a residual of 1e-13 by
  // forces that are wrong by far more.
  constexpr double small = 1e-17, wrong = 1e-12, grown = 2;
  constexpr int most_steps = 5, most_unseen = 16, many_changes = 16;
  const bool trusted = carried && !lost_digits && found_over_claimed <= 1;
  bool slow = false;  // corrections end before the energy is right: round-off has spoiled the factor for what is soft
  const auto improved = [&](double residual) {
    double error_before = 0;
    int step = 0;
    for (; step < most_steps && (step < least_steps || residual > small); ++step) {
      const double error = state.correct(), last = residual, softness = error / residual;
      // Soft parts contract less than the residual, which is mostly of stiff ones.
      if (step > 0) contraction = std::max(contraction, error / error_before);
      error_before = error;
      const bool as_seen = (trusted || step > 0) && unseen < most_unseen && softness < grown * seen_softness;
      if (as_seen && contraction * error < wrong) {
        ++unseen;
        return contraction * residual;
      }
      state.bring_motions_up_to_date();
      residual = state.evaluate();
      if (step > 0 && !(residual < 0.5 * last)) break;  // round-off of the residual itself: it tells no contraction
      contraction = std::max(residual / last, std::numeric_limits<double>::epsilon());
      seen_softness = softness;
      unseen = 0;
    }
    slow = step == most_steps && contraction * error_before > wrong;
    return residual;
  };
  double after = improved(before);
  if (carried && (after > options.watched_residual || (slow && altered > many_changes))) {
    ++state.counters.mended;
    altered = 0;
    const std::size_t held = state.holds().size();
    if (!state.factorize()) {
      computation_failed("the stiffness matrix could not be factorized anew",
                         "round-off of changes had grown, and the network is singular in more than a few places",
                         "Stop before the network falls apart");
    }
    after = improved(after);
    for (const auto& [component, stiffness] : state.holds().subspan(held)) {
      HeldMechanism mechanism{component, stiffness, {}, {}};
      for (std::size_t p = 0; p < state.cases.size(); ++p) {
        mechanism.reaction.push_back(state.unbalanced(component, p));
        mechanism.driven.push_back(std::abs(mechanism.reaction[p]) > left_of_reactions * state.scales[p] ? 1 : 0);
        if (mechanism.driven[p] != 0) carried = false;
      }
      if (found != nullptr) found->push_back(std::move(mechanism));
    }
  }
  measured = after;
  // Rounding has a bound for all networks (UpdatedState::rounding). A network leaves less: the factor `caution` on the
  // bound is an estimate, learned from the residuals that refinements find, and not below `least`.
  constexpr double margin = 4, least = 0.125, noise = 1e-14;
  if (found_over_claimed > 1) {
    caution *= 2 * found_over_claimed;
  } else if (!lost_digits && rounding > noise) {
    caution = std::clamp(margin * before / rounding, std::max(least, 0.5 * caution), std::max(1.0, caution));
  }
  lost_digits = !carried;
  reacted = 0;
  unwatched = 0;
  if (found_over_claimed > 1) {
    interval = 1;
  } else if (before > options.watched_residual) {
    interval = std::max(interval / 4, 1);
  } else {
    interval = std::min(2 * interval, options.most_changes_unwatched);
  }
  if (carried) {
    sums = state.sums();
    state.follow_bases();
  }
  return before;
}

UpdatedEquilibrium::UpdatedEquilibrium(const Assembly& assembly, const ContactSprings& springs,
                                       DegreesOfFreedom unknowns, std::vector<RightHandSide> cases,
                                       std::vector<ContactStrength> strengths,
                                       const UpdatedEquilibriumOptions& options) {
  check_network(springs, assembly.contacts.size(), cases.size(), strengths.size());
  implementation_ = std::make_unique<Implementation>(
      Implementation{{assembly, springs, std::move(unknowns), std::move(cases), std::move(strengths), options}});
  UpdatedState& state = implementation_->state;
  if (!state.factorize()) {
    computation_failed("the stiffness matrix is not positive definite", "the network has a mechanism",
                       "Hold what moves without energy, or take it out");
  }
  implementation_->refine(2);
  implementation_->interval = 4;
}

UpdatedEquilibrium::~UpdatedEquilibrium() = default;

std::vector<HeldMechanism> UpdatedEquilibrium::remove(std::size_t contact) {
  return implementation_->change(contact, {0, 0});
}

const OpenedContact* UpdatedEquilibrium::opened() const {
  return implementation_->opened ? &*implementation_->opened : nullptr;
}

const EquilibriumSums* UpdatedEquilibrium::sums() const {
  return implementation_->sums ? &*implementation_->sums : nullptr;
}

void UpdatedEquilibrium::spare(std::span<const std::size_t> contacts) {
  for (const std::size_t contact : contacts) implementation_->state.spare(contact);
}

std::vector<HeldMechanism> UpdatedEquilibrium::change(std::size_t contact, SpringConstants springs) {
  return implementation_->change(contact, springs);
}

CriticalContact UpdatedEquilibrium::critical(const LoadFactorSearch& search) {
  Implementation& all = *implementation_;
  const auto sought = [&] {
    CriticalContact found{all.state.critical(search)};
    if (found.contact < 0) return found;
    const auto number = static_cast<std::size_t>(found.contact);
    found.force.live = all.state.force_of(number, 0);
    if (all.state.cases.size() > 1) found.force.dead = all.state.force_of(number, 1);
    return found;
  };
  CriticalContact found = sought();
  if (!all.carried || !(all.claimed() > all.state.options.watched_residual) || all.state.is_refined()) return found;
  std::vector<HeldMechanism> mechanisms;
  all.refine(0, &mechanisms);
  found = all.carried ? sought() : CriticalContact{};
  found.mechanisms = std::move(mechanisms);
  return found;
}

std::vector<double> UpdatedEquilibrium::least_keys(const LoadFactorSearch& search) const {
  return implementation_->state.least_keys(search);
}

std::vector<ContactForce> UpdatedEquilibrium::forces(std::size_t of_case) {
  UpdatedState& state = implementation_->state;
  state.bring_all_up_to_date();
  std::vector<ContactForce> all;
  for (std::size_t c = 0; c < state.assembly.contacts.size(); ++c) all.push_back(state.force_of(c, of_case));
  return all;
}

PreciseMotion UpdatedEquilibrium::motion(std::size_t of_case) {
  return implementation_->state.motion(of_case);
}

double UpdatedEquilibrium::refine() {
  implementation_->opened.reset();
  return implementation_->refine(1);
}

std::vector<DiscMotion> UpdatedEquilibrium::driven_mechanism(std::int64_t component) const {
  return implementation_->state.driven_mechanism(component);
}

double UpdatedEquilibrium::estimated_residual() const {
  return implementation_->claimed();
}

const ContactSprings& UpdatedEquilibrium::springs() const {
  return implementation_->state.springs;
}

const UpdateCounters& UpdatedEquilibrium::counters() const {
  return implementation_->state.counters;
}

double UpdatedEquilibrium::factor_bytes() const {
  return implementation_->state.factor->report().bytes;
}

double UpdatedEquilibrium::bytes() const {
  return implementation_->state.bytes();
}

}  // namespace equidem
