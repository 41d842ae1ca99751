// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/stiffness_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/rigid_growth.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/precision/factor_precision.hpp"
#include "equidem/statics/precision/refinement.hpp"

namespace equidem {

StiffnessSolver::StiffnessSolver(const Assembly& assembly, const ContactSprings& springs, ContactGraph graph,
                                 DegreesOfFreedom unknowns, const SolverOptions& options, Mechanisms mechanisms,
                                 StageTimes& times)
    : assembly_(assembly),
      springs_(springs),
      graph_(std::move(graph)),
      unknowns_(std::move(unknowns)),
      options_(options),
      mechanisms_(mechanisms),
      on_graph_{matrix_, assembly_, graph_} {
  Stopwatch watch;
  const BackEnd& back_end = entry_of(options.method).back_end;
  if (!back_end.iterative) {
    DissectionTree tree = dissect(assembly, graph_);
    times.add("order", watch.lap());
    symbolic_ = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph_, unknowns_.per_disc));
    times.add("analyze", watch.lap());
  }
  const bool single = symbolic_ && tries_single_precision(options, springs, *symbolic_);
  SolveEstimate size = symbolic_ ? estimate(*symbolic_, unknowns_, springs.any_negative(), single)
                                 : estimate_iterations(assembly, unknowns_);
  size.peak_bytes *= back_end.memory_factor;
  check_memory(size, options.memory_limit);
  watch.lap();
  matrix_ = assemble_stiffness(assembly, graph_, springs, unknowns_);
  times.add("assemble", watch.lap());
  if (single) {
    std::string reason;
    factor_ = factorize_in_single_precision(system(), reason);
    times.add("factorize", watch.lap());
    if (factor_ && !grows_rigid(assembly, graph_, springs, unknowns_.per_disc) && !stands_probe(times)) {
      reason = "a motion resists much less than others";
      factor_.reset();
    }
    times.add("probe", watch.lap());
    if (!factor_) factorize_in_double(std::move(reason), times);
  } else {
    factor_ = factorize(system(), options, mechanisms, times);
  }
  watch.lap();
  judge_inertia();
  times.add("inertia", watch.lap());
}

System StiffnessSolver::system() const {
  return {on_graph_, springs_, unknowns_, symbolic_};
}

void StiffnessSolver::factorize_in_double(std::string reason, StageTimes& times) const {
  why_double_ = std::move(reason);
  factor_.reset();
  check_memory(estimate(*symbolic_, unknowns_, springs_.any_negative()), options_.memory_limit);
  factor_ = factorize(system(), options_, mechanisms_, times);
}

bool StiffnessSolver::stands_probe(StageTimes& times) const {
  constexpr double tolerance = 1e-6;  // below the share of one motion in the rough load of 1e11 unknowns
  const auto b = static_cast<std::size_t>(matrix_.block);
  Random random(1);
  RightHandSide rough;
  rough.force.resize(unknowns_.held.size());
  for (std::size_t k = 0; k < rough.force.size(); ++k) {
    rough.force[k] = (random.uniform() - 0.5) * std::sqrt(matrix_.diagonal_block(k / b)[k % b * (b + 1)]);
  }
  return refine({&rough, 1}, tolerance, nullptr, times);
}

std::string StiffnessSolver::solver_name() const {
  const std::string& name = factor_->report().name;
  return why_double_.empty() ? name : fmt::format("{} in double precision, since {}", name, why_double_);
}

void StiffnessSolver::judge_inertia() {
  const std::int64_t negative = factor_->report().negative_pivots;
  if (!springs_.any_negative()) {
    unstable_modes_ = 0;
  } else if (negative < 0) {
    unstable_modes_ = -1;
  } else {
    const std::int64_t of_rotations = negative_rotations(system());
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

bool StiffnessSolver::refine(std::span<const RightHandSide> cases, double good_enough, std::vector<Solution>* solutions,
                             StageTimes& times) const {
  constexpr int steps_for_one = 8;  // of conjugate gradients with a factor in single precision
  const bool single = factor_->report().single_precision;
  const std::size_t n = unknowns_.held.size();
  std::vector<double> x(n * cases.size());
  const auto column = [&](std::size_t k) { return std::span(x).subspan(k * n, n); };
  std::vector<Refinement> all;
  all.reserve(cases.size());
  for (std::size_t k = 0; k < cases.size(); ++k) all.emplace_back(*this, cases[k], column(k), good_enough);
  Stopwatch watch;
  const int most = options_.max_refinements * (single ? steps_for_one : 1);
  std::optional<Progress> progress;  // iterative methods show their own
  if (single) progress.emplace("refining");
  for (int pass = 0; pass <= most; ++pass) {
    std::vector<Refinement*> open;  // their residuals stand one after another at the front of x
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].failed) return false;
      if (all[k].done) continue;
      if (k != open.size()) std::ranges::copy(column(k), column(open.size()).begin());
      open.push_back(&all[k]);
    }
    if (open.empty()) break;
    factor_->solve(std::span(x).first(open.size() * n), static_cast<int>(open.size()));
    for (std::size_t k = open.size(); k-- > 0;) {
      const auto position = static_cast<std::size_t>(open[k] - all.data());
      if (position != k) std::ranges::copy(column(k), column(position).begin());
      all[position].correct(column(position), pass);
    }
    times.add(pass == 0 ? "solve" : "refine", watch.lap());
    if (!progress) continue;
    double share = 1;
    for (const Refinement& one : all) {
      if (!one.done) share = std::min(share, std::log(one.solution.relative_residual()) / std::log(good_enough));
    }
    progress->update(std::clamp(share, 0.0, 1.0));
  }
  if (single && std::any_of(all.begin(), all.end(), [](const Refinement& one) { return !one.done || one.failed; })) {
    return false;
  }
  for (std::size_t k = 0; solutions != nullptr && k < all.size(); ++k) solutions->push_back(all[k].finish());
  return true;
}

