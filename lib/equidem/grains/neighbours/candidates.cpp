// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <type_traits>

#include "equidem/contact/restitution.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/servo_walls.hpp"

namespace equidem {
namespace {

auto place(const Grain& grain) {
  return std::tuple(grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y, grain.spin,
                    grain.inertia.mass, grain.inertia.moment, grain.kind, grain.angle, grain.short_half_axis);
}

auto place(const Wall& wall) {
  return std::tuple(static_cast<int>(wall.shape), wall.point.x, wall.point.y, wall.normal.x, wall.normal.y, wall.end.x,
                    wall.end.y, wall.kind);
}

/// Clumps in one place differ by their discs, not by the caller's number of them.
bool has_lesser_discs(const Grain& a, const Grain& b, const std::vector<Clump>& clumps) {
  if (a.clump < 0 || b.clump < 0) return a.clump < 0 && b.clump >= 0;
  const auto less = [](const GrainPart& p, const GrainPart& q) {
    return std::tuple(p.offset.x, p.offset.y, p.a) < std::tuple(q.offset.x, q.offset.y, q.a);
  };
  const std::vector<GrainPart> of_a = parts_of(a, clumps), of_b = parts_of(b, clumps);
  return std::lexicographical_compare(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), less);
}

template <class Item, class Tie>
std::vector<std::size_t> sorted_by_place(const std::vector<Item>& items, const Tie& tie) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  auto end = order.end();
  if constexpr (std::is_same_v<Item, Grain>)  // absent ones follow by their numbers
    end = std::stable_partition(order.begin(), end, [&](std::size_t k) { return items[k].present; });
  std::stable_sort(order.begin(), end, [&](std::size_t a, std::size_t b) {
    const auto of_a = place(items[a]), of_b = place(items[b]);
    return of_a == of_b ? tie(items[a], items[b]) : of_a < of_b;
  });
  return order;
}

/// The place of each of so many numbers; -1: it has none.
std::vector<std::int32_t> inverse(const std::vector<std::size_t>& order, std::size_t count) {
  std::vector<std::int32_t> places(count, -1);
  for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = static_cast<std::int32_t>(k);
  return places;
}

}  // namespace

void order_by_place(GrainSystem& system, const GrainScene& scene, const std::vector<std::size_t>& order) {
  const auto lesser = [&](const Grain& a, const Grain& b) { return has_lesser_discs(a, b, scene.clumps); };
  system.bodies.order = order.empty() ? sorted_by_place(scene.grains, lesser) : order;
  for (const std::size_t number : system.bodies.order)
    if (scene.grains[number].present) system.bodies.grain_of.push_back(number);
  system.walls.wall_of = sorted_by_place(scene.walls, [](const Wall&, const Wall&) { return false; });
  system.bodies.place_of_grain = inverse(system.bodies.grain_of, scene.grains.size());
  system.walls.place_of_wall = inverse(system.walls.wall_of, scene.walls.size());
  system.scene = scene;
  for (const std::size_t number : system.bodies.grain_of) {
    const Grain& grain = scene.grains[number];
    system.bodies.constants.push_back({grain.radius, 1 / grain.inertia.mass, 1 / grain.inertia.moment, grain.kind});
    system.bodies.motions.push_back({grain.position, grain.velocity, grain.spin, grain.angle});
  }
  for (std::size_t k = 0; k < scene.walls.size(); ++k) system.scene.walls[k] = scene.walls[system.walls.wall_of[k]];
  system.walls.given = system.scene.walls;
  system.bodies.impulses.resize(system.bodies.motions.size());
  system.walls.places.resize(scene.walls.size());
  system.walls.loads.resize(scene.walls.size());
  place_parts(system);
}

namespace {

ExactPair exact_pair_of(const GrainSystem& system, const Candidate& candidate) {
  return system.law().prepare(candidate.reduced_mass, candidate.stiffness, candidate.dissipation,
                              system.properties(candidate.i, candidate.j).end, system.dt());
}

/// Order of partners of one body: grains ascending, then walls ascending.
std::uint32_t rank(std::int32_t j) {
  return j >= 0 ? static_cast<std::uint32_t>(j) : 0x80000000U + static_cast<std::uint32_t>(~j);
}

}  // namespace

