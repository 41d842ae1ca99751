// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/stiffness_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

StiffnessSolver::StiffnessSolver(const Assembly& assembly, const ContactSprings& springs, ContactGraph graph,
                                 DegreesOfFreedom unknowns, const SolverOptions& options, Mechanisms mechanisms,
                                 StageTimes& times)
    : assembly_(assembly),
      springs_(springs),
      graph_(std::move(graph)),
      unknowns_(std::move(unknowns)),
      options_(options) {
  Stopwatch watch;
  DissectionTree tree = dissect(assembly, graph_);
  times.add("order", watch.lap());
  auto symbolic = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph_, unknowns_.per_disc));
  times.add("analyze", watch.lap());
  SolveEstimate size = estimate(*symbolic, unknowns_, springs.any_negative());
  if (options.method == SolverMethod::umfpack) size.peak_bytes *= 4;  // LU of the whole matrix in an order of its own
  check_memory(size, options.memory_limit);
  watch.lap();
  matrix_ = assemble_stiffness(assembly, graph_, springs, unknowns_);
  times.add("assemble", watch.lap());
  const MatrixOnGraph k{matrix_, assembly, graph_};
  const System system{k, springs, unknowns_, std::move(symbolic)};
  factor_ = factorize(system, options, mechanisms, times);
  watch.lap();
  judge_inertia(system);
  times.add("inertia", watch.lap());
}

void StiffnessSolver::judge_inertia(const System& system) {
  const std::int64_t negative = factor_->report().negative_pivots;
  if (!springs_.any_negative()) {
    unstable_modes_ = 0;
  } else if (negative < 0) {
    unstable_modes_ = -1;
  } else {
    const std::int64_t of_rotations = negative_rotations(system);
    unstable_modes_ = of_rotations < 0 ? -1 : negative - of_rotations;
  }
}

double StiffnessSolver::norm_of_free(std::span<const double> x) const {
  double sum = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (unknowns_.held[k] == 0) sum += x[k] * x[k];
  }
  return std::sqrt(sum);
}

void StiffnessSolver::evaluate_residual(const RightHandSide& given, const PreciseMotion& motion,
                                        std::span<double> residual) const {
  residual_force({assembly_, graph_, springs_, unknowns_}, motion, given.imposed, given.force, residual);
}

/// Refinement of one right-hand side: K d = f - f_int(u), u := u + d, until the residual no longer falls. The first
/// pass is the solution itself; the residual comes from the contact law, the motion is kept to twice the digits.
struct StiffnessSolver::Refinement {
  const StiffnessSolver& solver;
  const RightHandSide& given;
  Solution solution;
  PreciseMotion previous{0};
  bool done = false;

  Refinement(const StiffnessSolver& solver_in, const RightHandSide& given_in, std::span<double> residual)
      : solver(solver_in), given(given_in) {
    const auto& unknowns = solver.unknowns_;
    solution.motion = PreciseMotion(unknowns.held.size());
    for (std::size_t k = 0; k < given.prescribed.size(); ++k) {
      if (unknowns.held[k] != 0) solution.motion.high[k] = given.prescribed[k];
    }
    solution.residual = evaluate(residual);
    solution.scale = std::max(solution.residual, imposed_force());
    done = solution.residual == 0;
  }

  /// Take in the correction that the factorization answered with, and leave the new residual in its place.
  void correct(std::span<double> x, int pass) {
    constexpr double good_enough = 1e-15;
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (solver.unknowns_.held[k] != 0) x[k] = 0;
    }
    previous = solution.motion;
    solution.motion.add(x);
    const double before = solution.residual;
    const double now = evaluate(x);
    if (pass > 0 && !(now < before)) {  // no better: keep what was
      solution.motion = std::move(previous);
      done = true;
      return;
    }
    solution.residual = now;
    solution.refinements = pass;
    done = now <= good_enough * solution.scale || (pass > 0 && now > 0.5 * before);
  }

  Solution finish() {
    constexpr double worthless = 1e-3;
    const double relative = solution.relative_residual();
    if (!std::isfinite(relative)) {
      computation_failed("the numbers of this case overflow a double", format("the residual comes out as {}", relative),
                         "Check the units of sizes, springs and loads");
    }
    if (!(relative <= worthless)) {
      computation_failed(format("the solution leaves a relative residual of {:.1e}", relative),
                         "the stiffness matrix is too close to singular for the digits of a double",
                         "Check supports and springs; springs of very different size are the usual cause");
    }
    return std::move(solution);
  }

 private:
  double evaluate(std::span<double> residual) const {
    solver.evaluate_residual(given, solution.motion, residual);
    return solver.norm_of_free(residual);
  }

  /// Size of the forces that imposed deformations cause, before they cancel on each disc.
  [[nodiscard]] double imposed_force() const {
    double sum = 0;
    for (std::size_t c = 0; c < given.imposed.size(); ++c) {
      const ContactForce f = linear_spring_force(solver.springs_[c], given.imposed[c]);
      sum += f.normal * f.normal + f.tangential * f.tangential;
    }
    return std::sqrt(2 * sum);
  }
};

