// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/contact_points.hpp"

#include <cassert>
#include <cmath>

#include "equidem/contact/frame.hpp"

namespace equidem {
namespace {

/// From the centre of a disc to the point of one of its contacts.
Vec2 arm(const Assembly& assembly, std::int32_t disc, std::size_t contact) {
  const ContactFrame frame = frame_of(assembly, contact);
  return assembly.contacts[contact].i == disc ? frame.lever_i * frame.normal : -frame.lever_j * frame.normal;
}

std::int32_t shared_disc(const Contact& a, const Contact& b) {
  assert(a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j);
  return a.i == b.i || a.i == b.j ? a.i : a.j;
}

}  // namespace

bool points_in_line(const Assembly& assembly, const std::array<std::size_t, 3>& contacts) {
  constexpr double in_line = 1e-6;
  const auto chord = [&](std::size_t from, std::size_t to) {
    const std::int32_t disc = shared_disc(assembly.contacts[from], assembly.contacts[to]);
    return arm(assembly, disc, to) - arm(assembly, disc, from);
  };
  const Vec2 a = chord(contacts[0], contacts[1]), b = chord(contacts[1], contacts[2]);
  return std::abs(cross(a, b)) <= in_line * norm(a) * norm(b);
}

}  // namespace equidem
