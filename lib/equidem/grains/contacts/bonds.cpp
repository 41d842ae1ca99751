// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/bonds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/grains/grain_system.hpp"

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
  const Vec2 branch = system.bodies.motions[bond.j].position - system.bodies.motions[bond.i].position;
  return system.cell.active ? branch + system.cell.now.shift(bond.image) : branch;
}

void move_images_of_bonds(GrainSystem& system, std::int32_t columns, const std::vector<PeriodicImage>& moves) {
  for (TiedPair& bond : system.bonds.tied) {
    bond.image.a += columns * bond.image.b + moves[bond.i].a - moves[bond.j].a;
    bond.image.b += moves[bond.i].b - moves[bond.j].b;
  }
  pack_images(system);
  system.bonds.packed.state_is_new = true;
}

BondState state_of(const GrainSystem& system, const TiedPair& bond) {
  return {bond.image, last_impulse(system, bond)};
}

void take_states(GrainSystem& system, const std::vector<BondState>& states) {
  std::vector<TiedPair>& tied = system.bonds.tied;
  for (std::size_t b = 0; b < tied.size(); ++b) {
    tied[b].image = states[b].image;
    take_last_impulse(system, tied[b], states[b].impulse);
  }
  pack_images(system);
  system.bonds.packed.state_is_new = true;
}

Tensor2 moment_of_bonds(const GrainSystem& system) {
  Tensor2 sum;
  for (const TiedPair& bond : system.bonds.holding())
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
/// \throws Error (computation_failed) if centres of bonded discs nearly coincide
void step_batches(GrainSystem& system, PackedBonds::Loop loop) {
  PackedBonds& packed = system.bonds.packed;
  for (std::size_t phase = 0; phase < PackedBonds::phases; ++phase) {
    const std::size_t first = packed.first_batch[phase];
    parallel_shares(packed.first_batch[phase + 1] - first,
                    [&](std::size_t k, int) { loop(system, packed.batches[first + k]); });
  }
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
    if (!scene.ties(bond)) continue;
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

void tie_bonds(GrainSystem& system, const GrainScene& scene) {
  std::vector<TiedPair>& tied = system.bonds.tied;
  for (std::size_t b = 0; b < scene.bonds.size(); ++b) {
    const GrainBond& bond = scene.bonds[b];
    if (!scene.ties(bond)) continue;
    TiedPair& pair = tied.emplace_back();
    pair.number = b;
    pair.i = system.bodies.place_of_grain[bond.i], pair.j = system.bodies.place_of_grain[bond.j];
    BondRest rest = bond.rest ? *bond.rest : rest_of(scene, bond.i, bond.j);
    if (pair.j < pair.i) {
      std::swap(pair.i, pair.j);
      rest = {-rest.branch, rest.angle_j, rest.angle_i};
    }
    pair.dashpots = {bond.normal_dashpot, bond.tangential_dashpot, bond.rolling_dashpot};
    pair.share = share_of(system.grain(pair.i), system.grain(pair.j));
    pair.angle_i = rest.angle_i, pair.angle_j = rest.angle_j;
    const ContactFrame frame = frame_of(rest.branch, pair.share);
    pair.springs = {rest.branch,
                    frame.lever_i,
                    frame.lever_j,
                    {.kN = bond.normal_spring, .kT = bond.tangential_spring},
                    bond.bending_spring};
    if (scene.strengths) pair.tension = scene.strengths->tension[b], pair.shear = scene.strengths->shear[b];
  }
  std::ranges::sort(tied, {}, [](const TiedPair& bond) { return std::pair(bond.i, bond.j); });
  system.bonds.held = tied.size();
  system.bonds.breakable = scene.strengths.has_value();
  if (scene.strengths) system.bonds.friction = scene.strengths->friction;
  if (scene.strengths) system.bonds.beside_contact = scene.strengths->beside_contact;
  if (!system.cell.active) return;
  for (TiedPair& bond : tied) bond.image = image_inside(system.cell.now, {}, branch_of(system, bond));
}

void refuse_crept_bonds(const GrainSystem& system) {
  for (const TiedPair& bond : system.bonds.holding()) {
    if (is_wide(system, bond)) continue;
    computation_failed(fmt::format("step {}: the centres of the bonded grains {} and {} have crept together",
                                   system.step, system.bodies.grain_of[bond.i], system.bodies.grain_of[bond.j]),
                       "dashpots alone creep under a steady force, N/C_n, and bonded discs do not collide",
                       "Use larger dashpots, give normal_spring, or tie the discs as a clump");
  }
}

void push_springs(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  for (BondBatch& batch : packed.batches) {
    batch.on_images = {};
    batch.reached.clear();
  }
  packed.state_is_new = false;
  if (packed.stretch) step_batches(system, packed.stretch);
}

void add_bond_impulses(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  if (packed.resist) {
    step_batches(system, packed.resist);
    count_losses(system);
  }
  parallel_shares(packed.first_batch[1], [&](std::size_t k, int) {
    const BondBatch& batch = packed.batches[k];
    for (std::size_t n = batch.first_body; n < batch.end_body; ++n) {
      const std::int32_t body = packed.bodies[n];
      BodyImpulse& sum = system.bodies.impulses[body];
      if (packed.resist) {
        const double* given = packed.bonded[body].given;
        sum.impulse += {given[0], given[1]};
        sum.torque += given[2];
      } else {
        sum.impulse += packed.by_springs[body].impulse;
        sum.torque += packed.by_springs[body].torque;
      }
    }
  });
  for (const BondBatch& batch : packed.batches) system.cell.on_images += batch.on_images;
}

void count_opening_kick(GrainSystem& system) {
  PackedBonds& packed = system.bonds.packed;
  if (!packed.count_opening || system.bonds.held == 0) return;
  step_batches(system, packed.count_opening);
  count_losses(system);
}

double elastic_of_bonds(const GrainSystem& system) {
  double sum = 0;
  for (const TiedPair& bond : system.bonds.holding()) {
    if (bond.has_springs()) sum += bond_energy(bond.springs, motion_of_bond(system, bond));
  }
  return sum;
}

std::vector<BodyContact> contacts_of_bonds(const GrainSystem& system) {
  std::vector<BodyContact> result;
  for (const TiedPair& bond : system.bonds.holding()) {
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
                      .normal_force = dot(on_i, frame.normal),
                      .tangential_force = dot(on_i, frame.tangent()),
                      .bending_moment = same ? bending : -bending});
  }
  std::ranges::sort(result, {}, [](const BodyContact& c) { return std::pair(c.i, c.j); });
  return result;
}

