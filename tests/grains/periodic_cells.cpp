// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cells whose content repeats.
#include "equidem/core/threads.hpp"

#include "grains/cell_scenes.hpp"
#include "grains/resuming.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const std::vector<Stepping> steppings_of_cells(all_steppings.begin(), all_steppings.begin() + 4);

/// Run what throws an Error whose text has all the words.
template <class Action>
void check_cell_error(const Action& action, const std::vector<std::string>& words) {
  try {
    action();
    FAIL("nothing was refused");
  } catch (const Error& error) {
    for (const std::string& word : words) {
      CAPTURE(error.what(), word);
      CHECK(std::string(error.what()).find(word) != std::string::npos);
    }
  }
}

GrainScene two_discs_in_cell(const Stepping& stepping, Vec2 middle) {
  PairProperties pair = one_second(stepping.law, 0.7, 0.5);
  pair.friction = 0.4;
  pair.tangential_ratio = 0.5;
  std::vector<Grain> grains{ball(middle + Vec2{-0.75, -0.125}, 0.5, {0.5, 0.25}),
                            ball(middle + Vec2{0.75, 0.125}, 0.75, {-0.5, 0.125}, 2)};
  grains[0].spin = 1;
  GrainScene scene = scene_of(grains, {}, pair);
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 8, .height = 8};
  return scene;
}

}  // namespace

TEST_CASE("discs_meet_across_the_sides_of_a_cell_as_they_do_inside") {
  const Stepping stepping = GENERATE(from_range(steppings_of_cells));
  const Vec2 middle = GENERATE(Vec2{8, 4}, Vec2{4, 0}, Vec2{8, 8}, Vec2{0, 0.25});
  const GrainScene inside = two_discs_in_cell(stepping, {4, 4}), across = two_discs_in_cell(stepping, middle);
  GrainScene open = inside;
  open.cell.reset();
  GrainSimulation a(inside, options_of(stepping, 0.01)), b(across, options_of(stepping, 0.01)),
      c(open, options_of(stepping, 0.01));
  for (int k = 0; k < 300; ++k) {
    a.advance(1);
    b.advance(1);
    c.advance(1);
    CAPTURE(stepping.name(), middle.x, middle.y, k);
    REQUIRE(bits_of(a) == bits_of(c));  // a cell that no body crosses changes nothing
    for (std::size_t g = 0; g < 2; ++g) {
      REQUIRE(norm(a.grains()[g].velocity - b.grains()[g].velocity) < 1e-12);
      REQUIRE(std::abs(a.grains()[g].spin - b.grains()[g].spin) < 1e-12);
      REQUIRE(distance_in_cell(a.grains()[g].position - Vec2{4, 4}, b.grains()[g].position - middle, *b.cell()) <
              1e-12);
    }
    REQUIRE(std::abs(a.energy().elastic() - b.energy().elastic()) < 1e-12);
    REQUIRE(std::abs(a.energy().lost_slip - b.energy().lost_slip) < 1e-12);
    REQUIRE(std::abs(a.energy().lost_dashpot - b.energy().lost_dashpot) < 1e-12);
  }
  CHECK(b.counters().contacts == 1);
  CHECK(b.energy().lost_dashpot > 0.01);
}

TEST_CASE("contacts_in_a_cell_are_those_of_all_images") {
  // after a step of these schemes contacts are those of the places at that time
  const Stepping stepping = GENERATE(steppings_of_cells[1], steppings_of_cells[3]);
  const std::uint64_t seed = GENERATE(1, 2, 3);
  const GrainScene scene = busy_cell(stepping.law, 6, 4, seed, 3);
  GrainSimulation simulation(scene, options_of(stepping, 0.002));
  std::size_t contacts = 0;
  for (int k = 0; k < 150; ++k) {
    simulation.advance(10);
    const Overlaps oracle = overlaps_by_brute_force(simulation.grains(), *simulation.cell(), 1e-12);
    const std::vector<GrainContact> found = simulation.contacts();
    CAPTURE(stepping.name(), seed, k);
    REQUIRE(found.size() == oracle.size());
    for (std::size_t c = 0; c < found.size(); ++c) {
      REQUIRE(found[c].i == std::get<0>(oracle[c]));
      REQUIRE(found[c].j == std::get<1>(oracle[c]));
      REQUIRE(std::abs(found[c].overlap - std::get<2>(oracle[c])) < 1e-12);
    }
    contacts += found.size();
  }
  CHECK(contacts > 100);
  CHECK(simulation.counters().contacts > 20);
}

TEST_CASE("a_cell_keeps_its_momentum_and_its_energy") {
  const Stepping stepping = GENERATE(from_range(steppings_of_cells));
  GrainScene scene = busy_cell(stepping.law, 6, 5, 4, 2);
  GrainSimulation simulation(scene, options_of(stepping, 0.001));
  simulation.advance(3000);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(stepping.name(), norm(momentum_in_cell(simulation)), ledger.error(), ledger.largest());
  CHECK(norm(momentum_in_cell(simulation)) < 1e-11);
  CHECK(std::abs(ledger.error()) < 1e-3 * ledger.largest());
  CHECK(ledger.lost() > 0.1 * ledger.initial);
  CHECK(simulation.counters().contacts > 50);
}

