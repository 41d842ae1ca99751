// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small scenes of bodies that collide.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "equidem/contact/restitution.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/grains/grain_simulation.hpp"

namespace equidem::test {

inline constexpr std::array all_laws{NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot, NormalLaw::five_case_map,
                                     NormalLaw::energy_map, NormalLaw::exact_flow};
using GrainIntegrator = GrainOptions::Integrator;

/// A law and a way to step that go together.
struct Stepping {
  NormalLaw law = NormalLaw::exact_flow;
  GrainIntegrator integrator = GrainIntegrator::semi_implicit_euler;
  [[nodiscard]] std::string name() const {
    return to_string(law) + (integrator == GrainIntegrator::velocity_verlet ? ", velocity_verlet" : "");
  }
};
inline const std::vector<Stepping> all_steppings{{NormalLaw::linear_dashpot, GrainIntegrator::semi_implicit_euler},
                                                 {NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet},
                                                 {NormalLaw::hertz_dashpot, GrainIntegrator::semi_implicit_euler},
                                                 {NormalLaw::hertz_dashpot, GrainIntegrator::velocity_verlet},
                                                 {NormalLaw::five_case_map, GrainIntegrator::semi_implicit_euler},
                                                 {NormalLaw::energy_map, GrainIntegrator::semi_implicit_euler},
                                                 {NormalLaw::exact_flow, GrainIntegrator::semi_implicit_euler}};
/// Those of laws that give forces, or of the others.
inline std::vector<Stepping> steppings_by_force(bool force) {
  std::vector<Stepping> found;
  for (const Stepping& stepping : all_steppings)
    if (gives_force(stepping.law) == force) found.push_back(stepping);
  return found;
}
/// Shapes, cells and vectors take these.
inline const std::vector<Stepping> force_steppings = steppings_by_force(true);
/// Of bonds that break.
inline const std::vector<Stepping> spring_bond_steppings(force_steppings.begin(), force_steppings.begin() + 3);
/// Of walls that follow a force.
inline const std::vector<Stepping> servo_steppings{all_steppings[0], all_steppings[1], all_steppings[2],
                                                   all_steppings[6]};
inline const std::vector<Stepping> stage_steppings{all_steppings[0], all_steppings[1], all_steppings[3],
                                                   all_steppings[5], all_steppings[6]};
/// Those that keep the balance of one contact to round-off.
inline const std::vector<NormalLaw> exact_laws{NormalLaw::five_case_map, NormalLaw::energy_map, NormalLaw::exact_flow};

/// Of mass 1 unless said, by default with the inertia of a disc.
inline Grain ball(Vec2 position, double radius, Vec2 velocity = {}, double mass = 1, double beta = 0.5) {
  Grain grain;
  grain.position = position;
  grain.radius = radius;
  grain.velocity = velocity;
  grain.inertia = {mass, beta * mass * radius * radius};
  return grain;
}

inline Wall line(std::string name, Vec2 point, Vec2 normal) {
  Wall wall;
  wall.name = std::move(name);
  wall.point = point;
  wall.normal = normal;
  return wall;
}

inline Wall segment(std::string name, Vec2 from, Vec2 to) {
  Wall wall = line(std::move(name), from, {0, 1});
  wall.shape = Wall::Shape::segment;
  wall.end = to;
  return wall;
}

/// Contacts of w = sqrt(k/m) = pi for the reduced mass given: an impact with e = 1 lasts one second. hertz_dashpot: for
/// a closing speed of 1 m/s.
inline PairProperties one_second(NormalLaw law, double restitution, double reduced_mass = 1) {
  PairProperties pair;
  pair.restitution = restitution;
  pair.stiffness = reduced_mass * std::numbers::pi * std::numbers::pi;
  if (law == NormalLaw::hertz_dashpot) {
    const double overlap = 1 / hertz_impact(1, 1, 1).duration * hertz_impact(1, 1, 1).overlap;
    pair.stiffness = 1.25 * reduced_mass / std::pow(overlap, 2.5);
  }
  return pair;
}

inline GrainScene scene_of(std::vector<Grain> grains, std::vector<Wall> walls, const PairProperties& pair,
                           Vec2 gravity = {}) {
  GrainScene scene;
  scene.grains = std::move(grains);
  scene.walls = std::move(walls);
  scene.gravity = gravity;
  scene.pairs = {pair};
  return scene;
}

inline GrainOptions options_of(Stepping stepping, double step) {
  GrainOptions options;
  options.law = stepping.law;
  options.integrator = stepping.integrator;
  options.time_step = step;
  return options;
}
inline GrainOptions options_of(NormalLaw law, double step) {
  return options_of(Stepping{law, GrainIntegrator::semi_implicit_euler}, step);
}

/// The largest difference of places, velocities, spins and angles of the same bodies.
inline double distance_of(const std::vector<Grain>& a, const std::vector<Grain>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    largest = std::max({largest, norm(a[k].position - b[k].position), norm(a[k].velocity - b[k].velocity),
                        std::abs(a[k].spin - b[k].spin), std::abs(a[k].angle - b[k].angle)});
  return largest;
}

struct Momenta {
  Vec2 linear;
  double angular = 0;  ///< about the origin
};
inline Momenta momenta_of(const std::vector<Grain>& grains) {
  Momenta sum;
  for (const Grain& grain : grains) {
    sum.linear += grain.inertia.mass * grain.velocity;
    sum.angular += grain.inertia.mass * cross(grain.position, grain.velocity) + grain.inertia.moment * grain.spin;
  }
  return sum;
}

/// The overlap of a contact at rest under a force.
inline double overlap_under(double force, NormalLaw law, double stiffness) {
  return std::pow(force / stiffness, law == NormalLaw::hertz_dashpot ? 2.0 / 3 : 1.0);
}

/// Step until something touched and nothing touches any more.
/// \return whether that happened
inline bool pass_contact(GrainSimulation& simulation, std::int64_t most_steps) {
  for (std::int64_t k = 0; k < most_steps; ++k) {
    simulation.advance(1);
    if (simulation.counters().contacts > 0 && simulation.contacts().empty()) return true;
  }
  return false;
}

/// All that a user can see of a state, bit by bit.
struct Bits {
  std::vector<std::uint64_t> words;
  bool operator==(const Bits&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const Bits& bits) {
    std::uint64_t mixed = bits.words.size();
    for (const std::uint64_t word : bits.words) mixed = (mixed ^ word) * 0x9e3779b97f4a7c15ULL;
    return out << bits.words.size() << " numbers, " << std::hex << mixed << std::dec;
  }
};
inline Bits bits_of(const GrainSimulation& simulation) {
  std::vector<std::uint64_t> bits{static_cast<std::uint64_t>(simulation.step())};
  const auto add = [&](std::initializer_list<double> numbers) {
    for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  };
  for (const Grain& g : simulation.present_grains()) {
    add({g.position.x, g.position.y, g.velocity.x, g.velocity.y, g.spin, g.angle});
  }
  for (const GrainContact& c : simulation.contacts()) {
    bits.push_back(static_cast<std::uint64_t>(c.i) << 32 | static_cast<std::uint32_t>(c.j));
    bits.push_back(static_cast<std::uint64_t>(c.steps) << 8 | static_cast<std::uint64_t>(c.mode));
    add({c.overlap, c.closing, c.normal.x, c.normal.y, c.normal_force, c.tangential_force});
  }
  const EnergyLedger l = simulation.energy();
  add({l.kinetic, l.elastic_normal, l.elastic_tangential, l.potential, l.lost_restitution, l.lost_dashpot, l.lost_slip,
       l.lost_tangential_dashpot, l.lost_release, l.work_of_walls, l.initial, l.elastic_bond, l.lost_bond});
  return {std::move(bits)};
}

/// Those, and the forces on bodies and walls, which the next step does not need.
inline Bits bits_and_loads_of(const GrainSimulation& simulation) {
  std::vector<std::uint64_t> bits = bits_of(simulation).words;
  const auto add = [&](std::initializer_list<double> numbers) {
    for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  };
  for (const BodyContact& c : simulation.body_contacts()) {
    bits.push_back(static_cast<std::uint64_t>(c.i) << 32 | static_cast<std::uint32_t>(c.j));
    add({c.arm.x, c.arm.y, c.shift.x, c.shift.y, c.force.x, c.force.y, c.normal_force, c.tangential_force,
         c.bending_moment});
  }
  for (const WallState& w : simulation.walls())
    add({w.place.x, w.place.y, w.velocity.x, w.velocity.y, w.force.x, w.force.y, w.moment, w.impulse.x, w.impulse.y,
         w.work});
  for (const ServoReport& s : simulation.servos())
    add({s.wanted, s.present, s.max_speed, s.overshoot, s.peak, s.mean_error});
  if (const auto c = simulation.cell())
    add({c->width, c->height, c->shift, c->strain.xx, c->strain.yy, c->strain.xy, c->stress.xx, c->stress.xy,
         c->stress.yx, c->stress.yy, c->coordination_number});
  const EnergyLedger ledger = simulation.energy();
  for (const EnergyTerm& term : energy_terms(BodyFamily::colliding)) add({ledger.*term.value});
  return {std::move(bits)};
}

/// Discs of several sizes thrown about in a box with friction, gravity and a floor that shakes: everything that a
/// contact remembers is in use.
inline GrainScene busy_box(NormalLaw law, int columns, int rows, std::uint64_t seed) {
  Random random(seed);
  std::vector<Grain> grains;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const double radius = random.uniform(0.3, 0.49);
      const Vec2 velocity{random.uniform(-1, 1), random.uniform(-1, 1)};
      Grain grain = ball({i + 0.5, j + 0.5}, radius, velocity, 4 * radius * radius);
      grain.spin = random.uniform(-1, 1);
      grains.push_back(grain);
    }
  }
  std::vector<Wall> walls{line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}),
                          line("right", {1.0 * columns, 0}, {-1, 0}), line("lid", {0, 1.0 * rows}, {0, -1})};
  walls[0].move_x = {Schedule::Kind::sine, 0.2, 0, 0, 0.5};
  walls[0].move_y = {Schedule::Kind::sine, -0.02, 0, 0, 1.5};
  PairProperties pair = one_second(law, 0.8, 0.5);
  pair.stiffness *= 100;  // a tenth of a second
  pair.friction = 0.4;
  pair.tangential_ratio = 0.5;
  pair.tangential_damping = 0.1;
  return scene_of(std::move(grains), std::move(walls), pair, {0, -1});
}

