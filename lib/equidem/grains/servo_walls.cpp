// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/servo_walls.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The loop of a servo wall. Bodies in a row give way: of the stiffness k of its contacts the wall meets the share c,
/// some 1/13 across 12 discs. With the relaxation r, the missing force e and the share s of the last step in the mean
/// speed u, a step changes e by -c (r e + k dt u) and u by s r e/(k dt): modes that fall by the factor 1 + z, z² + c r
/// z + c s r = 0, damped by the ratio sqrt(c r/s)/2. It must not fall with r: s is share_of_pace times r. As u sums up
/// e, the force runs past W after a step of W, by some tenth of that step. Thus u follows freely only where e is below
/// near_share of W, beyond it by the square of near_share W/e; at a limit of the speed it waits.
///
/// Before W is reached waves decide. A wall that moves at v sends a wave into the bodies and pushes them by Z v more;
/// the impedance Z is the sum of sqrt(k m) over its contacts, that of a chain of masses m and springs k for long waves.
/// The wave doubles where another wall, or the middle between two mirrors, throws it back. Nowhere are bodies pushed
/// beyond W if the wall comes in at (W - F)/(2 Z) at most. Afterwards it follows bodies that give way as fast as they
/// do: to come in so slowly then would leave them without their stress while they rearrange.
constexpr double share_of_pace = 0.04, near_share = 0.1, largest_push = 0.05;

std::size_t place_of_name(const GrainScene& scene, const std::string& name) {
  const auto found = std::ranges::find(scene.walls, name, &Wall::name);
  return static_cast<std::size_t>(found - scene.walls.begin());
}

const Servo& servo_of(const GrainSystem& system, const ServoState& state) {
  return *system.scene.walls[state.wall].servo;
}

Vec2 normal_of(const Wall& wall) {
  if (wall.shape == Wall::Shape::line) return wall.normal;
  const Vec2 along = wall.end - wall.point;
  return perpendicular(along) / norm(along);
}

/// Distance of two walls along a servo wall, m.
double length_between(const GrainSystem& system, const ServoState& state) {
  const Wall& wall = system.scene.walls[state.wall];
  const Vec2 along = perpendicular(normal_of(wall));
  const Vec2 from = wall.point + system.walls.places[state.wall].displacement;
  const auto place = [&](std::size_t other) {
    const Wall& bound = system.scene.walls[other];
    const Vec2 normal = normal_of(bound);
    return dot(normal, bound.point + system.walls.places[other].displacement - from) / dot(normal, along);
  };
  return std::abs(place(state.between[1]) - place(state.between[0]));
}

double wanted_force(const GrainSystem& system, const ServoState& state) {
  const Servo& servo = servo_of(system, state);
  const double wanted = servo.wanted.at(system.time());
  if (!servo.is_stress) return wanted;
  const double length = servo.length > 0 ? servo.length : length_between(system, state);
  if (length > 1e-6 * state.farthest) return wanted * length;
  throw Error(ErrorKind::computation_failed,
              fmt::format("step {}: walls '{}' and '{}' have met", system.step, servo.between[0], servo.between[1]),
              fmt::format("no length is left between them on which the stress of wall '{}' acts",
                          system.scene.walls[state.wall].name),
              "Put stops between them, or limit their motion", servo.place);
}

/// Resistance of the contacts on a wall against a motion along a direction.
struct WallResistance {
  double spring = 0;     ///< sum of k dt, N s/m
  double dashpot = 0;    ///< sum of c, N s/m
  double impedance = 0;  ///< sum of sqrt(k m), N s/m
};

WallResistance resistance_of(const GrainSystem& system, std::size_t wall, Vec2 direction) {
  WallResistance sum;
  const auto add = [&](Vec2 normal, double overlap, const ContactConstants& constants) {
    const double along = dot(normal, direction), across = cross(normal, direction);
    const ContactResistance of = resistance_of(system, constants, overlap);
    sum.spring += system.dt() * (of.k_n * along * along + of.k_t * across * across);
    sum.impedance += std::sqrt(of.k_n * constants.reduced_mass) * along * along;
    sum.dashpot += of.c_n * along * along + of.c_t * across * across;
  };
  const std::int32_t j = ~static_cast<std::int32_t>(wall);
  for (const NearList& list : system.contacts.of(Between::walls).blocks) {
    for (std::size_t p = 0; p < list.count; ++p) {
      if (static_cast<std::size_t>(list.second(p)) != wall || !list.touching(p)) continue;
      const ContactState contact = state_of(system, list, p);
      add(contact.normal, contact.overlap, constants_of(system, contact.i, j));
    }
  }
  for (const Candidate& candidate : system.contacts.candidates)
    if (candidate.j == j && candidate.touching && candidate.steps > 0)
      add(candidate.normal, candidate.overlap, candidate);
  return sum;
}

