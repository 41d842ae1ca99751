// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/assemble_stiffness.hpp"

#include <algorithm>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::size_t discs_at_once = 1 << 12;

/// The blocks of a disc and of the contacts that name it first: every block is written once, by one thread.
template <int B>
void assemble_disc(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                   const DegreesOfFreedom& unknowns, double held_stiffness, std::size_t d, StiffnessMatrix& matrix) {
  const auto held = [&](std::size_t disc, int k) { return unknowns.held[disc * B + k] != 0; };
  double diagonal[B * B] = {};
  for (const auto& edge : graph.of(d)) {
    const Contact& contact = assembly.contacts[edge.contact];
    const SpringConstants k = springs[edge.contact];
    DeformationGradient g =
        deformation_gradient(frame_of(assembly, static_cast<std::size_t>(edge.contact)), unknowns.rotation_scale);
    if (contact.i == contact.j) {  // both ends move alike
      for (int r = 0; r < 3; ++r) {
        g.normal_i[r] += g.normal_j[r];
        g.tangential_i[r] += g.tangential_j[r];
      }
    } else if (static_cast<std::size_t>(contact.j) == d) {
      add_linear_spring_tangent<B>(k, g.normal_j, g.normal_j, g.tangential_j, g.tangential_j, diagonal);
      continue;
    }
    add_linear_spring_tangent<B>(k, g.normal_i, g.normal_i, g.tangential_i, g.tangential_i, diagonal);
    double coupling[B * B] = {};
    if (contact.i != contact.j)
      add_linear_spring_tangent<B>(k, g.normal_i, g.normal_j, g.tangential_i, g.tangential_j, coupling);
    for (int r = 0; r < B; ++r) {
      for (int c = 0; c < B; ++c) {
        if (held(contact.i, r) || held(contact.j, c)) coupling[r * B + c] = 0;
      }
    }
    std::copy(coupling, coupling + B * B, &matrix.coupling[static_cast<std::size_t>(edge.contact) * B * B]);
  }
  for (int k = 0; k < B; ++k) {
    if (!held(d, k)) continue;
    for (int r = 0; r < B; ++r) diagonal[r * B + k] = diagonal[k * B + r] = 0;
    diagonal[k * B + k] = held_stiffness;
  }
  std::copy(diagonal, diagonal + B * B, &matrix.diagonal[d * B * B]);
}

template <int B>
void assemble(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
              const DegreesOfFreedom& unknowns, StiffnessMatrix& matrix) {
  const double held_stiffness = springs.largest();
  parallel_ranges(assembly.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      assemble_disc<B>(assembly, graph, springs, unknowns, held_stiffness, d, matrix);
    }
  });
}

}  // namespace

StiffnessMatrix assemble_stiffness(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                                   const DegreesOfFreedom& unknowns) {
  StiffnessMatrix matrix;
  matrix.block = unknowns.per_disc;
  const std::size_t entries = static_cast<std::size_t>(matrix.block) * matrix.block;
  matrix.diagonal.resize(assembly.size() * entries);
  matrix.coupling.resize(assembly.contacts.size() * entries);
  if (matrix.block == 3) {
    assemble<3>(assembly, graph, springs, unknowns, matrix);
  } else {
    assemble<2>(assembly, graph, springs, unknowns, matrix);
  }
  return matrix;
}

}  // namespace equidem
