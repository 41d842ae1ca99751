// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The multigrid cycle in single precision, an approximate inverse of the stiffness matrix of an assembly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/multigrid/block_matrix.hpp"
#include "equidem/linear/multigrid/grid.hpp"
#include "equidem/linear/multigrid/grouped_rows.hpp"
#include "equidem/linear/multigrid/transfer.hpp"

namespace equidem::multigrid {

/// Rows in chunks, each of which takes a number of steps in turn. A chunk follows as soon as the chunks that it reads
/// have taken the step before, while its rows are still in the cache (Wellein et al. 2009). The structure of the matrix
/// must be symmetric: then two vectors serve all steps, of which step s reads the one and writes the other.
class Wavefront {
 public:
  Wavefront() = default;
  /// \param first_row of each chunk, and their number at the end
  Wavefront(std::vector<std::int32_t> first_row, const GroupedRows& matrix);

  [[nodiscard]] std::size_t chunks() const { return neighbours_.size(); }
  [[nodiscard]] RowRange rows(std::size_t chunk) const {
    return {static_cast<std::size_t>(first_row_[chunk]), static_cast<std::size_t>(first_row_[chunk + 1])};
  }
  /// Call body(step, chunk) for every chunk and 0 <= step < steps, each once: after step 0 only once the chunks that it
  /// reads, itself included, have taken the step before. Which rows are written together does not depend on the number
  /// of threads.
  void run(int steps, const std::function<void(int step, std::size_t chunk)>& body) const;

 private:
  class Run;
  /// Chunks [first, last) that a chunk reads.
  struct Neighbours {
    std::int32_t first, last;
  };

  std::vector<std::int32_t> first_row_;
  std::vector<Neighbours> neighbours_;
  std::size_t farthest_ = 0;  ///< chunks from one to another that it reads
};

struct CycleOptions {
  double spacing = 3;      ///< of the nodes of the first grid, mean distances of discs in contact, > 0
  int degree = 5;          ///< products with the matrix before and after each coarse correction, >= 1
  double range = 15;       ///< largest over smallest eigenvalue that smoothing covers, > 1
  int direct_below = 200;  ///< discs that are solved for without a grid
};

/// V-cycle: smoothing, correction from the next coarser grid, smoothing (Brandt 1977). Symmetric and positive definite
/// but for rounding, the same bits for every number of threads.
class Cycle {
 public:
  Cycle(const SpringNetwork& network, const CycleOptions& options);
  /// The disc of each row.
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  /// Where the right-hand side is written, by rows; 0 where held.
  [[nodiscard]] Quad* right_hand_side() { return levels_[0].b.data(); }
  /// \returns an approximation of K^-1 times the right-hand side and the unit of stiffness, by rows; valid until the
  ///          next call
  const Quad* solve();
  /// q = K p over the unit of stiffness in double precision, rows x 3; returns p.q.
  /// \param p 0 where held; has one number more behind the last row
  double multiply(const double* p, double* q) const;
  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] double bytes() const;
  [[nodiscard]] std::int64_t grids() const { return static_cast<std::int64_t>(levels_.size()) - 1; }

 private:
  struct Level {
    std::unique_ptr<GroupedRows> matrix = nullptr;  // none on the coarsest level but the first
    std::unique_ptr<Grid> grid = nullptr;           // above; none on the coarsest level
    std::unique_ptr<Transfer> transfer = nullptr;   // to that grid
    Wavefront wavefront{};                          // over the chunks of the transfer
    std::vector<ChebyshevStep> before{}, after{};   // the coarse correction
    std::size_t rows = 0;
    QuadVector b{}, x{}, other{}, cells{};
  };
  void build_grids(const SpringNetwork& network, const CycleOptions& options);
  void correct(std::size_t number);

  double unit_;
  std::vector<std::int32_t> order_;
  std::vector<Level> levels_;
  EnvelopeCholesky coarsest_;
};

}  // namespace equidem::multigrid
