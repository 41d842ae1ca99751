// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs that fall into a box and come to rest: does the void ratio depend on the time step?
#include <cmath>
#include <numbers>

#include "equidem/core/random.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

constexpr double smallest_radius = 0.009, largest_radius = 0.011, normal_stiffness = 1e6,
                 solid_density = 2480;  // m, Pa, kg/m³

PackingOptions options_of(int discs, double step, std::uint64_t seed) {
  PackingOptions options;
  options.method = PackingMethod::falling;
  options.box = {.size = {0.2, 1}, .sides = PackingBox::Sides::open_top};
  options.seed = seed;
  Random random(~seed);
  for (int k = 0; k < discs; ++k) options.radii.push_back(random.uniform(smallest_radius, largest_radius));
  options.settling.springs = {normal_stiffness, 0.5 * normal_stiffness};
  options.settling.density = solid_density;
  options.settling.time_step = step;
  options.settling.rest = 1e-4;
  return options;
}

}  // namespace

Study settled_void_ratio_study(bool quick) {
  const int discs = quick ? 60 : 150, seeds = quick ? 2 : 4;
  Study study{.name = "settled_void_ratio",
              .title = fmt::format("{} boxes of {} discs that fell", seeds, discs),
              .quantities = {{.name = "void_ratio",
                              .label = "difference of the mean void ratio from that of the finest step",
                              .source = "the finest step"},
                             {.name = "standard_error", .label = "standard error of the mean void ratio", .fact = true},
                             {.name = "coordination", .label = "mean number of contacts of a disc", .fact = true}},
              .tasks = {},
              .truth = Truth::finest};
  // Half a period of two of the smallest discs on one spring: how long a contact of two lasts.
  const double contact = std::numbers::pi * std::sqrt(0.5 * std::numbers::pi * smallest_radius * smallest_radius *
                                                      solid_density / normal_stiffness);
  for (int n = 8; n <= (quick ? 32 : 64); n *= 2) {
    const double step = contact / n;
    Setting setting{.values = {{"steps_in_a_contact", static_cast<double>(n)}, {"time_step", step}},
                    .resolution = step};
    const auto work = [=](std::vector<GrainPacking>& packings) {
      for (int seed = 1; seed <= seeds; ++seed)
        packings.push_back(pack(options_of(discs, step, static_cast<std::uint64_t>(seed))));
    };
    const auto values = [=](const std::vector<GrainPacking>& packings) {
      std::vector<double> voids;
      double contacts = 0;
      for (const GrainPacking& packing : packings) {
        const PackingMeasures measures = measure(packing);
        voids.push_back(measures.void_ratio);
        contacts += measures.coordination / seeds;
      }
      const MeanEstimate mean = estimate_mean(voids, 0.95);
      return std::vector{mean.mean, mean.standard_error, contacts};
    };
    study.tasks.push_back(task_on(
        std::move(setting), [] { return std::vector<GrainPacking>(); }, work, values));
  }
  study.notes = {
      "No order is expected: falling is chaotic, so that another step is another packing of the same kind. What is "
      "left of the difference is the scatter of packings, which more discs and seeds make smaller and finer steps do "
      "not."};
  return study;
}

}  // namespace equidem
