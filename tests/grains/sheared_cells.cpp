// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Periodic cells that deform at a rate or keep a stress.
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"

#include "grains/cell_scenes.hpp"
#include "grains/plain_cell.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A square lattice of touching discs of radius 0.5, of mass 1.
GrainScene square_cell(int columns, double overlap) {
  std::vector<Grain> grains;
  const double period = 1 - overlap;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < columns; ++j) grains.push_back(ball({(i + 0.25) * period, (j + 0.25) * period}, 0.5));
  PairProperties pair;
  pair.stiffness = 1000;
  pair.restitution = 0.1;
  pair.friction = 100;
  pair.tangential_ratio = 0.4;
  pair.tangential_damping = 0.3;
  GrainScene scene = scene_of(grains, {}, pair);
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = columns * period, .height = columns * period};
  return scene;
}

}  // namespace

TEST_CASE("a_cell_sheared_past_its_period_moves_as_one_whose_images_are_never_taken_back") {
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 4, 4, 21);
  scene.pairs[0].friction = 0;
  scene.pairs[0].restitution = 1;
  scene.cell->rate_xy = {.value = GENERATE(2.0, -2.0)};
  const double dt = 0.002;
  GrainSimulation simulation(scene, verlet_options(dt));
  PlainCell plain(scene, dt);
  double apart = 0;
  for (int k = 0; k < 800; ++k) {
    simulation.advance(1);
    plain.step();
    const CellState cell = *simulation.cell();
    apart = std::max(apart, distance_of_states(simulation.grains(), plain.grains(), cell));
    CAPTURE(k, apart, plain.shift(), cell.shift);
    REQUIRE(apart < 1e-7);  // round-off, and its growth in collisions
    REQUIRE(std::abs(std::remainder(plain.shift() - cell.shift, cell.width)) < 1e-9);
    REQUIRE(std::abs(cell.shift) <= 0.5 * cell.width * (1 + 1e-12));
  }
  CHECK(std::abs(plain.shift()) > 1.5 * scene.cell->width);
  CHECK(simulation.counters().contacts > 20);
  CAPTURE(apart);
  CHECK(apart > 0);
}

TEST_CASE("a_sheared_cell_has_the_contacts_of_all_images") {
  const double rate = GENERATE(0.5, -3.0);
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 6, 4, 22);
  scene.cell->rate_xy = {.value = rate};
  scene.cell->rate_yy = {.value = -0.1};
  scene.cell->rate_xx = {.value = 0.1};
  GrainSimulation simulation(scene, verlet_options(0.002));
  std::size_t contacts = 0;
  for (int k = 0; k < 150; ++k) {
    simulation.advance(7);
    const Overlaps oracle = overlaps_by_brute_force(simulation.grains(), *simulation.cell(), 1e-12);
    const std::vector<GrainContact> found = simulation.contacts();
    CAPTURE(rate, k);
    REQUIRE(found.size() == oracle.size());
    for (std::size_t c = 0; c < found.size(); ++c) REQUIRE(std::abs(found[c].overlap - std::get<2>(oracle[c])) < 1e-12);
    contacts += found.size();
  }
  CHECK(contacts > 200);
}

TEST_CASE("the_period_of_a_cell_is_stretched_by_the_exponential_of_its_strain") {
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 6, 6, 23);
  scene.cell->rate_xx = {.value = 0.2};
  scene.cell->rate_yy = {.kind = Schedule::Kind::ramp, .value = -0.1, .start = 0, .end = 1};
  GrainSimulation simulation(scene, verlet_options(0.002));
  simulation.advance(500);
  const CellState cell = *simulation.cell();
  CAPTURE(cell.width, cell.height, cell.strain.xx, cell.strain.yy);
  CHECK(cell.strain.xx == Approx(0.2).epsilon(1e-12));
  CHECK(cell.strain.yy == Approx(-0.05).epsilon(1e-6));
  CHECK(cell.width == Approx(6 * std::exp(cell.strain.xx)).epsilon(1e-12));
  CHECK(cell.height == Approx(6 * std::exp(cell.strain.yy)).epsilon(1e-12));
}

TEST_CASE("a_gas_sheared_with_friction_heats_by_the_work_of_its_cell") {
  double errors[2];
  for (const int finer : {1, 2}) {
    GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 6, 6, 24);
    scene.pairs[0].restitution = 0.9;
    scene.cell->rate_xy = {.value = 1};
    scene.cell->rate_xx = {.value = -0.05};
    GrainSimulation simulation(scene, verlet_options(0.002 / finer));
    simulation.advance(1500 * finer);
    const EnergyLedger ledger = simulation.energy();
    CAPTURE(finer, ledger.kinetic, ledger.elastic(), ledger.lost(), ledger.work_of_cell, ledger.initial);
    CHECK(simulation.counters().contacts > 100);
    CHECK(ledger.work_of_cell > 0.5 * ledger.initial);
    CHECK(ledger.lost_slip > 0);
    CHECK(norm(momentum_in_cell(simulation)) < 1e-10);
    errors[finer - 1] = std::abs(ledger.error()) / ledger.work_of_cell;
    CHECK(errors[finer - 1] < 2e-3);
  }
  CAPTURE(errors[0], errors[1]);
  CHECK(errors[1] < errors[0]);
}

