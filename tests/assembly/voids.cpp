// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/voids.hpp"

#include <cmath>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

double room_at(const Assembly& assembly, Vec2 place) {
  double room = 1e300;
  const Vec2 period = assembly.period.value_or(Vec2{});
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      for (std::size_t d = 0; d < assembly.size(); ++d)
        room = std::min(room, norm(assembly.centres[d] + Vec2{x * period.x, y * period.y} - place) - assembly.radii[d]);
  return room;
}

}  // namespace

TEST_CASE("the_void_between_three_touching_discs_is_that_of_soddy") {
  const Assembly block = hexagonal_lattice({.columns = 5, .rows = 5, .radius = 0.5});
  const auto found = largest_void(block);
  REQUIRE(found);
  CHECK(found->radius == Approx(0.5 * (2 / std::sqrt(3.0) - 1)).epsilon(1e-9));
}

TEST_CASE("a_disc_that_is_taken_out_leaves_a_void_of_its_size") {
  Assembly cell = hexagonal_lattice({.columns = 8, .rows = 8, .radius = 0.5, .periodic = true});
  for (const std::size_t disc : {std::size_t{0}, std::size_t{27}}) {  // at a corner of the cell, and inside it
    Assembly holed = cell;
    const Vec2 place = holed.centres[disc];
    holed.centres.erase(holed.centres.begin() + static_cast<std::ptrdiff_t>(disc));
    holed.radii.erase(holed.radii.begin() + static_cast<std::ptrdiff_t>(disc));
    holed.contacts.clear();
    const auto found = largest_void(holed);
    REQUIRE(found);
    CAPTURE(disc, found->centre.x, found->centre.y, place.x, place.y);
    CHECK(found->radius == Approx(0.5).epsilon(1e-9));
    const Vec2 off = found->centre - place;
    const Vec2 period = *cell.period;
    CHECK(std::hypot(off.x - period.x * std::round(off.x / period.x), off.y - period.y * std::round(off.y / period.y)) <
          1e-9);
  }
}

TEST_CASE("no_place_on_a_grid_has_more_room_than_the_largest_void") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    Assembly cell;
    cell.period = Vec2{2.0, 1.0};
    while (cell.size() < 60) {
      const Vec2 place{random.uniform(0, 2), random.uniform(0, 1)};
      const double radius = random.uniform(0.03, 0.06);
      if (cell.size() > 0 && room_at(cell, place) < radius) continue;
      cell.centres.push_back(place);
      cell.radii.push_back(radius);
    }
    const auto found = largest_void(cell);
    REQUIRE(found);
    double most = 0;
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 200; ++x) most = std::max(most, room_at(cell, {0.01 * x, 0.01 * y}));
    CAPTURE(seed, most, found->radius);
    CHECK(room_at(cell, found->centre) == Approx(found->radius).epsilon(1e-9));
    CHECK(most <= found->radius * (1 + 1e-9));
    CHECK(most > 0.9 * found->radius);
  }
}

TEST_CASE("two_discs_have_no_void_between_them") {
  Assembly pair;
  pair.centres = {{0, 0}, {3, 0}};
  pair.radii = {1, 1};
  CHECK_FALSE(largest_void(pair));
}
