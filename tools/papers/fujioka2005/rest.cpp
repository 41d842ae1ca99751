// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that come to rest under gravity; not in the paper.
#include <algorithm>
#include <cmath>

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr int history_points = 400;

/// Springs of the contacts of a column; contact 0 is that with the floor.
class Springs {
 public:
  Springs(const Variant& variant, const GrainScene& scene, double step)
      : hertz_(variant.law == NormalLaw::hertz_dashpot), mass_(scene.grains[0].inertia.mass) {
    stiffness_ = variant.a * mass_ / (step * step) / (hertz_ ? std::sqrt(diameter) : 1);
  }
  [[nodiscard]] double overlap(std::size_t contact, double force) const {
    const double ratio = force / stiffness(contact);
    return hertz_ ? std::pow(ratio, 2.0 / 3) : ratio;
  }
  [[nodiscard]] double energy(std::size_t contact, double overlap) const {
    if (overlap <= 0) return 0;
    return stiffness(contact) * (hertz_ ? 0.4 * std::pow(overlap, 2.5) : 0.5 * overlap * overlap);
  }

  /// Kinetic, elastic and potential energy, at the instant of the velocities: half a step back in semi-implicit Euler.
  [[nodiscard]] double energy(const std::vector<Grain>& grains, double lag) const {
    double sum = 0, below = -0.5 * diameter;  // centre of a ball that would just touch, less the diameter
    for (std::size_t k = 0; k < grains.size(); ++k) {
      const double speed = grains[k].velocity.y, height = grains[k].position.y - lag * speed;
      sum += 0.5 * mass_ * speed * speed + mass_ * gravity * height + energy(k, below + diameter - height);
      below = height;
    }
    return sum;
  }
  [[nodiscard]] double energy_at_rest(std::size_t balls) const {
    double sum = 0, height = -0.5 * diameter;
    for (std::size_t k = 0; k < balls; ++k) {
      const double force = static_cast<double>(balls - k) * mass_ * gravity, pressed = overlap(k, force);
      height += diameter - pressed;
      sum += mass_ * gravity * height + energy(k, pressed);
    }
    return sum;
  }

 private:
  /// From the dimensionless one: the reduced mass of two balls is half that of a ball and the floor.
  [[nodiscard]] double stiffness(std::size_t contact) const { return contact == 0 ? stiffness_ : 0.5 * stiffness_; }

  bool hertz_;
  double mass_, stiffness_;
};

Rest settle(const Variant& variant, int balls, double duration, double e) {
  const GrainScene scene = column(variant.pair(e), balls);
  const double step = paper_step, weight = balls * gravity * scene.grains[0].inertia.mass;
  const Springs springs(variant, scene, step);
  const double still = springs.energy_at_rest(scene.grains.size()), expected = springs.overlap(0, weight);

  Rest rest{.variant = variant, .balls = balls, .times = {}, .energies = {}};
  GrainSimulation run = start(scene, variant.law, step);
  const auto last = static_cast<std::int64_t>(std::llround(duration / step)), late = last - last / 10;
  double speeds = 0, overlaps = 0;
  std::int64_t touched = 0;
  while (run.step() < last) {
    run.advance(1);
    if (run.step() % (last / history_points) == 0) {
      stop_if_interrupted();
      const double energy = springs.energy(run.grains(), variant.of_paper() ? 0.5 * step : 0);
      rest.times.push_back(run.time());
      rest.energies.push_back((energy - still) / (weight * diameter));
    }
    if (run.step() <= late) continue;
    const auto grains = run.grains();
    for (const Grain& grain : grains) speeds += dot(grain.velocity, grain.velocity) / balls;
    overlaps += 0.5 * diameter - grains[0].position.y;
    for (const GrainContact& contact : run.contacts()) touched += contact.j < 0 ? 1 : 0;
  }
  const auto steps = static_cast<double>(last - late);
  rest.speed = std::sqrt(speeds / steps) / (gravity * step);
  rest.overlap = overlaps / steps / expected;
  rest.contact = static_cast<double>(touched) / steps;
  return rest;
}

}  // namespace

std::vector<Rest> come_to_rest(int balls, double duration, double e) {
  std::vector<Rest> all;
  for (const Variant& variant : variants(stiff)) all.push_back(settle(variant, balls, duration, e));
  return all;
}

}  // namespace equidem::fujioka2005
