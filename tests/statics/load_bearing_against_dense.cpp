// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts that load_bearing_network leaves out carry no force, and the others carry the same force as before:
/// against dense solutions of random networks. Self-stresses against dense ranks.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/random.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "statics/random_networks.hpp"
#include "statics/semidefinite_factor.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A network and what holds it.
struct Network {
  Assembly assembly;
  ContactSprings springs{SpringConstants{}};
  Rotation rotation = Rotation::from_scene;
  std::vector<std::uint8_t> held;

  [[nodiscard]] Effects effects() const { return derive_effects(springs, rotation); }
  [[nodiscard]] LoadBearingNetwork load_bearing() const {
    return load_bearing_network(assembly, springs, effects(), held);
  }
};

/// Stretch and slip of all contacts, and behind them the relative rotation of those that bend, as rows over (u_x, u_y,
/// theta) of all discs, straight from the contact law.
struct Compatibility {
  LongMatrix rows;
  Vector stiffness;        ///< per row
  std::vector<bool> free;  ///< per component

  Compatibility(const Assembly& assembly, const ContactSprings& springs, bool rotation,
                const std::vector<std::uint8_t>& held) {
    free.assign(3 * assembly.size(), true);
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      free[3 * d] = free[3 * d + 1] = held.empty() || held[d] == 0;
      free[3 * d + 2] = free[3 * d] && rotation;
    }
    for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
      const Contact& c = assembly.contacts[k];
      const EndGradients g = end_gradients(frame_of(assembly, k), 1);
      Vector normal(free.size(), 0.0), tangential(free.size(), 0.0);
      for (std::size_t m = 0; m < 3; ++m) {
        normal[3 * c.i + m] += g.i.normal[m];
        normal[3 * c.j + m] += g.j.normal[m];
        tangential[3 * c.i + m] += g.i.tangential[m];
        tangential[3 * c.j + m] += g.j.tangential[m];
      }
      rows.push_back(std::move(normal));
      rows.push_back(std::move(tangential));
      stiffness.push_back(springs[k].kN);
      stiffness.push_back(springs[k].kT);
    }
    for (std::size_t k = 0; springs.bends() && k < assembly.contacts.size(); ++k) {
      rows.emplace_back(free.size(), 0.0);
      rows.back()[3 * assembly.contacts[k].i + 2] -= 1;
      rows.back()[3 * assembly.contacts[k].j + 2] += 1;
      stiffness.push_back(rotation ? springs.bending(k) : 0);
    }
  }

  /// K over the free components; unit rows for the others.
  [[nodiscard]] LongMatrix stiffness_matrix() const {
    LongMatrix k(free.size(), Vector(free.size(), 0.0));
    for (std::size_t p = 0; p < free.size(); ++p) {
      if (!free[p]) k[p][p] = 1;
      for (std::size_t q = 0; q < free.size(); ++q) {
        if (!free[p] || !free[q]) continue;
        for (std::size_t r = 0; r < rows.size(); ++r) k[p][q] += rows[r][p] * stiffness[r] * rows[r][q];
      }
    }
    return k;
  }

  [[nodiscard]] Vector forces(const Vector& motion, const Vector& affine) const {
    Vector f(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) f[r] = stiffness[r] * (dot(rows[r], motion) + affine[r]);
    return f;
  }
};