void find_dissipations(GrainSystem& system) {
  for (const PairProperties& pair : system.scene.pairs) {
    system.dissipations.push_back(system.law().dissipation(pair.restitution, pair.end));
  }
}

ContactConstants constants_of(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  static constexpr GrainBody wall{};
  const GrainBody& bi = system.bodies.constants[i];
  const GrainBody& bj = j >= 0 ? system.bodies.constants[j] : wall;
  const double inverse_mass = bi.inverse_mass + bj.inverse_mass;
  const PairProperties& properties = system.properties(i, j);
  const double dt = system.dt(), length_factor = system.law().length_factor(system.length);
  ContactConstants constants;
  const double m = constants.reduced_mass = 1 / inverse_mass;
  constants.stiffness = properties.stiffness > 0
                            ? properties.stiffness
                            : stiffness_from_dimensionless(properties.dimensionless, m, dt) / length_factor;
  constants.a =
      properties.stiffness > 0 ? properties.stiffness * length_factor * dt * dt / m : properties.dimensionless;
  constants.dissipation = system.dissipations[&properties - system.scene.pairs.data()];
  if (properties.end == ContactEnd::at_zero_overlap) constants.least = -std::numeric_limits<double>::infinity();
  if (system.friction && properties.friction > 0) {
    Sliding& sliding = constants.sliding;
    sliding.coefficient = properties.friction;
    sliding.stiffness = properties.tangential_ratio * constants.stiffness * length_factor;
    // of bodies that just touch: it must not depend on where they were when they were found
    const double inverse =
        inverse_mass + bi.radius * bi.radius * bi.inverse_moment + bj.radius * bj.radius * bj.inverse_moment;
    sliding.dashpot = 2 * properties.tangential_damping * std::sqrt(1 / inverse * sliding.stiffness);
    constants.tangential_damping = 2 * properties.tangential_damping * std::sqrt(sliding.stiffness);
  }
  return constants;
}

EffectConstants effects_between(const GrainSystem& system, std::int32_t i, std::int32_t j, double stiffness) {
  const PairProperties& pair = system.properties(i, j);
  return {.rolling_friction = pair.rolling_friction,
          .rolling_stiffness = pair.rolling_ratio * stiffness * system.law().length_factor(system.length),
          .rolling_damping = pair.rolling_damping,
          .attraction = pair.cohesion,
          .range = pair.cohesion_range};
}

namespace {

/// The pairs of discs and the contacts of discs with walls of maps and simultaneous laws.
void find_single_contacts(GrainSystem& system, const NeighbourList& list) {
  std::vector<Candidate> before;
  std::vector<ExactPair> pairs_before;
  before.swap(system.contacts.candidates);
  pairs_before.swap(system.contacts.exact_pairs);
  const bool exact = is_simultaneous(system.options.law);
  std::size_t k = 0;
  const auto add = [&](std::size_t body, std::int32_t j) {
    const auto i = static_cast<std::int32_t>(body);
    const auto key = [](std::int32_t a, std::int32_t b) { return std::pair(a, rank(b)); };
    const auto key_before = [&] { return key(before[k].i, before[k].j); };
    while (k < before.size() && key_before() < key(i, j)) ++k;
    if (k < before.size() && key_before() == key(i, j)) {
      system.contacts.candidates.push_back(before[k]);
      if (exact) system.contacts.exact_pairs.push_back(pairs_before[k]);
      return;
    }
    Candidate candidate;
    static_cast<ContactConstants&>(candidate) = constants_of(system, i, j);
    candidate.i = i;
    candidate.j = j;
    system.contacts.candidates.push_back(candidate);
    if (exact) system.contacts.exact_pairs.push_back(exact_pair_of(system, candidate));
  };
  std::size_t next_bond = 0;
  for (std::size_t i = 0; i < system.bodies.constants.size(); ++i) {
    for (std::int64_t p = list.begin[i]; p < list.begin[i + 1]; ++p) {
      const std::int32_t j = list.partner[p];
      if (!are_tied(system.bonds.tied, next_bond, static_cast<std::int32_t>(i), j)) add(i, j);
    }
    for (std::size_t w = 0; w < system.scene.walls.size(); ++w) {
      const WallContact contact =
          nearest(system.scene.walls[w], system.walls.places[w].displacement, system.bodies.motions[i].position);
      if (contact.distance <= system.bodies.constants[i].radius + system.contacts.skin.margin)
        add(i, ~static_cast<std::int32_t>(w));
    }
  }
}

void find_neighbours(ContactList& contacts, const MovingCell& cell, double margin) {
  if (!cell.active) {
    contacts.neighbours = &contacts.finder.within(contacts.circles, margin);
    return;
  }
  NeighbourList& list = contacts.in_cell;
  std::vector<PeriodicImage>& images = contacts.images;
  list.begin.assign(contacts.circles.size() + 1, 0);
  images.clear();
  for (const CirclePair& pair : contacts.finder_in_cell.within(contacts.circles, cell.now, margin)) {
    if (pair.i == pair.j.body) continue;  // a body is far from its own images
    ++list.begin[pair.i + 1];
    images.push_back(pair.j);
  }
  for (std::size_t k = 1; k < list.begin.size(); ++k) {
    list.begin[k] += list.begin[k - 1];
    std::sort(images.begin() + list.begin[k - 1], images.begin() + list.begin[k]);
  }
  contacts.neighbours = &list;
}

}  // namespace

