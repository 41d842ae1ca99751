// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/core/error.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/size_distribution.hpp"

#include "packing/packings.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

namespace {

constexpr PackingBox::Sides closed[] = {PackingBox::Sides::walls, PackingBox::Sides::periodic};

}  // namespace

TEST_CASE("a_seed_gives_the_same_bits_for_every_number_of_threads_and_another_seed_does_not") {
  const int before = thread_count();
  for (const auto& entry : EnumNames<PackingMethod>::list) {
    const bool falls = entry.value == PackingMethod::falling;
    PackingOptions options =
        falls ? falling_soil(30, 0.1) : square_box(entry.value, PackingBox::Sides::walls, 100, 0.45);
    INFO(entry.name);
    set_thread_count(1);
    const GrainPacking first = pack(options);
    set_thread_count(3);
    const GrainPacking again = pack(options);
    set_thread_count(before);
    CHECK(centres_of(first) == centres_of(again));
    CHECK(first.radii == again.radii);
    CHECK(first.work == again.work);
    options.seed = 2;
    CHECK(centres_of(first) != centres_of(pack(options)));
  }
}

// Feder (1980): the solid fraction of n throws lags behind that of infinitely many by a multiple of n^(-1/2). Equal
// discs: 0.547070 (Zhang & Torquato 2013, Phys. Rev. E 88, 053312).
TEST_CASE("equal_discs_thrown_at_random_approach_their_known_limit_from_below") {
  PackingOptions options;
  options.method = PackingMethod::rejection;
  options.box = {{1, 1}, PackingBox::Sides::periodic};
  options.as_dense_as_possible = true;
  options.attempts = 1;
  constexpr double radius = 0.005, limit = 0.547070;
  const double throws_per_time = 1 / (3.141592653589793 * radius * radius);
  const auto after = [&](double time) {
    options.radii.assign(static_cast<std::size_t>(time * throws_per_time), radius);
    return area_of_discs(pack(options).radii);
  };
  const double early = after(16), late = after(64);
  const double extrapolated = 2 * late - early;  // four times the throws: half the lag
  CAPTURE(early, late, extrapolated);
  CHECK(early < late);
  CHECK(late < limit);
  // The scatter of the solid fraction of 7000 discs is 0.001.
  CHECK(extrapolated == Approx(limit).margin(0.006));
}

TEST_CASE("discs_that_grow_without_end_jam_where_every_disc_held_has_the_contacts_that_rigidity_needs") {
  PackingOptions options = square_box(PackingMethod::growth, PackingBox::Sides::periodic, 400, 0.5);
  options.as_dense_as_possible = true;
  options.overlap = GENERATE(1e-3, 1e-5);
  const GrainPacking packing = pack(options);
  const PackingMeasures measures = measure(packing);
  CAPTURE(options.overlap, measures.solid_fraction, measures.coordination_without_rattlers, measures.rattlers);
  CHECK(measures.solid_fraction > 0.82);
  CHECK(measures.solid_fraction < 0.88);
  // Maxwell: two equations a disc, less two for the translations of all, and one more contact to press.
  const double held = static_cast<double>(packing.size()) - static_cast<double>(measures.rattlers);
  const double isostatic = 4 - 2 / held;
  CHECK(measures.coordination_without_rattlers >= isostatic - 1e-9);
  // It rises with the root of the overlap: z - 4 = 3.6 (phi - phi_J)^0.5 or so (O'Hern et al. 2003).
  CHECK(measures.coordination_without_rattlers < 4 + 8 * std::sqrt(options.overlap));
  // Radii keep their ratios.
  CHECK(packing.radii[7] / packing.radii[3] == Approx(options.radii[7] / options.radii[3]).epsilon(2e-9));
}

TEST_CASE("discs_that_rearrange_while_they_jam_are_jammed_at_any_overlap_asked_for") {
  // After these rearranged, steps of twice the overlap would not come back to jamming in 40 attempts.
  const std::uint64_t seed = GENERATE(47, 308, 312, 401, 425);
  PackingOptions jammed;
  jammed.box.sides = PackingBox::Sides::periodic;
  jammed.as_dense_as_possible = true;
  jammed.overlap = 1e-7;
  const ScalablePacking packing{jammed, {.grains = 60, .box = Vec2{0.5, 0.5}}, {.smallest = 0.005, .largest = 0.01}};
  const PackingMeasures measures = measure(pack(resized(packing, 60, seed)));
  CAPTURE(seed, measures.solid_fraction, measures.largest_overlap);
  CHECK(measures.solid_fraction > 0.8);
  CHECK(measures.largest_overlap > 1e-7);
  CHECK(measures.largest_overlap < 1e-5);
}

