// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The Brillouin zone, and what is largest over it: where lattices lose their stiffness, what frequency is highest.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Case {
  Assembly assembly;
  ContactSprings springs;
  BlochWaves waves;
  BrillouinZone zone;

  Case(Assembly discs, double ratio, bool rotation = true, double beta = 0.5)
      : assembly(std::move(discs)),
        springs(SpringConstants{1, ratio}),
        waves(primitive_cell(assembly, springs), unit_masses(assembly, beta), rotation),
        zone(brillouin_zone(waves.cell().period)) {}

  [[nodiscard]] ZoneMaximum critical() const {
    return maximize_over_zone(zone, [this](Vec2 q) { return waves.critical_ratio(q); });
  }
  [[nodiscard]] ZoneMaximum highest() const {
    return maximize_over_zone(zone, [this](Vec2 q) { return waves.squared_frequencies(q).back(); });
  }
  [[nodiscard]] ZoneMaximum growing() const {
    return maximize_over_zone(zone, [this](Vec2 q) { return -waves.squared_frequencies(q).front(); });
  }
};

int count(const std::vector<ZonePoint>& points, const std::string& name) {
  return static_cast<int>(std::count_if(points.begin(), points.end(), [&](const auto& p) { return p.name == name; }));
}

}  // namespace

TEST_CASE("every_corner_and_middle_of_the_zone_is_as_near_to_gamma_as_to_its_neighbours") {
  const std::array<Vec2, 2> period =
      GENERATE(std::array{Vec2{2, 0}, Vec2{1, std::sqrt(3.0)}}, std::array{Vec2{0, 2}, Vec2{-2, 0}},
               std::array{Vec2{3, 0}, Vec2{0, 2}}, std::array{Vec2{2, 0}, Vec2{0.7, 2.9}},
               std::array{Vec2{1, 2}, Vec2{-1, 2}}, std::array{Vec2{2, 1}, Vec2{0, 3}});
  const BrillouinZone zone = brillouin_zone(period);
  CAPTURE(zone.lattice, period[0].x, period[0].y, period[1].x, period[1].y);
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b)
      CHECK(dot(period[a], zone.reciprocal[b]) == Approx(a == b ? 2 * std::numbers::pi : 0).margin(1e-14));
  for (const ZonePoint& point : zone.points) {
    int nearest = 0;  // reciprocal lattice points on the circle around it through Gamma
    double closest = std::numeric_limits<double>::infinity();
    for (int i = -3; i <= 3; ++i) {
      for (int j = -3; j <= 3; ++j) {
        const double distance = norm(point.q - i * zone.reciprocal[0] - j * zone.reciprocal[1]);
        closest = std::min(closest, distance);
        nearest += std::abs(distance - norm(point.q)) < 1e-12 * norm(zone.reciprocal[0]) ? 1 : 0;
      }
    }
    CAPTURE(point.name, point.q.x, point.q.y, closest);
    CHECK(norm(point.q) == Approx(closest).margin(1e-12));
    const bool corner = point.name[0] == 'H' || point.name == "K";
    const bool of_rectangle = point.name == "S" || (point.name == "M" && zone.lattice == "square");
    CHECK(nearest == (point.name == "Gamma" ? 1 : corner ? 3 : of_rectangle ? 4 : 2));
    CHECK(zone.name_of(point.q + zone.reciprocal[0] - zone.reciprocal[1]) == point.name);
  }
}

TEST_CASE("the_grid_is_the_whole_zone_once_with_its_mirror_image") {
  const BrillouinZone zone = brillouin_zone({Vec2{2, 0}, Vec2{0.7, 2.9}});
  const int n = 8;
  const std::vector<Vec2> grid = zone_grid(zone, n);
  int known = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Vec2 q = 1.0 / n * (i * zone.reciprocal[0] + j * zone.reciprocal[1]);
      known += std::any_of(grid.begin(), grid.end(), [&](Vec2 p) { return zone.equivalent(p, q); }) ? 1 : 0;
    }
  }
  CHECK(known == n * n);
}

