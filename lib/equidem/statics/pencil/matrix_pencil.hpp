// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Eigenvalues of pencils A x = -v B x of two matrices on the contacts of an assembly, for critical ratios and loads.
#pragma once

#include <functional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/degrees_of_freedom.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

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

}  // namespace equidem
