// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/settling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/material/wave_speed_springs.hpp"

namespace equidem {
namespace {

constexpr double moment_of_disc = 0.5;  // I/(m r²)

bool positive(double value) {
  return value > 0 && std::isfinite(value);
}

void check(const SettlingOptions& options) {
  if (!positive(options.density) || !positive(options.springs.kN) || !positive(options.gravity)) {
    bad_input(
        format("density {} kg/m³, kN {} Pa, gravity {} m/s²", options.density, options.springs.kN, options.gravity),
        "discs that fall need all three", "Give numbers > 0");
  }
  if (!(options.springs.kT >= 0) || !(options.friction >= 0) || !(options.wall_friction >= 0)) {
    bad_input(
        format("kT {} Pa, friction {}, with walls {}", options.springs.kT, options.friction, options.wall_friction),
        "negative ones would feed the motion", "Give 0 or more");
  }
  if (options.springs.kT == 0 && (options.friction > 0 || options.wall_friction > 0)) {
    bad_input("there is friction, but no tangential spring (kT = 0)",
              "friction that only slides trembles and never holds anything at rest", "Give kT > 0, or friction 0");
  }
  if (!(options.damping > 0 && options.damping <= 10)) {
    bad_input(format("the damping is {}", options.damping),
              "without it nothing comes to rest, far above 1 steps become tiny",
              "Give a number above 0, at most 10; 1 is usual");
  }
  if (!(options.rest >= 1e-12 && options.rest < 1) || !positive(options.longest) || !(options.time_step >= 0)) {
    bad_input(format("unbalanced force ratio {}, longest time {} s, time step {} s", options.rest, options.longest,
                     options.time_step),
              "the ratio lies between 1e-12 and 1, times are positive", "Correct it");
  }
}

/// Damping ratios of a contact of two discs: c = 2 h sqrt(m k) (2.27) over 2 sqrt(m' k), m' the mass that the contact moves: m/2
/// along the normal, by 1 + m r²/I smaller along the tangent.
double normal_damping(double damping) {
  return damping * std::numbers::sqrt2;
}
double tangential_damping(double damping) {
  return normal_damping(damping) * std::sqrt(1 + 1 / moment_of_disc);
}

/// A quarter of the limit of one contact: several at a disc lower it, dashpots in proportion to their number.
double chosen_step(const SettlingOptions& options, double lightest) {
  if (options.time_step > 0) return options.time_step;
  const double mass = 0.5 * lightest;
  const auto limit = [](double stiffness, double moved, double damping) {
    return semi_implicit_limit(damping) / std::sqrt(stiffness / moved);
  };
  double step = limit(options.springs.kN, mass, normal_damping(options.damping));
  if (options.springs.kT > 0) {
    step =
        std::min(step, limit(options.springs.kT, mass / (1 + 1 / moment_of_disc), tangential_damping(options.damping)));
  }
  return 0.25 * step;
}

double mean_mass(std::span<const Grain> grains) {
  double mass = 0;
  for (const Grain& grain : grains) mass += grain.inertia.mass;
  return mass / static_cast<double>(grains.size());
}

void stop_all(GrainSimulation& simulation) {
  GrainState state = simulation.save();
  for (Grain& grain : state.grains) {
    grain.velocity = {};
    grain.spin = 0;
  }
  simulation.restore(state);
}

}  // namespace

std::vector<GrainWall> walls_of_box(double width) {
  const auto wall = [](const char* name, Vec2 point, Vec2 normal) {
    GrainWall made;
    made.name = name;
    made.point = point;
    made.normal = normal;
    made.kind = 1;
    return made;
  };
  return {wall("floor", {0, 0}, {0, 1}), wall("left", {0, 0}, {1, 0}), wall("right", {width, 0}, {-1, 0})};
}

GrainScene scene_of(std::span<const Vec2> centres, std::span<const double> radii, double width,
                    const SettlingOptions& options) {
  GrainScene scene;
  for (std::size_t k = 0; k < centres.size(); ++k) {
    Grain grain;
    grain.position = centres[k];
    grain.radius = radii[k];
    grain.inertia = inertia_of(radii[k], options.density, Body::disc);
    scene.grains.push_back(grain);
  }
  scene.walls = walls_of_box(width);
  scene.gravity = {0, -options.gravity};
  scene.kinds = 2;
  // At a wall the mass that the contact moves is that of the disc.
  const auto pair = [&](double share, double friction) {
    PairProperties made;
    made.stiffness = options.springs.kN;
    made.restitution =
        restitution_of(normal_damping(options.damping) * std::sqrt(0.5 / share), ContactEnd::at_zero_force);
    made.friction = friction;
    if (friction > 0 && options.springs.kT > 0) {
      made.tangential_ratio = options.springs.ratio();
      made.tangential_damping = tangential_damping(options.damping) * std::sqrt(0.5 / share);
    }
    return made;
  };
  const PairProperties discs = pair(0.5, options.friction), walls = pair(1, options.wall_friction);
  scene.pairs = {discs, walls, walls, walls};
  return scene;
}

SettlingReport unbalance(std::span<const Grain> grains, std::span<const GrainContact> contacts, Vec2 gravity) {
  std::vector<Vec2> forces(grains.size());
  for (std::size_t k = 0; k < grains.size(); ++k) forces[k] = grains[k].inertia.mass * gravity;
  double carried = 0;
  for (const GrainContact& contact : contacts) {
    const Vec2 on_j = contact.normal_force * contact.normal + contact.tangential_force * perpendicular(contact.normal);
    forces[static_cast<std::size_t>(contact.i)] -= on_j;
    if (contact.j >= 0) forces[static_cast<std::size_t>(contact.j)] += on_j;
    carried += norm(on_j);
  }
  SettlingReport report;
  double sum = 0, largest = 0;
  for (const Vec2 force : forces) {
    sum += norm(force);
    largest = std::max(largest, norm(force));
  }
  const double mean = contacts.empty() ? 0 : carried / static_cast<double>(contacts.size());
  report.unbalanced = mean > 0 ? sum / static_cast<double>(grains.size()) / mean : INFINITY;
  report.largest_unbalanced = mean > 0 ? largest / mean : INFINITY;
  return report;
}

SettledDiscs settle(std::span<const Vec2> centres, std::span<const double> radii, double width,
                    const SettlingOptions& options) {
  check(options);
  const GrainScene scene = scene_of(centres, radii, width, options);
  double lightest = INFINITY;
  for (const Grain& grain : scene.grains) lightest = std::min(lightest, grain.inertia.mass);
  const double step = chosen_step(options, lightest);
  // Friction of the midpoint rule creeps under a steady force; that of velocity_verlet comes to rest.
  GrainSimulation simulation(scene, {.law = NormalLaw::linear_dashpot,
                                     .scheme = GrainOptions::Scheme::velocity_verlet,
                                     .time_step = step,
                                     .reference_length = 0,
                                     .margin = 0});

  // What is left of the motion once the discs lie: they swing in the slowest modes, which contacts hardly damp. Where the kinetic
  // energy has fallen to half a peak all of them are stopped, and the springs find them nearer to rest. Discs that can
  // still drop by more than this share of their radius are left to fall.
  constexpr double lying_drop = 1e-4, resting_drop = 1e-9;
  const double weight_radius = static_cast<double>(scene.grains.size()) * mean_mass(scene.grains) * options.gravity *
                               *std::min_element(radii.begin(), radii.end());
  constexpr std::int64_t block = 100;
  const double steps = std::ceil(options.longest / step);
  Progress progress("settling");
  double peak = 0;
  while (static_cast<double>(simulation.step()) < steps) {
    simulation.advance(block);
    const double kinetic = simulation.energy().kinetic;
    progress.update(std::min(static_cast<double>(simulation.step()) / steps, 1.0));
    peak = std::max(peak, kinetic);
    if (kinetic <= resting_drop * weight_radius) {
      const auto grains = simulation.grains();
      const auto contacts = simulation.contacts();
      SettlingReport report = unbalance(grains, contacts, scene.gravity);
      if (report.unbalanced <= options.rest) {
        report.time_step = step;
        report.time = simulation.time();
        report.steps = simulation.step();
        report.ledger = simulation.energy();
        return {grains, contacts, report};
      }
    }
    if (kinetic < lying_drop * weight_radius && kinetic < 0.5 * peak) {
      stop_all(simulation);
      peak = 0;
    }
  }
  const SettlingReport report = unbalance(simulation.grains(), simulation.contacts(), scene.gravity);
  computation_failed(format("after {:.4g} s the discs are not at rest", simulation.time()),
                     format("the mean unbalanced force is {:.2g} of the mean contact force, {:.2g} was wanted",
                            report.unbalanced, options.rest),
                     "Give them longer, more friction or damping, or take a shorter step");
}

}  // namespace equidem
