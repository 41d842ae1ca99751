// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A Cholesky factor that follows changes of single springs, against dense algebra and a factor made anew.
#include "equidem/linear/multifrontal/updated_cholesky.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/linear/kernels/panel_change.hpp"

#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/fields.hpp"
#include "support/random_systems.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

void add(DenseMatrix& k, const RankOneChange& change, std::size_t b) {
  std::vector<std::pair<std::size_t, double>> v;
  for (std::size_t r = 0; r < b; ++r) {
    v.emplace_back(change.i * b + r, change.at_i[r]);
    v.emplace_back(change.j * b + r, change.at_j[r]);
  }
  for (const auto& [row, x] : v) {
    for (const auto& [column, y] : v) k(row, column) += change.stiffness * x * y;
  }
}

RankOneChange random_change(const Assembly& assembly, double stiffness, Random& random) {
  const Contact& contact = assembly.contacts[random.below(assembly.contacts.size())];
  RankOneChange change{stiffness, contact.i, contact.j};
  for (auto* end : {&change.at_i, &change.at_j}) {
    for (double& value : *end) value = random.uniform(-1, 1);
  }
  return change;
}

RankOneChange taken_out(RankOneChange change) {
  change.stiffness = -change.stiffness;
  return change;
}

double error_against(const DenseMatrix& k, const UpdatedCholesky& factor, std::uint64_t seed) {
  const std::vector<double> b = random_vector(k.size, seed);
  std::vector<double> x = b;
  factor.solve(x, 1);
  return relative_difference(x, solve(k, b));
}

}  // namespace

TEST_CASE("a_changed_factor_is_that_of_the_changed_matrix") {
  Random random(1);
  for (int trial = 0; trial < 12; ++trial) {
    const int block = 2 + trial % 2, leaf_size = 1 + trial % 5, discs = 5 + static_cast<int>(random.below(50));
    RandomSystem system(random_graph(discs, 2, trial % 3 * 8, random), block, leaf_size);
    system.fill_positive(random);
    DenseMatrix k = system.dense_matrix();
    UpdatedCholesky factor(system.symbolic);
    REQUIRE(factor.factorize(system.on_graph()));
    std::vector<RankOneChange> present;
    double largest_error = 0;
    for (int step = 0; step < 300; ++step) {
      // Stiffnesses over six decades; what was added is taken out again in another order, alone or in pairs.
      const double stiffness = std::pow(10, random.uniform(-3, 3));
      std::vector<RankOneChange> changes;
      if (present.empty() || random.uniform() < 0.55) {
        changes.push_back(random_change(system.assembly, stiffness, random));
        present.push_back(changes.back());
        if (step % 2 == 0) {
          RankOneChange beside = random_change(system.assembly, stiffness, random);
          beside.i = changes[0].i, beside.j = changes[0].j;
          changes.push_back(beside);
          present.push_back(beside);
        }
      } else {
        const std::size_t which = random.below(present.size());
        changes.push_back(taken_out(present[which]));
        present.erase(present.begin() + static_cast<std::ptrdiff_t>(which));
      }
      CHECK(factor.change(changes).held.empty());
      for (const RankOneChange& change : changes) add(k, change, block);
      if (step % 20 == 19) largest_error = std::max(largest_error, error_against(k, factor, step));
    }
    for (const RankOneChange& change : present) {
      CHECK(factor.change(std::array{taken_out(change)}).held.empty());
      add(k, taken_out(change), block);
    }
    CAPTURE(trial, discs, block, leaf_size, largest_error);
    CHECK(largest_error < 1e-11);
    CHECK(error_against(system.dense_matrix(), factor, 7) < 1e-10);  // of numbers that had been up to 1e3 times larger
  }
}

TEST_CASE("loads_of_a_change_are_solved_on_its_path") {
  Random random(2);
  for (int trial = 0; trial < 10; ++trial) {
    const int block = 2 + trial % 2;
    RandomSystem system(random_graph(40, 2, 8, random), block, 2);
    system.fill_positive(random);
    UpdatedCholesky factor(system.symbolic);
    REQUIRE(factor.factorize(system.on_graph()));
    std::vector<RankOneChange> changes = {random_change(system.assembly, 2, random)};
    if (trial % 3 != 0) changes.push_back(changes[0]), changes[1].at_i = {0.5, 0, 0};
    std::vector<UpdatedCholesky::Load> loads(1 + trial % 2);
    const std::size_t n = system.unknowns();
    std::vector<std::vector<double>> right(loads.size(), std::vector<double>(n, 0.0));
    for (std::size_t c = 0; c < loads.size(); ++c) {
      for (int r = 0; r < block; ++r) {
        loads[c].at_i[r] = right[c][changes[0].i * block + r] = random.uniform(-1, 1);
        loads[c].at_j[r] = right[c][changes[0].j * block + r] = random.uniform(-1, 1);
      }
    }
    const FactorPath path = factor.change(changes, loads);
    REQUIRE(path.held.empty());
    for (std::size_t c = 0; c < loads.size(); ++c) {
      std::vector<double> x(n, 0.0), in_order(n);
      std::size_t offset = 0;
      for (const std::int32_t t : path.fronts) {
        const std::size_t pivots = system.symbolic->pivots(t);
        std::copy_n(path.values.data() + offset + c * pivots, pivots,
                    x.data() + system.symbolic->tree.nodes[t].begin * block);
        offset += pivots * loads.size();
      }
      factor.backward({x.data(), n, 1});
      permute_from_elimination(*system.symbolic, x, in_order);
      std::vector<double> expected = right[c];
      factor.solve(expected, 1);
      CAPTURE(trial, c, changes.size(), loads.size());
      CHECK(relative_difference(in_order, expected) < 1e-13);
    }
  }
}

TEST_CASE("a_pivot_that_vanishes_is_held_by_its_stiffness") {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    // One component of one disc is resisted by a single spring, which is taken out.
    const int block = 2 + trial % 2, discs = 20;
    RandomSystem system(random_graph(discs, 2, 4, random), block, 1 + trial % 4);
    system.fill_positive(random);
    const auto disc = static_cast<std::int32_t>(random.below(discs));
    const std::size_t loose = disc * block;
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t c = 0; c < system.assembly.contacts.size(); ++c) {
      const Contact& contact = system.assembly.contacts[c];
      double* at = &system.matrix.coupling[c * b * b];
      for (std::size_t r = 0; r < b; ++r) {
        if (contact.i == disc) at[r] = 0;
        if (contact.j == disc) at[r * b] = 0;
      }
    }
    double* diagonal = &system.matrix.diagonal[disc * b * b];
    for (std::size_t r = 0; r < b; ++r) diagonal[r] = diagonal[r * b] = 0;
    diagonal[0] = 3;
    DenseMatrix k = system.dense_matrix();
    UpdatedCholesky factor(system.symbolic);
    REQUIRE(factor.factorize(system.on_graph()));
    const RankOneChange spring{-3, disc, disc, {1, 0, 0}, {0, 0, 0}};
    const FactorPath path = factor.change(std::array{spring});
    CAPTURE(trial, disc);
    REQUIRE(path.held == std::vector{static_cast<std::int64_t>(loose)});
    CHECK(factor.stiffness_of(path.held[0]) == 3);
    CHECK(error_against(k, factor, 4) < 1e-13);  // 3 taken out, 3 put in its place
  }
}
