// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/core/simd.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/contacts/force_step.hpp"
#include "equidem/grains/kernels/slide_lanes.hpp"

namespace equidem {
namespace {

using namespace eight;

constexpr double none = std::numeric_limits<double>::infinity();

// These members are loaded and stored as one row.
static_assert(offsetof(Candidate, steps) - offsetof(Candidate, reduced_mass) == 3 * sizeof(double));
static_assert(offsetof(Candidate, stretch) - offsetof(Candidate, overlap) == 7 * sizeof(double));
static_assert(offsetof(Candidate, sliding) - offsetof(Candidate, stiffness) == sizeof(double));
static_assert(offsetof(Sliding, coefficient) == 2 * sizeof(double));
static_assert(offsetof(WallLoad, work) - offsetof(WallLoad, step_impulse) == 3 * sizeof(double));
static_assert(offsetof(Wall, normal) - offsetof(Wall, point) == sizeof(Vec2));
static_assert(offsetof(WallPlace, velocity) - offsetof(WallPlace, displacement) == sizeof(Vec2));
static_assert(offsetof(GrainBody, inverse_moment) - offsetof(GrainBody, radius) == 2 * sizeof(double) &&
              sizeof(GrainBody) == offsetof(GrainBody, radius) + 4 * sizeof(double));

/// Eight discs and the walls that they may touch.
struct NearWalls {
  Candidate* contact[lanes_of_pairs];
  std::size_t body[lanes_of_pairs], wall[lanes_of_pairs];
  unsigned touched = 0;  ///< bits of those that touched in the last step
  bool flat = true;      ///< all walls are lines, and no contact is covered

  NearWalls(GrainSystem& system, std::size_t first, std::size_t count) {
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      Candidate& candidate = system.contacts.candidates[first + std::min(k, count - 1)];
      contact[k] = &candidate;
      body[k] = static_cast<std::size_t>(candidate.i);
      wall[k] = static_cast<std::size_t>(~candidate.j);
      if (k < count && candidate.touching) touched |= 1U << k;
      flat = flat && !candidate.covered && system.scene.walls[wall[k]].shape == Wall::Shape::line;
    }
  }
};

/// Geometry with walls of any shape, one by one: overlap, and normal from the wall to the centre.
template <class Lanes>
void meet_walls(const GrainSystem& system, const NearWalls& near, Lanes& overlap, Lanes& nx, Lanes& ny) {
  PairLanes depth, x, y;
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const ContactGeometry geometry = geometry_of(system, *near.contact[k]);
    depth[k] = geometry.overlap;
    x[k] = -geometry.normal.x;
    y[k] = -geometry.normal.y;
  }
  overlap = load<Lanes>(depth);
  nx = load<Lanes>(x);
  ny = load<Lanes>(y);
}

template <class Law, bool friction>
struct CollideWithWalls {
  template <class Lanes>
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums);
};

