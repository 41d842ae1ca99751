// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonded discs in periodic cells.
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/plain_cell.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const std::vector<Stepping> steppings_of_bonded_cells{{NormalLaw::linear_dashpot, GrainIntegrator::semi_implicit_euler},
                                                      {NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet},
                                                      {NormalLaw::hertz_dashpot, GrainIntegrator::velocity_verlet}};

/// Two bonded discs and one that meets them, about a place in a cell of 8 by 8.
GrainScene molecule_in_cell(const Stepping& stepping, Vec2 middle) {
  PairProperties pair = one_second(stepping.law, 0.7, 0.5);
  pair.friction = 0.4;
  pair.tangential_ratio = 0.5;
  GrainScene scene =
      scene_of({ball(middle + Vec2{-0.5, 0}, 0.5, {0.1, 0.3}), ball(middle + Vec2{0.4, 0.1}, 0.4, {0, -0.2}),
                ball(middle + Vec2{1.4, 0.4}, 0.45, {-0.5, -0.3})},
               {}, pair);
  GrainBond bond = all_of_a_bond;
  bond.bending_spring = 0.7;
  bond.i = 1, bond.j = 0;
  scene.bonds = {bond};
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 8, .height = 8};
  return scene;
}

/// Discs that fly about in a cell, neighbours bonded in rows across its side, and some columns.
GrainScene bonded_cell(NormalLaw law, int columns, int rows, std::uint64_t seed, const GrainBond& like) {
  GrainScene scene = busy_cell(law, columns, rows, seed, 0.3);
  const auto number = [&](int i, int j) { return static_cast<std::size_t>((i % columns) * rows + j % rows); };
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; j += 2) {
      GrainBond bond = like;
      bond.i = number(i, j), bond.j = number(i + 1, j);
      scene.bonds.push_back(bond);
    }
    if (i % 2 == 0) continue;
    GrainBond bond = like;  // across the lower side
    bond.i = number(i, 0), bond.j = number(i, rows - 1);
    scene.bonds.push_back(bond);
  }
  return scene;
}

GrainBond sprung() {
  return {.normal_spring = 300, .tangential_spring = 150, .bending_spring = 12};
}

/// As a mirror at the y-axis shows it.
GrainScene mirrored(GrainScene scene) {
  for (Grain& grain : scene.grains) {
    grain.position.x *= -1, grain.velocity.x *= -1;
    grain.angle *= -1, grain.spin *= -1;
  }
  PeriodicCell& cell = *scene.cell;
  cell.corner.x = -cell.corner.x - cell.width;
  cell.shift *= -1;
  cell.rate_xy.value *= -1;
  return scene;
}

/// How far a scene and its mirror image are from being mirror images after some steps, in velocity.
double mirror_error(const GrainScene& scene, const GrainOptions& options, int steps) {
  GrainSimulation simulation(scene, options), image(mirrored(scene), options);
  simulation.advance(steps);
  image.advance(steps);
  double error = 0;
  for (std::size_t g = 0; g < scene.grains.size(); ++g) {
    const Grain grain = simulation.grains()[g], other = image.grains()[g];
    error = std::max({error, std::abs(grain.velocity.x + other.velocity.x),
                      std::abs(grain.velocity.y - other.velocity.y), std::abs(grain.spin + other.spin)});
  }
  return error;
}

/// Small discs of a sheared cell, each bonded to its four neighbours.
GrainScene sheared_net(double dashpot) {
  const std::size_t side = 6;
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, side, side, 24, 0.1);
  for (Grain& grain : scene.grains) grain.radius *= 0.5;
  scene.cell->rate_xy = {.value = 1};
  for (std::size_t i = 0; i < side; ++i)
    for (std::size_t j = 0; j < side; ++j)
      for (const std::size_t other : {i * side + (j + 1) % side, (i + 1) % side * side + j})
        scene.bonds.push_back({.i = i * side + j,
                               .j = other,
                               .normal_dashpot = dashpot,
                               .tangential_dashpot = 0.4 * dashpot,
                               .normal_spring = 500,
                               .tangential_spring = 200,
                               .bending_spring = 5});
  return scene;
}

}  // namespace

