// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Works and sums over all contacts of a network whose factor is updated; of the sums F_i l_j also their changes, where
/// most contacts are not up to date.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/statics/breaking/updated_state.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {
namespace {

// The sum F_i l_j over contacts is what their forces work on the motion of all discs with the gradient e_i e_j: q.u
// with the forces q that this motion needs, and what prescribed motions and mean strains add. q.x = (L^-1 q).(L^T x),
// and behind a change L^T x is not zero on its path alone. The forces h that drive the free discs, h = f - K u_0 with
// the prescribed motions and the mean strain u_0, are followed likewise.
double product(std::span<const double> a, std::span<const double> b) {
  constexpr std::size_t entries_at_once = 1 << 13;
  return sums_over<1>(a.size(), entries_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += a[k] * b[k];
    return std::array{sum};
  })[0];
}

}  // namespace

void UpdatedState::solve_followed() {
  const std::size_t n = components(), moments = this->moments();
  std::vector<ContactForce> forces(moments > 0 ? assembly.contacts.size() : 0);
  std::vector<double> q(n);
  const auto keep = [&](std::size_t number) {
    for (std::size_t k = 0; k < n; ++k) {
      if (unknowns.held[k] != DegreesOfFreedom::free) q[k] = 0;
    }
    permute_to_elimination(*symbolic_, q, std::span(followed_).subspan(number * n, n));
  };
  for (std::size_t g = 0; g < moments; ++g) {
    for (std::size_t c = 0; c < forces.size(); ++c) {
      forces[c] = linear_spring_force(
          springs[c],
          affine_deformation(frame_of(assembly, c), assembly.branch(assembly.contacts[c]), moment_gradients[g]));
    }
    internal_force(assembly, graph, unknowns, forces, q);
    keep(g);
  }
  for (std::size_t p = 0; p < cases.size(); ++p) {
    residual_force(network(), driving_motion(p), cases[p].gradient, cases[p].force, q);
    keep(moments + p);
  }
  for (std::size_t first = 0; first < moments + cases.size(); first += most_columns)
    factor->forward({followed_.data() + first * n, n, std::min(most_columns, moments + cases.size() - first)});
}

FactorPath UpdatedState::change_factor(std::size_t number, const SpringConstants& to,
                                       std::span<const RankOneChange> changes,
                                       std::span<const UpdatedCholesky::Load> loads, std::span<Tensor2> moments) {
  const ContactFrame frame = frame_of(assembly, number);
  const Vec2 branch = assembly.branch(assembly.contacts[number]);
  UpdatedCholesky::Followed followed{followed_, {}};
  const auto follow = [&](const ContactDeformation& d) {
    followed.by.push_back({to.kN != springs[number].kN ? d.normal : d.tangential, d.tangential});
  };
  for (std::size_t g = 0; options.force_moments && g < moment_gradients.size(); ++g)
    follow(affine_deformation(frame, branch, moment_gradients[g]));
  for (std::size_t p = 0; p < cases.size(); ++p) {
    const ContactDeformation d = driving_deformation(number, p);
    follow({-d.normal, -d.tangential});
  }
  const std::int32_t slot = slot_[number];
  for (std::size_t p = 0; p < cases.size(); ++p)
    follow(grows_[p] ? opening_of(contacts_[slot], offsets_of(slot), layout(), base(p)) : ContactDeformation{});
  const FactorPath path = factor->change(changes, loads, followed);
  if (!options.force_moments) return path;
  const auto b = static_cast<std::size_t>(symbolic_->block);
  for (std::size_t p = 0; p < cases.size(); ++p) {
    std::array<double, moment_gradients.size()> sums{};
    const double* y = path.values.data();
    for (const std::int32_t t : path.fronts) {
      const std::size_t pivots = symbolic_->pivots(t), begin = symbolic_->tree.nodes[t].begin * b;
      for (std::size_t g = 0; g < sums.size(); ++g) {
        const double* z = followed_.data() + g * components() + begin;
        for (std::size_t k = 0; k < pivots; ++k) sums[g] += z[k] * y[p * pivots + k];
      }
      y += pivots * cases.size();
    }
    moments[p] =
        Tensor2{sums[0], sums[1], sums[2], sums[3]} + -1.0 * outer(force_on_i(frame, force_of(number, p)), branch);
  }
  return path;
}