/// As collide() of force_step.cpp, for eight contacts at once. The loop over pairs knows what other forces do to a body
/// in a step: PairBody::middle_velocity.
template <class Law, bool friction>
template <class Lanes>
void CollideWithWalls<Law, friction>::run(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums) {
  const double dt = system.dt();
  const double per_length = 1 / system.length, per_speed = dt / system.length, unit_speed = system.length / dt;
  const Vec2 half_fall = 0.5 * dt * system.scene.gravity;
  const Lanes zero{};
  Row<Lanes> lost{};  // by dashpots, slip, tangential dashpots; work of walls
  Lanes deepest{};
  for (std::size_t first = begin; first < end; first += lanes_of_pairs) {
    const std::size_t count = std::min(lanes_of_pairs, end - first);
    const NearWalls near(system, first, count);
    Lanes body[lanes_of_pairs];
    Row<Lanes> constants[lanes_of_pairs], shapes[lanes_of_pairs], places[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      body[k] = load<Lanes>(&system.contacts.near.bodies[near.body[k]].position.x);
      constants[k] = load<Row<Lanes>>(&system.bodies.constants[near.body[k]].radius);
      shapes[k] = load<Row<Lanes>>(&system.scene.walls[near.wall[k]].point.x);
      places[k] = load<Row<Lanes>>(&system.walls.places[near.wall[k]].displacement.x);
    }
    transpose(body);
    Lanes radius, inverse_mass, inverse_moment, unused, x, y, nx, ny, moved_x, moved_y, wall_u, wall_v;
    columns_of(constants, radius, inverse_mass, inverse_moment, unused);
    columns_of(shapes, x, y, nx, ny);
    columns_of(places, moved_x, moved_y, wall_u, wall_v);
    const Lanes from_x = body[0] - moved_x - x, from_y = body[1] - moved_y - y;
    Lanes overlap = radius - (nx * from_x + ny * from_y);
    if (!near.flat) [[unlikely]]
      meet_walls(system, near, overlap, nx, ny);
    // lanes behind the last contact are apart
    constexpr double largest[2 * lanes_of_pairs] = {none, none, none, none, none, none, none, none,
                                                    -1,   -1,   -1,   -1,   -1,   -1,   -1,   -1};
    overlap = smaller(overlap, load<Lanes>(largest + (lanes_of_pairs - count)));
    const Bits<Lanes> touch = negative(zero - overlap);
    alignas(64) constexpr long long bit[lanes_of_pairs] = {1, 2, 4, 8, 16, 32, 64, 128};
    const auto touching = static_cast<unsigned>(bits_of_all(touch & load<Bits<Lanes>>(bit)));
    const unsigned changed = touching ^ near.touched;
    if ((touching | changed) == 0) continue;
    for (std::size_t k = 0; changed != 0 && k < lanes_of_pairs; ++k) {
      if ((changed >> k & 1) == 0) continue;
      if ((touching >> k & 1) == 0) {
        forget_contact(*near.contact[k], sums.lost);
        continue;
      }
      near.contact[k]->touching = true;
      ++sums.contacts;
    }
    sums.evaluations += std::popcount(touching);
    deepest = larger(deepest, overlap);

    nx = -nx;  // from the disc to the wall
    ny = -ny;
    Row<Lanes> laws[lanes_of_pairs], springs[lanes_of_pairs];
    Lanes state[lanes_of_pairs];
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      laws[k] = load<Row<Lanes>>(&near.contact[k]->reduced_mass);
      state[k] = load<Lanes>(&near.contact[k]->overlap);
      if constexpr (friction) springs[k] = load<Row<Lanes>>(&near.contact[k]->stiffness);
    }
    transpose(state);
    Lanes mass, a, dissipation, steps;
    columns_of(laws, mass, a, dissipation, steps);
    Lanes &closing_before = state[1], &impulse_before = state[4], &tangential_before = state[6], &stretch = state[7];
    const Bits<Lanes> lasting = -bits_of(steps) >> 63;
    const Lanes u = wall_u - body[2], v = wall_v - body[3];
    const Lanes closing = -(u * nx + v * ny);
    const Lanes depth = only(touch, overlap * per_length), sigma = closing * per_speed;
    const Lanes spring = -Law::spring(a, depth);
    PairLanes pulls;
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) pulls[k] = near.contact[k]->attraction ? none : 0;
    const Lanes change =  // in this order a NaN persists
        only(touch, smaller(load<Lanes>(pulls), spring - Law::dashpot(dissipation, depth) * sigma));
    const Lanes unit = mass * unit_speed;
    const Lanes impulse = -change * unit;
    const Lanes by_others = only(lasting, closing - closing_before + impulse_before / mass);
    const Lanes heat = (spring - change) * unit * (closing + 0.5 * (change * unit_speed + by_others));
    Lanes px = impulse * nx, py = impulse * ny;
    Tangent<Lanes> tangent{};
    if constexpr (friction) {
      Lanes stiffness, tangential_stiffness, dashpot, coefficient;
      columns_of(springs, stiffness, tangential_stiffness, dashpot, coefficient);
      const Lanes compliance = 1 / choose(negative(zero - tangential_stiffness), tangential_stiffness, all<Lanes>(1));
      const LawLanes<Lanes> law = law_lanes(zero, zero, coefficient, tangential_stiffness, compliance, dt);
      const Lanes mobility = 0.5 * (inverse_mass + radius * radius * inverse_moment);
      // at the middle of the step as other forces make it: half of what the last step did
      const Lanes middle_u = wall_u - body[4] - half_fall.x, middle_v = wall_v - body[5] - half_fall.y;
      const Lanes velocity = middle_v * nx - middle_u * ny - body[6] - mobility * tangential_before;
      tangent = slide<false, false>(law, dashpot * dt, stretch, velocity, zero, mobility, zero,
                                    coefficient * larger(impulse, zero), dt);
      const Lanes tangential = -only(touch, tangent.impulse);
      px -= tangential * ny;
      py += tangential * nx;
      tangential_before = tangential;
      stretch = only(touch, tangent.stretch);
    } else {
      tangential_before = zero;  // the friction of an earlier stage may have left one
    }
    state[0] = overlap;
    closing_before = closing;
    state[2] = nx;
    state[3] = ny;
    impulse_before = impulse;
    const Lanes work = -(px * wall_u + py * wall_v);
    const Lanes turn = (from_x + radius * nx) * py - (from_y + radius * ny) * px;
    Row<Lanes> row[lanes_of_pairs], pushes[lanes_of_pairs];
    rows_of(only(touch, heat), only(touch, tangent.slip_loss), only(touch, tangent.dashpot_loss), work, row);
    for (const Row<Lanes>& one : row) lost += one;
    rows_of(px, py, turn, work, row);
    rows_of(px, py, zero, tangential_before, pushes);
    rows_of(mass, a, dissipation, as<Lanes>((bits_of(steps) + 1) & touch), laws);
    transpose(state);
    for (std::size_t k = 0; k < count; ++k) {
      add(&sums.on_walls[near.wall[k]].step_impulse, row[k]);
      subtract(&system.bodies.impulses[near.body[k]], pushes[k]);
      store(laws[k], &near.contact[k]->reduced_mass);
      store(state[k], &near.contact[k]->overlap);
    }
  }
  double each[4];
  store(lost, each);
  sums.lost.lost_dashpot += each[0];
  sums.lost.lost_slip += each[1];
  sums.lost.lost_tangential_dashpot += each[2];
  sums.lost.work_of_walls += each[3];
  PairLanes deep;
  store(deepest, deep);
  for (const double one : deep) sums.deepest = std::max(sums.deepest, one);
}

}  // namespace

CandidateLoop wall_loop(const GrainSystem& system) {
  if (!system.contacts.near.active || !system.shapes.parts.empty() || system.options.verlet()) return nullptr;
  return visit_law(system.options.law, [&]<class Law>(std::type_identity<Law>) -> CandidateLoop {
    if constexpr (Law::kind == LawKind::force) {
      const auto choose = [&]<bool friction>() {
        return by_vector_width<CollideWithWalls<Law, friction>, GrainSystem&, std::size_t, std::size_t, BlockSums&>();
      };
      return system.friction ? choose.template operator()<true>() : choose.template operator()<false>();
    } else {
      return nullptr;
    }
  });
}

}  // namespace equidem
