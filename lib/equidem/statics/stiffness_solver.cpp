// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/stiffness_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"

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
  const BackEnd& back_end = entry_of(options.method).back_end;
  std::shared_ptr<const SymbolicFactor> symbolic;
  if (!back_end.iterative) {
    DissectionTree tree = dissect(assembly, graph_);
    times.add("order", watch.lap());
    symbolic = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph_, unknowns_.per_disc));
    times.add("analyze", watch.lap());
  }
  SolveEstimate size =
      symbolic ? estimate(*symbolic, unknowns_, springs.any_negative()) : estimate_iterations(assembly, unknowns_);
  size.peak_bytes *= back_end.memory_factor;
  check_memory(size, options.memory_limit);
  watch.lap();
  if (!back_end.iterative) {
    matrix_ = assemble_stiffness(assembly, graph_, springs, unknowns_);
    times.add("assemble", watch.lap());
  }
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
/// Round-off of the factor hides the softest motions first, of which a correction then brings only a part, and always
/// the same one: where corrections shrink slowly, each is scaled to the least energy, u := u + (d.r / d.K d) d, which
/// brings all of one such motion.
struct StiffnessSolver::Refinement {
  const StiffnessSolver& solver;
  const RightHandSide& given;
  Solution solution;
  PreciseMotion previous{0};
  bool done = false;
  int corrections = 0;
  double last_step = 0;  ///< size of the last correction, m

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

  /// Add the correction by the factorization, and replace it by the new residual.
  void correct(std::span<double> x, int pass) {
    const double good_enough = entry_of(solver.options_.method).back_end.good_enough;
    constexpr double slow = 0.05;  // share of the error that a pass leaves
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (solver.unknowns_.held[k] != 0) x[k] = 0;
    }
    const double step = solver.norm_of_free(x);
    const bool scaled = pass > 0 && step > slow * last_step && scale_to_least_energy(x);
    last_step = step;
    ++corrections;
    if (pass > 0) previous = solution.motion;
    solution.motion.add(x);
    const double before = solution.residual;
    const double now = evaluate(x);
    if (pass > 0 && !scaled && !(now < before)) {  // no better: keep the previous motion
      solution.motion = std::move(previous);
      done = true;
      return;
    }
    previous = PreciseMotion(0);
    solution.residual = now;
    solution.refinements = pass;
    done = now <= good_enough * solution.scale || (pass > 0 && !scaled && now > 0.5 * before);
  }

  Solution finish() {
    constexpr double worthless = 1e-3;
    const double relative = solution.relative_residual();
    if (!std::isfinite(relative)) {
      bad_input("the numbers of this case overflow a double", fmt::format("the residual comes out as {}", relative),
                "Check the units of sizes, springs and loads");
    }
    if (!(relative <= worthless)) {
      computation_failed(fmt::format("the solution leaves a relative residual of {:.1e}", relative), too_soft, remedy);
    }
    const double size = std::hypot(norm_of(solution.motion.high), imposed_length());
    if (corrections > 1 && relative > 0 && !(last_step <= worthless * size)) {
      computation_failed(fmt::format("the last of {} refinements still changed the motions by {:.1e} of their size",
                                     corrections - 1, last_step / size),
                         too_soft, remedy);
    }
    return std::move(solution);
  }

 private:
  static constexpr const char* too_soft = "the stiffness matrix is too close to singular for the digits of a double";
  static constexpr const char* remedy =
      "Hold a slender assembly in more places, make springs less different in size, or use fewer "
      "discs";

  double evaluate(std::span<double> residual) const {
    solver.evaluate_residual(given, solution.motion, residual);
    return solver.norm_of_free(residual);
  }

  /// x := (x.r / x.K x) x, the multiple of x at which the energy is stationary; false where there is none.
  bool scale_to_least_energy(std::span<double> x) const {
    std::vector<double> residual(x.size());
    evaluate(residual);
    long double work = 0;
    for (std::size_t k = 0; k < x.size(); ++k) work += static_cast<long double>(x[k]) * residual[k];
    const double factor = static_cast<double>(work) / solver.twice_energy(x);
    constexpr double most = 100;  // more: the motions of the factor are not those of K
    if (!(factor > 0 && factor < most)) return false;
    for (double& value : x) value *= factor;
    return true;
  }

  static double norm_of(const std::vector<double>& x) {
    double sum = 0;
    for (const double value : x) sum += value * value;
    return std::sqrt(sum);
  }

  [[nodiscard]] double imposed_length() const {
    double sum = 0;
    for (const ContactDeformation& d : given.imposed) sum += d.normal * d.normal + d.tangential * d.tangential;
    return std::sqrt(sum);
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
  return iterate_inverse(start, {});
}

double StiffnessSolver::scaled_inverse_norm(std::span<const double> start) const {
  std::vector<double> root = row_sums();
  for (double& value : root) value = std::sqrt(value);
  return iterate_inverse(start, std::move(root)).inverse_norm;
}

SoftestMotion StiffnessSolver::iterate_inverse(std::span<const double> start, std::vector<double> scale) const {
  const auto scale_of = [&](std::size_t k) {
    return unknowns_.held[k] != 0 ? 0.0 : scale.empty() ? 1.0 : scale[k];
  };
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
  // Round-off of the factor may make the motion stiffer than it is.
  const double stiffness = springs_.any_negative() ? 0 : twice_energy(x);
  if (stiffness > 0) result.inverse_norm = std::max(result.inverse_norm, 1 / stiffness);
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
      const auto force = [&](const PreciseMotion& m, std::span<const ContactDeformation> imposed) {
        const auto f = linear_spring_force(springs_[c], deformation_of(network, m, imposed, c));
        return std::abs(f.normal) + std::abs(f.tangential);
      };
      work += rounding * normal_rounding(assembly_, contact) *
              (distance(motion.high) * force(other, {}) + distance(v) * force(motion, given.imposed));
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
