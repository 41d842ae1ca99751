// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Settled boxes of discs, ellipses and clumps on one thread and on several: bench_grain_threads --help.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <CLI/CLI.hpp>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

#include "bench.hpp"
#include "text_table.hpp"

namespace equidem::bench {
namespace {

constexpr double step = 1.5e-5, density = 25, largest = 0.01, spacing = 0.0205;
const char* const all_shapes[] = {"discs", "ellipses", "clumps"};

/// Bodies whose bounding circles are of radius 0.5 to 1 cm, in a loose lattice above the floor of a box without a lid.
/// \param shape one of all_shapes
GrainScene loose_bodies(const std::string& shape, std::size_t count) {
  const auto columns = static_cast<std::size_t>(std::sqrt(1.1 * static_cast<double>(count)));
  Random random(7);
  GrainScene scene;
  constexpr int sizes = 8;  // clumps of one size share a shape
  for (int k = 0; k < sizes && shape == "clumps"; ++k) {
    const double size = largest * (0.5 + 0.5 * k / (sizes - 1));
    scene.clumps.push_back(centred_clump({{{-0.3 * size, 0}, 0.7 * size}, {{0.3 * size, 0}, 0.7 * size}}));
  }
  for (std::size_t k = 0; k < count; ++k) {
    Grain grain;
    const int size = static_cast<int>(random.below(sizes));
    grain.radius = largest * random.uniform(0.5, 1);
    if (shape == "clumps") {
      grain.clump = size;
      grain.radius = radius_of(scene.clumps[static_cast<std::size_t>(size)]);
      grain.inertia = inertia_of_clump(scene.clumps[static_cast<std::size_t>(size)], density);
    } else if (shape == "ellipses") {
      grain.short_half_axis = 0.7 * grain.radius;
      grain.inertia = inertia_of_ellipse(grain.radius, grain.short_half_axis, density);
    } else {
      grain.inertia = inertia_of(grain.radius, density, Body::disc);
    }
    grain.angle = random.uniform(0, 2 * std::numbers::pi);
    const double room = largest - grain.radius;
    const double x = (static_cast<double>(k % columns) + 0.5) * spacing + random.uniform(-room, room);
    grain.position = {x, (static_cast<double>(k / columns) + 0.5) * spacing + random.uniform(-room, room)};
    scene.grains.push_back(grain);
  }
  scene.walls = box_walls(static_cast<double>(columns) * spacing);
  scene.gravity = {0, -9.81};
  scene.pairs = {
      {.stiffness = 1e5, .restitution = 0.4, .friction = 0.3, .tangential_ratio = 0.8, .tangential_damping = 0.1}};
  return scene;
}

GrainOptions options() {
  return {.law = NormalLaw::linear_dashpot, .time_step = step};
}

/// The scene as it has come to rest.
GrainScene settled(GrainScene scene, double seconds) {
  GrainSimulation simulation(scene, options());
  simulation.advance(static_cast<std::int64_t>(seconds / step));
  scene.grains = simulation.grains();
  return scene;
}

/// So many boxes side by side without the walls between them.
GrainScene side_by_side(const GrainScene& box, std::size_t copies) {
  const double width = box.walls.back().point.x;
  GrainScene row = box;
  for (std::size_t k = 1; k < copies; ++k) {
    for (Grain grain : box.grains) {
      grain.position.x += static_cast<double>(k) * width;
      row.grains.push_back(grain);
    }
  }
  row.walls = box_walls(static_cast<double>(copies) * width);
  return row;
}

struct Request {
  std::vector<std::string> shapes{std::begin(all_shapes), std::end(all_shapes)};
  std::size_t box = 20000;
  std::vector<std::size_t> boxes{1, 50};
  std::vector<int> threads{1, 2};
  int rounds = 5;
  double work = 4e7, settle = 1.9;
  std::int64_t joining = 500;
};

void measure(TextTable& table, const Request& request, const std::string& shape, const GrainScene& scene) {
  GrainSimulation simulation(scene, options());
  set_thread_count(request.threads.back());
  simulation.advance(request.joining);
  simulation.stop_all();
  simulation.advance(request.joining);
  const auto bodies = static_cast<double>(scene.grains.size());
  const auto steps = std::max<std::int64_t>(1, static_cast<std::int64_t>(request.work / bodies));
  std::vector<Entry> entries;
  for (const int threads : request.threads) {
    entries.push_back({fmt::format("{}", threads), [&](std::int64_t n) { simulation.advance(n); }, threads});
  }
  const GrainCounters start = simulation.counters();
  const std::vector<Seconds> seconds = take_turns(entries, steps, request.rounds);
  const double made = static_cast<double>(steps) * (request.rounds + 1) * static_cast<double>(entries.size());
  const double contacts = static_cast<double>(simulation.counters().evaluations - start.evaluations) / made / bodies;
  const double nanoseconds = 1e9 / (bodies * static_cast<double>(steps));
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Range each = range_of(seconds[k]) * nanoseconds;
    table.add("{} & {} & {} & {} & {:.3g} & {} & {:.2f} & {:.0f}", shape, scene.grains.size(), entries[k].label,
              each.text("{:.1f}"), 1e9 / each.median, ratio_of(seconds[0], seconds[k]).text("{:.2f}"), contacts,
              simulation.bytes_per_body());
  }
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem;
  using namespace equidem::bench;
  Request request;
  return run_benchmark(
      "bench_grain_threads", "Settled boxes of grains on one thread and on several", argc, argv,
      [&](CLI::App& app) {
        app.add_option("--shapes", request.shapes, "discs, ellipses, clumps")
            ->delimiter(',')
            ->check(CLI::IsMember(std::vector<std::string>(std::begin(all_shapes), std::end(all_shapes))));
        app.add_option("--box", request.box, "grains that settle")->check(CLI::Range(100, 1000000));
        app.add_option("--boxes", request.boxes, "numbers of such boxes side by side")->delimiter(',');
        app.add_option("--threads", request.threads, "numbers of threads")->delimiter(',')->check(CLI::Range(1, 1024));
        app.add_option("--rounds", request.rounds, "measurements; the median is reported")->check(CLI::Range(1, 1000));
        app.add_option("--work", request.work, "grains times steps in each measurement");
        app.add_option("--settle", request.settle, "time for a box to fall and come to rest, s");
        app.add_option("--joining", request.joining, "steps before and after all grains are stopped");
      },
      [&](Report& report) {
        report.begin("Settled grains on several threads");
        TextTable table(
            "shape & grains & threads & ns per grain and step & grain-steps/s & over the first & contacts per grain & "
            "bytes per grain");
        for (const std::string& shape : request.shapes) {
          set_thread_count(request.threads.back());
          const GrainScene box = settled(loose_bodies(shape, request.box), request.settle);
          for (const std::size_t boxes : request.boxes) measure(table, request, shape, side_by_side(box, boxes));
        }
        report.add(fmt::format("\nDiscs, ellipses of aspect 1.4 and rigid pairs of discs, their bounding circles of "
                               "radius 0.5 to 1 cm, "
                               "linear spring and dashpot, friction 0.3 with a tangential spring. {} of them have "
                               "fallen into a box and "
                               "come to rest; larger numbers are such boxes side by side without the walls between "
                               "them, settled again "
                               "for {} steps. One thread: processor time; more: wall time; medians (smallest .. "
                               "largest) of {} rounds in "
                               "which all take turns. The bits of the motion are those of one thread.\n\n",
                               request.box, 2 * request.joining, request.rounds) +
                   table.markdown());
      });
}
