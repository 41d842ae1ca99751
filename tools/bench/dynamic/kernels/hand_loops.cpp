// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "equidem/dynamics/kernels/motion_step.hpp"
#include "equidem/dynamics/layout.hpp"

#include "scene.hpp"

#if defined(__x86_64__)
#define EQUIDEM_WIDE __attribute__((target("avx2,fma")))
#else
#define EQUIDEM_WIDE
#endif

namespace equidem::bench {
namespace {

using lanes::gather;
using lanes::Lanes;
using lanes::load_group;
using lanes::store_group;
using simd::load;
using simd::store;

/// Arrays as the library has them.
class HandLoop : public Contender {
 public:
  HandLoop(const Assembly& assembly, int unknowns) : layout_(lay_out(assembly)), slots_(list_slots(assembly, layout_)) {
    const std::size_t places = layout_.disc_at.size(), width = unknowns == 3 ? 4 : 2;
    before_.assign(places * width, 0.0);
    velocity_.assign(places * static_cast<std::size_t>(unknowns), 0.0);
    const std::vector<DiscMotion> start = start_motions(assembly);
    for (std::size_t p = 0; p < places; ++p) {
      if (layout_.disc_at[p] < 0) continue;
      const DiscMotion& motion = start[layout_.disc_at[p]];
      before_[p * width] = motion.u.x;
      before_[p * width + 1] = motion.u.y;
      if (width == 4) before_[p * width + 2] = motion.theta;
    }
    after_ = before_;
    geometry_.assign(slots_.contact.size() * 3, 0.0);
    for (std::size_t k = 0; k < slots_.contact.size(); ++k) {
      if (slots_.contact[k] == 0) continue;
      Vec2 branch = assembly.branch(assembly.contacts[static_cast<std::size_t>(std::abs(slots_.contact[k]) - 1)]);
      if (slots_.contact[k] < 0) branch = -branch;
      double* lane = geometry_.data() + k / 4 * 12 + k % 4;
      lane[0] = branch.x;
      lane[4] = branch.y;
      lane[8] = 1 / dot(branch, branch);
    }
  }

  void advance(std::int64_t steps) override {
    for (std::int64_t step = 0; step < steps; ++step) {
      one_step();
      std::swap(before_, after_);
    }
  }

  [[nodiscard]] double activity() const override {
    double sum = 0;
    for (const double v : velocity_) sum += v * v;
    return sum;
  }

 protected:
  virtual void one_step() = 0;

  DiscLayout layout_;
  ContactSlots slots_;
  LaneVector<double> geometry_, before_, after_, velocity_;
};

template <LoopKind::Springs springs>
class SpringLoop : public HandLoop {
 public:
  explicit SpringLoop(const Assembly& assembly) : HandLoop(assembly, unknowns) {}

 private:
  static constexpr bool rotation = springs == LoopKind::Springs::rotation;
  static constexpr bool tangential = springs != LoopKind::Springs::normal;
  static constexpr int unknowns = rotation ? 3 : 2, width = rotation ? 4 : 2;

  EQUIDEM_WIDE void one_step() override {
    const double kT = tangential ? scene_springs.kT : 0, excess = scene_springs.kN - kT, h = time_step;
    for (std::int32_t group = 0; group < layout_.groups(); ++group) {
      Lanes x, y, theta, sum_x{}, sum_y{}, sum_moment{}, normal_x{}, normal_y{};
      load_group<width>(before_.data() + 4 * width * static_cast<std::ptrdiff_t>(group), x, y, theta);
      for (std::int32_t k = slots_.first[group]; k < slots_.first[group + 1]; ++k) {
        const double* at = geometry_.data() + 12 * static_cast<std::ptrdiff_t>(k);
        Lanes xj, yj, theta_j, lx, ly, over_square;
        gather<width>(before_.data(), slots_.neighbour.data() + 4 * static_cast<std::ptrdiff_t>(k), xj, yj, theta_j);
        lx = load<Lanes>(at);
        ly = load<Lanes>(at + 4);
        over_square = load<Lanes>(at + 8);
        const Lanes dx = xj - x, dy = yj - y, normal = over_square * (lx * dx + ly * dy);
        normal_x += normal * lx;
        normal_y += normal * ly;
        if constexpr (rotation) {
          const Lanes turn = 0.5 * (theta + theta_j), ex = dx + turn * ly, ey = dy - turn * lx;
          sum_x += ex;
          sum_y += ey;
          sum_moment += lx * ey - ly * ex;
        } else if constexpr (tangential) {
          sum_x += dx;
          sum_y += dy;
        }
      }
      double* velocity = velocity_.data() + 4 * unknowns * static_cast<std::ptrdiff_t>(group);
      Lanes vx = load<Lanes>(velocity), vy = load<Lanes>(velocity + 4);
      vx += h / scene_inertia.mass * (tangential ? kT * sum_x + excess * normal_x : excess * normal_x);
      vy += h / scene_inertia.mass * (tangential ? kT * sum_y + excess * normal_y : excess * normal_y);
      store(vx, velocity);
      store(vy, velocity + 4);
      if constexpr (rotation) {
        Lanes omega = load<Lanes>(velocity + 8);
        omega += h / scene_inertia.moment * 0.5 * kT * sum_moment;
        store(omega, velocity + 8);
        theta += h * omega;
      }
      store_group<width>(x + h * vx, y + h * vy, theta, after_.data() + 4 * width * static_cast<std::ptrdiff_t>(group));
    }
  }
};

}  // namespace

std::unique_ptr<Contender> loop_by_hand(const Assembly& assembly, LoopKind::Springs springs) {
  switch (springs) {
    case LoopKind::Springs::normal:
      return std::make_unique<SpringLoop<LoopKind::Springs::normal>>(assembly);
    case LoopKind::Springs::tangential:
      return std::make_unique<SpringLoop<LoopKind::Springs::tangential>>(assembly);
    case LoopKind::Springs::rotation:
      return std::make_unique<SpringLoop<LoopKind::Springs::rotation>>(assembly);
  }
  return nullptr;
}

}  // namespace equidem::bench