inline Wall pushing(Wall wall, double force, double max_speed = 0.1) {
  wall.servo = Servo{.direction = wall.normal, .wanted = {.value = force}, .max_speed = max_speed};
  return wall;
}

/// Columns of discs that touch one another between a floor, two walls and a lid that presses them, stiffer than their
/// load by 100, damped.
inline GrainScene pressed_columns(NormalLaw law, double force, double friction = 0, double restitution = 0.3,
                                  double lid = 4.05) {
  std::vector<Grain> grains;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) grains.push_back(ball({i + 0.5, j + 0.5}, 0.5));
  PairProperties pair = one_second(law, restitution, 0.5);
  pair.stiffness *= 1000;
  pair.friction = friction;
  pair.tangential_ratio = 0.5;
  return scene_of(grains,
                  {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}), line("right", {4, 0}, {-1, 0}),
                   pushing(line("lid", {0, lid}, {0, -1}), force)},
                  pair);
}

/// Its walls stand.
inline GrainScene still(GrainScene scene) {
  for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
  return scene;
}

/// With rolling resistance and cohesion. \param attraction N
inline GrainScene with_effects(GrainScene scene, double attraction = 1) {
  for (PairProperties& pair : scene.pairs) {
    pair.rolling_friction = 0.3;
    pair.rolling_ratio = 0.4;
    pair.rolling_damping = 0.2;
    pair.cohesion = attraction;
    pair.cohesion_range = 0.03;
  }
  return scene;
}

}  // namespace equidem::test