/// Contact forces at rest (normal, tangential of every contact) where the held components have the values `motion`,
/// the cell has the mean displacement gradient H and `loads` act on the free components.
Vector forces_at_rest(const Assembly& assembly, const Compatibility& law, Vector motion, const Tensor2& H,
                      const Vector& loads) {
  Vector affine(law.rows.size(), 0.0);
  for (std::size_t k = 0; k < assembly.contacts.size() && assembly.periodic(); ++k) {
    const ContactFrame frame = frame_of(assembly, k);
    const Vec2 du = H * assembly.branch(assembly.contacts[k]);
    affine[2 * k] = equidem::dot(du, frame.normal);
    affine[2 * k + 1] = equidem::dot(du, frame.tangent());
  }
  for (std::size_t p = 0; p < motion.size(); ++p) {
    if (law.free[p]) motion[p] = 0;
  }
  const Vector at_first = law.forces(motion, affine);
  Vector load = loads;
  for (std::size_t p = 0; p < load.size(); ++p) {
    if (!law.free[p]) {
      load[p] = 0;
      continue;
    }
    for (std::size_t r = 0; r < law.rows.size(); ++r) load[p] -= law.rows[r][p] * at_first[r];
  }
  const SemidefiniteFactor factor(law.stiffness_matrix());
  CAPTURE(static_cast<double>(factor.smallest), static_cast<double>(factor.left_over));
  REQUIRE(factor.smallest > 1e5 * factor.left_over);
  const Vector move = factor.solve(load);
  for (std::size_t p = 0; p < motion.size(); ++p) motion[p] += move[p];
  return law.forces(motion, affine);
}

double energy(const Compatibility& law, const Vector& forces) {
  Number sum = 0;
  for (std::size_t r = 0; r < forces.size(); ++r) {
    if (law.stiffness[r] != 0) sum += forces[r] * forces[r] / law.stiffness[r] / 2;
  }
  return static_cast<double>(sum);
}

/// Directions of the period in which the discs are joined to their images, by following contacts through the plane
/// tiled with the cell.
int spanned_by(const Assembly& assembly) {
  std::set<std::pair<int, int>> windings;
  for (int first = 0; first < static_cast<int>(assembly.size()); ++first) {
    for (const auto& [d, x, y] : images_joined_to(assembly, first))
      if (d == first && (x != 0 || y != 0)) windings.insert({x, y});
  }
  for (const auto& [x, y] : windings) {
    for (const auto& [p, q] : windings) {
      if (x * q != y * p) return 2;
    }
  }
  return windings.empty() ? 0 : 1;
}

/// Lattices, shaken or not, that have lost many contacts; contact points at the radii's share, anywhere, at the
/// distance of the radii (levers then do not add up) or at a centre. \param apart all at the distance of the radii
Network random_network(Random& random, bool bends, bool apart = false) {
  Network network;
  Assembly& a = network.assembly;
  const bool periodic = random.uniform() < 0.7;
  const int columns = (periodic ? 1 : 2) + static_cast<int>(random.below(3)),
            rows = 2 + 2 * static_cast<int>(random.below(2));
  const bool hexagonal = random.uniform() < 0.7;
  a = shaken_lattice(hexagonal, {.columns = columns, .rows = rows, .radius = 0.5, .periodic = periodic}, random);
  const double lost = random.uniform(0.2, 0.7);
  std::erase_if(a.contacts, [&](const Contact&) { return random.uniform() < lost; });
  const std::uint64_t levers = apart ? 2 : random.below(6);
  for (Contact& c : a.contacts) {
    const double l = norm(a.branch(c));
    double share = a.radii[c.i] / (a.radii[c.i] + a.radii[c.j]);
    if (levers == 0) share = random.uniform(0.3, 0.7);
    if (levers == 1 && random.uniform() < 0.3) share = 0;
    c.lever_i = levers == 2 ? a.radii[c.i] : share * l;
    c.lever_j = levers == 2 ? a.radii[c.j] : l - c.lever_i;
  }
  const double tangential = std::min(1.0, 1.5 * random.uniform());
  network.springs = drawn_springs(a.contacts.size(), tangential, bends, random);
  network.rotation = random.uniform() < 0.7 ? Rotation::free : Rotation::restrained;
  if (!periodic || random.uniform() < 0.1) {
    network.held.resize(a.size());
    for (auto& held : network.held) held = random.uniform() < 0.3 ? 1 : 0;
  }
  return network;
}

