// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/bond_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/move_bodies.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {

BondRest rest_of(const GrainScene& scene, std::size_t i, std::size_t j) {
  const Grain &of_i = scene.grains.at(i), &of_j = scene.grains.at(j);
  Vec2 branch = of_j.position - of_i.position;
  if (scene.cell) {
    const Periods periods = periods_of(*scene.cell);
    branch += periods.shift(image_inside(periods, {}, branch));
  }
  return {branch, of_i.angle, of_j.angle};
}

Vec2 branch_of(const GrainSystem& system, const TiedPair& bond) {
  const Vec2 branch = system.bodies.motions[static_cast<std::size_t>(bond.j)].position -
                      system.bodies.motions[static_cast<std::size_t>(bond.i)].position;
  return system.cell.active ? branch + system.cell.now.shift(bond.image) : branch;
}

void find_images_of_bonds(GrainSystem& system) {
  if (!system.cell.active) return;
  const auto find = [&](std::vector<TiedPair>& bonds) {
    for (TiedPair& bond : bonds) {
      const Vec2 branch = system.bodies.motions[static_cast<std::size_t>(bond.j)].position -
                          system.bodies.motions[static_cast<std::size_t>(bond.i)].position;
      bond.image = image_inside(system.cell.now, {}, branch);
    }
  };
  find(system.bonds.tied);
  if (system.bonds.breakable) find(system.bonds.breakable->all);
}

Tensor2 moment_of_bonds(const GrainSystem& system) {
  Tensor2 sum;
  for (const TiedPair& bond : system.bonds.tied)
    sum += outer((1 / system.dt()) * impulses_of_bond(system, bond)[1].impulse, branch_of(system, bond));
  return sum;
}

