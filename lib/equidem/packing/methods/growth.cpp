// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that overlap push each other apart, and growth of bodies to a size or to jamming.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/overlaps.hpp"
#include "equidem/packing/packing.hpp"

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

namespace {

class Growth {
 public:
  explicit Growth(const PackingOptions& options)
      : options_(options), shape_(unit_body_of(options.shape)), bodies_{{}, options.radii, {}} {
    full_ = area_of(options.shape, options.radii) / options.box.area();
    options.shape.is_disc() ? scatter() : place_apart();
  }

  /// Grow to the solid fraction and push apart.
  PushingReport grow_to(double solid_fraction, const PushingOptions& pushing) {
    const double scale = std::sqrt(solid_fraction / full_);
    for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_.radii[k] = scale * options_.radii[k];
    refuse_wider_than_period();
    const PushingReport report = push_apart(options_.box, shape_, pushing, finder_, bodies_);
    work_ += report.evaluations;
    return report;
  }

  /// As check() refuses bodies that keep their size.
  void refuse_two_images() const {
    if (2 * width() <= period()) return;
    throw Error(ErrorKind::computation_failed,
                fmt::format("the largest {} has grown to {:.4g} m, the box is {:.4g} m by {:.4g} m",
                            noun_of(options_.shape.kind), width(), options_.box.size.x, options_.box.size.y),
                "a period holds two of them side by side, so that none meets two images of another",
                "Take more of them, or a squarer box", "grains");
  }

  [[nodiscard]] double full() const { return full_; }
  /// At the start.
  [[nodiscard]] double first_fraction() const { return first_; }

  void give(GrainPacking& packing) {
    make_grains(options_.shape, bodies_, options_.settling.density, packing);
    packing.work = work_;
  }

 private:
  [[nodiscard]] double width() const {
    return 2 * shape_.reach * *std::max_element(bodies_.radii.begin(), bodies_.radii.end());
  }

  /// Infinite where nothing repeats.
  [[nodiscard]] double period() const {
    return options_.box.periodic() ? std::min(options_.box.size.x, options_.box.size.y) : INFINITY;
  }

  /// Such a body would overlap its own images, which are no partners.
  void refuse_wider_than_period() const {
    if (width() <= period()) return;
    computation_failed(
        fmt::format("the largest {} grows wider than the period of {:.4g} m", noun_of(options_.shape.kind), period()),
        "it would meet itself across the sides", "Take more of them, or a squarer box");
  }

  /// Discs separate from any start.
  void scatter() {
    Random random(options_.seed);
    for (std::size_t k = 0; k < bodies_.radii.size(); ++k) {
      const double x = random.uniform(0, options_.box.size.x);
      bodies_.centres.push_back({x, random.uniform(0, options_.box.size.y)});
    }
    first_ = 0.4;
  }

  /// Clumps that start interlocked may stay so: circles around the bodies are placed at random where they have room.
  void place_apart() {
    PackingOptions circles = options_;
    circles.shape = {};
    circles.as_dense_as_possible = false;
    constexpr double share = 0.3, widest = 0.45;  // of the box that the circles cover, of its shorter side
    const Vec2 size = options_.box.size;
    const double largest = *std::max_element(options_.radii.begin(), options_.radii.end());
    const double scale = std::min(std::sqrt(share * size.x * size.y / area_of(circles.shape, options_.radii)),
                                  widest * std::min(size.x, size.y) / largest);
    for (double& radius : circles.radii) radius *= scale;
    // Sorted like the radii, so that a circle finds the body that is in it.
    std::vector<std::size_t> order(options_.radii.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return options_.radii[a] > options_.radii[b]; });
    GrainPacking placed;
    fill_by_rejection(circles, placed);
    if (placed.failure) throw *placed.failure;
    bodies_.centres.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) bodies_.centres[order[k]] = placed.grains[k].position;
    Random random(options_.seed ^ 0xa5a5a5a5ULL);
    for (std::size_t k = 0; k < order.size(); ++k) bodies_.turns.push_back(random.uniform());
    first_ = full_ * (scale / shape_.reach) * (scale / shape_.reach);
  }

  const PackingOptions& options_;
  UnitBody shape_;
  Bodies bodies_;
  PairFinder finder_;
  double full_ = 0, first_ = 0;
  std::int64_t work_ = 0;
};

/// Steps of the solid fraction, smaller as the box fills; at most 7 % of the size of the bodies, so that none passes
/// through another.
double next_fraction(double fraction, double end) {
  const double step = std::min(0.15 * fraction, fraction < 0.7 ? 0.1 : fraction < 0.8 ? 0.02 : 0.005);
  return std::min(fraction + step, end);
}

