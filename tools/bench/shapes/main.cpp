// SPDX-License-Identifier: GPL-3.0-or-later
// What a contact of ellipses or clumps costs beside one of discs: bench_shapes --help.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/clump.hpp"
#include "equidem/output/files/json.hpp"

#include "contender.hpp"

namespace equidem::bench {
namespace {

constexpr double contact_stiffness = 1e5;
constexpr double pair_radius = 0.5 / std::numbers::sqrt2;  ///< of each disc of a pair

struct Request {
  int side = 32, rounds = 7;
  std::string file;
};

/// All of the area of a disc of the radius 0.5 m.
struct Shape {
  std::string label;
  double aspect = 1;  ///< 0: disc, < 0: pair of discs, else the long half-axis over the short one
  GrainOptions::EllipseLaw law = GrainOptions::EllipseLaw::exact;
  bool bonded = false;  ///< a pair that dashpots tie, two grains
  GrainOptions::BondStep bond_step = GrainOptions::BondStep::exact;
  GrainOptions::Scheme scheme = GrainOptions::Scheme::semi_implicit_euler;
};

/// Each scheme begins with the disc.
std::vector<Shape> shapes() {
  using Law = GrainOptions::EllipseLaw;
  using Bond = GrainOptions::BondStep;
  using Scheme = GrainOptions::Scheme;
  return {{"disc", 0},
          {"disc in the loop of shapes", 1},
          {"ellipse, aspect 1.2", 1.2},
          {"ellipse, aspect 2", 2},
          {"ellipse, aspect 5", 5},
          {"ellipse, aspect 20", 20},
          {"ellipse, aspect 2, enlarged, mended", 2, Law::enlarged_mended},
          {"rigid pair of discs", -1},
          {"bonded pair of discs", -1, Law::exact, true},
          {"bonded pair of discs, explicit", -1, Law::exact, true, Bond::explicit_euler},
          {"disc", 0, Law::exact, false, Bond::exact, Scheme::velocity_verlet},
          {"bonded pair of discs", -1, Law::exact, true, Bond::exact, Scheme::velocity_verlet},
          {"bonded pair of discs, explicit", -1, Law::exact, true, Bond::explicit_euler, Scheme::velocity_verlet},
          {"disc", 0, Law::exact, false, Bond::exact, Scheme::corrected_verlet},
          {"bonded pair of discs", -1, Law::exact, true, Bond::exact, Scheme::corrected_verlet},
          {"bonded pair of discs, explicit", -1, Law::exact, true, Bond::explicit_euler, Scheme::corrected_verlet}};
}

Wall line(const char* name, Vec2 point, Vec2 normal) {
  Wall wall;
  wall.name = name;
  wall.point = point;
  wall.normal = normal;
  return wall;
}

/// The step is half the limit of these dashpots where they are explicit; C_s in the ratio of the masses that they move.
GrainBond dashpots_between(std::size_t i, std::size_t j, const Grain& disc, double step) {
  GrainBond bond{.i = i, .j = j};
  bond.normal_dashpot = 0.5 * disc.inertia.mass / step;
  bond.tangential_dashpot = bond.normal_dashpot / 3;
  return bond;
}

double step_of(const Grain& grain) {
  return 0.1 * std::sqrt(grain.inertia.mass / contact_stiffness);
}

/// Grains on a wide grid, turned at random, over a floor between two walls; the contact properties are those of sand.
GrainScene grains_to_fall(const Shape& shape, int side) {
  GrainScene scene;
  Grain grain;
  grain.radius = 0.5;
  grain.inertia = inertia_of(0.5, 1, Body::disc);
  if (shape.aspect > 0) {
    grain.radius = 0.5 * std::sqrt(shape.aspect);
    grain.short_half_axis = 0.5 / std::sqrt(shape.aspect);
    grain.inertia = inertia_of_ellipse(grain.radius, grain.short_half_axis, 1);
  } else if (shape.bonded) {
    grain.radius = pair_radius;
    grain.inertia = inertia_of(pair_radius, 1, Body::disc);
  } else if (shape.aspect < 0) {
    const double radius = pair_radius;
    scene.clumps = {centred_clump({{{-radius, 0}, radius}, {{radius, 0}, radius}})};
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
    const std::size_t j = scene.grains.size() - 1;
    scene.bonds.push_back(dashpots_between(j - 1, j, grain, step_of(grain)));
  }
  scene.gravity = {0, -1};
  scene.walls = {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}),
                 line("right", {side * spacing, 0}, {-1, 0})};
  PairProperties pair;
  pair.stiffness = contact_stiffness;
  pair.restitution = 0.3;
  pair.friction = 0.17;
  pair.tangential_ratio = 1.0 / 3;
  pair.tangential_damping = 0.2;
  scene.pairs = {pair};
  return scene;
}

