// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/delaunay.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <set>

#include "equidem/assembly/power_cells.hpp"
#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/assembly/triangulation.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/threads.hpp"

#include "geometry_oracle.hpp"
#include "support/catch.hpp"
#include "triangulated_samples.hpp"

using namespace equidem;

namespace {

/// FNV-1a of the bits of everything in an assembly.
class Hash {
 public:
  void add(const auto& value) {
    unsigned char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 0x100000001b3ULL;
  }
  void add_all(const auto& values) {
    for (const auto& value : values) add(value);
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

std::uint64_t hash(const Assembly& a) {
  Hash h;
  h.add_all(a.centres);
  h.add_all(a.radii);
  h.add_all(a.contacts);
  h.add_all(a.cell_areas);
  h.add_all(a.facet_lengths);
  for (const auto& [name, discs] : a.groups) {
    h.add_all(name);
    h.add_all(discs.discs);
    h.add_all(discs.tributary_lengths);
  }
  return h.value();
}

/// Contacts, facets and areas are those of cells that are cut by the images of all discs.
/// \param images on each side of a periodic cell
void check_by_brute_force(const Assembly& a, const TurnedRectangle& box, int images) {
  check(a);
  const oracle::Cells expected = oracle::cells(a, box, images);
  REQUIRE(a.contacts.size() == expected.neighbours.size());
  // Three edges a disc; the images of one disc form a rectangular grid: the diagonals have facets of no length.
  if (a.period) CHECK(a.contacts.size() == (a.size() == 1 ? 2 : 3 * a.size()));
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    CAPTURE(k, a.contacts[k].i, a.contacts[k].j);
    CHECK(oracle::pair(a.contacts[k]) == expected.neighbours[k].pair);
    CHECK(std::abs(a.facet_lengths[k] - expected.neighbours[k].facet) < 1e-10 * a.mean_radius());
  }
  for (std::size_t d = 0; d < a.size(); ++d)
    CHECK(std::abs(a.cell_areas[d] - expected.areas[d]) < 1e-10 * a.mean_radius() * a.mean_radius());
}

PointProcess any_process() {
  return GENERATE(PointProcess::poisson_disc, PointProcess::perturbed_hexagonal, PointProcess::uniform);
}

}  // namespace

TEST_CASE("delaunay_triangles_have_empty_circles") {
  Random random(3);
  const std::vector<Vec2> points = uniform_points({.count = 60}, random).points;

  const auto edges = triangulation_edges(points, {}, hilbert_order(points));

  std::size_t triangles = 0;
  for (const TriangulationEdge& e : edges) {
    for (const std::int32_t third : {e.left, e.right}) {
      if (third < 0) continue;
      ++triangles;
      const Vec2 b = points[e.b] - points[e.a];
      const Vec2 c = points[third] - points[e.a];
      CHECK((cross(b, c) > 0) == (third == e.left));
      const Vec2 centre = points[e.a] - perpendicular(dot(b, b) * c - dot(c, c) * b) / (2 * cross(b, c));
      const double radius = norm(points[e.a] - centre);
      CHECK(norm(points[e.b] - centre) == Approx(radius).epsilon(1e-9));
      for (const Vec2 p : points) CHECK(norm(p - centre) > radius * (1 - 1e-9));
    }
  }
  CHECK(triangles > 3 * points.size());
}

TEST_CASE("cells_are_those_cut_by_brute_force") {
  const PointProcess process = any_process();
  const bool periodic = GENERATE(true, false);
  const auto radii = GENERATE(equal_radii, unequal_radii);
  const double aspect = GENERATE(1.0, 0.3);
  const std::uint64_t seed = GENERATE(1, 2);
  CAPTURE(to_string(process), periodic, radii.largest, aspect, seed);

  const Assembly a = delaunay_assembly({.discs = 60,
                                        .points = process,
                                        .disorder = 0.3,
                                        .seed = seed,
                                        .radii = radii,
                                        .aspect = aspect,
                                        .periodic = periodic});
  check_by_brute_force(a, Rectangle{{0, 0}, extent(a)}, 1);
}

TEST_CASE("tiny_periodic_cells_are_those_cut_by_brute_force") {
  const std::int64_t count = GENERATE(1, 2, 3, 4);
  const auto radii = GENERATE(equal_radii, unequal_radii);
  const double aspect = GENERATE(1.0, 0.25, 2.0);
  const std::uint64_t seed = GENERATE(1, 2, 3, 4, 5);
  CAPTURE(count, radii.largest, aspect, seed);

  const Assembly a = delaunay_assembly({.discs = count,
                                        .points = PointProcess::uniform,
                                        .seed = seed,
                                        .radii = radii,
                                        .aspect = aspect,
                                        .periodic = true});
  check_by_brute_force(a, {}, 6);
}

TEST_CASE("cells_fill_the_rectangle") {
  const PointProcess process = any_process();
  const bool periodic = GENERATE(true, false);
  const auto radii = GENERATE(equal_radii, unequal_radii);
  const std::int64_t count = GENERATE(5, 100, 3000);
  const double aspect = GENERATE(1.0, 7.0);

  const Assembly a = delaunay_assembly(
      {.discs = count, .points = process, .disorder = 0.45, .radii = radii, .aspect = aspect, .periodic = periodic});

  check(a);
  const Vec2 size = extent(a);
  const double mean_diameter = radii.smallest + radii.largest;
  const double per_disc = std::sqrt(3.0) / 2 * mean_diameter * mean_diameter;
  CAPTURE(to_string(process), periodic, radii.largest, count, aspect, a.size());
  CHECK(std::abs(sum(a.cell_areas) / (size.x * size.y) - 1) < 1e-12);
  // The mean spacing is the mean diameter; what hangs loose is left out, some swallowed discs and a corner or two.
  const double share_kept = static_cast<double>(a.size()) * per_disc / (size.x * size.y);
  const bool all_kept = periodic && radii.smallest == radii.largest;
  CHECK(share_kept <= 1 + 1e-12);
  CHECK(share_kept >= (all_kept ? 1 - 1e-12 : count == 5 ? 0.6 : 0.9));
  std::vector<int> contacts(a.size(), 0);
  for (const Contact& c : a.contacts) ++contacts[c.i], ++contacts[c.j];
  CHECK(std::count(contacts.begin(), contacts.end(), 0) == 0);
}

TEST_CASE("levers_reach_from_centre_to_centre") {
  const PointProcess process = any_process();
  const bool periodic = GENERATE(true, false);
  const auto radii = GENERATE(equal_radii, unequal_radii);
  const Assembly a =
      delaunay_assembly({.discs = 300, .points = process, .disorder = 0.1, .radii = radii, .periodic = periodic});
  CAPTURE(to_string(process), periodic, radii.largest);

  for (const Contact& c : a.contacts) {
    const double l = norm(a.branch(c));
    CHECK(c.lever_i + c.lever_j == Approx(l).epsilon(1e-13));
    // On the radical axis both discs have the same power, unless it lies behind a centre.
    const double ri = a.radii[c.i];
    const double rj = a.radii[c.j];
    const bool between = std::abs(ri * ri - rj * rj) <= l * l;
    if (between) {
      CHECK(std::abs((c.lever_i * c.lever_i - ri * ri) - (c.lever_j * c.lever_j - rj * rj)) <
            1e-12 * (ri * ri + l * l));
    } else {
      CHECK(c.lever_i * c.lever_j == 0);
    }
    if (ri == rj) CHECK(c.lever_i == c.lever_j);
  }
}

TEST_CASE("a_periodic_cell_may_be_cut_anywhere") {
  const auto radii = GENERATE(equal_radii, unequal_radii);
  const std::int64_t count = GENERATE(2, 3, 200);
  const Vec2 by = GENERATE(Vec2{0.0131, -0.0077}, Vec2{-1.7, 2.9}, Vec2{1e-9, 0});
  Assembly a = delaunay_assembly({.discs = count, .points = PointProcess::uniform, .radii = radii, .periodic = true});

  Assembly moved = a;
  for (Vec2& x : moved.centres) x += by;
  triangulate(moved);

  CAPTURE(radii.largest, count, by.x, by.y);
  REQUIRE(pairs(moved.contacts) == pairs(a.contacts));
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    CHECK(norm(moved.branch(moved.contacts[k])) == Approx(norm(a.branch(a.contacts[k]))).epsilon(1e-9));
    CHECK(std::abs(moved.facet_lengths[k] - a.facet_lengths[k]) < 1e-9 * a.mean_radius());
  }
  for (std::size_t d = 0; d < a.size(); ++d) CHECK(moved.cell_areas[d] == Approx(a.cell_areas[d]).epsilon(1e-9));

