// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Statistics of the moduli over an ensemble of random cells: mean, scatter, their dependence on size, the size needed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/core/statistics.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/ensemble/ensemble.hpp"

namespace equidem {

/// A quantity whose statistics are taken.
struct EnsembleQuantity {
  const char* name;    ///< as in tables
  const char* symbol;  ///< as in reports
  double EffectiveModuli::*value;
  bool modulus;  ///< in Pa; else a number
};

inline constexpr std::array ensemble_quantities{
    EnsembleQuantity{"bulk_modulus_2d", "K", &EffectiveModuli::bulk_modulus_2d, true},
    EnsembleQuantity{"shear_modulus", "G", &EffectiveModuli::shear_modulus, true},
    EnsembleQuantity{"poisson_ratio_plane_strain", "nu (plane strain)", &EffectiveModuli::poisson_strain, false},
    EnsembleQuantity{"poisson_ratio_plane_stress", "nu (plane stress)", &EffectiveModuli::poisson_stress, false},
    EnsembleQuantity{"young_modulus_plane_strain", "E (plane strain)", &EffectiveModuli::young_strain, true},
    EnsembleQuantity{"young_modulus_plane_stress", "E (plane stress)", &EffectiveModuli::young_stress, true},
    EnsembleQuantity{"anisotropy", "anisotropy", &EffectiveModuli::anisotropy, false},
};
/// One value for each of ensemble_quantities.
template <typename Value>
using PerQuantity = std::array<Value, ensemble_quantities.size()>;

/// Cells of one size.
struct EnsembleSize {
  std::int64_t discs = 0;  ///< wanted
  double mean_discs = 0;   ///< of the cells that have moduli; N below
  std::int64_t refused = 0;
  PerQuantity<MeanEstimate> estimates;
};

/// Dependence of one quantity on the number N of discs in a cell. Scatter: sd = amplitude N^-exponent; many independent
/// patches of a cell average as 1/sqrt(N) (Kanit et al. 2003). Drift: mean = limit + drift/N.
struct SizeDependence {
  bool scattered = false;    ///< false: all cells agree to round-off, or no size has two of them; nothing below is set
  double exponent = 0.5;     ///< 1/2, unless the one measured differs from it significantly
  double amplitude = 0;      ///< of the scatter
  std::int64_t freedom = 0;  ///< degrees of freedom of the amplitude: samples less sizes
  std::optional<double> measured_exponent;  ///< from two sizes on
  double exponent_error = 0;                ///< its standard error
  /// From two sizes on; its error is that of the limit, from the scatter above.
  std::optional<double> limit;
  double limit_error = 0;
  double drift = 0;
  double drift_error = 0;
  bool drifts = false;  ///< the drift is not 0 with the wanted confidence
};

struct EnsembleStatistics {
  double confidence = 0.95;
  std::vector<EnsembleSize> sizes;
  PerQuantity<SizeDependence> dependence;
};

/// \param confidence in (0, 1)
EnsembleStatistics analyze_ensemble(const EnsemblePlan& plan, const std::vector<EnsembleSample>& samples,
                                    double confidence);

/// Discs in a cell from which on the mean of `samples` cells misses the quantity of infinite cells by at most the
/// share `accuracy` of it, with the confidence of the statistics:
///
///   t amplitude N^-exponent / sqrt(samples) + |drift|/N <= accuracy |value|,
///
/// t Student's, the drift only where it is significant. At least the smallest size sampled: the scaling of smaller
/// ones is not known. Empty where a relative accuracy has no meaning: nothing was sampled, the value is 0 within its
/// error.
std::optional<std::int64_t> needed_discs(const EnsembleStatistics& statistics, std::size_t quantity, double accuracy,
                                         std::int64_t samples);

}  // namespace equidem
