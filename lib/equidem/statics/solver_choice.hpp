// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Choice of a factorization by the options of the user, checks of its result, and the zero-energy modes of K.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/rigidity.hpp"

namespace equidem {

/// Everything a factorization is made from.
struct System {
  const MatrixOnGraph& k;
  const ContactSprings& springs;
  const DegreesOfFreedom& unknowns;
  std::shared_ptr<const SymbolicFactor> symbolic;  ///< null for iterative methods
  int max_iterations = most_iterations;            ///< after which an iterative method gives up
  SolverOptions options = {};                      ///< settings that back ends use
};

/// The method that the options name; where they leave it to "auto", multigrid for many discs that form no narrow strip
/// and are solved for a few load cases: elsewhere elimination is about as fast and finds more, pivots and mechanisms.
SolverMethod choose_method(const Assembly& assembly, const ContactSprings& springs, const SolverOptions& options);

/// Estimated cost of a solution.
struct SolveEstimate {
  SolverMethod method = SolverMethod::multifrontal;
  std::int64_t unknowns = 0;
  double factor_nonzeros = 0;  ///< entries of L
  double factor_bytes = 0;
  double peak_bytes = 0;  ///< factor and what lives beside it during factorization
  double operations = 0;  ///< additions and multiplications
};

/// The cost of a factorization. \param indefinite by L D L^T
SolveEstimate estimate(const SymbolicFactor& symbolic, const DegreesOfFreedom& unknowns, bool indefinite);
/// The cost of an iterative method.
SolveEstimate estimate_iterations(const Assembly& assembly, const DegreesOfFreedom& unknowns);

/// \throws Error (out_of_memory) where the estimated peak exceeds `memory_limit` bytes, or what the machine has
///         where it is 0
void check_memory(const SolveEstimate& estimate, double memory_limit);

/// Cholesky where no spring is negative, else L D L^T with delayed pivots, unless the user names a method. A
/// factorization that breaks down, or whose softest motion costs no energy, means a mechanism.
/// \throws Error (bad_input) naming the mechanism; (computation_failed) where the chosen method cannot factorize K, or
///         an apparent mechanism is none
std::unique_ptr<Factorization> factorize(const System& system, SolverMethod method, Mechanisms mechanisms,
                                         StageTimes& times);

/// A motion that elimination found to resist no more than round-off: a mechanism, or too soft for a double.
/// \throws Error (bad_input, computation_failed) that names it
[[noreturn]] void report_singular(const System& system, const std::vector<double>& softest);

/// Negative eigenvalues that the rotations bring by themselves: those of the rotational block of K (Haynsworth: the
/// inertia of K is that of this block and of the stiffness with rotations eliminated); none where the block is
/// singular.
std::optional<std::int64_t> negative_rotations(const System& system);

/// The zero-energy modes of a system beside those that its unknowns hold, one for each of `components`, in which no
/// other can move once these are held.
class ZeroEnergyModes {
 public:
  /// By L D L^T of equal springs, until the components held leave no mode. \param system without negative springs
  /// \throws Error (computation_failed) where contacts deform in a motion that resists no more than round-off, or
  ///         memory does not suffice
  explicit ZeroEnergyModes(const System& system);

  [[nodiscard]] const std::vector<std::size_t>& components() const { return components_; }
  /// The mode of `components()[k]`, per component and not normalized, to the rounding of a double: it is corrected by
  /// the forces that contacts still have.
  [[nodiscard]] std::vector<double> motion(std::size_t k) const;
  /// A copy of the unknowns of the system with `components()` held.
  [[nodiscard]] const DegreesOfFreedom& held_unknowns() const { return unknowns_; }

 private:
  /// A factorization, and the modes that it found: those of its zero pivots, or else the one of its softest pivot.
  struct Stage {
    DegreesOfFreedom unknowns;
    std::unique_ptr<Factorization> factor;
    std::size_t first = 0;
  };
  [[nodiscard]] std::vector<double> corrected(const Stage& stage, std::vector<double> motion) const;

  const Assembly& assembly_;
  const ContactGraph& graph_;
  ContactSprings equal_;
  DegreesOfFreedom unknowns_;
  std::vector<std::size_t> components_;
  std::vector<Stage> stages_;
};

/// Solves with a K that has zero-energy modes by holding one component for each. \param rest of K with these held
std::unique_ptr<Factorization> hold_modes(std::unique_ptr<Factorization> rest, ZeroEnergyModes modes);

/// Whether a load does work on a zero-energy mode: more than 1e-8 of the sizes of force and motion, disc by disc (those
/// of an angle of 1e-8 between them), and than 1e-12 of those of all, to which the mode is known where it should be at
/// rest. \param motion, force per component
bool does_work(std::span<const double> force, std::span<const double> motion, int per_disc);

}  // namespace equidem
