// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The multigrid cycle in single precision, an approximate inverse of the stiffness matrix of an assembly.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/multigrid/block_matrix.hpp"
#include "equidem/linear/multigrid/envelope_cholesky.hpp"
#include "equidem/linear/multigrid/grid.hpp"
#include "equidem/linear/multigrid/transfer.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem::multigrid {

struct CycleOptions {
  double spacing = 2.5;    ///< of the nodes of the first grid, mean distances of discs in contact, > 0
  int degree = 3;          ///< products with the matrix before and after each coarse correction, >= 1
  double range = 8;        ///< largest over smallest eigenvalue that smoothing covers, > 1
  int direct_below = 200;  ///< discs that are solved for without a grid
  double coarse_factor =
      1;  ///< by which the matrix of the first grid is multiplied: only tests of a wrong one change it
};

/// V-cycle: smoothing, correction from the next coarser grid, smoothing (Brandt 1977). Symmetric and positive definite
/// but for rounding, the same bits for every number of threads.
class Cycle {
 public:
  Cycle(const MatrixOnGraph& k, const ContactSprings& springs, const DegreesOfFreedom& unknowns,
        const CycleOptions& options);
  /// z := an approximation of K^-1 r (over discs x block components; 0 where held), times a constant.
  void apply(std::span<const double> r, std::span<double> z);
  [[nodiscard]] double bytes() const;
  [[nodiscard]] std::int64_t grids() const { return static_cast<std::int64_t>(levels_.size()) - 1; }

 private:
  struct Level {
    BlockMatrix matrix;
    Smoother smoother;
    std::unique_ptr<Grid> grid = nullptr;          // above; none on the coarsest level
    std::unique_ptr<Transfer> transfer = nullptr;  // to that grid
    QuadVector b{}, x{}, step{}, next{}, cells{};
  };
  void build_grids(const MatrixOnGraph& k, const ContactSprings& springs, const CycleOptions& options);
  void correct(std::size_t level);

  const DegreesOfFreedom& unknowns_;
  std::vector<std::int32_t> order_;  // the disc of each row
  std::vector<Level> levels_;
  EnvelopeCholesky coarsest_;
};

}  // namespace equidem::multigrid