TEST_CASE("a_cell_cut_elsewhere_has_the_same_forces") {
  const GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 6, 5, 5);
  GrainScene other = scene;
  for (Grain& grain : other.grains) grain.position += Vec2{2.7, -1.3};
  GrainSimulation a(scene, verlet_options()), b(other, verlet_options());
  a.advance(100);
  b.advance(100);
  const std::vector<GrainContact> here = a.contacts(), there = b.contacts();
  REQUIRE(here.size() > 3);
  REQUIRE(here.size() == there.size());
  for (std::size_t c = 0; c < here.size(); ++c) {
    CAPTURE(c, here[c].normal_force, there[c].normal_force);
    CHECK(here[c].i == there[c].i);
    CHECK(here[c].j == there[c].j);
    CHECK(std::abs(here[c].normal_force - there[c].normal_force) < 1e-10);
    CHECK(std::abs(here[c].tangential_force - there[c].tangential_force) < 1e-10);
  }
}

TEST_CASE("a_run_in_a_cell_goes_on_with_its_bits_over_threads_blocks_margins_and_wraps") {
  const Stepping stepping = GENERATE(from_range(steppings_of_cells));
  const GrainScene scene = busy_cell(stepping.law, 5, 4, 6, 4);
  GrainOptions options = options_of(stepping, 0.004);
  options.bodies_per_block = 7;
  GrainSimulation whole(scene, options);
  whole.advance(700);
  const Bits end = bits_of(whole);
  CAPTURE(stepping.name());
  CHECK(whole.counters().contacts > 50);
  GrainSimulation stepped(scene, options);
  for (const int steps : {100, 155, 1, 1, 143, 111, 1, 188}) {
    GrainSimulation resumed(scene, options);
    resumed.restore(stepped.save());
    resumed.advance(700 - stepped.step());
    CAPTURE(stepped.step());
    REQUIRE(bits_of(resumed) == end);
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

TEST_CASE("a_disc_that_slides_down_along_a_cell_keeps_its_energy") {
  const Stepping stepping = GENERATE(from_range(steppings_of_cells));
  PairProperties pair = one_second(stepping.law, 1, 1);
  pair.stiffness *= 100;
  GrainScene scene =
      scene_of({ball({1, 0.499}, 0.5), ball({3, 0.499}, 0.5)}, {line("floor", {0, 0}, {0, 1})}, pair, {1, -1});
  scene.cell = PeriodicCell{.along = PeriodicCell::Along::x, .corner = {0, 0}, .width = 4};
  GrainSimulation simulation(scene, options_of(stepping, 0.005));
  simulation.advance(2000);  // 10 s: 50 m, twelve periods
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(stepping.name(), ledger.kinetic, ledger.potential, ledger.error());
  CHECK(ledger.kinetic == Approx(100).epsilon(0.01));
  CHECK(std::abs(ledger.error()) < 1e-3 * ledger.kinetic);
  CHECK_FALSE(simulation.cell().has_value());
  for (const Grain& grain : simulation.grains()) CHECK(std::abs(grain.position.x - 2) < 2 + 256 * 0.005 * 10);
}

TEST_CASE("what_a_cell_does_not_carry_is_refused_by_name") {
  const GrainScene good = busy_cell(NormalLaw::linear_dashpot, 4, 4, 7);
  const GrainOptions options = verlet_options();
  const auto check_scene = [&](const auto& change, const std::vector<std::string>& words) {
    GrainScene scene = good;
    change(scene);
    check_cell_error([&] { GrainSimulation(scene, options); }, words);
  };
  check_scene([](GrainScene& s) { s.cell->width = 1.9; }, {"width = 1.9 m", "several images"});
  check_scene([](GrainScene& s) { s.cell->height = 0; }, {"height = 0 m"});
  check_scene([](GrainScene& s) { s.cell->along = PeriodicCell::Along::x; }, {"height = 4 m"});
  check_scene([](GrainScene& s) { s.walls = {line("floor", {0, 0}, {0, 1})}; }, {"wall 'floor'", "along x and y"});
  check_scene(
      [](GrainScene& s) {
        s.cell->along = PeriodicCell::Along::x;
        s.cell->height = 0;
        s.walls = {line("side", {0, 0}, {1, 0})};
      },
      {"wall 'side'", "no line along x"});
  check_scene([](GrainScene& s) { s.gravity = {0, -1}; }, {"gravity", "no floor"});
  check_scene([](GrainScene& s) { s.cell->shift = NAN; }, {"shift"});
  check_scene(
      [](GrainScene& s) {
        s.grains[1].position = s.grains[0].position + Vec2{3.99, 0};
      },
      {"inside one another"});
  check_scene(
      [](GrainScene& s) {
        s.cell->rate_xx = {.value = 1}, s.cell->servo = CellServo{.stress_xx = Schedule{.value = -1}, .max_rate = 1};
      },
      {"rate_xx", "stress_xx"});
  check_scene([](GrainScene& s) { s.cell->servo = CellServo{.max_rate = 1}; }, {"keeps no stress"});
  check_scene([](GrainScene& s) { s.cell->servo = CellServo{.stress_yy = Schedule{.value = -1}}; }, {"max_rate"});
  check_cell_error([&] { GrainSimulation(good, options_of(NormalLaw::exact_flow, 0.01)); }, {"law exact_flow"});
  GrainScene shaped = good;
  shaped.grains[3].short_half_axis = 0.5 * shaped.grains[3].radius;
  GrainOptions enlarged = options;
  enlarged.ellipse_law = GrainOptions::EllipseLaw::enlarged;
  check_cell_error([&] { GrainSimulation(shaped, enlarged); }, {"enlarged", "exact contact"});
  GrainScene moving = good;
  moving.cell->rate_xy = {.value = 1};
  check_cell_error([&] { GrainSimulation(moving, options_of(NormalLaw::linear_dashpot, 0.01)); },
                   {"semi_implicit_euler", "velocity_verlet"});
}
