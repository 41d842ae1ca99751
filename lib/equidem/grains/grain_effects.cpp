// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

Effects::Entry entry(std::string name, bool active, std::string why_active, std::string why_not) {
  return {std::move(name), active, active ? std::move(why_active) : std::move(why_not)};
}

}  // namespace

Effects effects_of(const GrainScene& scene, const GrainOptions& options) {
  const auto any_pair = [&](auto has) { return std::any_of(scene.pairs.begin(), scene.pairs.end(), has); };
  const bool friction = any_pair([](const PairProperties& pair) { return pair.friction > 0; });
  const bool springs = any_pair([](const PairProperties& p) { return p.friction > 0 && p.tangential_ratio > 0; });
  const bool losses = any_pair([](const PairProperties& pair) { return pair.restitution < 1; });
  const bool gravity = scene.gravity != Vec2{};
  const bool moving = std::any_of(scene.walls.begin(), scene.walls.end(), [](const GrainWall& w) { return w.moves(); });
  Effects effects;
  effects.tangential_springs = springs;
  effects.rotation = friction;
  effects.entries = {
      entry(format("normal contact by {}", to_string(options.law)), true, "grains rebound", ""),
      entry("loss at impacts", losses, "restitution below 1", "restitution 1: impacts keep the energy"),
      entry("friction", friction, "a friction coefficient above 0", "friction 0 everywhere"),
      entry("tangential springs", springs, "tangential_ratio above 0", friction ? "tangential_ratio 0" : "no friction"),
      entry("rotation", friction, "friction turns grains", "no friction: nothing can turn a grain"),
      entry("gravity", gravity, "it is not 0", "it is 0"),
      entry("walls", !scene.walls.empty(), "the scene has some", "the scene has none"),
      entry("motion of walls", moving, "a wall has a schedule", "no wall moves"),
  };
  return effects;
}

}  // namespace equidem
