// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/kernels/touch_lanes.hpp"

namespace equidem::eight {

void count_instants(const GrainSystem& system, const std::int32_t* i, const std::int32_t* j, const StoredTouches& lanes,
                    BlockSums& block) {
  const auto dashpot = system.law().dashpot;
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    if (lanes.begun[k] == 0 && lanes.ended[k] == 0) continue;
    TouchInstant contact;
    contact.i = i[k];
    contact.j = system.body_of(j[k]);
    contact.normal = {lanes.nx[k], lanes.ny[k]};
    contact.arm_i = {lanes.arm_i_x[k], lanes.arm_i_y[k]};
    contact.arm_j = {lanes.arm_j_x[k], lanes.arm_j_y[k]};
    contact.closing = lanes.closing[k];
    contact.slip = lanes.slip[k];
    contact.part = part_of_drift(lanes.deep[k], lanes.begun[k] != 0 ? contact.closing : -contact.closing, system.dt());
    contact.spring = lanes.spring[k];
    contact.dashpot = lanes.impulse[k] - lanes.spring[k];
    contact.decay = dashpot(lanes.dashpot[k] * lanes.mobility[k], lanes.deep[k]);
    contact.tangential = lanes.tangential[k];
    contact.tangential_dashpot = lanes.tangential_dashpot[k];
    contact.stored = lanes.stored[k];
    contact.slides = lanes.slides[k] != 0;
    contact.pulls = lanes.least[k] < 0;
    if (lanes.begun[k] != 0) {
      begin_within_drift(system, contact, block.sums());
    } else {
      end_within_drift(system, contact, block.sums());
    }
  }
}

}  // namespace equidem::eight
