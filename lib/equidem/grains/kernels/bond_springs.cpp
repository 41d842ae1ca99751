// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Springs of bonds (contact/finite_bond.hpp) and what they bear (bond_breaking.hpp).
#include <algorithm>

#include "equidem/grains/kernels/bond_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

/// Springs that bonds have; each one those before it, too.
enum class BondSprings { along, across, bending };

struct SpringKind {
  BondSprings springs = BondSprings::along;
  bool strengths = false;
  bool cell = false;
};

template <SpringKind kind>
struct Stretch {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, BondBatch& batch);
};

template <SpringKind kind>
template <class Lanes>
void Stretch<kind>::run(GrainSystem& system, BondBatch& batch) {
  constexpr bool turning = kind.springs != BondSprings::along, bending = kind.springs == BondSprings::bending;
  constexpr double little = 1e-9;  // for the rounding of loads
  PackedBonds& packed = system.bonds.packed;
  BodyImpulse* by_springs = packed.by_springs.data();
  for (std::size_t n = batch.first_body; n < batch.end_body; ++n) by_springs[packed.bodies[n]] = {};
  const bool deforms = kind.cell && system.cell.deforms;
  const double friction = packed.friction;
  Lanes nearest = all<Lanes>(1);
  ImageSums<Lanes> here, before;
  for (std::size_t g = batch.first_group; g < batch.end_group; ++g) {
    const BondGroup& group = packed.groups[g];
    const SpringGroup& spring = packed.springs[g];
    const BondNow<Lanes> now = bonds_now<Lanes, turning, kind.cell>(system, g);
    const auto rest_x = load<Lanes>(spring.rest_x), rest_y = load<Lanes>(spring.rest_y);
    const auto levers = load<Lanes>(spring.levers);
    const Lanes length = square_root(now.x * now.x + now.y * now.y), lengths = length + levers;
    nearest = smaller(length * load<Lanes>(group.per_reach), nearest);
    const Lanes q = 1 / (length * lengths), inverse = lengths * q;
    const Lanes nx = now.x * inverse, ny = now.y * inverse, dx = now.x - rest_x, dy = now.y - rest_y;
    // |l| - |l0| = (l² - l0²)/(|l| + |l0|)
    const Lanes stretch = (dx * (rest_x + now.x) + dy * (rest_y + now.y)) * (length * q);
    const Lanes normal = load<Lanes>(spring.normal) * stretch;
    Lanes x = normal * nx, y = normal * ny;  // on i
    Lanes tangential{}, moment{};
    Row<Lanes> rows[lanes_of_pairs];
    if constexpr (turning) {
      const Lanes turn = turn_of(rest_x * now.x + rest_y * now.y, rest_x * dy - rest_y * dx);
      const Lanes tilt_i = now.angle_i - load<Lanes>(spring.angle_i),
                  tilt_j = now.angle_j - load<Lanes>(spring.angle_j);
      const auto share_i = load<Lanes>(group.share);
      const Lanes mean = tilt_j + share_i * (tilt_i - tilt_j);
      tangential = load<Lanes>(spring.tangential) * (levers * without_whole_turns(turn - mean));
      const Lanes turned = levers * tangential, across = turned * inverse;
      x -= across * ny;
      y += across * nx;
      Lanes moment_i = share_i * turned, moment_j = turned - moment_i;
      if constexpr (bending) {
        moment = load<Lanes>(spring.bending) * (tilt_j - tilt_i);
        moment_i += moment;
        moment_j -= moment;
      }
      rows_of(x, y, moment_i, -moment_j, rows);
    } else {
      rows_of(x, y, Lanes{}, Lanes{}, rows);
    }
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      add(&by_springs[group.i[k]], turning ? third_twice(rows[k]) : rows[k]);
      subtract(&by_springs[group.j[k]], turning ? fourth_twice(rows[k]) : rows[k]);
    }
    if constexpr (kind.cell) {
      if (deforms) {
        const BondImages& images = packed.images[g];
        here.add(-x, -y, shift_of<Lanes>(system.cell.now, images));
        before.add(-x, -y, shift_of<Lanes>(system.cell.before, images));
      }
    }
    if constexpr (kind.strengths) {
      const StrengthGroup& strength = packed.strengths[g];
      const Lanes by_moment = magnitude(moment) * load<Lanes>(strength.per_moment);
      const Lanes pulled = normal + by_moment + little * (magnitude(normal) + by_moment);
      const Lanes along = magnitude(tangential);
      const Lanes sheared = along + friction * normal + little * (along + friction * magnitude(normal));
      const Bits<Lanes> reached =
          negative(load<Lanes>(strength.tension) - pulled) | negative(load<Lanes>(strength.shear) - sheared);
      if (any(reached)) batch.reached.push_back(g);
    }
  }
  take_nearest(nearest, batch);
  batch.here = here.sum();
  batch.before = before.sum();
}

template <SpringKind kind>
PackedBonds::Loop loop_of() {
  return by_vector_width<Stretch<kind>, GrainSystem&, BondBatch&>();
}

template <bool strengths, bool cell>
PackedBonds::Loop loop_of(BondSprings springs) {
  switch (springs) {
    case BondSprings::along:
      return loop_of<SpringKind{BondSprings::along, strengths, cell}>();
    case BondSprings::across:
      return loop_of<SpringKind{BondSprings::across, strengths, cell}>();
    case BondSprings::bending:
      break;
  }
  return loop_of<SpringKind{BondSprings::bending, strengths, cell}>();
}

}  // namespace

PackedBonds::Loop spring_loop(const GrainSystem& system) {
  if (system.bonds.packed.springs.empty()) return nullptr;
  BondSprings springs = BondSprings::along;
  for (const TiedPair& bond : system.bonds.tied) {
    if (bond.springs.springs.kT > 0) springs = std::max(springs, BondSprings::across);
    if (bond.springs.kM > 0) springs = BondSprings::bending;
  }
  const bool cell = system.cell.active;
  if (!system.bonds.packed.strengths.empty())
    return cell ? loop_of<true, true>(springs) : loop_of<true, false>(springs);
  return cell ? loop_of<false, true>(springs) : loop_of<false, false>(springs);
}

}  // namespace equidem