// A soft network answers a change mostly by more of the motion that it has. What is a multiple of the base u leaves no
// rounding, which is why it is kept apart: with K u = q, a motion x with K x = g is c u + d with K d = g - c q, on
// every subtree with the part of L^-1 q there. Of loads f alone, q is f but for what the correction of u is to balance,
// for components that are held, and for contacts that changed since then; L^-1 q follows them as L^-1 f does.
void UpdatedState::follow_bases() {
  for (std::size_t p = 0; p < cases.size(); ++p) {
    if (!grows_[p]) continue;
    const std::span<double> base = of_base(p);
    if (!held_solved_ && !holds_.empty()) {
      force_holds();
      factor->forward({base.data(), components(), 1});
    }
    for (std::size_t k = 0; k < base.size(); ++k)
      base[k] = of_loads(p)[k] + (holds_.empty() ? 0.0 : base[k]) - (corrected_ ? left(p)[k] : 0.0);
    work_of_base_[p] = product(of_loads(p), base);
  }
  held_solved_ = false;
}

void UpdatedState::force_holds() {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  for (std::size_t p = 0; p < cases.size(); ++p) {
    std::ranges::fill(of_base(p), 0.0);
    for (const Held& hold : holds_) {
      const std::size_t place = symbolic_->position[hold.component / b] * b + hold.component % b;
      of_base(p)[place] += hold.stiffness * base_[p].high[place];
    }
  }
}

void UpdatedState::grow_by(const FactorPath& path) {
  // A smaller share leaves less rounding than it saves. Multiples of `unit` add up without rounding.
  constexpr double least = 1e-4, unit = 0x1p-30, most = 0x1p20;
  if (!path.held.empty()) return;  // what holds a component is no part of L^-1 q yet
  const auto b = static_cast<std::size_t>(symbolic_->block);
  for (std::size_t p = 0; p < cases.size(); ++p) {
    if (!grows_[p] || !(work_of_base_[p] > 0)) continue;
    const double* y = path.values.data();
    double work = 0;
    for (const std::int32_t t : path.fronts) {
      const std::size_t pivots = symbolic_->pivots(t);
      const double* z = of_loads(p).data() + symbolic_->tree.nodes[t].begin * b;
      for (std::size_t k = 0; k < pivots; ++k) work += z[k] * y[p * pivots + k];
      y += pivots * cases.size();
    }
    const double share = work / work_of_base_[p];
    const double more = more_[p] + unit * std::round(share / unit);
    if (std::abs(share) >= least && std::abs(more) < most && 1 + more > 0.5) more_[p] = more;
  }
}

double UpdatedState::grown() const {
  return 1 + std::max(std::abs(more_[0]), std::abs(more_[1]));
}

