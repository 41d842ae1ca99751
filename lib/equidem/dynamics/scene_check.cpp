// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/scene_check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/walls.hpp"

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

  /// Two supports may prescribe the same motion of a disc.
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
    }
  }

  void velocities(bool rotation) const {
    std::map<std::int32_t, const InitialVelocity*> given;  // disc -> velocity
    for (std::size_t k = 0; k < scene_.velocities.size(); ++k) {
      for (const std::int32_t disc : discs_of(scene_.velocities[k])) {
        const auto [earlier, is_new] = given.emplace(disc, &scene_.velocities[k]);
        if (is_new) continue;
        fail(fmt::format("velocity.{}.group", k), fmt::format("disc {} has two velocities at the start", disc),
             fmt::format("it is in '{}' and in '{}'", earlier->second->group, scene_.velocities[k].group),
             "Choose groups that share no disc");
      }
    }
    for (std::size_t k = 0; k < scene_.velocities.size(); ++k) {
      const InitialVelocity& velocity = scene_.velocities[k];
      if (velocity.spin != 0 && !rotation)
        fail(fmt::format("velocity.{}.spin", k),
             fmt::format("'{}' has a spin at the start, and rotations are no unknowns of this scene", velocity.group),
             scene_.springs.any_tangential() ? "they are restrained"
                                             : "kT = 0 everywhere: the spin would change nothing",
             "Remove the spin");
      for (const Component& component : components)
        if (component.velocity(velocity) != 0) not_prescribed(k, component);
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

  /// No support prescribes a component of the discs with the velocity k.
  void not_prescribed(std::size_t k, const Component& component) const {
    const InitialVelocity& velocity = scene_.velocities[k];
    std::vector<std::int32_t> moving = discs_of(velocity);
    std::ranges::sort(moving);
    for (const TimedSupport& support : scene_.supports) {
      if (!(support.*component.motion)) continue;
      const auto& held = discs_of(support);
      const auto both =
          std::ranges::find_if(held, [&](std::int32_t disc) { return std::ranges::binary_search(moving, disc); });
      if (both == held.end()) continue;
      fail(fmt::format("velocity.{}.{}", k, component.velocity_key),
           fmt::format("disc {} of '{}' has a velocity at the start, and its {} is prescribed", *both, velocity.group,
                       component.name),
           fmt::format("the support of '{}' says how it moves", support.group),
           "Choose a group without held discs, or release them");
    }
  }

  const Scene& scene_;
  const PlaceInScene& where_;
};

}  // namespace

void check(const Scene& scene, Rotation rotation, const PlaceInScene& where) {
  const SceneCheck checks(scene, where);
  checks.supports();
  checks.velocities(derive_effects(scene.assembly, scene.springs, rotation).rotation);
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

}  // namespace equidem
