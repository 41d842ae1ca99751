// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/bond_breaking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {
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

/// The bodies of a bond as a contact that begins now.
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
    const NewContact contact = contact_of(system, bond);
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
