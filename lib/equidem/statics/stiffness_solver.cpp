// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/stiffness_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/rigid_growth.hpp"
#include "equidem/statics/choice/method_choice.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/precision/factor_precision.hpp"
#include "equidem/statics/precision/refinement.hpp"

namespace equidem {
namespace {

constexpr std::size_t components_at_once = 1 << 14;

}  // namespace

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
  const MethodChoice choice = choose_method({assembly_, graph_, springs_, unknowns_}, options_);
  why_method_ = choice.reason;
  if (!entry_of(choice.method).back_end.iterative) {
    eliminate(choice.method, times);
  } else if (options.method == choice.method) {
    iterate(choice.method, times);
  } else {
    try {
      iterate(choice.method, times);
    } catch (const Error& error) {
      eliminate_instead(error, times);
    }
  }
  const Stopwatch watch;
  judge_inertia();
  times.add("inertia", watch.seconds());
}

void StiffnessSolver::iterate(SolverMethod method, StageTimes& times) const {
  method_ = method;
  check_memory(estimate_iterations(assembly_, unknowns_), options_.memory_limit);
  factor_ = factorize(system(), method, mechanisms_, times);
}

void StiffnessSolver::eliminate_instead(const Error& error, StageTimes& times) const {
  if (error.kind() != ErrorKind::computation_failed) throw;
  why_method_ = error.problem();
  factor_.reset();
  eliminate(SolverMethod::multifrontal, times);
}

void StiffnessSolver::eliminate(SolverMethod method, StageTimes& times) const {
  method_ = method;
  Stopwatch watch;
  DissectionTree tree = dissect(assembly_, graph_);
  times.add("order", watch.lap());
  symbolic_ = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph_, unknowns_.per_disc));
  times.add("analyze", watch.lap());
  const bool single = tries_single_precision(options_, springs_, *symbolic_);
  SolveEstimate size = estimate(*symbolic_, unknowns_, springs_.may_be_indefinite(), single);
  size.peak_bytes *= memory_factor(method, options_.ordering);
  check_memory(size, options_.memory_limit);
  watch.lap();
  matrix_ = assemble_stiffness(assembly_, graph_, springs_, unknowns_);
  times.add("assemble", watch.lap());
  if (!single) {
    factor_ = factorize(system(), method, mechanisms_, times);
    return;
  }
  std::string reason;
  factor_ = factorize_in_single_precision(system(), reason);
  times.add("factorize", watch.lap());
  if (factor_ && !grows_rigid(assembly_, graph_, springs_, unknowns_.per_disc) && !stands_probe(times)) {
    reason = "a motion resists much less than others";
    factor_.reset();
  }
  times.add("probe", watch.lap());
  if (!factor_) factorize_in_double(std::move(reason), times);
}

System StiffnessSolver::system() const {
  constexpr int given_up = 60;  // by "auto": elimination takes no longer
  const bool automatic = options_.method == SolverMethod::automatic;
  return {on_graph_, springs_, unknowns_, symbolic_, automatic ? given_up : most_iterations, options_};
}

void StiffnessSolver::factorize_in_double(std::string reason, StageTimes& times) const {
  why_double_ = std::move(reason);
  factor_.reset();
  check_memory(estimate(*symbolic_, unknowns_, springs_.may_be_indefinite()), options_.memory_limit);
  factor_ = factorize(system(), method_, mechanisms_, times);
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
  std::string name = factor_->report().name;
  if (!why_double_.empty()) name += " in double precision, since " + why_double_;
  if (!why_method_.empty()) name += fmt::format(" ({})", why_method_);
  return name;
}

void StiffnessSolver::judge_inertia() {
  const std::int64_t negative = factor_->report().negative_pivots;
  if (!springs_.may_be_indefinite()) {
    unstable_modes_ = 0;
  } else if (negative < 0) {
    unstable_modes_ = -1;
  } else {
    const std::int64_t of_rotations = negative_rotations(system());
    unstable_modes_ = of_rotations < 0 ? -1 : negative - of_rotations;
  }
}

double StiffnessSolver::norm_of_free(std::span<const double> x) const {
  return std::sqrt(sums_over<1>(x.size(), components_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) {
      if (unknowns_.held[k] == 0) sum += x[k] * x[k];
    }
    return std::array{sum};
  })[0]);
}

void StiffnessSolver::evaluate_residual(const RightHandSide& given, const PreciseMotion& motion,
                                        std::span<double> residual) const {
  residual_force({assembly_, graph_, springs_, unknowns_}, motion, given.gradient, given.force, residual);
}

bool StiffnessSolver::refine(std::span<const RightHandSide> cases, double good_enough, std::vector<Solution>* solutions,
                             StageTimes& times) const {
  constexpr int steps_for_one = 8;  // of conjugate gradients with a factor in single precision
  const bool single = factor_->report().single_precision;
  const std::size_t n = unknowns_.held.size();
  LargeVector<double> x(n * cases.size());
  const auto column = [&](std::size_t k) { return std::span(x).subspan(k * n, n); };
  std::vector<Refinement> all;
  all.reserve(cases.size());
  for (std::size_t k = 0; k < cases.size(); ++k) all.emplace_back(*this, cases[k], column(k), good_enough);
  Stopwatch watch;
  if (options_.accuracy > 0 && iterative()) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!all[k].done) all[k].solve_to(options_.accuracy, column(k));
    }
    times.add("solve", watch.lap());
  }
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
    if (iterative()) {
      constexpr double rough = 0.1;  // for rounding: lattices are at rest under a mean strain
      for (std::size_t k = 0; k < open.size(); ++k) {
        const Solution& now = open[k]->solution;
        open[k]->energies = factor_->solve_to(now.residual <= good_enough * now.scale ? rough : 0, 0, column(k));
      }
    } else {
      factor_->solve(std::span(x).first(open.size() * n), static_cast<int>(open.size()));
    }
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
  const auto attempt = [&](std::vector<Solution>& solutions) {
    const double good_enough = entry_of(method_).back_end.good_enough;
    if (!iterative()) return refine(cases, good_enough, &solutions, times);
    // One after another: vectors of one take as much memory as the grids.
    for (std::size_t k = 0; k < cases.size(); ++k) refine(cases.subspan(k, 1), good_enough, &solutions, times);
    return true;
  };
  std::vector<Solution> solutions;
  try {
    if (attempt(solutions)) return solutions;
    factorize_in_double("refinement did not converge", times);
  } catch (const Error& error) {
    if (method_ == options_.method || !iterative()) throw;
    eliminate_instead(error, times);
  }
  solutions.clear();
  attempt(solutions);
  return solutions;
}

