// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/equilibrium.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/rigidity.hpp"
#include "equidem/statics/solver_choice.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {
namespace {

/// Whether sums of squares and products stay far within a double, and within a float for the grids of multigrid.
bool in_range(double size) {
  return size > 1e-30 && size < 1e30;
}

}  // namespace

struct EquilibriumSolver::Implementation {
  const Assembly& assembly;
  const ContactSprings& springs;
  double unit;  ///< Pa, of the springs of the solver, so that no sum of squares leaves the range of a double
  std::optional<ContactSprings> scaled;  ///< springs over the unit, where that is not 1
  EquilibriumOptions options;
  Effects effects;
  StageTimes times;
  StiffnessSolver solver;

  Implementation(const Assembly& assembly_in, const ContactSprings& springs_in, std::span<const Support> supports,
                 const EquilibriumOptions& options_in)
      : assembly(assembly_in),
        springs(springs_in),
        unit(in_range(springs_in.largest()) ? 1 : spring_unit(springs_in)),
        scaled(unit == 1 ? std::nullopt : std::optional(scaled_springs(springs_in, 1 / unit))),
        options(options_in),
        effects(derive_effects(assembly_in, springs_in, options_in.rotation)),
        solver(build(supports)) {}

  StiffnessSolver build(std::span<const Support> supports);
  /// \param force per component, N/m \param prescribed per component, m
  [[nodiscard]] Equilibrium solve(std::vector<double> force, std::vector<double> prescribed);
  void check_mechanisms(const RightHandSide& given, Equilibrium& result) const;
  void bound_error(const RightHandSide& given, const Solution& solution, Equilibrium& result);
  void describe_state(std::span<const double> f, const PreciseMotion& motion, Equilibrium& result) const;
};

StiffnessSolver EquilibriumSolver::Implementation::build(std::span<const Support> supports) {
  Stopwatch watch;
  ContactGraph graph(assembly);
  DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, supports);
  check_rigidity(assembly, graph, springs, unknowns, options.mechanisms);
  if (assembly.size() == 1 && assembly.contacts.empty()) {
    bad_input("the assembly is a single disc", "it touches nothing, so there is no equilibrium to find",
              "Add discs that touch it");
  }
  times.add("check", watch.lap());
  stop_if_interrupted();
  return {
      assembly, scaled ? *scaled : springs, std::move(graph), std::move(unknowns), options.solver, options.mechanisms,
      times};
}

Equilibrium EquilibriumSolver::Implementation::solve(std::vector<double> force, std::vector<double> prescribed) {
  Equilibrium result;
  result.times = times;
  const DegreesOfFreedom& unknowns = solver.unknowns();
  RightHandSide given;
  given.force = std::move(force);
  check_inert_loads(assembly, unknowns, given.force);
  check_mechanisms(given, result);
  const auto moves = [](double u) { return u != 0; };
  if (std::any_of(prescribed.begin(), prescribed.end(), moves)) given.prescribed = std::move(prescribed);
  // Power of two: nothing is rounded.
  double size = 0;
  for (const std::vector<double>* all : {&given.force, &given.prescribed}) {
    const double per = all == &given.force ? unit : 1;
    for (const double value : *all) size = std::max(size, std::abs(value) / per);
  }
  if (size > 0 && size < 0x1p-960)  // smaller motions have fewer digits
    bad_input("the numbers of this case underflow a double", fmt::format("motions are of the order of {:.0e}", size),
              "Check the units of sizes, springs and loads");
  const double amount = size == 0 || in_range(size) ? 1 : std::exp2(std::ilogb(size));
  const std::vector<double> loads = given.force;
  for (double& value : given.force) value = value / unit / amount;
  for (double& value : given.prescribed) value /= amount;
  const std::int64_t iterations_before = solver.factor().report().iterations;
  Solution solution = std::move(solver.solve({&given, 1}, result.times).front());
  Stopwatch watch;
  result.relative_residual = solution.relative_residual();
  result.refinements = solution.refinements;
  if (solution.scale > 0) result.rounded_residual = solver.rounded_residual(given, solution.motion) / solution.scale;
  result.times.add("refine", watch.lap());
  if (options.solver.accuracy > 0 && solution.energy_error > 0) {
    result.error_bound = std::sqrt(solution.energy_error / solver.twice_energy(solution.motion.high));
  } else if (options.error_bound) {
    bound_error(given, solution, result);
    result.times.add("error bound", watch.lap());
  }
  for (std::vector<double>* part : {&solution.motion.high, &solution.motion.low}) {
    for (double& value : *part) value *= amount;
  }
  result.contact_forces.resize(assembly.contacts.size());
  contact_forces_of(assembly, springs, unknowns, solution.motion, result.contact_forces);
  describe_state(loads, solution.motion, result);
  if (!std::isfinite(result.energy)) {
    bad_input("the numbers of this case overflow a double", "the elastic energy comes out as no finite number",
              "Check the units of sizes, springs and loads");
  }
  static_cast<SolverFindings&>(result) = solver.findings();
  result.iterations -= iterations_before;
  return result;
}

