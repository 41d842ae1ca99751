// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A step of colliding bodies: its stages in their order, and nowhere else.
///
///   Steer     walls and cells that keep a force or a stress get the speed of the step
///   Drift     positions advance by velocities
///   Guard     motions that are no numbers, and bodies that would pass through one another, are refused
///   Lists     the pairs that may touch are found again where bodies have moved far enough
///   Contacts  impulses of contacts, block by block of bodies, each on its own bodies
///   Bonds     impulses of bonds
///   Gather    impulses on bodies of later blocks are added
///   Kick      velocities advance by impulses
///   Count     losses, loads of walls and counters of the blocks are added up
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/contacts/crossing.hpp"
#include "equidem/grains/contacts/force_step.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"
#include "equidem/grains/servo_walls.hpp"

namespace equidem {
namespace {

void begin_counts(GrainSystem& system) {
  system.deepest = 0;
  for (WallLoad& load : system.walls.loads) load.begin_step();
}

/// Guard and Lists: the motions of the step are compared by the lists that hold for it.
void list_and_guard(GrainSystem& system) {
  const double reach = reach_of(system);
  refuse_runaway(system, reach);
  refuse_long_ways_in_cell(system, reach);
  refresh_candidates(system, reach);
  if (!system.options.refuse_crossing || !may_cross(system, reach)) return;
  if (system.bodies.moved) find_places_before(system);
  refuse_crossings(system);
}

/// Bodies, walls and axes go on to the end of the step. Steer: walls.
void go_on(GrainSystem& system) {
  if (!system.bodies.moved) system.bodies.motions.swap(system.bodies.next);
  if (system.cell.deforms) advance_cell(system);
  ++system.step;
  if (!system.walls.servos.empty()) steer_walls(system);
  place_walls(system);
  turn_axes(system);
  cover_joints(system);
}

}  // namespace

void find_impulses(GrainSystem& system, CandidateLoop collide, BlockMove move) {
  system.cell.on_images = {};
  if (system.bonds.held > 0) push_springs(system);  // Bonds
  if (system.bonds.breakable && !system.options.verlet() && break_bonds(system) && system.bonds.held > 0)
    push_springs(system);
  const bool at_once = system.bonds.held == 0 && !collide;
  if (system.contacts.has(Between::ellipses)) load_part_bodies(system);
  collide_bodies(system, collide, at_once ? move : nullptr);  // Contacts, Gather, Kick of each block, Count
  if (system.bonds.held > 0) add_bond_impulses(system);
  if (at_once || !move) return;
  system.bodies.blocks.each([&](std::size_t block) { move(system, block); });  // Kick
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
  begin_counts(system);
  flow(system);  // all stages but Steer: contacts and motions are solved for together
  go_on(system);
}

void GrainSimulation::Implementation::step_by_euler() {
  begin_counts(system);
  find_impulses(system, collide, move_by_euler);  // Contacts, Bonds, Gather, Kick and Drift, Count
  take_longest_way(system);
  list_and_guard(system);  // Lists, Guard
  go_on(system);           // Steer
}

void GrainSimulation::Implementation::step_by_verlet() {
  if (system.bonds.breakable) break_bonds(system);  // by the springs of the last kick, which are those of the first one
  const bool deforms = system.cell.deforms;
  if (deforms) steer_cell(system);                      // Steer
  count_opening_kick(system);                           // Kick: the first half, and
  (deforms ? drift_in_cell : drift_of_verlet)(system);  // Drift
  list_and_guard(system);                               // Lists, Guard
  go_on(system);                                        // Steer
  begin_counts(system);                                 // servo walls were steered by those of the last step
  find_impulses(system, collide, deforms ? nullptr : kick_of_verlet);  // Contacts, Bonds, Gather, Kick, Count
  if (deforms) kick_in_cell(system);
}

}  // namespace equidem
