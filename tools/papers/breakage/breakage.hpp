// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Curves of breakage beside theory: strength against the length of a notch, scatter and size by Weibull.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/core/statistics.hpp"

#include "papers.hpp"

namespace equidem::breakage {

/// The share of the peak to which the load falls, at which tests are over; of plates with scattered strengths.
inline constexpr double test_over = 0.9, scattered_test_over = 0.7;

/// A plate of equal strengths with a notch 2a in its middle.
struct NotchedPlate {
  std::int64_t columns = 0, discs = 0;
  double ratio = 0;      ///< kT/kN
  double notch = 0;      ///< 2a over the width
  double length = 0;     ///< 2a over the distance of neighbours
  double strength = 0;   ///< stress times this distance over f_t
  double toughness = 0;  ///< K_Ic times the root of this distance over f_t
  double energy_error = 0;
};

/// sigma sqrt(sec(pi a/W)) against a, over the plates of one lattice and size. The crack of a lattice ends between the
/// last contact that is cut and the first that is not: a half-length a + c of the continuum, with c found too.
struct NotchFit {
  std::int64_t columns = 0;
  double ratio = 0;
  double griffith = 0;  ///< the least toughness that the energy of the broken contacts allows
  double lattice = 0;   ///< toughness of the infinite lattice (lattice_toughness)
  double exponent = 0,
         exponent_error = 0;          ///< of a + c; standard errors, here and below, from the scatter about the fit
  double shift = 0, shift_error = 0;  ///< c over the distance of neighbours, where the exponent is -1/2
  double toughness = 0, toughness_error = 0;            ///< likewise
  double plain_exponent = 0, plain_exponent_error = 0;  ///< of a alone, over longer notches
};

/// Toughness K_Ic sqrt(d)/f_t of the infinite hexagonal lattice: K of the field of a crack around its tip (Williams
/// 1957) at which the first contact reaches f_t.
double lattice_toughness(double ratio, bool quick);

struct Notches {
  std::vector<NotchedPlate> plates;
  std::vector<NotchFit> fits;
  double seconds = 0;
};
Notches notched_plates(bool quick);

/// Samples of one size whose contacts scatter by Weibull's law.
struct WeibullSize {
  double modulus = 0;
  std::int64_t contacts = 0;
  MeanEstimate strength;  ///< over f_t of a chain; stress times the distance of neighbours over f_t of a plate
  double theory = 0;      ///< of a chain: Gamma(1 + 1/m) n^(-1/m)
  double energy_error = 0;
};

struct Weibull {
  std::vector<WeibullSize> chains, plates;
  std::int64_t seeds = 0;
  double seconds_of_chains = 0, seconds_of_plates = 0;
};
Weibull weibull_samples(bool quick);

}  // namespace equidem::breakage
