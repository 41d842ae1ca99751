// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts of colliding bodies as callers see them.

#include "equidem/grains/grain_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/contacts/force_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/servo_walls.hpp"

namespace equidem {

namespace {

/// A refused step costs at most as many steps more; to keep a state so seldom costs less than a hundredth of them.
constexpr std::int64_t steps_between_kept_states = 1024;

BodyBlocks blocks_of(const GrainScene& scene, const GrainOptions& options) {
  return BodyBlocks(static_cast<std::size_t>(std::ranges::distance(scene.present())), options.bodies_per_block);
}

}  // namespace

GrainSimulation::GrainSimulation(const GrainScene& scene, const GrainOptions& options)
    : AnySimulation(BodyFamily::colliding, options.time_step),
      implementation_((check(scene, options), hidden<Implementation>(scene, options))) {
  implementation_->begin();
}

GrainSimulation::Implementation::Implementation(const GrainScene& scene, const GrainOptions& options,
                                                const GrainSystem* before)
    : effects(effects_of(scene, options)) {
  system.options = options;
  system.bodies.blocks = blocks_of(scene, options);
  system.bodies.sums.resize(system.bodies.blocks.count());
  system.bodies.ways.resize(system.bodies.blocks.count());
  system.bodies.inwards.resize(system.bodies.blocks.count());
  system.bodies.earliest.resize(system.bodies.blocks.count());
  std::iota(system.bodies.earliest.begin(), system.bodies.earliest.end(), std::size_t{0});
  order_by_place(system, scene, before == nullptr ? std::vector<std::size_t>() : before->bodies.order);
  set_cell(system, before);
  tie_bonds(system, scene);
  const auto any_pair = [&](auto has) { return std::ranges::any_of(scene.pairs, has); };
  system.rolling = any_pair([](const PairProperties& pair) { return pair.rolling_friction > 0; });
  system.cohesion = any_pair([](const PairProperties& pair) { return pair.cohesion > 0; });
  for (const PairProperties& pair : scene.pairs) system.range = std::max(system.range, pair.cohesion_range);
  system.friction = system.has_effects() || any_pair([](const PairProperties& pair) { return pair.friction > 0; });
  system.smallest_radius = smallest_inscribed_radius(scene);
  system.scene.walls = joined_walls(system.walls.given, joint_gap * system.smallest_radius);
  double fastest = 0;
  for (const Grain& grain : scene.present())
    fastest = std::max(
        fastest, norm(grain.velocity) + (grain.shape() == GrainShape::disc ? 0 : std::abs(grain.spin) * grain.radius));
  system.length = reference_length(scene, options);
  const auto& parts = system.shapes.parts;  // none where all bodies are discs
  const double smallest_size =
      parts.empty() ? system.smallest_radius : std::ranges::min(parts, {}, &GrainPart::size).size;
  system.bodies.next = system.bodies.motions;
  collide = candidate_loop(options.law, system.friction);
  flow = flow_function(options.law);
  if (!gives_force(options.law)) system.bodies.moments.resize(system.bodies.impulses.size());
  find_dissipations(system);
  find_servos(system);
  place_walls(system);
  prepare_lists(system);
  prepare_bodies(system);
  if (collide && system.friction) system.bodies.impulses_before.resize(system.bodies.impulses.size());
  pack_bonds(system);
  system.contacts.base_margin =
      options.margin > 0 ? options.margin : (gives_force(options.law) ? 0.6 : 0.2) * smallest_size;
  system.contacts.skin.margin = std::max(system.contacts.base_margin, 8 * fastest * options.time_step);
  if (!system.walls.servos.empty()) limit_free_way(system);
  system.walls.joints = joints_of(system.scene.walls, joint_gap * system.smallest_radius);
}

void GrainSimulation::Implementation::begin() {
  find_candidates(system);
  touch_contacts(system);
  for (Candidate& candidate : system.contacts.candidates) {
    // bodies that overlap at the start touch
    candidate.touching = geometry_of(system, candidate).overlap > 0;
    if (candidate.touching) ++system.counters.contacts;
  }
  system.contacts.record = true;
  if (verlet()) {
    find_impulses(system, collide, nullptr);
    system.lost = {};  // there was no drift before the start
    // The force that servo walls find in the first step: walls got half of it, as from a step with no force before.
    for (WallLoad& load : system.walls.loads)
      load = {.impulse = -2 * load.step_impulse,
              .step_impulse = 2 * load.step_impulse,
              .step_angular = 2 * load.step_angular};
    if (system.cell.deforms) begin_cell_stress(system, contacts());
  }
  const auto [potential, kinetic] = potential_and_kinetic();
  const StoredEnergy stored = stored_energy(system);
  const double elastic = stored.normal + stored.tangential + stored.rolling;
  at_start = {potential, kinetic + elastic + stored.cohesion + elastic_of_bonds(system)};
}

void GrainSimulation::advance(std::int64_t steps) {
  Implementation& self = *implementation_;
  for (std::int64_t k = 0; k < steps; ++k) {
    const std::int64_t now = self.system.step;
    const GrainCounters counters = self.system.counters;
    if (!self.kept || now - self.kept->step >= steps_between_kept_states) {
      self.kept.reset();  // the new one takes its memory
      self.kept = self.state();
    }
    try {
      self.system.contacts.record = k + 1 == steps || now + 1 - self.kept->step >= steps_between_kept_states;
      self.make_step();
    } catch (...) {
      // the failed step has changed contacts: repeat the steps from an earlier state to its start
      self.go_back_to(*self.kept);
      while (self.system.step < now) {
        self.system.contacts.record = self.system.step + 1 == now;
        self.make_step();
      }
      self.system.counters = counters;
      throw;
    }
  }
}

std::int64_t GrainSimulation::step() const {
  return implementation_->system.step;
}

std::vector<Grain> GrainSimulation::grains() const {
  const GrainSystem& system = implementation_->system;
  std::vector<Grain> grains = system.scene.grains;
  for (std::size_t k = 0; k < system.bodies.motions.size(); ++k) {
    Grain& grain = grains[system.bodies.grain_of[k]];
    const GrainMotion& motion = system.bodies.motions[k];
    grain.position = motion.position;
    grain.velocity = motion.velocity;
    grain.spin = motion.spin;
    grain.angle = motion.angle;
  }
  return grains;
}

std::vector<Grain> GrainSimulation::present_grains() const {
  std::vector<Grain> present = grains();
  std::erase_if(present, [](const Grain& grain) { return !grain.present; });
  return present;
}

std::vector<DiscMotion> GrainSimulation::motions() const {
  const GrainSystem& system = implementation_->system;
  std::vector<DiscMotion> motions(system.scene.grains.size(), not_there);
  for (std::size_t k = 0; k < system.bodies.motions.size(); ++k)
    motions[system.bodies.grain_of[k]] = {system.bodies.motions[k].position, system.bodies.motions[k].angle};
  return motions;
}

std::vector<DiscMotion> GrainSimulation::velocities() const {
  const GrainSystem& system = implementation_->system;
  std::vector<DiscMotion> velocities(system.scene.grains.size(), not_there);
  for (std::size_t k = 0; k < system.bodies.motions.size(); ++k)
    velocities[system.bodies.grain_of[k]] = {system.bodies.motions[k].velocity, system.bodies.motions[k].spin};
  return velocities;
}

EnergyLedger GrainSimulation::energy() const {
  return implementation_->energy();
}

std::vector<WallState> GrainSimulation::walls() const {
  const GrainSystem& system = implementation_->system;
  std::vector<WallState> walls(system.scene.walls.size());
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Wall& wall = system.walls.given[w];
    const WallPlace& place = system.walls.places[w];
    const WallLoad& load = system.walls.loads[w];
    walls[system.walls.wall_of[w]] = {.name = wall.name,
                                      .place = wall.point + place.displacement,
                                      .velocity = place.velocity,
                                      .force = load.step_impulse / system.dt(),
                                      .moment = load.step_angular / system.dt(),
                                      .impulse = load.impulse + load.step_impulse,
                                      .work = load.work};
  }
  return walls;
}

