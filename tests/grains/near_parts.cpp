// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The packed loops over pairs of parts do what the loop over single contacts does.
#include "grains/one_by_one.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("contacts_of_parts_by_eights_are_contacts_one_by_one") {
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot);
  const FrictionCap cap = GENERATE(FrictionCap::whole_force, FrictionCap::spring_alone);
  const ContactEnd end = GENERATE(ContactEnd::at_zero_force, ContactEnd::at_zero_overlap);
  const double friction = GENERATE(0.0, 0.05, 0.4);
  const bool needles = GENERATE(false, true);
  GrainScene scene = mixed_box(law, 5, 4, 61);
  scene.pairs[0].friction = friction;
  scene.pairs[0].cap = cap;
  scene.pairs[0].end = end;
  if (needles) {
    for (Grain& grain : scene.grains) {
      if (grain.shape() != GrainShape::clump) grain.short_half_axis = grain.radius / 20;
    }
  }
  const GrainOptions options = options_of({law, Scheme::semi_implicit_euler}, 0.004);
  GrainSimulation eights(scene, options), singles(one_by_one(scene), options);
  double apart = 0;
  for (int k = 0; k < 100; ++k) {
    eights.advance(1);
    singles.advance(1);
    apart = std::max(apart, distance_of_motions(eights, singles));
    const GrainLedger a = eights.energy(), b = singles.energy();
    CAPTURE(to_string(law), static_cast<int>(cap), static_cast<int>(end), friction, needles, k, apart);
    REQUIRE(apart < 1e-9);
    REQUIRE(eights.counters().contacts == singles.counters().contacts);
    REQUIRE(eights.counters().evaluations == singles.counters().evaluations);
    // each predicts the mean velocity of the step, to its second order, from other numbers
    REQUIRE(a.lost_dashpot == Approx(b.lost_dashpot).epsilon(2e-2).margin(1e-12));
    REQUIRE(a.lost_slip == Approx(b.lost_slip).epsilon(1e-7).margin(1e-11));
    REQUIRE(a.lost_tangential_dashpot == Approx(b.lost_tangential_dashpot).epsilon(1e-7).margin(1e-11));
    REQUIRE(a.lost_release == Approx(b.lost_release).epsilon(1e-7).margin(1e-11));
    REQUIRE(a.elastic_normal == Approx(b.elastic_normal).epsilon(1e-7).margin(1e-11));
    REQUIRE(a.elastic_tangential == Approx(b.elastic_tangential).epsilon(1e-7).margin(1e-11));
    const std::vector<GrainContact> here = eights.contacts(), there = singles.contacts();
    REQUIRE(here.size() == there.size());
    for (std::size_t c = 0; c < here.size(); ++c) {
      if (here[c].overlap != Approx(there[c].overlap).margin(1e-9))
        continue;  // clumps: two contacts of a pair in any order
      REQUIRE(here[c].i == there[c].i);
      REQUIRE(here[c].j == there[c].j);
      REQUIRE(here[c].steps == there[c].steps);
      REQUIRE(norm(here[c].normal - there[c].normal) < 1e-7);
      REQUIRE(norm(here[c].arm_i - there[c].arm_i) < 1e-7);
      REQUIRE(norm(here[c].arm_j - there[c].arm_j) < 1e-7);
      REQUIRE(here[c].normal_force == Approx(there[c].normal_force).epsilon(1e-6).margin(1e-6));
      REQUIRE(here[c].tangential_force == Approx(there[c].tangential_force).epsilon(1e-6).margin(1e-6));
    }
  }
  CHECK(eights.counters().contacts > 1);
  CHECK(eights.bytes_per_grain() != singles.bytes_per_grain());  // otherwise it is one loop twice
}
