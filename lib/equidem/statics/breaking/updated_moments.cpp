// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The sums F_i l_j over all contacts of a network whose factor is updated, of which most contacts are not up to date.
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/statics/breaking/updated_state.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {
namespace {

// The sum F_i l_j over contacts is what their forces work on the motion of all discs with the gradient e_i e_j: q.u
// with the forces q that this motion needs, and what prescribed motions and mean strains add. q.x = (L^-1 q).(L^T x),
// and behind a change L^T x is not zero on its path alone.
constexpr std::array<Tensor2, 4> moment_gradients = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

}  // namespace

void UpdatedState::solve_moments() {
  if (!options.force_moments) return;
  const std::size_t n = components();
  std::vector<ContactForce> forces(assembly.contacts.size());
  std::vector<double> q(n);
  moments_.resize(moment_gradients.size() * n);
  for (std::size_t g = 0; g < moment_gradients.size(); ++g) {
    for (std::size_t c = 0; c < forces.size(); ++c) {
      forces[c] = linear_spring_force(
          springs[c],
          affine_deformation(frame_of(assembly, c), assembly.branch(assembly.contacts[c]), moment_gradients[g]));
    }
    internal_force(assembly, graph, unknowns, forces, q);
    for (std::size_t k = 0; k < n; ++k) {
      if (unknowns.held[k] != DegreesOfFreedom::free) q[k] = 0;
    }
    permute_to_elimination<double>(*symbolic_, q, std::span(moments_).subspan(g * n, n));
  }
  factor->forward({moments_.data(), n, moment_gradients.size()});
}

FactorPath UpdatedState::change_factor(std::size_t number, const SpringConstants& to,
                                       std::span<const RankOneChange> changes,
                                       std::span<const UpdatedCholesky::Load> loads, std::span<Tensor2> moments) {
  if (!options.force_moments) return factor->change(changes, loads);
  const ContactFrame frame = frame_of(assembly, number);
  const Vec2 branch = assembly.branch(assembly.contacts[number]);
  UpdatedCholesky::Followed followed{moments_, {}};
  for (const Tensor2& gradient : moment_gradients) {
    const ContactDeformation d = affine_deformation(frame, branch, gradient);
    followed.by.push_back({to.kN != springs[number].kN ? d.normal : d.tangential, d.tangential});
  }
  const FactorPath path = factor->change(changes, loads, followed);
  const auto b = static_cast<std::size_t>(symbolic_->block);
  for (std::size_t p = 0; p < cases.size(); ++p) {
    std::array<double, moment_gradients.size()> sums{};
    const double* y = path.values.data();
    for (const std::int32_t t : path.fronts) {
      const std::size_t pivots = symbolic_->pivots(t), begin = symbolic_->tree.nodes[t].begin * b;
      for (std::size_t g = 0; g < sums.size(); ++g) {
        const double* z = moments_.data() + g * components() + begin;
        for (std::size_t k = 0; k < pivots; ++k) sums[g] += z[k] * y[p * pivots + k];
      }
      y += pivots * cases.size();
    }
    moments[p] =
        Tensor2{sums[0], sums[1], sums[2], sums[3]} + -1.0 * outer(force_on_i(frame, force_of(number, p)), branch);
  }
  return path;
}

}  // namespace equidem