double bond_step_limit(const GrainScene& scene, GrainOptions::BondStep bond_step) {
  if (bond_step == GrainOptions::BondStep::explicit_euler) return explicit_step_limit(scene);
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
  const double limit = bond_step_limit(scene, options.bond_step);
  if (options.time_step < limit) return;
  bad_input(fmt::format("the step of {:.6g} s is {:.4g} times the limit of {:.6g} s that the bonds impose",
                        options.time_step, options.time_step / limit, limit),
            "bonded discs would swing ever faster",
            bond_step_limit(scene, GrainOptions::BondStep::exact) > options.time_step
                ? "Stay below it, use smaller dashpots, or make the step of bonds exact, which dashpots do not limit"
                : "Stay below it, or use smaller springs");
}

namespace {

/// Load over strength; a bond without strength breaks under any load.
double share_of_strength(double load, double strength) {
  if (strength > 0) return load / strength;
  return load >= strength ? std::numeric_limits<double>::infinity() : 0;
}

/// The place of the bond as far as the levers say, between both centres.
Vec2 place_of(const GrainSystem& system, const TiedPair& bond) {
  return system.bodies.motions[bond.i].position + bond.share * branch_of(system, bond);
}

/// The bodies of a bond as a contact that begins now; one beside the bond is there before, and nothing begins.
struct NewContact {
  double stiffness = 0, overlap = 0;
  double attraction = 0;  ///< N
};

NewContact contact_of(const GrainSystem& system, const TiedPair& bond) {
  const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
  const double overlap =
      system.bodies.constants[i].radius + system.bodies.constants[j].radius - norm(branch_of(system, bond));
  const double stiffness = constants_of(system, bond.i, bond.j).stiffness;
  const EffectConstants effects = effects_between(system, bond.i, bond.j, stiffness);
  return {stiffness, std::max(overlap, 0.0), overlap > -effects.range ? effects.attraction : 0};
}

/// Verlet schemes kick bodies at the start of a step by the impulses of the last one: those of a bond that has broken
/// give way to that of the spring behind it, so that both half kicks of the step are of the same contact.
void replace_impulses(GrainSystem& system, const TiedPair& bond, const NewContact& contact) {
  const auto i = static_cast<std::size_t>(bond.i), j = static_cast<std::size_t>(bond.j);
  const Vec2 branch = branch_of(system, bond);
  const double force = contact.stiffness * std::pow(contact.overlap, system.law().spring_power) - contact.attraction;
  const Vec2 push = system.dt() * force / norm(branch) * branch;
  const auto [of_i, of_j] = impulses_of_bond(system, bond);
  BodyImpulse &on_i = system.bodies.impulses[i], &on_j = system.bodies.impulses[j];
  on_i.impulse -= of_i.impulse + push;
  on_j.impulse -= of_j.impulse - push;
  on_i.torque -= of_i.torque;
  on_j.torque -= of_j.torque;
}

void set_broken(GrainSystem& system, TiedPair& bond, bool broken) {
  if (bond.broken == broken) return;
  bond.broken = broken;
  broken ? --system.bonds.held : ++system.bonds.held;
  pack_again(system, bond);
}

/// Places in BondList::tied of bonds that may have reached their strength, ascending.
std::vector<std::size_t> suspects_of(const GrainSystem& system) {
  const PackedBonds& packed = system.bonds.packed;
  std::vector<std::size_t> suspects;
  if (packed.state_is_new) {
    suspects.resize(system.bonds.tied.size());
    std::iota(suspects.begin(), suspects.end(), std::size_t{0});
    return suspects;
  }
  for (const BondBatch& batch : packed.batches)
    for (const std::size_t group : batch.reached)
      for (const std::int32_t bond : packed.lanes[group])
        if (bond >= 0) suspects.push_back(static_cast<std::size_t>(bond));
  std::ranges::sort(suspects);
  return suspects;
}

}  // namespace

