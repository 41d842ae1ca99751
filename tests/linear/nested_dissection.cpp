// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/ordering/nested_dissection.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/random_systems.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Assemblies of every kind, and graphs that are not planar.
void for_all_graphs(const std::function<void(const Assembly&)>& body) {
  for (const AssemblyKind& kind : assembly_kinds()) {
    CAPTURE(kind.name);
    body(kind.assembly);
  }
  for (const int far : {0, 30}) {
    Random random(4);
    const Assembly graph = random_graph(90, 3, far, random);
    CAPTURE(far);
    body(graph);
  }
  Assembly coincident = chain_of_discs(40, 1);  // nothing to divide them by
  for (Vec2& x : coincident.centres) x = {1, 1};
  CAPTURE("coincident");
  body(coincident);
}

std::vector<std::int32_t> node_of_disc(const DissectionTree& tree) {
  std::vector<std::int32_t> node(tree.order.size(), -1);
  for (std::size_t t = 0; t < tree.nodes.size(); ++t) {
    for (std::int32_t p = tree.nodes[t].begin; p < tree.nodes[t].end; ++p) {
      node[tree.order[p]] = static_cast<std::int32_t>(t);
    }
  }
  return node;
}

/// Whether node `above` is `t` or one of its ancestors, by walking up.
bool on_the_way_up(const DissectionTree& tree, std::int32_t t, std::int32_t above) {
  while (t >= 0 && t != above) t = tree.nodes[t].parent;
  return t == above;
}

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

TEST_CASE("elimination_orders_are_permutations_in_trees_in_postorder") {
  for_all_graphs([](const Assembly& assembly) {
    const ContactGraph graph(assembly);
    for (const int leaf_size : {1, 4, 10, 1000}) {
      const DissectionTree tree = dissect(assembly, graph, {.leaf_size = leaf_size});
      CAPTURE(assembly.size(), leaf_size, tree.nodes.size());
      std::vector<std::int32_t> sorted = tree.order, expected(assembly.size());
      std::sort(sorted.begin(), sorted.end());
      std::iota(expected.begin(), expected.end(), 0);
      CHECK(sorted == expected);
      std::int32_t next = 0;
      for (std::size_t t = 0; t < tree.nodes.size(); ++t) {
        const auto& node = tree.nodes[t];
        CAPTURE(t, node.begin, node.end, node.parent, node.first_descendant);
        REQUIRE(node.begin == next);
        REQUIRE(node.end > node.begin);
        next = node.end;
        REQUIRE((node.parent == -1 || node.parent > static_cast<std::int32_t>(t)));
        // Exactly the nodes from first_descendant on lie below t.
        for (std::int32_t s = 0; s <= static_cast<std::int32_t>(t); ++s) {
          REQUIRE(on_the_way_up(tree, s, static_cast<std::int32_t>(t)) == (s >= node.first_descendant));
        }
      }
      REQUIRE(next == static_cast<std::int32_t>(assembly.size()));
    }
  });
}

TEST_CASE("separators_separate") {
  for_all_graphs([](const Assembly& assembly) {
    const ContactGraph graph(assembly);
    for (const int leaf_size : {1, 10}) {
      const DissectionTree tree = dissect(assembly, graph, {.leaf_size = leaf_size});
      const std::vector<std::int32_t> node = node_of_disc(tree);
      for (const Contact& c : assembly.contacts) {
        const std::int32_t early = std::min(node[c.i], node[c.j]), late = std::max(node[c.i], node[c.j]);
        CAPTURE(leaf_size, c.i, c.j, early, late);
        REQUIRE(on_the_way_up(tree, early, late));
      }
    }
  });
}

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

