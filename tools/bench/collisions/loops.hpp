// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Loops written by hand for one scene each, without anything that the scene does not need.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem::bench {

/// v += g dt, x += v dt.
class FallingPoints {
 public:
  explicit FallingPoints(const GrainScene& scene);
  void advance(std::int64_t steps, double dt);
  [[nodiscard]] Vec2 position(std::size_t i) const { return points_[i].position; }

 private:
  struct Point {
    Vec2 position, velocity;
  };
  std::vector<Point> points_;
  Vec2 gravity_;
};

/// Equal discs of mass 1 with law C between lines. Pairs that may touch are found once at the start; friction, spin and
/// ledger are absent.
class FrictionlessDiscs {
 public:
  FrictionlessDiscs(const GrainScene& scene, double margin, double dt);
  void advance(std::int64_t steps);
  [[nodiscard]] Vec2 position(std::size_t i) const { return points_[i].position; }

 private:
  struct Point {
    Vec2 position, velocity;
  };
  struct Touch {
    std::int32_t body;
    Vec2 point, normal;
  };
  std::vector<Point> points_;
  std::vector<Vec2> forces_;
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs_;
  std::vector<Touch> touches_;
  Vec2 gravity_;
  double diameter_, dt_, stiffness_pair_, stiffness_wall_, dashpot_pair_, dashpot_wall_;
};

}  // namespace equidem::bench
