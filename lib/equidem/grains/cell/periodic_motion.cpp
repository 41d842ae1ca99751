// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/grains/cell/periodic_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/grains/servo_walls.hpp"

namespace equidem {

namespace {

/// Steps after which stiffness and viscosity of a cell under control are measured again.
constexpr std::int64_t steps_between_measures = 16;

double contraction(const Tensor2& a, const Tensor2& b) {
  return a.xx * b.xx + a.xy * b.xy + a.yx * b.yx + a.yy * b.yy;
}

/// Add the part of a contact or a bond in the resistance of the cell: stretched along x, the ends of a branch part by
/// l_x along x.
void add_resistance(Vec2 branch, Vec2 normal, const ContactResistance& of, Vec2& stiffness, Vec2& viscosity) {
  const double xx = normal.x * normal.x, yy = normal.y * normal.y;
  stiffness += Vec2{squared(branch.x) * (of.k_n * xx + of.k_t * yy), squared(branch.y) * (of.k_n * yy + of.k_t * xx)};
  viscosity += Vec2{squared(branch.x) * (of.c_n * xx + of.c_t * yy), squared(branch.y) * (of.c_n * yy + of.c_t * xx)};
}

Periods deformed(const Periods& periods, const Tensor2& gradient, double dt) {
  return {periods.a + dt * (gradient * periods.a), periods.b + dt * (gradient * periods.b)};
}

/// The rate at which the cell is stretched along one axis.
double controlled_rate(const CellServo& servo, const Schedule& stress, double time, double dt, double present,
                       CellControl& control) {
  control.wanted = stress.at(time);
  control.present = present;
  control.count(present != 0, 1);
  const double spring = control.stiffness * dt;
  if (spring + control.viscosity > 0) {
    const double asked = control.asked_rate(servo.relaxation, spring, control.viscosity);
    control.rate = std::clamp(asked, -servo.max_rate, servo.max_rate);
  } else {
    control.rate = control.wanted < 0 ? -servo.max_rate : 0;
  }
  return control.rate;
}

/// Sum the works and moments of all blocks, and those of impulses on images.
CellSums summed(const MovingCell& cell) {
  CellSums all;
  all.here = cell.on_images.moment(cell.now);
  all.before = cell.on_images.moment(cell.before);
  for (const CellSums& sums : cell.sums) {
    all.here += sums.here;
    all.before += sums.before;
    all.flux += sums.flux;
    all.work += sums.work;
  }
  return all;
}

/// Work of the cell on a body whose peculiar velocity u turns to u - h L u.
double turn_velocity(const Tensor2& gradient, double h, double inverse_mass, Vec2& velocity) {
  const Vec2 turned = h * (gradient * velocity);
  const double work = (0.5 * dot(turned, turned) - dot(velocity, turned)) / inverse_mass;
  velocity -= turned;
  return work;
}

/// Sum of force times branch over the contacts, and of m u u over the bodies.
std::pair<Tensor2, Tensor2> sums_of_stress(const GrainSystem& system, std::span<const GrainContact> contacts) {
  Tensor2 forces = moment_of_bonds(system), flux;
  for (const GrainContact& contact : contacts) {
    const Vec2 on_j = contact.normal_force * contact.normal + contact.tangential_force * perpendicular(contact.normal);
    forces += outer(on_j, contact.arm_i - contact.arm_j);
  }
  for (std::size_t k = 0; k < system.bodies.constants.size(); ++k) {
    const Vec2 velocity = system.bodies.motions[k].velocity;
    flux += (1 / system.bodies.constants[k].inverse_mass) * outer(velocity, velocity);
  }
  return {forces, flux};
}

void set_stress(GrainSystem& system, const CellSums& sums) {
  MovingCell& cell = system.cell;
  cell.moment = sums.here;
  cell.stress = (-1 / cell.area()) * ((1 / system.dt()) * sums.here + sums.flux);
}

}  // namespace

void set_cell(GrainSystem& system, const GrainSystem* before) {
  if (!system.scene.cell) return;
  const PeriodicCell& given = *system.scene.cell;
  MovingCell& cell = system.cell;
  cell.active = true;
  cell.deforms = given.deforms();
  cell.now = periods_of(given);
  cell.before = cell.next = cell.now;
  cell.centre = before != nullptr ? before->cell.centre : given.corner + 0.5 * Vec2{given.width, cell.now.b.y};
  cell.sums.resize(system.bodies.blocks.count());
  for (const std::size_t number : system.bodies.grain_of) {
    const Grain& grain = system.scene.grains[number];
    cell.largest_radius = std::max(cell.largest_radius, grain.radius);
    cell.solid += area_of(grain, system.scene.clumps);
  }
  for (GrainMotion& motion : system.bodies.motions) {
    PeriodicImage move = image_inside(cell.now, cell.centre, motion.position);
    motion.position += cell.now.shift(move);
    cell.crossed.push_back({0, -move.b, -move.a});
  }
}

void measure_resistance(GrainSystem& system) {
  Vec2 stiffness, viscosity;
  each_list(system.contacts, [&](const NearList& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      if (!list.touching(p) || list.between == Between::walls) continue;
      if (list.between == Between::discs) {
        const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
        const Vec2 branch = system.branch(partners_of(system, list, p));
        const double distance = norm(branch), overlap = std::max(list.groups[g].reach[k] - distance, 0.0);
        if (!(distance > 0) || (system.cohesion && overlap == 0)) continue;
        const PairLaw law = law_of(system, list, p);
        ContactResistance of =
            resistance_along(system.law(), law.stiffness, list.groups[g].dashpot[k] / system.dt(), overlap);
        if (system.friction) of.k_t = law.tangential_stiffness, of.c_t = list.slips[g].dashpot[k] / system.dt();
        add_resistance(branch, branch / distance, of, stiffness, viscosity);
        continue;
      }
      const ContactState contact = state_of(system, list, p);
      if (system.cohesion && !(contact.overlap > 0)) continue;
      const ContactConstants constants = constants_of(system, contact.i, contact.j);
      add_resistance(system.branch(contact), contact.normal, resistance_of(system, constants, contact.overlap),
                     stiffness, viscosity);
    }
  });
  for (const TiedPair& bond : system.bonds.holding()) {
    const Vec2 branch = branch_of(system, bond);
    const SpringConstants& springs = bond.springs.springs;
    add_resistance(branch, branch / norm(branch),
                   {springs.kN, springs.kT, bond.dashpots.normal, bond.dashpots.tangential}, stiffness, viscosity);
  }
  const double area = system.cell.area();
  CellControl& x = system.cell.controls[0];
  CellControl& y = system.cell.controls[1];
  x.stiffness = stiffness.x / area;
  y.stiffness = stiffness.y / area;
  x.viscosity = viscosity.x / area;
  y.viscosity = viscosity.y / area;
}

