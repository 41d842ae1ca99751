// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/rigidity.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
namespace {

double norm_of_free(const DegreesOfFreedom& unknowns, std::span<const double> x) {
  double sum = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (unknowns.held[k] == 0) sum += x[k] * x[k];
  }
  return std::sqrt(sum);
}

void check_load(const Load& load) {
  for (const double value : {load.force.x, load.force.y, load.moment}) {
    if (!std::isfinite(value)) {
      bad_input(format("the load on '{}' has the value {}", load.group, value), "a load must be finite",
                "Give a number");
    }
  }
}

/// Force on every component: N/m; moments over a.
std::vector<double> assemble_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, const LoadCase& loads) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<double> f(assembly.size() * b, 0.0);
  for (const Load& load : loads) {
    check_load(load);
    const DiscGroup& discs = group(assembly, load.group);
    if (discs.discs.empty()) {
      bad_input(format("a load acts on the group '{}', which is empty", load.group), "there is no disc to carry it",
                "Choose a group with discs or mend its definition");
    }
    if (load.kind == LoadKind::traction && discs.tributary_lengths.empty()) {
      bad_input(format("a traction acts on the group '{}'", load.group),
                "it is no side of the assembly and has no length",
                "Use kind = \"per_disc\" or \"total\", or one of the groups left, right, bottom, top");
    }
    if (load.moment != 0 && b != 3) {
      bad_input(format("a moment acts on the group '{}'", load.group), "rotations are no unknowns of this scene",
                "Remove the moment, or let rotation = \"free\" with tangential springs");
    }
    const double share = load.kind == LoadKind::total ? 1.0 / static_cast<double>(discs.discs.size()) : 1.0;
    for (std::size_t k = 0; k < discs.discs.size(); ++k) {
      const double weight = load.kind == LoadKind::traction ? discs.tributary_lengths[k] : share;
      const std::size_t disc = discs.discs[k];
      f[disc * b] += weight * load.force.x;
      f[disc * b + 1] += weight * load.force.y;
      if (b == 3) f[disc * b + 2] += share * load.moment / unknowns.rotation_scale;
    }
  }
  return f;
}

/// A moment on a disc that no contact keeps from turning, and no support either, could not be balanced.
void check_inert_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> f) {
  if (unknowns.per_disc != 3 || unknowns.inert_rotations == 0) return;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    if (f[3 * d + 2] == 0 || unknowns.held[3 * d + 2] != DegreesOfFreedom::inert) continue;
    bad_input(format("a moment acts on disc {}", d),
              "none of its contacts has a tangential spring and a lever arm to resist it",
              "Remove the moment, hold the rotation of the disc, or give a contact of it kT != 0");
  }
}

}  // namespace

struct EquilibriumSolver::Implementation {
  const Assembly& assembly;
  const ContactSprings& springs;
  EquilibriumOptions options;
  Effects effects;
  ContactGraph graph;
  DegreesOfFreedom unknowns;
  StiffnessMatrix matrix;
  std::unique_ptr<Factorization> factor;
  std::int64_t unstable_modes = 0;
  StageTimes times;

  Implementation(const Assembly& assembly_in, const ContactSprings& springs_in, const EquilibriumOptions& options_in)
      : assembly(assembly_in),
        springs(springs_in),
        options(options_in),
        effects(derive_effects(springs_in, options_in.rotation)),
        graph(assembly_in) {}

  void build(std::span<const Support> supports);
  void judge_inertia(const System& system);
  [[nodiscard]] Equilibrium solve(const LoadCase& loads) const;
  void refine(std::span<const double> f, PreciseMotion& motion, Equilibrium& result) const;
  [[nodiscard]] double residual_of_rounded(std::span<const double> f, const PreciseMotion& motion) const;
  void describe_state(std::span<const double> f, const PreciseMotion& motion, Equilibrium& result) const;
};