std::optional<CellState> GrainSimulation::cell() const {
  const GrainSystem& system = implementation_->system;
  if (!system.cell.active || system.cell.now.b.y == 0) return {};
  return state_of_cell(system, contacts());
}

std::vector<Wall> GrainSimulation::placed_walls() const {
  const GrainSystem& system = implementation_->system;
  std::vector<Wall> walls(system.scene.walls.size());
  for (std::size_t w = 0; w < walls.size(); ++w) {
    Wall wall = system.walls.given[w];
    wall.point += system.walls.places[w].displacement;
    wall.end += system.walls.places[w].displacement;
    wall.move_x = wall.move_y = {};
    wall.servo.reset();
    walls[system.walls.wall_of[w]] = std::move(wall);
  }
  return walls;
}

std::optional<PeriodicCell> GrainSimulation::placed_cell() const {
  const GrainSystem& system = implementation_->system;
  std::optional<PeriodicCell> cell = system.scene.cell;
  if (!cell) return cell;
  cell->width = system.cell.now.a.x;
  cell->height = system.cell.now.b.y;
  cell->shift = system.cell.now.b.x;
  cell->corner = system.cell.centre - 0.5 * Vec2{cell->width, cell->height};
  return cell;
}

std::vector<ServoReport> GrainSimulation::servos() const {
  return reports_of(implementation_->system);
}

