// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/engine_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/assembly/touching.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/loop_choice.hpp"
#include "equidem/grains/scene/pair_options.hpp"

namespace equidem {
namespace {

using enum EngineFeature;

constexpr std::size_t most_points_of_schedule = 50;  // each is a term of a formula

void add(FoundFeatures& found, EngineFeature feature, const std::string& instance) {
  found.emplace(feature, instance);
}

/// Whether contact points lie at (d + r_i - r_j)/2 from i.
bool places_contact_points(const std::vector<double>& radii, const Assembly& assembly) {
  return std::ranges::all_of(assembly.contacts, [&](const Contact& c) {
    const double distance = norm(assembly.branch(c));
    const double lever = 0.5 * (distance + radii[c.i] - radii[c.j]);
    return std::abs(lever - c.lever_i) <= lever_tolerance * distance;
  });
}

/// r_j = r_i + lever_j - lever_i from contact to contact, the mean over each connected part that of the discs.
std::vector<double> radii_of_levers(const Assembly& assembly) {
  if (places_contact_points(assembly.radii, assembly)) return assembly.radii;
  std::vector<std::vector<std::pair<std::int32_t, double>>> steps(assembly.size());
  for (const Contact& c : assembly.contacts) {
    const double rise =
        std::abs(c.lever_j - c.lever_i) <= lever_tolerance * (c.lever_i + c.lever_j) ? 0 : c.lever_j - c.lever_i;
    steps[c.i].emplace_back(c.j, rise);
    steps[c.j].emplace_back(c.i, -rise);
  }
  std::vector<double> radii(assembly.size(), 0);
  std::vector<char> reached(assembly.size(), 0);
  for (std::size_t first = 0; first < assembly.size(); ++first) {
    if (reached[first]) continue;
    std::vector<std::int32_t> part{static_cast<std::int32_t>(first)};
    reached[first] = 1;
    double shift = assembly.radii[first];
    for (std::size_t k = 0; k < part.size(); ++k) {
      for (const auto& [other, rise] : steps[part[k]]) {
        if (reached[other]) continue;
        reached[other] = 1;
        radii[other] = radii[part[k]] + rise;
        shift += assembly.radii[other] - radii[other];
        part.push_back(other);
      }
    }
    for (const std::int32_t disc : part) radii[disc] += shift / static_cast<double>(part.size());
  }
  const bool possible = std::ranges::all_of(radii, [](double radius) { return radius > 0; });
  return possible && places_contact_points(radii, assembly) ? radii : std::vector<double>{};
}

void find_features_of_contacts(const Scene& scene, FoundFeatures& found) {
  const Assembly& assembly = scene.assembly;
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  double longest = 0;
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    const std::string name = fmt::format("contact {} of discs {} and {}", k, c.i, c.j);
    const double distance = norm(assembly.branch(c));
    longest = std::max(longest, distance);
    pairs.emplace_back(std::minmax(c.i, c.j));
    if (std::abs(c.lever_i + c.lever_j - distance) > lever_tolerance * distance) add(found, levers_with_gaps, name);
    if (std::abs(c.lever_i - 0.5 * distance) > lever_tolerance * distance) add(found, levers_by_radii, name);
    if (scene.springs[k].kT < 0) add(found, negative_tangential, name);
    if (scene.springs.bending(k) > 0) add(found, bending_bonds, name);
    if (scene.springs[k].kN != scene.springs[0].kN || scene.springs[k].kT != scene.springs[0].kT)
      add(found, unequal_springs, name);
  }
  std::ranges::sort(pairs);
  if (const auto twice = std::ranges::adjacent_find(pairs); twice != pairs.end())
    add(found, double_contacts, fmt::format("discs {} and {}", twice->first, twice->second));
  if (!assembly.periodic()) return;
  add(found, periodic_cell, "");
  if (std::min(assembly.period->x, assembly.period->y) <= 2 * longest) add(found, small_cell, "");
}

void find_features_of_inertia(EngineModel& model) {
  if (model.lever_radii.empty()) return;
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Inertia& inertia = model.bodies[k].inertia;
    const double expected = 0.5 * inertia.mass * squared(model.lever_radii[k]);
    if (std::abs(inertia.moment - expected) <= lever_tolerance * expected) continue;
    add(model.found, other_inertia, fmt::format("disc {}", k));
    return;
  }
}

