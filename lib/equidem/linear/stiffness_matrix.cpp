// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/stiffness_matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::size_t discs_at_once = 1 << 12;

/// Visit the blocks of a row of discs: visit(contact, first, coupling) for every contact of disc d. `first`: the
/// contact names d first; coupling() is the block K_ij, of a contact of a disc with its own image a block of zeros.
/// \returns K_dd
template <int B, typename Visit>
std::array<double, B * B> visit_row(const SpringNetwork& network, const ImageSigns& signs, double held_stiffness,
                                    std::size_t d, const Visit& visit) {
  const auto& [assembly, graph, springs, unknowns] = network;
  const auto held = [&](std::size_t disc, int k) { return network.unknowns.held[disc * B + k] != 0; };
  std::array<double, B * B> diagonal{};
  for (const auto& edge : graph.of(d)) {
    const auto number = static_cast<std::size_t>(edge.contact);
    const Contact& contact = assembly.contacts[number];
    const ContactStiffness k = contact_stiffness(springs, number, frame_of(assembly, number), unknowns.rotation_scale);
    const double sign = signs.of(contact);
    const bool first = static_cast<std::size_t>(contact.i) == d;
    if (contact.i == contact.j) {
      const EndGradient both = k.ends.as_one(sign);
      k.add<B>(both, both, diagonal.data());
    } else if (first) {
      k.add<B>(k.ends.i, k.ends.i, diagonal.data());
    } else {
      k.add<B>(k.ends.j, k.ends.j, diagonal.data());
    }
    visit(number, first, [&] {
      std::array<double, B * B> coupling{};
      if (contact.i == contact.j) return coupling;
      k.add<B>(k.ends.i, k.ends.j, coupling.data());
      for (int r = 0; r < B; ++r) {
        for (int c = 0; c < B; ++c) {
          if (held(contact.i, r) || held(contact.j, c)) coupling[r * B + c] = 0;
        }
      }
      if (sign < 0) std::transform(coupling.begin(), coupling.end(), coupling.begin(), std::negate());
      return coupling;
    });
  }
  for (int k = 0; k < B; ++k) {
    if (!held(d, k)) continue;
    for (int r = 0; r < B; ++r) diagonal[r * B + k] = diagonal[k * B + r] = 0;
    diagonal[k * B + k] = held_stiffness;
  }
  return diagonal;
}

/// The blocks of a disc and of the contacts that name it first: every block is written once, by one thread.
template <int B>
void assemble_disc(const SpringNetwork& network, const ImageSigns& signs, double held_stiffness, std::size_t d,
                   StiffnessMatrix& matrix) {
  const auto visit = [&](std::size_t contact, bool first, const auto& coupling) {
    if (!first) return;
    const auto block = coupling();
    std::copy(block.begin(), block.end(), &matrix.coupling[contact * B * B]);
  };
  const auto diagonal = visit_row<B>(network, signs, held_stiffness, d, visit);
  std::copy(diagonal.begin(), diagonal.end(), &matrix.diagonal[d * B * B]);
}

template <int B>
void add_row_sums(const SpringNetwork& network, double held_stiffness, std::size_t d, double* sums) {
  const auto visit = [&](std::size_t, bool first, const auto& coupling) {
    const auto block = coupling();
    for (int e = 0; e < B * B; ++e) sums[first ? e / B : e % B] += std::abs(block[e]);
  };
  const auto diagonal = visit_row<B>(network, {}, held_stiffness, d, visit);
  for (int e = 0; e < B * B; ++e) sums[e / B] += std::abs(diagonal[e]);
}

template <int B>
void assemble(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
              const DegreesOfFreedom& unknowns, const ImageSigns& signs, StiffnessMatrix& matrix) {
  const double held_stiffness = springs.largest();
  parallel_ranges(assembly.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      assemble_disc<B>({assembly, graph, springs, unknowns}, signs, held_stiffness, d, matrix);
    }
  });
}

