// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/grains/grain_simulation.hpp"

#include "fields/bodies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Discs side by side in rows, all contacts alike: s_xx = -fx/d, s_yy = -fy/d, s_xy = s_yx = t/d.
struct Rows {
  std::vector<Grain> grains;
  std::vector<BodyContact> contacts;
};
Rows square_lattice(int count, double d, double fx, double fy, double t) {
  Rows lattice;
  for (int row = 0; row < count; ++row)
    for (int column = 0; column < count; ++column)
      lattice.grains.push_back(disc({d * column, d * row}, d / 2, {2, -1}));
  for (int row = 0; row < count; ++row)
    for (int column = 0; column < count; ++column) {
      const int i = row * count + column;
      BodyContact contact;
      contact.i = i;
      if (column + 1 < count) {
        contact.j = i + 1;
        contact.force = {-fx, t};
        lattice.contacts.push_back(contact);
      }
      if (row + 1 < count) {
        contact.j = i + count;
        contact.force = {t, -fy};
        lattice.contacts.push_back(contact);
      }
    }
  return lattice;
}

}  // namespace

TEST_CASE("the_stress_of_a_lattice_is_the_one_its_forces_make_in_every_cell") {
  const double d = 0.02;
  const Rows lattice = square_lattice(20, d, 30, 50, 7);
  for (const Vec2 corner : {Vec2{2.25 * d, 2.4 * d}, Vec2{2.3 * d, 3.8 * d}}) {
    const CoarseGrid grid = grid_over({corner, corner + Vec2{12 * d, 8 * d}}, 2 * d);
    REQUIRE(grid.columns == 6);
    REQUIRE(grid.rows == 4);
    const CoarseFields fields = coarse_fields(lattice.grains, {}, lattice.contacts, grid);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      CAPTURE(corner.x, k);
      CHECK(fields.stress[k].xx == Approx(-30 / d));
      CHECK(fields.stress[k].yy == Approx(-50 / d));
      CHECK(fields.stress[k].xy == Approx(7 / d));
      CHECK(fields.stress[k].yx == Approx(7 / d));
      CHECK(fields.solid_fraction[k] == Approx(std::numbers::pi / 4));
      CHECK(fields.coordination[k] == 4);
      CHECK(fields.velocity[k].x == Approx(2));
      CHECK(fields.velocity[k].y == Approx(-1));
    }
  }
}

TEST_CASE("cells_add_up_to_the_stress_of_the_whole_and_bodies_to_their_area") {
  const Bodies bodies = scattered(GrainShape::ellipse, 50, 2);
  std::vector<BodyContact> contacts;
  Random random(4);
  for (int k = 0; k + 1 < 50; k += 2) {
    const double angle = random.uniform(-3, 3);
    const Vec2 normal = {std::cos(angle), std::sin(angle)};
    BodyContact contact;
    contact.i = k;
    contact.j = k % 4 == 0 ? ~0 : k + 1;
    contact.arm = 0.03 * normal;
    contact.force = -(random.uniform(0, 5) * normal) + random.uniform(-1, 1) * perpendicular(normal);
    contacts.push_back(contact);
  }
  const Rectangle all{{-0.2, -0.2}, {1.2, 1.2}};
  const auto sum_of = [&](double width) {
    const CoarseFields fields = coarse_fields(bodies.grains, bodies.clumps, contacts, grid_over(all, width));
    std::vector<double> sum(5, 0.0);
    const Vec2 size = fields.grid.cell_size();
    for (std::size_t k = 0; k < fields.grid.size(); ++k) {
      const Tensor2& s = fields.stress[k];
      const double values[] = {s.xx, s.xy, s.yx, s.yy, fields.solid_fraction[k]};
      for (std::size_t c = 0; c < 5; ++c) sum[c] += size.x * size.y * values[c];
    }
    return sum;
  };
  const auto whole = sum_of(1.4), parts = sum_of(0.037);
  double area = 0;
  for (const Grain& grain : bodies.grains) area += area_of(grain, {});
  CHECK(whole[4] == Approx(area));
  for (std::size_t c = 0; c < 5; ++c) {
    CAPTURE(c, whole[c], parts[c]);
    CHECK(parts[c] == Approx(whole[c]).epsilon(1e-11));
  }
}

TEST_CASE("bonds_carry_stress_as_contacts_do") {
  // Two heavy discs part at 2e-4 m/s: their bond of 1e6 N/m pulls with 2e-4 t 1e6 N/m along its 0.2 m.
  GrainScene scene;
  for (const double side : {-1.0, 1.0}) {
    scene.grains.push_back(disc({0, 0.1 * side}, 0.1, {0, 1e-4 * side}));
    scene.grains.back().inertia = {1e12, 1e12};
  }
  scene.bonds = {{.j = 1, .normal_spring = 1e6, .tangential_spring = 1e6}};
  scene.pairs = {PairProperties{.stiffness = 1e4}};
  GrainOptions options;
  options.law = NormalLaw::linear_dashpot;
  options.time_step = 1e-4;
  GrainSimulation simulation(scene, options);
  simulation.advance(1000);
  const CoarseFields fields =
      coarse_fields(simulation.grains(), {}, simulation.body_contacts(), grid_over({{-0.5, -0.2}, {0.5, 0.2}}, 1));
  REQUIRE(fields.stress.size() == 1);
  CAPTURE(fields.stress[0].xx, fields.stress[0].yy);
  CHECK(fields.stress[0].yy == Approx(2e-4 * 0.1 * 1e6 * 0.2 / 0.4).epsilon(2e-3));  // one step and the longer bond
  CHECK(fields.stress[0].xx == Approx(0).margin(1e-9));
  CHECK(fields.coordination[0] == 1);
}

TEST_CASE("a_column_at_rest_carries_its_weight") {
  // Discs upon each other on a floor: at any height s_yy times the width is the weight above.
  GrainScene scene;
  for (int k = 0; k < 10; ++k) scene.grains.push_back(disc({0, 0.1 + 0.2 * k}, 0.1));
  scene.walls = {line("floor", {0, 0}, {0, 1})};
  scene.gravity = {0, -10};
  PairProperties pair;
  pair.stiffness = 1e4;
  pair.restitution = 0.1;
  scene.pairs = {pair};
  GrainOptions options;
  options.time_step = 1e-4;
  GrainSimulation simulation(scene, options);
  simulation.advance(30'000);
  // Centres are 0.2 apart: the contact below the k-th carries the k-th and all above.
  const CoarseFields fields =
      coarse_fields(simulation.grains(), {}, simulation.body_contacts(), grid_over({{-0.5, 0}, {0.5, 0.2}}, 1));
  const double weight = 0.01 * 10, upper = 9 * weight, lower = 10 * weight;
  const auto grains = simulation.grains();
  const double foot = grains[0].position.y, rest = 0.2 - foot;
  CAPTURE(foot, grains[9].velocity.y);
  CHECK(fields.stress[0].yy * 0.2 == Approx(-(lower * 0.1 + upper * rest)).epsilon(1e-3));
  CHECK(fields.coordination[0] == 2);
  CHECK_THROWS_AS(grid_over({{0, 0}, {1, 1}}, 1e-4), Error);
  CHECK_THROWS_AS(grid_over({{0, 0}, {1, 1}}, 0), Error);
  CHECK_THROWS_AS(grid_over({{0, 0}, {0, 1}}, 0.1), Error);
}
