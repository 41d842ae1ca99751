// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Multifrontal Cholesky and L D L^T against dense algebra: solutions, inertia, null space, growth.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/fields.hpp"
#include "support/random_systems.hpp"
#include "support/sturm.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Largest entry of A X - B over |A| |X|, for several right-hand sides.
double backward_error(const DenseMatrix& a, Factorization& factor, int columns, std::uint64_t seed) {
  const std::vector<double> b = random_vector(a.size * columns, seed);
  std::vector<double> x = b;
  factor.solve(x, columns);
  double error = 0;
  for (int c = 0; c < columns; ++c) {
    const auto column = [&](const std::vector<double>& v) {
      return std::vector<double>(v.begin() + c * static_cast<std::ptrdiff_t>(a.size),
                                 v.begin() + (c + 1) * static_cast<std::ptrdiff_t>(a.size));
    };
    const std::vector<double> one = column(x);
    error = std::max(error, largest(combined(times(a, one), -1, column(b))) / (norm_of(a) * largest(one)));
  }
  return error;
}

/// Small random graphs, discs in the thousands of ways to couple, with leaves small enough for many fronts.
RandomSystem random_system(int discs, int block, int far, int leaf_size, Random& random) {
  return {random_graph(discs, 2, far, random), block, leaf_size};
}

/// The stiffness matrix of an assembly without supports.
struct Loose {
  const Assembly& assembly;
  ContactGraph graph;
  StiffnessMatrix matrix;
  std::shared_ptr<const SymbolicFactor> symbolic;

  Loose(const Assembly& discs, double ratio, int per_disc, int leaf_size)
      : assembly(discs),
        graph(discs),
        matrix(assemble_stiffness(discs, graph, ContactSprings(SpringConstants{1, ratio}), all_free(discs, per_disc))),
        symbolic(std::make_shared<const SymbolicFactor>(
            analyze(dissect(discs, graph, {.leaf_size = leaf_size}), graph, per_disc))) {}

  [[nodiscard]] MatrixOnGraph on_graph() const { return {matrix, assembly, graph}; }
};

bool same_bits(const std::vector<double>& x, const std::vector<double>& y) {
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0;
}

}  // namespace

// The factor itself stays behind its interface: K (K^-1 b) = b for random b says the same.
TEST_CASE("cholesky_undoes_the_matrix") {
  Random random(1);
  for (int trial = 0; trial < 40; ++trial) {
    const int block = 2 + trial % 2, leaf_size = 1 + trial % 7, discs = 1 + static_cast<int>(random.below(60));
    RandomSystem system = random_system(discs, block, trial % 3 * 10, leaf_size, random);
    system.fill_positive(random);
    const auto factor = multifrontal_cholesky(system.symbolic, system.on_graph());
    CAPTURE(trial, discs, block, leaf_size);
    REQUIRE(factor != nullptr);
    const FactorReport& report = factor->report();
    CHECK(backward_error(system.dense_matrix(), *factor, 3, 5) < 1e-15);
    CHECK(report.negative_pivots == 0);
    CHECK(report.nonzeros == system.symbolic->nonzeros);
    CHECK(report.smallest_pivot > 0);
    CHECK(report.smallest_pivot <= 1 + 1e-15);
  }
}

TEST_CASE("cholesky_refuses_what_is_not_positive_definite") {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    RandomSystem system = random_system(30, 2, 5, 3, random);
    system.fill_positive(random);
    const std::size_t disc = random.below(30);
    system.matrix.diagonal[disc * 4] = -0.5;
    CAPTURE(trial, disc);
    CHECK(multifrontal_cholesky(system.symbolic, system.on_graph()) == nullptr);
  }
}

