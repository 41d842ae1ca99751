// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Networks of bodies that touch off the lines of their centres, and their energy as plain as it gets: from the points
/// that touch.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/random.hpp"

#include "support/dense_oracle.hpp"

namespace equidem::test {

/// The contact of which the normal and the point are known; the point as an arm from the centre of i.
inline void place_contact(Assembly& assembly, Contact contact, Vec2 normal, Vec2 arm) {
  const Vec2 s = perpendicular(normal), rest = assembly.branch(contact) - arm;
  contact.lever_i = dot(arm, normal);
  contact.lever_j = dot(rest, normal);
  assembly.contacts.push_back(contact);
  assembly.contact_arms.push_back({normal, dot(arm, s), dot(rest, s)});
}

/// The bodies of an assembly, with sections of their own, whose contacts have normals and points drawn about those of
/// discs; one in `again` touch in a second place.
inline Assembly off_line(const Assembly& discs, std::uint64_t seed, int again = 5) {
  Random random(seed);
  Assembly bodies = discs;
  bodies.contacts.clear();
  bodies.facet_lengths.clear();
  for (const double r : bodies.radii) {
    const double area = std::numbers::pi * r * r, longer = random.uniform(1, 3);
    bodies.sections.push_back({area, area * r * r * longer * random.uniform(0.5, 0.9)});
  }
  for (const Contact& contact : discs.contacts) {
    const Vec2 l = discs.branch(contact);
    for (int touch = random.below(again) == 0 ? 2 : 1; touch > 0; --touch) {
      const double turn = random.uniform(-0.6, 0.6);
      const Vec2 n = (std::cos(turn) * l + std::sin(turn) * perpendicular(l)) / norm(l);
      place_contact(bodies, contact, n, random.uniform(0.2, 0.8) * l + random.uniform(-0.4, 0.4) * perpendicular(l));
    }
  }
  return bodies;
}

/// The points that touch, carried by their bodies: W = sum kN dn²/2 + kT ds²/2 where images move with the gradient as
/// well, N.
inline double energy_of_points(const Assembly& assembly, const ContactSprings& springs,
                               const std::vector<DiscMotion>& motions, const Tensor2& gradient = {}) {
  double energy = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactArms& arms = assembly.contact_arms[c];
    const Vec2 n = arms.normal, s{-n.y, n.x};
    const Vec2 point{contact.lever_i * n.x + arms.offset_i * s.x, contact.lever_i * n.y + arms.offset_i * s.y};
    const Vec2 l = assembly.branch(contact), from_j = point - l;
    const auto carried = [&](std::int32_t body, Vec2 arm) {
      const DiscMotion& m = motions[static_cast<std::size_t>(body)];
      return Vec2{m.u.x - m.theta * arm.y, m.u.y + m.theta * arm.x};
    };
    const Vec2 gap = carried(contact.j, from_j) + gradient * l - carried(contact.i, point);
    const double stretch = gap.x * n.x + gap.y * n.y, slip = gap.x * s.x + gap.y * s.y;
    energy += 0.5 * (springs[c].kN * stretch * stretch + springs[c].kT * slip * slip);
  }
  return energy;
}

/// K over (u_x, u_y, scale theta) of all bodies: differences of the energy, exact where it is quadratic.
inline DenseMatrix stiffness_of_energy(const Assembly& assembly, const ContactSprings& springs, double scale) {
  const std::size_t n = 3 * assembly.size();
  const auto energy = [&](std::size_t p, std::size_t q) {
    std::vector<DiscMotion> motions(assembly.size());
    for (const std::size_t k : {p, q}) {
      if (k >= n) continue;
      DiscMotion& m = motions[k / 3];
      (k % 3 == 0 ? m.u.x : k % 3 == 1 ? m.u.y : m.theta) += k % 3 == 2 ? 1 / scale : 1;
    }
    return energy_of_points(assembly, springs, motions);
  };
  DenseMatrix k(n);
  std::vector<double> own(n);
  for (std::size_t p = 0; p < n; ++p) own[p] = energy(p, n);
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t q = 0; q < n; ++q) k(p, q) = energy(p, q) - own[p] - own[q];
  return k;
}

}  // namespace equidem::test
