// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ellipses, clumps and the springs of packings in cases of grains.
#include "equidem/grains/scene/grain_shapes.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/wave_speed_springs.hpp"

#include "example.hpp"
#include "grain_example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const std::string soil = R"(schema = "equidem/1"
[grains]
density = 2480.0
[[grain]]
position = [0.0, 0.02]
radius = 0.01
[[grain]]
position = [0.1, 0.03]
half_axes = [0.02, 0.01]
angle = 0.5
[[grain]]
position = [0.2, 0.05]
discs = [[1.0, 2.0, 0.01], [1.015, 2.0, 0.01]]
[collisions]
law = "linear_dashpot"
shear_wave_speed = 150.0
poisson_ratio = 0.25
damping = 0.3
friction = 0.17
[collisions.walls]
friction = 0.25
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[run]
duration = 0.1
integrator = "velocity_verlet"
)";

std::string refused(const std::string& text) {
  return test::refusal_of([&] { parse_grain_case(text, "soil.toml", {}); }).message;
}

}  // namespace

TEST_CASE("grains_have_the_shapes_of_their_keys") {
  const GrainCase c = grains(soil);
  REQUIRE(c.scene.grains.size() == 3);
  CHECK(c.scene.grains[0].shape() == GrainShape::disc);
  CHECK(c.scene.grains[1].shape() == GrainShape::ellipse);
  CHECK(c.scene.grains[1].radius == 0.02);
  CHECK(c.scene.grains[1].short_half_axis == 0.01);
  CHECK(c.scene.grains[1].inertia.mass == Approx(2480 * std::numbers::pi * 0.02 * 0.01));
  CHECK(c.scene.grains[1].inertia.moment == Approx(c.scene.grains[1].inertia.mass * (0.02 * 0.02 + 0.01 * 0.01) / 4));
  REQUIRE(c.scene.grains[2].shape() == GrainShape::clump);
  const Clump& clump = c.scene.clumps[static_cast<std::size_t>(c.scene.grains[2].clump)];
  CHECK(clump.discs[0].offset.x == Approx(-0.0075));
  CHECK(clump.discs[1].offset.x == Approx(0.0075));
  CHECK(std::abs(clump.discs[1].offset.y) < 1e-15);
  CHECK(c.scene.grains[2].radius == Approx(0.0175));
  // Two discs without the lens that they share.
  const double r = 0.01, d = 0.015;
  const double lens = 2 * r * r * std::acos(d / (2 * r)) - 0.5 * d * std::sqrt(4 * r * r - d * d);
  CHECK(c.scene.grains[2].inertia.mass == Approx(2480 * (2 * std::numbers::pi * r * r - lens)));
}

TEST_CASE("the_settings_of_a_packing_are_those_of_a_run") {
  const GrainCase c = grains(soil);
  const SpringConstants springs = springs_of_wave_speeds(2480, wave_speeds_from_shear(150, 0.25));
  for (const bool at_wall : {false, true}) {
    CAPTURE(at_wall);
    const PairProperties& pair = c.contacts.between(0, at_wall ? 1 : 0).properties;
    // Dashpots 2 h sqrt(m k) (2.27); m/2 moves along the normal, at a wall m; a third of it along the tangent of a
    // disc.
    const double mass = 3.0, moved = at_wall ? mass : mass / 2;
    const double zeta = dashpot_of(0.3, mass, springs.kN) / (2 * std::sqrt(moved * springs.kN));
    CHECK(damping_ratio_of(pair.restitution, pair.end) == Approx(zeta));
    CHECK(pair.tangential_damping ==
          Approx(dashpot_of(0.3, mass, springs.kT) / (2 * std::sqrt(moved / 3 * springs.kT))));
    CHECK(pair.stiffness == springs.kN);
    CHECK(pair.tangential_ratio == Approx(springs.kT / springs.kN));
    CHECK(pair.friction == (at_wall ? 0.25 : 0.17));
    CHECK(pair.end == ContactEnd::at_zero_force);
  }
}

TEST_CASE("an_automatic_step_follows_needles_that_turn") {
  const std::string heavy = changed(changed(changed(soil, "radius = 0.01", "radius = 0.1"),
                                            "[[1.0, 2.0, 0.01], [1.015, 2.0, 0.01]]", "[[0.0, 0.0, 0.1]]"),
                                    "damping = 0.3", "restitution = 1.0");
  const auto step_of = [&](const std::string& shape) {
    return choose_grain_step(grains(changed(heavy, "half_axes = [0.02, 0.01]", shape))).step;
  };
  // Of equal mass: the needle turns away under a push near its tip.
  const double round = step_of("half_axes = [0.02, 0.02]"), needle = step_of("half_axes = [0.2, 0.002]");
  CAPTURE(round, needle);
  CHECK(needle < 0.6 * round);
}

TEST_CASE("springs_of_wave_speeds_need_one_density_and_no_other_ratio") {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {changed(soil, "angle = 0.5", "density = 1000.0"), "densities from 1000 to 2480"},
      {changed(soil, "damping = 0.3", "damping = 0.3\ntangential_ratio = 0.5"), "tangential_ratio"},
      {changed(soil, "poisson_ratio = 0.25", "poisson_ratio = 0.5"), "0.5"},
      {changed(soil, "shear_wave_speed = 150.0\n", "stiffness = 1e6\n"), "without shear_wave_speed"},
      {changed(soil, "law = \"linear_dashpot\"", "law = \"energy_map\""), "no use for damping"},
      {changed(soil, "[0.02, 0.01]", "[0.01, 0.02]"), "Exchange them"}};
  for (const auto& [text, words] : wrong) {
    const std::string sentence = refused(text);
    CAPTURE(sentence, words);
    CHECK(sentence.find(words) != std::string::npos);
  }
}

TEST_CASE("ellipses_meet_by_the_test_asked_for") {
  using enum GrainOptions::EllipseLaw;
  CHECK(grains(soil).options.ellipse_law == exact);
  for (const auto& [word, law] : {std::pair{"exact", exact}, {"enlarged", enlarged}}) {
    const GrainCase c = grains(soil, {fmt::format("collisions.ellipse_contact={}", word)});
    CAPTURE(word);
    CHECK(grain_options(c, 1e-6).ellipse_law == law);
  }
}

TEST_CASE("clumps_of_one_shape_are_kept_once_and_stay_where_they_are_centred") {
  GrainShapes shapes(Body::disc);
  std::vector<Grain> made(3);
  shapes.make_clump(made[0], {{{3, 1}, 0.5}, {{3.7, 1}, 0.3}}, 1000);
  shapes.make_clump(made[1], {{{3, 1}, 0.5}, {{3.7, 1}, 0.3}}, 2000);
  CHECK(made[0].clump == made[1].clump);
  CHECK(made[1].inertia.mass == Approx(2 * made[0].inertia.mass));
  const auto centred = shapes.clumps()[0].discs;
  shapes.make_clump(made[2], centred, 1000);
  const auto& again = shapes.clumps()[static_cast<std::size_t>(made[2].clump)].discs;
  for (std::size_t d = 0; d < centred.size(); ++d) CHECK(again[d].offset == centred[d].offset);
}
