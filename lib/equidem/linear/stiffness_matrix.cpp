// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/stiffness_matrix.hpp"

#include <algorithm>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::size_t discs_at_once = 1 << 12;

}  // namespace

double held_stiffness(const StiffnessMatrix& matrix, const DegreesOfFreedom& unknowns) {
  const auto found = std::find(unknowns.held.begin(), unknowns.held.end(), 1);
  if (found == unknowns.held.end()) return 1;
  const auto component = static_cast<std::size_t>(found - unknowns.held.begin());
  const auto block = static_cast<std::size_t>(matrix.block);
  return matrix.diagonal_block(component / block)[component % block * (block + 1)];
}

void multiply(const StiffnessMatrix& matrix, const Assembly& assembly, const ContactGraph& graph,
              std::span<const double> x, std::span<double> y) {
  const int b = matrix.block;
  parallel_ranges(graph.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      const double* diagonal = matrix.diagonal_block(d);
      for (int r = 0; r < b; ++r) {
        double sum = 0;
        for (int c = 0; c < b; ++c) sum += diagonal[r * b + c] * x[d * b + c];
        for (const auto& edge : graph.of(d)) {
          const double* k = matrix.coupling_block(edge.contact);
          const bool first = static_cast<std::size_t>(assembly.contacts[edge.contact].i) == d;
          const double* there = &x[static_cast<std::size_t>(edge.other) * b];
          for (int c = 0; c < b; ++c) sum += (first ? k[r * b + c] : k[c * b + r]) * there[c];
        }
        y[d * b + r] = sum;
      }
    }
  });
}

CompressedColumns compress(const StiffnessMatrix& matrix, const Assembly& assembly, const ContactGraph& graph,
                           const DegreesOfFreedom& unknowns, std::span<const std::int32_t> order) {
  const int b = matrix.block;
  CompressedColumns out;
  std::vector<std::int64_t> column_of(graph.size() * b, -1);
  for (std::size_t k = 0; k < graph.size(); ++k) {
    const std::size_t disc = order.empty() ? k : static_cast<std::size_t>(order[k]);
    for (int r = 0; r < b; ++r) {
      const std::size_t component = disc * b + r;
      if (unknowns.held[component] != 0) continue;
      column_of[component] = out.size++;
      out.component.push_back(static_cast<std::int64_t>(component));
    }
  }
  out.first.reserve(out.size + 1);
  out.first.push_back(0);
  std::vector<std::pair<std::int64_t, double>> entries;
  for (const std::int64_t component : out.component) {
    const std::size_t disc = component / b;
    const auto c = static_cast<int>(component % b);
    const std::int64_t column = column_of[component];
    entries.clear();
    const auto add = [&](std::size_t other, int r, double value) {
      const std::int64_t row = column_of[other * b + r];
      if (row >= column) entries.emplace_back(row, value);
    };
    for (int r = 0; r < b; ++r) add(disc, r, matrix.diagonal_block(disc)[r * b + c]);
    for (const auto& edge : graph.of(disc)) {
      if (static_cast<std::size_t>(edge.other) == disc) continue;
      const double* k = matrix.coupling_block(edge.contact);
      const bool first = static_cast<std::size_t>(assembly.contacts[edge.contact].i) == disc;
      for (int r = 0; r < b; ++r) add(edge.other, r, first ? k[c * b + r] : k[r * b + c]);
    }
    std::sort(entries.begin(), entries.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
    for (std::size_t e = 0; e < entries.size(); ++e) {
      if (e > 0 && entries[e].first == entries[e - 1].first) {
        out.values.back() += entries[e].second;
      } else {
        out.rows.push_back(entries[e].first);
        out.values.push_back(entries[e].second);
      }
    }
    out.first.push_back(static_cast<std::int64_t>(out.rows.size()));
  }
  return out;
}

}  // namespace equidem