void steer_cell(GrainSystem& system) {
  MovingCell& cell = system.cell;
  const PeriodicCell& given = *system.scene.cell;
  const double dt = system.dt(), middle = system.time() + 0.5 * dt;
  if (const double least = std::min(cell.now.a.x, cell.now.b.y); !(least > 4 * cell.largest_radius)) {
    throw Error(ErrorKind::computation_failed,
                fmt::format("step {}: the periodic cell has become {:.4g} m by {:.4g} m", system.step, cell.now.a.x,
                            cell.now.b.y),
                "a body would meet several images of another one",
                "Deform it less, or take more bodies: two of the largest diameters is the least", given.place);
  }
  double xx = given.rate_xx.at(middle), yy = given.rate_yy.at(middle);
  if (given.servo) {
    const CellServo& servo = *given.servo;
    if (system.step % steps_between_measures == 0) measure_resistance(system);
    if (servo.stress_xx)
      xx = controlled_rate(servo, *servo.stress_xx, system.time(), dt, cell.stress.xx, cell.controls[0]);
    if (servo.stress_yy)
      yy = controlled_rate(servo, *servo.stress_yy, system.time(), dt, cell.stress.yy, cell.controls[1]);
  }
  const double shear = given.rate_xy.at(middle);
  // so that a cell at a constant rate is stretched by exp(rate time)
  cell.gradient = {std::expm1(xx * dt) / dt, shear, 0, std::expm1(yy * dt) / dt};
  cell.next = deformed(cell.now, cell.gradient, dt);
  cell.strain.xx += xx * dt;
  cell.strain.yy += yy * dt;
  cell.strain.xy += shear * dt;
}