TEST_CASE("what_does_not_fit_is_refused_with_what_was_reached") {
  const auto problem = [](const PackingOptions& options) {
    const test::Refusal refused = test::refusal_of([&] { pack(options); });
    return refused.message.empty() ? "none" : refused.problem;
  };
  PackingOptions options = square_box(PackingMethod::rejection, PackingBox::Sides::walls, 200, 0.7);
  options.attempts = 200;
  CHECK(problem(options).find("of 200 discs found a place") != std::string::npos);
  options.method = PackingMethod::insertion;
  options.box.size *= 0.9;
  CHECK(problem(options).find("of 200 discs found a gap") != std::string::npos);
  options.method = PackingMethod::local_moves;
  CHECK(problem(options).find("still overlap") != std::string::npos);
  options = square_box(PackingMethod::growth, PackingBox::Sides::walls, 100, 0.93);
  CHECK(problem(options).find("jam") != std::string::npos);
  options = square_box(PackingMethod::growth, PackingBox::Sides::walls, 100, 1.2);
  CHECK(problem(options).find("1.2 times the area") != std::string::npos);
  options = square_box(PackingMethod::growth, PackingBox::Sides::periodic, 100, 0.93);
  std::fill(options.radii.begin(), options.radii.end(), 0.0075);
  options.box.size *= std::sqrt(area_of_discs(options.radii) / 0.91 / options.box.area());
  CHECK(problem(options).find("solid fraction of 0.91") != std::string::npos);
  options.box.sides = PackingBox::Sides::open_top;
  CHECK(problem(options).find("open top") != std::string::npos);
  options = square_box(PackingMethod::growth, PackingBox::Sides::walls, 3, 0.5);
  options.box.size.x = 0.001;
  CHECK(problem(options).find("the largest disc is") != std::string::npos);
  options.radii.clear();
  CHECK(problem(options).find("no bodies") != std::string::npos);
  CHECK_THROWS_AS(enum_from<PackingMethod>("grow"), Error);
}

TEST_CASE("radii_of_bodies_that_grow_until_they_jam_are_only_ratios") {
  const auto grow = [](std::int64_t discs, PackingBox::Sides sides, double factor) {
    PackingOptions options = square_box(PackingMethod::growth, sides, discs, 0.8);
    for (double& radius : options.radii) radius *= factor;
    options.as_dense_as_possible = true;
    options.overlap = 1e-4;
    return pack(options);
  };
  for (const auto sides : {PackingBox::Sides::periodic, PackingBox::Sides::walls}) {
    const GrainPacking given = grow(30, sides, 1);
    for (const double factor : {1e-50, 1e-3, 0.1, 3.7, 100.0, 1e50}) {
      const GrainPacking packing = grow(30, sides, factor);
      CAPTURE(factor);
      CHECK(packing.radii == given.radii);
      CHECK(centres_of(packing) == centres_of(given));
    }
  }
  // A period holds two bodies side by side, whatever radii were given.
  for (const double factor : {1e-3, 1.0, 100.0}) {
    CAPTURE(factor);
    for (const std::int64_t discs : {2, 3})
      CHECK_THROWS_WITH(grow(discs, PackingBox::Sides::periodic, factor),
                        Catch::Contains("a period holds two of them"));
    CHECK(grow(2, PackingBox::Sides::walls, factor).jammed);
  }
}

TEST_CASE("a_packing_that_fails_keeps_the_bodies_as_they_lie_and_says_why") {
  const auto check_kept = [](const PackingOptions& options, std::size_t least, const std::string& why) {
    const GrainPacking packing = try_to_pack(options);
    REQUIRE(packing.failure);
    INFO(packing.failure->what());
    CHECK(packing.failure->problem().find(why) != std::string::npos);
    CHECK(packing.size() >= least);
    CHECK(packing.grains.size() == packing.size());
    CHECK_NOTHROW(measure(packing, Rectangle{{0, 0}, packing.box.size}));
    CHECK_THROWS_AS(pack(options), Error);
  };
  PackingOptions options = square_box(PackingMethod::rejection, PackingBox::Sides::walls, 200, 0.7);
  options.attempts = 200;
  check_kept(options, 50, "found a place");
  options.method = PackingMethod::insertion;
  options.box.size *= 0.9;
  check_kept(options, 50, "found a gap");
  options.method = PackingMethod::local_moves;
  check_kept(options, 200, "still overlap");
  options = square_box(PackingMethod::growth, PackingBox::Sides::walls, 100, 0.93);
  check_kept(options, 100, "the solid fraction of 0.93 that is asked for");
  options = falling_soil(20, 0.1);
  options.settling.longest = 0.05;
  check_kept(options, 20, "not at rest");
}

// The centre of a clump is known to rounding only; what is nearly round is turned by next to nothing.
TEST_CASE("bodies_that_are_round_or_nearly_so_jam_like_discs") {
  using Kind = PackingShape::Kind;
  const PackingShape shapes[] = {{},
                                 {.kind = Kind::clump, .discs = {{{0, 0}, 1}}},
                                 {.kind = Kind::clump, .discs = {{{5, 5}, 1}}},
                                 {.kind = Kind::ellipse, .aspect = 1},
                                 {.kind = Kind::ellipse, .aspect = 1 + 1e-10},
                                 {.kind = Kind::ellipse, .aspect = 1.00001}};
  for (const PackingShape& shape : shapes) {
    for (const PackingBox::Sides sides : closed) {
      PackingOptions options = square_box(PackingMethod::growth, sides, 40, 0.5);
      options.shape = shape;
      options.as_dense_as_possible = true;
      options.overlap = 1e-3;
      const PackingMeasures measures = measure(pack(options), Rectangle{{0, 0}, options.box.size});
      CAPTURE(to_string(shape.kind), shape.aspect, measures.solid_fraction, measures.coordination);
      CHECK(measures.solid_fraction > 0.77);
      CHECK(measures.solid_fraction < 0.86);
      CHECK(measures.coordination < 4.5);
    }
  }
}
