// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Several passes over the rows of a matrix in one pass over memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "equidem/linear/multigrid/grouped_rows.hpp"

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

}  // namespace equidem::multigrid