void EquilibriumSolver::Implementation::check_mechanisms(const RightHandSide& given, Equilibrium& result) const {
  solver.refuse_floppy("the assembly");
  if (solver.factor().report().zero_pivots > 0) result.first_mechanism = solver.describe_mechanism(0);
  const auto driven = solver.driven_mechanism(given.force);
  if (!driven) return;
  bad_input("a load drives a mechanism",
            fmt::format("it does work on a motion that has no energy: {}",
                        describe_motion(assembly, disc_motions(solver.unknowns(), *driven))),
            remedy_of_mechanisms(assembly, springs, effects.rotation,
                                 {"hold that motion by a support", "take the load off those discs"}));
}

void EquilibriumSolver::Implementation::bound_error(const RightHandSide& given, const Solution& solution,
                                                    Equilibrium& result) {
  const SoftestMotion softest = solver.softest_motion(solution.motion.high);
  result.condition = solver.norm() * softest.inverse_norm;
  double size = 0;
  for (const double u : solution.motion.high) size += u * u;
  constexpr double safety = 10;           // the norm of the inverse is estimated from below
  constexpr double rounding = 0x1.0p-53;  // of the motions handed out
  result.error_bound = rounding;
  if (size == 0 || softest.motion.empty()) return;
  const double wrong = solution.residual + solver.rounding_work(given, solution.motion, softest.motion);
  result.error_bound += safety * softest.inverse_norm * wrong / std::sqrt(size);
}

void EquilibriumSolver::Implementation::describe_state(std::span<const double> f, const PreciseMotion& motion,
                                                       Equilibrium& result) const {
  const DegreesOfFreedom& unknowns = solver.unknowns();
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  result.motions = disc_motions(unknowns, motion.high);
  const SpringNetwork network{assembly, solver.graph(), springs, unknowns};
  std::vector<double> internal(f.size());
  if (effects.bending) result.bending_moments = bending_moments_of(network, motion);
  if (springs.prestressed() || effects.bending) {
    internal_force(network, motion, {}, internal);
  } else {
    internal_force(assembly, solver.graph(), unknowns, result.contact_forces, internal);
  }
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const auto held = [&](std::size_t k) { return unknowns.held[d * b + k] != 0; };
    const auto reaction = [&](std::size_t k) { return held(k) ? internal[d * b + k] - f[d * b + k] : 0.0; };
    if (!held(0) && !held(1) && !(b == 3 && reaction(2) != 0)) continue;
    const double moment = b == 3 ? reaction(2) * unknowns.rotation_scale : 0.0;
    result.reactions.push_back({static_cast<std::int32_t>(d), {reaction(0), reaction(1)}, moment});
  }
  if (effects.restrained) {
    result.rotation_moments = contact_moments(assembly, result.contact_forces);
    for (std::size_t c = 0; springs.prestressed() && c < assembly.contacts.size(); ++c) {
      const ContactMotion by = motion_of(network, motion, {}, c);
      ContactResponse<double> response;
      add_prestress(*springs.prestress(c), by.deformation, by.theta_i, by.theta_j, response);
      result.rotation_moments[assembly.contacts[c].i] += response.moment_i;
      result.rotation_moments[assembly.contacts[c].j] += response.moment_j;
    }
    for (double& moment : result.rotation_moments) moment = -moment;
  }
  if (springs.prestressed()) {
    result.energy = elastic_energy(assembly, springs, result.motions);
    return;
  }
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    result.energy += linear_spring_energy_of(springs[c], result.contact_forces[c]);
    if (effects.bending && springs.bending(c) > 0)
      result.energy += 0.5 * result.bending_moments[c] * result.bending_moments[c] / springs.bending(c);
  }
}

