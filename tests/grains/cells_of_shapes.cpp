// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ellipses and clumps in periodic cells.
#include "equidem/core/threads.hpp"

#include "grains/plain_cell.hpp"
#include "grains/resuming.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Discs, ellipses and clumps that fly about in a cell.
GrainScene mixed_cell(NormalLaw law, int columns, int rows, std::uint64_t seed, double speed = 1) {
  GrainScene scene = mixed_box(law, columns, rows, seed);
  scene.pairs[0].stiffness *= 8;  // small discs of clumps are not pressed into others
  return in_cell_of_its_size(std::move(scene), columns, rows, speed);
}

/// Two bodies that meet about a place in a cell of 8 by 8: 0 ellipse and disc, 1 clump and ellipse, 2 two clumps.
GrainScene two_shapes_in_cell(const Stepping& stepping, int which, Vec2 middle) {
  PairProperties pair = one_second(stepping.law, 0.7, 0.5);
  pair.friction = 0.4;
  pair.tangential_ratio = 0.5;
  GrainScene scene = scene_of({}, {}, pair);
  const Vec2 left = middle + Vec2{-0.9, -0.1}, right = middle + Vec2{0.9, 0.15};
  const std::vector<Clump::Disc> discs{{{0, 0}, 0.5}, {{0.6, 0}, 0.4}};
  scene.grains = {which == 0 ? oval(left, 0.8, 0.5, 0.3, {0.5, 0.25}) : lump(scene, discs, left, 0.3, {0.5, 0.25}),
                  which == 0   ? ball(right, 0.7, {-0.5, 0.1})
                  : which == 1 ? oval(right, 0.8, 0.5, 1.3, {-0.5, 0.1})
                               : lump(scene, discs, right, 2.3, {-0.5, 0.1})};
  scene.grains[0].spin = 0.6;
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 8, .height = 8};
  return scene;
}

void check_contacts(const GrainSimulation& simulation, const std::vector<Clump>& clumps, std::size_t& counted) {
  const CellState cell = *simulation.cell();
  std::vector<PlainContact> oracle =
      contacts_of_all_images(simulation.grains(), clumps, {cell.width, 0}, {cell.shift, cell.height}, 4);
  std::erase_if(oracle, [](const PlainContact& c) { return c.overlap < 1e-12; });
  std::vector<GrainContact> found = simulation.contacts();
  std::erase_if(found, [](const GrainContact& c) { return c.overlap < 1e-12; });
  const auto order = [](const auto& c) { return std::tuple(c.i, c.j, c.overlap); };
  std::ranges::sort(oracle, {}, order);
  std::ranges::sort(found, {}, order);
  REQUIRE(found.size() == oracle.size());
  for (std::size_t c = 0; c < found.size(); ++c) {
    REQUIRE(found[c].i == oracle[c].i);
    REQUIRE(found[c].j == oracle[c].j);
    REQUIRE(std::abs(found[c].overlap - oracle[c].overlap) < 1e-11);
    REQUIRE(norm(found[c].normal - oracle[c].normal) < 1e-7);
    REQUIRE(norm(found[c].arm_i - oracle[c].arm_i) < 1e-7);
  }
  counted += found.size();
}

}  // namespace

TEST_CASE("ellipses_and_clumps_meet_across_the_sides_of_a_cell_as_they_do_inside") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const int which = GENERATE(0, 1, 2);
  const Vec2 middle = GENERATE(Vec2{8, 4}, Vec2{4, 0}, Vec2{8, 8}, Vec2{0, 0.25});
  const GrainScene inside = two_shapes_in_cell(stepping, which, {4, 4});
  GrainScene open = inside;
  open.cell.reset();
  GrainSimulation a(inside, options_of(stepping, 0.005)),
      b(two_shapes_in_cell(stepping, which, middle), options_of(stepping, 0.005)), c(open, options_of(stepping, 0.005));
  for (int k = 0; k < 400; ++k) {
    a.advance(1);
    b.advance(1);
    c.advance(1);
    CAPTURE(stepping.name(), which, middle.x, middle.y, k);
    REQUIRE(bits_of(a) == bits_of(c));  // a cell that no body crosses changes nothing
    for (std::size_t g = 0; g < 2; ++g) {
      REQUIRE(norm(a.grains()[g].velocity - b.grains()[g].velocity) < 1e-11);
      REQUIRE(std::abs(a.grains()[g].spin - b.grains()[g].spin) < 1e-11);
      REQUIRE(distance_in_cell(a.grains()[g].position - Vec2{4, 4}, b.grains()[g].position - middle, *b.cell()) <
              1e-11);
    }
    REQUIRE(std::abs(a.energy().elastic() - b.energy().elastic()) < 1e-11);
    REQUIRE(std::abs(a.energy().lost_slip - b.energy().lost_slip) < 1e-11);
  }
  CHECK(b.counters().contacts >= 1);
  CHECK(b.counters().contacts == a.counters().contacts);
  CHECK(b.energy().lost_dashpot > 0.01);
}

