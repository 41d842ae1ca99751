// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Speed of the loop of bonded discs beside plain loops, its memory, and the cost of effects: bench_dynamic --help.
#include <algorithm>
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <malloc.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "bench.hpp"
#include "scene.hpp"

namespace equidem::bench {
namespace {

struct Request {
  std::vector<double> discs = {1e4, 1e6};
  std::vector<std::string> kinds = assembly_kinds();
  std::vector<int> threads = {1, 2};
  double effects_discs = 1e4;
  int rounds = 9;
  bool absent = false;  ///< absent effects alone
};

/// About a tenth of a second.
std::int64_t steps_for(const Assembly& assembly) {
  return std::max<std::int64_t>(24, std::llround(1e7 / static_cast<double>(assembly.size())));
}

double activity_of(const Simulation& simulation) {
  double sum = 0;
  for (const DiscMotion& v : motions_of(simulation.save()["velocities"])) sum += dot(v.u, v.u) + v.theta * v.theta;
  return sum;
}

/// \throws Error (computation_failed) where a loop moves otherwise than the simulation
void check_alike(const std::string& label, double activity, double expected) {
  if (std::abs(activity - expected) <= 1e-6 * expected) return;
  computation_failed(fmt::format("'{}' ends with a sum of squared velocities of {:.9g}", label, activity),
                     fmt::format("the simulation ends with {:.9g}", expected), "One of the two loops is wrong");
}

/// Disc-steps per second.
Range speed_of(const Seconds& seconds, const Assembly& assembly) {
  std::vector<double> values;
  for (const double s : seconds)
    values.push_back(static_cast<double>(steps_for(assembly)) * static_cast<double>(assembly.size()) / s);
  return range_of(std::move(values));
}

/// Operations per disc and step of springs with rotation: 22 for each of its contacts, 28 to move it.
double operations(const Assembly& assembly) {
  return 22 * assembly.coordination_number() + 28;
}

/// Bytes per disc and step that a loop reads and writes when nothing stays in the cache: geometry and place of every
/// neighbour, motion before and after, velocity read and written.
double traffic(const Assembly& assembly) {
  return (3 * 8 + 4) * assembly.coordination_number() + 2 * 32 + 2 * 24;
}

Entry entry_of(const std::string& label, Scenery& scenery, int threads = 1) {
  return {label, [&simulation = scenery.simulation()](std::int64_t n) { simulation.advance(n); }, threads};
}

void compare_loops(TextTable& table, const std::string& kind, double discs, const Request& request,
                   const Limits& limits) {
  const Assembly assembly = build_assembly(kind, static_cast<std::int64_t>(discs), 1);
  set_thread_count(1);
  const std::unique_ptr<Contender> neighbours = plain_loop_over_neighbours(assembly);
  const std::unique_ptr<Contender> pairs = plain_loop_over_pairs(assembly);
  Scenery stepwise(assembly, variants()[0]);
  std::vector<std::unique_ptr<Scenery>> whole;
  std::vector<Entry> entries = {{"plain, over neighbours", [&](std::int64_t n) { neighbours->advance(n); }},
                                {"plain, over pairs", [&](std::int64_t n) { pairs->advance(n); }},
                                {"equidem, step by step", [&](std::int64_t n) {
                                   for (std::int64_t k = 0; k < n; ++k) stepwise.simulation().advance(1);
                                 }}};
  for (const int count : request.threads) {
    whole.push_back(std::make_unique<Scenery>(assembly, variants()[0]));
    entries.push_back(entry_of("equidem", *whole.back(), count));
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps_for(assembly), request.rounds);
  const double activity = activity_of(stepwise.simulation());
  check_alike(entries[0].label, neighbours->activity(), activity);
  check_alike(entries[1].label, pairs->activity(), activity);
  for (const auto& scenery : whole) check_alike("equidem", activity_of(scenery->simulation()), activity);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Range speed = speed_of(seconds[k], assembly);
    const double per_core = 100 * speed.median / entries[k].threads;
    const std::string use = k < 2 ? " &  & "
                                  : fmt::format("{:.0f} & {:.0f} % & {:.0f} %", stepwise.simulation().bytes_per_body(),
                                                per_core * traffic(assembly) / limits.bandwidth,
                                                per_core * operations(assembly) / limits.arithmetic);
    table.add("{} & {} & {} & {} & {} & {} & {}", kind, assembly.size(), entries[k].label, entries[k].threads,
              speed.text("{:.3g}"), ratio_of(seconds[0], seconds[k]).text("{:.2f}"), use);
  }
}

/// Bytes that the program has allocated and not freed.
double heap_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

void count_memory(TextTable& table, const std::string& kind, double discs) {
  const double before = heap_bytes();
  const Assembly assembly = build_assembly(kind, static_cast<std::int64_t>(discs), 1);
  const double size = static_cast<double>(assembly.size()), own = (heap_bytes() - before) / size;
  for (const char* name : {"springs, rotation", "finite motions"}) {
    const Variant& variant = *std::ranges::find(variants(), name, &Variant::name);
    const double at_start = heap_bytes();
    const Scenery scenery(assembly, variant);
    const double simulation = (heap_bytes() - at_start) / size;
    table.add("{}, {} & {} & {:.0f} & {:.0f} & {:.0f}", kind, name, assembly.size(), own, simulation, own + simulation);
  }
}

/// Every variant beside the plain one.
std::string compare_effects(const Assembly& assembly, int rounds) {
  set_thread_count(1);
  std::vector<std::unique_ptr<Scenery>> scenes;
  std::vector<Entry> entries;
  for (const Variant& variant : variants()) {
    scenes.push_back(std::make_unique<Scenery>(assembly, variant));
    entries.push_back(entry_of(variant.name, *scenes.back()));
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps_for(assembly), rounds);
  TextTable table("effect & disc-steps/s & time over springs, rotation & bytes/disc");
  for (std::size_t k = 0; k < entries.size(); ++k)
    table.add("{} & {} & {} & {:.0f}", entries[k].label, speed_of(seconds[k], assembly).text("{:.3g}"),
              ratio_of(seconds[k], seconds[0]).text("{:.2f}"), scenes[k]->simulation().bytes_per_body());
  return table.markdown();
}

/// The simulation beside loops written by hand for its scene alone.
std::string compare_absent_effects(const Assembly& assembly, int rounds) {
  set_thread_count(1);
  TextTable table("scene & loop by hand, disc-steps/s & time of the simulation over it");
  for (const auto& [variant, springs] : {std::pair{std::size_t{1}, LoopKind::Springs::normal},
                                         {std::size_t{2}, LoopKind::Springs::tangential},
                                         {std::size_t{0}, LoopKind::Springs::rotation}}) {
    Scenery scenery(assembly, variants()[variant]);
    const std::unique_ptr<Contender> by_hand = loop_by_hand(assembly, springs);
    const Entry entries[] = {{"by hand", [&](std::int64_t n) { by_hand->advance(n); }}, entry_of("equidem", scenery)};
    const std::vector<Seconds> seconds = take_turns(entries, steps_for(assembly), rounds);
    check_alike("by hand", by_hand->activity(), activity_of(scenery.simulation()));
    table.add("{} & {} & {}", variants()[variant].name, speed_of(seconds[0], assembly).text("{:.3g}"),
              ratio_of(seconds[1], seconds[0]).text("{:.3f}"));
  }
  return table.markdown();
}

void report_absent_effects(Report& report, const Assembly& assembly, int rounds) {
  report.add("\nCost of absent effects: each scene beside a loop written by hand for it alone.\n\n" +
             compare_absent_effects(assembly, 3 * rounds));
}

void run(Report& report, const Request& request) {
  if (request.absent) {
    const auto discs = static_cast<std::int64_t>(request.effects_discs);
    for (const std::string& kind : request.kinds)
      report_absent_effects(report, build_assembly(kind, discs, 1), request.rounds);
    return;
  }
  const Limits limits = machine_limits();
  report.begin("Steps in time");
  report.add(
      fmt::format("\nOne core: triad {:.1f} GB/s, multiply-adds on four numbers {:.1f} Gflop/s. Medians (smallest .. "
                  "largest) of {} "
                  "rounds in which all take turns; one thread: processor time, more: wall time.\n",
                  1e-9 * limits.bandwidth, 1e-9 * limits.arithmetic, request.rounds));
  report.add(
      "\n## Beside plain loops\n\nSprings kN and kT, rotation, small motions, leapfrog. Bandwidth counts the bytes "
      "that "
      "a loop would stream if nothing stayed in the cache.\n\n");
  TextTable loops(
      "assembly & discs & loop & threads & disc-steps/s & over the plain loop & bytes/disc & of bandwidth & of peak "
      "arithmetic");
  TextTable memory("scene & discs & assembly, bytes/disc & simulation, bytes/disc & together");
  for (const std::string& kind : request.kinds) {
    for (const double discs : request.discs) compare_loops(loops, kind, discs, request, limits);
    count_memory(memory, kind, request.discs.back());
  }
  report.add(loops.markdown() + "\n## Memory\n\nAll that is allocated and kept, counted by the allocator.\n\n" +
             memory.markdown());
  for (const std::string& kind : request.kinds) {
    const Assembly assembly = build_assembly(kind, static_cast<std::int64_t>(request.effects_discs), 1);
    report.add(fmt::format("\n## Cost of effects: {}, {} discs\n\n", kind, assembly.size()) +
               compare_effects(assembly, request.rounds));
    report_absent_effects(report, assembly, request.rounds);
  }
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  Request request;
  return run_benchmark(
      "bench_dynamic", "Steps in time beside plain loops, memory, and the cost of each effect", argc, argv,
      [&](CLI::App& app) {
        app.add_option("--discs", request.discs, "numbers of discs")->delimiter(',')->check(CLI::PositiveNumber);
        app.add_option("--kinds", request.kinds, "assemblies")->delimiter(',')->check(CLI::IsMember(assembly_kinds()));
        app.add_option("--threads", request.threads, "numbers of threads")->delimiter(',')->check(CLI::PositiveNumber);
        app.add_option("--effects-discs", request.effects_discs, "discs for the tables of effects")
            ->check(CLI::PositiveNumber);
        app.add_option("--rounds", request.rounds, "of all entries in turn")->check(CLI::PositiveNumber);
        app.add_flag("--absent", request.absent, "the loops by hand alone: cost of absent effects");
      },
      [&](Report& report) { run(report, request); });
}