TEST_CASE("bonded_discs_move_across_the_sides_of_a_cell_as_they_do_inside") {
  const Stepping stepping = GENERATE(from_range(steppings_of_bonded_cells));
  const Vec2 middle = GENERATE(Vec2{8, 4}, Vec2{4, 0}, Vec2{8, 8});
  const GrainScene inside = molecule_in_cell(stepping, {4, 4});
  GrainScene open = inside;
  open.cell.reset();
  GrainOptions options = options_of(stepping, 0.005);
  GrainSimulation a(inside, options), b(molecule_in_cell(stepping, middle), options), c(open, options);
  for (int k = 0; k < 400; ++k) {
    a.advance(1);
    b.advance(1);
    c.advance(1);
    CAPTURE(stepping.name(), middle.x, middle.y, k);
    for (std::size_t g = 0; g < 3; ++g) {
      REQUIRE(norm(a.grains()[g].velocity - c.grains()[g].velocity) < 1e-11);
      REQUIRE(norm(a.grains()[g].velocity - b.grains()[g].velocity) < 1e-11);
      REQUIRE(std::abs(a.grains()[g].spin - b.grains()[g].spin) < 1e-11);
      REQUIRE(distance_in_cell(a.grains()[g].position - Vec2{4, 4}, b.grains()[g].position - middle, *b.cell()) <
              1e-11);
    }
    REQUIRE(std::abs(a.energy().elastic_bond - b.energy().elastic_bond) < 1e-11);
    REQUIRE(std::abs(a.energy().lost_bond - b.energy().lost_bond) < 1e-11);
    REQUIRE(std::abs(a.energy().error() - c.energy().error()) < 1e-11);
  }
  CHECK(b.counters().contacts >= 1);
  CHECK(b.energy().lost_bond > 0.01);
  CHECK(b.energy().elastic_bond > 0);
}

TEST_CASE("a_sheared_cell_of_bonded_discs_moves_as_one_whose_images_are_never_taken_back") {
  GrainScene scene = bonded_cell(NormalLaw::linear_dashpot, 4, 4, 21, sprung());
  scene.pairs[0].friction = 0;
  scene.pairs[0].restitution = 1;
  scene.cell->rate_xy = {.value = GENERATE(2.0, -2.0)};
  const double dt = 0.002;
  GrainSimulation simulation(scene, verlet_options(dt));
  PlainCell plain(scene, dt);
  double apart = 0;
  for (int k = 0; k < 500; ++k) {
    simulation.advance(1);
    plain.step();
    apart = std::max(apart, distance_of_states(simulation.grains(), plain.grains(), *simulation.cell()));
    CAPTURE(k, apart, plain.shift());
    REQUIRE(apart < 1e-7);
  }
  CHECK(std::abs(plain.shift()) > 0.9 * scene.cell->width);
  CHECK(plain.contacts_met() > 20);
  CHECK(apart > 0);
}

