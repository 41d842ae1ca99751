// SPDX-License-Identifier: GPL-3.0-or-later
#include "comparison.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "contender.hpp"
#include "hand_loops.hpp"
#include "heap.hpp"
#include "plain_loops.hpp"
#include "scene.hpp"

namespace equidem::bench {
namespace {

/// About a tenth of a second.
std::int64_t steps_for(std::size_t discs) {
  return std::max<std::int64_t>(24, std::llround(1e7 / static_cast<double>(discs)));
}

double activity_of(const Simulation& simulation) {
  double sum = 0;
  for (const DiscMotion& v : motions_of(simulation.save()["velocities"])) sum += dot(v.u, v.u) + v.theta * v.theta;
  return sum;
}

void check_alike(const std::string& label, double activity, double expected) {
  if (std::abs(activity - expected) <= 1e-6 * expected) return;
  computation_failed(fmt::format("'{}' ends with a sum of squared velocities of {:.9g}", label, activity),
                     fmt::format("the simulation ends with {:.9g}", expected), "One of the two loops is wrong");
}

std::string with_range(const Range& range, const char* digits) {
  const auto text = [&](double value) { return fmt::format(fmt::runtime(digits), value); };
  return text(range.median) + " (" + text(range.smallest) + " .. " + text(range.largest) + ")";
}

Range speeds(const Seconds& seconds, double disc_steps) {
  std::vector<double> values;
  for (const double s : seconds) values.push_back(disc_steps / s);
  return range_of(std::move(values));
}

/// Operations per disc and step of springs with rotation: 22 for each of its contacts, 28 to move it.
double operations(const Assembly& assembly) {
  return 22 * assembly.coordination_number() + 28;
}

/// Bytes per disc and step that a loop reads and writes when nothing stays in the cache: geometry and place of every
/// neighbour, motion, motion after, velocity in and out.
double traffic(const Assembly& assembly) {
  return (3 * 8 + 4) * assembly.coordination_number() + 2 * 32 + 2 * 24;
}

}  // namespace

std::string loops_header() {
  return "| assembly | discs | loop | threads | disc-steps/s | over the plain loop | bytes/disc | of bandwidth | of "
         "peak arithmetic |\n"
         "|---|---|---|---|---|---|---|---|---|\n";
}

std::string compare_loops(const std::string& kind, std::int64_t discs, const std::vector<int>& threads, int rounds,
                          const Limits& limits) {
  const Assembly assembly = build_assembly(kind, discs);
  const std::int64_t steps = steps_for(assembly.size());
  const double disc_steps = static_cast<double>(steps) * static_cast<double>(assembly.size());
  set_thread_count(1);
  const std::unique_ptr<Contender> neighbours = plain_loop_over_neighbours(assembly);
  const std::unique_ptr<Contender> pairs = plain_loop_over_pairs(assembly);
  Scenery stepwise(assembly, variants()[0]);
  std::vector<std::unique_ptr<Scenery>> ours;
  std::vector<Entry> entries = {{"plain, over neighbours", [&](std::int64_t n) { neighbours->advance(n); }},
                                {"plain, over pairs", [&](std::int64_t n) { pairs->advance(n); }},
                                {"equidem, step by step", [&](std::int64_t n) {
                                   for (std::int64_t k = 0; k < n; ++k) stepwise.simulation().advance(1);
                                 }}};
  for (const int count : threads) {
    ours.push_back(std::make_unique<Scenery>(assembly, variants()[0]));
    Simulation& simulation = ours.back()->simulation();
    entries.push_back({"equidem", [&simulation](std::int64_t n) { simulation.advance(n); }, count});
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  const double activity = activity_of(stepwise.simulation());
  check_alike(entries[0].label, neighbours->activity(), activity);
  check_alike(entries[1].label, pairs->activity(), activity);
  for (const auto& scenery : ours) check_alike("equidem", activity_of(scenery->simulation()), activity);
  std::string table;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Range speed = speeds(seconds[k], disc_steps);
    const double cores = entries[k].threads;
    table += fmt::format("| {} | {} | {} | {} | {} | {} |", kind, assembly.size(), entries[k].label, entries[k].threads,
                         with_range(speed, "{:.3g}"), with_range(ratio_of(seconds[0], seconds[k]), "{:.2f}"));
    if (k < 2) {
      table += " | | |\n";
    } else {
      table += fmt::format(" {:.0f} | {:.0f} % | {:.0f} % |\n", stepwise.simulation().bytes_per_body(),
                           100 * speed.median * traffic(assembly) / (cores * limits.bandwidth),
                           100 * speed.median * operations(assembly) / (cores * limits.arithmetic));
    }
  }
  return table;
}

std::string count_memory(const std::string& kind, std::int64_t discs) {
  std::string table =
      "| scene | discs | assembly, bytes/disc | simulation, bytes/disc | together |\n|---|---|---|---|---|\n";
  const double before = heap_bytes();
  const Assembly assembly = build_assembly(kind, discs);
  const double with_assembly = heap_bytes(), size = static_cast<double>(assembly.size());
  for (const std::size_t k : {std::size_t{0}, std::size_t{11}}) {
    const double at_start = heap_bytes();
    const Scenery scenery(assembly, variants()[k]);
    const double own = (with_assembly - before) / size, simulation = (heap_bytes() - at_start) / size;
    table += fmt::format("| {}, {} | {} | {:.0f} | {:.0f} | {:.0f} |\n", kind, variants()[k].name, assembly.size(), own,
                         simulation, own + simulation);
  }
  return table;
}

std::string compare_effects(const std::string& kind, std::int64_t discs, int rounds) {
  const Assembly assembly = build_assembly(kind, discs);
  const std::int64_t steps = steps_for(assembly.size());
  const double disc_steps = static_cast<double>(steps) * static_cast<double>(assembly.size());
  set_thread_count(1);
  std::vector<std::unique_ptr<Scenery>> scenes;
  std::vector<Entry> entries;
  for (const Variant& variant : variants()) {
    scenes.push_back(std::make_unique<Scenery>(assembly, variant));
    Simulation& simulation = scenes.back()->simulation();
    entries.push_back({variant.name, [&simulation](std::int64_t n) { simulation.advance(n); }});
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  std::string table = "| effect | disc-steps/s | time over springs, rotation | bytes/disc |\n|---|---|---|---|\n";
  for (std::size_t k = 0; k < entries.size(); ++k) {
    table += fmt::format(
        "| {} | {} | {} | {:.0f} |\n", entries[k].label, with_range(speeds(seconds[k], disc_steps), "{:.3g}"),
        with_range(ratio_of(seconds[k], seconds[0]), "{:.2f}"), scenes[k]->simulation().bytes_per_body());
  }
  return table;
}

std::string compare_absent_effects(const std::string& kind, std::int64_t discs, int rounds) {
  const Assembly assembly = build_assembly(kind, discs);
  const std::int64_t steps = steps_for(assembly.size());
  set_thread_count(1);
  std::string table = "| scene | loop by hand, disc-steps/s | time of the simulation over it |\n|---|---|---|\n";
  for (const auto& [variant, springs] :
       {std::pair(1, LoopKind::Springs::normal), std::pair(2, LoopKind::Springs::tangential),
        std::pair(0, LoopKind::Springs::rotation)}) {
    Scenery scenery(assembly, variants()[static_cast<std::size_t>(variant)]);
    const std::unique_ptr<Contender> by_hand = loop_by_hand(assembly, springs);
    const Entry entries[] = {{"by hand", [&](std::int64_t n) { by_hand->advance(n); }},
                             {"equidem", [&](std::int64_t n) { scenery.simulation().advance(n); }}};
    const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
    check_alike("by hand", by_hand->activity(), activity_of(scenery.simulation()));
    table += fmt::format(
        "| {} | {} | {} |\n", variants()[static_cast<std::size_t>(variant)].name,
        with_range(speeds(seconds[0], static_cast<double>(steps) * static_cast<double>(assembly.size())), "{:.3g}"),
        with_range(ratio_of(seconds[1], seconds[0]), "{:.3f}"));
  }
  return table;
}

}  // namespace equidem::bench