/// A spring k d^p stores F^((p + 1)/p) k^(-1/p)/(p + 1) at the force F. A body of mass m that comes at the speed
/// sqrt(2/((p + 1) m)) k^(-1/(2 p)) F^((p + 1)/(2 p)) has that energy: F/sqrt(k m) for p = 1. \return the power of F
double exponent_of_push(const GrainSystem& system) {
  const double p = system.law().spring_power;
  return (p + 1) / (2 * p);
}

/// The least speed at which one of the bodies pushes a wall by 1 N, m/s.
double speed_of_push(const GrainSystem& system, std::size_t wall) {
  const double p = system.law().spring_power;
  double least = INFINITY;
  for (std::size_t body = 0; body < system.bodies.constants.size(); ++body) {
    const ContactConstants of = constants_of(system, static_cast<std::int32_t>(body), ~static_cast<std::int32_t>(wall));
    least = std::min(least, std::sqrt(2 / ((p + 1) * of.reduced_mass)) * std::pow(of.stiffness, -0.5 / p));
  }
  return least;
}

/// The speed that the wall does not exceed, m/s: a given one, or that at which a body pushes it by largest_push of W,
/// or of F where that is larger.
double limit_of(const GrainSystem& system, const ServoState& state) {
  const Servo& servo = servo_of(system, state);
  if (servo.max_speed) return *servo.max_speed;
  const double push = largest_push * std::max(state.wanted, state.present);
  return state.speed_of_push * std::pow(push, exponent_of_push(system));
}

void steer(GrainSystem& system, ServoState& state) {
  const Servo& servo = servo_of(system, state);
  const double per_step = 1 / system.dt();
  state.way += system.dt() * state.rate;
  state.free_way += std::abs(system.dt() * state.rate);
  state.passed_speed = state.rate;
  WallResistance resistance = resistance_of(system, state.wall, servo.direction);
  state.present = -per_step * dot(system.walls.loads[state.wall].step_impulse, servo.direction);
  if (state.mirror != state.wall) {
    const WallResistance other = resistance_of(system, state.mirror, servo.direction);
    resistance = {0.5 * (resistance.spring + other.spring), 0.5 * (resistance.dashpot + other.dashpot),
                  0.5 * (resistance.impedance + other.impedance)};
    state.present =
        0.5 * (state.present + per_step * dot(system.walls.loads[state.mirror].step_impulse, servo.direction));
  }
  state.wanted = wanted_force(system, state);
  const double most = limit_of(system, state), impedance = resistance.impedance;
  if (resistance.spring + resistance.dashpot > 0) {
    state.touched = true;
    state.free_way = 0;
    const double missing = state.wanted - state.present;
    const double asked = state.asked_rate(servo.relaxation, resistance.spring, resistance.dashpot);
    const double by_waves = !state.arrived && missing > 0 ? 0.5 * missing / impedance : INFINITY;
    state.rate = std::clamp(asked, -most, std::min(most, by_waves));
    const double near = near_share * state.wanted, approach = std::abs(missing) <= near ? 1 : near / missing;
    if (state.rate == asked)
      state.mean_rate += share_of_pace * servo.relaxation * approach * approach * (state.rate - state.mean_rate);
  } else {
    state.rate = state.wanted > 0 ? most : 0;
    state.mean_rate = 0;
  }
  state.count(state.touched, impedance > 0 ? std::min(1.0, resistance.spring / impedance) : 1);
  if (state.free_way <= state.farthest) return;
  throw Error(ErrorKind::computation_failed,
              fmt::format("step {}: the servo wall '{}' has gone {:.3g} m and met no body", system.step,
                          system.scene.walls[state.wall].name, state.free_way),
              fmt::format("all bodies and walls lay in {:.3g} m, and nothing pushes back", state.farthest),
              "Let it push towards bodies, and hold them by walls on the other side", servo.place);
}

