// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case file of grains or of a packing that gives no more than it must means the defaults of the options.
#include <string>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/text.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

std::string shortest_case(const std::string& law) {
  return "schema = \"equidem/1\"\n[grains]\ndensity = 2500.0\n[[grain]]\nposition = [0.0, 1.0]\nradius = 0.01\n"
         "[[grain]]\nposition = [0.0, 2.0]\nradius = 0.02\n[collisions]\n" +
         (law.empty() ? "" : "law = \"" + law + "\"\n") +
         "restitution = 0.8\nstiffness = 1e6\nclosing_speed = 1.0\nfriction = 0.3\n[[wall]]\nname = \"floor\"\n"
         "point = [0.0, 0.0]\nnormal = [0.0, 1.0]\n[run]\nduration = 1.0\n";
}

}  // namespace

TEST_CASE("defaults_of_cases_of_grains_are_those_of_the_options") {
  const std::string law = GENERATE("", "exact_flow", "linear_dashpot", "hertz_dashpot", "five_case_map", "energy_map");
  CAPTURE(law);
  const GrainCase given = parse_grain_case(shortest_case(law), "case.toml", {});

  GrainScene scene;
  for (const double height : {1.0, 2.0})
    scene.grains.push_back(
        {.position = {0, height}, .radius = 0.01 * height, .inertia = inertia_of(0.01 * height, 2500, Body::disc)});
  Wall floor;
  floor.name = "floor";
  floor.normal = {0, 1};
  scene.walls = {floor};
  GrainOptions options;
  if (!law.empty()) options.law = enum_from<NormalLaw>(law);
  const ContactTable contacts = set_kinds(
      scene, {},
      {.bodies = {.stiffness = SpringStiffness{1e6}, .rebound = Restitution{0.8}, .closing_speed = 1, .friction = 0.3}},
      options.law);
  const GrainTimeStep step = choose_time_step(scene, contacts, options, {.longest = 1});

  CHECK(given.options.law == options.law);
  CHECK(given.options.integrator == options.integrator);
  CHECK(given.options.ellipse_law == options.ellipse_law);
  CHECK(given.options.reference_length == options.reference_length);
  CHECK(given.scene.gravity == scene.gravity);
  CHECK(given.contacts.kinds == contacts.kinds);
  for (std::size_t k = 0; k < contacts.pairs.size(); ++k)
    CHECK(given.contacts.pairs[k].properties == contacts.pairs[k].properties);
  CHECK(given.scene.grains[1].inertia.mass == scene.grains[1].inertia.mass);
  CHECK(choose_grain_step(given).step == step.step);
  CHECK(choose_grain_step(given).limit == step.limit);
}
