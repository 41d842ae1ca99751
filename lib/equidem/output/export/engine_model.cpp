// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/engine_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"
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

bool equal_masses(const EngineModel& model) {
  const auto [least, most] =
      std::ranges::minmax_element(model.bodies, {}, [](const EngineBody& body) { return body.inertia.mass; });
  return most->inertia.mass - least->inertia.mass <= 1e-9 * most->inertia.mass;
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
    if (k % rows_between_looks == 0) stop_if_interrupted();
    const auto name = [&] { return fmt::format("contact {} of discs {} and {}", k, c.i, c.j); };
    const double distance = norm(assembly.branch(c));
    longest = std::max(longest, distance);
    pairs.emplace_back(std::minmax(c.i, c.j));
    if (std::abs(c.lever_i + c.lever_j - distance) > lever_tolerance * distance)
      add(found, contact_points_of_no_radii, "the levers of " + name() + ", which do not add up to the distance");
    if (std::abs(c.lever_i - 0.5 * distance) > lever_tolerance * distance) add(found, contact_points, name());
    if (scene.springs[k].kT < 0) add(found, bonds, "negative kT of " + name());
    if (scene.springs.bending(k) > 0) add(found, bonds, "bending springs of " + name());
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

/// Stiffness where the properties give it by mass: k = a m/dt², of bodies of one mass.
void set_stiffness(EngineModel& model, double time_step) {
  const bool equal = equal_masses(model);
  const double mass = model.bodies.front().inertia.mass;
  for (int a = 0; a < model.kinds; ++a)
    for (int b = 0; b < model.kinds; ++b) {
      PairProperties& pair = model.pairs[static_cast<std::size_t>(a * model.kinds + b)];
      if (pair.stiffness > 0) continue;
      if (!equal) add(model.found, other_laws, "stiffness that follows from unequal masses");
      const double reduced = model.has_bodies(a) && model.has_bodies(b) ? mass * mass / (mass + mass) : mass;
      pair.stiffness = pair.dimensionless * reduced / squared(time_step);
    }
}

void find_features_of_pairs(EngineModel& model, NormalLaw law) {
  const PairProperties* first = nullptr;
  bool damped = false, differ = false;
  for (int a = 0; a < model.kinds; ++a)
    for (int b = 0; b < model.kinds; ++b) {
      if (!model.has_bodies(a) && !model.has_bodies(b)) continue;
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
      if (pair.rolling_friction > 0) {
        add(model.found, rolling, fmt::format("with the coefficient {:.6g}", pair.rolling_friction));
        if (pair.rolling_damping > 0 && !equal) add(model.found, other_laws, "rolling_damping of unequal bodies");
      }
      if (pair.cohesion > 0)
        add(model.found, other_laws,
            fmt::format("cohesion of {:.6g} within {:.6g} m", pair.cohesion, pair.cohesion_range));
      if (first == nullptr) first = &pair;
      differ = differ || !(pair == *first);
    }
  if (damped && differ) add(model.found, dashpots, "restitution that differs from pair to pair");
}

}  // namespace

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

std::string exact(double value) {
  return fmt::format("{}", value);
}

