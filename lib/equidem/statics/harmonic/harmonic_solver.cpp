// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/harmonic/harmonic_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/choice/solver_choice.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {
namespace {

constexpr std::size_t numbers_at_once = 1 << 14;

StiffnessMatrixOf<Complex> complex_matrix(const StiffnessMatrix& storage, const StiffnessMatrix& loss) {
  StiffnessMatrixOf<Complex> result;
  result.block = storage.block;
  const auto combine = [](const auto& real, const auto& imaginary, auto& into) {
    into.resize(real.size());
    for (std::size_t e = 0; e < into.size(); ++e) into[e] = {real[e], imaginary[e]};
  };
  combine(storage.diagonal, loss.diagonal, result.diagonal);
  combine(storage.coupling, loss.coupling, result.coupling);
  return result;
}

double norm_of_amplitudes(std::span<const Complex> x) {
  return std::sqrt(sums_over<1>(x.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (const Complex& value : x.subspan(begin, end - begin)) sum += std::norm(value);
    return std::array{sum};
  })[0]);
}

void add_to(HarmonicMotion& motion, std::span<const Complex> x) {
  std::vector<double> part(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) part[k] = x[k].real();
  motion.in_phase.add(part);
  for (std::size_t k = 0; k < x.size(); ++k) part[k] = x[k].imag();
  motion.out_of_phase.add(part);
}

SolveEstimate estimate_complex(const SymbolicFactor& symbolic, const DegreesOfFreedom& unknowns) {
  SolveEstimate size = estimate(symbolic, unknowns, true);
  size.factor_bytes *= 2;  // numbers of two doubles
  size.peak_bytes *= 2;
  return size;
}

}  // namespace

SolveEstimate estimate_harmonic(const Assembly& assembly, const ContactSprings& springs, const Effects& effects) {
  const ContactGraph graph(assembly);
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, {});
  return estimate_complex(analyze(dissect(assembly, graph), graph, unknowns.per_disc), unknowns);
}

HarmonicSolver::HarmonicSolver(const SpringNetwork& geometry, const ComplexSprings& springs,
                               const std::shared_ptr<const SymbolicFactor>& symbolic, double memory_limit,
                               StageTimes& times)
    : geometry_(geometry), springs_(springs) {
  Stopwatch watch;
  check_memory(estimate_complex(*symbolic, geometry.unknowns), memory_limit);
  const auto& [assembly, graph, unused, unknowns] = geometry;
  const StiffnessMatrixOf<Complex> matrix =
      complex_matrix(assemble_stiffness(assembly, graph, springs.storage, unknowns),
                     assemble_stiffness(assembly, graph, springs.loss, unknowns));
  rows_ = row_sums(network(springs.storage));
  const std::vector<double> of_loss = row_sums(network(springs.loss));
  for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k] += of_loss[k];
  times.add("assemble", watch.lap());
  const MatrixOnGraphOf<Complex> on_graph{matrix, assembly, graph};
  factor_ = std::make_unique<LdltFactor<Complex>>(symbolic, on_graph, IndefiniteOptions{});
  times.add("factorize", watch.lap());
  if (factor_->report().zero_pivots > 0) {
    computation_failed(fmt::format("at this frequency {} of the stiffness matrix are lost in round-off",
                                   counted(factor_->report().zero_pivots, "pivot")),
                       "normal and tangential springs are too far apart for the digits of a double",
                       "Choose a frequency at which both are within a factor of 1e10 of each other");
  }
}

SpringNetwork HarmonicSolver::network(const ContactSprings& springs) const {
  return {geometry_.assembly, geometry_.graph, springs, geometry_.unknowns};
}

void HarmonicSolver::clear_held(std::span<Complex> x) const {
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (geometry_.unknowns.held[k] != 0) x[k] = 0;
  }
}

/// (K' + i K'')(x + i y) = K' x - K'' y + i (K' y + K'' x): four evaluations of the law of real springs. The mean
/// strain is in phase.
void HarmonicSolver::evaluate_residual(const Tensor2& gradient, const HarmonicMotion& motion,
                                       std::span<Complex> residual) const {
  std::vector<double> part(residual.size());
  const auto add = [&](const ContactSprings& springs, const PreciseMotion& moved,
                       const std::optional<Tensor2>& strained, Complex factor) {
    residual_force(network(springs), moved, strained, {}, part);
    for (std::size_t k = 0; k < part.size(); ++k) residual[k] += factor * part[k];
  };
  std::fill(residual.begin(), residual.end(), Complex(0));
  constexpr Complex i{0, 1};
  add(springs_.storage, motion.in_phase, gradient, 1);
  add(springs_.loss, motion.out_of_phase, {}, -1);
  add(springs_.storage, motion.out_of_phase, {}, i);
  add(springs_.loss, motion.in_phase, gradient, i);
}