void drift_in_cell(GrainSystem& system) {
  MovingCell& cell = system.cell;
  const double dt = system.dt();
  const BodyBlocks& blocks = system.bodies.blocks;
  const Tensor2& gradient = cell.gradient;
  // two bodies that touch come nearer by their own ways and by that of the cell along their branch
  const double stretch = std::sqrt(contraction(gradient, gradient));
  const double by_cell = 0.5 * dt * stretch * (2 * cell.largest_radius + system.contacts.skin.margin + system.range);
  const bool near = system.contacts.has(Between::discs);
  find_longest_way(system, [&](std::size_t block) {
    CellSums& sums = cell.sums[block] = {};
    double longest = 0;
    for (std::size_t i = blocks.begin(block); i < blocks.end(block); ++i) {
      const GrainBody& body = system.bodies.constants[i];
      GrainMotion motion = system.bodies.motions[i];
      const Vec2 gain = body.inverse_mass * system.bodies.impulses[i].impulse;
      const double turn = body.inverse_moment * system.bodies.impulses[i].torque;
      motion.velocity += 0.5 * gain;
      motion.spin += 0.5 * turn;
      sums.work += turn_velocity(gradient, 0.5 * dt, body.inverse_mass, motion.velocity);
      const Vec2 with_cell = gradient * (motion.position - cell.centre);
      const double way = dt * norm(motion.velocity) + by_cell;
      motion.position += dt * (motion.velocity + with_cell);
      motion.angle += dt * motion.spin;
      system.bodies.next[i] = motion;
      longest = way * way > longest || way != way ? way * way : longest;
      if (!near) continue;
      GrainMotion seen = motion;
      seen.velocity += with_cell;
      system.contacts.pairs.bodies[i] = pair_body(body, seen, gain, turn);
    }
    return longest;
  });
}

void advance_cell(GrainSystem& system) {
  MovingCell& cell = system.cell;
  cell.before = cell.now;
  cell.now = cell.next;
}

void kick_in_cell(GrainSystem& system) {
  MovingCell& cell = system.cell;
  const BodyBlocks& blocks = system.bodies.blocks;
  blocks.each([&](std::size_t block) {
    CellSums& sums = cell.sums[block];  // with the work of the drift
    for (std::size_t i = blocks.begin(block); i < blocks.end(block); ++i) {
      GrainMotion& motion = system.bodies.motions[i];
      const GrainBody& body = system.bodies.constants[i];
      const Vec2 impulse = system.bodies.impulses[i].impulse;
      // impulse times branch, summed over contacts: times the places of bodies, and the shifts of images
      sums.here += outer(impulse, motion.position - cell.centre);
      sums.before += outer(impulse, system.bodies.next[i].position - cell.centre);
      sums.work += turn_velocity(cell.gradient, 0.5 * system.dt(), body.inverse_mass, motion.velocity);
      motion.velocity += 0.5 * body.inverse_mass * impulse;
      motion.spin += 0.5 * body.inverse_moment * system.bodies.impulses[i].torque;
      sums.flux += (1 / body.inverse_mass) * outer(motion.velocity, motion.velocity);
    }
  });
  const CellSums all = summed(cell);
  // half of each of the kicks at its ends acts along the way of a drift
  const double by_contacts = -0.5 * (contraction(cell.moment, cell.gradient) + contraction(all.before, cell.gradient));
  system.lost.work_of_cell += by_contacts + all.work;
  set_stress(system, all);
}

