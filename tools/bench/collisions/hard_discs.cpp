// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_discs.hpp"

#include <cmath>
#include <limits>

namespace equidem::bench {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// The next impact of a disc: with a disc of larger number, or with wall ~other.
struct Impact {
  double time = never;
  int other = 0;
};

class HardDiscs {
 public:
  explicit HardDiscs(const GrainScene& scene)
      : scene_(scene), grains_(scene.grains), at_(grains_.size(), 0), next_(grains_.size()) {
    for (std::size_t i = 0; i < grains_.size(); ++i) next_[i] = next_of(i);
  }

  int run_until(double end) {
    int impacts = 0;
    for (;;) {
      std::size_t first = 0;
      for (std::size_t i = 1; i < next_.size(); ++i) {
        if (next_[i].time < next_[first].time) first = i;
      }
      if (next_[first].time > end) break;
      now_ = next_[first].time;
      collide(first, next_[first].other);
      ++impacts;
    }
    now_ = end;
    for (std::size_t i = 0; i < grains_.size(); ++i) move(i);
    return impacts;
  }
  [[nodiscard]] const std::vector<Grain>& grains() const { return grains_; }

 private:
  [[nodiscard]] Vec2 place(std::size_t i) const { return grains_[i].position + (now_ - at_[i]) * grains_[i].velocity; }

  void move(std::size_t i) {
    grains_[i].position = place(i);
    at_[i] = now_;
  }

  [[nodiscard]] double meeting(std::size_t i, std::size_t j) const {
    const Vec2 r = place(j) - place(i), v = grains_[j].velocity - grains_[i].velocity;
    const double rate = dot(r, v);
    if (rate >= 0) return never;
    const double reach = grains_[i].radius + grains_[j].radius;
    const double root = rate * rate - dot(v, v) * (dot(r, r) - reach * reach);
    return root < 0 ? never : now_ + std::max(0.0, (dot(r, r) - reach * reach) / (std::sqrt(root) - rate));
  }

  [[nodiscard]] Impact next_of(std::size_t i) const {
    Impact impact;
    for (std::size_t w = 0; w < scene_.walls.size(); ++w) {
      const double closing = -dot(grains_[i].velocity, scene_.walls[w].normal);
      if (closing <= 0) continue;
      const double gap = dot(place(i) - scene_.walls[w].point, scene_.walls[w].normal) - grains_[i].radius;
      const double time = now_ + std::max(0.0, gap / closing);
      if (time < impact.time) impact = {time, ~static_cast<int>(w)};
    }
    for (std::size_t j = i + 1; j < grains_.size(); ++j) {
      const double time = meeting(i, j);
      if (time < impact.time) impact = {time, static_cast<int>(j)};
    }
    return impact;
  }

  void collide(std::size_t i, int other) {
    const double e = scene_.pairs[0].restitution;
    move(i);
    if (other < 0) {
      const Vec2 normal = scene_.walls[static_cast<std::size_t>(~other)].normal;
      grains_[i].velocity -= ((1 + e) * dot(grains_[i].velocity, normal)) * normal;
      renew(i, i);
      return;
    }
    const auto j = static_cast<std::size_t>(other);
    move(j);
    const Vec2 branch = grains_[j].position - grains_[i].position;
    const Vec2 normal = branch / norm(branch);
    const double closing = -dot(grains_[j].velocity - grains_[i].velocity, normal);
    const Vec2 change = (0.5 * (1 + e) * closing) * normal;
    grains_[i].velocity -= change;
    grains_[j].velocity += change;
    renew(i, j);
  }

  /// All impacts that i and j take part in.
  void renew(std::size_t i, std::size_t j) {
    for (std::size_t k = 0; k < grains_.size(); ++k) {
      const int other = next_[k].other;
      const bool lost =
          next_[k].time < never && other >= 0 && (other == static_cast<int>(i) || other == static_cast<int>(j));
      if (k == i || k == j || lost) {
        next_[k] = next_of(k);
        continue;
      }
      for (const std::size_t moved : {i, j}) {
        if (moved <= k) continue;
        const double time = meeting(k, moved);
        if (time < next_[k].time) next_[k] = {time, static_cast<int>(moved)};
      }
    }
  }

  const GrainScene& scene_;
  std::vector<Grain> grains_;
  std::vector<double> at_;  ///< when each was where it says
  std::vector<Impact> next_;
  double now_ = 0;
};

}  // namespace

std::vector<Grain> hard_discs_at(const GrainScene& scene, double time, int& impacts) {
  HardDiscs discs(scene);
  impacts = discs.run_until(time);
  return discs.grains();
}

}  // namespace equidem::bench