GrainSimulation settled(const Shape& shape, int side) {
  GrainOptions options;
  options.law = NormalLaw::linear_dashpot;
  options.ellipse_law = shape.law;
  const GrainScene scene = grains_to_fall(shape, side);
  options.bond_step = shape.bond_step;
  options.scheme = shape.scheme;
  options.time_step = step_of(scene.grains[0]);
  GrainSimulation simulation(scene, options);
  const double height = side * 2 * scene.grains[0].radius * (shape.bonded ? 2 : 1);
  simulation.advance(static_cast<std::int64_t>(3 * std::sqrt(height) / options.time_step));
  return simulation;
}

const char* name_of(GrainOptions::Scheme scheme) {
  if (scheme == GrainOptions::Scheme::semi_implicit_euler) return "semi_implicit_euler";
  return scheme == GrainOptions::Scheme::velocity_verlet ? "velocity_verlet" : "corrected_verlet";
}

std::string text(const Range& range, const char* digits) {
  const auto one = [&](double value) { return fmt::format(fmt::runtime(digits), value); };
  return one(range.median) + " (" + one(range.smallest) + " .. " + one(range.largest) + ")";
}

constexpr const char* introduction = R"(# Shapes

equidem {0}, compiler {1}, `bench_shapes --side {2} --rounds {3}`. {4} grains of equal area that have fallen into a box
under gravity, with friction, tangential springs and dashpots; the law linear_dashpot. One thread, processor time;
medians (smallest .. largest) of {3} rounds in which all take turns. Everything that a step does is counted: contacts,
grains that are near but apart, motion, lists. A contact is one that touches; a disc is that of the same scheme. Discs,
round parts and ellipses go through loops over eight pairs at once, the enlarged ellipse contact by contact. A bonded
pair counts as one grain: two discs and the dashpots between them.

| shape | scheme | contacts per grain | ns per grain and step | over a disc | ns per contact)"
                                     R"( | over a disc contact | bytes per grain |
|---|---|---|---|---|---|---|---|
)";

void run(const Request& request) {
  std::vector<GrainSimulation> simulations;
  std::vector<Entry> entries;
  for (const Shape& shape : shapes()) simulations.push_back(settled(shape, request.side));
  std::vector<std::int64_t> evaluations;
  for (std::size_t k = 0; k < simulations.size(); ++k) {
    entries.push_back({shapes()[k].label, [&simulations, k](std::int64_t steps) { simulations[k].advance(steps); }});
    evaluations.push_back(simulations[k].counters().evaluations);
  }
  constexpr std::int64_t steps = 500;
  const std::vector<Seconds> seconds = take_turns(entries, steps, request.rounds);
  const double grains = request.side * request.side;
  std::string report = fmt::format(introduction, library_version(), __VERSION__, request.side, request.rounds,
                                   request.side * request.side);
  std::vector<double> contacts;
  for (std::size_t k = 0; k < simulations.size(); ++k) {
    const auto made = static_cast<double>(simulations[k].counters().evaluations - evaluations[k]);
    contacts.push_back(made / (static_cast<double>(steps) * (request.rounds + 1) * grains));
  }
  const auto scaled = [](Range range, double scale) {
    return Range{range.median * scale, range.smallest * scale, range.largest * scale};
  };
  std::size_t disc = 0;
  for (std::size_t k = 0; k < simulations.size(); ++k) {
    if (shapes()[k].aspect == 0) disc = k;
    const Range each = scaled(range_of(seconds[k]), 1e9 / (static_cast<double>(steps) * grains));
    const Range over_disc = ratio_of(seconds[k], seconds[disc]);
    const Range over = scaled(over_disc, contacts[disc] / contacts[k]);
    report += fmt::format("| {} | {} | {:.2f} | {} | {} | {} | {} | {:.0f} |\n", entries[k].label,
                          name_of(shapes()[k].scheme), contacts[k], text(each, "{:.0f}"), text(over_disc, "{:.2f}"),
                          text(scaled(each, 1 / contacts[k]), "{:.0f}"), text(over, "{:.2f}"),
                          simulations[k].bytes_per_body() * (shapes()[k].bonded ? 2 : 1));
  }
  std::printf("%s", report.c_str());
  if (request.file.empty()) return;
  std::ofstream out(request.file);
  out << report;
  if (!out.flush()) bad_input(fmt::format("'{}' cannot be written", request.file), "", "Choose another path");
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem;
  bench::Request request;
  CLI::App app("What a contact of ellipses or clumps costs beside one of discs");
  app.add_option("--side", request.side, "grains in a row, and rows")
      ->check(CLI::Range(4, 1000))
      ->capture_default_str();
  app.add_option("--rounds", request.rounds, "in which all take turns")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--markdown", request.file, "file for the table");
  CLI11_PARSE(app, argc, argv);
  try {
    bench::run(request);
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_shapes: %s\n", error.what());
    return error.exit_code();
  }
  return 0;
}
