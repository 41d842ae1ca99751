// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Unsymmetric LU factorization by UMFPACK (Davis 2004), for matrices that are not positive definite.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <span>

#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

/// P K Q = L U over the components that are not held, with threshold partial pivoting (|L_ij| <= 10) and an ordering
/// of UMFPACK's own: any K that is not singular. Symmetry is not used, so that time and memory are about twice those
/// of a symmetric factorization, and the inertia stays unknown. Returns a null pointer where a
/// pivot is zero; a singular K may also end in one near round-off: the report's smallest_pivot, here over the largest
/// entry of its column, shows it. Held components are solved as rows of a unit matrix times the largest spring.
/// \throws Error (computation_failed) where memory does not suffice or UMFPACK fails
std::unique_ptr<Factorization> umfpack_lu(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns);

/// All entries of a matrix that need not be symmetric, over the components of its columns. As above, but for the rows
/// of components that are held, which are those of a unit matrix times `held_stiffness`.
std::unique_ptr<Factorization> umfpack_lu(CompressedColumns whole, double held_stiffness);

/// The factors of a complex matrix.
struct ComplexLu {
  double bytes = 0;
  /// x := K^-1 x over discs x block components; 0 where held.
  std::function<void(std::span<std::complex<double>> x)> solve = [](auto) {};
};
/// P K Q = L U of the complex symmetric matrix K = storage + i loss.
/// \param storage lower triangle of the real part
/// \param loss likewise of the imaginary part, on the same rows and columns
/// \throws Error (computation_failed) where K is singular, memory does not suffice or UMFPACK fails
ComplexLu umfpack_complex_lu(const CompressedColumns& storage, const CompressedColumns& loss);

}  // namespace equidem
