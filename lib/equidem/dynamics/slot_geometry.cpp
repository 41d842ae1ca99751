// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/slot_geometry.hpp"

#include <initializer_list>

#include "equidem/dynamics/layout.hpp"

namespace equidem {

void fill_geometry(const LoopKind& kind, Vec2 branch, double lever_own, double lever_other, SpringConstants k,
                   double kM, double* slot, int lane) {
  const auto write = [&](std::initializer_list<double> numbers) {
    double* to = slot + lane;
    for (const double number : numbers) {
      *to = number;
      to += DiscLayout::lanes;
    }
  };
  const double square = dot(branch, branch);
  if (kind.motion == LoopKind::Motion::finite) {
    const double levers = lever_own + lever_other;
    write({branch.x, branch.y, square});
    if (kind.equal_contacts) return;
    slot += 3 * DiscLayout::lanes;
    write({levers / norm(branch), levers > 0 ? lever_own / levers : 0.5, k.kN, k.kT});
    slot += 4 * DiscLayout::lanes;
  } else if (kind.equal_contacts) {
    write({branch.x, branch.y, 1 / square});
  } else {
    const Vec2 n = branch / norm(branch);
    write({n.x, n.y, lever_own, lever_other, k.kN, k.kT});
    slot += 6 * DiscLayout::lanes;
  }
  if (kind.bending) write({kM});
}

}  // namespace equidem
