// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What cannot be simulated is refused before the first step, naming the number and its bound.
#include <functional>
#include <limits>

#include "grains/scenes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

struct Spoiled {
  std::string says;
  std::function<void(GrainScene&, GrainOptions&)> spoil;
};

std::vector<Spoiled> all_spoiled() {
  using S = GrainScene;
  using O = GrainOptions;
  return {
      {"the scene has no grains", [](S& s, O&) { s.grains.clear(); }},
      {"the radius of grain 1 is 0 m", [](S& s, O&) { s.grains[1].radius = 0; }},
      {"the radius of grain 1 is nan m", [](S& s, O&) { s.grains[1].radius = no_number; }},
      {"the mass of grain 0 is -1", [](S& s, O&) { s.grains[0].inertia.mass = -1; }},
      {"the moment of inertia of grain 0 is 0", [](S& s, O&) { s.grains[0].inertia.moment = 0; }},
      {"grain 0 has a position, a velocity or a spin", [](S& s, O&) { s.grains[0].velocity.y = no_number; }},
      {"grain 0 has a position, a velocity or a spin", [](S& s, O&) { s.grains[0].position.x = 1 / 0.0; }},
      {"grain 1 is of the kind 1", [](S& s, O&) { s.grains[1].kind = 1; }},
      {"wall \"floor\" is of the kind -1", [](S& s, O&) { s.walls[0].kind = -1; }},
      {"1 pairs are given for 2 kinds", [](S& s, O&) { s.kinds = 2; }},
      {"kinds 0 and 1 meet by other rules than 1 and 0",
       [](S& s, O&) {
         s.kinds = 2;
         s.pairs.resize(4, s.pairs[0]);
         s.pairs[1].friction = 0.1;
       }},
      {"a contact has no stiffness", [](S& s, O&) { s.pairs[0].stiffness = 0; }},
      {"a contact has a stiffness and a dimensionless stiffness", [](S& s, O&) { s.pairs[0].dimensionless = 0.1; }},
      {"the stiffness of a contact is -1", [](S& s, O&) { s.pairs[0].stiffness = -1; }},
      {"the stiffness of a contact is nan", [](S& s, O&) { s.pairs[0].stiffness = no_number; }},
      {"coefficient of restitution is 1.1", [](S& s, O&) { s.pairs[0].restitution = 1.1; }},
      {"coefficient of restitution is 0", [](S& s, O&) { s.pairs[0].restitution = 0; }},
      {"restitution is 2",
       [](S& s, O& o) {
         s.pairs[0].restitution = 2;
         o.law = NormalLaw::energy_map;
       }},
      {"its first step has an answer only where",
       [](S& s, O& o) {
         s.pairs[0].restitution = 0.1;
         o.law = NormalLaw::five_case_map;
       }},
      {"the friction of a contact is -0.1", [](S& s, O&) { s.pairs[0].friction = -0.1; }},
      {"tangential damping is given without", [](S& s, O&) { s.pairs[0].tangential_damping = 0.1; }},
      {"velocity_verlet is asked for with the law \"exact_flow\"",
       [](S&, O& o) { o.integrator = GrainIntegrator::velocity_verlet; }},
      {"velocity_verlet is asked for with the law \"energy_map\"",
       [](S&, O& o) {
         o.integrator = GrainIntegrator::velocity_verlet;
         o.law = NormalLaw::energy_map;
       }},
      {"the time step is 0 s", [](S&, O& o) { o.time_step = 0; }},
      {"the time step is -1 s", [](S&, O& o) { o.time_step = -1; }},
      {"the reference length is -1 m", [](S&, O& o) { o.reference_length = -1; }},
      {"the margin", [](S&, O& o) { o.margin = no_number; }},
      {"gravity is not a number", [](S& s, O&) { s.gravity.x = no_number; }},
      {"grains 0 and 1 start inside one another",
       [](S& s, O&) {
         s.grains[1].position = {0.5, 2};
       }},
      {"grain 1 starts behind wall \"floor\"",
       [](S& s, O&) {
         s.grains[1].position = {5, -0.1};
       }},
      {"wall 'floor' has the normal (0, 2)",
       [](S& s, O&) {
         s.walls[0].normal = {0, 2};
       }},
  };
}

}  // namespace

TEST_CASE("scenes_that_cannot_be_stepped_are_refused") {
  const GrainScene good =
      scene_of({ball({0, 2}, 1), ball({5, 2}, 1)}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e3}, {0, -1});
  const GrainOptions options = options_of(NormalLaw::exact_flow, 0.1);
  CHECK_NOTHROW(GrainSimulation(good, options));
  for (const Spoiled& spoiled : all_spoiled()) {
    GrainScene scene = good;
    GrainOptions other = options;
    spoiled.spoil(scene, other);
    CAPTURE(spoiled.says);
    CHECK_FALSE(check_refused([&] { GrainSimulation(scene, other); }, {spoiled.says}).remedy.empty());
  }
}

TEST_CASE("effects_of_a_scene_are_listed_with_their_reasons") {
  GrainScene scene = scene_of({ball({0, 2}, 1)}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e3});
  const auto active = [&](const std::string& name) {
    const GrainSimulation simulation(scene, options_of(NormalLaw::exact_flow, 0.1));
    for (const Effects::Entry& entry : simulation.effects().entries) {
      CHECK_FALSE(entry.why.empty());
      if (entry.name == name) return entry.active;
    }
    FAIL("no such effect: " << name);
    return false;
  };
  CHECK_FALSE(active("friction"));
  CHECK_FALSE(active("rotation"));
  CHECK_FALSE(active("gravity"));
  CHECK_FALSE(active("loss at impacts"));
  CHECK_FALSE(active("motion of walls"));
  CHECK(active("walls"));
  CHECK(active("normal contact by exact_flow"));
  scene.pairs[0].friction = 0.1;
  scene.pairs[0].restitution = 0.5;
  scene.gravity = {0, -1};
  scene.walls[0].move_x = {Schedule::Kind::sine, 1, 0, 0, 1};
  CHECK(active("friction"));
  CHECK(active("rotation"));
  CHECK(active("gravity"));
  CHECK(active("loss at impacts"));
  CHECK(active("motion of walls"));
  CHECK_FALSE(active("tangential springs"));
  scene.pairs[0].tangential_ratio = 0.5;
  CHECK(active("tangential springs"));
}