/// The gap of bonds, by the radii that place their contact points, beyond which PFC is to bond nothing: that of the
/// longest. Another pair with a smaller gap would be bonded too.
void find_largest_gap(EngineModel& model) {
  if (model.lever_radii.empty() || model.period) return;
  std::vector<std::pair<std::int32_t, std::int32_t>> bonded;
  for (const EngineBond& bond : model.bonds) {
    bonded.emplace_back(std::minmax(bond.i, bond.j));
    model.largest_gap =
        std::max(model.largest_gap, bond.length - model.lever_radii[bond.i] - model.lever_radii[bond.j]);
  }
  std::ranges::sort(bonded);
  model.largest_gap += lever_tolerance * *std::ranges::max_element(model.lever_radii);
  Assembly near;
  near.radii = model.lever_radii;
  for (const EngineBody& body : model.bodies) near.centres.push_back(body.position);
  const double tolerance = std::max(0.0, model.largest_gap) / (2 * *std::ranges::min_element(near.radii));
  if (tolerance > 1) return add(model.found, bonds_by_no_gap, "gaps wider than a disc");
  for (const Contact& c : touching_discs(near, tolerance)) {
    const double gap = norm(near.branch(c)) - near.radii[c.i] - near.radii[c.j];
    if (gap > model.largest_gap || std::ranges::binary_search(bonded, std::pair(c.i, c.j))) continue;
    return add(model.found, bonds_by_no_gap, fmt::format("discs {} and {} are as near", c.i, c.j));
  }
}

void find_features_of_schedule(const Schedule& schedule, const std::string& name, FoundFeatures& found) {
  if (schedule.times.size() > most_points_of_schedule) add(found, long_tables, name);
}

/// Walls of either kind of scene.
void find_features_of_walls(const std::vector<Wall>& walls, FoundFeatures& found) {
  for (const Wall& wall : walls) {
    const std::string name = "wall '" + wall.name + "'";
    if (wall.shape != Wall::Shape::line) add(found, shaped_walls, name);
    if (wall.moves()) add(found, moving_walls, name);
    if (wall.servo) add(found, servo_walls, name);
    for (const Schedule* move : {&wall.move_x, &wall.move_y}) find_features_of_schedule(*move, name, found);
    if (wall.normal.x != 0 && wall.normal.y != 0) add(found, oblique_walls, name);
  }
}

void hold(EngineModel& model, const Scene& scene) {
  for (const TimedSupport& support : scene.supports) {
    const std::optional<Schedule>* components[] = {&support.ux, &support.uy, &support.rotation};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& component = *components[k];
      if (!component) continue;
      const std::string name = "support of '" + support.group + "'";
      const std::vector<std::int32_t>& discs = group(scene.assembly, support.group).discs;
      const double at_start = component->at(0);
      if (at_start != 0) add(model.found, given_displacements, name);
      for (const std::int32_t disc : discs) model.bodies[disc].held[k] = at_start;
      if (!component->changes()) continue;
      add(model.found, k == 2 ? turning_schedules : schedules, name);
      find_features_of_schedule(*component, name, model.found);
      model.motions.push_back({k, *component, discs});
    }
  }
}

