// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/sample_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "equidem/assembly/touching.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_described = 8;

/// Gears, and other zero-energy modes: no contact is deformed by them, so that the forces of any mean strain do no work
/// on them, and moduli exist where every mean strain has energy. At most eight of each kind are described.
/// \param name of the network for messages: "the network", "the cell, cut open at its boundary,"
/// \throws Error (bad_input) as StiffnessSolver::refuse_floppy
std::vector<ZeroEnergyMode> zero_energy_modes(const Assembly& assembly, const StiffnessSolver& solver,
                                              const HeldMotions& held, const std::string& name) {
  std::vector<ZeroEnergyMode> result;
  for (const GearMode& gear : held.gears) {
    if (result.size() == most_described) break;
    result.push_back({"gear", fmt::format("{} around {} counter-rotate like gears: their contacts form no odd ring",
                                          counted(gear.discs, "disc"),
                                          describe_disc(assembly, static_cast<std::size_t>(gear.first_disc)))});
  }
  solver.refuse_floppy(name);
  for (std::int64_t k = 0; k < std::min<std::int64_t>(solver.factor().report().zero_pivots, most_described); ++k) {
    ZeroEnergyMode mode{"mode", solver.describe_mechanism(k)};
    const auto same = [&](const ZeroEnergyMode& other) { return other.description == mode.description; };
    if (std::ranges::none_of(result, same)) result.push_back(std::move(mode));
  }
  return result;
}

}  // namespace

SampleSolver::SampleSolver(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                           const std::vector<std::uint8_t>& held, bool hold_translations, EffectiveStiffness& result)
    : whole_(assembly), whole_springs_(springs), options_(options) {
  prune(held, result);
  factorize(held, hold_translations, result);
}

void SampleSolver::prune(const std::vector<std::uint8_t>& held, EffectiveStiffness& result) {
  Stopwatch watch;
  network_ = load_bearing_network(whole_, whole_springs_, result.effects, held);
  result.rattlers = network_.rattlers;
  result.discs_removed = network_.removed();
  result.removed = network_.sentences;
  result.times.add("network", watch.lap());
  if (options_.boundary == Boundary::traction || (network_.spanned == 2 && network_.pieces > 0)) return;
  const std::string removed = joined(network_.sentences, "; ");
  bad_input(
      network_.spanned == 0 || network_.pieces == 0 ? "no piece of the network spans the cell"
                                                    : "the network spans the cell in one direction only",
      removed.empty() ? "some mean strain costs it no energy" : removed,
      fmt::format("It has no modulus. Add contacts{}, or pack the discs more densely", by_larger_tolerance(whole_)));
}

void SampleSolver::factorize(const std::vector<std::uint8_t>& held, bool hold_translations,
                             EffectiveStiffness& result) {
  Stopwatch watch;
  ContactGraph graph(assembly());
  DegreesOfFreedom unknowns = number_unknowns(assembly(), springs(), result.effects, {});
  for (std::size_t d = 0; hold_translations && d < assembly().size(); ++d) {
    if (held[network_.part ? network_.part->discs[d] : d] == 0) continue;
    for (int k = 0; k < 2; ++k) unknowns.held[d * unknowns.per_disc + k] = DegreesOfFreedom::supported;
    unknowns.unknowns -= 2;
  }
  const std::int64_t free_unknowns = unknowns.unknowns;
  held_motions_ = hold_free_motions(assembly(), graph, springs(), unknowns);
  result.times.add("network", watch.lap());
  SolverOptions solver = options_.solver;
  solver.right_hand_sides = 3;  // mean strains
  solver_.emplace(assembly(), springs(), std::move(graph), std::move(unknowns), solver, Mechanisms::hold, result.times);
  result.motions = zero_energy_modes(assembly(), *solver_, held_motions_,
                                     options_.boundary == Boundary::traction && !whole_.groups.contains("left")
                                         ? "the cell, cut open at its boundary,"
                                         : "the network");
  result.gear_modes = static_cast<std::int64_t>(held_motions_.gears.size());
  static_cast<SolverFindings&>(result) = solver_->findings();
  result.self_stresses =
      count_self_stresses(assembly(), springs(), result.effects, free_unknowns,
                          static_cast<std::int64_t>(held_motions_.components.size()) + result.mechanisms);
}

std::vector<std::int32_t> SampleSolver::indices() const {
  std::vector<std::int32_t> index(whole_.size(), -1);
  for (std::size_t d = 0; d < assembly().size(); ++d) {
    index[network_.part ? network_.part->discs[d] : d] = static_cast<std::int32_t>(d);
  }
  return index;
}

std::vector<DiscMotion> SampleSolver::motions_of_whole(const PreciseMotion& motion) const {
  std::vector<DiscMotion> motions = disc_motions(unknowns(), motion.high);
  if (!network_.part) return motions;
  std::vector<DiscMotion> all(whole_.size());
  for (std::size_t d = 0; d < motions.size(); ++d) all[network_.part->discs[d]] = motions[d];
  return all;
}

void SampleSolver::report_unbalanced_disc(std::size_t disc) const {
  bad_input(fmt::format("the boundary tears {} off", describe_disc(assembly(), disc)),
            "its piece of the network cannot balance the tractions of a uniform stress",
            "Use boundary = \"periodic\" or \"displacement\", or a larger sample");
}

