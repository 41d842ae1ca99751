// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Networks that break contact by contact, and their forces by factorizing anew.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/breaking/updated_network.hpp"
#include "equidem/statics/mechanisms.hpp"

#include "support/assemblies.hpp"
#include "support/fields.hpp"

namespace equidem::test {

/// Strengths of a contact, N/m.
struct ContactStrength {
  double tension = 1, shear = 1;
};

/// A network with what acts on it.
struct BreakingScene {
  std::string name;
  Assembly assembly;
  ContactSprings springs;
  DegreesOfFreedom unknowns;
  std::vector<RightHandSide> cases;
  std::vector<ContactStrength> strengths;

  [[nodiscard]] UpdatedNetwork updated() const { return {assembly, springs, unknowns, cases}; }
};

inline std::vector<ContactStrength> random_strengths(std::size_t contacts, double size, std::uint64_t seed) {
  Random random(seed);
  std::vector<ContactStrength> strengths(contacts);
  for (ContactStrength& s : strengths) {  // Weibull, modulus 4
    s.tension = size * std::pow(-std::log(1 - random.uniform()), 0.25);
    s.shear = 2 * size * std::pow(-std::log(1 - random.uniform()), 0.25);
  }
  return strengths;
}

inline DegreesOfFreedom unknowns_of(const Assembly& assembly, const ContactSprings& springs,
                                    std::span<const Support> supports) {
  const Effects effects = derive_effects(assembly, springs, Rotation::from_scene);
  DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, supports);
  hold_free_motions(assembly, ContactGraph(assembly), springs, unknowns);
  return unknowns;
}

/// Pulled at its right side, held at its left side; `dead`: its own weight beside that.
inline BreakingScene pulled(std::string name, const Assembly& assembly, const ContactSprings& springs, bool dead,
                            std::uint64_t seed) {
  const std::vector<Support> supports = {{"left", 0.0, 0.0, std::nullopt}};
  BreakingScene scene{std::move(name), assembly, springs, unknowns_of(assembly, springs, supports), {}, {}};
  const auto b = static_cast<std::size_t>(scene.unknowns.per_disc);
  RightHandSide live;
  live.force.resize(assembly.size() * b);
  for (const std::int32_t disc : group(assembly, "right").discs) live.force[disc * b] = 1;
  scene.cases.push_back(live);
  if (dead) {
    RightHandSide weight;
    weight.force.resize(assembly.size() * b);
    for (std::size_t d = 0; d < assembly.size(); ++d) weight.force[d * b + 1] = -0.001;
    scene.cases.push_back(weight);
  }
  scene.strengths = random_strengths(assembly.contacts.size(), 10, seed);
  return scene;
}

/// A periodic cell under a mean strain.
inline BreakingScene strained(std::string name, const Assembly& assembly, const ContactSprings& springs,
                              const Tensor2& gradient, std::uint64_t seed) {
  BreakingScene scene{std::move(name), assembly, springs, unknowns_of(assembly, springs, {}), {}, {}};
  scene.cases.resize(1);
  scene.cases[0].gradient = gradient;
  scene.strengths = random_strengths(assembly.contacts.size(), 10, seed);
  return scene;
}

/// Moved at its right side.
inline BreakingScene drawn(std::string name, const Assembly& assembly, const ContactSprings& springs,
                           std::uint64_t seed) {
  const std::vector<Support> supports = {{"left", 0.0, 0.0, 0.0}, {"right", 0.01, 0.0, std::nullopt}};
  BreakingScene scene{std::move(name), assembly, springs, unknowns_of(assembly, springs, supports), {}, {}};
  scene.cases.resize(1);
  scene.cases[0].prescribed = scene.unknowns.prescribed;
  scene.strengths = random_strengths(assembly.contacts.size(), 1e6, seed);
  return scene;
}

inline ContactSprings spread_springs(std::size_t contacts, double ratio, double decades, std::uint64_t seed) {
  Random random(seed);
  std::vector<SpringConstants> springs(contacts);
  for (SpringConstants& k : springs) {
    k.kN = 1e9 * std::pow(10, random.uniform(-decades, 0));
    k.kT = ratio * k.kN;
  }
  return ContactSprings(std::move(springs));
}

inline std::vector<BreakingScene> breaking_scenes() {
  const Assembly hexagonal = hexagonal_lattice({.columns = 20, .rows = 20, .radius = 0.01});
  const Assembly cell = hexagonal_lattice({.columns = 18, .rows = 16, .radius = 0.01, .periodic = true});
  const Assembly delaunay = delaunay_assembly({.discs = 500});
  const ContactSprings uniform(SpringConstants{1e9, 4e8});
  return {pulled("hexagonal", hexagonal, uniform, false, 1),
          pulled("hexagonal with its weight", hexagonal, uniform, true, 2),
          pulled("delaunay with its weight", delaunay, uniform, true, 3),
          pulled("hexagonal, kT = 0", hexagonal, ContactSprings(SpringConstants{1e9, 0}), false, 4),
          pulled("springs over six decades", delaunay, spread_springs(delaunay.contacts.size(), 0.5, 6, 1), false, 5),
          strained("cell, sheared", cell, uniform, {1e-4, 2e-3, 0, 1e-4}, 6),
          strained("cell, drawn", cell, uniform, {1e-3, 0, 0, 0}, 7),
          drawn("delaunay, right side moved", delaunay, uniform, 8)};
}

