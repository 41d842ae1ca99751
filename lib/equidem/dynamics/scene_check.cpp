// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/dynamics/scene_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

namespace {

/// A component of the motion of a disc.
struct Component {
  const char *name, *velocity_key;
  std::optional<Schedule> TimedSupport::*motion;
  double (*velocity)(const InitialVelocity&);
};
constexpr Component components[] = {
    {"ux", "velocity", &TimedSupport::ux, [](const InitialVelocity& v) { return v.velocity.x; }},
    {"uy", "velocity", &TimedSupport::uy, [](const InitialVelocity& v) { return v.velocity.y; }},
    {"rotation", "spin", &TimedSupport::rotation, [](const InitialVelocity& v) { return v.spin; }}};

class SceneCheck {
 public:
  SceneCheck(const Scene& scene, const PlaceInScene& where) : scene_(scene), where_(where) {}

  void velocities(bool rotation) const {
    std::map<std::int32_t, const InitialVelocity*> given;  // disc -> velocity
    for (std::size_t k = 0; k < scene_.velocities.size(); ++k) {
      const InitialVelocity& velocity = scene_.velocities[k];
      for (const std::int32_t disc : discs_of(velocity)) {
        const auto [earlier, is_new] = given.emplace(disc, &velocity);
        if (is_new) continue;
        fail(fmt::format("velocity.{}.group", k), fmt::format("disc {} has two velocities at the start", disc),
             fmt::format("it is in '{}' and in '{}'", earlier->second->group, velocity.group),
             "Choose groups that share no disc");
      }
      if (velocity.spin == 0 || rotation) continue;
      fail(fmt::format("velocity.{}.spin", k),
           fmt::format("'{}' has a spin at the start, and rotations are no unknowns of this scene", velocity.group),
           scene_.springs.any_tangential() ? "they are restrained" : "kT = 0 everywhere: the spin would change nothing",
           "Remove the spin");
    }
  }

  /// Two supports may prescribe the same motion of a disc; no velocity is given where one prescribes the motion.
  void supports() const {
    for (const Component& component : components) {
      std::map<std::int32_t, const TimedSupport*> prescribed;  // disc -> support
      for (std::size_t k = 0; k < scene_.supports.size(); ++k) {
        const TimedSupport& support = scene_.supports[k];
        const auto& motion = support.*component.motion;
        if (!motion) continue;
        for (const std::int32_t disc : discs_of(support)) {
          const auto [earlier, is_new] = prescribed.emplace(disc, &support);
          if (is_new || earlier->second->*component.motion == motion) continue;
          fail(fmt::format("support.{}.{}", k, component.name),
               fmt::format("the support of '{}' prescribes {} of disc {} a second time", support.group, component.name,
                           disc),
               fmt::format("that of '{}' gives it another motion", earlier->second->group),
               "Prescribe each component of a disc once");
        }
      }
      for (std::size_t k = 0; k < scene_.velocities.size(); ++k) {
        const InitialVelocity& velocity = scene_.velocities[k];
        if (component.velocity(velocity) == 0) continue;
        for (const std::int32_t disc : discs_of(velocity)) {
          const auto held = prescribed.find(disc);
          if (held == prescribed.end()) continue;
          fail(fmt::format("velocity.{}.{}", k, component.velocity_key),
               fmt::format("disc {} of '{}' has a velocity at the start, and its {} is prescribed", disc,
                           velocity.group, component.name),
               fmt::format("the support of '{}' says how it moves", held->second->group),
               "Choose a group without held discs, or release them");
        }
      }
    }
  }

  void walls() const {
    for (std::size_t k = 0; k < scene_.walls.size(); ++k) {
      try {
        check_wall(scene_.walls, k, scene_.assembly);
      } catch (const Error& error) {
        throw error.at(place_of(fmt::format("wall.{}", k)));
      }
    }
  }

 private:
  template <class Acting>
  [[nodiscard]] const std::vector<std::int32_t>& discs_of(const Acting& acting) const {
    return group(scene_.assembly, acting.group).discs;
  }
  [[nodiscard]] std::string place_of(const std::string& path) const { return where_ ? where_(path) : path; }
  [[noreturn]] void fail(const std::string& path, const std::string& problem, const std::string& why,
                         const std::string& remedy) const {
    bad_input_at(place_of(path), problem, why, remedy);
  }

  const Scene& scene_;
  const PlaceInScene& where_;
};

}  // namespace

void check(const Scene& scene, Rotation rotation, const PlaceInScene& where) {
  const SceneCheck checks(scene, where);
  checks.velocities(derive_effects(scene.assembly, scene.springs, rotation).rotation);
  checks.supports();
  checks.walls();
}

