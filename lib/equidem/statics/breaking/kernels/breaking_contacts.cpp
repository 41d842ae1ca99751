// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/kernels/breaking_contacts.hpp"

namespace equidem {
namespace {

template <int B>
void add_force(const BreakingContact& c, const double* motion, ContactForce& force) {
  const double* i = motion + static_cast<std::size_t>(c.i) * B;
  const double* j = motion + static_cast<std::size_t>(c.j) * B;
  const double x = j[0] - i[0], y = j[1] - i[1];
  double stretch = x * c.normal.x + y * c.normal.y, slip = y * c.normal.x - x * c.normal.y;
  if constexpr (B == 3) {
    stretch += c.open_i * i[2] + c.open_j * j[2];
    slip -= c.turn_i * i[2] + c.turn_j * j[2];
  }
  force.normal += c.springs.kN * stretch;
  force.tangential += c.springs.kT * slip;
}

template <int B>
void add_all(std::span<BreakingContact> contacts, const double* live, const double* dead) {
  for (BreakingContact& c : contacts) add_force<B>(c, live, c.force.live);
  if (dead == nullptr) return;
  for (BreakingContact& c : contacts) add_force<B>(c, dead, c.force.dead);
}

}  // namespace

void add_forces(std::span<BreakingContact> contacts, int block, const double* live, const double* dead) {
  if (block == 3) return add_all<3>(contacts, live, dead);
  add_all<2>(contacts, live, dead);
}

Utilization utilization_of(std::span<const BreakingContact> contacts, double friction) {
  Utilization all;
  for (const BreakingContact& c : contacts) {
    all.include({breaking_point(c.force, c.strength, friction).load_factor,
                 dead_utilization(c.force.dead, c.strength, friction)});
  }
  return all;
}

}  // namespace equidem
