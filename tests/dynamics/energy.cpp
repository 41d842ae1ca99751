// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The ledger of energies: its balance, and how it stands after a million steps.
#include <algorithm>
#include <cmath>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/dynamics/time_step.hpp"

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Schedule ramp(double value, double end) {
  Schedule schedule;
  schedule.kind = Schedule::Kind::ramp;
  schedule.value = value;
  schedule.end = end;
  return schedule;
}

Schedule sine(double value, double frequency) {
  Schedule schedule;
  schedule.kind = Schedule::Kind::sine;
  schedule.value = value;
  schedule.frequency = frequency;
  return schedule;
}

double kinetic_energy(const Scene& scene, const std::vector<DiscMotion>& v) {
  double energy = 0;
  for (std::size_t d = 0; d < v.size(); ++d) {
    energy += 0.5 * (scene.inertia[d].mass * dot(v[d].u, v[d].u) + scene.inertia[d].moment * v[d].theta * v[d].theta);
  }
  return energy;
}

double elastic_energy(const Scene& scene, const std::vector<DiscMotion>& u, LoopKind::Motion motion) {
  double energy = 0;
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const Contact& contact = scene.assembly.contacts[c];
    const SpringConstants k = scene.springs[c];
    const ContactDeformation d = deformation(frame_of(scene.assembly, c), u[contact.i], u[contact.j]);
    energy += motion == LoopKind::Motion::finite
                  ? bond_energy(bond_of(scene.assembly, contact, k), u[contact.i], u[contact.j])
                  : 0.5 * (k.kN * d.normal * d.normal + k.kT * d.tangential * d.tangential);
  }
  return energy;
}

}  // namespace

TEST_CASE("the_balance_of_leapfrog_closes_to_rounding") {
  struct Given {
    std::string name;
    Damping damping;
  };
  const Given given = GENERATE(Given{"none", {}}, Given{"mass", {.mass = 0.2}}, Given{"local", {.local = 0.5}},
                               Given{"stiffness", {.stiffness = 0.1}}, Given{"contact", {.contact = 0.2}},
                               Given{"mass and contact", {.mass = 0.1, .contact = 0.2}});
  const bool hexagonal = GENERATE(true, false);
  const Rotation rotation = GENERATE(Rotation::from_scene, Rotation::restrained);
  const Assembly assembly = hexagonal ? hexagonal_block(7) : delaunay_block(60, 9);
  const ContactSprings springs(SpringConstants{1, 0.4});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  TimedSupport bottom;
  bottom.group = "bottom";
  bottom.uy = sine(0.05, 0.1);
  scene.supports = {bottom};
  scene.loads = {{{"top", LoadKind::per_disc, {0.03, -0.02}, 0}, ramp(1, 20)},
                 {{"right", LoadKind::traction, {0.05, 0}, 0}, sine(1, 0.02)}};
  scene.gravity = {0.001, -0.01};
  start_with(scene, random_motions(assembly.size(), 5, 0.1, 0.1), rotation);
  SimulationOptions options{.rotation = rotation, .damping = given.damping};
  options.time_step = choose_time_step(scene, options, {.fraction = 0.7}).step;
  const ThreadsFor one(1);
  Simulation run(scene, options);
  double most = 0;
  for (int k = 0; k < 50; ++k) {
    run.advance(40);
    const EnergyLedger e = run.energy();
    most = std::max({most, e.kinetic, std::abs(e.elastic()), std::abs(e.work()), e.lost()});
    CAPTURE(given.name, hexagonal, k, e.kinetic, e.elastic(), e.potential, e.lost(), e.work(), e.initial,
            e.error() / most);
    REQUIRE(std::abs(e.error()) < 2e-13 * most);
  }
  const EnergyLedger e = run.energy();
  CHECK(e.kinetic > 0);
  CHECK(e.work_of_loads != 0);
  CHECK(e.work_of_supports != 0);
  CHECK((e.damped_mass > 0) == (given.damping.mass > 0));
  CHECK((e.damped_local > 0) == (given.damping.local > 0));
  CHECK((e.damped_contact > 0) == (given.damping.stiffness + given.damping.contact > 0));
}

