// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/geometry/neighbours.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/threads.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

namespace {

struct Case {
  std::string name;
  std::vector<Circle> circles;
};

std::vector<Circle> scattered(Random& random, int count, double ratio, Vec2 low, Vec2 extent) {
  std::vector<Circle> circles;
  for (int k = 0; k < count; ++k) {
    // Equal areas per factor in size, so that small ones are many.
    const double radius = 1 / std::sqrt(random.uniform(1 / (ratio * ratio), 1));
    circles.push_back({low + Vec2{random.uniform() * extent.x, random.uniform() * extent.y}, radius});
  }
  return circles;
}

/// A square lattice with the spacing of one diameter: rows and columns of any grid lie on boundaries of its cells.
std::vector<Circle> lattice(int side, double spacing, Vec2 low) {
  std::vector<Circle> circles;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) circles.push_back({low + Vec2{spacing * x, spacing * y}, 0.5 * spacing});
  }
  return circles;
}

std::vector<Case> cases() {
  Random random(5);
  std::vector<Case> all;
  for (const double ratio : {1.0, 1.5, 100.0, 1e4}) {
    all.push_back({"ratio " + std::to_string(ratio), scattered(random, 1200, ratio, {}, {60, 60})});
  }
  all.push_back({"two sizes, the large ones last", scattered(random, 800, 1, {}, {1e4, 1e4})});
  for (int k = 0; k < 20; ++k) {
    all.back().circles.push_back({{random.uniform(0, 1e4), random.uniform(0, 1e4)}, 1e3});
  }
  all.push_back({"far away", scattered(random, 500, 3, {1e9, -1e9}, {30, 30})});
  all.push_back({"so far away that centres round to few places", scattered(random, 500, 3, {-3e16, 1e16}, {30, 30})});
  all.push_back({"a heap and fugitives", scattered(random, 600, 2, {}, {30, 30})});
  for (const double far : {1e4, 1e9, 1e14, 1e30, 1e149}) {
    all.back().circles.push_back({{far, -far}, 1});
    all.back().circles.push_back({{far, -far}, 1});
  }
  all.push_back({"thinly spread", scattered(random, 500, 1, {}, {1e12, 1e12})});
  all.push_back({"in one row", scattered(random, 500, 2, {-1e5, 3}, {1e3, 0})});
  all.push_back({"in one column", scattered(random, 500, 2, {3, -1e5}, {0, 1e3})});
  all.push_back({"lattice", lattice(25, 1, {})});
  all.push_back({"lattice of tenths", lattice(25, 0.1, {-0.3, 7.7})});
  all.push_back({"lattice far away", lattice(25, 2, {1e9, 1e9})});
  all.push_back({"all in one place", std::vector<Circle>(60, Circle{{0.1, 0.2}, 0.5})});
  all.push_back({"points in one place", std::vector<Circle>(60, Circle{{0.1, 0.2}, 0})});
  all.push_back({"points and discs", scattered(random, 400, 3, {}, {20, 20})});
  for (std::size_t k = 0; k < all.back().circles.size(); k += 3) all.back().circles[k].radius = 0;
  all.push_back({"two", {{{0, 0}, 1}, {{1.5, 0}, 1}}});
  all.push_back({"one", {{{4, 5}, 1}}});
  all.push_back({"none", {}});
  all.push_back({"sizes over 60 orders of magnitude", {}});
  for (int k = -30; k <= 30; ++k) {
    const double size = std::pow(10.0, k);
    all.back().circles.push_back({{size, 0}, size});
    all.back().circles.push_back({{-size, 0.3 * size}, 0.7 * size});
  }
  return all;
}

/// By comparison of all pairs.
NeighbourList neighbours_by_brute_force(const std::vector<Circle>& circles, double margin) {
  NeighbourList list;
  list.begin.push_back(0);
  for (std::size_t a = 0; a < circles.size(); ++a) {
    for (std::size_t b = a + 1; b < circles.size(); ++b) {
      const Vec2 branch = circles[a].centre - circles[b].centre;
      const double reach = circles[a].radius + circles[b].radius + margin;
      if (dot(branch, branch) < reach * reach) list.partner.push_back(static_cast<std::int32_t>(b));
    }
    list.begin.push_back(static_cast<std::int64_t>(list.partner.size()));
  }
  return list;
}

