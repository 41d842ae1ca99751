// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/spheres.hpp"

#include <algorithm>

namespace equidem::validation {
namespace {

double gap_of(const std::vector<Grain>& grains) {
  if (grains.size() == 1) return grains[0].position.y - grains[0].radius;
  return norm(grains[1].position - grains[0].position) - grains[0].radius - grains[1].radius;
}

/// The largest of samples at equal distances, by the parabola through the largest and its neighbours.
double peak(const std::vector<double>& samples) {
  const auto top = std::max_element(samples.begin(), samples.end());
  if (top == samples.begin() || top + 1 == samples.end()) return *top;
  const double before = *(top - 1), after = *(top + 1);
  return *top - squared(before - after) / (8 * (before - 2 * *top + after));
}

}  // namespace

Grain sphere(double radius, double density, Vec2 position, Vec2 velocity, double spin) {
  return {.position = position,
          .radius = radius,
          .inertia = inertia_of(radius, density, Body::sphere),
          .velocity = velocity,
          .spin = spin};
}

GrainScene spheres(std::vector<Grain> grains, const PairProperties& contact, bool floor) {
  GrainScene scene;
  scene.grains = std::move(grains);
  if (floor) scene.walls.emplace_back();
  scene.pairs = {contact};
  return scene;
}

double reduced_mass(const GrainScene& scene) {
  const double first = scene.grains[0].inertia.mass;
  return scene.grains.size() == 1 ? first : 1 / (1 / first + 1 / scene.grains[1].inertia.mass);
}

Rebound collide(const GrainScene& scene, NormalLaw law, double time_step) {
  GrainSimulation run(scene, {.law = law,
                              .integrator = law == NormalLaw::exact_flow ? GrainOptions::Integrator::semi_implicit_euler
                                                                         : GrainOptions::Integrator::corrected_verlet,
                              .time_step = time_step});
  Rebound rebound;
  std::vector<double> overlaps{0}, forces{0};
  double gap = 0, before = 0;
  do {
    run.advance(1);
    rebound.grains = run.grains();
    before = gap;
    gap = gap_of(rebound.grains);
    overlaps.push_back(-gap);
    for (const GrainContact& contact : run.contacts()) forces.push_back(contact.normal_force);
  } while (gap < 0);
  rebound.overlap = peak(overlaps);
  rebound.force = peak(forces);
  rebound.duration = run.time() - time_step * gap / (gap - before);
  run.advance(1);  // a step that ends apart may have begun in contact
  rebound.grains = run.grains();
  return rebound;
}

std::vector<Grain> after_steps(const GrainScene& scene, NormalLaw law, double time_step, std::int64_t steps) {
  GrainSimulation run(scene,
                      {.law = law, .integrator = GrainOptions::Integrator::velocity_verlet, .time_step = time_step});
  run.advance(steps);
  return run.grains();
}

}  // namespace equidem::validation