void begin_cell_stress(GrainSystem& system, std::span<const GrainContact> contacts) {
  const auto [forces, flux] = sums_of_stress(system, contacts);
  CellSums sums;
  sums.here = system.dt() * forces;
  sums.flux = flux;
  set_stress(system, sums);
}

CellState state_of_cell(const GrainSystem& system, std::span<const GrainContact> contacts) {
  const MovingCell& cell = system.cell;
  CellState state;
  state.width = cell.now.a.x;
  state.height = cell.now.b.y;
  state.shift = std::remainder(cell.now.b.x, cell.now.a.x);
  state.strain = cell.strain;
  const auto [forces, flux] = sums_of_stress(system, contacts);
  state.stress = (-1 / cell.area()) * (forces + flux);
  state.void_ratio = cell.area() / cell.solid - 1;
  state.coordination_number = 2 * static_cast<double>(contacts.size() + system.bonds.held) /
                              static_cast<double>(system.bodies.constants.size());
  if (!system.scene.cell->servo) return state;
  const CellServo& servo = *system.scene.cell->servo;
  const auto add = [&](const char* component, const std::optional<Schedule>& stress, double present,
                       const CellControl& control) {
    if (!stress) return;
    CellServoReport& report = state.servos.emplace_back(CellServoReport{control.report(), component});
    report.present = present;
  };
  add("xx", servo.stress_xx, state.stress.xx, cell.controls[0]);
  add("yy", servo.stress_yy, state.stress.yy, cell.controls[1]);
  return state;
}

Periods periods_of(const PeriodicCell& cell) {
  const bool rows = cell.along == PeriodicCell::Along::xy;
  return {{cell.width, 0}, rows ? Vec2{cell.shift, cell.height} : Vec2{}};
}

void wrap_bodies(GrainSystem& system) {
  MovingCell& cell = system.cell;
  const auto columns = static_cast<std::int32_t>(std::nearbyint(cell.now.b.x / cell.now.a.x));
  bool changed = columns != 0;
  if (columns != 0) {
    // the period b less some of a: a multiple of b is the same of the new one, and so many a more
    cell.now.b.x -= columns * cell.now.a.x;
    cell.before.b.x -= columns * cell.before.a.x;
    for (PeriodicImage& crossed : cell.crossed) crossed.a += columns * crossed.b;
  }
  std::vector<PeriodicImage> moves(system.bodies.motions.size());
  for (std::size_t k = 0; k < moves.size(); ++k) {
    Vec2& position = system.bodies.motions[k].position;
    const PeriodicImage move = moves[k] = image_inside(cell.now, cell.centre, position);
    if (move.a == 0 && move.b == 0) continue;
    changed = true;
    position += cell.now.shift(move);
    cell.crossed[k].a -= move.a;
    cell.crossed[k].b -= move.b;
    if (system.contacts.has(Between::discs)) system.contacts.pairs.bodies[k].position = position;
  }
  cell.next = cell.now;
  if (!changed) return;
  move_images_of_bonds(system, columns, moves);
  each_list(system.contacts, [&](NearList& list) {
    for (std::size_t p = 0; p < list.count && list.images.used; ++p) {
      const Partners of = partners_of(system, list, p);
      PairImages& images = list.images[p / lanes_of_pairs];
      images.a[p % lanes_of_pairs] += columns * of.b + moves[of.i].a - moves[of.j].a;
      images.b[p % lanes_of_pairs] += moves[of.i].b - moves[of.j].b;
    }
  });
  find_candidates(system);
}

}  // namespace equidem
