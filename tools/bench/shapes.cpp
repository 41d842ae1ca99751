// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cost of a contact of ellipses or clumps beside one of discs: bench_shapes --help.
#include <cmath>
#include <numbers>

#include <CLI/CLI.hpp>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

#include "bench.hpp"
#include "text_table.hpp"

namespace equidem::bench {
namespace {

using EllipseLaw = GrainOptions::EllipseLaw;
using GrainIntegrator = GrainOptions::Integrator;

constexpr double stiffness = 1e5;
constexpr double pair_radius = 0.5 / std::numbers::sqrt2;  // of each disc of a pair
constexpr std::int64_t steps = 500;

/// A body with the area of a disc of the radius 0.5 m.
struct Shape {
  std::string label;
  double aspect = 1;  ///< 0: disc; < 0: pair of discs; else long over short half-axis
  EllipseLaw law = EllipseLaw::exact;
  bool bonded = false;  ///< a pair bonded by dashpots, two grains
  GrainIntegrator integrator = GrainIntegrator::semi_implicit_euler;
};

/// Each integrator begins with the disc.
std::vector<Shape> shapes() {
  std::vector<Shape> all{{"disc", 0},
                         {"disc in the loop of shapes", 1},
                         {"ellipse, aspect 1.2", 1.2},
                         {"ellipse, aspect 2", 2},
                         {"ellipse, aspect 5", 5},
                         {"ellipse, aspect 20", 20},
                         {"ellipse, aspect 2, enlarged", 2, EllipseLaw::enlarged},
                         {"rigid pair of discs", -1}};
  for (const GrainIntegrator integrator : {GrainIntegrator::semi_implicit_euler, GrainIntegrator::velocity_verlet}) {
    if (integrator != GrainIntegrator::semi_implicit_euler)
      all.push_back({"disc", 0, EllipseLaw::exact, false, integrator});
    all.push_back({"bonded pair of discs", -1, EllipseLaw::exact, true, integrator});
  }
  return all;
}

double step_of(const Grain& grain) {
  return 0.1 * std::sqrt(grain.inertia.mass / stiffness);
}

/// Grains on a wide grid at random angles, over a floor between two walls; the contact properties are those of sand.
GrainScene grains_to_fall(const Shape& shape, int side) {
  const double half = shape.aspect < 0 ? pair_radius : 0.5;
  GrainScene scene;
  Grain grain{.position = {}, .radius = half, .inertia = inertia_of(half, 1, Body::disc)};
  if (shape.aspect > 0) {
    grain.radius = 0.5 * std::sqrt(shape.aspect);
    grain.short_half_axis = 0.5 / std::sqrt(shape.aspect);
    grain.inertia = inertia_of_ellipse(grain.radius, grain.short_half_axis, 1);
  } else if (shape.aspect < 0 && !shape.bonded) {
    scene.clumps = {centred_clump({{{-half, 0}, half}, {{half, 0}, half}})};
    grain.clump = 0;
    grain.radius = radius_of(scene.clumps[0]);
    grain.inertia = inertia_of_clump(scene.clumps[0], 1);
  }
  Random random(1);
  const double spacing = 2.05 * (shape.bonded ? 2 * pair_radius : grain.radius);
  for (int k = 0; k < side * side; ++k) {
    grain.position = {(k % side + 0.5) * spacing, (std::floor(k / side) + 0.5) * spacing};
    grain.velocity = {random.uniform(-0.3, 0.3), 0};
    grain.angle = random.uniform(0, 2 * std::numbers::pi);
    scene.grains.push_back(grain);
    if (!shape.bonded) continue;
    const Vec2 arm = pair_radius * Vec2{std::cos(grain.angle), std::sin(grain.angle)};
    scene.grains.back().position -= arm;
    grain.position += arm;
    scene.grains.push_back(grain);
    // Explicit dashpots are stable up to twice this step; C_s is C_n times the ratio of the masses that they move.
    const double dashpot = 0.5 * grain.inertia.mass / step_of(grain);
    const std::size_t j = scene.grains.size() - 1;
    scene.bonds.push_back({.i = j - 1, .j = j, .normal_dashpot = dashpot, .tangential_dashpot = dashpot / 3});
  }
  scene.gravity = {0, -1};
  scene.walls = box_walls(side * spacing);
  scene.pairs = {{.stiffness = stiffness,
                  .restitution = 0.3,
                  .friction = 0.17,
                  .tangential_ratio = 1.0 / 3,
                  .tangential_damping = 0.2}};
  return scene;
}

GrainSimulation settled(const Shape& shape, int side) {
  const GrainScene scene = grains_to_fall(shape, side);
  const GrainOptions options{.law = NormalLaw::linear_dashpot,
                             .integrator = shape.integrator,
                             .time_step = step_of(scene.grains[0]),
                             .ellipse_law = shape.law};
  GrainSimulation simulation(scene, options);
  const double height = side * 2 * scene.grains[0].radius * (shape.bonded ? 2 : 1);
  simulation.advance(static_cast<std::int64_t>(3 * std::sqrt(height) / options.time_step));
  return simulation;
}

constexpr const char* introduction = R"(
{} grains of equal area that have fallen into a box under gravity, with
friction, tangential springs and dashpots; the law linear_dashpot. One thread, processor time; medians (smallest ..
largest) of rounds in which all take turns. A step contains contacts, near pairs without contact, motion and neighbour
lists. Contacts are those with overlap; "over a disc" compares with the disc of the same integrator. Discs, round parts
and ellipses are computed by loops over eight pairs at once, the enlarged ellipse contact by contact. A bonded pair
counts as one grain: two discs and the dashpots between them.

)";

void run(Report& report, int side, int rounds) {
  const std::vector<Shape> all = shapes();
  std::vector<GrainSimulation> simulations;
  std::vector<Entry> entries;
  std::vector<std::int64_t> evaluations;
  for (const Shape& shape : all) simulations.push_back(settled(shape, side));
  for (std::size_t k = 0; k < all.size(); ++k) {
    entries.push_back({all[k].label, [&simulations, k](std::int64_t n) { simulations[k].advance(n); }});
    evaluations.push_back(simulations[k].counters().evaluations);
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  const double grains = side * side, grain_steps = grains * static_cast<double>(steps);
  TextTable table(
      "shape & integrator & contacts per grain & ns per grain and step & over a disc & ns per contact & over a disc "
      "contact "
      "& bytes per grain");
  std::size_t disc = 0;
  double contacts_of_disc = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto made = static_cast<double>(simulations[k].counters().evaluations - evaluations[k]);
    const double contacts = made / (grain_steps * (rounds + 1));
    if (all[k].aspect == 0) disc = k, contacts_of_disc = contacts;
    const Range each = range_of(seconds[k]) * (1e9 / grain_steps), over_disc = ratio_of(seconds[k], seconds[disc]);
    table.add("{} & {} & {:.2f} & {} & {} & {} & {} & {:.0f}", all[k].label, to_string(all[k].integrator), contacts,
              each.text("{:.0f}"), over_disc.text("{:.2f}"), (each * (1 / contacts)).text("{:.0f}"),
              (over_disc * (contacts_of_disc / contacts)).text("{:.2f}"),
              simulations[k].bytes_per_body() * (all[k].bonded ? 2 : 1));
  }
  report.begin("Shapes");
  report.add(fmt::format(introduction, side * side) + table.markdown());
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  int side = 32, rounds = 7;
  return run_benchmark(
      "bench_shapes", "Cost of a contact of ellipses or clumps beside one of discs", argc, argv,
      [&](CLI::App& app) {
        app.add_option("--side", side, "grains in a row, and rows")->check(CLI::Range(4, 1000))->capture_default_str();
        app.add_option("--rounds", rounds, "in which all take turns")
            ->check(CLI::Range(1, 1000))
            ->capture_default_str();
      },
      [&](Report& report) { run(report, side, rounds); });
}