TEST_CASE("contacts_of_shapes_in_a_cell_are_those_of_all_images") {
  const Stepping stepping = GENERATE(force_steppings[1], force_steppings[3]);
  const std::uint64_t seed = GENERATE(1, 2);
  const double rate = GENERATE(0.0, 2.0);
  if (rate != 0 && stepping.integrator != GrainIntegrator::velocity_verlet) return;
  GrainScene scene = mixed_cell(stepping.law, 6, 4, seed, 2);
  scene.cell->rate_xy = {.value = rate};
  GrainSimulation simulation(scene, options_of(stepping, 0.001));
  std::size_t contacts = 0;
  for (int k = 0; k < 150; ++k) {
    simulation.advance(10);
    CAPTURE(stepping.name(), seed, rate, k);
    check_contacts(simulation, scene.clumps, contacts);
  }
  CHECK(contacts > 100);
  CHECK(simulation.counters().contacts > 20);
  if (rate != 0) CHECK(simulation.cell()->strain.xy * 4 > 6);  // past the period
}

TEST_CASE("a_sheared_cell_of_shapes_moves_as_one_whose_images_are_never_taken_back") {
  GrainScene scene = mixed_cell(NormalLaw::linear_dashpot, 4, 4, 21);
  scene.pairs[0].friction = 0;
  scene.pairs[0].restitution = 1;
  scene.cell->rate_xy = {.value = GENERATE(2.0, -2.0)};
  const double dt = 0.001;
  GrainSimulation simulation(scene, verlet_options(dt));
  PlainCell plain(scene, dt);
  double apart = 0;
  for (int k = 0; k < 1200; ++k) {
    simulation.advance(1);
    plain.step();
    apart = std::max(apart, distance_of_states(simulation.grains(), plain.grains(), *simulation.cell()));
    CAPTURE(k, apart, plain.shift());
    REQUIRE(apart < 1e-6);  // round-off, and its growth in collisions
  }
  CHECK(std::abs(plain.shift()) > 1.1 * scene.cell->width);
  CHECK(simulation.counters().contacts > 15);
  CHECK(apart > 0);
}

TEST_CASE("a_cell_of_shapes_keeps_its_momentum_and_its_energy") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const GrainScene scene = mixed_cell(stepping.law, 6, 5, 4, 2);
  GrainSimulation simulation(scene, options_of(stepping, 5e-4));
  simulation.advance(4000);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(stepping.name(), norm(momentum_in_cell(simulation)), ledger.error(), ledger.largest());
  CHECK(norm(momentum_in_cell(simulation)) < 1e-11);
  CHECK(std::abs(ledger.error()) < 2e-3 * ledger.largest());
  CHECK(ledger.lost() > 0.1 * ledger.initial);
  CHECK(simulation.counters().contacts > 50);
}

TEST_CASE("a_sheared_gas_of_shapes_heats_by_the_work_of_its_cell") {
  double errors[2];
  for (const int finer : {1, 2}) {
    GrainScene scene = mixed_cell(NormalLaw::linear_dashpot, 6, 6, 24);
    scene.pairs[0].restitution = 0.9;
    scene.cell->rate_xy = {.value = 1};
    scene.cell->rate_xx = {.value = -0.02};
    GrainSimulation simulation(scene, verlet_options(0.001 / finer));
    simulation.advance(2500 * finer);
    const EnergyLedger ledger = simulation.energy();
    CAPTURE(finer, ledger.kinetic, ledger.elastic(), ledger.lost(), ledger.work_of_cell, ledger.initial);
    CHECK(simulation.counters().contacts > 100);
    CHECK(ledger.work_of_cell > 0.3 * ledger.initial);
    CHECK(ledger.lost_slip > 0);
    CHECK(norm(momentum_in_cell(simulation)) < 1e-10);
    errors[finer - 1] = std::abs(ledger.error()) / ledger.work_of_cell;
    CHECK(errors[finer - 1] < 4e-3);
  }
  CAPTURE(errors[0], errors[1]);
  CHECK(errors[1] < errors[0]);
}

