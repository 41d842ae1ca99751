// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Residuals of the motions behind an updated factor, and the motions that correct them.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/ordering/nested_dissection.hpp"
#include "equidem/statics/breaking/kernels/twofold.hpp"
#include "equidem/statics/breaking/updated_state.hpp"

namespace equidem {
namespace {

constexpr std::size_t blocks_of_contacts = 1 << 4, discs_at_once = 1 << 9;

/// u := (1 + more) u, to some units of the last place of `low`.
void grow(PreciseMotion& u, double more) {
  u.low.resize(u.high.size(), 0.0);
  parallel_ranges(u.high.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Twofold<double> before{u.high[k], u.low[k]}, now = before + before * more;
      u.high[k] = now.high, u.low[k] = now.low;
    }
  });
}

}  // namespace

ContactDeformation UpdatedState::affine_deformation_of(std::size_t contact, std::size_t of_case) const {
  const auto& gradient = cases[of_case].gradient;
  if (!gradient) return {};
  return affine_deformation(frame_of(assembly, contact), assembly.branch(assembly.contacts[contact]), *gradient);
}

PreciseMotion UpdatedState::driving_motion(std::size_t of_case) const {
  PreciseMotion motion(components());
  const std::vector<double>& prescribed = cases[of_case].prescribed;
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    if (unknowns.held[k] != DegreesOfFreedom::free) motion.high[k] = prescribed[k];
  }
  return motion;
}

ContactDeformation UpdatedState::driving_deformation(std::size_t contact, std::size_t of_case) const {
  ContactDeformation d = affine_deformation_of(contact, of_case);
  const std::vector<double>& prescribed = cases[of_case].prescribed;
  if (prescribed.empty()) return d;
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  const auto motion_of = [&](std::int32_t disc) {
    const auto component = [&](std::size_t r) {
      const std::size_t k = disc * b + r;
      return r < b && unknowns.held[k] != DegreesOfFreedom::free ? prescribed[k] : 0.0;
    };
    return DiscMotion{{component(0), component(1)}, component(2) / unknowns.rotation_scale};
  };
  const Contact& c = assembly.contacts[contact];
  const ContactDeformation by = equidem::deformation(frame_of(assembly, contact), motion_of(c.i), motion_of(c.j));
  return {d.normal + by.normal, d.tangential + by.tangential};
}

void UpdatedState::fold_motions() {
  for (std::size_t p = 0; p < cases.size(); ++p) {
    if (more_[p] != 0) grow(base_[p], more_[p]);
    base_[p].add(column(moved_, p));
  }
  more_ = {};
  for (BlockState& state : states_) state.more = {};
  std::fill(moved_.begin(), moved_.end(), 0.0);
  std::fill(boundary_.begin(), boundary_.end(), 0.0);
  visits_ = {};
}

double UpdatedState::evaluate_forces(std::size_t of_case) {
  return sums_over<1>(blocks_->all().size(), blocks_of_contacts, [&](std::size_t first, std::size_t last) {
    const auto begin = static_cast<std::size_t>((*blocks_)[first].contacts_begin);
    const std::size_t count = static_cast<std::size_t>((*blocks_)[last - 1].contacts_end) - begin;
    std::vector<ContactDeformation> affine;
    for (std::size_t slot = begin; cases[of_case].gradient && slot < begin + count; ++slot)
      affine.push_back(affine_deformation_of(static_cast<std::size_t>(blocks_->contacts()[slot]), of_case));
    equidem::evaluate_forces(std::span(contacts_).subspan(begin, count), offsets(begin, count), layout(), base(of_case),
                             affine, std::span(forces_[of_case]).subspan(begin, count),
                             std::span(remainders_).subspan(begin, count));
    double sum = 0;
    for (std::size_t slot = begin; slot < begin + count; ++slot) {
      const SpringConstants& k = contacts_[slot].springs;
      if (k.kN != 0) sum += 2 * linear_spring_energy_of(k, forces_[of_case][slot]);
    }
    return std::array{sum};
  })[0];
}