std::string formula_of(const Schedule& schedule, const std::string& time) {
  const auto negative = [](double value) { return value < 0 ? fmt::format("({})", value) : exact(value); };
  const auto since = [&](double start) { return fmt::format("({0}-{1}+abs({0}-{1}))/2", time, negative(start)); };
  // The time between two instants, from 0 to their distance.
  const auto between = [&](double start, double end) {
    return fmt::format("(abs({0}-{1})-abs({0}-{2})+{3})/2", time, negative(start), negative(end), exact(end - start));
  };
  const auto slope_of = [&](std::size_t k) {
    return (schedule.values[k + 1] - schedule.values[k]) / (schedule.times[k + 1] - schedule.times[k]);
  };
  std::string sum;
  switch (schedule.kind) {
    case Schedule::Kind::constant:
      sum = exact(schedule.value);
      break;
    case Schedule::Kind::ramp:
      sum =
          fmt::format("{}*(1-cos({}*({})))", negative(0.5 * schedule.value),
                      exact(std::numbers::pi / (schedule.end - schedule.start)), between(schedule.start, schedule.end));
      break;
    case Schedule::Kind::sine:
      sum = fmt::format("{}*sin({}*({}))", negative(schedule.value), exact(2 * std::numbers::pi * schedule.frequency),
                        since(schedule.start));
      break;
    case Schedule::Kind::cycles:
      sum = fmt::format("{}*(1-cos({}*({})))", negative(schedule.value),
                        exact(2 * std::numbers::pi * schedule.frequency), between(schedule.start, schedule.end));
      break;
    case Schedule::Kind::table:
      sum = exact(schedule.values.front());
      for (std::size_t k = 0; k + 1 < schedule.times.size(); ++k) {
        if (slope_of(k) == 0) continue;
        sum += fmt::format("+{}*{}", negative(slope_of(k)), between(schedule.times[k], schedule.times[k + 1]));
      }
      break;
  }
  return sum;
}

EngineFile readme_of(const EngineModel& model, Engine engine) {
  const bool lammps = engine == Engine::lammps;
  const std::string bodies = counted(std::ssize(model.bodies), model.body == Body::disc ? "disc" : "sphere");
  const std::string contacts = model.bonded ? " and " + counted(std::ssize(model.bonds), "bond") : " that collide";
  std::string text =
      fmt::format("{}{}{} for {}, written by equidem; start: {} (the state at the end: {}).\n",
                  model.title.empty() ? "" : model.title + ": ", bodies, contacts, to_string(engine),
                  lammps ? "lmp -in in.equidem" : "yade -n -x run_equidem.py", lammps ? "end.dump" : "end.txt");
  text +=
      model.body == Body::disc
          ? "Units: SI. Masses, moments of inertia, springs and forces are those of one metre of depth: kg/m, kg m, "
            "N/m², N/m.\n"
          : "Units: SI; masses and forces are those of whole spheres; springs N/m.\n";
  text += fmt::format("Time step {} s, stable; {}.\n", exact(model.time_step),
                      !model.bonded ? "tangential springs are without force at the start"
                      : model.found.contains(EngineFeature::strengths)
                          ? "motions are finite here, bonds that break are gone, none carries a force at the start"
                          : "motions are finite here, bonds neither break nor carry forces at the start");
  for (const auto& [feature, instance] : model.found) {
    const EngineFeatureRow& row = entry_of(feature);
    if (!row.carried_by(engine) && row.accept != nullptr) text += fmt::format("Accepted: {}; {}.\n", row.name, row.why);
  }
  return {"README", text};
}

std::int64_t steps_of(const EngineModel& model) {
  if (!model.to_rest) return std::max<std::int64_t>(1, count_steps(model.duration, model.time_step));
  double low = model.bodies.front().position.x, high = low, bottom = model.bodies.front().position.y, top = bottom;
  for (const EngineBody& body : model.bodies) {
    low = std::min(low, body.position.x), high = std::max(high, body.position.x);
    bottom = std::min(bottom, body.position.y), top = std::max(top, body.position.y);
  }
  double length = 0;
  for (const EngineBond& bond : model.bonds) length += bond.length;
  length /= static_cast<double>(std::max<std::size_t>(1, model.bonds.size()));
  const double across = 1 + std::max(high - low, top - bottom) / length;
  constexpr double steps_across = 2000;
  return static_cast<std::int64_t>(std::ceil(steps_across * across));
}

double force_scale(const EngineModel& model) {
  double stiffness = 0, force = 0;
  for (const EngineBond& bond : model.bonds) stiffness = std::max(stiffness, bond.springs.kN);
  for (const EngineBody& body : model.bodies) {
    force = std::max({force, norm(body.load.force), std::abs(body.load.moment) / body.radius,
                      body.inertia.mass * norm(model.gravity)});
    for (std::size_t k = 0; k < 3; ++k)
      if (body.held[k]) force = std::max(force, stiffness * std::abs(*body.held[k]) * (k == 2 ? body.radius : 1));
  }
  return force;
}

}  // namespace equidem