/// \param key of the table of the servo that is wrong; empty: the table
[[noreturn]] void refuse_servo_wall(const Wall& wall, const std::string& what, const std::string& why,
                                    const std::string& remedy, const std::string& key = {}) {
  const std::string& place = wall.servo->place;
  bad_input_at(place.empty() || key.empty() ? place : place + "." + key,
               fmt::format("the servo of wall '{}' {}", wall.name, what), why, remedy);
}

void check_mirror(const GrainScene& scene, const Wall& wall) {
  const Servo& servo = *wall.servo;
  const std::size_t mirror = place_of_name(scene, servo.mirror);
  if (mirror == scene.walls.size())
    refuse_servo_wall(wall, fmt::format("has the mirror '{}'", servo.mirror), "there is no wall of that name",
                      "Name another wall of the scene", "mirror");
  if (servo.mirror == wall.name)
    refuse_servo_wall(wall, "moves that wall as its own mirror", "a mirror is another wall", "Name another wall",
                      "mirror");
  if (scene.walls[mirror].servo)
    refuse_servo_wall(wall, fmt::format("moves '{}' as its mirror", servo.mirror), "that wall has a servo itself",
                      "Give one of the two walls a servo", "mirror");
  for (const Wall& other : scene.walls)
    if (other.servo && &other != &wall && other.servo->mirror == servo.mirror)
      refuse_servo_wall(wall, fmt::format("moves '{}' as its mirror", servo.mirror),
                        fmt::format("that of wall '{}' does so too", other.name), "Let one of them move it", "mirror");
}

/// The largest displacement of a wall by its schedules along a direction, either way, m.
double displaced_along(const Wall& wall, Vec2 direction) {
  const auto values = [](const Schedule& schedule) {
    std::vector<double> all{schedule.value};
    all.insert(all.end(), schedule.values.begin(), schedule.values.end());
    return all;
  };
  const std::vector<double> x = values(wall.move_x), y = values(wall.move_y);
  double most = 0;
  for (std::size_t k = 0; k < std::max(x.size(), y.size()); ++k)
    most = std::max(most, std::abs((k < x.size() ? x[k] * direction.x : 0) + (k < y.size() ? y[k] * direction.y : 0)));
  return most;
}

/// \param owner wall with the servo
void check_along(const Wall& wall, Vec2 direction, const Wall& owner) {
  if (displaced_along(wall, direction) <= 1e-9 * displaced_along(wall, perpendicular(direction))) return;
  refuse_servo_wall(owner, fmt::format("moves wall '{}' along ({:.3g}, {:.3g})", wall.name, direction.x, direction.y),
                    "a displacement, a velocity or a shaking moves that wall along it as well",
                    "Leave out that motion, or give it a direction across that of the servo");
}

void check_length_of_stress(const GrainScene& scene, const Wall& wall) {
  const Servo& servo = *wall.servo;
  if (!servo.is_stress || servo.length > 0) return;
  for (const std::string& name : servo.between) {
    const std::string key = &name == servo.between.data() ? "from" : "to";
    const std::size_t found = place_of_name(scene, name);
    if (found == scene.walls.size() || name == wall.name)
      refuse_servo_wall(wall, fmt::format("is a stress between '{}' and '{}'", servo.between[0], servo.between[1]),
                        fmt::format("'{}' is no other wall", name), "Name two other walls, or give the length", key);
    const Wall& bound = scene.walls[found];
    if (std::abs(dot(normal_of(bound), normal_of(wall))) > 1 - 1e-9)
      refuse_servo_wall(wall, fmt::format("is a stress whose length '{}' bounds", name), "that wall does not cross it",
                        "Name walls at an angle to it, or give the length", key);
  }
  if (servo.between[0] == servo.between[1])
    refuse_servo_wall(wall, fmt::format("is a stress between '{}' and itself", servo.between[0]),
                      "the length on which it acts is that between two walls", "Name another wall, or give the length",
                      "to");
}

}  // namespace

