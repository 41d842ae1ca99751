// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motions of an assembly with complex springs under mean strains that change as exp(i omega t), without inertia.
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/contact/complex_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/ldlt_factor.hpp"
#include "equidem/linear/spring_network.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {

using Complex = std::complex<double>;

/// Stretch and slip of a contact, complex amplitudes, m.
using HarmonicDeformation = DeformationOf<Complex>;

/// Complex amplitudes of the motion that balances one mean strain: `in_phase` + i `out_of_phase`.
struct HarmonicMotion {
  PreciseMotion in_phase{0}, out_of_phase{0};
  double residual = 0;  ///< 2-norm over the unknowns, N/m
  double scale = 0;     ///< N/m, reference of relative residuals: the forces that the mean strain causes by itself

  [[nodiscard]] double relative_residual() const { return scale > 0 ? residual / scale : 0.0; }
};

/// Size of the complex factor of an assembly without supports.
SolveEstimate estimate_harmonic(const Assembly& assembly, const ContactSprings& springs, const Effects& effects);

/// The matrix K = K' + i K'' of one frequency, factorized on the fronts of the elastic matrix: K is symmetric, not
/// Hermitian, and L D L^T goes without conjugation. All springs lie in one quarter of the complex plane, so that
/// exp(-i pi/4) K has a positive definite real part wherever no mechanism is, and K is singular for mechanisms alone.
class HarmonicSolver {
 public:
  /// \param geometry discs, contacts and unknowns, which hold all zero-energy modes; its springs are not used, and it
  ///        must outlive this object
  /// \param springs must outlive this object
  /// \throws Error (computation_failed) where K is singular, or the factor would not fit into memory
  HarmonicSolver(const SpringNetwork& geometry, const ComplexSprings& springs,
                 const std::shared_ptr<const SymbolicFactor>& symbolic, double memory_limit, StageTimes& times);

  /// Solves and refines against the contact law, evaluated in extended precision.
  /// \param gradients of the mean displacement
  [[nodiscard]] std::vector<HarmonicMotion> solve(std::span<const Tensor2> gradients, int max_refinements,
                                                  StageTimes& times) const;
  [[nodiscard]] HarmonicDeformation deformation(const Tensor2& gradient, const HarmonicMotion& motion,
                                                std::size_t contact) const;
  [[nodiscard]] SpringConstantsOf<Complex> springs_of(std::size_t contact) const;

  /// |D^-1/2 r|, square root of N, of the residual force r of a motion: D = diag(sum_j |K_ij|), of storage and loss.
  [[nodiscard]] double scaled_residual(const Tensor2& gradient, const HarmonicMotion& motion) const;
  /// |D^1/2 K^-1 D^1/2| by inverse iteration from `start`: a lower bound, mostly within a factor of 2.
  [[nodiscard]] double scaled_inverse_norm(const HarmonicMotion& start) const;
  [[nodiscard]] const FactorReport& report() const { return factor_->report(); }

 private:
  [[nodiscard]] SpringNetwork network(const ContactSprings& springs) const;
  /// -K (motion + mean strain) per component, 0 where held.
  void evaluate_residual(const Tensor2& gradient, const HarmonicMotion& motion, std::span<Complex> residual) const;
  void refine(const Tensor2& gradient, int most, std::span<Complex> x, HarmonicMotion& motion) const;
  [[nodiscard]] double affine_force(const Tensor2& gradient) const;
  void clear_held(std::span<Complex> x) const;

  const SpringNetwork& geometry_;
  const ComplexSprings& springs_;
  std::unique_ptr<LdltFactor<Complex>> factor_;
  std::vector<double> rows_;  // sum_j |K'_ij| + |K''_ij|, Pa
};

}  // namespace equidem