/// 113 bits of mantissa.
__extension__ using Quadruple = __float128;

/// |f - f_int| of a motion, N/m, contact by contact from the law itself.
inline double residual_length(const BreakingScene& scene, const ContactSprings& springs, const PreciseMotion& motion,
                              const RightHandSide& given) {
  const auto b = static_cast<std::size_t>(scene.unknowns.per_disc);
  const Quadruple scale = scene.unknowns.rotation_scale;
  std::vector<Quadruple> left(motion.high.size());
  for (std::size_t k = 0; k < given.force.size(); ++k) left[k] = given.force[k];
  const auto moved = [&](std::size_t k) {
    return motion.high[k] + (motion.low.empty() ? Quadruple(0) : Quadruple(motion.low[k]));
  };
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const Contact& contact = scene.assembly.contacts[c];
    const ContactFrame frame = frame_of(scene.assembly, c);
    const std::size_t i = contact.i * b, j = contact.j * b;
    Quadruple x = moved(j) - moved(i), y = moved(j + 1) - moved(i + 1);
    const Quadruple turn_i = b == 3 ? moved(i + 2) / scale : 0, turn_j = b == 3 ? moved(j + 2) / scale : 0;
    ContactDeformation affine;
    if (given.gradient) affine = affine_deformation(frame, scene.assembly.branch(contact), *given.gradient);
    const Quadruple normal = springs[c].kN * (x * frame.normal.x + y * frame.normal.y + frame.offset_i * turn_i +
                                              frame.offset_j * turn_j + affine.normal);
    const Quadruple tangential = springs[c].kT * (y * frame.normal.x - x * frame.normal.y - frame.lever_i * turn_i -
                                                  frame.lever_j * turn_j + affine.tangential);
    x = normal * frame.normal.x - tangential * frame.normal.y;
    y = normal * frame.normal.y + tangential * frame.normal.x;
    left[i] += x, left[i + 1] += y;
    left[j] -= x, left[j + 1] -= y;
    if (b == 3) {
      left[i + 2] += (frame.lever_i * tangential - frame.offset_i * normal) / scale;
      left[j + 2] += (frame.lever_j * tangential - frame.offset_j * normal) / scale;
    }
  }
  double sum = 0;
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (scene.unknowns.held[k] == DegreesOfFreedom::free) sum += squared(static_cast<double>(left[k]));
  }
  return std::sqrt(sum);
}

/// The largest of all right-hand sides, over the forces that act where no free disc moves.
inline double relative_residual(const BreakingScene& scene, UpdatedNetwork& state) {
  double largest = 0;
  for (std::size_t p = 0; p < scene.cases.size(); ++p) {
    const RightHandSide& given = scene.cases[p];
    PreciseMotion driven(scene.unknowns.held.size());
    for (std::size_t k = 0; k < given.prescribed.size(); ++k) driven.high[k] = given.prescribed[k];
    double affine = 0;
    for (std::size_t c = 0; given.gradient && c < scene.assembly.contacts.size(); ++c) {
      const ContactFrame frame = frame_of(scene.assembly, c);
      const ContactForce f = linear_spring_force(
          scene.springs[c],
          affine_deformation(frame, scene.assembly.branch(scene.assembly.contacts[c]), *given.gradient));
      affine = std::hypot(affine, f.normal, f.tangential);
    }
    const double scale = std::max(affine, residual_length(scene, scene.springs, driven, given));
    largest = std::max(largest, residual_length(scene, state.springs(), state.motion(p), given) / scale);
  }
  return largest;
}

/// Forces of the network with some contacts gone, factorized anew.
inline std::vector<std::vector<ContactForce>> anew(const BreakingScene& scene, const ContactSprings& springs) {
  StageTimes times;
  SolverOptions options;
  options.method = SolverMethod::multifrontal;
  StiffnessSolver solver(scene.assembly, springs, ContactGraph(scene.assembly), scene.unknowns, options,
                         Mechanisms::hold, times);
  const std::vector<Solution> solutions = solver.solve(scene.cases, times);
  std::vector<std::vector<ContactForce>> forces(scene.cases.size());
  for (std::size_t p = 0; p < scene.cases.size(); ++p) {
    for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
      forces[p].push_back(
          linear_spring_force(springs[c], solver.contact_motion(scene.cases[p], solutions[p].motion, c).deformation));
    }
  }
  return forces;
}

inline bool is_carried(const std::vector<HeldMechanism>& mechanisms) {
  return std::ranges::none_of(mechanisms, &HeldMechanism::driven);
}

}  // namespace equidem::test
