// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/nested_dissection.hpp"

#include <algorithm>
#include <cstdint>

#include "equidem/assembly/lattices.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

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