  // Images of single discs may be given too: the shifts follow them.
  moved.centres[1] += Vec2{2 * a.period->x, -a.period->y};
  triangulate(moved);
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    CHECK(norm(moved.branch(moved.contacts[k])) == Approx(norm(a.branch(a.contacts[k]))).epsilon(1e-9));
  }
}

TEST_CASE("sides_of_a_random_assembly_are_shared_out_whole") {
  const PointProcess process = any_process();
  const auto radii = GENERATE(equal_radii, unequal_radii);
  const Assembly a = delaunay_assembly({.discs = 400, .points = process, .radii = radii, .aspect = 2});
  CAPTURE(to_string(process), radii.largest);

  CHECK(sum(group(a, "top").tributary_lengths) == Approx(sum(group(a, "bottom").tributary_lengths)).epsilon(1e-12));
  CHECK(sum(group(a, "right").tributary_lengths) == Approx(sum(group(a, "left").tributary_lengths)).epsilon(1e-12));
  // The disc that holds a corner is the one with the least power there.
  const Vec2 size = extent(a);
  const std::vector<std::pair<const char*, Vec2>> corners = {
      {"bottom_left", {0, 0}}, {"bottom_right", {size.x, 0}}, {"top_left", {0, size.y}}, {"top_right", size}};
  for (const auto& [name, corner] : corners) {
    std::int32_t best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t d = 0; d < a.size(); ++d) {
      const Vec2 to = a.centres[d] - corner;
      const double power = dot(to, to) - a.radii[d] * a.radii[d];
      if (power < least) least = power, best = static_cast<std::int32_t>(d);
    }
    CHECK(group(a, name).discs == std::vector<std::int32_t>{best});
  }
}

