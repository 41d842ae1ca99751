// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Wanted moduli -> contact springs of a given assembly.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/lattices/lattice.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/material/elastic_moduli.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

struct CalibrateOptions {
  /// Boundary::periodic is taken as displacement where the assembly is not periodic.
  HomogenizeOptions homogenize = {};
  SpringWeighting weighting = SpringWeighting::uniform;
  std::optional<double> bond_width = {};  ///< as BendingOptions: kM then follows kN; none: contacts carry no moments
  /// The assembly is a block of this lattice, of touching equal discs: equal springs are those of the infinite lattice
  /// in closed form. Null, or other weightings: springs are searched for.
  const Lattice* lattice = nullptr;
  bool static_only = false;  ///< kT < 0 allowed, down to the loss of stability
  double tolerance = 1e-11;  ///< relative, of the moduli reached, in [1e-14, 1e-2]
};

/// Springs that give an assembly the wanted moduli, and how well.
struct Calibration {
  SpringConstants springs;      ///< before weighting
  EffectiveStiffness achieved;  ///< with them; where not `verified` only its stiffness, that of the infinite lattice
  EffectiveModuli moduli;       ///< with them
  double relative_error = 0;    ///< larger of those of G and K
  bool verified = true;         ///< homogenized with these springs; false: closed form, on a block with free edges
  int factorizations = 0;       ///< all of them, those for the range included
  int iterations = 0;           ///< steps on kT/kN
  /// All G/K in between are shown by this assembly without negative springs, kT/kN <= 1e6; infinite where slip resists
  /// shear. `scanned`: and no others, else the values at the ends.
  double smallest_shear_to_bulk = 0;
  double largest_shear_to_bulk = std::numeric_limits<double>::infinity();
  bool scanned = false;  ///< all ratios were searched for the extremes of G/K, as find_by_scan
  bool rising = true;    ///< G/K rose with kT/kN at every ratio tried, as FoundRatio
  std::string method;    ///< "closed form, Abe 1996, eq. 34", "search on kT/kN"
  StageTimes times;      ///< of all factorizations

  /// Poisson's ratios without negative springs: (K - G)/(2K) or (K - G)/(K + G) at the ends, and at least -1, which
  /// no solid reaches.
  [[nodiscard]] double lowest_poisson_ratio(Plane plane) const;
  [[nodiscard]] double highest_poisson_ratio(Plane plane) const;
};

/// The Poisson's ratio wanted lies outside the range of the assembly: the range of G/K and `scanned` are found.
class InfeasibleModuli : public ErrorWith<Calibration> {
 public:
  InfeasibleModuli(const Error& error, Calibration range)
      : ErrorWith(Error(ErrorKind::computation_failed, error.problem(), error.why(), error.remedy(), error.where()),
                  std::move(range)) {}
};

/// The stiffness is C = kN c(r), r = kT/kN: Poisson's ratio, that is q = G/K, fixes r, then G fixes kN. Two
/// factorizations at the ends of the range of r, then about ten more (ratio_search.hpp); slopes dC/dr = C_T/r come from
/// the tangential strain energies C_T of EffectiveStiffness. Where q(r) does not rise at both
/// ends, and before nu is refused, the whole range is scanned, some twenty factorizations. G and K are those of the
/// nearest isotropic tensor.
///
/// On a lattice the springs are those of its relation. (34) of Abe 1996 also holds with rotation restrained: moduli are
/// read from the symmetric part of stress by strain, which is independent of the mean rotation; (53), the relation by
/// wave speeds and prescribed displacements, is springs_for(..., *Lattice::restrained). The square lattice can show nu
/// = 0 only.
/// \throws InfeasibleModuli where nu is out of the range of this assembly, with the range and the nearest feasible
///         value; ErrorWith<Calibration> where the search fails or the user asked to stop, with the springs nearest to
///         the target among those tried; Error (bad_input) for other nu than 0 on the square lattice; springs in the
///         assembly file; as effective_stiffness and springs_for; (computation_failed) as effective_stiffness; where
///         the tolerance is not reached
Calibration calibrate(const Assembly& assembly, const ElasticModuli& target, const CalibrateOptions& options = {});

/// The springs that the mean field of Abe (1996), eqs. (21) and (22), advises, and the moduli of the assembly with
/// them.
struct MeanFieldGuess {
  SpringConstants springs;                ///< before weighting
  std::optional<EffectiveModuli> moduli;  ///< by one factorization
  std::string missing;                    ///< why there are no such springs or moduli
};

/// For comparison with calibrate(): the guess that needs no search. None for lattices, whose relation is exact.
/// \throws Error (interrupted)
std::optional<MeanFieldGuess> mean_field_guess(const Assembly& assembly, const ElasticModuli& target,
                                               const CalibrateOptions& options = {});

}  // namespace equidem
