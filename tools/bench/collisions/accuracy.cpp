// SPDX-License-Identifier: GPL-3.0-or-later
#include "accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/fujioka2005_scenes.hpp"

#include "bench.hpp"
#include "hard_discs.hpp"
#include "text_table.hpp"

namespace equidem::bench {
namespace {

/// A scene whose outcome is known for rigid bodies.
struct RigidLimit {
  std::string what;
  GrainScene scene;  ///< its pair gives the restitution
  double time = 0, coarsest = 0;
  std::function<double(const std::vector<Grain>&)> error;
};

RigidLimit ball() {
  constexpr double time = 2.5, drop = 2.25, e = 0.7;
  const double truth = fujioka2005::rigid_height(drop, e, time);
  return {"A ball dropped from 2.25 m, e = 0.7, after three impacts: error of its height at 2.5 s over 2.25 m",
          fujioka2005::column({.restitution = e}, 1, 1, drop), time, 0.02, [=](const std::vector<Grain>& grains) {
            return std::abs(grains[0].position.y - grains[0].radius - truth) / drop;
          }};
}

RigidLimit stack() {
  return {"One sphere on two (section 5.6), e = 0.7: relative error of d' at 1.3 T0",
          fujioka2005::stacked({.restitution = 0.7}), 1.3 * fujioka2005::exact_parting, 2e-3,
          [](const std::vector<Grain>& grains) {
            return std::abs(fujioka2005::dimensionless_speed(grains[1].velocity.x) / fujioka2005::exact_speed - 1);
          }};
}

RigidLimit dilute_gas() {
  constexpr double time = 3;
  const GrainScene scene = gas(1000, 0.2, {.restitution = 0.9});
  const HardDiscs truth = hard_discs_at(scene, time);
  return {
      fmt::format("1000 discs in a box, solid fraction 0.2, e = 0.9, {} impacts: median error of place over the radius",
                  truth.impacts),
      scene, time, 0.05, [=](const std::vector<Grain>& grains) {
        std::vector<double> errors;
        for (std::size_t i = 0; i < grains.size(); ++i)
          errors.push_back(norm(grains[i].position - truth.positions[i]) / radius);
        return range_of(std::move(errors)).median;
      }};
}

/// One step of one law; infinite where the law fails (centres would pass each other).
struct Point {
  double step, seconds = std::numeric_limits<double>::infinity(), error = seconds;
};
using Curve = std::vector<Point>;  ///< from the coarsest step to the finest

/// Every law and step in turn, thrice; the shortest time counts.
std::vector<Curve> curves_of(const RigidLimit& limit, std::span<const Variant> variants, int halvings) {
  std::vector<Curve> curves(variants.size());
  GrainScene scene = limit.scene;
  for (int k = 0; k <= halvings; ++k) {
    const std::int64_t steps = std::llround(limit.time / limit.coarsest * std::pow(2.0, k));
    const double step = limit.time / static_cast<double>(steps);
    for (Curve& curve : curves) curve.push_back({step});
    for (int round = 0; round < 3; ++round) {
      for (std::size_t v = 0; v < variants.size(); ++v) {
        Point& point = curves[v].back();
        scene.pairs = {pair_of(variants[v], limit.scene.pairs[0].restitution)};
        try {
          GrainSimulation simulation = start(scene, variants[v], step);
          const double begin = processor_time();
          simulation.advance(steps);
          point.seconds = std::min(point.seconds, processor_time() - begin);
          point.error = limit.error(simulation.grains());
        } catch (const Error&) {
          continue;
        }
      }
    }
  }
  return curves;
}

/// Seconds of the coarsest step from which on the error stays below.
std::optional<double> seconds_for(const Curve& curve, double error) {
  std::optional<double> seconds;
  for (auto point = curve.rbegin(); point != curve.rend() && point->error <= error; ++point) seconds = point->seconds;
  return seconds;
}

}  // namespace

PairProperties pair_of(const Variant& variant, double restitution) {
  return fujioka2005::pair_of(variant.law, restitution, variant.dimensionless);
}

GrainSimulation start(const GrainScene& scene, const Variant& variant, double step) {
  return {scene, {.law = variant.law, .integrator = variant.integrator, .time_step = step}};
}

std::string compare_accuracy(std::span<const Variant> variants, int halvings) {
  std::string text;
  for (const RigidLimit& limit : {ball(), stack(), dilute_gas()}) {
    const std::vector<Curve> curves = curves_of(limit, variants, halvings);
    TextTable table("law & 1e-1 & 1e-2 & 1e-3 & 1e-4 & order of the error & error, seconds at the finest step");
    for (std::size_t v = 0; v < curves.size(); ++v) {
      std::string row = variants[v].name;
      for (const double error : {1e-1, 1e-2, 1e-3, 1e-4}) {
        const auto own = seconds_for(curves[v], error), of_first = seconds_for(curves[0], error);
        row += own ? fmt::format(" & {:.2g}", *own) : " & -";
        if (own && of_first) row += fmt::format(" ({:.2f})", *own / *of_first);
      }
      const Point& last = curves[v].back();
      const Point& early = curves[v][static_cast<std::size_t>(std::max(0, halvings - 4))];
      const double order = std::log(early.error / last.error) / std::log(early.step / last.step);
      row += std::isfinite(order) ? fmt::format(" & {:.1f}", order) : " & -";
      table.add_row(row + fmt::format(" & {:.2g}, {:.2g}", last.error, last.seconds));
    }
    text += fmt::format("\n{}. Seconds (over C) of the coarsest step from which on the error stays below:\n\n{}",
                        limit.what, table.markdown());
  }
  return text;
}

}  // namespace equidem::bench
