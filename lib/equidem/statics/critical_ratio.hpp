// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The ratio kT/kN at which an assembly with its supports loses stability.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

/// A pseudo-random motion, 0 where held: the same for the same unknowns.
std::vector<double> random_motion(const DegreesOfFreedom& unknowns);

/// The eigenvalue of A x = -v B x nearest to a shift, by inverse iteration from x, which becomes its vector; NaN where
/// it does not settle.
struct InverseIteration {
  const Assembly& assembly;
  const ContactGraph& graph;
  const DegreesOfFreedom& unknowns;
  const StiffnessMatrix& b;
  const Factorization& shifted;  ///< of A + shift B
  std::function<double(const std::vector<double>& x)>
      quotient;                                              ///< of Rayleigh: it errs by the square of the error of x
  std::function<bool(double value, double before)> settled;  ///< whether a value and the one before are alike

  double run(std::vector<double>& x) const;
};

/// The value v = -x.A x/x.B x, over the components that are not held.
double rayleigh_quotient(const Assembly& assembly, const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                         const StiffnessMatrix& a, const StiffnessMatrix& b, const std::vector<double>& x);

struct CriticalRatioOptions {
  double lowest = -1;           ///< where the search ends, in [-1, 0)
  double tolerance = 1e-10;     ///< width of the interval that is left, in [1e-12, 1)
  bool rotation = true;         ///< free; else restrained
  bool antiperiodic_x = false;  ///< of a periodic cell: motions that change sign from one period to the next along x
  bool antiperiodic_y = false;
};

/// Result of the search.
struct CriticalRatio {
  double ratio = 0;             ///< negative infinity: stable down to `lowest`; 0: for no kT < 0
  std::int64_t mechanisms = 0;  ///< motions that resist for no ratio, beside those held: they are left out
  std::int64_t factorizations = 0;
  /// The unstable motion, per disc, not normalized; empty where the value was found by bisection.
  std::vector<DiscMotion> motion;
};

/// The ratio r_c < 0 below which the assembly is unstable in statics where contacts have kT = r kN: the stiffness with
/// rotations eliminated is linear in r, S = K_N + r S_T with S_T >= 0, so that S loses definiteness once and for good
/// as r falls. The number of negative eigenvalues of K beyond those of the rotations brackets r_c; inverse iteration on
/// the pencil K_N x = -r K_T x from the stable end of the bracket then converges to r_c, which is nearest to it; two
/// more factorizations beside the value prove it. Rigid motions and gears that nothing resists are held, in a periodic
/// cell the translations; other mechanisms are counted as they are at r = 1.
/// \param springs kN of every contact; where some kT are zero and others are not, the former have none for any r
/// \throws Error (bad_input) on options out of range, on contacts off the lines of centres, as number_unknowns does;
///         (computation_failed) where K cannot be factorized
CriticalRatio find_critical_ratio(const Assembly& assembly, const ContactSprings& springs,
                                  std::span<const Support> supports, const CriticalRatioOptions& options = {});

/// As above, for equal springs.
double critical_ratio(const Assembly& assembly, std::span<const Support> supports,
                      const CriticalRatioOptions& options = {});

}  // namespace equidem