template <int B>
void multiply_row(const StiffnessMatrix& matrix, const Assembly& assembly, const ContactGraph& graph, std::size_t d,
                  std::span<const double> x, std::span<double> y) {
  double sum[B] = {};
  const double* diagonal = matrix.diagonal_block(d);
  for (int r = 0; r < B; ++r) {
    for (int c = 0; c < B; ++c) sum[r] += diagonal[r * B + c] * x[d * B + c];
  }
  for (const auto& edge : graph.of(d)) {
    const double* k = matrix.coupling_block(edge.contact);
    const double* there = &x[static_cast<std::size_t>(edge.other) * B];
    if (static_cast<std::size_t>(assembly.contacts[edge.contact].i) == d) {
      for (int r = 0; r < B; ++r) {
        for (int c = 0; c < B; ++c) sum[r] += k[r * B + c] * there[c];
      }
    } else {
      for (int c = 0; c < B; ++c) {
        for (int r = 0; r < B; ++r) sum[r] += k[c * B + r] * there[c];
      }
    }
  }
  std::copy(sum, sum + B, &y[d * B]);
}

}  // namespace

double held_stiffness(const StiffnessMatrix& matrix, const DegreesOfFreedom& unknowns) {
  const auto found = std::find_if(unknowns.held.begin(), unknowns.held.end(),
                                  [](std::uint8_t held) { return held != DegreesOfFreedom::free; });
  if (found == unknowns.held.end()) return 1;
  const auto component = static_cast<std::size_t>(found - unknowns.held.begin());
  const auto block = static_cast<std::size_t>(matrix.block);
  return matrix.diagonal_block(component / block)[component % block * (block + 1)];
}

void multiply(const StiffnessMatrix& matrix, const Assembly& assembly, const ContactGraph& graph,
              std::span<const double> x, std::span<double> y) {
  parallel_ranges(graph.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      if (matrix.block == 3) {
        multiply_row<3>(matrix, assembly, graph, d, x, y);
      } else {
        multiply_row<2>(matrix, assembly, graph, d, x, y);
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
  constexpr std::int64_t between_looks = 65536;  // columns
  for (const std::int64_t component : out.component) {
    if (std::ssize(out.first) % between_looks == 0) stop_if_interrupted();
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

CompressedColumns with_upper_triangle(const CompressedColumns& lower) {
  stop_if_interrupted();
  CompressedColumns full;
  full.size = lower.size;
  full.component = lower.component;
  full.first.assign(lower.first.size(), 0);
  for (std::int64_t c = 0; c < lower.size; ++c) {
    for (std::int64_t e = lower.first[c]; e < lower.first[c + 1]; ++e) {
      ++full.first[c + 1];
      if (lower.rows[e] != c) ++full.first[lower.rows[e] + 1];
    }
  }
  for (std::int64_t c = 0; c < lower.size; ++c) full.first[c + 1] += full.first[c];
  full.rows.resize(full.first.back());
  full.values.resize(full.first.back());
  // Columns are filled in ascending order: what earlier columns mirror into column c lies above its diagonal.
  std::vector<std::int64_t> next(full.first.begin(), full.first.end() - 1);
  const auto put = [&](std::int64_t column, std::int64_t row, double value) {
    full.rows[next[column]] = row;
    full.values[next[column]++] = value;
  };
  for (std::int64_t c = 0; c < lower.size; ++c) {
    for (std::int64_t e = lower.first[c]; e < lower.first[c + 1]; ++e) {
      put(c, lower.rows[e], lower.values[e]);
      if (lower.rows[e] != c) put(lower.rows[e], c, lower.values[e]);
    }
  }
  return full;
}

StiffnessMatrix assemble_stiffness(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                                   const DegreesOfFreedom& unknowns, const ImageSigns& signs) {
  stop_if_interrupted();
  StiffnessMatrix matrix;
  matrix.block = unknowns.per_disc;
  const std::size_t entries = static_cast<std::size_t>(matrix.block) * matrix.block;
  matrix.diagonal.resize(assembly.size() * entries);
  matrix.coupling.resize(assembly.contacts.size() * entries);
  if (matrix.block == 3) {
    assemble<3>(assembly, graph, springs, unknowns, signs, matrix);
  } else {
    assemble<2>(assembly, graph, springs, unknowns, signs, matrix);
  }
  return matrix;
}

std::vector<double> row_sums(const SpringNetwork& network) {
  const auto b = static_cast<std::size_t>(network.unknowns.per_disc);
  const double held_stiffness = network.springs.largest();
  std::vector<double> sums(network.assembly.size() * b, 0.0);
  parallel_ranges(network.assembly.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      if (b == 3) {
        add_row_sums<3>(network, held_stiffness, d, &sums[3 * d]);
      } else {
        add_row_sums<2>(network, held_stiffness, d, &sums[2 * d]);
      }
    }
  });
  return sums;
}

}  // namespace equidem