TEST_CASE("work_of_a_cell_is_stress_times_rate_times_area") {
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 6, 6, 25);
  scene.cell->rate_xy = {.value = 1};
  scene.cell->rate_yy = {.value = -0.1};
  const double dt = 0.0005;
  GrainSimulation simulation(scene, verlet_options(dt));
  double integral = 0;
  const auto power = [&] {
    const CellState cell = *simulation.cell();
    return cell.area() * (cell.stress.xy * 1 + cell.stress.yy * -0.1);
  };
  double before = power();
  for (int k = 0; k < 2000; ++k) {
    simulation.advance(1);
    const double now = power();
    integral += 0.5 * dt * (before + now);
    before = now;
  }
  const double work = simulation.energy().work_of_cell;
  CAPTURE(work, integral);
  CHECK(work == Approx(integral).epsilon(2e-3));
  CHECK(work > 0);
}

TEST_CASE("a_square_lattice_cell_answers_small_strains_by_its_effective_stiffness") {
  const double strain = 1e-8, overlap = 1e-7;
  const int columns = 6;
  const GrainScene scene = square_cell(columns, overlap);
  const double kN = scene.pairs[0].stiffness, kT = scene.pairs[0].tangential_ratio * kN;
  const Assembly lattice = square_lattice({.columns = columns, .rows = columns, .radius = 0.5, .periodic = true});
  const Matrix3 expected = effective_stiffness(lattice, ContactSprings(SpringConstants{kN, kT})).stiffness;
  const double step = 1e-4, time = 0.1;
  const Schedule pulse{.kind = Schedule::Kind::table,
                       .times = {0, time, time + 0.1 * step},
                       .values = {strain / time, strain / time, 0}};
  for (int component = 0; component < 3; ++component) {
    GrainScene strained = scene;
    (component == 0   ? strained.cell->rate_xx
     : component == 1 ? strained.cell->rate_yy
                      : strained.cell->rate_xy) = pulse;
    GrainSimulation simulation(strained, verlet_options(step));
    const Tensor2 before = simulation.cell()->stress;
    simulation.advance(30000);
    const CellState after = *simulation.cell();
    const double change[3] = {after.stress.xx - before.xx, after.stress.yy - before.yy,
                              0.5 * (after.stress.xy + after.stress.yx)};
    const double reached[3] = {after.strain.xx, after.strain.yy, after.strain.xy};
    for (int row = 0; row < 3; ++row) {
      CAPTURE(component, row, change[row] / strain, expected[row][component], after.coordination_number);
      CHECK(reached[row] == Approx(row == component ? strain : 0).epsilon(1e-6).margin(1e-20));
      CHECK(std::abs(change[row] / strain - expected[row][component]) < 1e-6 * kN);
    }
    CHECK(after.coordination_number == 4);
  }
}

TEST_CASE("the_stress_of_a_cell_is_that_which_its_servo_keeps") {
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 8, 8, 26);
  for (PairProperties& pair : scene.pairs) pair.stiffness *= 20;
  const double pressure = scene.pairs[0].stiffness * 1e-3;
  scene.cell->servo = CellServo{
      .stress_xx = Schedule{.value = -pressure}, .stress_yy = Schedule{.value = -2 * pressure}, .max_rate = 0.5};
  GrainSimulation simulation(scene, verlet_options(0.001));
  simulation.advance(20000);
  const CellState cell = *simulation.cell();
  CAPTURE(cell.stress.xx, cell.stress.yy, pressure, cell.void_ratio, cell.coordination_number, cell.width, cell.height,
          simulation.energy().kinetic, simulation.energy().error(), simulation.energy().work_of_cell);
  REQUIRE(cell.servos.size() == 2);
  for (const CellServoReport& servo : cell.servos) {
    CAPTURE(servo.component, servo.reached, servo.wanted, servo.stress, servo.overshoot, servo.mean_error);
    CHECK(servo.reached);
    CHECK(servo.stress == Approx(servo.wanted).epsilon(0.02));
  }
  CHECK(cell.stress.xx == Approx(-pressure).epsilon(0.02));
  CHECK(cell.stress.yy == Approx(-2 * pressure).epsilon(0.02));
  CHECK(cell.void_ratio < 0.35);
  CHECK(cell.coordination_number > 2.5);
  const EnergyLedger ledger = simulation.energy();
  CHECK(std::abs(ledger.error()) < 0.01 * ledger.work_of_cell);
}

