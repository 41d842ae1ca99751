// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/sound.hpp"

#include <cmath>

namespace equidem {

PlaneWaves plane_waves(const Matrix4& gradient_stiffness, double mass_per_area, Vec2 direction) {
  constexpr int row[2][2] = {{0, 2}, {3, 1}};  // of the component ij
  const Vec2 unit = direction / norm(direction);
  const double n[2] = {unit.x, unit.y};
  double a[2][2] = {};
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j)
        for (int l = 0; l < 2; ++l) a[i][k] += n[j] * n[l] * gradient_stiffness[row[i][j]][row[k][l]] / mass_per_area;
  const double coupling = 0.5 * (a[0][1] + a[1][0]), middle = 0.5 * (a[0][0] + a[1][1]);
  const double half_difference = 0.5 * (a[0][0] - a[1][1]), radius = std::hypot(half_difference, coupling);
  // n . A n lies above the middle where the larger eigenvalue belongs to the wave along n.
  const Vec2 an{a[0][0] * unit.x + coupling * unit.y, coupling * unit.x + a[1][1] * unit.y};
  const double sign = dot(unit, an) >= middle ? 1 : -1;
  return {middle + sign * radius, middle - sign * radius};
}

}  // namespace equidem
