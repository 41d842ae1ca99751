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
#include "equidem/statics/rigidity.hpp"
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

/// The findings of a solver: properties of its matrix and of its factor.
struct SolverFindings {
  std::string solver;  ///< the back end and factorization used
  std::int64_t unknowns = 0;
  std::int64_t mechanisms = 0;                      ///< that are held: zero pivots of K
  std::optional<std::int64_t> negative_pivots = 0;  ///< negative eigenvalues of K (Sylvester's law); none: not counted
  /// Negative eigenvalues beyond those that the rotations bring by themselves where kT < 0 (one each): independent
  /// unstable motions. 0: the equilibrium is statically stable; none: the solver does not determine it.
  std::optional<std::int64_t> unstable_modes = 0;
  std::int64_t iterations = 0;  ///< of all passes together, where the method is iterative
  double pivot_growth = 0;      ///< largest |L_ij| of the factorization
  double factor_nonzeros = 0;   ///< entries of L
  double factor_bytes = 0;
};

/// A motion of least resistance.
struct SoftestMotion {
  double inverse_norm =
      0;  ///< 1/Pa, |K^-1| (2-norm) as this motion shows it: a lower bound, mostly within a factor of 2
  std::vector<double> motion;  ///< per component, a unit vector; empty where nothing is free
};

/// Threads may share one for its constant functions. The others use the factor, or replace it where iterations that
/// "auto" chose fail: one thread at a time.
class StiffnessSolver {
 public:
  /// Order, analyze, assemble and factorize. The assembly and the springs must outlive this object.
  /// \throws Error (out_of_memory) where the factor would not fit; (computation_failed) where K is singular to working
  ///         precision;
  ///         (bad_input) naming a mechanism, unless mechanisms are held
  StiffnessSolver(const Assembly& assembly, const ContactSprings& springs, ContactGraph graph,
                  DegreesOfFreedom unknowns, const SolverOptions& options, Mechanisms mechanisms, StageTimes& times);
  StiffnessSolver(const StiffnessSolver&) = delete;  // the factorization may refer to members
  StiffnessSolver& operator=(const StiffnessSolver&) = delete;

  /// \param times gets "solve" and "refine"
  /// \throws Error (computation_failed) where the residual shows that K is too near to singular, or numbers overflow
  [[nodiscard]] std::vector<Solution> solve(std::span<const RightHandSide> cases, StageTimes& times);

  /// Residual of the motion rounded to doubles, N/m.
  [[nodiscard]] double rounded_residual(const RightHandSide& given, const PreciseMotion& motion) const;
  /// Deformation of a contact, that by the mean strain included, and the rotations of its discs.
  [[nodiscard]] ContactMotion contact_motion(const RightHandSide& given, const PreciseMotion& motion,
                                             std::size_t contact) const;
  /// By inverse iteration from `start` (empty: from a fixed rough vector), which finds the softest motion that
  /// `start` has a part in.
  [[nodiscard]] SoftestMotion softest_motion(std::span<const double> start = {});
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
  [[nodiscard]] double scaled_inverse_norm(std::span<const double> start);
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
  [[nodiscard]] Factorization& factor() { return *factor_; }
  /// The fronts of the factor; null where the method is iterative.
  [[nodiscard]] const std::shared_ptr<const SymbolicFactor>& symbolic() const { return symbolic_; }
  /// Name of the method, with the reason where "auto" went from iterations to elimination.
  [[nodiscard]] std::string solver_name() const;
  /// As the solves so far leave them.
  [[nodiscard]] SolverFindings findings() const;
  /// A mechanism that is held and on which a load does work; none: there is no such one.
  /// \param force per component, N/m
  [[nodiscard]] std::optional<std::vector<double>> driven_mechanism(std::span<const double> force) const;
  /// The k-th mechanism that is held, in words.
  [[nodiscard]] std::string describe_mechanism(std::int64_t k) const;
  /// \param name of the network for the message: "the assembly"
  /// \throws Error (bad_input) where there are more than 1000 mechanisms
  void refuse_floppy(const std::string& name) const;
  /// Whether the method is iterative: solutions come with an estimate of their error.
  [[nodiscard]] bool iterative() const { return entry_of(method_).back_end.iterative; }
  /// Negative eigenvalues beyond those that rotations bring by themselves where kT < 0; none: not known.
  [[nodiscard]] std::optional<std::int64_t> unstable_modes() const { return unstable_modes_; }

 private:
  struct Refinement;
  /// Adds the solutions of the cases, with the factor at hand.
  void refine(std::span<const RightHandSide> cases, std::vector<Solution>& solutions, StageTimes& times);
  void iterate(SolverMethod method, StageTimes& times);
  void eliminate(SolverMethod method, StageTimes& times);
  /// Where iterations that "auto" chose failed. \throws the error itself where it is no failed computation
  void fall_back_to_elimination(const Error& error, StageTimes& times);
  [[nodiscard]] System system() const;
  [[nodiscard]] std::optional<std::int64_t> count_unstable_modes() const;
  /// Inverse iteration for |S K^-1 S|, S = diag(scale), the unit matrix where `scale` is empty: the motion is S^-1 x
  /// for the unit vector x that it ends with.
  [[nodiscard]] SoftestMotion iterate_inverse(std::span<const double> start, std::vector<double> scale);
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
  StiffnessMatrix matrix_;  // empty where iterations do without it
  MatrixOnGraph on_graph_;
  std::shared_ptr<const SymbolicFactor> symbolic_;
  SolverMethod method_ = SolverMethod::multifrontal;
  std::string why_method_;  // why iterations that "auto" chose failed
  std::unique_ptr<Factorization> factor_;
  std::optional<std::int64_t> unstable_modes_;
};

}  // namespace equidem