double UpdatedState::balance(std::size_t of_case) {
  using Extended = long double;
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const std::vector<double>& load = cases[of_case].force;
  const std::span<double> unbalanced = left(of_case);
  const auto square = sums_over<1>(assembly.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t place = begin; place < end; ++place) {
      const auto disc = static_cast<std::size_t>(symbolic_->tree.order[place]);
      std::array<Extended, 3> pull{};
      for (const auto& edge : graph.of(disc)) {
        const std::int32_t slot = slot_[edge.contact];
        const BreakingContact& c = contacts_[slot];
        const ForceRemainder& rest = remainders_[slot];
        const ContactOffsets beside = offsets_of(slot);
        const ContactForce& rounded = forces_[of_case][slot];
        const Extended normal = static_cast<Extended>(rounded.normal) + rest.normal;
        const Extended tangential = static_cast<Extended>(rounded.tangential) + rest.tangential;
        const Extended x = normal * c.normal.x - tangential * c.normal.y;
        const Extended y = normal * c.normal.y + tangential * c.normal.x;
        if (static_cast<std::size_t>(c.i) == place) {
          pull[0] += x, pull[1] += y;
          pull[2] += c.lever_i * tangential - beside.i * normal;
        }
        if (static_cast<std::size_t>(c.j) == place) {
          pull[0] -= x, pull[1] -= y;
          pull[2] += c.lever_j * tangential - beside.j * normal;
        }
      }
      pull[2] /= unknowns.rotation_scale;
      for (std::size_t r = 0; r < b; ++r) {
        const std::size_t component = disc * b + r;
        if (!load.empty()) pull[r] += load[component];
        const double kept = unknowns.held[component] != 0 ? 0.0 : static_cast<double>(pull[r]);
        unbalanced[place * b + r] = kept;
        sum += kept * kept;
      }
    }
    return std::array{sum};
  });
  return std::sqrt(square[0]);
}

double UpdatedState::evaluate() {
  fold_motions();
  double largest = 0;
  for (std::size_t p = 0; p < cases.size(); ++p) {
    twice_energy_[p] = evaluate_forces(p);
    const double length = balance(p);
    if (scales[p] > 0) largest = std::max(largest, length / scales[p]);
  }
  corrected_ = false;
  evaluate_blocks();
  return largest;
}

double UpdatedState::unbalanced(std::int64_t component, std::size_t of_case) const {
  const std::int64_t b = symbolic_->block;
  return left(of_case)[symbolic_->position[component / b] * b + component % b];
}

// The correction x has the energy x.K x = |y|², a sum over fronts. What it has of its own in a subtree, beside the
// motion that follows the boundary, is the share of the fronts there.
double UpdatedState::correct() {
  constexpr double margin = 1 + 1e-6;  // for round-off
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const auto& nodes = symbolic_->tree.nodes;
  // The forces of what holds components are solved for in the same sweep, which takes little longer.
  const bool grow = grows_[0] || (cases.size() > 1 && grows_[1]);
  const std::size_t more = grow && !holds_.empty() ? cases.size() : 0;
  if (more > 0) force_holds();
  factor->forward({left(0).data() - more * components(), components(), cases.size() + more});
  corrected_ = true;
  held_solved_ = more > 0;
  std::array<double, most_right_sides> energy{};      // twice that of the correction
  for (std::size_t k = 0; k < states_.size(); ++k) {  // children before their parents
    BlockState& state = states_[k];
    const MotionBlock& block = (*blocks_)[k];
    state.to_correct = true;
    for (std::size_t p = 0; p < cases.size(); ++p) {
      double square = 0;
      for (std::size_t at = nodes[block.first].begin * b; at < nodes[block.root].end * b; ++at)
        square += squared(left(p)[at]);
      for (const std::int32_t child : block.children) square += squared(states_[child].corrected[p]);
      state.corrected[p] = margin * std::sqrt(square);
      if (block.parent < 0) {
        state.reached[p] += state.corrected[p];
        energy[p] += squared(state.corrected[p]);
      }
    }
  }
  double largest = 0;
  for (std::size_t p = 0; p < cases.size(); ++p) {
    if (energy[p] > 0) largest = std::max(largest, std::sqrt(energy[p] / twice_energy_[p]));
  }
  return largest;
}

PreciseMotion UpdatedState::motion(std::size_t of_case) {
  bring_all_up_to_date();
  PreciseMotion now = base_[of_case], motion(components());
  if (more_[of_case] != 0) grow(now, more_[of_case]);
  now.add(column(moved_, of_case));
  permute_from_elimination(*symbolic_, now.high, motion.high);
  if (!now.low.empty()) {
    motion.low.resize(components());
    permute_from_elimination(*symbolic_, now.low, motion.low);
  }
  return motion;
}

}  // namespace equidem