EquilibriumSolver::EquilibriumSolver(const Assembly& assembly, const ContactSprings& springs,
                                     std::span<const Support> supports, const EquilibriumOptions& options) {
  check(assembly);
  check(options.solver);
  implementation_ = std::make_unique<Implementation>(assembly, springs, supports, options);
}

EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

namespace {

void check_count(std::span<const DiscForce> loads, const Assembly& assembly) {
  if (loads.size() != assembly.size())
    bad_input(fmt::format("there are loads of {}, and the assembly has {}",
                          counted(static_cast<std::int64_t>(loads.size()), "disc"),
                          counted(static_cast<std::int64_t>(assembly.size()), "disc")),
              "each disc has its own", "Give as many, 0 where nothing acts");
}

}  // namespace

Equilibrium EquilibriumSolver::solve(const LoadCase& loads) {
  Implementation& self = *implementation_;
  const DegreesOfFreedom& unknowns = self.solver.unknowns();
  return self.solve(assemble_loads(self.assembly, unknowns, loads), unknowns.prescribed);
}
Equilibrium EquilibriumSolver::solve(std::span<const DiscForce> loads) {
  check_count(loads, implementation_->assembly);
  const DegreesOfFreedom& unknowns = implementation_->solver.unknowns();
  return implementation_->solve(assemble_loads(unknowns, loads), unknowns.prescribed);
}
Equilibrium EquilibriumSolver::solve_held(std::span<const DiscForce> loads) {
  check_count(loads, implementation_->assembly);
  return implementation_->solve(assemble_loads(implementation_->solver.unknowns(), loads), {});
}
const Assembly& EquilibriumSolver::assembly() const {
  return implementation_->assembly;
}
const ContactSprings& EquilibriumSolver::springs() const {
  return implementation_->springs;
}
const Effects& EquilibriumSolver::effects() const {
  return implementation_->effects;
}
std::int64_t EquilibriumSolver::unknowns() const {
  return implementation_->solver.unknowns().unknowns;
}

Equilibrium solve_equilibrium(const Assembly& assembly, const ContactSprings& springs,
                              std::span<const Support> supports, const LoadCase& loads,
                              const EquilibriumOptions& options) {
  return EquilibriumSolver(assembly, springs, supports, options).solve(loads);
}

SolveEstimate estimate_solve(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                             const EquilibriumOptions& options, bool indefinite) {
  check(assembly);
  const ContactGraph graph(assembly);
  const Effects effects = derive_effects(assembly, springs, options.rotation);
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, supports);
  const SolverMethod method = choose_method(assembly, springs, options.solver);
  SolveEstimate result;
  if (entry_of(method).back_end.iterative) {
    result = estimate_iterations(assembly, unknowns);
  } else {
    const SymbolicFactor symbolic = analyze(dissect(assembly, graph), graph, unknowns.per_disc);
    result = estimate(symbolic, unknowns, indefinite || springs.may_be_indefinite());
    result.peak_bytes *= memory_factor(method, options.solver.ordering);
  }
  result.method = method;
  return result;
}

std::string Equilibrium::report() const {
  std::string text = fmt::format("{} unknowns, {}, ", unknowns, solver);
  text += iterations > 0 ? counted(iterations, "iteration") : fmt::format("{:.3g} entries in L", factor_nonzeros);
  text += fmt::format(" ({})\n", readable_bytes(factor_bytes));
  text += fmt::format("relative residual {:.1e} after {}, {:.1e} for the motions rounded to double\n",
                      relative_residual, counted(refinements, "refinement"), rounded_residual);
  if (condition > 0)
    text += fmt::format("condition about {:.1e}; relative error of the motions at most about {:.1e}\n", condition,
                        error_bound);
  if (negative_pivots > 0 || unstable_modes != 0) {
    text += negative_pivots ? fmt::format("{} negative pivots: ", *negative_pivots) : "negative pivots not counted: ";
    if (unstable_modes == 0) {
      text += "those of the rotations alone (kT < 0); the state of rest is stable in statics\n";
    } else if (!unstable_modes) {
      text += "the solver does not determine stability\n";
    } else {
      text += fmt::format("{} beyond those of the rotations: the state of rest is UNSTABLE\n", *unstable_modes);
    }
  }
  for (const auto& [stage, seconds] : times.stages()) text += fmt::format("{:<10} {:.4f} s\n", stage, seconds);
  return text;
}

}  // namespace equidem
