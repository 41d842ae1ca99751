// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/settling.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {
namespace {

constexpr double moment_of_disc = 0.5;  // I/(m r²)

void check(const SettlingOptions& options) {
  using O = SettlingOptions;
  constexpr Bound<O> bounds[] = {{"density", &O::density, Range::positive(), "kg/m³"},
                                 {"damping", &O::damping, Range::above_zero_to(10)},
                                 {"gravity", &O::gravity, Range::positive(), "m/s²"},
                                 {"friction", &O::friction, Range::not_negative()},
                                 {"wall_friction", &O::wall_friction, Range::not_negative()},
                                 {"time_step", &O::time_step, Range::not_negative(), "s"},
                                 {"rest", &O::rest, {.low = 1e-12, .high = 1, .high_open = true}},
                                 {"longest", &O::longest, Range::positive(), "s"}};
  constexpr Bound<SpringConstants> spring_bounds[] = {{"kN", &SpringConstants::kN, Range::positive(), "Pa"},
                                                      {"kT", &SpringConstants::kT, Range::not_negative(), "Pa"}};
  const auto owner = [] { return " of the settling"; };
  check_bounds(options, bounds, owner);
  check_bounds(options.springs, spring_bounds, owner);
  if (options.springs.kT == 0 && (options.friction > 0 || options.wall_friction > 0)) {
    bad_input("there is friction, but no tangential spring (kT = 0)",
              "friction without a spring never holds anything at rest", "Give kT > 0, or friction 0");
  }
}

void tie(GrainScene& scene, double share, double step) {
  for (GrainBond& bond : scene.bonds) {
    const double mass = 0.5 * scene.grains[bond.i].inertia.mass;
    bond.normal_dashpot = share * 2 * mass / step;
    bond.tangential_dashpot = bond.normal_dashpot / (1 + 1 / moment_of_disc);
  }
}

/// Friction of the midpoint rule creeps under a steady force; that of the Verlet schemes comes to rest.
GrainSimulation simulation_of(const GrainScene& scene, double step) {
  return {scene,
          {.law = NormalLaw::linear_dashpot,
           .integrator = GrainOptions::Integrator::velocity_verlet,
           .time_step = step,
           .reference_length = 0,
           .margin = 0}};
}

/// Twice the time of the free fall from the highest body: what is left after the fall is measured to take half as long
/// to as long again as the fall.
double time_to_rest(const GrainScene& scene, const SettlingOptions& options) {
  double highest = 0;
  for (const Grain& grain : scene.grains) highest = std::max(highest, grain.position.y);
  return std::min(options.longest, 2 * std::sqrt(2 * highest / options.gravity));
}

}  // namespace

double contact_step_limit(const GrainScene& scene, const SettlingOptions& options) {
  // Smallest masses that a contact of two equal bodies moves along its normal and tangent.
  double normal = INFINITY, tangential = INFINITY, mass = INFINITY;
  for (const Grain& grain : scene.grains) {
    const Inertia& body = grain.inertia;
    const auto moved = [&](double lever) { return 0.5 / (1 / body.mass + lever * lever / body.moment); };
    mass = std::min(mass, body.mass);
    normal = std::min(normal, moved(longest_lever(outline_of(grain, scene.clumps))));
    tangential = std::min(tangential, moved(grain.radius));
  }
  const auto limit = [&](double stiffness, double moved_mass) {
    return semi_implicit_limit(options.damping * std::sqrt(mass / moved_mass)) / std::sqrt(stiffness / moved_mass);
  };
  double step = limit(options.springs.kN, normal);
  if (options.springs.kT > 0) step = std::min(step, limit(options.springs.kT, tangential));
  return step;
}

double settling_step(const GrainScene& scene, const SettlingOptions& options) {
  return options.time_step > 0 ? options.time_step : 0.25 * contact_step_limit(scene, options);
}

std::vector<Wall> walls_of_box(double width) {
  const auto wall = [](const char* name, Vec2 point, Vec2 normal) {
    return Wall{.name = name, .point = point, .normal = normal, .kind = 1};
  };
  return {wall("floor", {0, 0}, {0, 1}), wall("left", {0, 0}, {1, 0}), wall("right", {width, 0}, {-1, 0})};
}

GrainScene scene_of_box(double width, const SettlingOptions& options) {
  GrainScene scene;
  scene.walls = walls_of_box(width);
  scene.gravity = {0, -options.gravity};
  scene.kinds = 2;
  const auto pair = [&](bool on_wall, double friction) {
    return contact_of({.stiffness = SpringStiffness{options.springs.kN},
                       .rebound = DashpotDamping{options.damping},
                       .friction = friction,
                       .tangential_ratio = options.springs.ratio()},
                      NormalLaw::linear_dashpot, {.on_wall = on_wall})
        .properties;
  };
  const PairProperties bodies = pair(false, options.friction), walls = pair(true, options.wall_friction);
  scene.pairs = {bodies, walls, walls, walls};
  return scene;
}

