// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mean stress of a rectangle.
#include <cmath>
#include <numeric>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/fields/box_measures.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Bodies in a square of 1 m with contacts, some with walls, of random places and forces.
struct Scattered {
  std::vector<DiscMotion> places;
  std::vector<BodyContact> contacts;
  std::vector<std::int32_t> all;

  explicit Scattered(std::uint64_t seed, int bodies = 40) {
    Random random(seed);
    const auto vector = [&] { return Vec2{random.uniform(), random.uniform()}; };
    for (int b = 0; b < bodies; ++b) places.push_back({vector(), 0});
    for (int c = 0; c < 4 * bodies; ++c) {
      const int i = c % bodies, j = c % 5 == 0 ? ~0 : (i + 1 + c / bodies) % bodies;
      contacts.push_back({.i = i,
                          .j = j,
                          .arm = 0.5 * (vector() - places[static_cast<std::size_t>(i)].u),
                          .force = vector() - Vec2{0.5, 0.5}});
    }
    all.resize(places.size());
    std::iota(all.begin(), all.end(), 0);
  }
};

double distance(const Tensor2& a, const Tensor2& b) {
  return std::abs(a.xx - b.xx) + std::abs(a.xy - b.xy) + std::abs(a.yx - b.yx) + std::abs(a.yy - b.yy);
}

}  // namespace

TEST_CASE("the_stress_of_a_box_that_holds_all_is_that_of_the_outer_forces_at_their_places") {
  const Scattered scene(GENERATE(1, 2, 3));
  const Rectangle box{{-1, -2}, {2, 1}};
  // The outer forces: walls push at their contacts; what each body then still lacks to be at rest acts at its centre.
  std::vector<Vec2> lacking(scene.places.size());
  Tensor2 outer_moment;
  for (const BodyContact& c : scene.contacts) {
    lacking[static_cast<std::size_t>(c.i)] -= c.force;
    if (c.j >= 0)
      lacking[static_cast<std::size_t>(c.j)] += c.force;
    else
      outer_moment += outer(c.force, scene.places[static_cast<std::size_t>(c.i)].u + c.arm);
  }
  for (std::size_t b = 0; b < lacking.size(); ++b) outer_moment += outer(lacking[b], scene.places[b].u);
  const Tensor2 wanted = (1.0 / 9) * outer_moment;
  const Tensor2 found = region_stress(box, scene.all, scene.places, scene.contacts);
  CAPTURE(found.xx, found.xy, found.yx, found.yy, wanted.xx, wanted.xy, wanted.yx, wanted.yy);
  CHECK(distance(found, wanted) < 1e-13);
  CHECK(distance(wanted, {}) > 1e-2);
}

TEST_CASE("boxes_that_make_up_a_larger_one_add_up_to_its_stress_and_groups_to_that_of_all") {
  const Scattered scene(GENERATE(4, 5, 6));
  const Rectangle whole{{0.1, 0.2}, {0.8, 0.9}};
  const auto stress = [&](const Rectangle& box, const std::vector<std::int32_t>& bodies) {
    return region_stress(box, bodies, scene.places, scene.contacts);
  };
  const Tensor2 all = stress(whole, scene.all);
  Tensor2 sum;
  const double across[] = {0.1, 0.3, 0.45, 0.8}, along[] = {0.2, 0.7, 0.9};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j) {
      const Rectangle part{{across[i], along[j]}, {across[i + 1], along[j + 1]}};
      sum += (across[i + 1] - across[i]) * (along[j + 1] - along[j]) / 0.49 * stress(part, scene.all);
    }
  const std::vector<std::int32_t> first(scene.all.begin(), scene.all.begin() + 17),
      rest(scene.all.begin() + 17, scene.all.end());
  CAPTURE(all.xx, sum.xx, all.yy, sum.yy);
  CHECK(distance(all, {}) > 1e-2);
  CHECK(distance(sum, all) < 1e-13);
  CHECK(distance(stress(whole, first) + stress(whole, rest), all) < 1e-13);
}

TEST_CASE("a_bar_in_tension_has_its_force_over_the_width_of_the_box_wherever_it_crosses_it") {
  // Three bodies in a row pull with 6 N/m; the middle one is the image of one a period of 5 m away.
  const std::vector<DiscMotion> places{{{-2, 0.3}, 0}, {{0.5 + 5, 0.3}, 0}, {{3, 0.3}, 0}};
  const std::vector<BodyContact> contacts{{.i = 0, .j = 1, .arm = {1, 0}, .shift = {-5, 0}, .force = {6, 0}},
                                          {.i = 2, .j = 1, .arm = {-1, 0}, .shift = {-5, 0}, .force = {-6, 0}}};
  const std::vector<std::int32_t> all{0, 1, 2}, ends{0, 2};
  const auto xx = [&](const Rectangle& box, const std::vector<std::int32_t>& bodies) {
    return region_stress(box, bodies, places, contacts).xx;
  };
  CHECK(xx({{-1.9, 0}, {-1.1, 2}}, all) == Approx(6.0 / 2).epsilon(1e-14));
  CHECK(xx({{2.1, 0.3}, {2.9, 0.8}}, all) == Approx(6.0 / 0.5).epsilon(1e-14));  // along its side
  CHECK(xx({{-3, 0}, {-1, 1}}, all) == Approx(6.0 / 2).epsilon(1e-14));          // half of its length
  CHECK(xx({{-1.9, 0.31}, {-1.1, 2}}, all) == 0);
  CHECK(xx({{2, 0}, {3, 1}}, ends) == Approx(6).epsilon(1e-14));
  CHECK(xx({{5, 0}, {6, 1}}, all) == Approx(6).epsilon(1e-14));  // the image stands at its own place
  CHECK(xx({{5, 0}, {6, 1}}, ends) == 0);
}
