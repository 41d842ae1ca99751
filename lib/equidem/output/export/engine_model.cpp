// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/engine_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/layout.hpp"
#include "equidem/grains/scene/pair_options.hpp"

namespace equidem {

std::vector<std::string> acceptable_features() {
  std::vector<std::string> words;
  for (const EngineFeatureRow& row : EnumNames<EngineFeature>::list)
    if (row.accept != nullptr) words.emplace_back(row.accept);
  return words;
}

void require_carried(const FoundFeatures& found, Engine engine, const std::vector<std::string>& accepted) {
  const std::vector<std::string> words = acceptable_features();
  for (const std::string& word : accepted) {
    if (std::ranges::find(words, word) != words.end()) continue;
    bad_input(fmt::format("--accept {}: nothing of that name can be accepted", word),
              "what an engine does not carry is refused", fmt::format("Give --accept {}", joined(words, " or ")));
  }
  for (const auto& [feature, instance] : found) {
    const EngineFeatureRow& row = entry_of(feature);
    if (row.carried_by(engine)) continue;
    if (row.accept != nullptr && std::ranges::find(accepted, row.accept) != accepted.end()) continue;
    bad_input(fmt::format("the export to {} does not carry {}{}", to_string(engine), row.name,
                          instance.empty() ? "" : ", here " + instance),
              row.why, row.remedy);
  }
}

std::string engine_features_table() {
  const auto names = names_of<Engine>();
  std::string text =
      fmt::format("| part of a model | {} | why it is refused |\n|---|---|---|---|\n", joined(names, " | "));
  for (const EngineFeatureRow& row : EnumNames<EngineFeature>::list) {
    std::vector<std::string> cells;
    for (const auto& engine : EnumNames<Engine>::list) {
      const std::string otherwise = row.accept != nullptr ? fmt::format("with --accept {}", row.accept) : "no";
      cells.push_back(row.carried_by(engine.value) ? "yes" : otherwise);
    }
    text += fmt::format("| {} | {} | {} |\n", row.name, joined(cells, " | "), row.why);
  }
  return text;
}

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
    if (std::abs(c.lever_i + c.lever_j - distance) > lever_tolerance * distance)
      add(found, contact_points_of_no_radii, "the levers of " + name + ", which do not add up to the distance");
    if (std::abs(c.lever_i - 0.5 * distance) > lever_tolerance * distance) add(found, contact_points, name);
    if (scene.springs[k].kT < 0) add(found, bonds, "negative kT of " + name);
    if (scene.springs.bending(k) > 0) add(found, bonds, "bending springs of " + name);
  }
  std::ranges::sort(pairs);
  if (const auto twice = std::ranges::adjacent_find(pairs); twice != pairs.end())
    add(found, bonds, fmt::format("two contacts of discs {} and {}", twice->first, twice->second));
  if (assembly.periodic() && std::min(assembly.period->x, assembly.period->y) <= 2 * longest)
    add(found, cells, "a cell that is too short");
}

void find_features_of_schedule(const Schedule& schedule, const std::string& name, FoundFeatures& found) {
  if (schedule.times.size() > most_points_of_schedule) add(found, EngineFeature::schedules, "that of " + name);
}

