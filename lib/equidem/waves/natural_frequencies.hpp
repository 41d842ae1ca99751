// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The lowest natural frequencies of an assembly.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/statics/adjoint.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

struct NaturalFrequencyOptions {
  int count = 4;            ///< lowest frequencies, >= 1
  double tolerance = 1e-6;  ///< of the error bound of omega², relative, > 0
  SolverOptions solver = {};
  /// Components of motion, held ones included, up to which the whole spectrum is computed; that of few more is, too.
  std::size_t dense_limit = 150;
  bool derivatives = false;  ///< of the frequencies by springs; one more is computed, to part the last from the next
};

/// Derivatives of omega, rad/s over the unit of the parameter; forces at rest stay what they are.
struct FrequencyDerivatives : SpringAndPlaceDerivatives {
  /// Frequencies that coincide, within 1e-6 of omega² or as far as the error bounds part them, have no derivatives:
  /// the lists are empty.
  bool simple = false;
  /// The sum over contacts of the errors of k domega/dk is at most about this share of omega.
  double error = 0;
};

/// The lowest eigenvalues of K x = omega² M x above those of zero-energy modes, ascending.
struct NaturalFrequencies {
  std::vector<double> squared;  ///< omega², (rad/s)²; fewer than asked for where the assembly has no more
  /// (rad/s)²: some omega² of the assembly lies within this of `squared`, which is never below the true one of its
  /// place.
  std::vector<double> error_bounds;
  std::vector<std::vector<DiscMotion>>
      motions;  ///< of all discs, with a modal mass sum m u² + I theta² of 1 kg (per metre)
  std::vector<FrequencyDerivatives> derivatives = {};  ///< of each, where they are asked for
  bool converged = false;                              ///< to the tolerance
  std::int64_t zero_energy_modes = 0;                  ///< rigid motions and mechanisms, with the frequency 0
  std::string why_none;                                ///< why there are none; empty where they were sought
  std::string solver;                                  ///< of the inverse
  int iterations = 0;                                  ///< 0: the whole spectrum was computed
};

/// Vectors that the search for the lowest eigenvalues keeps, those of zero-energy modes aside.
constexpr double vectors_of_frequencies(double sought) {
  return 5 * sought + 40;
}

/// Expects no negative spring. Zero-energy modes are those that hold_free_motions finds and those of zero pivots.
/// \param unknowns of the assembly with its supports; in a periodic cell the motions repeat with it
/// \throws Error of kind interrupted
NaturalFrequencies natural_frequencies(const Assembly& assembly, const ContactSprings& springs,
                                       const DegreesOfFreedom& unknowns, const std::vector<Inertia>& inertia,
                                       const NaturalFrequencyOptions& options = {});

}  // namespace equidem
