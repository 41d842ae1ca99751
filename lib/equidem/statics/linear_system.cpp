// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/linear_system.hpp"

#include <cassert>
#include <utility>

#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/rigidity.hpp"

namespace equidem {
namespace {

Vec2 mean_centre(const Assembly& assembly) {
  Vec2 sum;
  for (const Vec2 x : assembly.centres) sum += x;
  return (1 / static_cast<double>(assembly.size())) * sum;
}

/// Values per component as values per unknown.
std::vector<double> of_unknowns(const CompressedColumns& stiffness, std::span<const double> components) {
  std::vector<double> values;
  values.reserve(stiffness.component.size());
  for (const std::int64_t component : stiffness.component)
    values.push_back(components[static_cast<std::size_t>(component)]);
  return values;
}

std::vector<double> force_of(const SpringNetwork& network, const RightHandSide& given) {
  const DegreesOfFreedom& unknowns = network.unknowns;
  PreciseMotion motion(unknowns.held.size());
  for (std::size_t k = 0; k < given.prescribed.size(); ++k) {
    if (unknowns.held[k] != 0) motion.high[k] = given.prescribed[k];
  }
  std::vector<double> force(unknowns.held.size());
  residual_force(network, motion, given.gradient, given.force, force);
  return force;
}

}  // namespace

std::vector<DiscMotion> LinearSystem::motions(std::span<const double> solution) const {
  assert(solution.size() == stiffness.component.size());
  std::vector<double> components = unknowns.prescribed;
  for (std::size_t k = 0; k < solution.size(); ++k)
    components[static_cast<std::size_t>(stiffness.component[k])] = solution[k];
  return disc_motions(unknowns, components);
}

LinearSystem linear_system(const SpringNetwork& network, std::span<const RightHandSide> right_hand_sides) {
  const auto& [assembly, graph, springs, unknowns] = network;
  LinearSystem system;
  system.unknowns = unknowns;
  system.stiffness = compress(assemble_stiffness(assembly, graph, springs, unknowns), assembly, graph, unknowns);
  for (const RightHandSide& given : right_hand_sides)
    system.right_hand_sides.push_back(of_unknowns(system.stiffness, force_of(network, given)));
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  const Vec2 centre = mean_centre(assembly);
  for (std::size_t m = 0; m < system.rigid_motions.size(); ++m) {
    std::vector<double> components(unknowns.held.size(), 0.0);
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      const Vec2 arm = assembly.centres[d] - centre;
      const double rotation[] = {-arm.y, arm.x, unknowns.rotation_scale};
      for (std::size_t k = 0; k < b; ++k) components[d * b + k] = m == 2 ? rotation[k] : m == k ? 1.0 : 0.0;
    }
    system.rigid_motions[m] = of_unknowns(system.stiffness, components);
  }
  return system;
}

LinearSystem equilibrium_system(const Assembly& assembly, const ContactSprings& springs,
                                std::span<const Support> supports, std::span<const LoadCase> loads, Rotation rotation) {
  check(assembly);
  const ContactGraph graph(assembly);
  const DegreesOfFreedom unknowns =
      number_unknowns(assembly, springs, derive_effects(assembly, springs, rotation), supports);
  check_rigidity(assembly, graph, springs, unknowns);
  std::vector<RightHandSide> cases;
  for (const LoadCase& acting : loads) {
    RightHandSide given{.force = assemble_loads(assembly, unknowns, acting), .prescribed = unknowns.prescribed};
    check_inert_loads(assembly, unknowns, given.force);
    cases.push_back(std::move(given));
  }
  return linear_system({assembly, graph, springs, unknowns}, cases);
}

}  // namespace equidem
