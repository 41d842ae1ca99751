// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/overlaps.hpp"

#include <numbers>

#include "equidem/core/stopwatch.hpp"

namespace equidem {

namespace {

/// Forces of all overlaps, moments over levers.
struct Forces {
  std::vector<Vec2> force;
  std::vector<double> turning;  ///< of discs none
  double sum = 0;               ///< of all contact forces
  double largest = 0;
  std::int64_t contacts = 0;

  void count(double overlap) {
    sum += overlap;
    largest = std::max(largest, overlap);
    ++contacts;
  }
};

void push_discs(const Bodies& bodies, std::span<const CirclePair> pairs, Forces& out) {
  for (const CirclePair& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j.body);
    const Vec2 branch = bodies.centres[j] + pair.shift - bodies.centres[i];
    const double reach = bodies.radii[i] + bodies.radii[j], square = dot(branch, branch);
    if (square >= reach * reach) continue;
    const double distance = std::sqrt(square), overlap = reach - distance;
    const Vec2 push = (distance > 0 ? overlap / distance : 0) * branch;
    out.force[i] -= push;
    out.force[j] += push;
    out.count(overlap);
  }
}

/// The gradient is exact: a force along the common normal at the closest points.
void push_shapes(const Bodies& bodies, std::span<const Outline> outlines, double lever,
                 std::span<const CirclePair> pairs, Forces& out) {
  for (const CirclePair& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j.body);
    const Vec2 branch = bodies.centres[j] + pair.shift - bodies.centres[i];
    for_touches(outlines[i], outlines[j], branch, 0, [&](const Touch& touch) {
      const Vec2 push = touch.overlap * touch.normal;
      out.force[i] -= push;
      out.force[j] += push;
      out.turning[i] -= cross(touch.arm_i, push) / (lever * bodies.radii[i]);
      out.turning[j] += cross(touch.arm_j, push) / (lever * bodies.radii[j]);
      out.count(touch.overlap);
    });
  }
}

/// The unknowns that FIRE moves: positions, and angles of bodies other than discs.
class Pushed {
 public:
  Pushed(const PackingBox& box, const UnitBody& shape, const PushingOptions& options, PairFinder& finder,
         Bodies& bodies)
      : box_(box), shape_(shape), finder_(finder), bodies_(bodies), lever_(shape.lever) {
    double mean_square = 0;
    const auto count = static_cast<double>(bodies.size());
    for (const double radius : bodies.radii) mean_radius += radius / count, mean_square += radius * radius / count;
    for (const double radius : bodies.radii)
      weights_.push_back((radius * radius / mean_square * mean_radius) * options.weight);
    margin_ = 0.3 * mean_radius;
    outlines_.resize(bodies.size());
    turn_outlines();
    find_pairs();
  }

  double mean_radius = 0;
  Forces forces;

  [[nodiscard]] bool turns() const { return lever_ > 0; }

  void evaluate() {
    forces.force = weights_;
    forces.turning.assign(shape_.is_disc() ? 0 : weights_.size(), 0);
    forces.sum = forces.largest = 0;
    forces.contacts = 0;
    if (shape_.is_disc()) {
      push_discs(bodies_, *pairs_, forces);
    } else {
      push_shapes(bodies_, outlines_, turns() ? lever_ : 1, *pairs_, forces);
    }
    push_from_walls();
  }

  /// \param way that no body moves further
  void move(std::span<const Vec2> velocities, std::span<const double> spins, double time, double way) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_.centres[k] += time * velocities[k];
    for (std::size_t k = 0; k < spins.size(); ++k)
      bodies_.turns[k] += time * spins[k] / (2 * std::numbers::pi * lever_ * bodies_.radii[k]);
    if (turns()) turn_outlines();
    moved_ += way;
    if (2 * moved_ > margin_) find_pairs();
  }

 private:
  void turn_outlines() {
    for (std::size_t k = 0; k < outlines_.size(); ++k) outlines_[k] = shape_.outline(bodies_.radii[k], bodies_.turn(k));
  }

  void find_pairs() {
    circles_.clear();
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      Vec2& x = bodies_.centres[k];
      if (box_.periodic() && moved_ > 0) {
        x.x -= box_.size.x * std::floor(x.x / box_.size.x);
        x.y -= box_.size.y * std::floor(x.y / box_.size.y);
      }
      circles_.push_back({x, shape_.reach * bodies_.radii[k]});
    }
    pairs_ = &finder_.within(circles_, box_.periods(), margin_);
    moved_ = 0;
  }

  void push_from_walls() {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      for_wall_touches(outlines_[k], bodies_.centres[k], box_, 0, [&](int, const Touch& touch) {
        const Vec2 push = touch.overlap * touch.normal;
        forces.force[k] -= push;
        if (turns()) forces.turning[k] -= cross(touch.arm_i, push) / (lever_ * bodies_.radii[k]);
        forces.count(touch.overlap);
      });
    }
  }

  const PackingBox& box_;
  const UnitBody& shape_;
  PairFinder& finder_;
  Bodies& bodies_;
  double lever_ = 0, margin_ = 0, moved_ = 0;
  std::vector<Vec2> weights_;
  std::vector<Outline> outlines_;
  std::vector<Circle> circles_;
  const std::vector<CirclePair>* pairs_ = nullptr;
};

