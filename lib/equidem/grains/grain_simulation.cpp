// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/grain_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/crossing.hpp"
#include "equidem/grains/contacts/flow_step.hpp"
#include "equidem/grains/contacts/move_bodies.hpp"
#include "equidem/grains/contacts/pack_bonds.hpp"
#include "equidem/grains/contacts/part_crossing.hpp"
#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/contacts/part_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/neighbours/part_pairs.hpp"
#include "equidem/grains/servo_walls.hpp"

namespace equidem {
namespace {

/// A refused step costs at most as many steps more; to keep a state so seldom costs less than a hundredth of them.
constexpr std::int64_t steps_between_kept_states = 1024;

void begin_loads_of_walls(GrainSystem& system) {
  for (WallLoad& load : system.walls.loads) load.begin_step();
}

}  // namespace

GrainSimulation::GrainSimulation(const GrainScene& scene, const GrainOptions& options,
                                 const std::vector<std::size_t>& order)
    : AnySimulation(BodyFamily::colliding, options.time_step), implementation_(hidden<Implementation>()) {
  check(scene, options);
  Implementation& self = *implementation_;
  GrainSystem& system = self.system;
  system.options = options;
  system.bodies.blocks = BodyBlocks(scene.grains.size(), options.bodies_per_block);
  system.bodies.sums.resize(system.bodies.blocks.count());
  system.bodies.ways.resize(system.bodies.blocks.count());
  system.bodies.inwards.resize(system.bodies.blocks.count());
  system.bodies.earliest.resize(system.bodies.blocks.count());
  std::iota(system.bodies.earliest.begin(), system.bodies.earliest.end(), std::size_t{0});
  order_by_place(system, scene, order);
  set_cell(system);
  std::vector<std::size_t> numbers = tie_bonds(system, scene);
  if (scene.strengths)
    system.bonds.breakable = std::make_shared<BreakableBonds>(system, *scene.strengths, std::move(numbers));
  system.friction =
      std::any_of(scene.pairs.begin(), scene.pairs.end(), [](const PairProperties& pair) { return pair.friction > 0; });
  system.smallest_radius = smallest_inscribed_radius(scene);
  system.scene.walls = joined_walls(system.walls.given, joint_gap * system.smallest_radius);
  double fastest = 0;
  for (const Grain& grain : scene.grains)
    fastest = std::max(
        fastest, norm(grain.velocity) + (grain.shape() == GrainShape::disc ? 0 : std::abs(grain.spin) * grain.radius));
  system.length = reference_length(scene, options);
  const auto& parts = system.shapes.parts;  // none where all bodies are discs
  const double smallest_size =
      parts.empty() ? system.smallest_radius : std::ranges::min(parts, {}, &GrainPart::size).size;
  system.bodies.next = system.bodies.motions;
  self.collide = system.shapes.parts.empty() ? candidate_loop(options.law, system.friction)
                                             : part_candidate_loop(options.law, system.friction);
  self.flow = flow_function(options.law);
  if (!gives_force(options.law)) system.bodies.moments.resize(system.bodies.impulses.size());
  find_dissipations(system);
  find_servos(system);
  place_walls(system);
  prepare_near_pairs(system);
  if (const CandidateLoop loop = wall_loop(system)) {
    self.collide = loop;
  } else if (self.collide && system.friction) {
    system.bodies.impulses_before.resize(system.bodies.impulses.size());
  }
  pack_bonds(system);
  prepare_near_parts(system);
  const bool listed_twice =
      system.shapes.parts.empty() ? system.contacts.near.active : system.contacts.near_parts.active;
  system.contacts.base_margin = options.margin > 0 ? options.margin : (listed_twice ? 0.6 : 0.2) * smallest_size;
  system.contacts.margin = std::max(system.contacts.base_margin, 8 * fastest * options.time_step);
  if (!system.walls.servos.empty()) limit_free_way(system);
  system.walls.joints = joints_of(system.scene.walls, joint_gap * system.smallest_radius);
  find_candidates(system);
  touch_near_pairs(system);
  touch_near_parts(system);
  for (std::size_t c = 0; c < system.contacts.candidates.size(); ++c) {
    // bodies that overlap at the start touch
    Candidate& candidate = system.contacts.candidates[c];
    candidate.touching = overlap_of(system, c) > 0;
    if (candidate.touching) ++system.counters.contacts;
  }
  system.contacts.near.record = true;
  if (self.verlet()) {
    self.find_impulses(nullptr);
    system.lost = {};  // there was no drift before the start
    // The force that servo walls find in the first step: walls got half of it, as from a step with no force before.
    for (WallLoad& load : system.walls.loads)
      load = {.impulse = -2 * load.step_impulse,
              .step_impulse = 2 * load.step_impulse,
              .step_angular = 2 * load.step_angular};
    if (system.cell.deforms) begin_cell_stress(system, contacts());
  }
  self.effects = effects_of(scene, options);
  const auto [potential, kinetic] = self.potential_and_kinetic();
  self.potential_at_start = potential;
  const auto [normal, tangential] = self.elastic();
  self.energy_at_start = kinetic + normal + tangential + elastic_of_bonds(system);
}

void GrainSimulation::Implementation::make_step() {
  if (flow) return step_together();
  if (verlet()) {
    step_by_verlet();
  } else {
    step_by_euler();
  }
  if (system.cell.active && system.step % steps_between_wraps == 0) wrap_bodies(system);
}

void GrainSimulation::Implementation::step_together() {
  system.deepest = 0;
  begin_loads_of_walls(system);
  flow(system);  // contacts, motion and candidates
  start_next_step();
}

void GrainSimulation::Implementation::step_by_euler() {
  system.deepest = 0;
  begin_loads_of_walls(system);
  find_impulses(move_by_euler);
  take_longest_way(system);
  update_candidates();
  start_next_step();
}

void GrainSimulation::Implementation::step_by_verlet() {
  if (system.bonds.breakable) break_bonds(system);  // by the springs of the last kick, which are those of the first one
  const bool deforms = system.cell.deforms;
  if (deforms) steer_cell(system);
  count_opening_kick(system);
  (deforms ? drift_in_cell : drift_of_verlet)(system);
  update_candidates();
  start_next_step();
  system.deepest = 0;
  begin_loads_of_walls(system);  // servo walls were steered by those of the last step
  find_impulses(deforms ? nullptr : kick_of_verlet);
  if (deforms) kick_in_cell(system);
}

void GrainSimulation::Implementation::find_impulses(BlockMove move) {
  system.cell.bond_sums = {};
  if (!system.bonds.tied.empty()) push_springs(system);
  if (system.bonds.breakable && !verlet() && break_bonds(system) && !system.bonds.tied.empty()) push_springs(system);
  const bool at_once = system.bonds.tied.empty() && touches_walls_alone(system);
  if (system.contacts.near_parts.active) load_part_bodies(system);
  collide_bodies(system, collide, at_once ? move : nullptr);
  if (!system.bonds.tied.empty()) add_bond_impulses(system);
  if (at_once || !move) return;
  system.bodies.blocks.each([&](std::size_t block) { move(system, block, system.free_flight); });
}

void GrainSimulation::Implementation::update_candidates() {
  const double reach = reach_of(system);
  refuse_runaway(system, reach);
  refuse_long_ways_in_cell(system, reach);
  refresh_candidates(system, reach);
  if (!system.options.refuse_crossing || !may_cross(system, reach)) return;
  if (system.bodies.in_place) find_places_before(system);
  refuse_crossings(system);
}

void GrainSimulation::Implementation::start_next_step() {
  if (!system.bodies.in_place) system.bodies.motions.swap(system.bodies.next);
  if (system.cell.deforms) advance_cell(system);
  ++system.step;
  if (!system.walls.servos.empty()) steer_walls(system);
  place_walls(system);
  turn_axes(system);
  if (system.meets_images()) turn_images(system);
  cover_joints(system);
}

void GrainSimulation::advance(std::int64_t steps) {
  Implementation& self = *implementation_;
  for (std::int64_t k = 0; k < steps; ++k) {
    const std::int64_t now = self.system.step;
    const GrainCounters counters = self.system.counters;
    if (self.kept.arrays.empty() || now - self.kept.step >= steps_between_kept_states) self.kept = save();
    try {
      self.system.contacts.near.record = k + 1 == steps || now + 1 - self.kept.step >= steps_between_kept_states;
      self.make_step();
    } catch (...) {
      // the failed step has changed contacts: repeat the steps from an earlier state to its start
      go_back_to(self.kept);
      while (self.system.step < now) {
        self.system.contacts.near.record = self.system.step + 1 == now;
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
  std::vector<Grain> grains(system.bodies.motions.size());
  for (std::size_t k = 0; k < grains.size(); ++k) {
    Grain grain = system.scene.grains[k];
    const GrainMotion& motion = system.bodies.motions[k];
    grain.position = motion.position;
    grain.velocity = motion.velocity;
    grain.spin = motion.spin;
    grain.angle = motion.angle;
    grains[system.bodies.grain_of[k]] = grain;
  }
  return grains;
}

std::vector<DiscMotion> GrainSimulation::motions() const {
  const GrainSystem& system = implementation_->system;
  std::vector<DiscMotion> motions(system.bodies.motions.size());
  for (std::size_t k = 0; k < motions.size(); ++k)
    motions[system.bodies.grain_of[k]] = {system.bodies.motions[k].position, system.bodies.motions[k].angle};
  return motions;
}

std::vector<DiscMotion> GrainSimulation::velocities() const {
  const GrainSystem& system = implementation_->system;
  std::vector<DiscMotion> velocities(system.bodies.motions.size());
  for (std::size_t k = 0; k < velocities.size(); ++k)
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

const std::vector<std::size_t>& GrainSimulation::order() const {
  return implementation_->system.bodies.grain_of;
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

}  // namespace equidem