TEST_CASE("a_cell_of_shapes_goes_on_with_its_bits_over_threads_blocks_margins_and_wraps") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double rate = GENERATE(0.0, 3.0);
  if (rate != 0 && stepping.integrator != GrainIntegrator::velocity_verlet) return;
  GrainScene scene = mixed_cell(stepping.law, 5, 4, 6, 2);
  scene.cell->rate_xy = {.value = rate};
  if (rate != 0) scene.cell->servo = CellServo{.stress_yy = Schedule{.value = -5}, .max_rate = 0.1};
  GrainOptions options = options_of(stepping, 0.001);
  options.bodies_per_block = 7;
  GrainSimulation whole(scene, options);
  whole.advance(700);
  const Bits end = bits_of(whole);
  CAPTURE(stepping.name(), rate);
  CHECK(whole.counters().contacts > 8);
  GrainSimulation stepped(scene, options);
  for (const int steps : {100, 155, 1, 1, 143, 111, 1, 188}) {
    GrainSimulation resumed(scene, options);
    resumed.restore(stepped.save());
    resumed.advance(700 - stepped.step());
    CAPTURE(stepped.step());
    REQUIRE(bits_of(resumed) == end);
    REQUIRE(resumed.energy().work_of_cell == whole.energy().work_of_cell);
    stepped.advance(steps);
  }
  for (const double margin : {1e-3, 0.1, 1.0, 6.0}) {
    options.margin = margin;
    GrainSimulation other(scene, options);
    other.advance(700);
    CAPTURE(margin);
    CHECK(bits_of(other) == end);
  }
  options.margin = 0;
  const int before = thread_count();
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    GrainSimulation other(scene, options);
    other.advance(700);
    CAPTURE(threads);
    CHECK(bits_of(other) == end);
  }
  set_thread_count(before);
}

TEST_CASE("the_void_ratio_of_a_cell_counts_the_areas_of_ellipses_and_of_the_unions_of_clumps") {
  GrainScene scene = scene_of({}, {}, one_second(NormalLaw::linear_dashpot, 1));
  scene.grains = {ball({2, 2}, 0.5), oval({5, 2}, 1, 0.25), lump(scene, pair_of_discs(), {6, 6}),
                  lump(scene, {{{0, 0}, 1}, {{0.5, 0}, 1}}, {2, 6})};
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 9, .height = 10};
  const GrainSimulation simulation(scene, verlet_options());
  const double lens = 2 * std::acos(0.25) - 0.5 * std::sqrt(0.9375);  // of two circles of radius 1, 0.5 apart
  const double solid = std::numbers::pi * (0.25 + 0.25 + 2 + 2) - lens;
  CHECK(simulation.cell()->void_ratio == Approx(90 / solid - 1).epsilon(1e-12));
}

TEST_CASE("bodies_slide_down_along_a_cell_on_a_floor_whatever_their_shape") {
  PairProperties pair = one_second(NormalLaw::linear_dashpot, 1, 1);
  pair.stiffness *= 100;
  GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, pair, {1, -1});
  scene.grains = {oval({1, 0.249}, 0.5, 0.25), lump(scene, {{{-0.3, 0}, 0.3}, {{0.3, 0}, 0.3}}, {3, 0.2985})};
  scene.cell = PeriodicCell{.along = PeriodicCell::Along::x, .corner = {0, 0}, .width = 4};
  GrainSimulation simulation(scene, options_of(force_steppings[1], 0.002));
  simulation.advance(5000);  // 10 s: 50 m, twelve periods
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(ledger.kinetic, ledger.potential, ledger.error());
  CHECK(ledger.kinetic == Approx(100).epsilon(0.02));
  CHECK(std::abs(ledger.error()) < 2e-3 * ledger.kinetic);
}