DegreesOfFreedom unknowns_at(const Scene& scene, const Effects& effects, double time) {
  std::vector<Support> supports;
  for (const TimedSupport& timed : scene.supports) {
    Support support;
    support.group = timed.group;
    if (timed.ux) support.ux = timed.ux->at(time);
    if (timed.uy) support.uy = timed.uy->at(time);
    if (timed.rotation && effects.rotation) support.rotation = timed.rotation->at(time);
    supports.push_back(support);
  }
  return number_unknowns(scene.assembly, scene.springs, effects, supports);
}

namespace {

void check_alone(const Wall& wall, const Assembly& assembly) {
  if (assembly.periodic()) {
    bad_input(fmt::format("wall '{}' stands in a periodic assembly", wall.name),
              "every disc has images on both sides of any wall", "Remove the wall, or set periodic = false");
  }
  if (wall.shape != Wall::Shape::line) {
    bad_input(fmt::format("wall '{}' is a segment or an arc", wall.name), "bonded discs meet straight walls alone",
              "Give it the shape of a line");
  }
  if (wall.servo) {
    bad_input(fmt::format("wall '{}' has a servo", wall.name), "walls of bonded discs move by schedules alone",
              "Give it a displacement, or load the discs");
  }
  check(wall);
  check_positive(wall.kN, fmt::format("kN of wall '{}'", wall.name), "Pa");
}

/// Times at which a displacement turns or ends.
std::vector<double> turning_points(const Schedule& displacement) {
  switch (displacement.kind) {
    case Schedule::Kind::constant:
      return {};
    case Schedule::Kind::ramp:
      return {displacement.end};
    case Schedule::Kind::sine:
      return {displacement.start + 0.25 / displacement.frequency, displacement.start + 0.75 / displacement.frequency};
    case Schedule::Kind::table:
      return displacement.times;
    case Schedule::Kind::cycles:
      return {displacement.start + 0.5 / displacement.frequency, displacement.end};
  }
  return {};
}

/// Lines that are parallel to a millionth meet far outside.
bool face_each_other(const Wall& a, const Wall& b) {
  return dot(a.normal, b.normal) < 0 && std::abs(cross(a.normal, b.normal)) < 1e-6;
}

void check_room(const Wall& a, const Wall& b) {
  std::vector<double> times{0};
  for (const Wall* wall : {&a, &b})
    for (const Schedule* schedule : {&wall->move_x, &wall->move_y})
      for (const double time : turning_points(*schedule)) times.push_back(std::max(time, 0.0));
  for (const double time : times) {
    const double room =
        dot(a.normal, b.point - a.point) - a.displacement_along_normal(time) - b.displacement_along_normal(time);
    if (room > 0) continue;
    bad_input(
        fmt::format("walls '{}' and '{}' cross{}", a.name, b.name, time > 0 ? fmt::format(" at {:.6g} s", time) : ""),
        fmt::format("they face each other with {:.6g} m between them", room),
        time > 0 ? "Move them less or further apart" : "Move them apart, or turn their normals to the discs");
  }
}

void check_discs(const Wall& wall, const Assembly& assembly) {
  const double start = wall.displacement_along_normal(0);
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const double height = dot(wall.normal, assembly.centres[disc] - wall.point) - start;
    if (height > 0) continue;
    bad_input(fmt::format("the centre of disc {} lies {:.6g} m behind wall '{}'", disc, -height, wall.name),
              "all discs are in front of a wall, where its normal points", "Turn the normal, or move the wall");
  }
}

}  // namespace

std::vector<DiscAtWall> wall_contacts(const Scene& scene, const std::vector<DiscMotion>& motions, double time) {
  std::vector<DiscAtWall> contacts;
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    const double moved = wall.displacement_along_normal(time);
    for (std::size_t d = 0; d < motions.size(); ++d) {
      const double gap = gap_to(wall, moved, scene.assembly.centres[d] + motions[d].u, scene.assembly.radii[d]);
      if (!(gap >= 0)) contacts.push_back({.wall = w, .disc = d, .gap = gap});
    }
  }
  return contacts;
}

WallPushes wall_pushes(const Scene& scene, const std::vector<DiscMotion>& motions, double time) {
  WallPushes result;
  if (!scene.walls.empty()) result.forces.resize(motions.size());
  for (const auto& [w, disc, gap] : wall_contacts(scene, motions, time)) {
    const Wall& wall = scene.walls[w];
    result.forces[disc] += force_of(wall, gap);
    result.energy += 0.5 * wall.kN * gap * gap;
  }
  return result;
}

void check_wall(std::span<const Wall> walls, std::size_t k, const Assembly& assembly) {
  check_alone(walls[k], assembly);
  for (const Wall& other : walls)
    if (face_each_other(walls[k], other)) check_room(walls[k], other);
  check_discs(walls[k], assembly);
}

}  // namespace equidem
