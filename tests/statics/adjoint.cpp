// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Derivatives of measured numbers against central differences of equilibria, along random directions in the space of
/// all springs, loads and positions.

#include "equidem/statics/adjoint.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/motion_description.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double kN = 1e9;
constexpr double tiny = 1e-30;  // a cell of one disc does not move

struct Direction {
  std::vector<double> kN, kT, kM;
  std::vector<DiscForce> loads;
  std::vector<Vec2> places;
};

/// A scene with random springs and loads, its supports a little moved, and what is measured of it.
struct MeasuredScene {
  Assembly assembly;
  ContactSprings springs;
  std::vector<Support> supports;
  EquilibriumOptions options;
  std::vector<DiscForce> loads;
  Measure measure;
};

std::vector<double> drawn(std::size_t count, double size, Random& random) {
  std::vector<double> x(count);
  for (double& value : x) value = size * random.uniform(-1, 1);
  return x;
}

std::vector<DiscForce> drawn_forces(const Assembly& assembly, bool moments, Random& random) {
  std::vector<DiscForce> forces(assembly.size());
  for (DiscForce& f : forces)
    f = {{random.uniform(-1, 1), random.uniform(-1, 1)},
         moments ? assembly.mean_radius() * random.uniform(-1, 1) : 0.0};
  return forces;
}

ContactSprings with_changes(const ContactSprings& springs, const Direction& along, double t) {
  std::vector<SpringConstants> constants;
  for (std::size_t c = 0; c < along.kN.size(); ++c)
    constants.push_back({springs[c].kN + t * along.kN[c], springs[c].kT + t * along.kT[c]});
  ContactSprings changed(constants);
  if (springs.bends()) {
    std::vector<double> bending = springs.bending_springs();
    for (std::size_t c = 0; c < bending.size(); ++c) bending[c] += t * along.kM[c];
    changed = changed.with_bending(bending);
  }
  if (!springs.prestressed()) return changed;
  std::vector<ContactPrestress> forms;
  for (std::size_t c = 0; c < along.kN.size(); ++c) forms.push_back(*springs.prestress(c));
  return changed.with_prestress(forms);
}

/// Levers keep their shares of the distance.
Assembly moved(const Assembly& assembly, const std::vector<Vec2>& places, double t) {
  Assembly changed = assembly;
  for (std::size_t d = 0; d < places.size(); ++d) changed.centres[d] += t * places[d];
  for (Contact& c : changed.contacts) {
    const double growth = norm(changed.branch(c)) / norm(assembly.branch(c));
    c.lever_i *= growth, c.lever_j *= growth;
  }
  return changed;
}

double measured(const MeasuredScene& scene, const Direction& along, double t) {
  const Assembly assembly = moved(scene.assembly, along.places, t);
  const ContactSprings springs = with_changes(scene.springs, along, t);
  std::vector<DiscForce> loads = scene.loads;
  for (std::size_t d = 0; d < along.loads.size(); ++d)
    loads[d].force += t * along.loads[d].force, loads[d].moment += t * along.loads[d].moment;
  EquilibriumSolver solver(assembly, springs, scene.supports, scene.options);
  return derivatives(solver, solver.solve(loads), scene.measure).value;
}

/// The sum of derivatives times direction, and of its magnitudes.
struct Along {
  double sum = 0, magnitude = 0;
  void add(double term) { sum += term, magnitude += std::abs(term); }
};

