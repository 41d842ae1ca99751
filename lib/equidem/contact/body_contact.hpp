// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A contact with its force: a result of simulations, written to files.
#pragma once

#include <cstddef>
#include <cstdint>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// A contact of two bodies, or of a body and a wall. Forces are per metre of depth, but for spheres: N/m or N.
struct BodyContact {
  std::int32_t i = 0;
  std::int32_t j = 0;           ///< negative: wall ~j
  Vec2 arm;                     ///< from the centre of i to the contact point, m
  Vec2 shift = {};              ///< i touches the image of j at the place of j + shift, m; {}: no period between them
  Vec2 force = {};              ///< on i; its negative acts on j
  double normal_force = 0;      ///< on i along the normal n from i: tension positive
  double tangential_force = 0;  ///< on i along s = (-n_y, n_x)
  double bending_moment = 0;    ///< N, of bonds with bending springs and of rolling, on i; its negative acts on j
};

/// A contact of an assembly by its number, at the places of before the motion.
inline BodyContact bonded_contact(const Assembly& assembly, std::size_t contact, const ContactForce& force) {
  const Contact& c = assembly.contacts[contact];
  const ContactFrame frame = frame_of(assembly, contact);
  const Vec2 period = assembly.period.value_or(Vec2{});
  return {.i = c.i,
          .j = c.j,
          .arm = arm_of_i(frame),
          .shift = {c.shift_x * period.x, c.shift_y * period.y},
          .force = force_on_i(frame, force),
          .normal_force = force.normal,
          .tangential_force = force.tangential};
}

}  // namespace equidem
