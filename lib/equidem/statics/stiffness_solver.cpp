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
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/refinement.hpp"

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
  const SolverMethod method = choose_method(assembly_, springs_, options_);
  if (!entry_of(method).back_end.iterative) {
    eliminate(method, times);
  } else if (options.method == method) {
    iterate(method, times);
  } else {
    try {
      iterate(method, times);
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
  SolveEstimate size = estimate(*symbolic_, unknowns_, springs_.may_be_indefinite());
  size.peak_bytes *= memory_factor(method, options_.ordering);
  check_memory(size, options_.memory_limit);
  watch.lap();
  matrix_ = assemble_stiffness(assembly_, graph_, springs_, unknowns_);
  times.add("assemble", watch.lap());
  factor_ = factorize(system(), method, mechanisms_, times);
}

System StiffnessSolver::system() const {
  constexpr int given_up = 60;  // by "auto": elimination takes no longer
  const bool automatic = options_.method == SolverMethod::automatic;
  return {on_graph_, springs_, unknowns_, symbolic_, automatic ? given_up : most_iterations, options_};
}

std::string StiffnessSolver::solver_name() const {
  std::string name = factor_->report().name;
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

void StiffnessSolver::refine(std::span<const RightHandSide> cases, std::vector<Solution>& solutions,
                             StageTimes& times) const {
  const double good_enough = entry_of(method_).back_end.good_enough;
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
  for (int pass = 0; pass <= options_.max_refinements; ++pass) {
    std::vector<Refinement*> open;  // their residuals stand one after another at the front of x
    for (std::size_t k = 0; k < all.size(); ++k) {
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
  }
  for (Refinement& one : all) solutions.push_back(one.finish());
}

std::vector<Solution> StiffnessSolver::solve(std::span<const RightHandSide> cases, StageTimes& times) const {
  std::vector<Solution> solutions;
  const auto solve_all = [&] {
    // Iterations one after another: vectors of one case take as much memory as the grids.
    const std::size_t at_once = iterative() ? 1 : cases.size();
    for (std::size_t k = 0; k < cases.size(); k += at_once) refine(cases.subspan(k, at_once), solutions, times);
  };
  try {
    solve_all();
  } catch (const Error& error) {
    if (method_ == options_.method || !iterative()) throw;
    eliminate_instead(error, times);
    solutions.clear();
    solve_all();
  }
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
  // Round-off of the factor may make the motion stiffer than it is, and where the solutions are rough, softer, too. The
  // quotient of Rayleigh does not depend on them; for an exact factor it is at least the growth of the last pass.
  const double stiffness = springs_.may_be_indefinite() ? 0 : twice_energy(x);
  if (stiffness > 0) result.inverse_norm = std::max(iterative() ? 0.0 : result.inverse_norm, 1 / stiffness);
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