void check_servos(const GrainScene& scene, NormalLaw law) {
  for (const Wall& wall : scene.walls) {
    if (!wall.servo) continue;
    if (is_map(law))
      refuse_servo_wall(wall, fmt::format("meets bodies by the law {}", to_string(law)),
                        "a map gives impulses and no force that could be held",
                        fmt::format("Use exact_flow, {}", names_of_laws(LawKind::force)));
    check_length_of_stress(scene, wall);
    check_along(wall, wall.servo->direction, wall);
    if (wall.servo->mirror.empty()) continue;
    check_mirror(scene, wall);
    check_along(scene.walls[place_of_name(scene, wall.servo->mirror)], wall.servo->direction, wall);
  }
}

ContactResistance resistance_along(const LawDescription& law, double stiffness, double dashpot, double overlap) {
  return {.k_n = law.spring_power * stiffness * std::pow(overlap, law.spring_power - 1),
          .c_n = law.dashpot != nullptr ? law.dashpot(dashpot, overlap) : dashpot};
}

ContactResistance resistance_of(const GrainSystem& system, const ContactConstants& constants, double overlap) {
  ContactResistance of =
      resistance_along(system.law(), constants.stiffness, constants.dashpot(), std::max(overlap, 0.0));
  of.k_t = constants.sliding.stiffness;
  of.c_t = constants.sliding.dashpot;
  return of;
}

void find_servos(GrainSystem& system) {
  for (std::size_t w = 0; w < system.scene.walls.size(); ++w) {
    const Wall& wall = system.scene.walls[w];
    if (!wall.servo) continue;
    const auto place = [&](const std::string& name) { return name.empty() ? w : place_of_name(system.scene, name); };
    ServoState state;
    state.wall = w;
    state.mirror = place(wall.servo->mirror);
    if (!wall.servo->max_speed) state.speed_of_push = speed_of_push(system, w);
    for (std::size_t k = 0; k < 2; ++k) state.between[k] = place(wall.servo->between[k]);
    system.walls.servos.push_back(state);
  }
}

void limit_free_way(GrainSystem& system) {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  const auto include = [&](Vec2 point, double radius) {
    low = {std::min(low.x, point.x - radius), std::min(low.y, point.y - radius)};
    high = {std::max(high.x, point.x + radius), std::max(high.y, point.y + radius)};
  };
  for (std::size_t k = 0; k < system.bodies.motions.size(); ++k)
    include(system.bodies.motions[k].position, system.bodies.constants[k].radius);
  for (std::size_t w = 0; w < system.scene.walls.size(); ++w) {
    const Wall& wall = system.scene.walls[w];
    const Vec2 moved = system.walls.places[w].displacement;
    include(wall.point + moved, 0);
    if (wall.shape == Wall::Shape::segment) include(wall.end + moved, 0);
  }
  for (ServoState& state : system.walls.servos) state.farthest = norm(high - low);
}

void steer_walls(GrainSystem& system) {
  for (ServoState& state : system.walls.servos) steer(system, state);
}

void place_servo_walls(GrainSystem& system) {
  const bool verlet = system.options.verlet();
  const auto add = [&](const ServoState& state, std::size_t wall, Vec2 direction) {
    WallPlace& place = system.walls.places[wall];
    if (!system.scene.walls[wall].moves()) place = {};
    const double acting = verlet && system.step > 0 ? 0.5 * (state.rate + state.passed_speed) : state.rate;
    const double passed = verlet && system.step > 0 ? state.passed_speed : state.rate;
    place.displacement += state.way * direction;
    place.velocity += state.rate * direction;
    place.acting_velocity += acting * direction;
    place.passed_velocity += passed * direction;
  };
  for (const ServoState& state : system.walls.servos) {
    const Vec2 direction = servo_of(system, state).direction;
    add(state, state.wall, direction);
    if (state.mirror != state.wall) add(state, state.mirror, -direction);
  }
}

std::vector<ServoReport> reports_of(const GrainSystem& system) {
  std::vector<const ServoState*> states;
  for (const ServoState& state : system.walls.servos) states.push_back(&state);
  std::ranges::sort(states, {}, [&](const ServoState* state) { return system.walls.wall_of[state->wall]; });
  std::vector<ServoReport> reports;
  for (const ServoState* state : states)
    reports.push_back({state->report(), system.scene.walls[state->wall].name, servo_of(system, *state).mirror,
                       state->touched, limit_of(system, *state)});
  return reports;
}

}  // namespace equidem