void EquilibriumSolver::Implementation::build(std::span<const Support> supports) {
  Stopwatch watch;
  unknowns = number_unknowns(assembly, springs, effects, supports);
  check_rigidity(assembly, graph, springs, unknowns);
  if (assembly.size() == 1 && assembly.contacts.empty()) {
    bad_input("the assembly is a single disc", "it touches nothing, so there is no equilibrium to find",
              "Add discs that touch it");
  }
  times.add("check", watch.lap());
  DissectionTree tree = dissect(assembly, graph);
  times.add("order", watch.lap());
  auto symbolic = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph, unknowns.per_disc));
  times.add("analyze", watch.lap());
  SolveEstimate size = estimate(*symbolic, unknowns, springs.any_negative());
  if (options.solver.method == SolverMethod::umfpack)
    size.peak_bytes *= 4;  // LU of the whole matrix in an order of its own
  check_memory(size, options.solver.memory_limit);
  watch.lap();
  matrix = assemble_stiffness(assembly, graph, springs, unknowns);
  times.add("assemble", watch.lap());
  const MatrixOnGraph k{matrix, assembly, graph};
  const System system{k, springs, unknowns, std::move(symbolic)};
  factor = factorize(system, options.solver, times);
  watch.lap();
  judge_inertia(system);
  times.add("inertia", watch.lap());
}

void EquilibriumSolver::Implementation::judge_inertia(const System& system) {
  const std::int64_t negative = factor->report().negative_pivots;
  if (!springs.any_negative()) {
    unstable_modes = 0;
  } else if (negative < 0) {
    unstable_modes = -1;
  } else {
    const std::int64_t of_rotations = negative_rotations(system);
    unstable_modes = of_rotations < 0 ? -1 : negative - of_rotations;
  }
}

Equilibrium EquilibriumSolver::Implementation::solve(const LoadCase& loads) const {
  Equilibrium result;
  result.times = times;
  result.unknowns = unknowns.unknowns;
  const std::vector<double> f = assemble_loads(assembly, unknowns, loads);
  check_inert_loads(assembly, unknowns, f);
  PreciseMotion motion(f.size());
  for (std::size_t k = 0; k < f.size(); ++k) motion.high[k] = unknowns.prescribed[k];
  result.contact_forces.resize(assembly.contacts.size());
  refine(f, motion, result);
  contact_forces_of(assembly, springs, unknowns, motion, result.contact_forces);
  describe_state(f, motion, result);
  const FactorReport& report = factor->report();
  result.solver = report.name;
  result.negative_pivots = report.negative_pivots;
  result.unstable_modes = unstable_modes;
  result.pivot_growth = report.growth;
  result.factor_nonzeros = report.nonzeros;
  result.factor_bytes = report.bytes;
  return result;
}

// Solve K d = f - f_int(u), u := u + d, until the residual no longer falls: the first pass is the solution
// itself, the others are iterative refinement with the residual taken from the contact law and the motion
// kept to twice the digits.
void EquilibriumSolver::Implementation::refine(std::span<const double> f, PreciseMotion& motion,
                                               Equilibrium& result) const {
  constexpr double good_enough = 1e-15;
  std::vector<double> residual(f.size());
  const auto evaluate = [&] {
    residual_force(assembly, graph, springs, unknowns, motion, f, residual);
    return norm_of_free(unknowns, residual);
  };
  const double reference = evaluate();
  if (reference == 0) return;
  Stopwatch watch;
  double before = 1;
  for (int pass = 0; pass <= options.solver.max_refinements; ++pass) {
    factor->solve(residual, 1);
    for (std::size_t k = 0; k < f.size(); ++k) {
      if (unknowns.held[k] != 0) residual[k] = 0;
    }
    const PreciseMotion previous = motion;
    motion.add(residual);
    const double now = evaluate() / reference;
    result.times.add(pass == 0 ? "solve" : "refine", watch.lap());
    if (pass > 0 && !(now < before)) {  // no better: keep what was
      motion = previous;
      break;
    }
    result.relative_residual = now;
    result.refinements = pass;
    if (now <= good_enough || (pass > 0 && now > 0.5 * before)) break;
    before = now;
  }
  result.rounded_residual = residual_of_rounded(f, motion) / reference;
  constexpr double worthless = 1e-3;
  if (!std::isfinite(result.relative_residual)) {
    computation_failed("the numbers of this case overflow a double",
                       format("the residual comes out as {}", result.relative_residual),
                       "Check the units of sizes, springs and loads");
  }
  if (!(result.relative_residual <= worthless)) {
    computation_failed(format("the solution leaves a relative residual of {:.1e}", result.relative_residual),
                       "the stiffness matrix is too close to singular for the digits of a double",
                       "Check supports and springs; springs of very different size are the usual cause");
  }
}

