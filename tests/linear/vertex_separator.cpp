// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/ordering/nested_dissection.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

struct Graph {
  int vertices = 0;
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::uint32_t low = 0, high = 0;  ///< sets of the vertices next to source and sink

  /// Whether a path from source to sink is left without the vertices of a set.
  [[nodiscard]] bool joined_without(std::uint32_t removed) const {
    std::uint32_t reached = low & ~removed, before = ~reached;
    while (reached != before) {
      before = reached;
      for (const auto& [a, b] : edges) {
        if ((reached >> a & 1U) != 0) reached |= 1U << b & ~removed;
        if ((reached >> b & 1U) != 0) reached |= 1U << a & ~removed;
      }
    }
    return (reached & high) != 0;
  }
  [[nodiscard]] int smallest_by_brute_force() const {
    int best = vertices;
    for (std::uint32_t set = 0; set < (1U << vertices); ++set) {
      if (std::popcount(set) < best && !joined_without(set)) best = std::popcount(set);
    }
    return best;
  }
};

}  // namespace

TEST_CASE("the_vertex_separator_parts_source_and_sink_and_none_is_smaller") {
  VertexSeparator separator;  // one for all graphs: its memory is reused
  Random random(1);
  for (int trial = 0; trial < 600; ++trial) {
    Graph graph;
    graph.vertices = 1 + static_cast<int>(random.below(10));
    const auto any = [&] { return static_cast<std::int32_t>(random.below(graph.vertices)); };
    for (std::uint64_t e = random.below(2 * graph.vertices + 1); e > 0; --e) {
      const std::int32_t a = any(), b = any();
      if (a != b) graph.edges.emplace_back(a, b);
    }
    for (std::uint64_t k = random.below(5); k > 0; --k) graph.low |= 1U << any();
    for (std::uint64_t k = random.below(5); k > 0; --k) graph.high |= 1U << any();
    separator.clear(graph.vertices);
    for (const auto& [a, b] : graph.edges) {
      separator.add_edge(a, b);
      if (random.below(4) == 0) separator.add_edge(b, a);  // two discs may touch twice
    }
    for (std::int32_t v = 0; v < graph.vertices; ++v) {
      if ((graph.low >> v & 1U) != 0) separator.touch_low(v);
      if ((graph.high >> v & 1U) != 0) separator.touch_high(v);
    }
    using Side = VertexSeparator::Side;
    const auto found = separator.solve();
    const std::vector<Side> sides(found.begin(), found.end());
    std::uint32_t removed = 0;
    for (std::int32_t v = 0; v < graph.vertices; ++v) removed |= (sides[v] == Side::separator ? 1U : 0U) << v;
    std::string edges;
    for (const auto& [a, b] : graph.edges) edges += fmt::format(" {}-{}", a, b);
    CAPTURE(trial, graph.vertices, edges, graph.low, graph.high, removed);
    REQUIRE(sides.size() == static_cast<std::size_t>(graph.vertices));
    for (const auto& [a, b] : graph.edges) {
      REQUIRE(!(sides[a] == Side::low && sides[b] == Side::high));
      REQUIRE(!(sides[a] == Side::high && sides[b] == Side::low));
    }
    for (std::int32_t v = 0; v < graph.vertices; ++v) {
      if ((graph.low >> v & 1U) != 0) REQUIRE(sides[v] != Side::high);
      if ((graph.high >> v & 1U) != 0) REQUIRE(sides[v] != Side::low);
    }
    REQUIRE(!graph.joined_without(removed));
    REQUIRE(std::popcount(removed) == static_cast<int>(separator.size()));
    REQUIRE(std::popcount(removed) == graph.smallest_by_brute_force());
  }
}
