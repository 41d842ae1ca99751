// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small dense Hermitian matrices, their spectra, and what is left of them for long waves.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

namespace equidem {

using Complex = std::complex<double>;

/// A square matrix, column by column.
struct ComplexMatrix {
  std::size_t size = 0;
  std::vector<Complex> entries;

  ComplexMatrix() = default;
  explicit ComplexMatrix(std::size_t n) : size(n), entries(n * n) {}
  Complex& operator()(std::size_t r, std::size_t c) { return entries[c * size + r]; }
  const Complex& operator()(std::size_t r, std::size_t c) const { return entries[c * size + r]; }
};

/// Eigenvalues, ascending, with orthonormal eigenvectors in the columns of `vectors`.
struct HermitianSpectrum {
  std::vector<double> values;
  ComplexMatrix vectors;
};
HermitianSpectrum spectrum(const ComplexMatrix& hermitian);
/// Eigenvalues alone, ascending.
std::vector<double> eigenvalues(const ComplexMatrix& hermitian);

/// A - B D^+ B^H for the matrix [A B; B^H D], positive semidefinite, of which A keeps the rows where `eliminated` is 0:
/// what is left of a stiffness once the eliminated motions are free to follow. D may be singular: its null vectors are
/// null vectors of B, too.
ComplexMatrix condense(const ComplexMatrix& matrix, const std::vector<char>& eliminated);

/// Largest lambda in [0, 1] with T v = lambda (N + T) v, for N and T positive semidefinite: the largest share of its
/// energy that a motion has in T. Motions without energy in either are left out; 0 where there is no other.
double largest_share(const ComplexMatrix& n, const ComplexMatrix& t);

/// Eigenvalues c² (ascending) of the waves that start at zero frequency, omega² = c² q² + O(q³), where the dynamic
/// matrix is D0 + q D1 + q² D2: second-order perturbation theory on the null space Z of D0,
///
///   H = Z^H (D2 - D1 D0^+ D1) Z,   Z^H D1 Z = 0
///
/// the latter because a zero-energy mode at q = 0 has a stiffness of O(q²) for small q. `vectors` holds the columns of
/// Z turned to the eigenvectors of H, size x as many as there are values.
struct LongWaves {
  std::vector<double> squared_speeds;
  std::vector<std::vector<Complex>> vectors;
};
LongWaves long_waves(const ComplexMatrix& d0, const ComplexMatrix& d1, const ComplexMatrix& d2);

/// K(q) = zeroth + first[0] q_x + first[1] q_y + second[0] q_x² + second[1] q_x q_y + second[2] q_y² + O(q³) of a
/// network: zeroth and second are real symmetric, first is i times a real antisymmetric matrix.
struct StiffnessOrders {
  ComplexMatrix zeroth;
  std::array<ComplexMatrix, 2> first;
  std::array<ComplexMatrix, 3> second;
};

struct LongWaveLoss {
  double ratio = 0;  ///< r_c in (-1, 0]; negative infinity: no long wave is lost before other motions, or before r = -1
  double angle = 0;  ///< rad in [0, pi), direction of the wave vector
};

/// The ratio at which long waves lose their stiffness: the limit q -> 0 of the critical ratio, exact and over all
/// directions at once. As q -> 0 along n a wave is the motion a/q of the discs together and, of order 1, what they do
/// beside it. The stiffness (with the orders above) leaves
///
///   A(n; r) = Q(n) - L(n) D^-1 L(n)^T,   Q = Z^T K2(n) Z,   L = Z^T K1(n) Y,   D = Y^T K0 Y,   K = N + r T,
///
/// Z the zero-energy modes at q = 0 (translations, gears) and Y the others: the acoustic tensor of the
/// homogenized assembly, which waves lose where it first has an eigenvalue 0 as r falls from 0.
///
/// \param normal, tangential N and T of K = N + r T, both positive semidefinite for every q
/// \param rotation per row: 1 where the unknown is a rotation, on which N does not depend
LongWaveLoss find_long_wave_loss(const StiffnessOrders& normal, const StiffnessOrders& tangential,
                                 const std::vector<char>& rotation);

}  // namespace equidem