std::vector<Solution> StiffnessSolver::solve(std::span<const RightHandSide> cases, StageTimes& times) const {
  const double good_enough = entry_of(options_.method).back_end.good_enough;
  std::vector<Solution> solutions;
  if (!refine(cases, good_enough, &solutions, times)) {
    factorize_in_double("refinement did not converge", times);
    refine(cases, good_enough, &solutions, times);
  }
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

double StiffnessSolver::twice_energy(std::span<const double> x) const {
  return 2 * elastic_energy(assembly_, springs_, disc_motions(unknowns_, x));
}

SoftestMotion StiffnessSolver::softest_motion(std::span<const double> start) const {
  return iterate_inverse(start, std::vector<double>(unknowns_.held.size(), 1.0));
}

double StiffnessSolver::scaled_inverse_norm(std::span<const double> start) const {
  std::vector<double> root = row_sums();
  for (double& value : root) value = std::sqrt(value);
  return iterate_inverse(start, std::move(root)).inverse_norm;
}

SoftestMotion StiffnessSolver::iterate_inverse(std::span<const double> start, std::vector<double> scale) const {
  for (std::size_t k = 0; k < scale.size(); ++k) {
    if (unknowns_.held[k] != 0) scale[k] = 0;
  }
  std::vector<double> x(start.begin(), start.end());
  x.resize(scale.size());
  const auto multiply_by_scale = [&] {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] *= scale[k];
  };
  multiply_by_scale();
  if (norm_of_free(x) == 0) {
    Random random(1);
    for (double& value : x) value = random.uniform() - 0.5;
  }
  SoftestMotion result;
  const auto make_unit = [&] {
    const double size = norm_of_free(x);
    if (size > 0) {
      for (double& value : x) value /= size;
    }
    return size;
  };
  if (!(make_unit() > 0)) return result;
  for (int pass = 0; pass < 2; ++pass) {
    multiply_by_scale();
    factor_->solve(x, 1);
    multiply_by_scale();
    result.inverse_norm = std::max(result.inverse_norm, make_unit());
  }
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = scale[k] > 0 ? x[k] / scale[k] : 0;
  // Round-off of the factor may make the motion stiffer than it is, and in single precision softer, too. The quotient
  // of Rayleigh does not depend on the factor; for an exact one it is at least the growth of the last pass.
  const double stiffness = springs_.any_negative() ? 0 : twice_energy(x);
  const bool single = factor_->report().single_precision;
  if (stiffness > 0) result.inverse_norm = std::max(single ? 0.0 : result.inverse_norm, 1 / stiffness);
  result.motion = std::move(x);
  return result;
}

double StiffnessSolver::scaled_residual(const RightHandSide& given, const PreciseMotion& motion) const {
  const std::vector<double> scale = row_sums();
  std::vector<double> residual(unknowns_.held.size());
  evaluate_residual(given, motion, residual);
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (unknowns_.held[k] == 0) residual[k] /= std::sqrt(scale[k]);
  }
  return norm_of_free(residual);
}

double StiffnessSolver::scaled_residual_bound(const RightHandSide& given, const Solution& solution) const {
  const std::vector<double> rows = row_sums();
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (unknowns_.held[k] != 0) continue;
    least = std::min(least, rows[k]);
    most = std::max(most, rows[k]);
  }
  constexpr double alike = 100;
  if (!(least > 0) || most > alike * least) return scaled_residual(given, solution.motion);
  return solution.residual / std::sqrt(least);
}

double normal_rounding(const Assembly& assembly, const Contact& contact) {
  if (!assembly.periodic()) return 2;
  const Vec2 shift{contact.shift_x * assembly.period->x, contact.shift_y * assembly.period->y};
  return 2 + norm(shift) / norm(assembly.branch(contact));
}

double StiffnessSolver::rounding_work(const RightHandSide& given, const PreciseMotion& motion,
                                      std::span<const double> v) const {
  constexpr double rounding = 0x1.0p-52;
  PreciseMotion other(v.size());
  std::copy(v.begin(), v.end(), other.high.begin());
  const std::vector<ContactDeformation> of_u = deformations(given, motion), of_v = deformations({}, other);
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  double work = 0;
  for (std::size_t c = 0; c < of_u.size(); ++c) {
    const Contact& contact = assembly_.contacts[c];
    const std::size_t i = contact.i * b, j = contact.j * b;
    const auto distance = [&](const std::vector<double>& x) { return std::hypot(x[j] - x[i], x[j + 1] - x[i + 1]); };
    const auto force = [&](const ContactDeformation& d) {
      const auto f = linear_spring_force(springs_[c], d);
      return std::abs(f.normal) + std::abs(f.tangential);
    };
    work += rounding * normal_rounding(assembly_, contact) *
            (distance(motion.high) * force(of_v[c]) + distance(other.high) * force(of_u[c]));
  }
  return work;
}

std::vector<double> StiffnessSolver::row_sums() const {
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
  return sum;
}

double StiffnessSolver::norm() const {
  const std::vector<double> sum = row_sums();
  double largest = 0;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (unknowns_.held[k] == 0) largest = std::max(largest, sum[k]);
  }
  return largest;
}

}  // namespace equidem
