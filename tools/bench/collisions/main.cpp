// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cost of a step of colliding bodies, law by law, and of effects that the scene lacks: bench_collisions --help.
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

#include "bench.hpp"
#include "loops.hpp"

namespace equidem::bench {
namespace {

/// A law with its settings.
struct Variant {
  std::string name;
  NormalLaw law;
  double dimensionless;  ///< a = k dt²/m
  GrainOptions::Integrator integrator = GrainOptions::Integrator::semi_implicit_euler;
};

/// C first. The stiffness of Fujioka & Ushijima (2005), Table 2: a = 0.1, for T 4.62; X also at w dt = 2.
const std::vector<Variant> variants{
    {"C", NormalLaw::linear_dashpot, 0.1},
    {"C, velocity Verlet", NormalLaw::linear_dashpot, 0.1, GrainOptions::Integrator::velocity_verlet},
    {"T", NormalLaw::hertz_dashpot, 4.62},
    {"F", NormalLaw::five_case_map, 0.1},
    {"P", NormalLaw::energy_map, 0.1},
    {"X", NormalLaw::exact_flow, 0.1},
    {"X, a = 4", NormalLaw::exact_flow, 4}};

PairProperties pair_of(const Variant& variant, double restitution) {
  return {.dimensionless = variant.dimensionless,
          .restitution = restitution,
          .end = variant.law == NormalLaw::exact_flow ? ContactEnd::at_zero_force : ContactEnd::at_zero_overlap};
}

GrainSimulation start(const GrainScene& scene, const Variant& variant, double step) {
  return {scene, {.law = variant.law, .integrator = variant.integrator, .time_step = step}};
}

constexpr double radius = 0.5;  // m, of all discs; their mass is 1 kg

Grain disc_at(Vec2 position, Vec2 velocity = {}) {
  const double density = 1 / (std::numbers::pi * radius * radius);
  return {
      .position = position, .radius = radius, .inertia = inertia_of(radius, density, Body::disc), .velocity = velocity};
}

/// Discs in a square box on a grid of the given solid fraction, with velocities of 1 m/s in random directions.
GrainScene gas(int discs, double fraction, const PairProperties& pair) {
  const double spacing = radius * std::sqrt(std::numbers::pi / fraction);
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(discs))));
  GrainScene scene;
  scene.pairs = {pair};
  Random random(1);
  for (int k = 0; k < discs; ++k) {
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    scene.grains.push_back(disc_at({(k % columns + 0.5) * spacing, (std::floor(k / columns) + 0.5) * spacing},
                                   {std::cos(angle), std::sin(angle)}));
  }
  scene.walls = box_walls(columns * spacing, columns * spacing);
  return scene;
}

/// Discs on a wide grid that fall and drift apart without contact.
GrainScene free_flight(int discs) {
  GrainScene scene = gas(discs, 0.03, {.dimensionless = 0.1});
  scene.walls.clear();
  scene.gravity = {0, -9.8};
  for (Grain& grain : scene.grains) grain.velocity = 0.01 * grain.velocity;
  return scene;
}

/// Rows of discs that rest on a floor between two walls, pressed together by gravity.
GrainScene packed_bed(int columns, int rows, const PairProperties& pair) {
  constexpr double spacing = 2 * radius - 5e-4;  // overlapping from the start
  GrainScene scene;
  scene.pairs = {pair};
  scene.gravity = {0, -1};
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < columns; ++k)
      scene.grains.push_back(
          disc_at({(k + 0.5 + 0.5 * (row % 2)) * spacing, (0.5 + 0.5 * std::numbers::sqrt3 * row) * spacing}));
  scene.walls = box_walls((columns + 0.5) * spacing);
  return scene;
}

/// 2500 discs in a box stepped by every law: "gas", colliding without loss, or "bed", at rest under gravity.
std::string compare_laws(std::string_view scene, int rounds) {
  constexpr std::int64_t steps = 100;
  constexpr int side = 50, discs = side * side;
  const bool is_gas = scene == "gas";
  std::vector<GrainSimulation> simulations;
  std::vector<Entry> entries;
  std::vector<std::int64_t> before;
  simulations.reserve(variants.size());
  for (const Variant& variant : variants) {
    const bool lasts = variant.law == NormalLaw::linear_dashpot || variant.law == NormalLaw::hertz_dashpot ||
                       (variant.law == NormalLaw::exact_flow && variant.dimensionless < 1);
    if (!is_gas && !lasts) continue;  // refused or unstable in a bed
    simulations.push_back(
        start(is_gas ? gas(discs, 0.6, pair_of(variant, 1)) : packed_bed(side, side, pair_of(variant, 0.7)), variant,
              is_gas ? 2e-3 : 1e-3));
    simulations.back().advance(500);  // away from the grid, or to rest
    before.push_back(simulations.back().counters().evaluations);
    entries.push_back(entry_of(variant.name, simulations.back()));
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  TextTable table("law & evaluations per disc and step & ns per disc and step & over C & bytes per disc");
  constexpr auto disc_steps = static_cast<double>(discs * steps);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const auto evaluations = static_cast<double>(simulations[k].counters().evaluations - before[k]);
    table.add("{} & {:.3f} & {} & {} & {:.0f}", entries[k].label, evaluations / (disc_steps * (rounds + 1)),
              (range_of(seconds[k]) * (1e9 / disc_steps)).text("{:.1f}"),
              ratio_of(seconds[k], seconds[0]).text("{:.2f}"), simulations[k].bytes_per_body());
  }
  return table.markdown();
}

