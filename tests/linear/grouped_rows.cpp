// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Products of rows in groups against those of the assembled matrix.
#include "equidem/linear/multigrid/grouped_rows.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/linear/multigrid/cycle.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/off_line_networks.hpp"

using namespace equidem;
using namespace equidem::multigrid;
using namespace equidem::test;

namespace {

constexpr double share_of_rounding = 2e-6;  // of entries in single precision, over the largest entry of the product

/// Chunks whose sizes are no multiples of a group.
std::vector<std::int32_t> chunks_of(std::size_t rows) {
  std::vector<std::int32_t> first;
  for (std::size_t row = 0; row < rows; row += 19) first.push_back(static_cast<std::int32_t>(row));
  first.push_back(static_cast<std::int32_t>(rows));
  return first;
}

void check_products(const std::string& name, const Assembly& assembly, const ContactSprings& springs,
                    const DegreesOfFreedom& unknowns) {
  const ContactGraph graph(assembly);
  const SpringNetwork network{assembly, graph, springs, unknowns};
  const std::size_t n = assembly.size(), b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<double> x = random_vector(n * b, 3), wanted(n * b);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = unknowns.held[k] != 0 ? 0 : x[k];
  multiply(assemble_stiffness(assembly, graph, springs, unknowns), assembly, graph, x, wanted);

  std::vector<std::int32_t> order(n);
  std::iota(order.rbegin(), order.rend(), 0);
  const std::vector<std::int32_t> first_row = chunks_of(n);
  const double unit = springs.largest();
  const GroupedRows rows(network, order, first_row, unit);
  std::vector<double> p(3 * n + 1, 0.0), q(3 * n, 0.0);
  QuadVector single(n, Quad{}), zero(n, Quad{}), force(n);
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t e = 0; e < b; ++e) {
      p[3 * row + e] = x[static_cast<std::size_t>(order[row]) * b + e];
      single[row][e] = static_cast<float>(p[3 * row + e]);
    }
  }
  double work = 0;
  for (std::size_t chunk = 0; chunk + 1 < first_row.size(); ++chunk) {
    work += rows.multiply({static_cast<std::size_t>(first_row[chunk]), static_cast<std::size_t>(first_row[chunk + 1])},
                          p.data(), q.data());
  }
  residual(rows, zero, single, force);
  double off = 0, off_single = 0, largest_force = 0;
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t e = 0; e < b; ++e) {
      const double f = wanted[static_cast<std::size_t>(order[row]) * b + e] / unit;
      if (unknowns.held[static_cast<std::size_t>(order[row]) * b + e] != 0) {
        CHECK(q[3 * row + e] == 0);
        CHECK(force[row][e] == 0);
        continue;
      }
      off = std::max(off, std::abs(q[3 * row + e] - f));
      off_single = std::max(off_single, std::abs(force[row][e] + f));
      largest_force = std::max(largest_force, std::abs(f));
    }
  }
  CAPTURE(name, off, off_single, largest_force);
  CHECK(off <= share_of_rounding * largest_force);
  CHECK(off_single <= share_of_rounding * largest_force);
  CHECK(work == Approx(product(x, wanted) / unit).epsilon(1e-5));
}

}  // namespace

TEST_CASE("grouped_rows_multiply_as_the_stiffness_matrix_does") {
  for (const HeldScene& scene : held_scenes()) {
    const Effects effects = derive_effects(scene.assembly(), scene.springs, scene.options.rotation);
    check_products(scene.name, scene.assembly(), scene.springs,
                   number_unknowns(scene.assembly(), scene.springs, effects, scene.supports));
  }
  const Assembly beside = off_line(delaunay_assembly({.discs = 300, .periodic = true}), 3);
  check_products("off the lines of centres", beside, ContactSprings({2e9, 0.7e9}), all_free(beside, 3));
  const Assembly tiny = hexagonal_lattice({.columns = 2, .rows = 2, .periodic = true});
  check_products("discs that touch twice, and their own images", tiny, ContactSprings({2e9, 0.7e9}), all_free(tiny, 3));
}

TEST_CASE("a_wavefront_takes_every_step_once_after_the_steps_that_it_reads") {
  constexpr std::size_t rows = 4000;
  constexpr int steps = 5;
  for (const std::size_t farthest : {1, 30}) {  // rows that a row reads on either side
    for (const int threads : {1, 3}) {
      const ThreadsFor only(threads);
      BlockMatrix matrix;
      matrix.first.push_back(0);
      for (std::size_t row = 0; row < rows; ++row) matrix.first.push_back(matrix.first.back() + 3);
      matrix.resize();
      for (std::size_t row = 0; row < rows; ++row) {
        matrix.set(matrix.first[row], row, {});
        matrix.set(matrix.first[row] + 1, std::min(row + farthest, rows - 1), {});
        matrix.set(matrix.first[row] + 2, row - std::min(row, farthest), {});
        matrix.set_inverse(row, {});
      }
      std::vector<std::int32_t> first_row;
      for (std::int32_t row = 0; row < static_cast<std::int32_t>(rows); row += 9) first_row.push_back(row);
      first_row.push_back(rows);
      const GroupedRows grouped(matrix, first_row);
      const Wavefront wavefront(first_row, grouped);
      std::vector<std::atomic<int>> taken(rows);
      std::atomic<int> wrong = 0;
      wavefront.run(steps, [&](int step, std::size_t chunk) {
        const RowRange here = wavefront.rows(chunk);
        if (taken[here.begin] != step) ++wrong;
        if (step > 0) {
          for (const std::size_t other :
               {here.begin - std::min(here.begin, farthest), std::min(here.end - 1 + farthest, rows - 1)}) {
            if (taken[other] < step || taken[other] > step + 1) ++wrong;
          }
        }
        for (std::size_t row = here.begin; row < here.end; ++row) ++taken[row];
      });
      CAPTURE(farthest, threads);
      CHECK(wrong == 0);
      CHECK(std::all_of(taken.begin(), taken.end(), [](const auto& t) { return t == steps; }));
    }
  }
}
