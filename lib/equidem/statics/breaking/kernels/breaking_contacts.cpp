// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/kernels/breaking_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace equidem {
namespace {

template <int B>
ContactDeformation opening(const BreakingContact& c, const double* motion) {
  const double* i = motion + static_cast<std::size_t>(c.i) * B;
  const double* j = motion + static_cast<std::size_t>(c.j) * B;
  const double x = j[0] - i[0], y = j[1] - i[1];
  double stretch = x * c.normal.x + y * c.normal.y, slip = y * c.normal.x - x * c.normal.y;
  if constexpr (B == 3) {
    stretch += c.open_i * i[2] + c.open_j * j[2];
    slip -= c.turn_i * i[2] + c.turn_j * j[2];
  }
  return {stretch, slip};
}

template <int B>
void add_force(const BreakingContact& c, const double* motion, ContactForce& force) {
  const ContactDeformation d = opening<B>(c, motion);
  force.normal += c.springs.kN * d.normal;
  force.tangential += c.springs.kT * d.tangential;
}

template <int B>
void add_all(std::span<BreakingContact> contacts, const double* live, const double* dead) {
  for (BreakingContact& c : contacts) add_force<B>(c, live, c.force.live);
  if (dead == nullptr) return;
  for (BreakingContact& c : contacts) add_force<B>(c, dead, c.force.dead);
}

}  // namespace

ContactDeformation opening_of(const BreakingContact& contact, int block, const double* motion) {
  return block == 3 ? opening<3>(contact, motion) : opening<2>(contact, motion);
}

void add_forces(std::span<BreakingContact> contacts, int block, const double* live, const double* dead) {
  if (block == 3) return add_all<3>(contacts, live, dead);
  add_all<2>(contacts, live, dead);
}

ClassedUtilization utilization_of(std::span<const BreakingContact> contacts, std::span<const std::uint8_t> classes,
                                  double friction, double direction) {
  ClassedUtilization all;
  std::array<double, rate_classes> most{};  // utilization at lambda = 1 of contacts without dead load
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const BreakingContact& c = contacts[k];
    if (classes[k] == never_breaks) continue;
    Utilization& its = all.of[classes[k]];
    const bool no_dead = c.force.dead.normal == 0 && c.force.dead.tangential == 0;
    if (no_dead && c.strength.tension > 0 && c.strength.shear > 0) {
      const double pull = direction * c.force.live.normal;
      const double shear = std::abs(c.force.live.tangential) + friction * pull;
      its.dead = std::max(its.dead, 0.0);
      most[classes[k]] = std::max({most[classes[k]], pull / c.strength.tension, shear / c.strength.shear});
      continue;
    }
    const double dead = dead_utilization(c.force.dead, c.strength, friction);
    its.include({dead < 1 ? breaking_moment(c.force, c.strength, friction, {.direction = direction}).t : 0, dead});
  }
  for (std::size_t c = 0; c < rate_classes; ++c) {
    if (most[c] > 0) all.of[c].load_factor = std::min(all.of[c].load_factor, 1 / most[c]);
  }
  return all;
}

}  // namespace equidem
