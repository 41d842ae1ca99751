// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The damped oscillator g'' + 2 zeta g' + g = 0, g(0) = 0, g'(0) = 1, and its integrals, to round-off for every
/// damping and time.
#pragma once

namespace equidem {

/// Values at one time x.
struct Response {
  double slope = 1;  ///< g'
  double g[5] = {};  ///< g[k]: the k-fold integral of g from 0
};

/// \param zeta >= 0; neither zeta = 1 nor its neighbourhood is special
/// \param x >= 0
Response response(double zeta, double x);

/// Integrals from 0 to x of g'², g², g[1]², 2 g' g, 2 g' g[1], 2 g g[1].
struct ResponseProducts {
  double of[6] = {};
};

ResponseProducts products_of_response(double zeta, double x);

}  // namespace equidem
