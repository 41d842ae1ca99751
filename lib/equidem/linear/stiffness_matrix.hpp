// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The stiffness matrix of an assembly: a symmetric matrix of small blocks on the graph of discs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/large_buffer.hpp"

namespace equidem {

/// A symmetric matrix of small blocks on the graph of discs: K_dd for every disc d and K_ij for every contact (i, j);
/// K_ji is its transpose. Two discs that touch twice have two blocks, to be added. Unknowns are scaled (u_x, u_y, a
/// theta), entries in Pa.
struct StiffnessMatrix {
  int block = 2;                 ///< rows of a block: DegreesOfFreedom::per_disc
  LargeVector<double> diagonal;  ///< discs x block x block, row-major
  std::vector<double>
      coupling;  ///< contacts x block x block, row-major; zero for a contact of a disc with its own image

  [[nodiscard]] const double* diagonal_block(std::size_t disc) const { return &diagonal[disc * block * block]; }
  [[nodiscard]] const double* coupling_block(std::size_t contact) const { return &coupling[contact * block * block]; }
};

/// A matrix with its graph, as fronts are assembled from it.
struct MatrixOnGraph {
  const StiffnessMatrix& matrix;
  const Assembly& assembly;
  const ContactGraph& graph;
};

/// The diagonal entry of held components, Pa; 1 where none is held.
double held_stiffness(const StiffnessMatrix& matrix, const DegreesOfFreedom& unknowns);

/// y = K x; vectors hold discs x block components.
void multiply(const StiffnessMatrix& matrix, const Assembly& assembly, const ContactGraph& graph,
              std::span<const double> x, std::span<double> y);

/// The lower triangle of the matrix over the components that are not held, as sorted compressed columns.
struct CompressedColumns {
  std::int64_t size = 0;
  std::vector<std::int64_t> first;  ///< size + 1
  std::vector<std::int64_t> rows;
  std::vector<double> values;
  std::vector<std::int64_t> component;  ///< component (disc * block + k) of every column
};

/// \param order discs in the order in which columns are numbered; empty: as they are
CompressedColumns compress(const StiffnessMatrix& matrix, const Assembly& assembly, const ContactGraph& graph,
                           const DegreesOfFreedom& unknowns, std::span<const std::int32_t> order = {});

/// All entries of a symmetric matrix from its lower triangle. Columns of a symmetric matrix are its rows: `first`,
/// `rows` (then the columns of the entries) and `values` are the arrays of the CSR format as well.
CompressedColumns with_upper_triangle(const CompressedColumns& lower);

/// Motions of a periodic cell that change sign from one period to the next along an axis, exp(i q.L) = -1.
struct ImageSigns {
  bool change_along_x = false, change_along_y = false;

  /// 1, or -1 where the image of disc j that the contact joins moves against disc j.
  [[nodiscard]] double of(const Contact& contact) const {
    return (change_along_x && contact.shift_x % 2 != 0) != (change_along_y && contact.shift_y % 2 != 0) ? -1 : 1;
  }
};

/// The sum of ContactStiffness over contacts. Rows and columns of held components are those of a unit matrix times the
/// largest spring.
StiffnessMatrix assemble_stiffness(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                                   const DegreesOfFreedom& unknowns, const ImageSigns& signs = {});

/// sum_j |K_ij| of every row, Pa, without K itself.
std::vector<double> row_sums(const SpringNetwork& network);

}  // namespace equidem