TEST_CASE("indefinite_matrices_are_solved_with_their_inertia_and_bounded_growth") {
  const double u = GENERATE(0.01, 0.1, 0.5), zero_share = GENERATE(0.3, 1.0);
  std::int64_t delayed = 0;
  double growth = 0;
  Random random(3);
  for (int trial = 0; trial < 30; ++trial) {
    const int block = 2 + trial % 2, leaf_size = 1 + trial % 4, discs = 1 + static_cast<int>(random.below(45));
    RandomSystem system = random_system(discs, block, trial % 3 * 8, leaf_size, random);
    system.fill_at_random(random, zero_share);
    const DenseMatrix a = system.dense_matrix();
    const Signs expected = signs_of(a, 1e-10);
    const auto factor = multifrontal_ldlt(system.symbolic, system.on_graph(), {.threshold = u});
    const FactorReport& report = factor->report();
    CAPTURE(u, zero_share, trial, discs, block, leaf_size, expected.negative, expected.zero, report.negative_pivots,
            report.zero_pivots, report.delayed_pivots, report.growth, report.smallest_pivot);
    CHECK(report.zero_pivots == expected.zero);
    CHECK(report.negative_pivots == expected.negative);
    CHECK(report.growth <= (1 + 1e-12) / u);
    CHECK(report.nonzeros >= system.symbolic->nonzeros - static_cast<double>(report.zero_pivots * a.size));
    if (expected.zero == 0) CHECK(backward_error(a, *factor, 2, 6) < 1e-14 / u);
    delayed += report.delayed_pivots;
    growth = std::max(growth, report.growth);
  }
  CAPTURE(u, zero_share, delayed, growth);
  CHECK(delayed > 0);
  CHECK(growth > 1);
}

TEST_CASE("the_same_matrix_has_the_same_inertia_whatever_the_pivots") {
  Random random(4);
  RandomSystem coarse = random_system(60, 3, 20, 60, random);
  coarse.fill_at_random(random, 0.5);
  const Signs expected = signs_of(coarse.dense_matrix(), 1e-10);
  for (const int leaf_size : {1, 2, 5, 10, 100}) {
    RandomSystem fine(coarse.assembly, 3, leaf_size);
    fine.matrix = coarse.matrix;
    for (const double u : {1e-6, 0.01, 0.5}) {
      const auto factor = multifrontal_ldlt(fine.symbolic, fine.on_graph(), {.threshold = u});
      CAPTURE(leaf_size, u, factor->report().delayed_pivots, factor->report().growth);
      CHECK(factor->report().negative_pivots == expected.negative);
      CHECK(factor->report().zero_pivots == expected.zero);
    }
  }
}

TEST_CASE("cholesky_and_indefinite_factorization_agree_on_positive_matrices") {
  Random random(5);
  RandomSystem system = random_system(80, 3, 20, 4, random);
  system.fill_positive(random);
  const auto cholesky = multifrontal_cholesky(system.symbolic, system.on_graph());
  const auto ldlt = multifrontal_ldlt(system.symbolic, system.on_graph());
  REQUIRE(cholesky != nullptr);
  std::vector<double> x = random_vector(system.unknowns(), 1), y = x;
  cholesky->solve(x, 1);
  ldlt->solve(y, 1);
  CHECK(relative_difference(x, y) < 1e-13);
  CHECK(ldlt->report().negative_pivots == 0);
  CHECK(ldlt->report().delayed_pivots == 0);
  CHECK(ldlt->report().nonzeros == cholesky->report().nonzeros);
}

TEST_CASE("zero_pivots_count_the_null_space_of_unsupported_assemblies") {
  for (const AssemblyKind& kind : assembly_kinds()) {
    if (kind.assembly.size() > 100) continue;  // dense
    for (const double ratio : {0.5, 0.0, -0.05}) {
      for (const int per_disc : {2, 3}) {
        for (const int leaf_size : {3, 10}) {
          const Loose loose(kind.assembly, ratio, per_disc, leaf_size);
          const DenseMatrix a = dense_matrix(loose.matrix, kind.assembly);
          const Signs expected = signs_of(a, 1e-12);
          const auto factor = multifrontal_ldlt(loose.symbolic, loose.on_graph());
          const FactorReport& report = factor->report();
          CAPTURE(kind.name, ratio, per_disc, leaf_size, expected.zero, expected.negative, report.zero_pivots,
                  report.negative_pivots, report.smallest_pivot, report.growth, report.delayed_pivots);
          CHECK(report.zero_pivots == expected.zero);
          CHECK(report.negative_pivots == expected.negative);
          if (expected.zero == 0) continue;
          const std::vector<double> softest = factor->softest_motion().value();
          REQUIRE(largest(softest) > 0);
          const double resistance = norm_of(a) == 0 ? 0 : largest(times(a, softest)) / (norm_of(a) * largest(softest));
          CAPTURE(resistance);
          CHECK(resistance < 1e-13);
        }
      }
    }
  }
}