namespace {

/// Count the impulse on an image in the moments of a periodic cell (periodic_motion.hpp).
void count_on_image(GrainSystem& system, const TiedPair& bond, Vec2 on_j) {
  MovingCell& cell = system.cell;
  if (!cell.deforms) return;
  cell.bond_sums.here += outer(on_j, cell.now.shift(bond.image));
  cell.bond_sums.before += outer(on_j, cell.before.shift(bond.image));
}

/// Add the impulse of dashpots along the rates of a bond in its frame to those of its bodies.
void give_impulse(GrainSystem& system, const TiedPair& bond, const BondModes& impulse) {
  BodyImpulse& on_i = system.bodies.impulses[static_cast<std::size_t>(bond.i)];
  BodyImpulse& on_j = system.bodies.impulses[static_cast<std::size_t>(bond.j)];
  const Vec2 on = impulse.normal * bond.frame.normal + impulse.tangential * bond.frame.tangent();
  count_on_image(system, bond, on);
  on_i.impulse -= on;
  on_j.impulse += on;
  on_i.torque -= bond.frame.lever_i * impulse.tangential + impulse.rolling;
  on_j.torque -= bond.frame.lever_j * impulse.tangential - impulse.rolling;
}

InverseInertia inverse_of(const Grain& grain) {
  return {1 / grain.inertia.mass, 1 / grain.inertia.moment};
}

InverseInertia inverse_of(const GrainBody& body) {
  return {body.inverse_mass, body.inverse_moment};
}

ContactFrame frame_of(Vec2 branch, double share) {
  const double distance = norm(branch);
  return {branch / distance, share * distance, distance - share * distance};
}

double share_of(const Grain& i, const Grain& j) {
  return i.radius / (i.radius + j.radius);
}

bool is_wide(const GrainSystem& system, const TiedPair& bond) {
  const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
  const double radii = system.bodies.constants[i].radius + system.bodies.constants[j].radius;
  return norm(branch_of(system, bond)) > nearest_centres_of_bonds * radii;
}

/// Springs by where the discs are at the start of the step.
void push_springs(GrainSystem& system) {
  const double dt = system.dt();
  for (const std::size_t b : system.bonds.packed.sprung) {
    const TiedPair& bond = system.bonds.tied[b];
    if (!is_wide(system, bond)) refuse_crept_bonds(system);
    const BondForces<double> force = bond_forces(bond.springs, motion_of_bond(system, bond));
    BodyImpulse& on_i = system.bodies.impulses[static_cast<std::size_t>(bond.i)];
    BodyImpulse& on_j = system.bodies.impulses[static_cast<std::size_t>(bond.j)];
    const Vec2 impulse = dt * Vec2{force.x, force.y};
    on_i.impulse += impulse;
    on_j.impulse -= impulse;
    on_i.torque += dt * force.moment_i;
    on_j.torque += dt * force.moment_j;
    count_on_image(system, bond, -impulse);
  }
}

/// The motion of j against i by that of a deforming cell. \param drifted whether bodies have drifted in this step
Vec2 motion_of_cell(const GrainSystem& system, const TiedPair& bond, bool drifted) {
  const MovingCell& cell = system.cell;
  if (!cell.deforms) return {};
  if (!drifted) return cell.gradient * branch_of(system, bond);
  const std::vector<GrainMotion>& before = system.bodies.next;
  return cell.gradient * (before[static_cast<std::size_t>(bond.j)].position + cell.before.shift(bond.image) -
                          before[static_cast<std::size_t>(bond.i)].position);
}

/// Rates of a bond at the start of the step.
BondModes rates_now(const GrainSystem& system, const TiedPair& bond, bool drifted) {
  const GrainMotion& i = system.bodies.motions[static_cast<std::size_t>(bond.i)];
  const GrainMotion& j = system.bodies.motions[static_cast<std::size_t>(bond.j)];
  return bond_rates(bond.frame, {i.velocity, i.spin}, {j.velocity + motion_of_cell(system, bond, drifted), j.spin});
}

/// Contribution of the present impulses to the rates; gravity has none.
BondModes gain_by_impulses(const GrainSystem& system, const TiedPair& bond) {
  const auto gain = [&](std::int32_t body) {
    const auto b = static_cast<std::size_t>(body);
    return DiscMotion{system.bodies.constants[b].inverse_mass * system.bodies.impulses[b].impulse,
                      system.bodies.constants[b].inverse_moment * system.bodies.impulses[b].torque};
  };
  return bond_rates(bond.frame, gain(bond.i), gain(bond.j));
}

/// One bond after the other, each exact with those before it as they are: what dashpots take, they take from the
/// motion, in whatever number they hang together.
void resist_exactly(GrainSystem& system, TiedPair& bond, const BondModes& inverse) {
  const double dt = system.dt();
  const BondModes &c = bond.dashpots, &v = bond.rate, &g = bond.gained;
  BondModes all = gain_by_impulses(system, bond);
  const auto impulse = [&](double dashpot, double inverse_mass, double rate, double gained, double in_all) {
    if (dashpot == 0) return 0.0;
    return exact_dashpot_change(dashpot * inverse_mass * dt, rate, in_all - gained, gained) / inverse_mass;
  };
  bond.impulse = {impulse(c.normal, inverse.normal, v.normal, g.normal, all.normal),
                  impulse(c.tangential, inverse.tangential, v.tangential, g.tangential, all.tangential), 0};
  give_impulse(system, bond, bond.impulse);
  if (c.rolling == 0) return;
  all = gain_by_impulses(system, bond);  // spin of unequal discs has changed with the tangential impulse
  bond.impulse.rolling = impulse(c.rolling, inverse.rolling, v.rolling, g.rolling, all.rolling);
  give_impulse(system, bond, {0, 0, bond.impulse.rolling});
}

void resist_explicitly(GrainSystem& system, TiedPair& bond, const BondModes& inverse) {
  const double dt = system.dt();
  const auto impulse = [&](double dashpot, double inverse_mass, double rate) {
    return explicit_dashpot_change(dashpot * inverse_mass * dt, rate) / inverse_mass;
  };
  const BondModes &c = bond.dashpots, &v = bond.rate;
  bond.impulse = {impulse(c.normal, inverse.normal, v.normal), impulse(c.tangential, inverse.tangential, v.tangential),
                  impulse(c.rolling, inverse.rolling, v.rolling)};
  give_impulse(system, bond, bond.impulse);
}

/// Energy lost by the motion: impulses times the rates after a share of all impulses has acted.
double loss_of_bonds(const GrainSystem& system, double share) {
  double sum = 0;
  for (const std::size_t b : system.bonds.packed.one_by_one) {
    const TiedPair& bond = system.bonds.tied[b];
    const BondModes gained = gain_by_impulses(system, bond);
    const BondModes &v = bond.rate, &given = bond.impulse;
    sum -= given.normal * (v.normal + share * gained.normal) +
           given.tangential * (v.tangential + share * gained.tangential) +
           given.rolling * (v.rolling + share * gained.rolling);
  }
  return sum;
}

/// The part of a bond in M^-1 C and M^-1 K of its discs.
struct Rates {
  double rate = 0, square = 0;
};

Rates rates_of(const GrainScene& scene, const GrainBond& bond, GrainOptions::BondStep bond_step) {
  const Grain &i = scene.grains[bond.i], &j = scene.grains[bond.j];
  const ContactFrame frame = frame_of((bond.rest ? *bond.rest : rest_of(scene, bond.i, bond.j)).branch, share_of(i, j));
  const auto largest = [&](const BondModes& c) { return largest_bond_rate(c, frame, inverse_of(i), inverse_of(j)); };
  const bool limits = bond_step == GrainOptions::BondStep::explicit_euler;
  return {limits ? largest({bond.normal_dashpot, bond.tangential_dashpot, bond.rolling_dashpot}) : 0.0,
          largest({bond.normal_spring, bond.tangential_spring, bond.bending_spring})};
}

}  // namespace