/// The relative error of the derivatives along a direction, beside a difference of fourth order.
double error_along(const MeasuredScene& scene, const MeasureDerivatives& found, const Direction& along) {
  Along all;
  for (std::size_t c = 0; c < found.by_kN.size(); ++c) {
    all.add(found.by_kN[c] * along.kN[c]), all.add(found.by_kT[c] * along.kT[c]);
    if (!found.by_kM.empty()) all.add(found.by_kM[c] * along.kM[c]);
  }
  for (std::size_t d = 0; d < along.loads.size(); ++d)
    all.add(dot(found.by_load[d].u, along.loads[d].force)), all.add(found.by_load[d].theta * along.loads[d].moment);
  for (std::size_t d = 0; d < along.places.size(); ++d) all.add(dot(found.by_position[d], along.places[d]));
  const double h = scene.springs.any_negative() ? 2e-5 : 1e-3;  // near to instability states change fast
  const auto difference = [&](double t) { return (measured(scene, along, t) - measured(scene, along, -t)) / (2 * t); };
  return std::abs((4 * difference(h / 2) - difference(h)) / 3 - all.sum) / (all.magnitude + tiny);
}

MeasuredScene measured_scene(const HeldScene& held, bool bend, bool prestress, Random& random) {
  MeasuredScene scene{.assembly = held.assembly(),
                      .springs = held.springs,
                      .supports = held.supports,
                      .options = held.options,
                      .loads = drawn_forces(held.assembly(), false, random),
                      .measure = {}};
  const std::size_t contacts = scene.assembly.contacts.size();
  const double a = scene.assembly.mean_radius();
  scene.supports.front().ux = 1e-9;
  std::vector<SpringConstants> constants;
  for (std::size_t c = 0; c < contacts; ++c)
    constants.push_back({held.springs[c].kN * random.uniform(0.8, 1.2), held.springs[c].kT * random.uniform(0.8, 1.2)});
  scene.springs = ContactSprings(constants);
  if (bend) scene.springs = scene.springs.with_bending(std::vector(contacts, 0.2 * kN * a * a));
  if (prestress) {
    std::vector<ContactPrestress> forms;
    for (std::size_t c = 0; c < contacts; ++c)
      forms.push_back(prestress_of_discs(frame_of(scene.assembly, c),
                                         norm(scene.assembly.branch(scene.assembly.contacts[c])),
                                         {-1e-3 * kN * a * random.uniform(), 0}));
    scene.springs = scene.springs.with_prestress(forms);
  }
  scene.measure.motions = drawn_forces(scene.assembly, false, random);
  scene.measure.forces.resize(contacts);
  for (ContactForce& w : scene.measure.forces) w = {random.uniform(-1, 1) / kN, random.uniform(-1, 1) / kN};
  return scene;
}

}  // namespace

TEST_CASE("derivatives_of_measured_numbers_are_those_of_differences") {
  const bool bend = GENERATE(false, true), prestress = GENERATE(false, true);
  Random random(17);
  std::size_t scenes = 0;
  for (const HeldScene& held : held_scenes()) {
    if (bend && held.springs[0].kT < 0) continue;
    CAPTURE(held.name, bend, prestress);
    const MeasuredScene scene = measured_scene(held, bend, prestress, random);
    EquilibriumSolver solver(scene.assembly, scene.springs, scene.supports, scene.options);
    const MeasureDerivatives found = derivatives(solver, solver.solve(scene.loads), scene.measure);
    const std::size_t contacts = scene.assembly.contacts.size();
    const double a = scene.assembly.mean_radius(), k = 0.1 * kN * std::abs(held.springs[0].kT / held.springs[0].kN);
    Direction springs{drawn(contacts, 0.1 * kN, random),
                      drawn(contacts, k, random),
                      drawn(contacts, bend ? 0.1 * kN * a * a : 0, random),
                      {},
                      {}};
    CHECK(error_along(scene, found, springs) < 1e-7);
    const std::vector<double> none(contacts);
    CHECK(error_along(scene, found, {none, none, none, drawn_forces(scene.assembly, false, random), {}}) < 1e-7);
    CHECK(found.by_position.empty() == prestress);
    if (prestress) continue;
    Direction places{none, none, none, {}, std::vector<Vec2>(scene.assembly.size())};
    for (Vec2& x : places.places) x = {0.1 * a * random.uniform(-1, 1), 0.1 * a * random.uniform(-1, 1)};
    CHECK(error_along(scene, found, places) < 1e-7);
    ++scenes;
  }
  CHECK((prestress || scenes >= 10));
}