void check_equal(const NeighbourList& list, const NeighbourList& expected) {
  CAPTURE(list.partner.size(), expected.partner.size());
  CHECK(list.begin == expected.begin);
  CHECK(list.partner == expected.partner);
}

}  // namespace

TEST_CASE("the_rows_find_the_pairs_that_comparing_all_finds") {
  NeighbourFinder finder;
  for (const auto& [name, circles] : cases()) {
    for (const double margin : {0.0, 0.05, 1.0, 40.0, 1e6}) {
      CAPTURE(name, circles.size(), margin);
      const NeighbourList expected = neighbours_by_brute_force(circles, margin);
      check_equal(neighbours_within(circles, margin), expected);
      check_equal(finder.within(circles, margin), expected);
    }
  }
}

TEST_CASE("touching_is_not_near_and_the_next_number_is") {
  const double above = std::nextafter(2.0, 3.0);
  const double below = std::nextafter(2.0, 1.0);
  const auto pairs = [](double distance, double margin) {
    return neighbours_within(std::vector<Circle>{{{0, 0}, 0.75}, {{0, distance}, 1.25}}, margin).partner.size();
  };
  CHECK(pairs(2, 0) == 0);
  CHECK(pairs(above, 0) == 0);
  CHECK(pairs(below, 0) == 1);
  CHECK(pairs(2, 1e-12) == 1);
}

TEST_CASE("neither_threads_nor_what_was_searched_before_change_the_list") {
  Random random(3);
  const std::vector<Circle> circles = scattered(random, 60000, 30, {}, {1500, 1500});
  const int threads = thread_count();
  set_thread_count(1);
  const NeighbourList alone = neighbours_within(circles, 0.3);
  NeighbourFinder finder;
  for (const int count : {2, 4}) {
    set_thread_count(count);
    CAPTURE(count, alone.partner.size());
    (void)finder.within(lattice(200, 1, {}), 1);
    check_equal(finder.within(circles, 0.3), alone);
  }
  set_thread_count(threads);
}

TEST_CASE("the_order_of_the_bodies_renames_the_pairs_only") {
  Random random(4);
  const std::vector<Circle> circles = scattered(random, 2000, 20, {}, {300, 300});
  const std::vector<Circle> reversed(circles.rbegin(), circles.rend());
  const NeighbourList list = neighbours_within(circles, 0.2);
  const NeighbourList other = neighbours_within(reversed, 0.2);
  const auto last = static_cast<std::int32_t>(circles.size()) - 1;
  std::vector<std::vector<std::int32_t>> renamed(circles.size());
  for (std::int32_t i = 0; i <= last; ++i) {
    for (auto k = other.begin[static_cast<std::size_t>(i)]; k < other.begin[static_cast<std::size_t>(i) + 1]; ++k) {
      const std::int32_t j = other.partner[static_cast<std::size_t>(k)];
      renamed[static_cast<std::size_t>(last - j)].insert(renamed[static_cast<std::size_t>(last - j)].begin(), last - i);
    }
  }
  REQUIRE(list.partner.size() == other.partner.size());
  std::vector<std::int32_t> partner;
  for (const auto& row : renamed) partner.insert(partner.end(), row.begin(), row.end());
  CHECK(partner == list.partner);
}

TEST_CASE("bodies_that_are_nowhere_are_refused") {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const int what : {0, 1, 2}) {
      std::vector<Circle> circles = lattice(4, 1, {});
      (what == 0 ? circles[7].centre.x : what == 1 ? circles[7].centre.y : circles[7].radius) = bad;
      CAPTURE(bad, what);
      test::check_refused([&] { (void)neighbours_within(circles, 0.1); }, {"body 7 "}, ErrorKind::computation_failed);
    }
  }
}
