// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "bench.hpp"
#include "scene.hpp"

namespace equidem::bench {
namespace {

struct Body {
  double x = 0, y = 0, theta = 0;
};

/// Normal and distance of the contact point from either centre, 1.
struct Bond {
  std::int32_t i = 0, j = 0;
  double nx = 0, ny = 0, lever = 0;
};

/// Force and moment on i.
inline Body force_of(const Bond& bond, const Body& i, const Body& j) {
  const double dx = j.x - i.x, dy = j.y - i.y;
  const double normal = scene_springs.kN * (bond.nx * dx + bond.ny * dy);
  const double shear = scene_springs.kT * (bond.nx * dy - bond.ny * dx - bond.lever * (i.theta + j.theta));
  return {normal * bond.nx - shear * bond.ny, normal * bond.ny + shear * bond.nx, bond.lever * shear};
}

inline void move(const Body& force, Body& velocity, Body& motion) {
  velocity.x += time_step / scene_inertia.mass * force.x;
  velocity.y += time_step / scene_inertia.mass * force.y;
  velocity.theta += time_step / scene_inertia.moment * force.theta;
  motion.x += time_step * velocity.x;
  motion.y += time_step * velocity.y;
  motion.theta += time_step * velocity.theta;
}

/// Discs row by row, as lattices come; neighbours then are near in memory.
class PlainLoop : public Contender {
 public:
  explicit PlainLoop(const Assembly& assembly) : velocity_(assembly.size()), force_(assembly.size()) {
    std::vector<std::int32_t> order(assembly.size()), place(assembly.size());
    std::iota(order.begin(), order.end(), 0);
    const auto row = [&](std::int32_t d) { return static_cast<std::int64_t>(assembly.centres[d].y / 1.7); };
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
      return std::pair(row(a), assembly.centres[a].x) < std::pair(row(b), assembly.centres[b].x);
    });
    const std::vector<DiscMotion> start = start_motions(assembly);
    for (std::size_t k = 0; k < order.size(); ++k) {
      place[order[k]] = static_cast<std::int32_t>(k);
      motion_.push_back({start[order[k]].u.x, start[order[k]].u.y, start[order[k]].theta});
    }
    for (const Contact& contact : assembly.contacts) {
      Vec2 normal = assembly.branch(contact);
      const double length = norm(normal);
      std::int32_t i = place[contact.i], j = place[contact.j];
      if (i > j) std::swap(i, j), normal = -normal;
      bonds_.push_back({i, j, normal.x / length, normal.y / length, length / 2});
    }
    std::sort(bonds_.begin(), bonds_.end(),
              [](const Bond& a, const Bond& b) { return std::pair(a.i, a.j) < std::pair(b.i, b.j); });
  }

  void advance(std::int64_t steps) override {
    for (std::int64_t step = 0; step < steps; ++step) {
      for (const Bond& bond : bonds_) {
        const Body force = force_of(bond, motion_[bond.i], motion_[bond.j]);
        force_[bond.i].x += force.x;
        force_[bond.i].y += force.y;
        force_[bond.i].theta += force.theta;
        force_[bond.j].x -= force.x;
        force_[bond.j].y -= force.y;
        force_[bond.j].theta += force.theta;
      }
      for (std::size_t d = 0; d < motion_.size(); ++d) {
        move(force_[d], velocity_[d], motion_[d]);
        force_[d] = {};
      }
    }
  }

  [[nodiscard]] double activity() const override {
    double sum = 0;
    for (const Body& v : velocity_) sum += v.x * v.x + v.y * v.y + v.theta * v.theta;
    return sum;
  }

 private:
  std::vector<Bond> bonds_;  // i < j, ascending
  std::vector<Body> motion_, velocity_, force_;
};

double triad_bandwidth() {
  constexpr std::size_t count = std::size_t{1} << 24;
  std::vector<double> a(count, 0.0), b(count, 1.0), c(count, 2.0);
  double best = 0;
  for (int round = 0; round < 7; ++round) {
    const double begin = processor_time();
    for (std::size_t i = 0; i < count; ++i) a[i] = b[i] + 0.5 * c[i];
    best = std::max(best, 24.0 * static_cast<double>(count) / (processor_time() - begin));
    b[static_cast<std::size_t>(round)] = a[count - 1];  // otherwise the compiler could omit rounds
  }
  return best;
}

double peak_arithmetic() {
  using Lanes = double __attribute__((vector_size(32)));
  constexpr int chains = 10, repetitions = 4'000'000;
  Lanes sums[chains] = {};
  double best = 0;
  for (int round = 0; round < 7; ++round) {
    const double begin = processor_time();
    for (int k = 0; k < repetitions; ++k) {
#pragma GCC unroll 10
      for (Lanes& sum : sums) sum = sum * 0.999 + 0.001;
    }
    best = std::max(best, 8.0 * chains * repetitions / (processor_time() - begin));
    for (Lanes& sum : sums) asm volatile("" : "+m"(sum));  // otherwise the compiler could omit all of it
  }
  return best;
}

}  // namespace

std::unique_ptr<Contender> plain_loop(const Assembly& assembly) {
  return std::make_unique<PlainLoop>(assembly);
}

Limits machine_limits() {
  return {.bandwidth = triad_bandwidth(), .arithmetic = peak_arithmetic()};
}

}  // namespace equidem::bench