const GrainCounters& GrainSimulation::counters() const {
  return implementation_->system.counters;
}

const Effects& GrainSimulation::effects() const {
  return implementation_->effects;
}

std::vector<GrainContact> GrainSimulation::contacts() const {
  return implementation_->contacts();
}

std::vector<GrainContact> GrainSimulation::Implementation::contacts() const {
  std::vector<GrainContact> contacts;
  for (const ContactState& state : contact_states(system)) {
    if (state.steps == 0) continue;
    GrainContact& contact =
        contacts.emplace_back(GrainContact{.i = static_cast<std::int32_t>(system.bodies.grain_of[state.i]),
                                           .overlap = state.overlap,
                                           .closing = state.closing,
                                           .normal = state.normal,
                                           .arm_i = state.arm_i,
                                           .arm_j = state.arm_j,
                                           .normal_force = state.impulse / system.dt(),
                                           .tangential_force = state.tangential_impulse / system.dt(),
                                           .moment = state.lever * state.rolling_impulse / system.dt(),
                                           .mode = state.mode,
                                           .steps = state.steps});
    contact.j =
        static_cast<std::int32_t>(state.j < 0 ? ~system.walls.wall_of[~state.j] : system.bodies.grain_of[state.j]);
    if (contact.j < 0 || contact.j > contact.i) continue;
    std::swap(contact.i, contact.j);
    contact.normal = -contact.normal;
    std::swap(contact.arm_i, contact.arm_j);
    contact.moment = -contact.moment;
  }
  std::ranges::stable_sort(contacts, {}, [](const GrainContact& c) { return std::pair(c.i, c.j); });
  return contacts;
}

std::vector<BodyContact> GrainSimulation::body_contacts() const {
  const GrainSystem& system = implementation_->system;
  const auto shift_of = [&](const GrainContact& c) {
    if (!system.cell.active || c.j < 0) return Vec2{};
    const auto place = [&](std::int32_t grain) {
      return system.bodies.motions[system.bodies.place_of_grain[grain]].position;
    };
    const Vec2 apart = place(c.j) - place(c.i);
    return system.cell.now.shift(image_inside(system.cell.now, {}, apart));
  };
  std::vector<BodyContact> result;
  for (const GrainContact& c : contacts()) {
    const Vec2 on_j = c.normal_force * c.normal + c.tangential_force * perpendicular(c.normal);
    result.push_back({.i = c.i,
                      .j = c.j,
                      .arm = c.arm_i,
                      .shift = shift_of(c),
                      .force = -on_j,
                      .normal_force = -c.normal_force,
                      .tangential_force = -c.tangential_force,
                      .bending_moment = -c.moment});
  }
  const std::vector<BodyContact> bonds = contacts_of_bonds(system);
  result.insert(result.end(), bonds.begin(), bonds.end());
  return result;
}

