// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Results with ellipses and clumps are bit-identical for every order of the bodies and margin, and after a restore.
#include "equidem/core/text.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

#include "grains/resuming.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("the_order_of_bodies_clumps_and_their_discs_changes_no_bit") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const GrainScene scene = mixed_box(stepping.law, 4, 4, 71);
  GrainScene other = scene;
  std::reverse(other.grains.begin(), other.grains.end());
  std::reverse(other.walls.begin(), other.walls.end());
  std::reverse(other.clumps.begin(), other.clumps.end());
  for (Clump& clump : other.clumps) std::reverse(clump.discs.begin(), clump.discs.end());
  for (Grain& grain : other.grains) {
    if (grain.clump >= 0) grain.clump = static_cast<int>(other.clumps.size()) - 1 - grain.clump;
  }
  GrainSimulation one(scene, options_of(stepping, 0.004)), two(other, options_of(stepping, 0.004));
  one.advance(400);
  two.advance(400);
  CHECK(one.counters().contacts > 20);
  CHECK(one.energy().kinetic == two.energy().kinetic);
  std::vector<Grain> expected = one.grains();
  std::reverse(expected.begin(), expected.end());
  const std::vector<Grain> found = two.grains();
  for (std::size_t k = 0; k < found.size(); ++k) {
    CAPTURE(stepping.name(), k);
    CHECK(found[k].position == expected[k].position);
    CHECK(found[k].velocity == expected[k].velocity);
    CHECK(found[k].spin == expected[k].spin);
    CHECK(found[k].angle == expected[k].angle);
  }
}

TEST_CASE("the_margin_changes_no_bit_of_ellipses_and_clumps") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool needles = GENERATE(false, true);
  const GrainScene scene = needles ? flying_needles(24, 33) : mixed_box(stepping.law, 4, 4, 72);
  const auto run = [&](double margin) {
    GrainOptions options = options_of(stepping, needles ? 1e-3 : 0.004);
    options.margin = margin;
    GrainSimulation simulation(scene, options);
    simulation.advance(needles ? 1200 : 400);
    CHECK(simulation.counters().contacts > 10);
    return bits_of(simulation);
  };
  const Bits chosen = run(0);
  for (const double margin : {1e-6, 0.01, 0.3, 10.0}) {
    CAPTURE(stepping.name(), needles, margin);
    CHECK(run(margin) == chosen);
  }
}

TEST_CASE("ellipses_and_clumps_saved_at_any_step_go_on_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool friction = GENERATE(true, false);
  CAPTURE(stepping.name(), friction);
  GrainScene scene = mixed_box(stepping.law, 3, 3, 73);
  if (!friction) scene.pairs[0].friction = 0;
  check_resuming(scene, options_of(stepping, 0.01), 120);
}

TEST_CASE("an_ellipse_slides_over_a_joint_of_segments_as_over_one") {
  // Where walls join, one contact: the floor in two pieces is as stiff as in one.
  const bool clump = GENERATE(false, true);
  const auto run = [&](const std::vector<double>& ends) {
    GrainScene scene = scene_of({}, {}, {.stiffness = 1e4}, {0, -1});
    scene.grains = {clump ? lump(scene, pair_of_discs(), {-3, 1 - 1e-5}, 0, {1, 0})
                          : oval({-3, 0.5}, 1, 0.5, 0.1, {1, 0})};
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      Wall wall;
      wall.shape = Wall::Shape::segment;
      wall.name = std::to_string(k);
      wall.point = {ends[k], 0};
      wall.end = {ends[k + 1], 0};
      scene.walls.push_back(wall);
    }
    GrainSimulation simulation(scene, options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 1e-3));
    simulation.advance(6000);
    CHECK(simulation.grains()[0].position.x > 2.9);
    return simulation.grains()[0];
  };
  const Grain whole = run({-20, 20}), pieces = run({-20, 0, 1, 20});
  CAPTURE(clump, whole.position.y, pieces.position.y, whole.angle, pieces.angle);
  CHECK(norm(whole.position - pieces.position) < 1e-9);
  CHECK(std::abs(whole.angle - pieces.angle) < 1e-9);
}

TEST_CASE("stages_that_change_nothing_leave_contacts_of_all_shapes_as_they_are") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    GrainScene scene = mixed_box(NormalLaw::linear_dashpot, 5, 4, seed);
    for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
    for (PairProperties& pair : scene.pairs) pair.stiffness *= 100;
    scene.gravity = {0, -10};
    const GrainOptions options = options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 1e-3);
    constexpr std::int64_t length = 100, stages = 40;
    std::vector<GrainStage> same;
    for (std::int64_t k = 0; k < stages; ++k)
      same.push_back({.name = fmt::format("{}", k), .scene = scene, .steps = length});
    StagedSimulation staged(same, options);
    GrainSimulation whole(scene, options);
    std::size_t met = 0, listed = 0;
    while (!staged.over()) {
      staged.advance(length);
      whole.advance(length);
      met += whole.contacts().size();
      listed += staged.present().contacts().size();
    }
    const std::vector<Grain> grains = staged.present().grains(), expected = whole.grains();
    std::size_t moved = 0;
    for (std::size_t g = 0; g < grains.size(); ++g)
      if (grains[g].position != expected[g].position || grains[g].angle != expected[g].angle) ++moved;
    CAPTURE(seed, moved, staged.energy().work_of_stages);
    CHECK(listed == met);
    CHECK(met > 400);
    CHECK(moved == 0);
  }
}
