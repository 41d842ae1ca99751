// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cholesky factors in single precision, and triangular solutions with one panel.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/linear/kernels/panel_solve.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/random_systems.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

RandomSystem positive_system(int discs, int block, int leaf_size, Random& random) {
  RandomSystem system(random_graph(discs, 2, 20, random), block, leaf_size);
  system.fill_positive(random);
  return system;
}

/// K := S K S with S = 10^(from -range to range).
void spread(RandomSystem& system, double range, Random& random) {
  const auto b = static_cast<std::size_t>(system.matrix.block);
  std::vector<double> s(system.unknowns());
  for (double& value : s) value = std::pow(10.0, random.uniform(-range, range));
  for (std::size_t k = 0; k < system.matrix.diagonal.size(); ++k) {
    const std::size_t disc = k / (b * b);
    system.matrix.diagonal[k] *= s[disc * b + k / b % b] * s[disc * b + k % b];
  }
  for (std::size_t k = 0; k < system.matrix.coupling.size(); ++k) {
    const Contact& contact = system.assembly.contacts[k / (b * b)];
    system.matrix.coupling[k] *= s[contact.i * b + k / b % b] * s[contact.j * b + k % b];
  }
}

template <typename Real>
double panel_error(std::size_t pivots, std::size_t rows, std::size_t columns, Random& random) {
  std::vector<Real> l(pivots * rows);
  for (Real& value : l) value = static_cast<Real>(random.uniform(-1, 1)) / static_cast<Real>(rows);
  for (std::size_t p = 0; p < pivots; ++p) l[p * (rows + 1)] = static_cast<Real>(random.uniform(1, 2));
  const std::vector<double> given = random_vector(rows * columns, rows);
  std::vector<Real> forward(given.begin(), given.end()), backward = forward;
  const Panel<Real> panel{l.data(), pivots, rows};
  solve_forward(panel, forward.data(), columns);
  solve_backward(panel, backward.data(), columns);
  double error = 0;
  for (std::size_t c = 0; c < columns; ++c) {
    std::vector<double> x(given.begin() + static_cast<std::ptrdiff_t>(c * rows),
                          given.begin() + static_cast<std::ptrdiff_t>((c + 1) * rows));
    std::vector<double> y = x;
    for (std::size_t p = 0; p < pivots; ++p) {
      x[p] /= l[p * (rows + 1)];
      for (std::size_t r = p + 1; r < rows; ++r) x[r] -= l[p * rows + r] * x[p];
    }
    for (std::size_t p = pivots; p-- > 0;) {
      for (std::size_t r = p + 1; r < rows; ++r) y[p] -= l[p * rows + r] * y[r];
      y[p] /= l[p * (rows + 1)];
    }
    for (std::size_t r = 0; r < rows; ++r) {
      error = std::max({error, std::abs(forward[c * rows + r] - x[r]), std::abs(backward[c * rows + r] - y[r])});
    }
  }
  return error;
}

}  // namespace

TEST_CASE("triangular_solutions_with_a_panel_are_those_of_plain_loops") {
  Random random(1);
  for (const std::size_t pivots : {1, 2, 3, 4, 5, 8, 11, 30}) {
    for (const std::size_t below : {0, 1, 3, 7, 8, 29}) {
      for (std::size_t columns = 1; columns <= most_columns; ++columns) {
        CAPTURE(pivots, below, columns);
        CHECK(panel_error<float>(pivots, pivots + below, columns, random) < 2e-6);
        CHECK(panel_error<double>(pivots, pivots + below, columns, random) < 2e-15);
      }
    }
  }
}

TEST_CASE("a_factor_of_floats_solves_to_their_precision_with_half_the_memory") {
  Random random(2);
  for (const double range : {0.0, 5.0}) {  // stiffnesses up to twenty decades apart
    for (const int block : {2, 3}) {
      RandomSystem system = positive_system(150, block, 5, random);
      spread(system, range, random);
      FactorReport single, twofold;
      const auto floats = multifrontal_cholesky<float>(system.symbolic, system.on_graph(), &single);
      const auto doubles = multifrontal_cholesky(system.symbolic, system.on_graph(), &twofold);
      REQUIRE(floats != nullptr);
      const std::vector<double> load = random_vector(6 * system.unknowns(), 3);
      std::vector<double> x = load, y = load;
      floats->solve(x, 6);
      doubles->solve(y, 6);
      double off = 0;
      for (std::size_t k = 0; k < x.size(); ++k) off = std::max(off, std::abs(x[k] - y[k]) / (1e-3 + std::abs(y[k])));
      CAPTURE(range, block, off, single.smallest_pivot, twofold.smallest_pivot);
      CHECK(relative_difference(x, y) < 1e-4);
      CHECK(relative_difference(x, y) > 1e-9);
      CHECK(single.bytes == twofold.bytes / 2);
      CHECK(single.single_precision);
      CHECK(!twofold.single_precision);
      CHECK(single.smallest_pivot == Approx(twofold.smallest_pivot).epsilon(1e-3));
      CHECK(single.smallest_component == twofold.smallest_component);
      CHECK(relative_difference(floats->softest_motion(), doubles->softest_motion()) < 1e-3);
    }
  }
}

TEST_CASE("a_factor_of_floats_has_the_same_bits_for_every_number_of_threads") {
  Random random(7);
  RandomSystem system(random_graph(600, 3, 2500, random), 3, 8);
  REQUIRE(system.symbolic->largest_front > 768);  // factorized in tiles
  system.fill_positive(random);
  const auto solved = [&](int threads) {
    const ThreadsFor with(threads);
    std::vector<double> x = random_vector(2 * system.unknowns(), 3);
    multifrontal_cholesky<float>(system.symbolic, system.on_graph())->solve(x, 2);
    return x;
  };
  const std::vector<double> one = solved(1);
  for (const int threads : {2, 3, 7}) {
    const std::vector<double> more = solved(threads);
    CAPTURE(threads);
    CHECK(std::memcmp(one.data(), more.data(), one.size() * sizeof(double)) == 0);
  }
}

TEST_CASE("a_factor_of_floats_refuses_what_is_not_positive_definite") {
  Random random(3);
  RandomSystem system = positive_system(40, 2, 4, random);
  system.matrix.diagonal[4 * 17] = -0.5;
  FactorReport report;
  CHECK(multifrontal_cholesky<float>(system.symbolic, system.on_graph(), &report) == nullptr);
  CHECK(report.smallest_pivot <= 0);
  CHECK(report.smallest_component >= 0);
}