namespace {

/// The grains of a scene of a box move under gravity until all are at rest, or until that fails: where no rest comes in
/// `longest`, as GrainSimulation, or interrupted. Bonds get their dashpots.
/// \throws Error (bad_input) on options out of range
void settle(GrainScene scene, const SettlingOptions& options, GrainPacking& packing) {
  check(options);
  const double step = settling_step(scene, options);
  tie(scene, options.bond_share, step);
  GrainSimulation simulation = simulation_of(scene, step);

  // Once the bodies lie, they still swing in the slowest modes, which contacts hardly damp. Where
  // the kinetic energy has fallen to half a peak all of them are stopped, and the springs find them nearer to rest.
  // Bodies that can still drop by more than this share of their radius are left to fall; bonded pairs creep as long as
  // they carry.
  constexpr double lying_drop = 1e-4;
  const double resting_drop = scene.bonds.empty() ? 1e-9 : 1e-5;
  double smallest = INFINITY, mass = 0;
  for (const Grain& grain : scene.grains) {
    smallest = std::min(smallest, grain.radius);
    mass += grain.inertia.mass;
  }
  const double weight_radius = mass * options.gravity * smallest;
  constexpr std::int64_t block = 100;
  const double steps = std::ceil(options.longest / step);
  const double expected = std::ceil(time_to_rest(scene, options) / step);
  Progress progress(fmt::format("settling, about {:.2g} steps", expected));
  const auto keep = [&](const Unbalance& unbalance) {
    packing.work += simulation.step();
    packing.grains = simulation.grains();
    packing.contacts = simulation.contacts();
    packing.bonds = scene.bonds;
    packing.settling = {.unbalanced = unbalance.mean,
                        .largest_unbalanced = unbalance.largest,
                        .time_step = step,
                        .time = simulation.time(),
                        .steps = simulation.step(),
                        .ledger = simulation.energy()};
  };
  double peak = 0;
  std::optional<Error> failure;
  while (!failure && static_cast<double>(simulation.step()) < steps) {
    constexpr double nearly_done = 0.99;  // rest may take longer than expected
    try {
      simulation.advance(block);
      progress.update(std::min(static_cast<double>(simulation.step()) / expected, nearly_done));
    } catch (const Error& error) {
      failure = error;
    }
    const double kinetic = simulation.energy().kinetic;
    peak = std::max(peak, kinetic);
    if (kinetic <= resting_drop * weight_radius) {
      const Unbalance unbalance = unbalance_of(simulation, scene.bonds, scene.gravity);
      if (unbalance.mean <= options.rest) return keep(unbalance);
    }
    if (kinetic < lying_drop * weight_radius && kinetic < 0.5 * peak) {
      simulation.stop_all();
      peak = 0;
    }
  }
  const Unbalance unbalance = unbalance_of(simulation, scene.bonds, scene.gravity);
  keep(unbalance);
  if (!failure)
    failure.emplace(ErrorKind::computation_failed,
                    fmt::format("after {:.4g} s the bodies are not at rest", simulation.time()),
                    fmt::format("the mean unbalanced force is {:.2g} of the mean contact force, {:.2g} was wanted",
                                unbalance.mean, options.rest),
                    scene.bonds.empty() ? "Give them longer, more friction or damping, or take a shorter step"
                                        : "Let the bonds creep less (a larger bond_share), or give them longer");
  keep_failure(packing, [&] { throw *failure; });
}

/// Staggered rows, wide enough for the circle round the largest body; each shifted at random within its room.
std::vector<Vec2> staggered_grid(std::span<const double> radii, double width, Random& random) {
  const double largest = *std::max_element(radii.begin(), radii.end());
  constexpr double room = 1.1;
  const double wanted = 2 * room * largest;
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>((width - wanted / 2) / wanted));
  // Rows are shifted by half a spacing to and fro.
  const bool stagger = width >= 1.5 * wanted;
  const double spacing = width / (static_cast<double>(columns) + (stagger ? 0.5 : 0));
  std::vector<Vec2> places;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const std::size_t row = k / columns, column = k % columns;
    const double shift = stagger && row % 2 == 1 ? 1.0 : 0.5;
    const double slack = wanted / 2 - radii[k];
    const double dx = random.uniform(-slack, slack);
    places.push_back({(static_cast<double>(column) + shift) * spacing + dx,
                      (static_cast<double>(row) + 0.5) * wanted + random.uniform(-slack, slack)});
  }
  return places;
}

Bodies bodies_above(const PackingOptions& options, const UnitBody& shape) {
  Random random(options.seed);
  std::vector<double> reaches;
  for (const double radius : options.radii) reaches.push_back(shape.reach * radius);
  Bodies bodies{staggered_grid(reaches, options.box.size.x, random), options.radii, {}};
  if (!options.shape.is_disc())
    for (std::size_t k = 0; k < bodies.size(); ++k) bodies.turns.push_back(random.uniform());
  return bodies;
}

}  // namespace

void fill_by_falling(const PackingOptions& options, GrainPacking& packing) {
  make_grains(options.shape, bodies_above(options, unit_body_of(options.shape)), options.settling.density, packing);
  GrainScene scene = scene_of_box(options.box.size.x, options.settling);
  scene.grains = packing.grains;
  scene.clumps = packing.clumps;
  scene.bonds = packing.bonds;
  settle(std::move(scene), options.settling, packing);
  double top = 0;
  for (const Grain& grain : packing.grains)
    top = std::max(top, grain.position.y + reach_along(outline_of(grain, packing.clumps), {0, 1}));
  packing.box.size.y = top;
}

}  // namespace equidem