BondMotion<double> motion_of_bond(const GrainSystem& system, const TiedPair& bond) {
  const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
  const GrainMotion &mi = system.bodies.motions[i], &mj = system.bodies.motions[j];
  const Vec2 way = branch_of(system, bond) - bond.springs.branch;
  return {way.x, way.y, mi.angle - bond.angle_i, mj.angle - bond.angle_j};
}

std::array<BodyImpulse, 2> impulses_of_bond(const GrainSystem& system, const TiedPair& bond) {
  const ContactFrame frame = frame_of(branch_of(system, bond), bond.share);
  const BondModes last = last_impulse(system, bond);
  const BondForces<double> force = bond_forces(bond.springs, motion_of_bond(system, bond));
  const double dt = system.dt();
  const Vec2 on_i = dt * Vec2{force.x, force.y} - last.normal * frame.normal - last.tangential * frame.tangent();
  return {BodyImpulse{on_i, dt * force.moment_i - frame.lever_i * last.tangential - last.rolling},
          BodyImpulse{-on_i, dt * force.moment_j - frame.lever_j * last.tangential + last.rolling}};
}

std::vector<std::size_t> tie_bonds(GrainSystem& system, const GrainScene& scene) {
  std::vector<TiedPair> pairs;
  for (const GrainBond& bond : scene.bonds) {
    TiedPair pair;
    pair.i = system.bodies.place_of_grain[bond.i], pair.j = system.bodies.place_of_grain[bond.j];
    BondRest rest = bond.rest ? *bond.rest : rest_of(scene, bond.i, bond.j);
    if (pair.j < pair.i) {
      std::swap(pair.i, pair.j);
      rest = {-rest.branch, rest.angle_j, rest.angle_i};
    }
    const Grain& i = system.scene.grains[static_cast<std::size_t>(pair.i)];
    const Grain& j = system.scene.grains[static_cast<std::size_t>(pair.j)];
    pair.dashpots = {bond.normal_dashpot, bond.tangential_dashpot, bond.rolling_dashpot};
    pair.share = share_of(i, j);
    pair.angle_i = rest.angle_i, pair.angle_j = rest.angle_j;
    const ContactFrame frame = frame_of(rest.branch, pair.share);
    pair.springs = {rest.branch,
                    frame.lever_i,
                    frame.lever_j,
                    {.kN = bond.normal_spring, .kT = bond.tangential_spring},
                    bond.bending_spring};
    pairs.push_back(pair);
  }
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t bond) { return std::pair(pairs[bond].i, pairs[bond].j); });
  for (const std::size_t bond : order) system.bonds.tied.push_back(pairs[bond]);
  find_images_of_bonds(system);
  return order;
}

void refuse_crept_bonds(const GrainSystem& system) {
  for (const TiedPair& bond : system.bonds.tied) {
    if (is_wide(system, bond)) continue;
    computation_failed(fmt::format("step {}: the centres of the bonded grains {} and {} have crept together",
                                   system.step, system.bodies.grain_of[static_cast<std::size_t>(bond.i)],
                                   system.bodies.grain_of[static_cast<std::size_t>(bond.j)]),
                       "dashpots alone give way to a steady force, N/C_n, and bonded discs do not collide",
                       "Use larger dashpots, give normal_spring, or tie the discs as a clump");
  }
}

void add_bond_impulses(GrainSystem& system) {
  system.free_flight = false;
  system.cell.bond_sums = {};
  push_springs(system);
  push_packed_bonds(system);
  const bool turns_rims = system.contacts.near.active && system.friction;
  for (const std::size_t b : system.bonds.packed.one_by_one) {
    TiedPair& bond = system.bonds.tied[b];
    const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
    if (!is_wide(system, bond)) refuse_crept_bonds(system);
    if (turns_rims) {  // what others do to the spin is asked for
      turn_rims(system.bodies.impulses[i], system.bodies.constants[i]);
      turn_rims(system.bodies.impulses[j], system.bodies.constants[j]);
    }
    bond.frame = frame_of(branch_of(system, bond), bond.share);
    bond.rate = rates_now(system, bond, true);
    bond.gained = gain_by_impulses(system, bond);
  }
  const auto resist = system.options.bond_step == GrainOptions::BondStep::exact ? resist_exactly : resist_explicitly;
  for (const std::size_t b : system.bonds.packed.one_by_one) {
    TiedPair& bond = system.bonds.tied[b];
    resist(system, bond,
           bond_inverse_masses(bond.frame, inverse_of(system.bodies.constants[static_cast<std::size_t>(bond.i)]),
                               inverse_of(system.bodies.constants[static_cast<std::size_t>(bond.j)])));
  }
  system.lost.lost_bond += system.options.verlet() ? 0.5 * loss_of_bonds(system, 0.25) : loss_of_bonds(system, 0.5);
}