std::pair<double, double> GrainSimulation::Implementation::potential_and_kinetic() const {
  const bool behind = !flow && system.options.integrator == GrainOptions::Integrator::semi_implicit_euler;
  return system.bodies.blocks.sum([&](std::size_t block) {
    double potential = 0, kinetic = 0;
    for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i) {
      const GrainMotion& motion = system.bodies.motions[i];
      const GrainBody& body = system.bodies.constants[i];
      Vec2 position = motion.position;
      if (system.cell.active) position += system.cell.now.shift(system.cell.crossed[i]);
      if (behind) position -= (0.5 * system.dt()) * motion.velocity;
      const double mass = 1 / body.inverse_mass;
      potential -= mass * dot(system.scene.gravity, position);
      kinetic += 0.5 * mass * dot(motion.velocity, motion.velocity);
      kinetic += 0.5 * motion.spin * motion.spin / body.inverse_moment;
    }
    return std::pair(potential, kinetic);
  });
}

EnergyLedger GrainSimulation::Implementation::energy() const {
  EnergyLedger ledger = system.lost;
  double potential = 0;
  std::tie(potential, ledger.kinetic) = potential_and_kinetic();
  const StoredEnergy stored = stored_energy(system);
  ledger.elastic_normal = stored.normal;
  ledger.elastic_tangential = stored.tangential;
  ledger.elastic_rolling = stored.rolling;
  ledger.cohesion = stored.cohesion;
  ledger.elastic_bond = elastic_of_bonds(system);
  ledger.potential = potential - at_start.potential;
  ledger.initial = at_start.energy;
  return ledger;
}

namespace {

Effects::Entry entry(std::string name, bool active, std::string why_active, std::string why_not) {
  return {std::move(name), active, active ? std::move(why_active) : std::move(why_not)};
}

std::string law_of_ellipses(GrainOptions::EllipseLaw law) {
  switch (law) {
    case GrainOptions::EllipseLaw::exact:
      return "contact by closest points and common normal";
    case GrainOptions::EllipseLaw::enlarged:
      break;
  }
  return "contact by the enlarged ellipse: misses shallow contacts, does not keep the energy";
}

}  // namespace

Effects effects_of(const GrainScene& scene, const GrainOptions& options) {
  const auto any_pair = [&](auto has) { return std::any_of(scene.pairs.begin(), scene.pairs.end(), has); };
  const bool friction = any_pair([](const PairProperties& pair) { return pair.friction > 0; });
  const bool springs = any_pair([](const PairProperties& p) { return p.friction > 0 && p.tangential_ratio > 0; });
  const bool rolling = any_pair([](const PairProperties& pair) { return pair.rolling_friction > 0; });
  const bool cohesion = any_pair([](const PairProperties& pair) { return pair.cohesion > 0; });
  const bool losses = any_pair([](const PairProperties& pair) { return pair.restitution < 1; });
  const bool moving = std::any_of(scene.walls.begin(), scene.walls.end(), [](const Wall& w) { return w.moves(); });
  const bool servo = std::ranges::any_of(scene.walls, [](const Wall& w) { return w.servo.has_value(); });
  const auto any_shape = [&](GrainShape shape) {
    return std::ranges::any_of(scene.present(), [&](const Grain& g) { return g.shape() == shape; });
  };
  const std::size_t blocks = blocks_of(scene, options).count();
  const bool ellipses = any_shape(GrainShape::ellipse), clumps = any_shape(GrainShape::clump);
  Effects effects;
  effects.tangential_springs = springs;
  const auto any_bond = [&](const auto& test) {
    return std::ranges::any_of(scene.bonds, [&](const GrainBond& b) { return scene.ties(b) && test(b); });
  };
  const bool bonds = any_bond([](const GrainBond& /*any*/) { return true; });
  const bool sprung = any_bond([](const GrainBond& b) { return b.normal_spring > 0 || b.tangential_spring > 0; });
  const bool bending = any_bond([](const GrainBond& b) { return b.bending_spring > 0; });
  const bool turning = any_bond([](const GrainBond& b) {
                         return b.tangential_dashpot > 0 || b.rolling_dashpot > 0 || b.tangential_spring > 0;
                       }) ||
                       bending;
  effects.rotation = friction || rolling || turning || ellipses || clumps;
  effects.entries = {
      entry(fmt::format("normal contact by {}", to_string(options.law)), true, "grains rebound", ""),
      entry("loss at impacts", losses, "restitution below 1", "restitution 1: impacts keep the energy"),
      entry("friction", friction, "a friction coefficient above 0", "friction 0 everywhere"),
      entry("tangential springs", springs, "tangential_ratio above 0", friction ? "tangential_ratio 0" : "no friction"),
      entry("rolling resistance", rolling, "a coefficient of rolling friction above 0",
            "rolling_friction 0 everywhere"),
      entry("cohesion", cohesion, "bodies closer than a range attract", "cohesion 0 everywhere"),
      entry("ellipses", ellipses, law_of_ellipses(options.ellipse_law), "the scene has none"),
      entry("clumps", clumps, "discs that are tied rigidly", "the scene has none"),
      entry("rotation", effects.rotation,
            friction  ? "friction turns grains"
            : rolling ? "rolling resistance turns grains"
            : turning ? "bonds turn grains"
                      : "normal forces turn ellipses and clumps",
            "no friction: nothing can turn a grain"),
      entry("bonds", bonds, sprung ? "grains are tied by dashpots and springs" : "grains are tied by dashpots",
            "no grains are tied"),
      entry("bending springs", bending, "bonds resist the relative rotation of their discs", "no bond has one"),
      entry("breaking", scene.strengths.has_value(), "bonds have strengths", "no bond has a strength"),
      entry("gravity", scene.weighs(), "it is not 0", "it is 0"),
      entry("walls", !scene.walls.empty(), "the scene has some", "the scene has none"),
      entry("periodic cell", scene.cell.has_value(), "the bodies repeat", "nothing repeats"),
      entry("deformation of the cell", scene.cell && scene.cell->deforms(), "it has rates or keeps a stress",
            scene.cell ? "it keeps its size" : "there is no cell"),
      entry("motion of walls", moving, "a wall has a schedule", "no wall moves by a schedule"),
      entry("servo walls", servo, "a wall follows a force or a stress", "no wall follows a force or a stress"),
      entry("several threads", blocks > 1, fmt::format("the grains are stepped in {} blocks", blocks),
            "few grains: threads would wait for one another longer than they work"),
  };
  return effects;
}