TEST_CASE("a_sheared_cell_goes_on_with_its_bits") {
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 5, 5, 27);
  scene.cell->rate_xy = {.value = 3};
  scene.cell->servo = CellServo{.stress_yy = Schedule{.value = -5}, .max_rate = 0.2};
  GrainOptions options = verlet_options(0.002);
  options.bodies_per_block = 6;
  GrainSimulation whole(scene, options), stepped(scene, options);
  whole.advance(1100);
  CHECK(std::abs(whole.cell()->strain.xy) > 2);
  for (const int steps : {100, 155, 1, 1, 247, 9, 99, 300}) {
    GrainSimulation resumed(scene, options);
    resumed.restore(stepped.save());
    resumed.advance(1100 - stepped.step());
    CAPTURE(stepped.step());
    REQUIRE(bits_of(resumed) == bits_of(whole));
    REQUIRE(resumed.cell()->height == whole.cell()->height);
    REQUIRE(resumed.energy().work_of_cell == whole.energy().work_of_cell);
    stepped.advance(steps);
  }
}

TEST_CASE("a_sheared_cell_has_the_same_bits_for_every_margin_and_number_of_threads") {
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::hertz_dashpot);
  const double rate = GENERATE(3.0, -0.4);
  GrainScene scene = busy_cell(law, 6, 5, 29);
  scene.cell->rate_xy = {.value = rate};
  scene.cell->servo = CellServo{.stress_yy = Schedule{.value = -5}, .max_rate = 0.1};
  GrainOptions options = options_of(Stepping{law, GrainIntegrator::velocity_verlet}, 0.002);
  options.bodies_per_block = 7;
  GrainSimulation whole(scene, options);
  whole.advance(1100);
  const Bits end = bits_of(whole);
  CAPTURE(to_string(law), rate, whole.cell()->strain.xy, whole.counters().rebuilds);
  CHECK(whole.counters().contacts > 50);
  const int before = thread_count();
  for (const double margin : {1e-3, 0.02, 0.3, 1.0, 6.0}) {
    for (const int threads : {1, 2, 3, 4}) {
      options.margin = margin;
      set_thread_count(threads);
      GrainSimulation other(scene, options);
      other.advance(1100);
      CAPTURE(margin, threads, other.counters().rebuilds);
      CHECK(bits_of(other) == end);
      CHECK(other.cell()->height == whole.cell()->height);
      CHECK(other.energy().work_of_cell == whole.energy().work_of_cell);
    }
  }
  set_thread_count(before);
}

TEST_CASE("a_cell_that_becomes_too_thin_is_refused") {
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 4, 4, 28);
  for (Grain& grain : scene.grains) grain.radius *= 0.5;
  scene.cell->rate_yy = {.value = -1};
  scene.cell->rate_xx = {.value = 1};
  GrainSimulation simulation(scene, verlet_options(0.002));
  try {
    simulation.advance(3000);
    FAIL("it was not refused");
  } catch (const Error& error) {
    CAPTURE(error.what());
    CHECK(std::string(error.what()).find("the periodic cell has become") != std::string::npos);
  }
}

TEST_CASE("a_cell_or_a_body_in_it_too_fast_for_the_step_is_refused_before_it_moves") {
  const auto refused = [](const auto& change, const std::vector<std::string>& words) {
    GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 4, 4, 2);
    change(scene);
    try {
      GrainSimulation simulation(scene, verlet_options());
      const auto before = simulation.motions();
      CHECK_THROWS_AS(simulation.advance(1), Error);
      CHECK(simulation.step() == 0);
      CHECK(simulation.motions()[3].u == before[3].u);
      simulation.advance(1);
      FAIL("nothing was refused");
    } catch (const Error& error) {
      for (const std::string& word : words) {
        CAPTURE(error.what(), word);
        CHECK(std::string(error.what()).find(word) != std::string::npos);
      }
    }
  };
  const std::vector<std::string> of_cell{"step 0: bodies of the periodic cell would pass through one another",
                                         "Use a step below"};
  refused([](GrainScene& scene) { scene.cell->rate_xy = {.value = 1e7}; }, of_cell);
  refused([](GrainScene& scene) { scene.cell->rate_yy = {.value = -1e4}; }, of_cell);
  refused(
      [](GrainScene& scene) {
        scene.grains[2].velocity = {1e6, 0};
      },
      {"grain 2 of the periodic cell moves 5000 m in a step of 0.005 s", "pass through others", "Use a step below"});
}
