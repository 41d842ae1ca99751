// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// L D L^T of complex symmetric matrices: no conjugation, zero diagonals, every number of threads.
#include <cmath>
#include <complex>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/linear/multifrontal/ldlt_factor.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/random_systems.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using Number = std::complex<double>;

/// A random symmetric matrix `real` + i `imaginary` on one graph.
struct ComplexSystem {
  RandomSystem real, imaginary;
  StiffnessMatrixOf<Number> matrix;

  ComplexSystem(int discs, int block, double zero_share, Random& random)
      : real(random_graph(discs, 2, discs / 3, random), block, 3), imaginary(real) {
    real.fill_at_random(random, zero_share);
    imaginary.fill_at_random(random, zero_share);
    matrix.block = block;
    for (std::size_t e = 0; e < real.matrix.diagonal.size(); ++e)
      matrix.diagonal.emplace_back(real.matrix.diagonal[e], imaginary.matrix.diagonal[e]);
    for (std::size_t e = 0; e < real.matrix.coupling.size(); ++e)
      matrix.coupling.emplace_back(real.matrix.coupling[e], imaginary.matrix.coupling[e]);
  }

  [[nodiscard]] LdltFactor<Number> factor() const {
    return {real.symbolic, {matrix, real.assembly, real.graph}, {.threshold = 0.1}};
  }
};

}  // namespace

TEST_CASE("complex_factors_solve_symmetric_systems_without_conjugation") {
  Random random(41);
  std::int64_t delayed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int discs = 2 + 3 * trial, block = 2 + trial % 2;
    const ComplexSystem system(discs, block, trial % 3 == 0 ? 0.6 : 0.1, random);
    const LdltFactor<Number> factor = system.factor();
    const DenseMatrix a = system.real.dense_matrix(), b = system.imaginary.dense_matrix();
    std::vector<Number> x(a.size), given(a.size);
    for (Number& value : given) value = {random.uniform(-1, 1), random.uniform(-1, 1)};
    x = given;
    factor.solve(x, 1);
    double error = 0, size = 0;
    for (std::size_t r = 0; r < a.size; ++r) {
      Number sum = -given[r];
      for (std::size_t c = 0; c < a.size; ++c) sum += Number(a(r, c), b(r, c)) * x[c];
      error = std::max(error, std::abs(sum));
      size = std::max(size, std::abs(x[r]));
    }
    CAPTURE(trial, discs, block, error, size, factor.report().growth, factor.report().delayed_pivots);
    CHECK(factor.report().zero_pivots == 0);
    CHECK(factor.report().negative_pivots == -1);
    CHECK(error < 1e-12 * (norm_of(a) + norm_of(b)) * size);
    delayed += factor.report().delayed_pivots;
  }
  CHECK(delayed > 0);
}

TEST_CASE("complex_factors_have_the_same_bits_for_every_number_of_threads") {
  Random random(43);
  const ComplexSystem system(400, 3, 0.3, random);
  std::vector<std::vector<Number>> solutions;
  for (const int threads : {1, 2, 3}) {
    const ThreadsFor with(threads);
    std::vector<Number>& x = solutions.emplace_back(system.real.unknowns(), Number(1, -2));
    system.factor().solve(x, 1);
  }
  CHECK(solutions[0] == solutions[1]);
  CHECK(solutions[0] == solutions[2]);
}
