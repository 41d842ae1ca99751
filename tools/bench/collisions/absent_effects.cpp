// SPDX-License-Identifier: GPL-3.0-or-later
#include "absent_effects.hpp"

#include <cmath>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "contender.hpp"
#include "hand_loops.hpp"
#include "scenes.hpp"
#include "variants.hpp"

namespace equidem::bench {
namespace {

/// \throws Error (computation_failed) where the two do not do the same
template <class Loop>
void check_alike(const GrainSimulation& simulation, const Loop& loop, double tolerance) {
  const std::vector<Grain> grains = simulation.grains();
  double worst = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) worst = std::max(worst, norm(grains[i].position - loop.position(i)));
  if (worst <= tolerance) return;
  computation_failed(fmt::format("the loop by hand and the simulation are {:.3g} m apart", worst),
                     "they should do the same", "One of the two is wrong");
}

std::string row(const std::string& name, const Seconds& seconds, const Seconds& by_hand, double disc_steps,
                const std::string& bytes) {
  const Range time = range_of(seconds), over = ratio_of(seconds, by_hand);
  return fmt::format("| {} | {:.2f} ({:.2f} .. {:.2f}) | {:.2f} ({:.2f} .. {:.2f}) | {} |\n", name,
                     1e9 * time.median / disc_steps, 1e9 * time.smallest / disc_steps, 1e9 * time.largest / disc_steps,
                     over.median, over.smallest, over.largest, bytes);
}

constexpr const char* header =
    "| loop | ns per disc and step | over the loop by hand | bytes per disc |\n|---|---|---|---|\n";

}  // namespace

std::string compare_free_flight(int discs, int rounds) {
  constexpr double dt = 1e-4;
  constexpr std::int64_t steps = 200;
  const GrainScene scene = free_flight(discs);
  FallingPoints points(scene);
  std::vector<GrainSimulation> simulations;
  std::vector<Entry> entries{{"by hand", [&](std::int64_t n) { points.advance(n, dt); }}};
  simulations.reserve(variants().size());
  for (const Variant& variant : variants()) {
    if (variant.law == NormalLaw::five_case_map || variant.law == NormalLaw::hertz_dashpot ||
        variant.dimensionless > 3 || variant.dimensionless < 0.1) {
      continue;  // their step is that of P, C and X
    }
    simulations.push_back(start(scene, variant, dt));
    GrainSimulation& simulation = simulations.back();
    entries.push_back({variant.name, [&simulation](std::int64_t n) { simulation.advance(n); }});
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  check_alike(simulations[0], points, 1e-9);
  std::string table = header;
  const double disc_steps = static_cast<double>(discs) * static_cast<double>(steps);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    table += row(entries[k].label, seconds[k], seconds[0], disc_steps,
                 k > 0 ? fmt::format("{:.0f}", simulations[k - 1].bytes_per_body()) : "32");
  }
  return table + fmt::format("\nLists of neighbours made in {} steps: {}.\n", simulations[0].step(),
                             simulations[0].counters().rebuilds);
}

std::string compare_friction(int columns, int rows, int rounds) {
  constexpr double dt = 1e-3;
  constexpr std::int64_t steps = 100;
  const Variant law = variants()[0];
  PairProperties pair = pair_of(law, 0.7);
  const GrainScene smooth = packed_bed(columns, rows, pair);
  pair.friction = 0.5;
  pair.tangential_ratio = 0.5;
  FrictionlessDiscs by_hand(smooth, 0.1, dt);
  GrainSimulation without = start(smooth, law, dt), with = start(packed_bed(columns, rows, pair), law, dt);
  const Entry entries[] = {{"by hand, without friction", [&](std::int64_t n) { by_hand.advance(n); }},
                           {"C, friction 0", [&](std::int64_t n) { without.advance(n); }},
                           {"C, friction 0.5 with springs", [&](std::int64_t n) { with.advance(n); }}};
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  check_alike(without, by_hand, 1e-6);
  const double disc_steps = static_cast<double>(smooth.grains.size()) * static_cast<double>(steps);
  return header + row(entries[0].label, seconds[0], seconds[0], disc_steps, "") +
         row(entries[1].label, seconds[1], seconds[0], disc_steps, fmt::format("{:.0f}", without.bytes_per_body())) +
         row(entries[2].label, seconds[2], seconds[0], disc_steps, fmt::format("{:.0f}", with.bytes_per_body()));
}

}  // namespace equidem::bench
