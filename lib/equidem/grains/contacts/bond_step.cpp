// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/bond_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/contacts/pack_bonds.hpp"
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
  pack_images(system);
  system.bonds.packed.state_is_new = true;
}

Tensor2 moment_of_bonds(const GrainSystem& system) {
  Tensor2 sum;
  for (const TiedPair& bond : system.bonds.tied)
    sum += outer((1 / system.dt()) * impulses_of_bond(system, bond)[1].impulse, branch_of(system, bond));
  return sum;
}

namespace {

InverseInertia inverse_of(const Grain& grain) {
  return {1 / grain.inertia.mass, 1 / grain.inertia.moment};
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

/// Step the batches of each phase on all threads, one phase after the other.
template <class Work>
void each_batch(PackedBonds& packed, const Work& work) {
  for (std::size_t phase = 0; phase < PackedBonds::phases; ++phase) {
    const std::size_t first = packed.first_batch[phase];
    parallel_shares(packed.first_batch[phase + 1] - first,
                    [&](std::size_t k, int) { work(packed.batches[first + k]); });
  }
}

/// Call work(body) for the bonded bodies of each block, on all threads.
template <class Work>
void each_bonded_body(PackedBonds& packed, const Work& work) {
  parallel_shares(packed.first_batch[1], [&](std::size_t k, int) {
    const BondBatch& batch = packed.batches[k];
    for (std::size_t n = batch.first_body; n < batch.end_body; ++n) work(static_cast<std::size_t>(packed.bodies[n]));
  });
}

/// Step all batches by a loop. \throws Error (computation_failed) if centres of bonded discs nearly coincide
void step_batches(GrainSystem& system, PackedBonds::Loop loop) {
  PackedBonds& packed = system.bonds.packed;
  each_batch(packed, [&](BondBatch& batch) { loop(system, batch); });
  for (const BondBatch& batch : packed.batches)
    if (batch.nearest <= nearest_centres_of_bonds) return refuse_crept_bonds(system);
}

void count_losses(GrainSystem& system) {
  for (const BondBatch& batch : system.bonds.packed.batches) system.lost.lost_bond += batch.lost;
}

/// The part of a bond in M^-1 C and M^-1 K of its discs.
struct Rates {
  double rate = 0, square = 0;
};

Rates rates_of(const GrainScene& scene, const GrainBond& bond) {
  const Grain &i = scene.grains[bond.i], &j = scene.grains[bond.j];
  const ContactFrame frame = frame_of((bond.rest ? *bond.rest : rest_of(scene, bond.i, bond.j)).branch, share_of(i, j));
  const auto largest = [&](const BondModes& c) { return largest_bond_rate(c, frame, inverse_of(i), inverse_of(j)); };
  return {largest({bond.normal_dashpot, bond.tangential_dashpot, bond.rolling_dashpot}),
          largest({bond.normal_spring, bond.tangential_spring, bond.bending_spring})};
}

/// Largest sums of the rates at a disc.
Rates largest_rates(const GrainScene& scene) {
  std::vector<Rates> of_grain(scene.grains.size());
  Rates largest;
  for (const GrainBond& bond : scene.bonds) {
    const Rates own = rates_of(scene, bond);
    for (const std::size_t grain : {bond.i, bond.j}) {
      Rates& sum = of_grain[grain];
      sum = {sum.rate + own.rate, sum.square + own.square};
      largest = {std::max(largest.rate, sum.rate), std::max(largest.square, sum.square)};
    }
  }
  return largest;
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

void push_springs(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  for (BondBatch& batch : packed.batches) {
    batch.here = batch.before = {};
    batch.reached.clear();
  }
  packed.state_is_new = false;
  if (packed.stretch) step_batches(system, packed.stretch);
}

void add_bond_impulses(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  std::vector<BodyImpulse>& impulses = system.bodies.impulses;
  system.free_flight = false;
  if (packed.resist) {
    packed.drifted = true;
    step_batches(system, packed.resist);
    each_bonded_body(packed, [&](std::size_t body) {
      const double* given = packed.bonded[body].given;
      impulses[body].impulse += {given[0], given[1]};
      impulses[body].torque += given[2];
    });
    count_losses(system);
  } else {
    each_bonded_body(packed, [&](std::size_t body) {
      impulses[body].impulse += packed.by_springs[body].impulse;
      impulses[body].torque += packed.by_springs[body].torque;
    });
  }
  for (const BondBatch& batch : packed.batches) {
    system.cell.bond_sums.here += batch.here;
    system.cell.bond_sums.before += batch.before;
  }
}

void count_opening_kick(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  if (!packed.count_opening) return;
  packed.drifted = false;
  step_batches(system, packed.count_opening);
  count_losses(system);
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

double bond_step_limit(const GrainScene& scene) {
  return bond_step_limit(0, largest_rates(scene).square);
}

double explicit_step_limit(const GrainScene& scene) {
  const Rates largest = largest_rates(scene);
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
  const double limit = bond_step_limit(scene);
  if (options.time_step < limit) return;
  bad_input(fmt::format("the step of {:.6g} s is {:.4g} times the limit of {:.6g} s that the bonds impose",
                        options.time_step, options.time_step / limit, limit),
            "bonded discs would swing ever faster", "Stay below it, or use smaller springs");
}

}  // namespace equidem
