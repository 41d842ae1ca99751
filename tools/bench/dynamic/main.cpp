// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Speed of the loop of bonded discs beside a plain loop and loops by hand: bench_dynamic --help.
#include <algorithm>
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "bench.hpp"
#include "scene.hpp"

namespace equidem::bench {
namespace {

constexpr const char* introduction = R"(
One core: triad {:.1f} GB/s, multiply-adds on four numbers {:.1f} Gflop/s. Medians (smallest .. largest) of {} rounds in
which all take turns; one thread: processor time, more: wall time.

## Beside a plain loop

Springs kN and kT, rotation, small motions, leapfrog. Bandwidth counts the bytes that a loop would stream if nothing
stayed in the cache.

)";

struct Request {
  Sizes sizes = {.discs = {1e4, 1e6}, .rounds = 9};
  double absent_discs = 1e4;
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

void compare_loops(TextTable& table, const std::string& kind, double discs, const Request& request,
                   const Limits& limits) {
  const Assembly assembly = build_assembly(kind, static_cast<std::int64_t>(discs), 1);
  set_thread_count(1);
  const std::unique_ptr<Contender> plain = plain_loop(assembly);
  Scenery stepwise(assembly);
  std::vector<std::unique_ptr<Scenery>> whole;
  std::vector<Entry> entries = {entry_of("plain, over pairs", *plain), {"equidem, step by step", [&](std::int64_t n) {
                                                                          for (std::int64_t k = 0; k < n; ++k)
                                                                            stepwise.simulation().advance(1);
                                                                        }}};
  for (const int count : request.sizes.threads) {
    whole.push_back(std::make_unique<Scenery>(assembly));
    entries.push_back(entry_of("equidem", whole.back()->simulation(), count));
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps_for(assembly), request.sizes.rounds);
  const double activity = activity_of(stepwise.simulation());
  check_alike(entries[0].label, plain->activity(), activity);
  for (const auto& scenery : whole) check_alike("equidem", activity_of(scenery->simulation()), activity);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Range speed = speed_of(seconds[k], assembly);
    const double per_core = 100 * speed.median / entries[k].threads;
    const std::string use = k == 0 ? " &  & "
                                   : fmt::format("{:.0f} & {:.0f} % & {:.0f} %", stepwise.simulation().bytes_per_body(),
                                                 per_core * traffic(assembly) / limits.bandwidth,
                                                 per_core * operations(assembly) / limits.arithmetic);
    table.add("{} & {} & {} & {} & {} & {} & {}", kind, assembly.size(), entries[k].label, entries[k].threads,
              speed.text("{:.3g}"), ratio_of(seconds[0], seconds[k]).text("{:.2f}"), use);
  }
}

/// The simulation beside loops written by hand for its scene alone.
std::string compare_absent_effects(const Assembly& assembly, int rounds) {
  set_thread_count(1);
  TextTable table("scene & loop by hand, disc-steps/s & time of the simulation over it");
  for (const auto& [label, springs] : {std::pair{"normal springs only", LoopKind::Springs::normal},
                                       {"rotation restrained", LoopKind::Springs::tangential},
                                       {"springs, rotation", LoopKind::Springs::rotation}}) {
    Scenery scenery(assembly, springs);
    const std::unique_ptr<Contender> by_hand = loop_by_hand(assembly, springs);
    const Entry entries[] = {entry_of("by hand", *by_hand), entry_of("equidem", scenery.simulation())};
    const std::vector<Seconds> seconds = take_turns(entries, steps_for(assembly), 3 * rounds);
    check_alike("by hand", by_hand->activity(), activity_of(scenery.simulation()));
    table.add("{} & {} & {}", label, speed_of(seconds[0], assembly).text("{:.3g}"),
              ratio_of(seconds[1], seconds[0]).text("{:.3f}"));
  }
  return table.markdown();
}

void run(Report& report, const Request& request) {
  if (!request.absent) {
    const Limits limits = machine_limits();
    report.begin("Steps in time");
    report.add(fmt::format(introduction, 1e-9 * limits.bandwidth, 1e-9 * limits.arithmetic, request.sizes.rounds));
    TextTable loops(
        "assembly & discs & loop & threads & disc-steps/s & over the plain loop & bytes/disc & of bandwidth & of peak "
        "arithmetic");
    for (const std::string& kind : request.sizes.kinds)
      for (const double discs : request.sizes.discs) compare_loops(loops, kind, discs, request, limits);
    report.add(loops.markdown());
  }
  report.add("\n## Cost of absent effects\n\nEach scene beside a loop written by hand for it alone.\n");
  for (const std::string& kind : request.sizes.kinds) {
    const Assembly assembly = build_assembly(kind, static_cast<std::int64_t>(request.absent_discs), 1);
    report.add(fmt::format("\n{}, {} discs:\n\n", kind, assembly.size()) +
               compare_absent_effects(assembly, request.sizes.rounds));
  }
}

}  // namespace

std::vector<DiscMotion> start_motions(const Assembly& assembly) {
  double width = 1;
  for (const Vec2 x : assembly.centres) width = std::max(width, x.x);
  std::vector<DiscMotion> motions(assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    const double phase = 6.0 * assembly.centres[d].x / width;
    motions[d] = {{0.01 * std::sin(phase), 0.01 * std::cos(phase)}, 0.001 * std::sin(phase)};
  }
  return motions;
}

Scenery::Scenery(const Assembly& assembly, LoopKind::Springs springs)
    : springs_({.kN = scene_springs.kN, .kT = springs == LoopKind::Springs::normal ? 0 : scene_springs.kT}),
      simulation_(Scene(assembly, springs_, std::vector<Inertia>(assembly.size(), scene_inertia)),
                  {.rotation = springs == LoopKind::Springs::tangential ? Rotation::restrained : Rotation::from_scene,
                   .time_step = time_step}) {
  SavedState state = simulation_.save();
  state["motions"] = state["previous"] = numbers_of(start_motions(assembly));
  simulation_.restore(state);
}

}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  Request request;
  return run_benchmark(
      "bench_dynamic", "Steps in time beside a plain loop and loops by hand", argc, argv,
      [&](CLI::App& app) {
        request.sizes.declare(app);
        app.add_option("--absent-discs", request.absent_discs, "discs beside loops by hand")
            ->check(CLI::PositiveNumber);
        app.add_flag("--absent", request.absent, "the loops by hand alone: cost of absent effects");
      },
      [&](Report& report) { run(report, request); });
}