// Abe's unexplained threshold: K(M) = diag(2 kN + 6 kT, 6 kN + 2 kT, 4 kT a²).
TEST_CASE("the_hexagonal_lattice_gives_way_at_minus_one_third_at_three_points_m") {
  const auto [columns, rows] = GENERATE(std::pair{1, 2}, std::pair{5, 4}, std::pair{3, 2});
  const Case hexagonal(periodic_hexagonal(columns, rows), 0.5);
  const ZoneMaximum critical = hexagonal.critical();
  CAPTURE(columns, rows, critical.value, critical.at.name, critical.at.q.x, critical.at.q.y);
  CHECK(std::abs(critical.value + 1.0 / 3) < 1e-14);
  CHECK(critical.at.name == "M");
  CHECK(count(critical.points, "M") == 3);
  CHECK(critical.points.size() == 3);
  for (const double value : critical.on_grid) CHECK(!(value > -1.0 / 3 + 1e-13));
}

TEST_CASE("the_square_lattice_gives_way_for_every_negative_kT") {
  const Case square(periodic_square(3, 3), 0.5);
  const ZoneMaximum critical = square.critical();
  CHECK(std::abs(critical.value) < 1e-15);
  CHECK(count(critical.points, "X") == 2);
  // A transverse wave along an axis: S = kT X/(1 + cos²(phi/2)); at Gamma nothing is left.
  CHECK(square.waves.critical_ratio({0.37, 0}) == Approx(0).margin(1e-14));
  CHECK(square.waves.critical_ratio({}) == -std::numeric_limits<double>::infinity());
}

// With rotation restrained K_uu alone decides: its smaller eigenvalue is (1 + 3 r) kN W/4 all along Gamma-M.
TEST_CASE("restrained_rotation_is_lost_at_the_same_ratio_on_the_whole_line_to_m") {
  const Case hexagonal(periodic_hexagonal(2, 2), 0.5, false);
  const Vec2 m = hexagonal.zone.points[1].q;
  for (const double share : {1e-3, 0.1, 0.5, 1.0}) {
    CAPTURE(share);
    CHECK(hexagonal.waves.critical_ratio(share * m) == Approx(-1.0 / 3).epsilon(1e-9));
  }
  CHECK(hexagonal.critical().value == Approx(-1.0 / 3).epsilon(1e-9));
}

// The limit q -> 0 by extrapolation of finite wave vectors, whose error is of the order q^4, direction by direction.
TEST_CASE("long_waves_are_lost_where_the_limit_of_finite_ones_over_all_directions_is") {
  const bool rotation = GENERATE(true, false), diluted = GENERATE(false, true);
  const std::uint64_t seed = GENERATE(1, 2, 3);
  Assembly cell = random_cell(8, seed);
  if (diluted)
    cell.contacts.erase(cell.contacts.begin() + 3), cell.contacts.erase(cell.contacts.begin() + 11),
        cell.facet_lengths.clear();
  const Case given(cell, 0.5, rotation);
  const LongWaveLoss loss = given.waves.long_wave_loss();
  const double length = 2e-3 * norm(given.zone.reciprocal[0]);
  const auto limit = [&](double angle) {
    const Vec2 q = length * Vec2{std::cos(angle), std::sin(angle)};
    return (4 * given.waves.critical_ratio(0.5 * q) - given.waves.critical_ratio(q)) / 3;
  };
  CAPTURE(rotation, diluted, seed, loss.ratio, loss.angle, given.waves.critical_ratio({}));
  double largest = -1;
  for (int k = 0; k < 90; ++k) largest = std::max(largest, limit(k * std::numbers::pi / 90));
  if (std::isfinite(loss.ratio)) {
    CHECK(std::abs(limit(loss.angle) - loss.ratio) < 1e-9);
    CHECK(largest < loss.ratio + 1e-9);
    CHECK(largest > loss.ratio - 1e-3);  // and the grid of directions is not far
  } else {
    CHECK(largest < given.waves.critical_ratio({}) + 1e-9);
  }
}

TEST_CASE("long_waves_of_lattices_are_lost_where_closed_forms_say") {
  // Square: C66 = kT/2. Hexagonal: G = sqrt3/4 (kN + kT), with rotation restrained (53) sqrt3/4 (kN + 3 kT).
  CHECK(std::abs(Case(periodic_square(2, 2), 0.5).waves.long_wave_loss().ratio) < 1e-13);
  CHECK(Case(periodic_hexagonal(2, 2), 0.5, false).waves.long_wave_loss().ratio == Approx(-1.0 / 3).epsilon(1e-13));
  CHECK(!std::isfinite(Case(periodic_hexagonal(2, 2), 0.5).waves.long_wave_loss().ratio));
}

