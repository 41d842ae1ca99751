// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Processors with wide vectors and without give the same bits.
#include "equidem/grains/kernels/vector_width.hpp"

#include "equidem/grains/contacts/bond_breaking.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Neighbours of a busy box tied two by two.
GrainScene busy_pairs(NormalLaw law) {
  GrainScene scene = busy_box(law, 8, 6, 31);
  for (std::size_t k = 0; k + 1 < scene.grains.size(); k += 2) {
    GrainBond bond{.normal_dashpot = 300, .tangential_dashpot = 200};
    bond.i = k, bond.j = k + 1;
    scene.bonds.push_back(bond);
  }
  return scene;
}

/// Rows of a busy box tied by bonds, of which some break.
GrainScene breaking_rows(NormalLaw law) {
  GrainScene scene = busy_box(law, 8, 6, 31);
  GrainBond like = all_of_a_bond;
  like.normal_spring = 300, like.tangential_spring = 150, like.bending_spring = 5;
  for (std::size_t k = 0; k + 1 < scene.grains.size(); ++k) {
    if (k % 6 == 5) continue;
    like.i = k, like.j = k + 1;
    scene.bonds.push_back(like);
  }
  scene.strengths = bond_strengths(scene, {.tension = 30, .shear = 20, .friction = 0.2, .weibull_modulus = 3.0});
  return scene;
}

}  // namespace

TEST_CASE("every_width_of_vectors_gives_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  struct Case {
    const char* name;
    GrainScene scene;
    double step;
  };
  std::vector<Case> cases{{"discs", busy_box(stepping.law, 8, 6, 31), 0.004},
                          {"ellipses, clumps and discs", mixed_box(stepping.law, 4, 4, 72), 0.004},
                          {"needles", flying_needles(24, 33), 1e-3}};
  if (stepping.law == NormalLaw::linear_dashpot) {
    cases.push_back({"bonded pairs", busy_pairs(stepping.law), 0.004});
    cases.push_back({"bonds that break", breaking_rows(stepping.law), 0.004});
  }
  for (const Case& each : cases) {
    const auto run = [&](VectorWidth widest) {
      allow_vectors_up_to(widest);
      GrainSimulation simulation(each.scene, options_of(stepping, each.step));
      simulation.advance(600);
      CAPTURE(each.name, stepping.name());
      CHECK(simulation.counters().contacts > 10);
      allow_vectors_up_to(VectorWidth::bits_512);
      return bits_of(simulation);
    };
    const Bits narrow = run(VectorWidth::bits_128);
    CAPTURE(each.name, stepping.name(), static_cast<int>(vector_width()));
    CHECK(run(VectorWidth::bits_256) == narrow);
    CHECK(run(VectorWidth::bits_512) == narrow);
  }
}