double GrainSimulation::bytes_per_body() const {
  const GrainSystem& system = implementation_->system;
  std::size_t lists = system.contacts.parts.bytes();
  each_list(system.contacts, [&](const NearList& list) { lists += list.bytes(); });
  const double bytes = static_cast<double>(
      lists + system.contacts.pairs.bodies.capacity() * sizeof(PairBody) +
      system.bodies.constants.capacity() * sizeof(GrainBody) + system.bodies.moments.capacity() * sizeof(Vec2) +
      2 * system.bodies.motions.capacity() * sizeof(GrainMotion) +
      (system.bodies.impulses.capacity() + system.bodies.impulses_before.capacity()) * sizeof(BodyImpulse) +
      system.contacts.candidates.capacity() * sizeof(Candidate) + system.shapes.parts.capacity() * sizeof(GrainPart) +
      system.shapes.axes.capacity() * sizeof(Vec2) + system.bonds.tied.capacity() * sizeof(TiedPair) +
      system.bonds.packed.bytes() + system.contacts.exact_pairs.capacity() * sizeof(ExactPair) +
      (system.contacts.images.capacity() + system.cell.crossed.capacity()) * sizeof(PeriodicImage) +
      system.bonds.breaks.capacity() * sizeof(BondBreak) + system.scene.grains.capacity() * sizeof(Grain));
  return bytes / static_cast<double>(system.bodies.constants.size());
}

namespace {

/// Grains that are one body.
struct RestingBody {
  std::vector<std::size_t> grains;
  std::vector<Vec2> places;  ///< of the grains, beside one another where they are in a periodic cell, m
  Vec2 centre{};             ///< of mass, m
  double radius = 0;         ///< of the circle about the centre that holds all grains, m
};

/// The bodies of a scene, and of each grain the number of its body.
class RestingBodies {
 public:
  RestingBodies(const std::vector<Grain>& grains, std::span<const GrainBond> bonds,
                const std::optional<PeriodicCell>& cell)
      : of_(grains.size(), none), tied_(grains.size()) {
    for (const GrainBond& bond : bonds) {
      if (bond.has_springs()) continue;
      tied_[bond.i].push_back(bond.j);
      tied_[bond.j].push_back(bond.i);
    }
    for (std::size_t grain = 0; grain < grains.size(); ++grain)
      if (grains[grain].present && of_[grain] == none) add_body(grain, grains, cell);
  }