double HarmonicSolver::affine_force(const Tensor2& gradient) const {
  const Assembly& assembly = geometry_.assembly;
  return std::sqrt(2 * sums_over<1>(assembly.contacts.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
                     double sum = 0;
                     for (std::size_t c = begin; c < end; ++c) {
                       const ContactDeformation d =
                           affine_deformation(frame_of(assembly, c), assembly.branch(assembly.contacts[c]), gradient);
                       const SpringConstantsOf<Complex> k = springs_of(c);
                       sum += std::norm(k.kN * d.normal) + std::norm(k.kT * d.tangential);
                     }
                     return std::array{sum};
                   })[0]);
}

void HarmonicSolver::refine(const Tensor2& gradient, int most, std::span<Complex> x, HarmonicMotion& motion) const {
  constexpr double good_enough = 1e-15;
  evaluate_residual(gradient, motion, x);
  motion.residual = norm_of_amplitudes(x);
  motion.scale = std::max(motion.residual, affine_force(gradient));
  for (int pass = 0; pass <= most && motion.residual > 0; ++pass) {
    factor_->solve(x, 1);
    clear_held(x);
    HarmonicMotion before;
    if (pass > 0) before = motion;
    add_to(motion, x);
    evaluate_residual(gradient, motion, x);
    const double last = motion.residual;
    motion.residual = norm_of_amplitudes(x);
    if (pass > 0 && !(motion.residual < last)) {  // no better: keep the previous motion
      motion = std::move(before);
      return;
    }
    if (motion.residual <= good_enough * motion.scale || (pass > 0 && motion.residual > 0.5 * last)) return;
  }
}

std::vector<HarmonicMotion> HarmonicSolver::solve(std::span<const Tensor2> gradients, int max_refinements,
                                                  StageTimes& times) const {
  constexpr double worthless = 1e-3;
  const Stopwatch watch;
  std::vector<HarmonicMotion> motions(gradients.size());
  std::vector<Complex> x(rows_.size());
  for (std::size_t k = 0; k < gradients.size(); ++k) {
    motions[k].in_phase = motions[k].out_of_phase = PreciseMotion(x.size());
    refine(gradients[k], max_refinements, x, motions[k]);
    const double relative = motions[k].relative_residual();
    if (relative <= worthless) continue;
    computation_failed(fmt::format("the solution leaves a relative residual of {:.1e}", relative),
                       "the complex stiffness matrix is too close to singular for the digits of a double",
                       "Choose another frequency, or springs less different in size");
  }
  times.add("solve", watch.seconds());
  return motions;
}

HarmonicDeformation HarmonicSolver::deformation(const Tensor2& gradient, const HarmonicMotion& motion,
                                                std::size_t contact) const {
  const ContactDeformation x = deformation_of(geometry_, motion.in_phase, gradient, contact);
  const ContactDeformation y = deformation_of(geometry_, motion.out_of_phase, {}, contact);
  return {{x.normal, y.normal}, {x.tangential, y.tangential}};
}

SpringConstantsOf<Complex> HarmonicSolver::springs_of(std::size_t contact) const {
  const SpringConstants storage = springs_.storage[contact], loss = springs_.loss[contact];
  return {{storage.kN, loss.kN}, {storage.kT, loss.kT}};
}

double HarmonicSolver::scaled_residual(const Tensor2& gradient, const HarmonicMotion& motion) const {
  std::vector<Complex> residual(rows_.size());
  evaluate_residual(gradient, motion, residual);
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (geometry_.unknowns.held[k] == 0) residual[k] /= std::sqrt(rows_[k]);
  }
  return norm_of_amplitudes(residual);
}

/// The matrix A = S K^-1 S, S = D^1/2, is symmetric: A^H x = conj(A conj(x)). Powers of A^H A grow by its squared norm.
double HarmonicSolver::scaled_inverse_norm(const HarmonicMotion& start) const {
  std::vector<Complex> x(rows_.size());
  const auto scale = [&] {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] *= geometry_.unknowns.held[k] != 0 ? 0.0 : std::sqrt(rows_[k]);
  };
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = {start.in_phase.high[k], start.out_of_phase.high[k]};
  scale();
  if (norm_of_amplitudes(x) == 0) std::ranges::generate(x, [n = 1u]() mutable { return 1.0 / n++; });
  double largest = 0;
  constexpr int passes = 4;
  for (int pass = 0; pass < passes; ++pass) {
    clear_held(x);
    const double size = norm_of_amplitudes(x);
    if (!(size > 0)) break;
    for (Complex& value : x) value /= size;
    if (pass % 2 == 1) std::ranges::transform(x, x.begin(), [](const Complex& value) { return std::conj(value); });
    scale();
    factor_->solve(x, 1);
    scale();
    if (pass % 2 == 1) std::ranges::transform(x, x.begin(), [](const Complex& value) { return std::conj(value); });
    largest = std::max(largest, norm_of_amplitudes(x));
  }
  return largest;
}

}  // namespace equidem