// Discs of a honeycomb turn like gears in a wave of any length at next to no cost: the gear follows the long wave.
TEST_CASE("gears_follow_long_waves") {
  Assembly honeycomb;
  honeycomb.kind = "file";
  const double h = std::sqrt(3.0);
  honeycomb.period = {2 * h, 6};
  honeycomb.centres = {{0, 0}, {0, 2}, {h, 3}, {h, 5}};
  honeycomb.radii.assign(4, 1);
  honeycomb.contacts = {{0, 1, 0, 0, 1, 1}, {1, 2, 0, 0, 1, 1}, {1, 2, -1, 0, 1, 1},
                        {2, 3, 0, 0, 1, 1}, {3, 0, 0, 1, 1, 1}, {3, 0, 1, 1, 1, 1}};
  const Case given(honeycomb, 0.5);
  const LongWaveLoss loss = given.waves.long_wave_loss();
  double largest = -1;
  for (int k = 0; k < 180; ++k) {
    const double angle = k * std::numbers::pi / 180;
    const Vec2 q = 2e-3 * norm(given.zone.reciprocal[0]) * Vec2{std::cos(angle), std::sin(angle)};
    largest = std::max(largest, (4 * given.waves.critical_ratio(0.5 * q) - given.waves.critical_ratio(q)) / 3);
  }
  CAPTURE(given.waves.cell().size(), loss.ratio, loss.angle, largest);
  CHECK(given.waves.cell().size() == 2);
  CHECK(std::abs(loss.ratio - largest) < 1e-7);
}

TEST_CASE("the_highest_frequency_over_the_zone_is_that_of_f10") {
  const double kT = GENERATE(0.0, 1e-4, 0.05, 0.2, 1.0 / 3, 0.5, 1.0, 3.0), beta = GENERATE(0.5, 0.4);
  const bool rotation = kT != 0;
  const double turning = rotation ? kT / beta : 0;
  CAPTURE(kT, beta);
  const double hexagonal = std::max(6 + 2 * kT, 12 * turning), square = std::max(4 * (1 + kT), 8 * turning);
  CHECK(Case(periodic_hexagonal(4, 4), kT, rotation, beta).highest().value == Approx(hexagonal).epsilon(1e-12));
  CHECK(Case(periodic_square(4, 4), kT, rotation, beta).highest().value == Approx(square).epsilon(1e-12));
}

TEST_CASE("the_fastest_growth_of_a_hexagonal_lattice_is_uniform_spin") {
  const double kT = GENERATE(-0.01, -0.05, -0.1, -0.2, -0.3);
  const ZoneMaximum growing = Case(periodic_hexagonal(4, 4), kT).growing();
  CAPTURE(kT, growing.value, growing.at.name);
  CHECK(growing.value == Approx(-24 * kT).epsilon(1e-12));
  CHECK(growing.at.name == "Gamma");
}

TEST_CASE("a_maximum_between_grid_points_is_found") {
  const BrillouinZone zone = brillouin_zone({Vec2{2, 0}, Vec2{0.7, 2.9}});
  const Vec2 top = 0.237 * zone.reciprocal[0] + 0.411 * zone.reciprocal[1];
  const auto [a, b] = std::pair{Vec2{2, 0}, Vec2{0.7, 2.9}};
  const ZoneMaximum found = maximize_over_zone(
      zone,
      [&, a = a, b = b](Vec2 q) {  // smooth, periodic, even in q; largest where q is +-top
        const double p = dot(top, a), r = dot(top, b);
        return -std::pow(std::cos(dot(q, a)) - std::cos(p), 2) -
               std::pow(std::cos(dot(q, a + b)) - std::cos(p + r), 2) - std::pow(std::cos(dot(q, b)) - std::cos(r), 2);
      },
      {.grid = 12});
  CAPTURE(found.value, found.at.q.x, found.at.q.y, top.x, top.y);
  CHECK(std::abs(found.value) < 1e-15);
  CHECK(norm(zone.folded(found.at.q)) == Approx(norm(zone.folded(top))).epsilon(1e-6));
}
