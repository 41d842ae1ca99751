// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Equilibrium in long double, straight from the contact law and dense: for springs and radii of very different size,
/// where doubles leave few digits.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"

namespace equidem::test {

/// Motions (u_x, u_y, theta) per disc that balance `forces` (f_x, f_y, moment); components marked in `held` are zero.
inline std::vector<long double> solve_in_long_double(const Assembly& assembly, const ContactSprings& springs,
                                                     std::span<const char> held, std::span<const double> forces) {
  using Number = long double;
  const std::size_t n = 3 * assembly.size();
  std::vector<std::vector<Number>> k(n, std::vector<Number>(n + 1, 0));
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    Number x = static_cast<Number>(assembly.centres[contact.j].x) - assembly.centres[contact.i].x;
    Number y = static_cast<Number>(assembly.centres[contact.j].y) - assembly.centres[contact.i].y;
    if (assembly.period) {
      x += static_cast<Number>(contact.shift_x) * assembly.period->x;
      y += static_cast<Number>(contact.shift_y) * assembly.period->y;
    }
    const Number length = std::sqrt(x * x + y * y), nx = x / length, ny = y / length;
    const std::size_t at[6] = {3UL * contact.i, 3UL * contact.i + 1, 3UL * contact.i + 2,
                               3UL * contact.j, 3UL * contact.j + 1, 3UL * contact.j + 2};
    const Number stretch[6] = {-nx, -ny, 0, nx, ny, 0};
    const Number slip[6] = {ny,  -nx, -static_cast<Number>(contact.lever_i),
                            -ny, nx,  -static_cast<Number>(contact.lever_j)};
    for (int r = 0; r < 6; ++r) {
      for (int s = 0; s < 6; ++s)
        k[at[r]][at[s]] += springs[c].kN * stretch[r] * stretch[s] + springs[c].kT * slip[r] * slip[s];
    }
  }
  for (std::size_t r = 0; r < n; ++r) {
    k[r][n] = held[r] != 0 ? 0 : forces[r];
    if (held[r] == 0) continue;
    for (std::size_t s = 0; s < n; ++s) k[r][s] = k[s][r] = 0;
    k[r][r] = 1;
  }
  std::vector<Number> scale(n, 0);
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t s = 0; s < n; ++s) scale[r] = std::max(scale[r], std::abs(k[r][s]));
  }
  for (std::size_t p = 0; p < n; ++p) {  // Gauss with scaled partial pivoting
    std::size_t best = p;
    for (std::size_t r = p; r < n; ++r) {
      if (std::abs(k[r][p]) * scale[best] > std::abs(k[best][p]) * scale[r]) best = r;
    }
    if (k[best][p] == 0) throw std::domain_error("singular");
    std::swap(k[p], k[best]);
    std::swap(scale[p], scale[best]);
    for (std::size_t r = p + 1; r < n; ++r) {
      if (k[r][p] == 0) continue;
      const Number l = k[r][p] / k[p][p];
      for (std::size_t s = p; s <= n; ++s) k[r][s] -= l * k[p][s];
    }
  }
  std::vector<Number> u(n);
  for (std::size_t p = n; p-- > 0;) {
    u[p] = k[p][n];
    for (std::size_t s = p + 1; s < n; ++s) u[p] -= k[p][s] * u[s];
    u[p] /= k[p][p];
  }
  return u;
}

}  // namespace equidem::test