TEST_CASE("energies_are_those_of_one_instant_and_exact_at_the_start") {
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  const auto integrator = GENERATE(Integrator::leapfrog, Integrator::velocity_verlet, Integrator::fourth_order);
  const double alpha = GENERATE(0.0, 0.3);
  const Assembly assembly = delaunay_block(40, 2);
  const ContactSprings springs(SpringConstants{1, 0.4});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const std::vector<DiscMotion> given = random_motions(assembly.size(), 5, 0.05, 0.05);
  start_with(scene, given);
  scene.loads = lasting({{"top", LoadKind::per_disc, {0.3, -0.2}, 0}});
  scene.gravity = {0.1, -1};
  SimulationOptions options{.motion = motion, .integrator = integrator, .damping = {.mass = alpha}};
  options.time_step = choose_time_step(scene, options, {.fraction = 0.7}).step;
  Simulation run(scene, options);
  CAPTURE(to_string(integrator), alpha);
  const EnergyLedger start = run.energy();
  CHECK(start.initial == Approx(kinetic_energy(scene, given)).epsilon(1e-13));
  CHECK(start.kinetic + start.elastic() == start.initial);
  for (const auto& term : {start.potential, start.sway, start.lost(), start.work()}) CHECK(term == 0);
  run.advance(37);
  const EnergyLedger now = run.energy();
  CHECK(now.kinetic == Approx(kinetic_energy(scene, run.velocities())).epsilon(1e-13));
  CHECK(now.elastic() == Approx(elastic_energy(scene, run.motions(), motion)).epsilon(1e-12));
  double fallen = 0;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    fallen -= scene.inertia[d].mass * dot(scene.gravity, run.motions()[d].u);
  }
  CHECK(now.potential == Approx(fallen).epsilon(1e-12));
}

TEST_CASE("the_balance_of_finite_motions_closes_to_the_order_of_the_integrator") {
  struct Given {
    Integrator integrator;
    double order;
    Damping damping;
  };
  const Given given =
      GENERATE(Given{Integrator::leapfrog, 2, {}}, Given{Integrator::velocity_verlet, 2, {.mass = 0.02}},
               Given{Integrator::leapfrog, 2, {.contact = 0.05}}, Given{Integrator::fourth_order, 4, {}});
  const Assembly assembly = delaunay_block(12, 4);
  const ContactSprings springs(SpringConstants{1, 0.4});
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  if (given.order == 2) {  // to which order the work of what drives a run is counted
    scene.loads = {{{"top", LoadKind::per_disc, {0.02, 0.01}, 0}, ramp(1, 20)}};
    TimedSupport bottom;
    bottom.group = "bottom";
    bottom.ux = ramp(0.4, 20);
    scene.supports = {bottom};
  }
  start_with(scene, random_motions(assembly.size(), 7, 0.15, 0.15));
  SimulationOptions options{
      .motion = LoopKind::Motion::finite, .integrator = given.integrator, .damping = given.damping};
  const double end = 16, first = 0.5 * choose_time_step(scene, options).critical;
  std::vector<double> errors;
  for (const int halved : {1, 2, 4, 8}) {
    const auto steps = static_cast<std::int64_t>(halved * std::ceil(end / first));
    options.time_step = end / static_cast<double>(steps);
    Simulation run(scene, options);
    run.advance(steps);
    errors.push_back(std::abs(run.energy().error()) / (run.energy().kinetic + run.energy().elastic()));
  }
  const double order = std::log2(errors[2] / errors[3]);
  CAPTURE(to_string(given.integrator), errors, order);
  CHECK(order > given.order - 0.35);
  CHECK(errors[0] < 0.02);
}