double EquilibriumSolver::Implementation::residual_of_rounded(std::span<const double> f,
                                                              const PreciseMotion& motion) const {
  PreciseMotion rounded(0);
  rounded.high = motion.high;
  rounded.low.assign(motion.high.size(), 0.0);
  std::vector<double> residual(f.size());
  residual_force(assembly, graph, springs, unknowns, rounded, f, residual);
  return norm_of_free(unknowns, residual);
}

void EquilibriumSolver::Implementation::describe_state(std::span<const double> f, const PreciseMotion& motion,
                                                       Equilibrium& result) const {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  result.motions.resize(assembly.size());
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const double turn = b == 3 ? motion.high[d * b + 2] / unknowns.rotation_scale : 0.0;
    result.motions[d] = {{motion.high[d * b], motion.high[d * b + 1]}, turn};
  }
  std::vector<double> internal(f.size());
  internal_force(assembly, graph, unknowns, result.contact_forces, internal);
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const auto held = [&](std::size_t k) { return unknowns.held[d * b + k] != 0; };
    const auto reaction = [&](std::size_t k) { return held(k) ? internal[d * b + k] - f[d * b + k] : 0.0; };
    if (!held(0) && !held(1) && !(b == 3 && reaction(2) != 0)) continue;
    const double moment = b == 3 ? reaction(2) * unknowns.rotation_scale : 0.0;
    result.reactions.push_back({static_cast<std::int32_t>(d), {reaction(0), reaction(1)}, moment});
  }
  if (effects.tangential_springs && !effects.rotation) {
    result.rotation_moments = contact_moments(assembly, result.contact_forces);
    for (double& moment : result.rotation_moments) moment = -moment;
  }
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    result.energy += linear_spring_energy_of(springs[c], result.contact_forces[c]);
  }
}

EquilibriumSolver::EquilibriumSolver(const Assembly& assembly, const ContactSprings& springs,
                                     std::span<const Support> supports, const EquilibriumOptions& options) {
  check(assembly);
  check(options.solver);
  implementation_ = std::make_unique<Implementation>(assembly, springs, options);
  implementation_->build(supports);
}

EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

Equilibrium EquilibriumSolver::solve(const LoadCase& loads) const {
  return implementation_->solve(loads);
}
const Effects& EquilibriumSolver::effects() const {
  return implementation_->effects;
}
std::int64_t EquilibriumSolver::unknowns() const {
  return implementation_->unknowns.unknowns;
}

Equilibrium solve_equilibrium(const Assembly& assembly, const ContactSprings& springs,
                              std::span<const Support> supports, const LoadCase& loads,
                              const EquilibriumOptions& options) {
  return EquilibriumSolver(assembly, springs, supports, options).solve(loads);
}

SolveEstimate estimate_solve(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                             const EquilibriumOptions& options) {
  check(assembly);
  const ContactGraph graph(assembly);
  const Effects effects = derive_effects(springs, options.rotation);
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, supports);
  return estimate(analyze(dissect(assembly, graph), graph, unknowns.per_disc), unknowns, springs.any_negative());
}

std::string Equilibrium::report() const {
  std::string text = format("{} unknowns, {}, {:.3g} entries in L ({})\n", unknowns, solver, factor_nonzeros,
                            readable_bytes(factor_bytes));
  text += format("relative residual {:.1e} after {}, {:.1e} for the motions rounded to double\n", relative_residual,
                 counted(refinements, "refinement"), rounded_residual);
  if (negative_pivots > 0 || unstable_modes != 0) {
    text += negative_pivots < 0 ? "negative pivots not counted: " : format("{} negative pivots: ", negative_pivots);
    if (unstable_modes == 0) {
      text += "those of the rotations alone (kT < 0); the state of rest is stable in statics\n";
    } else if (unstable_modes < 0) {
      text += "the solver cannot tell stable from unstable\n";
    } else {
      text += format("{} beyond those of the rotations: the state of rest is UNSTABLE\n", unstable_modes);
    }
  }
  for (const auto& [stage, seconds] : times.stages()) text += format("{:<10} {:.4f} s\n", stage, seconds);
  return text;
}

}  // namespace equidem
