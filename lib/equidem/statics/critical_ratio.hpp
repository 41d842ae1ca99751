// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The ratio kT/kN at which an assembly with its supports loses stability.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem {

/// A stiffness matrix K(s) = A + s B on the unknowns of an assembly, factorized by L D L^T, which counts its negative
/// eigenvalues.
class StiffnessPencil {
 public:
  /// \param held springs by which motions that nothing resists are found, and held; null: none are
  /// \param threshold of pivots (IndefiniteOptions)
  StiffnessPencil(const Assembly& assembly, DegreesOfFreedom unknowns, const ContactSprings* held, double threshold);
  virtual ~StiffnessPencil() = default;
  StiffnessPencil(const StiffnessPencil&) = delete;
  StiffnessPencil& operator=(const StiffnessPencil&) = delete;

  [[nodiscard]] std::int64_t factorizations() const { return factorizations_; }
  /// A pseudo-random motion, 0 where held: the same for the same unknowns.
  [[nodiscard]] std::vector<double> random_motion() const;
  /// The eigenvalue v of A x = -v B x nearest to a shift, by inverse iteration from x, which becomes its vector; NaN
  /// where it does not settle.
  double nearest(double shift, std::vector<double>& x);

 protected:
  [[nodiscard]] virtual StiffnessMatrix stiffness(double s) const = 0;
  [[nodiscard]] virtual StiffnessMatrix slope(const StiffnessMatrix& a) const = 0;  // B
  /// v = -x.A x/x.B x (Rayleigh): it errs by the square of the error of x.
  [[nodiscard]] virtual double quotient(const StiffnessMatrix& a, const StiffnessMatrix& b,
                                        const std::vector<double>& x) const;
  /// Whether a value and the one before are alike.
  [[nodiscard]] virtual bool settled(double value, double before) const = 0;
  std::unique_ptr<Factorization> factorize(double s);
  void clear_held(std::vector<double>& x) const;
  /// M x, 0 where held.
  [[nodiscard]] std::vector<double> product(const StiffnessMatrix& m, const std::vector<double>& x) const;

  const Assembly& assembly_;
  ContactGraph graph_;
  DegreesOfFreedom unknowns_;
  std::shared_ptr<const SymbolicFactor> symbolic_;

 private:
  double threshold_;
  std::int64_t factorizations_ = 0;
};

struct CriticalRatioOptions {
  double lowest = -1;           ///< where the search ends, in [-1, 0)
  double tolerance = 1e-10;     ///< width of the interval that is left, in [1e-12, 1)
  bool rotation = true;         ///< free; else restrained
  bool antiperiodic_x = false;  ///< of a periodic cell: motions that change sign from one period to the next along x
  bool antiperiodic_y = false;
  bool derivatives = false;  ///< by the springs
};

/// Result of the search.
struct CriticalRatio {
  double ratio = 0;             ///< negative infinity: stable down to `lowest`; 0: for no kT < 0
  std::int64_t mechanisms = 0;  ///< motions that resist for no ratio, beside those held: they are left out
  std::int64_t factorizations = 0;
  /// The unstable motion, per disc, not normalized; empty where the value was found by bisection.
  std::vector<DiscMotion> motion;
  /// Per contact, 1/Pa, with kT = r kN: where they are asked for and one motion alone loses stability at r. Else empty.
  std::vector<double> by_kN;
};

/// The ratio r_c < 0 below which the assembly is unstable in statics where contacts have kT = r kN: the stiffness with
/// rotations eliminated is linear in r, S = K_N + r S_T with S_T >= 0, so that S loses definiteness once and for good
/// as r falls. The number of negative eigenvalues of K beyond those of the rotations brackets r_c; inverse iteration on
/// the pencil K_N x = -r K_T x from the stable end of the bracket then converges to r_c, which is nearest to it; two
/// more factorizations beside the value prove it. Rigid motions and gears that nothing resists are held, in a periodic
/// cell the translations; other mechanisms are counted as they are at r = 1.
/// \param springs kN of every contact; where some kT are zero and others are not, the former have none for any r
///
/// With the stretches n and slips s of the motion that is lost, r changes with the springs by
///
///   dr/dkN = -(n² + r s²)/sum kN s².
///
/// \throws Error (bad_input) on options out of range, on contacts off the lines of centres, as number_unknowns does;
///         (computation_failed) where K cannot be factorized
CriticalRatio find_critical_ratio(const Assembly& assembly, const ContactSprings& springs,
                                  std::span<const Support> supports, const CriticalRatioOptions& options = {});

}  // namespace equidem
