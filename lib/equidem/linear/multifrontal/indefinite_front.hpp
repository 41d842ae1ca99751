// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Partial L D L^T factorization of one dense front with threshold pivoting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace equidem {

/// A symmetric front: lower triangle, column-major, leading dimension `size`. Its first `candidates` rows are fully
/// summed: pivots are chosen among them.
struct IndefiniteFront {
  std::size_t size = 0;
  std::size_t candidates = 0;
  double* values = nullptr;
  std::vector<std::int64_t> ids;  ///< what each row stands for; permuted along with the rows
};

/// The pivots of a front in the order of elimination. Column p of L (unit diagonal) is left in column p of the front.
struct FrontPivots {
  std::size_t count = 0;
  std::vector<double> diagonal;      ///< D_pp
  std::vector<double> off_diagonal;  ///< D_p+1,p where p opens a 2 x 2 pivot, else 0
  double growth = 0;                 ///< largest |L_ij|
};

/// Eliminate candidates one or two at a time (Duff & Reid 1983; Ashcraft, Grimes & Lewis 1998): a 1 x 1 pivot d is
/// taken where |d| >= u max |column|, a 2 x 2 pivot D where |D^-1| |columns| <= 1/u, so that |L_ij| <= 1/u.
/// Candidates that pass neither test stay behind, after the pivots, for a later front. Entries at or below `zero`
/// count as zero. The rows that are left are updated: the Schur complement stands in rows and columns count ..
/// size.
/// \param u threshold, in (0, 1/2]
FrontPivots factorize_indefinite(IndefiniteFront& front, double u, double zero);

}  // namespace equidem