void load(EngineModel& model, const Scene& scene) {
  for (const TimedLoad& timed : scene.loads) {
    const Load& given = timed.load;
    const std::string name = "load on '" + given.group + "'";
    const bool changes = timed.factor.changes();
    if (given.moment != 0) add(model.found, load_moments, name);
    if (changes) {
      add(model.found, schedules, name);
      find_features_of_schedule(timed.factor, name, model.found);
      model.timed_loads.push_back({timed.factor, {}});
    }
    const DiscGroup& discs = group(scene.assembly, given.group);
    const double share = given.kind == LoadKind::total ? 1.0 / static_cast<double>(discs.discs.size()) : 1.0;
    for (std::size_t k = 0; k < discs.discs.size(); ++k) {
      const double weight = given.kind == LoadKind::traction ? discs.tributary_lengths.at(k) : share;
      const DiscForce part{weight * given.force, share * given.moment};
      if (changes) {
        model.timed_loads.back().shares.emplace_back(discs.discs[k], part);
        continue;
      }
      DiscForce& sum = model.bodies[discs.discs[k]].load;
      sum.force += timed.factor.value * part.force;
      sum.moment += timed.factor.value * part.moment;
    }
  }
}

void set_velocities(EngineModel& model, const Scene& scene) {
  for (const InitialVelocity& given : scene.velocities)
    for (const std::int32_t disc : group(scene.assembly, given.group).discs) {
      model.bodies[disc].velocity = given.velocity;
      model.bodies[disc].spin = given.spin;
    }
}

/// Extremes of the masses of bodies.
std::pair<double, double> extreme_masses(const EngineModel& model) {
  const auto [least, most] =
      std::ranges::minmax_element(model.bodies, {}, [](const EngineBody& body) { return body.inertia.mass; });
  return {least->inertia.mass, most->inertia.mass};
}

bool equal_masses(const EngineModel& model) {
  const auto [least, most] = extreme_masses(model);
  return most - least <= 1e-9 * most;
}

/// Stiffness where the properties give it by mass: k = a m/dt², of bodies of one mass.
void set_stiffness(EngineModel& model, double time_step) {
  const bool equal = equal_masses(model);
  const EngineBody& body = model.bodies.front();
  std::vector<char> of_bodies(static_cast<std::size_t>(model.kinds), 0);
  for (const EngineBody& each : model.bodies) of_bodies[static_cast<std::size_t>(each.kind)] = 1;
  for (int a = 0; a < model.kinds; ++a)
    for (int b = 0; b < model.kinds; ++b) {
      PairProperties& pair = model.pairs[static_cast<std::size_t>(a * model.kinds + b)];
      if (pair.stiffness > 0) continue;
      if (!equal) add(model.found, stiffness_by_mass, "");
      const bool two = of_bodies[static_cast<std::size_t>(a)] && of_bodies[static_cast<std::size_t>(b)];
      pair.stiffness = pair.dimensionless * reduced_mass(body, two ? &body : nullptr) / squared(time_step);
    }
}

void find_features_of_pairs(EngineModel& model, NormalLaw law) {
  std::vector<char> of_bodies(static_cast<std::size_t>(model.kinds), 0);
  for (const EngineBody& each : model.bodies) of_bodies[static_cast<std::size_t>(each.kind)] = 1;
  const PairProperties* first = nullptr;
  bool damped = false;
  for (int a = 0; a < model.kinds; ++a)
    for (int b = 0; b < model.kinds; ++b) {
      if (!of_bodies[static_cast<std::size_t>(a)] && !of_bodies[static_cast<std::size_t>(b)]) continue;
      const PairProperties& pair = model.between(a, b);
      const double zeta = damping_ratio(law, pair);
      const std::string restitution = fmt::format("restitution {:.6g}", pair.restitution);
      damped = damped || zeta > 0;
      if (zeta > 0 && !equal_masses(model)) add(model.found, unequal_dashpots, restitution);
      if (zeta > 0 && pair.end != ContactEnd::at_zero_force) add(model.found, pulling_dashpots, restitution);
      if (zeta >= 1 && !equal_masses(model))
        add(model.found, strong_dashpots, fmt::format("damping ratio {:.6g}", zeta));
      if (pair.friction > 0) {
        add(model.found, friction_levers, fmt::format("with the coefficient {:.6g}", pair.friction));
        if (pair.tangential_damping > 0) add(model.found, tangential_dashpots, "");
        if (pair.tangential_damping > 0 && zeta == 0 && !equal_masses(model))
          add(model.found, dashpots_along_alone, "");
      }
      if (first == nullptr) first = &pair;
      if (!(pair == *first)) add(model.found, unequal_pairs, "");
    }
  if (damped && model.found.contains(unequal_pairs)) add(model.found, dashpots_by_pair, "");
}

}  // namespace