double StiffnessSolver::rounded_residual(const RightHandSide& given, const PreciseMotion& motion) const {
  PreciseMotion rounded(0);
  rounded.high = motion.high;
  std::vector<double> residual(motion.high.size());
  evaluate_residual(given, rounded, residual);
  return norm_of_free(residual);
}

ContactMotion StiffnessSolver::contact_motion(const RightHandSide& given, const PreciseMotion& motion,
                                              std::size_t contact) const {
  return motion_of({assembly_, graph_, springs_, unknowns_}, motion, given.gradient, contact);
}

ContactDeformation StiffnessSolver::deformation(const RightHandSide& given, const PreciseMotion& motion,
                                                std::size_t contact) const {
  return deformation_of({assembly_, graph_, springs_, unknowns_}, motion, given.gradient, contact);
}

double StiffnessSolver::twice_energy(std::span<const double> x) const {
  return 2 * elastic_energy(assembly_, springs_, disc_motions(unknowns_, x));
}

SoftestMotion StiffnessSolver::softest_motion(std::span<const double> start) const {
  return iterate_inverse(start, {});
}

double StiffnessSolver::scaled_inverse_norm(std::span<const double> start) const {
  std::vector<double> root = row_sums();
  for (double& value : root) value = std::sqrt(value);
  return iterate_inverse(start, std::move(root)).inverse_norm;
}

SoftestMotion StiffnessSolver::iterate_inverse(std::span<const double> start, std::vector<double> scale) const {
  const auto scale_of = [&](std::size_t k) { return unknowns_.held[k] != 0 ? 0.0 : scale.empty() ? 1.0 : scale[k]; };
  std::vector<double> x(start.begin(), start.end());
  x.resize(unknowns_.held.size());
  const auto multiply_by_scale = [&] {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] *= scale_of(k);
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
    factor_->solve_roughly(x);
    multiply_by_scale();
    result.inverse_norm = std::max(result.inverse_norm, make_unit());
  }
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = scale_of(k) > 0 ? x[k] / scale_of(k) : 0;
  // Round-off of the factor may make the motion stiffer than it is, and in single precision, or where the solutions are
  // rough, softer, too. The quotient of Rayleigh does not depend on them; for an exact factor it is at least the growth
  // of the last pass.
  const double stiffness = springs_.may_be_indefinite() ? 0 : twice_energy(x);
  const bool rough = factor_->report().single_precision || iterative();
  if (stiffness > 0) result.inverse_norm = std::max(rough ? 0.0 : result.inverse_norm, 1 / stiffness);
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

double StiffnessSolver::scaled_residual_bound(std::span<const RightHandSide> cases,
                                              std::span<const Solution> solutions) const {
  const std::vector<double> rows = row_sums();
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (unknowns_.held[k] != 0) continue;
    least = std::min(least, rows[k]);
    most = std::max(most, rows[k]);
  }
  constexpr double alike = 100;
  const bool each = !(least > 0) || most > alike * least;
  double largest = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    largest = std::max(
        largest, each ? scaled_residual(cases[k], solutions[k].motion) : solutions[k].residual / std::sqrt(least));
  }
  return largest;
}

double normal_rounding(const Assembly& assembly, const Contact& contact) {
  if (!assembly.periodic()) return 2;
  const Vec2 shift{contact.shift_x * assembly.period->x, contact.shift_y * assembly.period->y};
  return 2 + norm(shift) / norm(assembly.branch(contact));
}

double StiffnessSolver::rounding_work(const RightHandSide& given, const PreciseMotion& motion,
                                      std::span<const double> v) const {
  constexpr double rounding = 0x1.0p-52;
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  const SpringNetwork network{assembly_, graph_, springs_, unknowns_};
  PreciseMotion other(0);
  other.high.assign(v.begin(), v.end());
  constexpr std::size_t contacts_at_once = 1 << 13;
  return sums_over<1>(assembly_.contacts.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
    double work = 0;
    for (std::size_t c = begin; c < end; ++c) {
      const Contact& contact = assembly_.contacts[c];
      const std::size_t i = contact.i * b, j = contact.j * b;
      const auto distance = [&](std::span<const double> x) {
        return equidem::norm(Vec2{x[j] - x[i], x[j + 1] - x[i + 1]});
      };
      const auto force = [&](const PreciseMotion& m, const std::optional<Tensor2>& gradient) {
        const auto f = linear_spring_force(springs_[c], deformation_of(network, m, gradient, c));
        return std::abs(f.normal) + std::abs(f.tangential);
      };
      work += rounding * normal_rounding(assembly_, contact) *
              (distance(motion.high) * force(other, {}) + distance(v) * force(motion, given.gradient));
    }
    return std::array{work};
  })[0];
}

std::vector<double> StiffnessSolver::row_sums() const {
  return equidem::row_sums({assembly_, graph_, springs_, unknowns_});
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
