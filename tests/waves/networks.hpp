// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Periodic networks whose waves are tested.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/random.hpp"
#include "equidem/waves/bloch.hpp"
#include "equidem/waves/brillouin_zone.hpp"

namespace equidem::test {

/// Discs of unit mass and moment beta.
inline std::vector<Inertia> unit_masses(const Assembly& assembly, double beta = 0.5) {
  std::vector<Inertia> inertia;
  for (const double r : assembly.radii) inertia.push_back({1, beta * r * r});
  return inertia;
}

inline Assembly periodic_hexagonal(int columns, int rows) {
  return hexagonal_lattice({.columns = columns, .rows = rows, .radius = 1, .periodic = true});
}
inline Assembly periodic_square(int columns, int rows) {
  return square_lattice({.columns = columns, .rows = rows, .radius = 1, .periodic = true});
}
inline Assembly random_cell(std::int64_t discs, std::uint64_t seed) {
  DelaunayOptions options;
  options.discs = discs;
  options.seed = seed;
  options.radii = {0.8, 1.2};
  options.periodic = true;
  return delaunay_assembly(options);
}

/// The springs with the geometric stiffness of forces at rest: `share` of kN times the length of each contact, by its
/// direction, so that they repeat with the contacts.
inline ContactSprings under_forces(Assembly assembly, const ContactSprings& springs, double share) {
  if (share == 0) return springs;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Vec2 l = assembly.branch(assembly.contacts[c]);
    const double twice = 2 * std::atan2(l.y, l.x), size = share * springs[c].kN * norm(l);
    assembly.contact_normal_force.push_back(size * (0.3 + std::cos(twice)));
    assembly.contact_tangential_force.push_back(0.4 * size * std::sin(twice));
  }
  return springs.with_prestress(prestress_of(assembly));
}

/// The assembly nx x ny times over, discs, contacts and their order shuffled and ends of contacts swapped at random.
inline Assembly repeated(const Assembly& cell, int nx, int ny, std::uint64_t seed) {
  Random random(seed);
  const auto n = static_cast<std::int32_t>(cell.size());
  const Vec2 period = *cell.period;
  std::vector<std::int32_t> place(static_cast<std::size_t>(n) * nx * ny);
  for (std::size_t k = 0; k < place.size(); ++k) place[k] = static_cast<std::int32_t>(k);
  for (std::size_t k = place.size(); k > 1; --k) std::swap(place[k - 1], place[random.below(k)]);
  const auto disc = [&](int x, int y, std::int32_t d) { return place[(y * nx + x) * n + d]; };
  Assembly all;
  all.kind = "file";
  all.period = {nx * period.x, ny * period.y};
  all.centres.resize(place.size());
  all.radii.resize(place.size());
  for (int y = 0; y < ny; ++y) {
    for (int x = 0; x < nx; ++x) {
      for (std::int32_t d = 0; d < n; ++d) {
        all.centres[disc(x, y, d)] = cell.centres[d] + Vec2{x * period.x, y * period.y};
        all.radii[disc(x, y, d)] = cell.radii[d];
      }
      for (const Contact& c : cell.contacts) {
        const int to_x = x + c.shift_x, to_y = y + c.shift_y;
        const auto over = [](int to, int count) { return to >= 0 ? to / count : -((count - 1 - to) / count); };
        const int shift_x = over(to_x, nx), shift_y = over(to_y, ny);
        Contact image{disc(x, y, c.i), disc(to_x - shift_x * nx, to_y - shift_y * ny, c.j), shift_x, shift_y, c.lever_i,
                      c.lever_j};
        if (random.below(2) == 0) image = {image.j, image.i, -shift_x, -shift_y, image.lever_j, image.lever_i};
        all.contacts.push_back(image);
      }
    }
  }
  for (std::size_t k = all.contacts.size(); k > 1; --k) std::swap(all.contacts[k - 1], all.contacts[random.below(k)]);
  return all;
}

}  // namespace equidem::test