std::vector<Solution> SampleSolver::solve(std::span<const RightHandSide> cases, EffectiveStiffness& result) {
  if (options_.boundary == Boundary::traction) {
    for (const RightHandSide& given : cases) {
      const auto driven = solver_->driven_mechanism(given.force);
      if (!driven) continue;
      const auto most = std::ranges::max_element(*driven, {}, [](double x) { return std::abs(x); });
      report_unbalanced_disc(static_cast<std::size_t>(most - driven->begin()) / unknowns().per_disc);
    }
  }
  std::vector<Solution> solutions = solver_->solve(cases, result.times);
  Stopwatch watch;
  // Without negative springs a motion without energy deforms no contact: mean strains do no work on it.
  const bool may_react = options_.boundary == Boundary::traction || springs().may_be_indefinite();
  for (std::size_t k = 0; may_react && k < cases.size(); ++k) check_reactions(cases[k], solutions[k]);
  const bool estimated = solver_->iterative();
  if (!estimated) result.condition = solver_->scaled_inverse_norm(solutions[0].motion.high);
  for (const Solution& solution : solutions) {
    result.relative_residual = std::max(result.relative_residual, solution.relative_residual());
    energy_error_ = std::max(energy_error_, solution.energy_error);
  }
  if (!estimated) {
    constexpr double safety = 10;  // the norm of the inverse is estimated from below
    const double residual = solver_->scaled_residual_bound(cases, solutions);
    energy_error_ = safety * residual * residual * result.condition;
  }
  static_cast<SolverFindings&>(result) = solver_->findings();
  result.times.add("error bound", watch.lap());
  return solutions;
}

void SampleSolver::check_reactions(const RightHandSide& given, const Solution& solution) const {
  if (held_motions_.components.empty()) return;
  double size = 0;
  for (std::size_t c = 0; c < assembly().contacts.size(); ++c) {
    const ContactForce force =
        linear_spring_force(springs()[c], solver_->contact_motion(given, solution.motion, c).deformation);
    size = std::max({size, std::abs(force.normal), std::abs(force.tangential)});
  }
  std::vector<double> internal(unknowns().held.size());
  internal_force({assembly(), solver_->graph(), springs(), unknowns()}, solution.motion, given.gradient, internal);
  for (const std::size_t k : held_motions_.components) {
    const double load = given.force.empty() ? 0.0 : given.force[k];
    if (std::abs(internal[k] - load) <= negligible_reaction * std::max(size, std::abs(load))) continue;
    if (options_.boundary == Boundary::traction) report_unbalanced_disc(k / unknowns().per_disc);
    computation_failed("a motion that nothing resists is driven by the mean strain",
                       "at this kT/kN the cell is at its limit of stability",
                       "Choose another kT/kN; 'equidem stability' finds the limit");
  }
}

void add_pair_energies(const SpringConstants& k, const ContactDeformation* d, double* sums) {
  add_triangle(sums, [&](std::size_t a, std::size_t b) { return k.kN * d[a].normal * d[b].normal; });
  add_triangle(sums + pair_sums / 2,
               [&](std::size_t a, std::size_t b) { return k.kT * d[a].tangential * d[b].tangential; });
}

PairEnergies pair_energies(const double* sums) {
  return {symmetric(sums), symmetric(sums + pair_sums / 2)};
}

Matrix3 bending_energies(const SampleSolver& solver, const std::vector<RightHandSide>& cases,
                         const std::vector<Solution>& solutions) {
  const auto sums = contact_sums<6>(solver.assembly().contacts.size(), [&](std::size_t c, auto& total) {
    double turns[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const ContactMotion motion = solver.solver().contact_motion(cases[k], solutions[k].motion, c);
      turns[k] = motion.theta_j - motion.theta_i;
    }
    add_triangle(total.data(),
                 [&](std::size_t a, std::size_t b) { return solver.springs().bending(c) * turns[a] * turns[b]; });
  });
  return symmetric(sums.data());
}

LinearSystem strain_system(const Assembly& assembly, const ContactSprings& springs, Rotation rotation) {
  check(assembly);
  if (!assembly.periodic())
    bad_input("the assembly is not periodic", "a mean strain moves the images of a periodic cell",
              "Take a periodic assembly, or give supports and loads");
  const Effects effects = derive_effects(assembly, springs, rotation);
  const LoadBearingNetwork bearing = load_bearing_network(assembly, springs, effects);
  if (bearing.pieces == 0)
    bad_input("no piece of the network spans the cell", "nothing resists a mean strain", "Add contacts");
  const Assembly& network = bearing.part ? bearing.part->assembly : assembly;
  const ContactSprings& its_springs = bearing.part ? bearing.part->springs : springs;
  const ContactGraph graph(network);
  DegreesOfFreedom unknowns = number_unknowns(network, its_springs, effects, {});
  hold_free_motions(network, graph, its_springs, unknowns);
  std::vector<RightHandSide> cases(effects.restrained ? 4 : 3);
  for (std::size_t k = 0; k < cases.size(); ++k) cases[k].gradient = unit_gradients[k];
  LinearSystem system = linear_system({network, graph, its_springs, unknowns}, cases);
  if (bearing.part) system.discs = bearing.part->discs;
  system.names = {"strain xx", "strain yy", "strain xy", "rotation"};
  system.names.resize(cases.size());
  return system;
}

}  // namespace equidem