TEST_CASE("a_seed_gives_the_same_bits_for_every_number_of_threads") {
  const PointProcess process = any_process();
  const bool periodic = GENERATE(true, false);
  const DelaunayOptions options = {
      .discs = 20000, .points = process, .seed = 5, .radii = unequal_radii, .periodic = periodic};
  CAPTURE(to_string(process), periodic);
  const int before = thread_count();

  set_thread_count(1);
  const std::uint64_t one = hash(delaunay_assembly(options));
  const std::uint64_t again = hash(delaunay_assembly(options));
  set_thread_count(3);
  const std::uint64_t three = hash(delaunay_assembly(options));
  set_thread_count(before);
  DelaunayOptions other = options;
  other.seed = 6;

  CHECK(again == one);
  CHECK(three == one);
  CHECK(hash(delaunay_assembly(other)) != one);
}

TEST_CASE("a_triangulation_fills_the_box_asked_for_with_discs_of_the_radius_asked_for") {
  const PointProcess points = any_process();
  const bool periodic = GENERATE(true, false);
  const Vec2 box{0.31, 0.11};
  const RadiusDistribution radii{.smallest = 0.004, .largest = 0.006};
  const Assembly a = delaunay_assembly(
      {.discs = discs_that_fill(box, radii), .points = points, .radii = radii, .periodic = periodic, .box = box});
  CAPTURE(static_cast<int>(points), periodic, a.size());
  CHECK(a.area() == Approx(box.x * box.y).epsilon(1e-12));
  if (periodic) CHECK(*a.period == box);
  for (const Vec2 x : a.centres) {
    CHECK((x.x >= 0 && x.x <= box.x));
    CHECK((x.y >= 0 && x.y <= box.y));
  }
  const auto [smallest, largest] = std::ranges::minmax(a.radii);
  CHECK((smallest >= radii.smallest && largest <= radii.largest));
  // 2 sqrt3 a² for each of them, to the scatter of the point process.
  CHECK(static_cast<double>(a.size()) == Approx(box.x * box.y / (2 * std::sqrt(3.0) * 0.005 * 0.005)).epsilon(0.05));
}

TEST_CASE("boxes_that_no_discs_fill_are_refused") {
  const RadiusDistribution radii{.smallest = 0.005, .largest = 0.005};
  CHECK_THROWS_AS(discs_that_fill({1e-4, 1e-4}, radii), Error);
  CHECK_THROWS_AS(discs_that_fill({1e4, 1e4}, radii), Error);
  CHECK_THROWS_AS(delaunay_assembly({.discs = 50, .box = Vec2{-0.1, -0.1}}), Error);
  CHECK_THROWS_AS(delaunay_assembly({.discs = 50, .box = Vec2{10, 1e-3}}), Error);
}