TEST_CASE("a_cell_of_bonded_discs_answers_small_strains_by_its_effective_stiffness") {
  const double strain = 1e-8;
  const int columns = 6;
  const LatticeOptions sizes{.columns = columns, .rows = columns, .radius = 0.5, .periodic = true};
  const bool hexagonal = GENERATE(true, false);
  const Assembly lattice = hexagonal ? hexagonal_lattice(sizes) : square_lattice(sizes);
  const double kN = 1000, kT = 400, kM = GENERATE(0.0, 60.0);
  std::vector<Grain> grains;
  for (const Vec2 centre : lattice.centres) grains.push_back(ball(centre, 0.5));
  PairProperties pair = one_second(NormalLaw::linear_dashpot, 1);
  pair.stiffness = 1e-3;  // discs that touch are bonded
  GrainScene scene = scene_of(grains, {}, pair);
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = lattice.period->x, .height = lattice.period->y};
  for (const Contact& contact : lattice.contacts)
    scene.bonds.push_back({.i = static_cast<std::size_t>(contact.i),
                           .j = static_cast<std::size_t>(contact.j),
                           .normal_dashpot = 3,
                           .tangential_dashpot = 3,
                           .normal_spring = kN,
                           .tangential_spring = kT,
                           .bending_spring = kM});
  ContactSprings springs(SpringConstants{kN, kT});
  if (kM > 0) springs = springs.with_bending({kM});
  const Matrix3 expected = effective_stiffness(lattice, springs).stiffness;
  const double step = 1e-3, time = 0.1;
  const Schedule pulse{.kind = Schedule::Kind::table,
                       .times = {0, time, time + 0.1 * step},
                       .values = {strain / time, strain / time, 0}};
  for (int component = 0; component < 3; ++component) {
    GrainScene strained = scene;
    (component == 0   ? strained.cell->rate_xx
     : component == 1 ? strained.cell->rate_yy
                      : strained.cell->rate_xy) = pulse;
    GrainOptions options = verlet_options(step);
    GrainSimulation simulation(strained, options);
    simulation.advance(20000);
    const CellState after = *simulation.cell();
    const double change[3] = {after.stress.xx, after.stress.yy, 0.5 * (after.stress.xy + after.stress.yx)};
    for (int row = 0; row < 3; ++row) {
      CAPTURE(hexagonal, kM, component, row, change[row] / strain, expected[row][component]);
      CHECK(std::abs(change[row] / strain - expected[row][component]) < 1e-6 * kN);
    }
    CHECK(after.coordination_number == (hexagonal ? 6 : 4));
  }
}

TEST_CASE("a_sheared_cell_of_bonds_that_break_heats_by_the_work_of_its_cell") {
  double errors[2];
  for (const int finer : {1, 4}) {
    GrainBond like = sprung();
    like.normal_dashpot = 1;
    like.tangential_dashpot = 1;
    GrainScene scene = bonded_cell(NormalLaw::linear_dashpot, 6, 6, 24, like);
    scene.strengths =
        bond_strengths(scene, {.tension = 18, .shear = 12, .friction = 0.2, .weibull_modulus = 4.0, .seed = 3});
    scene.cell->rate_xy = {.value = 0.5};
    scene.cell->rate_xx = {.value = -0.05};
    GrainOptions options = verlet_options(0.002 / finer);
    GrainSimulation simulation(scene, options);
    simulation.advance(1000 * finer);
    const EnergyLedger ledger = simulation.energy();
    CAPTURE(finer, ledger.kinetic, ledger.elastic(), ledger.lost_bond, ledger.lost_breaking, ledger.work_of_cell,
            simulation.breaks().size(), scene.bonds.size());
    CHECK(simulation.breaks().size() > 4);
    CHECK(simulation.breaks().size() < scene.bonds.size());
    CHECK(ledger.lost_bond > 0.1);
    CHECK(norm(momentum_in_cell(simulation)) < 1e-10);
    errors[finer - 1 > 0] = std::abs(ledger.error()) / ledger.largest();
    CHECK(errors[finer - 1 > 0] < 5e-3);
  }
  CAPTURE(errors[0], errors[1]);
  CHECK(errors[1] < 0.6 * errors[0]);
}

