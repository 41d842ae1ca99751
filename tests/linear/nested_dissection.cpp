// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/nested_dissection.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/random_systems.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Structure of the columns of L by eliminating discs one by one: rows[p] are later positions, ascending.
std::vector<std::vector<std::int32_t>> eliminate(const ContactGraph& graph, const SymbolicFactor& symbolic) {
  const std::size_t n = graph.size();
  std::vector<std::vector<char>> coupled(n, std::vector<char>(n, 0));
  for (std::size_t p = 0; p < n; ++p) {
    for (const auto& edge : graph.of(symbolic.tree.order[p])) coupled[p][symbolic.position[edge.other]] = 1;
  }
  std::vector<std::vector<std::int32_t>> rows(n);
  for (std::size_t p = 0; p < n; ++p) {
    for (std::size_t q = p + 1; q < n; ++q) {
      if (coupled[p][q] != 0) rows[p].push_back(static_cast<std::int32_t>(q));
    }
    for (const std::int32_t q : rows[p]) {
      for (const std::int32_t r : rows[p]) coupled[q][r] = 1;
    }
  }
  return rows;
}

}  // namespace

TEST_CASE("lattices_are_divided_down_to_their_leaves_by_short_separators") {
  const bool periodic = GENERATE(false, true);
  const int n = 40;
  const Assembly lattice = hexagonal_lattice({.columns = n, .rows = n, .periodic = periodic});
  const DissectionTree tree = dissect(lattice, ContactGraph(lattice));
  const auto& root = tree.nodes.back();
  std::int32_t largest = 0;
  for (const auto& node : tree.nodes) largest = std::max(largest, node.end - node.begin);
  CAPTURE(periodic, root.end - root.begin, largest, tree.nodes.size());
  // A straight cut through n rows takes a disc of each, and a cell that closes through its period is cut
  // twice.
  CHECK(root.end - root.begin <= (periodic ? 2 * n : n));
  CHECK(largest <= (periodic ? 2 * n : n));
}

TEST_CASE("an_assembly_far_from_the_origin_is_divided_as_well_as_one_near_it") {
  // Coordinates of a national grid: millimetres at half a million metres need more digits than single
  // precision has.
  Assembly near = hexagonal_lattice({.columns = 40, .rows = 40, .radius = 0.005});
  Assembly far = near;
  for (Vec2& x : far.centres) x += {5e5, 4e6};
  const ContactGraph graph(near);
  const double nonzeros_near = analyze(dissect(near, graph), graph, 3).nonzeros;
  const double nonzeros_far = analyze(dissect(far, graph), graph, 3).nonzeros;
  CAPTURE(nonzeros_near, nonzeros_far);
  CHECK(nonzeros_far <= 1.1 * nonzeros_near);
}

TEST_CASE("fronts_of_a_triangulated_assembly_hold_their_fill_and_nothing_else") {
  const Assembly lattice = hexagonal_lattice({.columns = 12, .rows = 12});
  const ContactGraph graph(lattice);
  const SymbolicFactor symbolic = analyze(dissect(lattice, graph), graph, 2);
  const auto fill = eliminate(graph, symbolic);
  for (std::size_t t = 0; t < symbolic.fronts(); ++t) {
    std::vector<std::int32_t> expected;
    const auto& node = symbolic.tree.nodes[t];
    for (std::int32_t p = node.begin; p < node.end; ++p) {
      for (const std::int32_t q : fill[p]) {
        if (q >= node.end) expected.push_back(q);
      }
    }
    std::sort(expected.begin(), expected.end());
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    CAPTURE(t);
    CHECK(symbolic.rows[t] == expected);
  }
}

TEST_CASE("order_and_symbolic_factor_do_not_depend_on_the_number_of_threads") {
  // Above 20 000 discs, parts are divided level by level in parallel.
  const Assembly lattice = hexagonal_lattice({.columns = 200, .rows = 150, .periodic = true});
  const ContactGraph graph(lattice);
  const auto analyzed = [&](int threads) {
    const ThreadsFor with(threads);
    return analyze(dissect(lattice, graph), graph, 3);
  };
  const SymbolicFactor one = analyzed(1);
  for (const int threads : {2, 3, 7}) {
    const SymbolicFactor many = analyzed(threads);
    CAPTURE(threads);
    CHECK(many.tree.order == one.tree.order);
    CHECK(many.rows == one.rows);
    CHECK(many.nonzeros == one.nonzeros);
    CHECK(many.operations == one.operations);
  }
}
