// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/kernels/breaking_contacts.hpp"

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

Utilization utilization_of(std::span<const BreakingContact> contacts, double friction, double direction) {
  Utilization all;
  for (const BreakingContact& c : contacts) {
    const double dead = dead_utilization(c.force.dead, c.strength, friction);
    all.include({dead < 1 ? breaking_moment(c.force, c.strength, friction, {.direction = direction}).t : 0, dead});
  }
  return all;
}

}  // namespace equidem
