// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Invariants of motion: momentum in free flight, rest at rest, forces that are those of the matrix.
#include <algorithm>
#include <cmath>

#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/internal_force.hpp"

#include "dynamics/moving_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Momentum {
  Vec2 linear;
  double angular = 0;
};

/// Angular momentum about the origin, of the places where the motion's law acts: those at rest, or those now.
Momentum momentum_of(const equidem::Scene& scene, const Simulation& run, bool finite) {
  const std::vector<DiscMotion> u = run.motions(), v = run.velocities();
  Momentum sum;
  for (std::size_t d = 0; d < v.size(); ++d) {
    const Vec2 x = scene.assembly.centres[d] + (finite ? u[d].u : Vec2{});
    sum.linear += scene.inertia[d].mass * v[d].u;
    sum.angular += scene.inertia[d].mass * (x.x * v[d].u.y - x.y * v[d].u.x) + scene.inertia[d].moment * v[d].theta;
  }
  return sum;
}

}  // namespace

TEST_CASE("momentum_is_conserved_in_free_flight") {
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  const auto integrator = GENERATE(Integrator::leapfrog, Integrator::velocity_verlet, Integrator::fourth_order);
  const double contact = GENERATE(0.0, 0.2);
  if (contact > 0 && integrator == Integrator::fourth_order) return;
  const bool hexagonal = GENERATE(true, false);
  const Assembly assembly = hexagonal ? hexagonal_block(6) : delaunay_block(50, 3);
  const ContactSprings springs(SpringConstants{1, 0.4});
  equidem::Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  start_with(scene, random_motions(assembly.size(), 4, 0.05, 0.05));
  Simulation run(scene,
                 {.motion = motion, .integrator = integrator, .damping = {.contact = contact}, .time_step = 0.1});
  const bool finite = motion == LoopKind::Motion::finite;
  const Momentum first = momentum_of(scene, run, finite);
  double scale = 0;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    scale += scene.inertia[d].mass * norm(run.velocities()[d].u) * (1 + norm(assembly.centres[d]));
  }
  run.advance(1000);
  const Momentum last = momentum_of(scene, run, finite);
  CAPTURE(finite, to_string(integrator), contact, hexagonal, scale, first.angular, last.angular);
  CHECK(norm(last.linear - first.linear) < 1e-13 * scale);
  CHECK(std::abs(last.angular - first.angular) < 1e-12 * scale);
}

TEST_CASE("what_is_at_rest_stays_at_rest") {
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  for (const AssemblyKind& kind : assembly_kinds()) {
    const ContactSprings springs(SpringConstants{1e9, 0.4e9});
    const equidem::Scene scene(kind.assembly, springs, inertia_of(kind.assembly.radii, 2000, Body::disc));
    Simulation run(scene, {.motion = motion, .time_step = 1e-6});
    run.advance(10);
    CAPTURE(kind.name);
    for (const DiscMotion& u : run.motions()) CHECK((u.u.x == 0 && u.u.y == 0 && u.theta == 0));
    CHECK(run.energy().error() == 0);
  }
}

TEST_CASE("forces_of_small_motions_are_those_of_the_stiffness_matrix") {
  for (const HeldScene& held : held_scenes()) {
    const Assembly& assembly = held.assembly();
    const equidem::Scene scene(assembly, held.springs, inertia_of(assembly.radii, 2000, Body::disc));
    const Effects effects = derive_effects(held.springs, held.options.rotation);
    Simulation run(scene, {.rotation = held.options.rotation, .time_step = 1e-6});
    const DegreesOfFreedom unknowns = all_free(assembly, effects.unknowns_per_disc());
    const ContactGraph graph(assembly);
    const std::vector<double> u = random_vector(unknowns.held.size(), 11);
    std::vector<double> f(u.size());
    multiply(assemble_stiffness(assembly, graph, held.springs, unknowns), assembly, graph, u, f);
    const std::vector<DiscForce> forces = run.unbalanced_forces(as_motions(unknowns, u));
    const auto b = static_cast<std::size_t>(unknowns.per_disc);
    double difference = 0;
    for (std::size_t k = 0; k < u.size(); ++k) {
      const DiscForce& disc = forces[k / b];
      const double force = k % b == 0   ? disc.force.x
                           : k % b == 1 ? disc.force.y
                                        : disc.moment / unknowns.rotation_scale;
      difference = std::max(difference, std::abs(force + f[k]));
    }
    CAPTURE(held.name, difference, largest(f));
    CHECK(difference <= 1e-14 * largest(f));
  }
}
