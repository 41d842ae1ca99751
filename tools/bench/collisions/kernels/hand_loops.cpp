// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/geometry/neighbours.hpp"

#include "loops.hpp"

namespace equidem::bench {

FallingPoints::FallingPoints(const GrainScene& scene) : gravity_(scene.gravity) {
  for (const Grain& grain : scene.grains) points_.push_back({grain.position, grain.velocity});
}

void FallingPoints::advance(std::int64_t steps, double dt) {
  const Vec2 fall = dt * gravity_;
  for (std::int64_t k = 0; k < steps; ++k) {
    for (Point& point : points_) {
      point.velocity += fall;
      point.position += dt * point.velocity;
    }
  }
}

FrictionlessDiscs::FrictionlessDiscs(const GrainScene& scene, double margin, double dt)
    : forces_(scene.grains.size()), gravity_(scene.gravity), diameter_(2 * scene.grains[0].radius), dt_(dt) {
  const double a = scene.pairs[0].dimensionless,
               zeta = damping_ratio_of(scene.pairs[0].restitution, scene.pairs[0].end);
  stiffness_pair_ = a * 0.5 / (dt * dt);
  stiffness_wall_ = a / (dt * dt);
  dashpot_pair_ = 2 * zeta * std::sqrt(0.5 * stiffness_pair_);
  dashpot_wall_ = 2 * zeta * std::sqrt(stiffness_wall_);
  std::vector<Circle> circles;
  for (const Grain& grain : scene.grains) {
    points_.push_back({grain.position, grain.velocity});
    circles.push_back({grain.position, grain.radius});
  }
  const NeighbourList near = neighbours_within(circles, margin);
  for (std::size_t i = 0; i < circles.size(); ++i) {
    for (std::int64_t p = near.begin[i]; p < near.begin[i + 1]; ++p) {
      pairs_.emplace_back(static_cast<std::int32_t>(i), near.partner[static_cast<std::size_t>(p)]);
    }
    for (const Wall& wall : scene.walls) {
      if (dot(circles[i].centre - wall.point, wall.normal) < circles[i].radius + margin) {
        touches_.push_back({static_cast<std::int32_t>(i), wall.point, wall.normal});
      }
    }
  }
}

void FrictionlessDiscs::advance(std::int64_t steps) {
  for (std::int64_t k = 0; k < steps; ++k) {
    std::fill(forces_.begin(), forces_.end(), gravity_);
    for (const auto& [i, j] : pairs_) {
      const Point& a = points_[static_cast<std::size_t>(i)];
      const Point& b = points_[static_cast<std::size_t>(j)];
      const Vec2 branch = b.position - a.position;
      const double square = dot(branch, branch);
      if (square >= diameter_ * diameter_) continue;
      const double distance = std::sqrt(square);
      const Vec2 normal = branch / distance;
      const double force =
          stiffness_pair_ * (diameter_ - distance) - dashpot_pair_ * dot(b.velocity - a.velocity, normal);
      forces_[static_cast<std::size_t>(i)] -= force * normal;
      forces_[static_cast<std::size_t>(j)] += force * normal;
    }
    for (const Touch& touch : touches_) {
      const Point& a = points_[static_cast<std::size_t>(touch.body)];
      const double overlap = 0.5 * diameter_ - dot(a.position - touch.point, touch.normal);
      if (overlap <= 0) continue;
      const double force = stiffness_wall_ * overlap - dashpot_wall_ * dot(a.velocity, touch.normal);
      forces_[static_cast<std::size_t>(touch.body)] += force * touch.normal;
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points_[i].velocity += dt_ * forces_[i];
      points_[i].position += dt_ * points_[i].velocity;
    }
  }
}

}  // namespace equidem::bench