void find_candidates(GrainSystem& system) {
  ContactList& contacts = system.contacts;
  std::vector<Circle>& circles = contacts.circles;
  circles.clear();
  for (std::size_t i = 0; i < system.bodies.constants.size(); ++i)
    circles.push_back({system.bodies.motions[i].position, system.bodies.constants[i].radius});
  find_neighbours(contacts, system.cell, contacts.skin.margin + system.range);
  if (!gives_force(system.options.law)) find_single_contacts(system, *contacts.neighbours);
  find_near_lists(system);
  cover_joints(system);
  contacts.skin.moved = 0;
  ++system.counters.rebuilds;
}

bool refresh_candidates(GrainSystem& system, double reach) {
  ContactList& contacts = system.contacts;
  if (contacts.skin.holds(reach)) {
    contacts.skin.moved += reach;
    refresh_near_lists(system, reach);
    return false;
  }
  contacts.skin.margin = std::max(contacts.base_margin, 8 * reach);
  find_candidates(system);
  contacts.skin.moved = contacts.pairs.skin.moved = contacts.parts.skin.moved = reach;
  return true;
}

double reach_of(const GrainSystem& system) {
  double longest = system.longest_way;
  for (const WallPlace& wall : system.walls.places) {
    const Vec2 way = system.dt() * wall.velocity;
    if (dot(way, way) > longest) longest = dot(way, way);
  }
  return std::sqrt(longest) + longest_turn(system);
}

void forget_contact(Candidate& candidate, EnergyLedger& lost) {
  lost.lost_release += 0.5 * candidate.sliding.stiffness * candidate.stretch * candidate.stretch;
  candidate.stretch = 0;
  candidate.touching = candidate.parted = false;
  candidate.steps = 0;
  candidate.mode = 0;
  candidate.impulse = candidate.moment = candidate.tangential_impulse = 0;
}

void place_walls(GrainSystem& system) {
  const double now = system.time();
  const double next = static_cast<double>(system.step + 1) * system.dt();
  for (std::size_t w = 0; w < system.walls.places.size(); ++w) {
    const Wall& wall = system.scene.walls[w];
    if (!wall.moves() && system.step > 0) continue;  // where it always was, or servo_walls.hpp
    const Vec2 here = wall.displacement(now);
    const Vec2 there = wall.displacement(next);
    const Vec2 velocity = (there - here) / system.dt();
    system.walls.places[w] = {here, velocity, velocity, velocity};
    if (!system.options.verlet() || system.step == 0) continue;
    const double past = static_cast<double>(system.step - 1) * system.dt();
    const Vec2 before = wall.displacement(past);
    system.walls.places[w].acting_velocity = (there - before) / (2 * system.dt());
    system.walls.places[w].passed_velocity = (here - before) / system.dt();
  }
  if (!system.walls.servos.empty()) place_servo_walls(system);
}

}  // namespace equidem