/// Sums over all unknowns.
struct Sums {
  double residual = 0, power = 0, speed2 = 0, force2 = 0;
};

Sums sums_of(const Forces& forces, std::span<const Vec2> velocities, std::span<const double> spins) {
  Sums sums;
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    const double turning = spins.empty() ? 0 : forces.turning[k], spin = spins.empty() ? 0 : spins[k];
    const double f2 = dot(forces.force[k], forces.force[k]) + turning * turning;
    sums.residual += std::sqrt(f2);
    sums.force2 += f2;
    sums.power += dot(forces.force[k], velocities[k]) + turning * spin;
    sums.speed2 += dot(velocities[k], velocities[k]) + spin * spin;
  }
  return sums;
}

}  // namespace

PushingReport push_apart(const PackingBox& box, const UnitBody& shape, const PushingOptions& options,
                         PairFinder& finder, Bodies& bodies) {
  Pushed pushed(box, shape, options, finder, bodies);
  // Time in units of sqrt(m/k) = 1. Bodies that turn have more contacts, and stiffer ones.
  const double longest_step = pushed.turns() ? 0.4 : 0.6;
  constexpr double first_step = 0.1, keep = 0.1, shrink = 0.99;
  constexpr int patience = 5;
  const double longest_way = 0.1 * pushed.mean_radius;
  double step = first_step, mixing = keep;
  int downhill = 0;
  std::vector<Vec2> velocities(bodies.size());
  std::vector<double> spins(pushed.turns() ? bodies.size() : 0);
  const Forces& forces = pushed.forces;
  PushingReport report;
  for (;;) {
    pushed.evaluate();
    ++report.evaluations;
    if (report.evaluations % 16 == 0) stop_if_interrupted();
    Sums sums = sums_of(forces, velocities, spins);
    const double contacts = static_cast<double>(std::max<std::int64_t>(forces.contacts, 1));
    report.largest_overlap = forces.largest / pushed.mean_radius;
    report.mean_overlap = forces.sum / contacts / pushed.mean_radius;
    report.unbalanced =
        forces.sum > 0 ? sums.residual / static_cast<double>(bodies.size()) / (forces.sum / contacts) : 0;
    report.apart = options.weight == Vec2{} && report.largest_overlap <= options.overlap;
    report.balanced = forces.sum > 0 && report.unbalanced <= options.unbalanced;
    if (report.apart || report.balanced || report.evaluations >= options.most) return report;

    if (sums.power > 0) {
      if (++downhill > patience) {
        step = std::min(1.1 * step, longest_step);
        mixing *= shrink;
      }
    } else {
      downhill = 0;
      step *= 0.5;
      mixing = keep;
      std::fill(velocities.begin(), velocities.end(), Vec2{});
      std::fill(spins.begin(), spins.end(), 0.0);
      sums.speed2 = 0;
    }
    const double turn = sums.force2 > 0 ? mixing * std::sqrt(sums.speed2 / sums.force2) : 0;
    double fastest2 = 0;
    for (std::size_t k = 0; k < velocities.size(); ++k) {
      velocities[k] = (1 - mixing) * velocities[k] + (turn + step) * forces.force[k];
      fastest2 = std::max(fastest2, dot(velocities[k], velocities[k]));
    }
    for (std::size_t k = 0; k < spins.size(); ++k) {
      spins[k] = (1 - mixing) * spins[k] + (turn + step) * forces.turning[k];
      fastest2 = std::max(fastest2, spins[k] * spins[k]);
    }
    const double way = std::sqrt(fastest2) * step, scale = way > longest_way ? longest_way / way : 1;
    pushed.move(velocities, spins, scale * step, scale * way);
  }
}

}  // namespace equidem