[[noreturn]] void refuse_jammed(const PackingOptions& options, double wanted, double fraction,
                                const PushingReport& report) {
  throw Error(
      ErrorKind::computation_failed,
      fmt::format("the {}s jam before they reach the solid fraction of {:.4g} that is asked for: grown to {:.4g} they "
                  "overlap by {:.2g} of the mean radius and no longer move apart",
                  noun_of(options.shape.kind), wanted, fraction, std::max(report.mean_overlap, report.largest_overlap)),
      "discs at random jam at 0.82 to 0.86, few of them or between near walls at less, those of equal size at what is "
      "nearly a lattice",
      "Ask for a smaller solid fraction, or give grains and box with solid_fraction = \"auto\" for the densest",
      "solid_fraction");
}

/// Radii larger by `spare` are pushed apart to overlaps of less than `spare`, so that the bodies themselves do not
/// touch. Where bodies overlap by `hopeless` of their radius on the mean, they have jammed some percent of the solid
/// fraction earlier.
void grow_to_size(const PackingOptions& options, Growth& growth) {
  constexpr double hopeless = 0.03;
  const double spare = std::min(options.overlap, 1e-4);
  const double end = growth.full() * (1 + spare) * (1 + spare);
  Progress progress("growing");
  double fraction = std::min(growth.first_fraction(), end);
  for (;;) {
    const bool last = fraction >= end;
    const auto report = growth.grow_to(fraction, {.overlap = last ? spare : 0.01, .most = last ? 100000 : 3000});
    progress.update(std::min(fraction / end, 1.0));
    if (!report.apart && (last || report.mean_overlap > hopeless))
      refuse_jammed(options, growth.full(), fraction, report);
    if (last) break;
    fraction = next_fraction(fraction, end);
  }
  growth.grow_to(growth.full(), {.overlap = 1, .most = 1});
}

/// Compress until forces no longer vanish, then take the radii back until the mean overlap is the wanted one: it grows
/// in proportion to the solid fraction above that of jamming (O'Hern et al. 2003, Phys. Rev. E 68, 011306).
void grow_to_jamming(const PackingOptions& options, Growth& growth) {
  Progress progress("growing");
  PushingReport report;
  double fraction = growth.first_fraction();
  for (;; fraction = next_fraction(fraction, 2)) {
    report = growth.grow_to(fraction, {.overlap = 1e-3, .most = 3000});
    progress.update(std::min(fraction, 0.99));
    if (!report.apart && report.mean_overlap > 4e-3) break;
  }
  const PushingOptions exact{.overlap = 0.01 * options.overlap, .unbalanced = 1e-7, .most = 100000};
  double loose = 0;  // the largest fraction seen at which nothing overlaps
  int loose_in_a_row = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    report = growth.grow_to(fraction, exact);
    progress.update(0.99);
    if (report.apart) {
      // Where bodies found a denser order, small steps would not come back to jamming: from the fifth on they double.
      loose = fraction;
      fraction *= 1 + std::ldexp(2 * options.overlap, std::max(loose_in_a_row++ - 3, 0));
      continue;
    }
    loose_in_a_row = 0;
    const double ratio = report.mean_overlap / options.overlap;
    if (report.balanced && ratio < 1.5 && ratio > 0.5) return;
    // Strain 2 d/D, area twice the strain: fraction falls by about mean overlap/radius.
    const double aim = fraction * (1 - (report.mean_overlap - options.overlap) * 0.9);
    fraction = loose > 0 && aim <= loose ? 0.5 * (fraction + loose) : aim;
  }
  computation_failed(
      fmt::format("no jammed state with a mean overlap of {:.2g} of the mean radius was found", options.overlap),
      fmt::format("the last one had {:.2g} and an unbalanced force of {:.1e}", report.mean_overlap, report.unbalanced),
      "Allow a larger overlap, or change the seed");
}

/// Over the largest, to 1e-9: the digits behind it depend on the unit, and jamming is chaotic.
std::vector<double> ratios_of(std::vector<double> radii) {
  const double largest = *std::max_element(radii.begin(), radii.end());
  for (double& radius : radii) radius = std::ldexp(std::max(std::round(std::ldexp(radius / largest, 30)), 1.0), -30);
  return radii;
}

}  // namespace

void fill_by_growth(const PackingOptions& given, GrainPacking& packing) {
  PackingOptions options = given;
  if (grows_to_any_size(options)) options.radii = ratios_of(options.radii);
  std::optional<Growth> growth;
  keep_failure(packing, [&] {
    growth.emplace(options);
    if (options.as_dense_as_possible) {
      grow_to_jamming(options, *growth);
      growth->refuse_two_images();
      packing.jammed = true;
    } else {
      grow_to_size(options, *growth);
    }
  });
  if (growth) growth->give(packing);
}

}  // namespace equidem