ContactStrengths bond_strengths(const GrainScene& scene, const StrengthOptions& options) {
  for (const GrainBond& bond : scene.bonds) {
    if (std::max(bond.i, bond.j) < scene.grains.size()) continue;
    bad_input(fmt::format("a bond ties grain {}", std::max(bond.i, bond.j)),
              fmt::format("there are {}, counted from 0", counted(std::ssize(scene.grains), "grain")),
              "Correct the number");
  }
  Assembly network;
  for (const Grain& grain : scene.grains) network.radii.push_back(grain.radius);
  for (const GrainBond& bond : scene.bonds)
    network.contacts.push_back({.i = static_cast<std::int32_t>(bond.i), .j = static_cast<std::int32_t>(bond.j)});
  return contact_strengths(network, options);
}

double moment_to_force(const SpringConstants& k, double kM) {
  return kM > 0 ? 6 / std::sqrt(12 * kM / k.kN) : 0;
}

std::optional<BreakMode> break_of(const SpringConstants& k, double kM, const ContactForce& force, double moment,
                                  double tension, double shear, double friction) {
  const double by_moment = moment_to_force(k, kM) * std::abs(moment);
  if (force.normal == 0 && force.tangential == 0 && by_moment == 0) return {};
  const double pulled = share_of_strength(force.normal + by_moment, tension);
  const double sheared = share_of_strength(std::abs(force.tangential), shear - friction * force.normal);
  if (std::max(pulled, sheared) < 1) return {};
  if (sheared > pulled) return BreakMode::shear;
  return by_moment > force.normal ? BreakMode::bending : BreakMode::tension;
}

bool break_bonds(GrainSystem& system) {
  BondList& bonds = system.bonds;
  std::vector<std::size_t> blocks;  // of bodies that have a partner more
  for (const std::size_t suspect : suspects_of(system)) {
    TiedPair& bond = bonds.tied[suspect];
    if (bond.broken) continue;
    const BondMotion<double> motion = motion_of_bond(system, bond);
    const ContactForce force = linear_spring_force(bond.springs.springs, bond_deformation(bond.springs, motion));
    const double moment = bending_moment(bond.springs.kM, motion.theta_i, motion.theta_j);
    const std::optional<BreakMode> mode =
        break_of(bond.springs.springs, bond.springs.kM, force, moment, bond.tension, bond.shear, bonds.friction);
    if (!mode) continue;
    const double energy = bond_energy(bond.springs, motion);
    bonds.breaks.push_back({system.step, bond.number, *mode, place_of(system, bond), energy});
    const NewContact contact = bonds.beside_contact ? NewContact{} : contact_of(system, bond);
    system.lost.lost_breaking += energy - system.law().energy(contact.stiffness, contact.overlap);
    if (system.options.verlet()) replace_impulses(system, bond, contact);
    set_broken(system, bond, true);
    blocks.push_back(system.bodies.blocks.of(static_cast<std::size_t>(bond.i)));
  }
  if (blocks.empty()) return false;
  find_near_pairs_of(system, std::move(blocks));
  return true;
}

void check_breaks(const GrainSystem& system, const std::vector<BondBreak>& breaks) {
  const std::size_t bonds = system.bonds.breakable ? system.scene.bonds.size() : 0;
  std::vector<char> broken(bonds, 0);
  for (const BondBreak& event : breaks) {
    if (event.bond < bonds && std::exchange(broken[event.bond], char{1}) == 0) continue;
    bad_input(fmt::format("the state has a break of bond {} at step {}", event.bond, event.step),
              event.bond < bonds ? "it has broken before"
                                 : fmt::format("the scene has {}", counted(static_cast<long long>(bonds), "bond")),
              "Resume with the scene that the state was saved from");
  }
}

void restore_breaks(GrainSystem& system, std::vector<BondBreak> breaks) {
  BondList& bonds = system.bonds;
  bonds.breaks = std::move(breaks);
  std::vector<char> broken(system.scene.bonds.size(), 0);
  for (const BondBreak& event : bonds.breaks) broken[event.bond] = 1;
  for (TiedPair& bond : bonds.tied) set_broken(system, bond, broken[bond.number] != 0);
}

}  // namespace equidem
