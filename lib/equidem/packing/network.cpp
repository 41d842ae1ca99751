// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/network.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem {
namespace {

/// The disc behind a wall that a disc touches in the wall.
Vec2 mirrored(Vec2 centre, int wall, Vec2 box) {
  switch (wall) {
    case 0:
      return {centre.x, -centre.y};
    case 1:
      return {-centre.x, centre.y};
    case 2:
      return {2 * box.x - centre.x, centre.y};
    default:
      return {centre.x, 2 * box.y - centre.y};
  }
}

void add_contact(Assembly& assembly, const PackingContact& found, std::int32_t j, const SpringConstants& springs) {
  Contact contact{.i = found.i, .j = j, .shift_x = found.shift_x, .shift_y = found.shift_y};
  const double distance = norm(assembly.branch(contact));
  const double ri = assembly.radii[static_cast<std::size_t>(contact.i)];
  contact.lever_i = distance * ri / (ri + assembly.radii[static_cast<std::size_t>(j)]);
  contact.lever_j = distance - contact.lever_i;
  assembly.contacts.push_back(contact);
  assembly.contact_kN.push_back(springs.kN);
  assembly.contact_kT.push_back(springs.kT);
}

/// Force and moment that a disc lacks to be in balance.
struct Lack {
  Vec2 force;
  double moment = 0;
};

std::vector<Lack> lacks_of(const GrainPacking& packing, double gravity) {
  std::vector<Lack> lacks(packing.size());
  for (std::size_t k = 0; k < lacks.size(); ++k) lacks[k].force.y = -packing.grains[k].inertia.mass * gravity;
  for (const GrainContact& contact : packing.contacts) {
    const auto i = static_cast<std::size_t>(contact.i);
    const Vec2 on_j = contact.normal_force * contact.normal + contact.tangential_force * perpendicular(contact.normal);
    const double ri = packing.radii[i];
    lacks[i].force -= on_j;
    double lever = ri;
    if (contact.j >= 0) {
      const auto j = static_cast<std::size_t>(contact.j);
      const double distance = norm(packing.grains[j].position - packing.grains[i].position);
      lever = distance * ri / (ri + packing.radii[j]);
      lacks[j].force += on_j;
      lacks[j].moment -= (distance - lever) * contact.tangential_force;
    }
    lacks[i].moment -= lever * contact.tangential_force;
  }
  return lacks;
}

/// Which discs are left once those with fewer than two contacts are taken out, one after the other.
std::vector<char> held_by_two(const std::vector<PackingContact>& contacts, std::size_t discs) {
  std::vector<std::vector<std::int32_t>> partners(discs);
  for (const PackingContact& c : contacts) {
    partners[static_cast<std::size_t>(c.i)].push_back(c.j);
    if (c.j >= 0) partners[static_cast<std::size_t>(c.j)].push_back(c.i);
  }
  std::vector<std::size_t> left(discs);
  std::vector<std::size_t> loose;
  for (std::size_t k = 0; k < discs; ++k) {
    left[k] = partners[k].size();
    if (left[k] < 2) loose.push_back(k);
  }
  std::vector<char> held(discs, 1);
  while (!loose.empty()) {
    const std::size_t k = loose.back();
    loose.pop_back();
    held[k] = 0;
    for (const std::int32_t other : partners[k]) {
      const auto j = static_cast<std::size_t>(other);
      if (other >= 0 && held[j] && --left[j] == 1) loose.push_back(j);
    }
  }
  return held;
}

}  // namespace

void check_network(const GrainPacking& packing) {
  if (packing.shape == PackingShape::Kind::disc) return;
  bad_input(format("contacts of {}s make no network for statics", noun_of(packing.shape)),
            packing.shape == PackingShape::Kind::bonded_pair
                ? "dashpots tie them, and at rest these carry nothing"
                : "their contacts lie off the line of their centres, and statics knows contacts of discs only",
            "Pack discs for homogenize, calibrate, stability and solve");
}

Assembly network_of(const GrainPacking& packing, const SpringConstants& springs) {
  check_network(packing);
  Assembly assembly;
  assembly.kind = "packing";
  for (const Grain& grain : packing.grains) assembly.centres.push_back(grain.position);
  assembly.radii = packing.radii;
  if (packing.box.periodic()) assembly.period = packing.box.size;
  for (const PackingContact& found : contacts_of(packing))
    if (found.j >= 0) add_contact(assembly, found, found.j, springs);
  return assembly;
}

HeldNetwork held_network_of(const GrainPacking& packing, const SpringConstants& springs) {
  check_network(packing);
  const auto contacts = contacts_of(packing);
  const std::vector<char> held = held_by_two(contacts, packing.size());
  HeldNetwork result;
  Assembly& assembly = result.assembly;
  assembly.kind = "packing";
  std::vector<std::int32_t> number(packing.size(), -1);
  for (std::size_t k = 0; k < packing.size(); ++k) {
    if (!held[k]) continue;
    number[k] = static_cast<std::int32_t>(assembly.size());
    assembly.centres.push_back(packing.grains[k].position);
    assembly.radii.push_back(packing.radii[k]);
    result.discs.push_back(static_cast<std::int32_t>(k));
  }
  DiscGroup walls;
  for (PackingContact found : contacts) {
    const auto i = static_cast<std::size_t>(found.i);
    if (!held[i] || (found.j >= 0 && !held[static_cast<std::size_t>(found.j)])) continue;
    found.i = number[i];
    if (found.j >= 0) {
      add_contact(assembly, found, number[static_cast<std::size_t>(found.j)], springs);
      continue;
    }
    walls.discs.push_back(static_cast<std::int32_t>(assembly.size()));
    assembly.centres.push_back(mirrored(packing.grains[i].position, ~found.j, packing.box.size));
    assembly.radii.push_back(packing.radii[i]);
    add_contact(assembly, found, walls.discs.back(), springs);
  }
  if (!walls.discs.empty()) assembly.groups["walls"] = walls;
  return result;
}

RestConfirmation confirm_rest(const GrainPacking& packing, const SettlingOptions& options) {
  check_network(packing);
  const std::vector<Lack> lacks = lacks_of(packing, options.gravity);
  HeldNetwork network = held_network_of(packing, options.springs);
  RestConfirmation result;
  result.left_out = static_cast<std::int64_t>(packing.size() - network.discs.size());
  for (const GrainContact& contact : packing.contacts)
    result.mean_overlap += contact.overlap / static_cast<double>(packing.contacts.size());
  LoadCase loads;
  for (std::size_t k = 0; k < network.discs.size(); ++k) {
    const Lack& lack = lacks[static_cast<std::size_t>(network.discs[k])];
    const std::string name = format("disc{}", k);
    network.assembly.groups[name] = {{static_cast<std::int32_t>(k)}, {}};
    loads.push_back({.group = name, .force = lack.force, .moment = lack.moment});
  }
  // Without tangential springs nothing turns.
  const bool turns = options.springs.kT > 0;
  if (!turns)
    for (Load& load : loads) load.moment = 0;
  const std::vector<Support> held{
      {.group = "walls", .ux = 0.0, .uy = 0.0, .rotation = turns ? std::optional(0.0) : std::nullopt}};
  const Equilibrium found = solve_equilibrium(network.assembly, ContactSprings(options.springs), held, loads);
  for (const DiscMotion& motion : found.motions)
    result.largest_motion = std::max(result.largest_motion, norm(motion.u));
  result.residual = found.relative_residual;
  return result;
}

}  // namespace equidem