/// \throws Error (computation_failed) where positions differ
template <class Loop>
void check_alike(const GrainSimulation& simulation, const Loop& loop, double tolerance) {
  const std::vector<Grain> grains = simulation.grains();
  double worst = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) worst = std::max(worst, norm(grains[i].position - loop.position(i)));
  if (worst <= tolerance) return;
  computation_failed(fmt::format("the loop by hand and the simulation are {:.3g} m apart", worst),
                     "both compute the same motion", "One of the two is wrong");
}

/// The first entry is the loop by hand.
std::string table_beside_hand_loop(std::span<const Entry> entries, const std::vector<Seconds>& seconds,
                                   std::span<const double> bytes, double disc_steps) {
  TextTable table("loop & ns per disc and step & over the loop by hand & bytes per disc");
  for (std::size_t k = 0; k < entries.size(); ++k)
    table.add("{} & {} & {} & {}", entries[k].label, (range_of(seconds[k]) * (1e9 / disc_steps)).text("{:.2f}"),
              ratio_of(seconds[k], seconds[0]).text("{:.2f}"), bytes[k] > 0 ? fmt::format("{:.0f}", bytes[k]) : "");
  return table.markdown();
}

std::string compare_free_flight(int rounds) {
  constexpr double dt = 1e-4;
  constexpr std::int64_t steps = 200;
  constexpr int discs = 10000;
  const GrainScene scene = free_flight(discs);
  FallingPoints points(scene);
  std::vector<GrainSimulation> simulations;
  std::vector<Entry> entries{{"by hand", [&](std::int64_t n) { points.advance(n, dt); }}};
  std::vector<double> bytes{32};
  simulations.reserve(variants.size());
  for (const Variant& variant : variants) {
    if (variant.name != "C" && variant.name != "C, velocity Verlet" && variant.name != "P" && variant.name != "X")
      continue;  // the steps of the others are the same without contacts
    simulations.push_back(start(scene, variant, dt));
    entries.push_back(entry_of(variant.name, simulations.back()));
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  check_alike(simulations[0], points, 1e-9);
  for (const GrainSimulation& simulation : simulations) bytes.push_back(simulation.bytes_per_body());
  return table_beside_hand_loop(entries, seconds, bytes, static_cast<double>(discs * steps)) +
         fmt::format("\nNeighbour lists made in {} steps: {}.\n", simulations[0].step(),
                     simulations[0].counters().rebuilds);
}

std::string compare_friction(int rounds) {
  constexpr double dt = 1e-3;
  constexpr std::int64_t steps = 100;
  constexpr int side = 50;
  PairProperties pair = pair_of(variants[0], 0.7);
  const GrainScene smooth = packed_bed(side, side, pair);
  pair.friction = 0.5;
  pair.tangential_ratio = 0.5;
  FrictionlessDiscs by_hand(smooth, 0.1, dt);
  GrainSimulation without = start(smooth, variants[0], dt), with = start(packed_bed(side, side, pair), variants[0], dt);
  StagedSimulation staged({{.name = "all", .scene = smooth, .steps = std::numeric_limits<std::int64_t>::max()}},
                          {.law = variants[0].law, .time_step = dt});
  const Entry entries[] = {entry_of("by hand, without friction", by_hand), entry_of("C, friction 0", without),
                           entry_of("C, friction 0, as a case of one stage", staged),
                           entry_of("C, friction 0.5 with springs", with)};
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  check_alike(without, by_hand, 1e-6);
  check_alike(staged.present(), by_hand, 1e-6);
  const double bytes[] = {0, without.bytes_per_body(), staged.bytes_per_body(), with.bytes_per_body()};
  return table_beside_hand_loop(entries, seconds, bytes, static_cast<double>(side * side * steps));
}

constexpr const char* introduction = R"(
One thread, processor time; medians (smallest .. largest) of rounds in
which all take turns. Laws: C linear spring and dashpot, T Hertz spring and dashpot, F and P the maps of Fujioka &
Ushijima, X the linear spring and dashpot solved exactly within the step. Dimensionless stiffness a = k dt²/m = 0.1
(T: 4.62) unless stated.

## A step with each law

2500 discs that keep colliding in a box, solid fraction 0.6, e = 1:

)";

void run(Report& report, int rounds, bool only_absent) {
  if (!only_absent) {
    report.begin("Collisions");
    report.add(introduction + compare_laws("gas", rounds));
    report.add("\n2500 discs packed by gravity, e = 0.7, with lasting contacts:\n\n" + compare_laws("bed", rounds));
  }
  report.add(
      "\n## Cost of absent effects\n\nFree flight: 10000 discs that fall and drift without contact, beside `v += g dt; "
      "x += v dt`.\n\n" +
      compare_free_flight(rounds));
  report.add(
      "\nFriction: 2500 discs packed in a box, beside a loop for discs without friction, spin, ledger and search for "
      "neighbours.\n\n" +
      compare_friction(rounds));
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  int rounds = 9;
  bool absent = false;
  return run_benchmark(
      "bench_collisions", "Cost of colliding bodies, law by law, and of absent effects", argc, argv,
      [&](CLI::App& app) {
        declare_rounds(app, rounds);
        app.add_flag("--absent", absent, "the loops by hand alone: cost of absent effects");
      },
      [&](Report& report) { run(report, rounds, absent); });
}