/// Walls of either kind of scene.
void find_features_of_walls(const std::vector<Wall>& walls, FoundFeatures& found) {
  for (const Wall& wall : walls) {
    const std::string name = "wall '" + wall.name + "'";
    if (wall.shape != Wall::Shape::line || wall.servo) add(found, shaped_walls, name);
    for (const Schedule* move : {&wall.move_x, &wall.move_y}) find_features_of_schedule(*move, name, found);
    if (wall.normal.x != 0 && wall.normal.y != 0) add(found, some_walls, "oblique " + name);
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
      if (at_start != 0) add(model.found, given_at_start, name);
      for (const std::int32_t disc : discs) model.bodies[disc].held[k] = at_start;
      if (!component->changes()) continue;
      if (k == 2) add(model.found, turning, "the rotation by the " + name);
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
    if (given.moment != 0) add(model.found, turning, "the " + name);
    if (changes) {
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
      if (!equal) add(model.found, other_laws, "stiffness that follows from unequal masses");
      const bool two = of_bodies[static_cast<std::size_t>(a)] && of_bodies[static_cast<std::size_t>(b)];
      pair.stiffness = pair.dimensionless * reduced_mass(body, two ? &body : nullptr) / squared(time_step);
    }
}

void find_features_of_pairs(EngineModel& model, NormalLaw law) {
  std::vector<char> of_bodies(static_cast<std::size_t>(model.kinds), 0);
  for (const EngineBody& each : model.bodies) of_bodies[static_cast<std::size_t>(each.kind)] = 1;
  const PairProperties* first = nullptr;
  bool damped = false, differ = false;
  for (int a = 0; a < model.kinds; ++a)
    for (int b = 0; b < model.kinds; ++b) {
      if (!of_bodies[static_cast<std::size_t>(a)] && !of_bodies[static_cast<std::size_t>(b)]) continue;
      const PairProperties& pair = model.between(a, b);
      const double zeta = damping_ratio(law, pair);
      const std::string restitution = fmt::format("restitution {:.6g}", pair.restitution);
      const bool equal = equal_masses(model), along = pair.friction > 0 && pair.tangential_damping > 0;
      damped = damped || zeta > 0;
      if (zeta > 0 && !equal) add(model.found, dashpots, restitution + " of bodies of unequal masses");
      if (zeta > 0 && pair.end != ContactEnd::at_zero_force)
        add(model.found, dashpots, restitution + " of contacts that may pull");
      if (along) add(model.found, dashpots, "tangential_damping");
      model.graded_dashpots = model.graded_dashpots || (zeta > 0 && !equal) || along;
      if (zeta >= 1 && !equal)
        add(model.found, other_laws, fmt::format("the damping ratio {:.6g} of bodies of unequal masses", zeta));
      if (along && zeta == 0 && !equal)
        add(model.found, other_laws, "tangential dashpots without normal ones, of bodies of unequal masses");
      if (pair.friction > 0) {
        add(model.found, friction_levers, fmt::format("with the coefficient {:.6g}", pair.friction));
      }
      if (first == nullptr) first = &pair;
      differ = differ || !(pair == *first);
    }
  if (damped && differ) add(model.found, dashpots, "restitution that differs from pair to pair");
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
  model.gravity = scene.gravity;
  model.period = assembly.period;
  model.local_damping = options.damping.local;
  if (options.damping.mass != 0) add(model.found, mass_damping, "");
  const bool damped = options.damping.dashpots();
  if (damped) add(model.found, bond_dashpots, "");
  if (!on_lines_of_centres(assembly)) add(model.found, contact_points_of_no_radii, "some off the line of centres");
  if (!assembly.sections.empty()) add(model.found, EngineFeature::shapes, "sections of other shapes");
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
    if (damped)
      model.bonds.back().dashpots =
          dashpots_of(options.damping, scene.springs[k], scene.inertia[c.i].mass, scene.inertia[c.j].mass);
  }
  find_features_of_contacts(scene, model.found);
  model.lever_radii = radii_of_levers(assembly);
  if (model.lever_radii.empty()) add(model.found, contact_points_of_no_radii, "");
  hold(model, scene);
  load(model, scene);
  set_velocities(model, scene);
  model.walls = scene.walls;
  find_features_of_walls(scene.walls, model.found);
  if (!scene.walls.empty()) add(model.found, some_walls, "wall '" + scene.walls.front().name + "'");
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
    if (grain.shape() != GrainShape::disc)
      add(model.found, shapes,
          fmt::format("grain {}, {}", k, grain.shape() == GrainShape::ellipse ? "an ellipse" : "a clump"));
    model.bodies.push_back({.position = grain.position,
                            .radius = grain.radius,
                            .inertia = grain.inertia,
                            .velocity = grain.velocity,
                            .spin = grain.spin,
                            .kind = grain.kind});
  }
  if (!scene.bonds.empty()) add(model.found, bonds, "bonds of bodies that collide");
  find_features_of_walls(scene.walls, model.found);
  if (scene.cell) add(model.found, cells, "[cell]");
  if (options.law != NormalLaw::linear_dashpot) {
    add(model.found, other_laws, std::string("the law ") + describe(options.law).name);
    return model;
  }
  set_stiffness(model, options.time_step);
  find_features_of_pairs(model, options.law);
  return model;
}

}  // namespace equidem