void count_opening_kick(GrainSystem& system) {
  count_opening_kick_of_packed_bonds(system);
  for (const std::size_t b : system.bonds.packed.one_by_one) {
    TiedPair& bond = system.bonds.tied[b];
    bond.frame = frame_of(branch_of(system, bond), bond.share);
    bond.rate = rates_now(system, bond, false);
  }
  system.lost.lost_bond += 0.5 * loss_of_bonds(system, 0.25);
}

double elastic_of_bonds(const GrainSystem& system) {
  double sum = 0;
  for (const TiedPair& bond : system.bonds.tied) {
    if (bond.has_springs()) sum += bond_energy(bond.springs, motion_of_bond(system, bond));
  }
  return sum;
}

std::vector<BodyContact> contacts_of_bonds(const GrainSystem& system) {
  std::vector<BodyContact> result;
  for (const TiedPair& bond : system.bonds.tied) {
    const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
    const ContactFrame frame = frame_of(branch_of(system, bond), bond.share);
    const Vec2 shift = system.cell.active ? system.cell.now.shift(bond.image) : Vec2{};
    const BondModes impulse = last_impulse(system, bond);
    Vec2 on_i = -1 / system.dt() * (impulse.normal * frame.normal + impulse.tangential * frame.tangent());
    double bending = 0;
    if (bond.has_springs()) {
      const BondMotion<double> motion = motion_of_bond(system, bond);
      const BondForces<double> springs = bond_forces(bond.springs, motion);
      on_i += {springs.x, springs.y};
      bending = bending_moment(bond.springs.kM, motion.theta_i, motion.theta_j);
    }
    const bool same = system.bodies.grain_of[i] < system.bodies.grain_of[j];
    const auto first = static_cast<std::int32_t>(system.bodies.grain_of[same ? i : j]),
               second = static_cast<std::int32_t>(system.bodies.grain_of[same ? j : i]);
    result.push_back({.i = first,
                      .j = second,
                      .arm = same ? frame.lever_i * frame.normal : -frame.lever_j * frame.normal,
                      .shift = same ? shift : -shift,
                      .force = same ? on_i : -on_i,
                      .normal_force = -dot(on_i, frame.normal),
                      .tangential_force = -dot(on_i, frame.tangent()),
                      .bending_moment = same ? bending : -bending});
  }
  std::ranges::sort(result, {}, [](const BodyContact& c) { return std::pair(c.i, c.j); });
  return result;
}

double bond_step_limit(const GrainScene& scene, GrainOptions::BondStep bond_step) {
  std::vector<Rates> of_grain(scene.grains.size());
  Rates largest;
  for (const GrainBond& bond : scene.bonds) {
    const Rates own = rates_of(scene, bond, bond_step);
    for (const std::size_t grain : {bond.i, bond.j}) {
      Rates& sum = of_grain[grain];
      sum = {sum.rate + own.rate, sum.square + own.square};
      largest = {std::max(largest.rate, sum.rate), std::max(largest.square, sum.square)};
    }
  }
  return bond_step_limit(largest.rate, largest.square);
}

void check_law_of_bonds(const GrainScene& scene, NormalLaw law) {
  if (is_simultaneous(law)) {
    bad_input(fmt::format("bonds are asked for with the law \"{}\"", to_string(law)),
              "it solves all contacts together and knows no bonds", "Use the law linear_dashpot");
  }
  if (scene.strengths && !gives_force(law)) {
    bad_input(fmt::format("bonds that break are asked for with the law \"{}\"", to_string(law)),
              "the discs of a bond that broke may overlap, and the law takes them for an impact",
              "Use the law linear_dashpot");
  }
}

void check_bonds(const GrainScene& scene, const GrainOptions& options) {
  if (scene.bonds.empty()) return;
  check_law_of_bonds(scene, options.law);
  check_bonds(scene);
  const double limit = bond_step_limit(scene, options.bond_step);
  if (options.time_step < limit) return;
  bad_input(fmt::format("the step of {:.6g} s is {:.4g} times the limit of {:.6g} s that the bonds impose",
                        options.time_step, options.time_step / limit, limit),
            "bonded discs would swing ever faster",
            bond_step_limit(scene, GrainOptions::BondStep::exact) > options.time_step
                ? "Stay below it, use smaller dashpots, or make the step of bonds exact, which dashpots do not limit"
                : "Stay below it, or use smaller springs");
}

}  // namespace equidem
