// SPDX-License-Identifier: GPL-3.0-or-later
#include "accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "hard_discs.hpp"
#include "processor_time.hpp"
#include "scenes.hpp"
#include "scenes/fujioka2005_scenes.hpp"
#include "variants.hpp"

namespace equidem::bench {
namespace {

/// A scene whose outcome is known for rigid bodies.
struct Study {
  std::string what;
  std::function<GrainScene(const Variant&)> scene;
  double time = 0, coarsest = 0;
  std::function<double(const std::vector<Grain>&)> error;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

Study ball() {
  constexpr double time = 2.5, drop = 2.25, e = 0.7;
  const double truth = fujioka2005::rigid_height(drop, e, time);
  return {"A ball dropped from 2.25 m, e = 0.7, after three impacts: error of its height at 2.5 s over 2.25 m",
          [](const Variant& variant) { return fujioka2005::column(pair_of(variant, e), 1, 1, drop); }, time, 0.02,
          [=](const std::vector<Grain>& grains) {
            return std::abs(grains[0].position.y - grains[0].radius - truth) / drop;
          }};
}

Study stack() {
  return {"One sphere on two (section 5.6), e = 0.7: relative error of d' at 1.3 T0",
          [](const Variant& variant) { return fujioka2005::stacked(pair_of(variant, 0.7)); },
          1.3 * fujioka2005::exact_parting, 2e-3,
          [=](const std::vector<Grain>& grains) {
            return std::abs(fujioka2005::dimensionless_speed(grains[1].velocity.x) / fujioka2005::exact_speed - 1);
          }};
}

Study dilute_gas() {
  constexpr double time = 3, e = 0.9;
  const auto scene = [](const Variant& variant) { return gas(1000, 0.2, pair_of(variant, e)); };
  int impacts = 0;
  const std::vector<Grain> truth = hard_discs_at(scene(variants()[0]), time, impacts);
  return {
      fmt::format("1000 discs in a box, solid fraction 0.2, e = 0.9, {} impacts: median error of place over the radius",
                  impacts),
      scene, time, 0.05, [=](const std::vector<Grain>& grains) {
        std::vector<double> errors;
        for (std::size_t i = 0; i < grains.size(); ++i) {
          errors.push_back(norm(grains[i].position - truth[i].position) / grains[i].radius);
        }
        return median(std::move(errors));
      }};
}

Study study_of(const std::string& name) {
  if (name == "ball") return ball();
  if (name == "stack") return stack();
  if (name == "gas") return dilute_gas();
  bad_input(fmt::format("'{}' is no scene", name), "", "Choose ball, stack or gas");
}

struct Point {
  double step, seconds, error;
};

/// Every law and step in turn; a law that fails at a step (centres would pass each other) has an infinite error there.
std::vector<std::vector<Point>> curves_of(const Study& study, int finest, int rounds) {
  std::vector<std::vector<Point>> curves(variants().size());
  for (int k = 0; k <= finest; ++k) {
    const auto steps = static_cast<std::int64_t>(std::llround(study.time / (study.coarsest * std::pow(0.5, k))));
    const double step = study.time / static_cast<double>(steps);
    for (auto& curve : curves) curve.push_back({step, 1e300, 1e300});
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t v = 0; v < curves.size(); ++v) {
        const Variant variant = variants()[v];
        try {
          GrainSimulation simulation = start(study.scene(variant), variant, step);
          const double begin = processor_time();
          simulation.advance(steps);
          curves[v].back().seconds = std::min(curves[v].back().seconds, processor_time() - begin);
          curves[v].back().error = study.error(simulation.grains());
        } catch (const Error&) {
          continue;
        }
      }
    }
  }
  return curves;
}

/// Seconds of the coarsest step from which on the error stays below.
std::optional<double> seconds_for(const std::vector<Point>& curve, double error) {
  std::optional<double> seconds;
  for (auto point = curve.rbegin(); point != curve.rend() && point->error <= error; ++point) seconds = point->seconds;
  return seconds;
}

}  // namespace

std::string compare_accuracy(const std::string& scene, int finest, int rounds) {
  const Study study = study_of(scene);
  const std::vector<std::vector<Point>> curves = curves_of(study, finest, rounds);
  std::string table =
      fmt::format("{}. Seconds (over C) of the coarsest step from which on the error stays below:\n\n", study.what);
  table += "| law | 1e-1 | 1e-2 | 1e-3 | 1e-4 | order of the error | error, seconds at the finest step |\n";
  table += "|---|---|---|---|---|---|---|\n";
  for (std::size_t v = 0; v < curves.size(); ++v) {
    table += fmt::format("| {} |", variants()[v].name);
    for (const double error : {1e-1, 1e-2, 1e-3, 1e-4}) {
      const auto own = seconds_for(curves[v], error), of_c = seconds_for(curves[0], error);
      table += own ? fmt::format(" {:.2g}", *own) : std::string(" -");
      table += own && of_c ? fmt::format(" ({:.2f}) |", *own / *of_c) : std::string(" |");
    }
    const Point& last = curves[v].back();
    const Point& early = curves[v][curves[v].size() - 1 - std::min<std::size_t>(4, curves[v].size() - 1)];
    table +=
        fmt::format(" {:.1f} | {:.2g}, {:.2g} |\n",
                    std::log(early.error / last.error) / std::log(early.step / last.step), last.error, last.seconds);
  }
  return table;
}

}  // namespace equidem::bench