TEST_CASE("a_cell_whose_last_bond_broke_has_the_stress_of_its_motion_alone") {
  PairProperties pair = one_second(NormalLaw::linear_dashpot, 1, 0.5);
  GrainScene scene = scene_of({ball({0.3, 4}, 0.5, {}), ball({7.3, 4}, 0.5, {})}, {}, pair);  // across the left side
  GrainBond bond = sprung();
  bond.i = 0, bond.j = 1;
  scene.bonds = {bond};
  scene.strengths = bond_strengths(scene, {.tension = 0.3, .shear = 50});
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 8, .height = 8};
  scene.cell->rate_xx = {.value = 0.05};
  GrainSimulation simulation(scene, verlet_options(0.001));
  double largest = 0;
  while (simulation.breaks().empty() && simulation.step() < 5000) {
    simulation.advance(1);
    largest = std::max(largest, std::abs(simulation.cell()->stress.xx));
  }
  simulation.advance(100);
  const CellState cell = *simulation.cell();
  double flux = 0;
  for (const Grain& grain : simulation.grains()) flux += grain.inertia.mass * grain.velocity.x * grain.velocity.x;
  const double by_motion = -flux / (cell.width * cell.height);
  CAPTURE(simulation.breaks().size(), largest, cell.stress.xx, by_motion);
  REQUIRE(simulation.breaks().size() == 1);
  CHECK(largest > 10 * std::abs(by_motion));
  CHECK(std::abs(cell.stress.xx - by_motion) < 1e-9 * largest);
}

TEST_CASE("a_cell_of_bonds_that_break_goes_on_with_its_bits_over_threads_blocks_margins_and_wraps") {
  const Stepping stepping = GENERATE(from_range(steppings_of_bonded_cells));
  const double rate = GENERATE(0.0, 2.0);
  if (rate != 0 && stepping.integrator != GrainIntegrator::velocity_verlet) return;
  GrainBond like = sprung();
  like.normal_dashpot = 1;
  GrainScene scene = bonded_cell(stepping.law, 5, 4, 6, like);
  const double strong = rate != 0 ? 3 : 1;
  scene.strengths =
      bond_strengths(scene, {.tension = 12 * strong, .shear = 8 * strong, .friction = 0.2, .weibull_modulus = 3.0});
  for (Grain& grain : scene.grains) grain.velocity = 4 * grain.velocity + Vec2{2, 1};  // all drift out of the cell
  scene.cell->rate_xy = {.value = rate};
  GrainOptions options = options_of(stepping, 0.002);
  options.bodies_per_block = 7;
  GrainSimulation whole(scene, options);
  whole.advance(900);
  const Bits end = bits_of(whole);
  CAPTURE(stepping.name(), rate, whole.breaks().size(), scene.bonds.size());
  CHECK(whole.breaks().size() > 2);
  CHECK(whole.breaks().size() < scene.bonds.size());
  GrainSimulation stepped(scene, options);
  for (const int steps : {100, 155, 1, 1, 143, 111, 1, 188}) {
    GrainSimulation resumed(scene, options);
    resumed.restore(stepped.save());
    resumed.advance(900 - stepped.step());
    CAPTURE(stepped.step());
    REQUIRE(bits_of(resumed) == end);
    stepped.advance(steps);
  }
  const int before = thread_count();
  for (const double margin : {1e-3, 0.2, 1.0})
    for (const int threads : {1, 2, 4}) {
      options.margin = margin;
      set_thread_count(threads);
      GrainSimulation other(scene, options);
      other.advance(900);
      CAPTURE(margin, threads);
      CHECK(bits_of(other) == end);
    }
  set_thread_count(before);
}

TEST_CASE("a_sheared_cell_and_its_mirror_image_move_as_mirror_images") {
  GrainScene dense = busy_cell(NormalLaw::linear_dashpot, 6, 6, 24);
  for (Grain& grain : dense.grains) grain.radius *= 1.3;
  dense.cell->rate_xy = {.value = 1};
  GrainOptions options = verlet_options(0.002);
  CHECK(mirror_error(dense, options, 100) < 1e-11);
  CHECK(mirror_error(sheared_net(0), options, 100) < 1e-11);
}

TEST_CASE("bonds_whose_dashpots_decay_one_after_the_other_differ_in_a_mirror_by_the_square_of_the_step") {
  const GrainScene scene = sheared_net(5);
  double before = mirror_error(scene, verlet_options(0.001), 1);
  CHECK(before > 1e-6);
  for (const double step : {5e-4, 2.5e-4, 1.25e-4}) {
    const double error = mirror_error(scene, verlet_options(step), 1);
    CAPTURE(step, error, before / error);
    CHECK(before / error == Approx(4).epsilon(0.1));
    before = error;
  }
}