double reduced_mass(const EngineBody& i, const EngineBody* j) {
  return j == nullptr ? i.inertia.mass : i.inertia.mass * j->inertia.mass / (i.inertia.mass + j->inertia.mass);
}

std::optional<double> common_mass(const EngineModel& model) {
  if (!equal_masses(model)) return std::nullopt;
  return model.bodies.front().inertia.mass;
}

double tangential_mass_share(Body body) {
  return 1 / (1 + 1 / inertia_factor(body));
}

EngineModel engine_model(const Scene& scene, const SimulationOptions& options, Body body) {
  const Assembly& assembly = scene.assembly;
  EngineModel model;
  model.bonded = true;
  model.body = body;
  if (body == Body::sphere) add(model.found, spheres, "");
  model.gravity = scene.gravity;
  model.period = assembly.period;
  model.local_damping = options.damping.local;
  if (options.damping.mass != 0) add(model.found, mass_damping, "");
  const bool dashpots = options.damping.dashpots();
  if (dashpots) add(model.found, bond_dashpots, "");
  if (!on_lines_of_centres(assembly)) add(model.found, off_line_contacts, "");
  if (!assembly.sections.empty()) add(model.found, sections, "");
  const bool restrained = options.rotation == Rotation::restrained;
  for (std::size_t k = 0; k < assembly.size(); ++k) {
    EngineBody disc{.position = assembly.centres[k], .radius = assembly.radii[k], .inertia = scene.inertia[k]};
    if (restrained) disc.held[2] = 0;
    model.bodies.push_back(disc);
  }
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    model.bonds.push_back({.i = c.i,
                           .j = c.j,
                           .length = norm(assembly.branch(c)),
                           .springs = scene.springs[k],
                           .shift_x = c.shift_x,
                           .shift_y = c.shift_y});
    if (dashpots)
      model.bonds.back().dashpots =
          dashpots_of(options.damping, scene.springs[k], scene.inertia[c.i].mass, scene.inertia[c.j].mass);
  }
  find_features_of_contacts(scene, model.found);
  model.lever_radii = radii_of_levers(assembly);
  if (model.lever_radii.empty()) add(model.found, levers_of_no_radii, "");
  find_features_of_inertia(model);
  find_largest_gap(model);
  hold(model, scene);
  load(model, scene);
  set_velocities(model, scene);
  model.walls = scene.walls;
  find_features_of_walls(scene.walls, model.found);
  if (!scene.walls.empty()) add(model.found, walls_of_bonds, "wall '" + scene.walls.front().name + "'");
  return model;
}

EngineModel engine_model(const GrainScene& scene, const GrainOptions& options, Body body) {
  EngineModel model;
  model.body = body;
  model.gravity = scene.gravity;
  model.walls = scene.walls;
  model.kinds = scene.kinds;
  model.pairs = scene.pairs;
  for (std::size_t k = 0; k < scene.grains.size(); ++k) {
    const Grain& grain = scene.grains[k];
    if (grain.shape() != GrainShape::disc) add(model.found, shapes, fmt::format("grain {}", k));
    model.bodies.push_back({.position = grain.position,
                            .radius = grain.radius,
                            .inertia = grain.inertia,
                            .velocity = grain.velocity,
                            .spin = grain.spin,
                            .kind = grain.kind});
  }
  if (body == Body::sphere) add(model.found, spheres, "");
  if (!scene.bonds.empty()) add(model.found, grain_bonds, "");
  find_features_of_walls(scene.walls, model.found);
  if (scene.cell) add(model.found, cell_of_grains, "");
  if (options.law != NormalLaw::linear_dashpot) {
    add(model.found, other_laws, describe(options.law).name);
    return model;
  }
  set_stiffness(model, options.time_step);
  find_features_of_pairs(model, options.law);
  return model;
}

}  // namespace equidem
