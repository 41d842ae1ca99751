// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/kernels/breaking_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace equidem {
namespace {

/// \param offsets null: 0
template <int B>
ContactDeformation opening(const BreakingContact& c, const ContactOffsets* offsets, double per_scale,
                           const double* motion) {
  const double* i = motion + static_cast<std::size_t>(c.i) * B;
  const double* j = motion + static_cast<std::size_t>(c.j) * B;
  const double x = j[0] - i[0], y = j[1] - i[1];
  double stretch = x * c.normal.x + y * c.normal.y, slip = y * c.normal.x - x * c.normal.y;
  if constexpr (B == 3) {
    const double turn_i = i[2] * per_scale, turn_j = j[2] * per_scale;
    if (offsets != nullptr) stretch += offsets->i * turn_i + offsets->j * turn_j;
    slip -= c.lever_i * turn_i + c.lever_j * turn_j;
  }
  return {stretch, slip};
}

template <int B>
void add_force(const BreakingContact& c, const ContactOffsets* offsets, double per_scale, const double* motion,
               ContactForce& force) {
  const ContactDeformation d = opening<B>(c, offsets, per_scale, motion);
  force.normal += c.springs.kN * d.normal;
  force.tangential += c.springs.kT * d.tangential;
}

template <int B>
void add_all(std::span<const BreakingContact> contacts, std::span<const ContactOffsets> offsets, double per_scale,
             const double* motion, std::span<ContactForce> forces) {
  for (std::size_t k = 0; k < contacts.size(); ++k)
    add_force<B>(contacts[k], offsets.empty() ? nullptr : &offsets[k], per_scale, motion, forces[k]);
}

}  // namespace

ContactDeformation opening_of(const BreakingContact& contact, const ContactOffsets& offsets, const MotionLayout& layout,
                              const double* motion) {
  const double per_scale = 1 / layout.rotation_scale;
  return layout.block == 3 ? opening<3>(contact, &offsets, per_scale, motion)
                           : opening<2>(contact, &offsets, per_scale, motion);
}

void add_forces(std::span<const BreakingContact> contacts, std::span<const ContactOffsets> offsets,
                const MotionLayout& layout, const double* motion, std::span<ContactForce> forces) {
  const double per_scale = 1 / layout.rotation_scale;
  if (layout.block == 3) return add_all<3>(contacts, offsets, per_scale, motion, forces);
  add_all<2>(contacts, offsets, per_scale, motion, forces);
}

ClassedUtilization utilization_of(std::span<const BreakingContact> contacts, std::span<const ContactForce> live,
                                  std::span<const ContactForce> dead, std::span<const std::uint8_t> classes,
                                  double friction, double direction) {
  ClassedUtilization all;
  std::array<double, rate_classes> most{};  // utilization at lambda = 1 of contacts without dead load
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const BreakingContact& c = contacts[k];
    if (classes[k] == never_breaks) continue;
    Utilization& its = all.of[classes[k]];
    const ContactForce at_rest = dead.empty() ? ContactForce{} : dead[k];
    const bool no_dead = at_rest.normal == 0 && at_rest.tangential == 0;
    if (no_dead && c.strength.tension > 0 && c.strength.shear > 0) {
      const double pull = direction * live[k].normal;
      const double shear = std::abs(live[k].tangential) + friction * pull;
      its.dead = std::max(its.dead, 0.0);
      most[classes[k]] = std::max({most[classes[k]], pull / c.strength.tension, shear / c.strength.shear});
      continue;
    }
    const double used = dead_utilization(at_rest, c.strength, friction);
    const ProportionalForce force{at_rest, live[k]};
    its.include({used < 1 ? breaking_moment(force, c.strength, friction, {.direction = direction}).t : 0, used});
  }
  for (std::size_t c = 0; c < rate_classes; ++c) {
    if (most[c] > 0) all.of[c].load_factor = std::min(all.of[c].load_factor, 1 / most[c]);
  }
  return all;
}

}  // namespace equidem