TEST_CASE("derivatives_of_the_energy_are_those_of_differences") {
  Random random(23);
  for (const HeldScene& held : held_scenes()) {
    CAPTURE(held.name);
    const Assembly& assembly = held.assembly();
    const bool bend = random.uniform() < 0.5;
    const MeasuredScene scene = measured_scene(held, bend, false, random);
    const std::size_t contacts = assembly.contacts.size();
    const double a = assembly.mean_radius();
    std::vector<DiscMotion> motions(assembly.size());
    for (DiscMotion& u : motions) u = {{random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(-1, 1) / a};
    const SpringAndPlaceDerivatives found = form_derivatives(assembly, scene.springs, motions, motions);
    Direction along{drawn(contacts, 0.1 * kN, random),
                    drawn(contacts, 0.1 * kN, random),
                    drawn(contacts, bend ? 0.1 * kN * a * a : 0, random),
                    {},
                    std::vector<Vec2>(assembly.size())};
    for (Vec2& x : along.places) x = {0.1 * a * random.uniform(-1, 1), 0.1 * a * random.uniform(-1, 1)};
    const auto twice_energy = [&](double t) {
      return 2 * elastic_energy(moved(assembly, along.places, t), with_changes(scene.springs, along, t), motions);
    };
    Along all;
    for (std::size_t c = 0; c < contacts; ++c) {
      all.add(found.by_kN[c] * along.kN[c]), all.add(found.by_kT[c] * along.kT[c]);
      if (bend) all.add(found.by_kM[c] * along.kM[c]);
    }
    for (std::size_t d = 0; d < assembly.size(); ++d) all.add(dot(found.by_position[d], along.places[d]));
    const auto difference = [&](double t) { return (twice_energy(t) - twice_energy(-t)) / (2 * t); };
    constexpr double h = 1e-3;
    CHECK(std::abs((4 * difference(h / 2) - difference(h)) / 3 - all.sum) < 1e-9 * all.magnitude);
  }
}

TEST_CASE("iterations_find_the_derivatives_that_elimination_finds") {
  Random random(29);
  const HeldScene held = held_scenes().front();
  const MeasuredScene scene = measured_scene(held, false, false, random);
  const auto found_by = [&](SolverMethod method) {
    EquilibriumOptions options = scene.options;
    options.solver.method = method;
    EquilibriumSolver solver(scene.assembly, scene.springs, scene.supports, options);
    return derivatives(solver, solver.solve(scene.loads), scene.measure);
  };
  const MeasureDerivatives a = found_by(SolverMethod::multifrontal), b = found_by(SolverMethod::multigrid);
  Along all, apart;
  for (std::size_t c = 0; c < a.by_kN.size(); ++c) {
    all.add(a.by_kN[c]), all.add(a.by_kT[c]);
    apart.add(b.by_kN[c] - a.by_kN[c]), apart.add(b.by_kT[c] - a.by_kT[c]);
  }
  CHECK(apart.magnitude < 1e-9 * all.magnitude);
}

TEST_CASE("what_is_measured_has_as_many_weights_as_there_are_discs_and_contacts") {
  const HeldScene held = held_scenes().front();
  EquilibriumSolver solver(held.assembly(), held.springs, held.supports, held.options);
  const Equilibrium state = solver.solve(std::vector<DiscForce>(held.assembly().size()));
  for (const Measure& wrong : {Measure{.motions = std::vector<DiscForce>(2), .forces = {}},
                               Measure{.motions = {}, .forces = std::vector<ContactForce>(3)}}) {
    const Refusal refusal = refusal_of([&] { derivatives(solver, state, wrong); });
    CHECK_THAT(refusal.message, Catch::Contains(" weights for "));
  }
  const Refusal refusal = refusal_of([&] { form_derivatives(held.assembly(), held.springs, {}, {}); });
  CHECK_THAT(refusal.message, Catch::Contains("motions of 0 discs"));
}