TEST_CASE("rows_of_fronts_hold_all_fill_of_their_discs") {
  for_all_graphs([](const Assembly& assembly) {
    const ContactGraph graph(assembly);
    for (const int leaf_size : {1, 10}) {
      const int block = leaf_size == 1 ? 2 : 3;
      const SymbolicFactor symbolic = analyze(dissect(assembly, graph, {.leaf_size = leaf_size}), graph, block);
      const auto fill = eliminate(graph, symbolic);
      double nonzeros = 0;
      std::size_t spare = 0;
      for (std::size_t t = 0; t < symbolic.fronts(); ++t) {
        const auto& node = symbolic.tree.nodes[t];
        const auto& rows = symbolic.rows[t];
        CAPTURE(leaf_size, t);
        REQUIRE(std::is_sorted(rows.begin(), rows.end()));
        REQUIRE(std::adjacent_find(rows.begin(), rows.end()) == rows.end());
        REQUIRE((rows.empty() || rows.front() >= node.end));
        REQUIRE((node.parent >= 0 || rows.empty()));
        std::vector<char> needed(assembly.size(), 0);
        for (std::int32_t p = node.begin; p < node.end; ++p) {
          for (const std::int32_t q : fill[p]) {
            if (q < node.end) continue;
            needed[q] = 1;
            REQUIRE(std::binary_search(rows.begin(), rows.end(), q));
          }
        }
        // More than that only where a child passes on what its parent's own discs are not coupled to.
        for (const std::int32_t q : rows) spare += needed[q] == 0 ? 1 : 0;
        const double k = static_cast<double>(symbolic.pivots(t)), m = static_cast<double>(symbolic.updates(t));
        nonzeros += k * (k + 1) / 2 + k * m;
      }
      CAPTURE(spare, symbolic.nonzeros);
      CHECK(symbolic.nonzeros == nonzeros);
      for (std::size_t p = 0; p < assembly.size(); ++p)
        REQUIRE(symbolic.position[symbolic.tree.order[p]] == static_cast<std::int32_t>(p));
    }
  });
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

TEST_CASE("a_schedule_holds_every_front_once_and_children_before_parents") {
  for_all_graphs([](const Assembly& assembly) {
    const ContactGraph graph(assembly);
    const DissectionTree tree = dissect(assembly, graph, {.leaf_size = 2});
    for (const int threads : {1, 2, 7}) {
      const ThreadsFor with(threads);
      std::vector<double> work;
      for (const auto& node : tree.nodes) work.push_back(node.end - node.begin);
      const TreeSchedule schedule = schedule_tree(tree, work);
      // Subtrees of one wave may run in any order; a node above them must find its children done.
      std::vector<int> visits(tree.nodes.size(), 0);
      std::vector<int> children_done(tree.nodes.size(), 0), children(tree.nodes.size(), 0);
      for (const auto& node : tree.nodes) {
        if (node.parent >= 0) ++children[node.parent];
      }
      const auto visit = [&](std::int32_t t) {
        ++visits[t];
        if (tree.nodes[t].parent >= 0) ++children_done[tree.nodes[t].parent];
      };
      CAPTURE(threads, tree.nodes.size(), schedule.waves.size());
      for (const auto& wave : schedule.waves) {
        for (const std::int32_t root : wave.subtrees) {
          for (std::int32_t t = tree.nodes[root].first_descendant; t <= root; ++t) visit(t);
        }
        for (const std::int32_t t : wave.above) {
          CAPTURE(t);
          REQUIRE(children_done[t] == children[t]);
          visit(t);
        }
      }
      CHECK(std::count(visits.begin(), visits.end(), 1) == static_cast<std::ptrdiff_t>(visits.size()));
    }
  });
}

TEST_CASE("a_sweep_hands_every_parent_the_values_of_its_children") {
  for_all_graphs([](const Assembly& assembly) {
    const ContactGraph graph(assembly);
    const SymbolicFactor symbolic = analyze(dissect(assembly, graph, {.leaf_size = 2}), graph, 2);
    const auto& nodes = symbolic.tree.nodes;
    for (const int threads : {1, 3}) {
      const ThreadsFor with(threads);
      TreeSweep sweep(symbolic, [](std::size_t) { return 1.0; });
      // Each front hands on the number of discs in its subtree, in an array of its own odd size.
      std::vector<double> discs_below(nodes.size(), -1);
      double reported = 0;
      sweep.up([](std::size_t t) { return 1 + t % 5; },
               [&](std::size_t t, double* values, const std::vector<TreeSweep::Child>& children) {
                 double sum = nodes[t].end - nodes[t].begin;
                 for (const auto& child : children) {
                   for (std::size_t k = 0; k < 1 + child.node % 5; ++k) {
                     if (child.values[k] != discs_below[child.node]) sum = -1e9;
                   }
                   sum += child.values[0];
                 }
                 std::fill(values, values + 1 + t % 5, sum);
                 discs_below[t] = sum;
               },
               [&](double share) { reported += share; });
      std::vector<std::int64_t> when(nodes.size(), -1);
      std::int64_t clock = 0;
      if (threads == 1) sweep.down([&](std::size_t t) { when[t] = clock++; });
      for (std::size_t t = 0; t < nodes.size(); ++t) {
        CAPTURE(threads, t, reported);
        REQUIRE(discs_below[t] == nodes[t].end - nodes[nodes[t].first_descendant].begin);
        if (threads == 1 && nodes[t].parent >= 0) REQUIRE(when[t] > when[nodes[t].parent]);
      }
      CHECK(reported <= 1 + 1e-12);
    }
  });
}