std::vector<Solution> StiffnessSolver::solve(std::span<const RightHandSide> cases, StageTimes& times) const {
  const std::size_t n = unknowns_.held.size();
  std::vector<double> x(n * cases.size());
  std::vector<Refinement> all;
  all.reserve(cases.size());
  for (std::size_t k = 0; k < cases.size(); ++k) all.emplace_back(*this, cases[k], std::span(x).subspan(k * n, n));
  Stopwatch watch;
  for (int pass = 0; pass <= options_.max_refinements; ++pass) {
    std::vector<Refinement*> open;  // their residuals stand one after another at the front of x
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].done) continue;
      if (k != open.size()) std::copy_n(x.begin() + k * n, n, x.begin() + open.size() * n);
      open.push_back(&all[k]);
    }
    if (open.empty()) break;
    factor_->solve(std::span(x).first(open.size() * n), static_cast<int>(open.size()));
    for (std::size_t k = open.size(); k-- > 0;) {
      const auto position = static_cast<std::size_t>(open[k] - all.data());
      if (position != k) std::copy_n(x.begin() + k * n, n, x.begin() + position * n);
      all[position].correct(std::span(x).subspan(position * n, n), pass);
    }
    times.add(pass == 0 ? "solve" : "refine", watch.lap());
  }
  std::vector<Solution> solutions;
  for (Refinement& one : all) solutions.push_back(one.finish());
  return solutions;
}

double StiffnessSolver::rounded_residual(const RightHandSide& given, const PreciseMotion& motion) const {
  PreciseMotion rounded(0);
  rounded.high = motion.high;
  rounded.low.assign(motion.high.size(), 0.0);
  std::vector<double> residual(motion.high.size());
  evaluate_residual(given, rounded, residual);
  return norm_of_free(residual);
}

std::vector<ContactDeformation> StiffnessSolver::deformations(const RightHandSide& given,
                                                              const PreciseMotion& motion) const {
  std::vector<ContactDeformation> result(assembly_.contacts.size());
  deformations_of({assembly_, graph_, springs_, unknowns_}, motion, given.imposed, result);
  return result;
}

double StiffnessSolver::inverse_norm(std::span<const double> start) const {
  std::vector<double> x(start.begin(), start.end());
  if (norm_of_free(x) == 0) {
    x.resize(unknowns_.held.size());
    Random random(1);
    for (double& value : x) value = random.uniform() - 0.5;
  }
  double result = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (unknowns_.held[k] != 0) x[k] = 0;
    }
    const double before = norm_of_free(x);
    if (!(before > 0)) break;
    for (double& value : x) value /= before;
    factor_->solve(x, 1);
    result = std::max(result, norm_of_free(x));
  }
  return result;
}

double StiffnessSolver::norm() const {
  const auto b = static_cast<std::size_t>(matrix_.block);
  std::vector<double> sum(unknowns_.held.size(), 0.0);
  for (std::size_t d = 0; d < assembly_.size(); ++d) {
    for (std::size_t e = 0; e < b * b; ++e) sum[d * b + e / b] += std::abs(matrix_.diagonal_block(d)[e]);
  }
  for (std::size_t c = 0; c < assembly_.contacts.size(); ++c) {
    const Contact& contact = assembly_.contacts[c];
    for (std::size_t e = 0; e < b * b; ++e) {
      const double entry = std::abs(matrix_.coupling_block(c)[e]);
      sum[contact.i * b + e / b] += entry;
      sum[contact.j * b + e % b] += entry;
    }
  }
  double largest = 0;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (unknowns_.held[k] == 0) largest = std::max(largest, sum[k]);
  }
  return largest;
}

}  // namespace equidem