TEST_CASE("the_softest_motion_of_a_nearly_singular_matrix_is_nearly_its_null_space") {
  // Held by springs to the ground of 1e-8 of the stiffness, at one disc.
  Assembly hexagonal = assembly_kind("hexagonal, free").assembly;
  for (const bool positive : {true, false}) {
    Loose loose(hexagonal, 0.5, 3, 4);
    for (const int k : {0, 4, 8}) loose.matrix.diagonal[9 * 20 + k] += 1e-8;
    const auto factor = positive ? multifrontal_cholesky(loose.symbolic, loose.on_graph())
                                 : multifrontal_ldlt(loose.symbolic, loose.on_graph());
    CAPTURE(positive);
    REQUIRE(factor != nullptr);
    const DenseMatrix a = dense_matrix(loose.matrix, hexagonal);
    const std::vector<double> softest = factor->softest_motion().value();
    const double resistance = largest(times(a, softest)) / (norm_of(a) * largest(softest));
    CAPTURE(resistance, factor->report().smallest_pivot, factor->report().smallest_component.value());
    CHECK(resistance < 1e-8);
    CHECK(factor->report().smallest_pivot < 1e-7);
  }
}

TEST_CASE("several_right_hand_sides_are_solved_as_one_by_one") {
  Random random(6);
  RandomSystem system = random_system(150, 3, 10, 6, random);
  const int columns = 5;
  const std::size_t n = system.unknowns();
  const std::vector<double> b = random_vector(n * columns, 9);
  const auto largest_difference = [&](Factorization& factor) {
    std::vector<double> together = b;
    factor.solve(together, columns);
    double difference = 0;
    for (int c = 0; c < columns; ++c) {
      const auto from = b.begin() + c * static_cast<std::ptrdiff_t>(n);
      std::vector<double> alone(from, from + static_cast<std::ptrdiff_t>(n));
      factor.solve(alone, 1);
      const auto there = together.begin() + c * static_cast<std::ptrdiff_t>(n);
      difference = std::max(difference, relative_difference({there, there + static_cast<std::ptrdiff_t>(n)}, alone));
    }
    return difference;
  };
  system.fill_positive(random);
  // BLAS sums several columns in another order than one: the last bits may differ.
  CHECK(largest_difference(*multifrontal_cholesky(system.symbolic, system.on_graph())) < 1e-14);
  system.fill_at_random(random, 0.5);
  // L D L^T takes one column after another: bit for bit.
  CHECK(largest_difference(*multifrontal_ldlt(system.symbolic, system.on_graph())) == 0);
}

TEST_CASE("large_fronts_are_solved_with_the_same_bits_for_every_number_of_threads") {
  // Many far contacts: the last front has 300 discs x 3 rows, which is factorized in tiles.
  Random random(7);
  RandomSystem system = random_system(600, 3, 2500, 8, random);
  CAPTURE(system.symbolic->largest_front);
  REQUIRE(system.symbolic->largest_front > 768);
  const bool positive = GENERATE(true, false);
  if (positive) {
    system.fill_positive(random);
  } else {
    system.fill_at_random(random, 0.5);
  }
  const auto solved = [&](int threads) {
    const ThreadsFor with(threads);
    const auto factor = positive ? multifrontal_cholesky(system.symbolic, system.on_graph())
                                 : multifrontal_ldlt(system.symbolic, system.on_graph());
    if (threads == 1) CHECK(backward_error(system.dense_matrix(), *factor, 1, 3) < (positive ? 1e-14 : 1e-12));
    std::vector<double> x = random_vector(2 * system.unknowns(), 3);
    factor->solve(x, 2);
    const FactorReport& report = factor->report();
    for (const double number :
         {report.growth, report.smallest_pivot, static_cast<double>(report.smallest_component.value()),
          static_cast<double>(report.delayed_pivots), static_cast<double>(report.negative_pivots.value())}) {
      x.push_back(number);
    }
    const std::vector<double> softest = factor->softest_motion().value();
    x.insert(x.end(), softest.begin(), softest.end());
    return x;
  };
  const std::vector<double> one = solved(1);
  for (const int threads : {2, 3, 7}) {
    CAPTURE(positive, threads);
    CHECK(same_bits(solved(threads), one));
  }
}