// A correction x with K x = r and y = L^-1 r changes works by products that are known before blocks get it: that of the
// loads by f.x = h.x, that of the forces which prescribed motions and a mean strain need on these by -h.x.
EquilibriumSums UpdatedState::sums() const {
  constexpr std::size_t contacts_at_once = 1 << 11;
  enum : std::size_t { imposed, moment = imposed + 2, count = moment + 8 };
  const bool strained = cases[0].gradient.has_value();
  std::array<double, count> total{};
  if (strained || options.force_moments) {
    total = sums_over<count>(contacts_.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
      std::array<double, count> sum{};
      for (std::size_t slot = begin; slot < end; ++slot) {
        const auto number = static_cast<std::size_t>(blocks_->contacts()[slot]);
        const Vec2 normal = contacts_[slot].normal, branch = assembly.branch(assembly.contacts[number]);
        for (std::size_t p = 0; p < cases.size(); ++p) {
          const ContactForce& f = forces_[p][slot];
          if (strained) {
            const ContactDeformation d = affine_deformation_of(number, 0);
            sum[imposed + p] += f.normal * d.normal + f.tangential * d.tangential;
          }
          const Vec2 on_i = {f.normal * normal.x - f.tangential * normal.y,
                             f.normal * normal.y + f.tangential * normal.x};
          const Tensor2 t = outer(on_i, branch);
          const double entries[] = {t.xx, t.xy, t.yx, t.yy};
          for (std::size_t e = 0; e < 4; ++e) sum[moment + 4 * p + e] += entries[e];
        }
      }
      return sum;
    });
  }
  const auto moment_of = [&](std::size_t p) {
    const double* m = &total[moment + 4 * p];
    return Tensor2{m[0], m[1], m[2], m[3]};
  };
  EquilibriumSums result{.imposed = {total[imposed], total[imposed + 1]}};
  std::array<bool, most_right_sides> loads{};  // whether there are any
  const auto b = static_cast<std::size_t>(symbolic_->block);
  for (std::size_t p = 0; p < cases.size(); ++p) {
    const std::vector<double>& force = cases[p].force;
    for (std::size_t k = 0; k < force.size(); ++k) {
      if (force[k] == 0) continue;
      loads[p] = true;
      const std::size_t place = symbolic_->position[k / b] * b + k % b;
      for (std::size_t q = 0; q < cases.size(); ++q) result.load_work[p][q] += force[k] * base_[q].high[place];
    }
  }
  const std::vector<double>& prescribed = cases[0].prescribed;
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    if (unknowns.held[k] == DegreesOfFreedom::free || prescribed[k] == 0) continue;
    for (std::size_t q = 0; q < cases.size(); ++q) result.imposed[q] += prescribed[k] * reaction(k, q);
  }
  if (!corrected_) {
    for (std::size_t p = 0; p < cases.size(); ++p) result.moment[p] = moment_of(p);
    return result;
  }
  for (std::size_t p = 0; p < cases.size(); ++p) {
    for (std::size_t q = 0; q < cases.size(); ++q) {
      const double h_by_x = product(of_loads(p), left(q));
      if (loads[p]) result.load_work[p][q] += h_by_x;
      if (p == 0 && !loads[0]) result.imposed[q] -= h_by_x;
    }
    std::array<double, moment_gradients.size()> more{};
    for (std::size_t g = 0; g < moments(); ++g) more[g] = product(column(followed_, g), left(p));
    result.moment[p] = moment_of(p) + Tensor2{more[0], more[1], more[2], more[3]};
  }
  return result;
}

double UpdatedState::reaction(std::size_t component, std::size_t of_case) const {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const std::size_t disc = component / b, r = component % b;
  double pull = cases[of_case].force.empty() ? 0 : cases[of_case].force[component];
  for (const auto& edge : graph.of(disc)) {
    const std::int32_t slot = slot_[edge.contact];
    const BreakingContact& c = contacts_[slot];
    const ContactForce& f = forces_[of_case][slot];
    const ContactOffsets beside = offsets_of(slot);
    const std::array<double, 3> on_i = {f.normal * c.normal.x - f.tangential * c.normal.y,
                                        f.normal * c.normal.y + f.tangential * c.normal.x, 0};
    const auto place = static_cast<std::size_t>(symbolic_->position[disc]);
    const double scale = unknowns.rotation_scale;
    if (static_cast<std::size_t>(c.i) == place)
      pull += r < 2 ? on_i[r] : (c.lever_i * f.tangential - beside.i * f.normal) / scale;
    if (static_cast<std::size_t>(c.j) == place)
      pull += r < 2 ? -on_i[r] : (c.lever_j * f.tangential - beside.j * f.normal) / scale;
  }
  return -pull;
}

}  // namespace equidem
