// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Iterative refinement of one right-hand side against the contact law.
#pragma once

#include <span>
#include <vector>

#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

/// K d = f - f_int(u), u := u + d, until the residual no longer falls. The first pass is the solution itself; the
/// residual comes from the contact law, the motion is kept to twice the digits.
///
/// Round-off of a factor in double precision hides the softest motions first, of which a correction then brings only a
/// part, and always the same one: where corrections shrink slowly, each is scaled to the least energy,
/// u := u + (d.r / d.K d) d, which brings all of one such motion.
///
/// Where the rounding of extended precision could leave a residual that counts, contacts are evaluated in quadruple
/// precision.
struct StiffnessSolver::Refinement {
  const StiffnessSolver& solver;
  const RightHandSide& given;
  double good_enough;
  Solution solution;
  bool done = false;
  Factorization::Energies energies{};  ///< of the correction that comes next, where the method is iterative

  /// \param residual becomes f - f_int of the start, in which held components move and no other
  Refinement(const StiffnessSolver& solver, const RightHandSide& given, std::span<double> residual, double good_enough);

  /// Adds the correction x, which a pass with the factor made of the residual, and replaces x by the new residual.
  void correct(std::span<double> x, int pass);

  /// Solves for the residual x to a relative accuracy in the norm of energy, and ends there. x becomes the residual.
  void solve_to(double accuracy, std::span<double> x);

  /// \throws Error where the solution is worth nothing
  Solution finish();

 private:
  void add_correction(std::span<double> x, int pass);
  double evaluate(std::span<double> residual) const;
  [[nodiscard]] double rounding_of_forces() const;
  bool scale_to_least_energy(std::span<double> x) const;
  [[nodiscard]] double affine_length() const;
  [[nodiscard]] double affine_force() const;
  template <typename Square>
  [[nodiscard]] double norm_of_affine(const Square& square) const;

  PreciseMotion previous_{0};
  int corrections_ = 0;
  double last_step_ = 0;  // size of the last correction, m
};

}  // namespace equidem