  [[nodiscard]] std::size_t of(std::size_t grain) const { return of_[grain]; }
  [[nodiscard]] const std::vector<RestingBody>& all() const { return bodies_; }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  void add_body(std::size_t first, const std::vector<Grain>& grains, const std::optional<PeriodicCell>& cell) {
    RestingBody body{.grains = {first}, .places = {grains[first].position}};
    of_[first] = bodies_.size();
    for (std::size_t k = 0; k < body.grains.size(); ++k) {
      for (const std::size_t other : tied_[body.grains[k]]) {
        if (of_[other] != none) continue;
        of_[other] = bodies_.size();
        Vec2 branch = grains[other].position - grains[body.grains[k]].position;
        if (cell) {
          const Periods periods = periods_of(*cell);
          branch += periods.shift(image_inside(periods, {}, branch));
        }
        body.grains.push_back(other);
        body.places.push_back(body.places[k] + branch);
      }
    }
    double mass = 0;
    for (std::size_t k = 0; k < body.grains.size(); ++k) {
      const double own = grains[body.grains[k]].inertia.mass;
      mass += own;
      body.centre += own / mass * (body.places[k] - body.centre);
    }
    for (std::size_t k = 0; k < body.grains.size(); ++k)
      body.radius = std::max(body.radius, norm(body.places[k] - body.centre) + grains[body.grains[k]].radius);
    bodies_.push_back(std::move(body));
  }

  std::vector<std::size_t> of_;
  std::vector<std::vector<std::size_t>> tied_;
  std::vector<RestingBody> bodies_;
};

struct Load {
  Vec2 force;
  double moment = 0;  ///< about the centre of the grain
};

}  // namespace

Unbalance unbalance_of(const GrainSimulation& simulation, std::span<const GrainBond> bonds, Vec2 gravity) {
  const std::vector<Grain> grains = simulation.grains();
  const RestingBodies bodies(grains, bonds, simulation.placed_cell());
  std::vector<Load> loads(grains.size());
  for (std::size_t k = 0; k < grains.size(); ++k) loads[k].force = grains[k].inertia.mass * gravity;
  // of body_contacts() those of contacts() come first, with an arm to each body as the step has taken it
  const std::vector<GrainContact> contacts = simulation.contacts();
  double carried = 0, carriers = 0;
  std::size_t number = 0;
  for (const BodyContact& contact : simulation.body_contacts()) {
    const std::size_t c = number++;
    const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
    if (contact.j >= 0 && bodies.of(i) == bodies.of(j)) continue;
    loads[i].force += contact.force;
    loads[i].moment += cross(contact.arm, contact.force) + contact.bending_moment;
    if (contact.j >= 0) {
      const Vec2 arm = c < contacts.size() ? contacts[c].arm_j
                                           : contact.arm - (grains[j].position + contact.shift - grains[i].position);
      loads[j].force -= contact.force;
      loads[j].moment -= cross(arm, contact.force) + contact.bending_moment;
    }
    carried += norm(contact.force);
    carriers += 1;
  }
  double sum = 0, largest = 0;
  for (const RestingBody& body : bodies.all()) {
    Load all;
    for (std::size_t k = 0; k < body.grains.size(); ++k) {
      const Load& load = loads[body.grains[k]];
      all.force += load.force;
      all.moment += load.moment + cross(body.places[k] - body.centre, load.force);
    }
    const double unbalanced = std::hypot(norm(all.force), all.moment / body.radius);
    sum += unbalanced;
    largest = std::max(largest, unbalanced);
  }
  const double mean = carriers > 0 ? carried / carriers : 0;
  if (!(mean > 0)) return {INFINITY, INFINITY};
  return {sum / static_cast<double>(bodies.all().size()) / mean, largest / mean};
}

}  // namespace equidem