Vector random_long_vector(std::size_t size, Random& random) {
  Vector x(size);
  for (Number& value : x) value = random.uniform(-1, 1);
  return x;
}

/// Values per disc (three) or per contact (two) of the whole for those of a part.
Vector chosen(const Vector& whole, const std::vector<std::int32_t>& which, std::size_t each) {
  Vector part;
  for (const std::int32_t k : which) {
    for (std::size_t m = 0; m < each; ++m) part.push_back(whole[each * k + m]);
  }
  return part;
}

}  // namespace

TEST_CASE("what_is_left_out_carries_no_force_and_changes_none") {
  const auto [bends, apart] = GENERATE(std::pair(false, false), std::pair(true, false), std::pair(true, true));
  Random random(31);
  int pruned = 0, rattlers = 0, dangling = 0, floating = 0;
  std::int64_t discs_left_out = 0, discs_without_force = 0;
  int spanned[3] = {0, 0, 0};
  for (int trial = 0; trial < (apart ? 600 : bends ? 120 : 400); ++trial) {
    const Network network = random_network(random, bends, apart);
    const Assembly& whole = network.assembly;
    const LoadBearingNetwork found = network.load_bearing();
    const bool rotation = network.effects().rotation;
    CAPTURE(bends, apart, trial, whole.size(), whole.contacts.size(), whole.periodic(), rotation, found.sentences);
    const Compatibility law(whole, network.springs, rotation, network.held);

    std::vector<std::int32_t> discs(whole.size()), contacts(whole.contacts.size());
    std::iota(discs.begin(), discs.end(), 0);
    std::iota(contacts.begin(), contacts.end(), 0);
    Assembly rest = whole;
    ContactSprings springs = network.springs;
    if (found.part) {
      discs = found.part->discs;
      contacts = found.part->contacts;
      rest = found.part->assembly;
      springs = found.part->springs;
    }
    REQUIRE(found.part.has_value() == (found.removed() > 0));
    REQUIRE(found.removed() + static_cast<std::int64_t>(rest.size()) == static_cast<std::int64_t>(whole.size()));
    std::vector<std::uint8_t> held;
    for (const std::int32_t d : discs) held.push_back(network.held.empty() ? 0 : network.held[d]);
    const Compatibility rest_law(rest, springs, rotation, held);

    std::vector<bool> is_left(whole.contacts.size(), false);
    for (const std::int32_t k : contacts) is_left[k] = true;
    Vector most_force(whole.contacts.size(), 0.0);
    for (int load_case = 0; load_case < 3; ++load_case) {
      const Tensor2 H{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      Vector motion = random_long_vector(3 * whole.size(), random);
      for (std::size_t d = 0; d < whole.size() && !rotation; ++d) motion[3 * d + 2] = 0;
      // Loads on what is left that it can carry: those that balance some motion of it.
      const Vector carried =
          rest_law.forces(random_long_vector(3 * rest.size(), random), Vector(rest_law.rows.size(), 0.0));
      Vector rest_loads(3 * rest.size(), 0.0), loads(3 * whole.size(), 0.0);
      for (std::size_t p = 0; p < rest_loads.size(); ++p) {
        for (std::size_t r = 0; r < rest_law.rows.size() && load_case > 0; ++r) {
          rest_loads[p] += rest_law.rows[r][p] * carried[r];
        }
        loads[3 * discs[p / 3] + p % 3] = rest_loads[p];
      }
      const Vector forces = forces_at_rest(whole, law, motion, H, loads);
      const Vector rest_forces = forces_at_rest(rest, rest_law, chosen(motion, discs, 3), H, rest_loads);

      constexpr double tolerance = 1e-10;
      const double scale = std::max(1.0, largest_of(forces));
      const Vector restricted = chosen(forces, contacts, 2);
      double difference = 0;
      for (std::size_t r = 0; r < restricted.size(); ++r) {
        difference = std::max(difference, static_cast<double>(std::abs(restricted[r] - rest_forces[r])));
      }
      double in_removed = 0;
      for (std::size_t k = 0; k < whole.contacts.size(); ++k) {
        const auto force = static_cast<double>(std::hypot(forces[2 * k], forces[2 * k + 1]));
        if (!is_left[k]) in_removed = std::max(in_removed, force);
        if (load_case == 0) most_force[k] = force / scale;
      }
      CAPTURE(load_case, scale);
      CHECK(difference < tolerance * scale);
      CHECK(in_removed < tolerance * scale);
      CHECK(std::abs(energy(law, forces) - energy(rest_law, rest_forces)) < tolerance * (1 + energy(law, forces)));
    }
    std::vector<bool> loaded(whole.size(), false);
    for (std::size_t k = 0; k < whole.contacts.size(); ++k) {
      if (most_force[k] > 1e-9) loaded[whole.contacts[k].i] = loaded[whole.contacts[k].j] = true;
    }
    for (std::size_t d = 0; d < whole.size(); ++d) {
      if (!loaded[d] && (network.held.empty() || network.held[d] == 0)) ++discs_without_force;
    }
    discs_left_out += found.removed();
    pruned += found.part && rest.size() > 0 ? 1 : 0;
    rattlers += found.rattlers > 0 ? 1 : 0;
    dangling += found.dangling > 0 ? 1 : 0;
    floating += found.floating > 0 ? 1 : 0;
    CHECK(found.spanned == (whole.periodic() ? spanned_by(rest) : 2));
    CHECK(found.pieces == static_cast<std::int64_t>(unwrap_pieces(rest, ContactGraph(rest)).count()));
    if (whole.periodic()) ++spanned[found.spanned];
  }
  CAPTURE(pruned, rattlers, dangling, floating, spanned[0], spanned[1], spanned[2], discs_left_out,
          discs_without_force);
  CHECK(std::min({pruned, rattlers, dangling, floating}) > (bends ? 5 : 30));
  CHECK(std::min({spanned[0], spanned[1], spanned[2]}) > (bends ? 4 : 20));
  CHECK(discs_left_out <= discs_without_force);
  if (!bends) CHECK(2 * discs_left_out > discs_without_force);  // most are found from the graph
}

TEST_CASE("states_of_self_stress_are_constraints_beyond_the_rank") {
  const bool bends = GENERATE(false, true);
  Random random(32);
  std::int64_t some = 0, none = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Network network = random_network(random, bends);
    const Effects effects = network.effects();
    Compatibility law(network.assembly, network.springs, effects.rotation, network.held);
    // Self-stresses: contact forces that balance, f^T B = 0, hence the null space of B B^T over the springs there are.
    LongMatrix products;
    for (std::size_t r = 0; r < law.rows.size(); ++r) {
      if (law.stiffness[r] == 0) continue;
      products.emplace_back();
      for (std::size_t s = 0; s < law.rows.size(); ++s) {
        Number sum = 0;
        for (std::size_t p = 0; p < law.free.size(); ++p) sum += law.free[p] ? law.rows[r][p] * law.rows[s][p] : 0;
        if (law.stiffness[s] != 0) products.back().push_back(sum);
      }
    }
    const auto constraints = static_cast<std::int64_t>(products.size());
    const std::int64_t self_stresses = constraints - SemidefiniteFactor(products).rank();
    const auto held = std::count(law.free.begin(), law.free.end(), false);
    const auto components = static_cast<std::int64_t>(law.free.size());
    const std::int64_t free_motions = components - SemidefiniteFactor(law.stiffness_matrix()).rank();
    CAPTURE(bends, trial, constraints, components, held, free_motions);
    CHECK(count_self_stresses(network.assembly, network.springs, effects, components - held, free_motions) ==
          self_stresses);
    ++(self_stresses > 0 ? some : none);
  }
  CAPTURE(some, none);
  CHECK(some > 20);
  CHECK(none > 20);
}
