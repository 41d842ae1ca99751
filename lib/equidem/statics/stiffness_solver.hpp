// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The factorized stiffness matrix of an assembly, solved and refined against the contact law for any right-hand sides.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {

/// Right-hand side: loads on discs, prescribed motions of held components, a mean strain.
struct RightHandSide {
  std::vector<double> force;          ///< per component, N/m (moments over a); empty: none
  std::vector<double> prescribed;     ///< per component, m, read where held; empty: held at 0
  std::optional<Tensor2> gradient{};  ///< of the mean displacement: all contacts deform by it beside the motion
};

/// The motion that balances one right-hand side.
struct Solution {
  PreciseMotion motion{0};
  double residual = 0;  ///< |f - f_int|, 2-norm over the unknowns, N/m
  double scale = 0;  ///< N/m, reference of relative residuals: |f| with prescribed motions and the mean strain included
  int refinements = 0;
  /// e.K e of the error e of the motion, N, estimated from the iterations; 0 where the method is direct.
  double energy_error = 0;

  [[nodiscard]] double relative_residual() const { return scale > 0 ? residual / scale : 0.0; }
};

/// Rounding error of the unit normal of a contact over 2^-52: of its division and, across a period, of the sum that
/// its branch is.
double normal_rounding(const Assembly& assembly, const Contact& contact);

/// A motion of least resistance.
struct SoftestMotion {
  double inverse_norm =
      0;  ///< 1/Pa, |K^-1| (2-norm) as this motion shows it: a lower bound, mostly within a factor of 2
  std::vector<double> motion;  ///< per component, a unit vector; empty where nothing is free
};

class StiffnessSolver {
 public:
  /// Order, analyze, assemble and factorize. The assembly and the springs must outlive this object.
  /// \throws Error (computation_failed) where the factor would not fit into memory or K is singular to working
  ///         precision;
  ///         (bad_input) naming a mechanism, unless mechanisms are held
  StiffnessSolver(const Assembly& assembly, const ContactSprings& springs, ContactGraph graph,
                  DegreesOfFreedom unknowns, const SolverOptions& options, Mechanisms mechanisms, StageTimes& times);
  StiffnessSolver(const StiffnessSolver&) = delete;  // the factorization may refer to members
  StiffnessSolver& operator=(const StiffnessSolver&) = delete;

  /// One thread at a time may call it: where iterations that "auto" chose fail, K is factorized.
  /// \param times gets "solve" and "refine"
  /// \throws Error (computation_failed) where the residual shows that K is too near to singular, or numbers overflow
  [[nodiscard]] std::vector<Solution> solve(std::span<const RightHandSide> cases, StageTimes& times) const;

  /// Residual of the motion rounded to doubles, N/m.
  [[nodiscard]] double rounded_residual(const RightHandSide& given, const PreciseMotion& motion) const;
  /// Deformation of a contact, that by the mean strain included, and the rotations of its discs.
  [[nodiscard]] ContactMotion contact_motion(const RightHandSide& given, const PreciseMotion& motion,
                                             std::size_t contact) const;
  /// By inverse iteration from `start` (empty: from a fixed rough vector), which finds the softest motion that
  /// `start` has a part in.
  [[nodiscard]] SoftestMotion softest_motion(std::span<const double> start = {}) const;
  /// The following two measure each component by its row of K, D = diag(sum_j |K_ij|), so that soft rotations beside
  /// stiff translations (small kT) are no errors: |D^-1/2 K D^-1/2| <= 1, and the energy of what a motion misses is
  /// at most scaled_residual² scaled_inverse_norm. |D^-1/2 (f - f_int)|, square root of N.
  [[nodiscard]] double scaled_residual(const RightHandSide& given, const PreciseMotion& motion) const;
  /// The largest of several solutions as above, or where rows are alike (within a factor of 100) a bound on it: the
  /// residual over the root of the smallest row.
  [[nodiscard]] double scaled_residual_bound(std::span<const RightHandSide> cases,
                                             std::span<const Solution> solutions) const;
  /// |D^1/2 K^-1 D^1/2| as softest_motion finds it: a lower bound, mostly within a factor of 2; 0 where nothing is
  /// free.
  [[nodiscard]] double scaled_inverse_norm(std::span<const double> start) const;
  /// Bound on |v^T dK u|, N, where the normals of contacts are wrong by their rounding (normal_rounding): what
  /// rounding of the geometry does to the motion u along v.
  [[nodiscard]] double rounding_work(const RightHandSide& given, const PreciseMotion& motion,
                                     std::span<const double> v) const;
  /// x.K x, N, of a motion given per component.
  [[nodiscard]] double twice_energy(std::span<const double> x) const;
  /// |K| (largest sum of the magnitudes of a row), Pa.
  [[nodiscard]] double norm() const;
  [[nodiscard]] const ContactGraph& graph() const { return graph_; }
  [[nodiscard]] const DegreesOfFreedom& unknowns() const { return unknowns_; }
  [[nodiscard]] const Factorization& factor() const { return *factor_; }
  /// The fronts of the factor; null where the method is iterative.
  [[nodiscard]] const std::shared_ptr<const SymbolicFactor>& symbolic() const { return symbolic_; }
  /// Name of the method, with the reason where "auto" went from iterations to elimination.
  [[nodiscard]] std::string solver_name() const;
  /// Whether the method is iterative: solutions come with an estimate of their error.
  [[nodiscard]] bool iterative() const { return entry_of(method_).back_end.iterative; }
  /// Negative eigenvalues beyond those that rotations bring by themselves where kT < 0; -1: not known.
  [[nodiscard]] std::int64_t unstable_modes() const { return unstable_modes_; }

 private:
  struct Refinement;
  /// Adds the solutions of the cases, with the factor at hand.
  void refine(std::span<const RightHandSide> cases, std::vector<Solution>& solutions, StageTimes& times) const;
  void iterate(SolverMethod method, StageTimes& times) const;
  void eliminate(SolverMethod method, StageTimes& times) const;
  /// Where iterations that "auto" chose failed. \throws the error itself where it is no failed computation
  void eliminate_instead(const Error& error, StageTimes& times) const;
  [[nodiscard]] System system() const;
  void judge_inertia();
  /// Inverse iteration for |S K^-1 S|, S = diag(scale), the unit matrix where `scale` is empty: the motion is S^-1 x
  /// for the unit vector x that it ends with.
  [[nodiscard]] SoftestMotion iterate_inverse(std::span<const double> start, std::vector<double> scale) const;
  void evaluate_residual(const RightHandSide& given, const PreciseMotion& motion, std::span<double> residual) const;
  /// sum_j |K_ij| of every row, Pa.
  [[nodiscard]] std::vector<double> row_sums() const;
  [[nodiscard]] double norm_of_free(std::span<const double> x) const;

  const Assembly& assembly_;
  const ContactSprings& springs_;
  ContactGraph graph_;
  DegreesOfFreedom unknowns_;
  SolverOptions options_;
  Mechanisms mechanisms_;
  mutable StiffnessMatrix matrix_;  // empty where iterations do without it
  MatrixOnGraph on_graph_;
  mutable std::shared_ptr<const SymbolicFactor> symbolic_;
  mutable SolverMethod method_ = SolverMethod::multifrontal;
  mutable std::string why_method_;  // why iterations that "auto" chose failed
  mutable std::unique_ptr<Factorization> factor_;
  std::int64_t unstable_modes_ = 0;
};

}  // namespace equidem
