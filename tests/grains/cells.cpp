// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs, ellipses, clumps and bonded discs in periodic cells, which stand, deform at a rate or keep a stress.
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"

#include "grains/bonded_scenes.hpp"
#include "grains/plain_cell.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

enum class Kind { discs, shapes, bonded };

/// Discs, ellipses and clumps that fly about in a cell.
GrainScene mixed_cell(NormalLaw law, int columns, int rows, std::uint64_t seed, double speed = 1) {
  GrainScene scene = mixed_box(law, columns, rows, seed);
  scene.pairs[0].stiffness *= 8;  // small discs of clumps are not pressed into others
  return in_cell_of_its_size(std::move(scene), columns, rows, speed);
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

/// Bodies that meet about a place in a cell of 8 by 8: 0 two discs, 1 ellipse and disc, 2 clump and ellipse, 3 two
/// clumps, 4 two bonded discs and a third.
GrainScene meeting_in_cell(const Stepping& stepping, int which, Vec2 middle) {
  PairProperties pair = one_second(stepping.law, 0.7, 0.5);
  pair.friction = 0.4;
  pair.tangential_ratio = 0.5;
  GrainScene scene = scene_of({}, {}, pair);
  const Vec2 left = middle + Vec2{-0.9, -0.1}, right = middle + Vec2{0.9, 0.15};
  const std::vector<Clump::Disc> discs{{{0, 0}, 0.5}, {{0.6, 0}, 0.4}};
  if (which == 0)
    scene.grains = {ball(middle + Vec2{-0.75, -0.125}, 0.5, {0.5, 0.25}),
                    ball(middle + Vec2{0.75, 0.125}, 0.75, {-0.5, 0.125}, 2)};
  if (which == 1) scene.grains = {oval(left, 0.8, 0.5, 0.3, {0.5, 0.25}), ball(right, 0.7, {-0.5, 0.1})};
  if (which == 2) scene.grains = {lump(scene, discs, left, 0.3, {0.5, 0.25}), oval(right, 0.8, 0.5, 1.3, {-0.5, 0.1})};
  if (which == 3)
    scene.grains = {lump(scene, discs, left, 0.3, {0.5, 0.25}), lump(scene, discs, right, 2.3, {-0.5, 0.1})};
  if (which == 4) {
    scene.grains = {ball(middle + Vec2{-0.5, 0}, 0.5, {0.1, 0.3}), ball(middle + Vec2{0.4, 0.1}, 0.4, {0, -0.2}),
                    ball(middle + Vec2{1.4, 0.4}, 0.45, {-0.5, -0.3})};
    GrainBond bond = all_of_a_bond;
    bond.bending_spring = 0.7;
    bond.i = 1, bond.j = 0;
    scene.bonds = {bond};
  } else {
    scene.grains[0].spin = which == 0 ? 1 : 0.6;
  }
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 8, .height = 8};
  return scene;
}

/// \return how many there are
std::size_t check_contacts(const GrainSimulation& simulation, const std::vector<Clump>& clumps) {
  // shear and places outside the cell move the nearest image by some periods
  const CellState cell = simulation.cell().value_or(CellState{});
  std::vector<PlainContact> oracle = contacts_of_all_images(simulation.grains(), clumps, {cell.width, 0},
                                                            {cell.shift, cell.height}, simulation.cell() ? 4 : 0);
  std::erase_if(oracle, [](const PlainContact& c) { return c.overlap < 1e-12; });
  std::vector<GrainContact> found = simulation.contacts();
  std::erase_if(found, [](const GrainContact& c) { return c.overlap < 1e-12 || c.j < 0; });
  const auto order = [](const auto& c) { return std::tuple(c.i, c.j, c.overlap); };
  std::ranges::sort(oracle, {}, order);
  std::ranges::sort(found, {}, order);
  REQUIRE(found.size() == oracle.size());
  for (std::size_t c = 0; c < found.size(); ++c) {
    REQUIRE(found[c].i == oracle[c].i);
    REQUIRE(found[c].j == oracle[c].j);
    REQUIRE(std::abs(found[c].overlap - oracle[c].overlap) < (clumps.empty() ? 1e-12 : 1e-11));
    REQUIRE(norm(found[c].normal - oracle[c].normal) < 1e-7);
    REQUIRE(norm(found[c].arm_i - oracle[c].arm_i) < 1e-7);
  }
  return found.size();
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

TEST_CASE("bodies_meet_across_the_sides_of_a_cell_as_they_do_inside") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const int which = GENERATE(0, 1, 2, 3, 4);
  const Vec2 middle = GENERATE(Vec2{8, 4}, Vec2{4, 0}, Vec2{8, 8}, Vec2{0, 0.25});
  const GrainScene inside = meeting_in_cell(stepping, which, {4, 4});
  GrainScene open = inside;
  open.cell.reset();
  const GrainOptions options = options_of(stepping, which == 0 ? 0.01 : 0.005);
  const double round_off = which == 0 ? 1e-12 : 1e-11;
  GrainSimulation a(inside, options), b(meeting_in_cell(stepping, which, middle), options), c(open, options);
  for (int k = 0; k < 400; ++k) {
    a.advance(1);
    b.advance(1);
    c.advance(1);
    CAPTURE(stepping.name(), which, middle.x, middle.y, k);
    if (inside.bonds.empty()) REQUIRE(bits_of(a) == bits_of(c));  // a cell that no body crosses changes nothing
    for (std::size_t g = 0; g < inside.grains.size(); ++g) {
      REQUIRE(norm(a.grains()[g].velocity - c.grains()[g].velocity) < round_off);
      REQUIRE(norm(a.grains()[g].velocity - b.grains()[g].velocity) < round_off);
      REQUIRE(std::abs(a.grains()[g].spin - b.grains()[g].spin) < round_off);
      REQUIRE(distance_in_cell(a.grains()[g].position - Vec2{4, 4}, b.grains()[g].position - middle, *b.cell()) <
              round_off);
    }
    const EnergyLedger here = a.energy(), there = b.energy();
    REQUIRE(std::abs(here.elastic() - there.elastic()) < round_off);
    REQUIRE(std::abs(here.elastic_bond - there.elastic_bond) < round_off);
    REQUIRE(std::abs(here.lost_slip - there.lost_slip) < round_off);
    REQUIRE(std::abs(here.lost_dashpot - there.lost_dashpot) < round_off);
    REQUIRE(std::abs(here.lost_bond - there.lost_bond) < round_off);
    REQUIRE(std::abs(here.error() - c.energy().error()) < round_off);
  }
  CHECK(b.counters().contacts >= 1);
  CHECK(b.counters().contacts == a.counters().contacts);
  CHECK(b.energy().lost_dashpot + b.energy().lost_bond > 0.01);
  CHECK((b.energy().elastic_bond > 0) == (which == 4));
}

TEST_CASE("contacts_in_a_cell_are_those_of_all_images") {
  // after a step of these schemes contacts are those of the places at that time
  const Stepping stepping = GENERATE(force_steppings[1], force_steppings[3]);
  const bool shapes = GENERATE(false, true);
  const std::uint64_t seed = GENERATE(1, 2, 3);
  const double rate = GENERATE(0.0, 2.0, -3.0);
  GrainScene scene = shapes ? mixed_cell(stepping.law, 6, 4, seed, 2) : busy_cell(stepping.law, 6, 4, seed, 3);
  scene.cell->rate_xy = {.value = rate};
  scene.cell->rate_xx = {.value = rate < 0 ? 0.1 : 0};
  scene.cell->rate_yy = {.value = rate < 0 ? -0.1 : 0};
  GrainSimulation simulation(scene, options_of(stepping, shapes ? 0.001 : 0.002));
  std::size_t contacts = 0;
  for (int k = 0; k < 150; ++k) {
    simulation.advance(10);
    CAPTURE(stepping.name(), shapes, seed, rate, k);
    contacts += check_contacts(simulation, scene.clumps);
  }
  CHECK(contacts > 100);
  CHECK(simulation.counters().contacts > 20);
  if (rate != 0) CHECK(std::abs(simulation.cell()->strain.xy) * 4 > 6);  // past the period
}

TEST_CASE("contacts_of_needles_are_those_of_all_pairs") {
  GrainOptions options = verlet_options(3e-4);
  options.margin = GENERATE(0.0, 1e-6, 2.0);
  GrainSimulation simulation(flying_needles(24, 31), options);
  std::size_t contacts = 0;
  for (int k = 0; k < 400; ++k) {
    simulation.advance(20);
    CAPTURE(options.margin, k);
    contacts += check_contacts(simulation, {});
  }
  CAPTURE(options.margin, simulation.counters().contacts, simulation.counters().rebuilds);
  CHECK(contacts > 20);
  CHECK(simulation.counters().contacts > 50);
  CHECK(simulation.counters().rebuilds > 2);
}

TEST_CASE("a_sheared_cell_moves_as_one_whose_images_are_never_taken_back") {
  const Kind kind = GENERATE(Kind::discs, Kind::shapes, Kind::bonded);
  const NormalLaw law = NormalLaw::linear_dashpot;
  GrainScene scene = kind == Kind::discs    ? busy_cell(law, 4, 4, 21)
                     : kind == Kind::shapes ? mixed_cell(law, 4, 4, 21)
                                            : bonded_cell(law, 4, 4, 21, sprung());
  scene.pairs[0].friction = 0;
  scene.pairs[0].restitution = 1;
  scene.cell->rate_xy = {.value = GENERATE(2.0, -2.0)};
  const double dt = kind == Kind::shapes ? 0.001 : 0.002;
  const int steps = kind == Kind::discs ? 800 : kind == Kind::shapes ? 1200 : 500;
  GrainSimulation simulation(scene, verlet_options(dt));
  PlainCell plain(scene, dt);
  double apart = 0;
  for (int k = 0; k < steps; ++k) {
    simulation.advance(1);
    plain.step();
    const CellState cell = *simulation.cell();
    apart = std::max(apart, distance_of_states(simulation.grains(), plain.grains(), cell));
    CAPTURE(static_cast<int>(kind), k, apart, plain.shift(), cell.shift);
    REQUIRE(apart < (kind == Kind::shapes ? 1e-6 : 1e-7));  // round-off, and its growth in collisions
    REQUIRE(std::abs(std::remainder(plain.shift() - cell.shift, cell.width)) < 1e-9);
    REQUIRE(std::abs(cell.shift) <= 0.5 * cell.width * (1 + 1e-12));
  }
  CHECK(std::abs(plain.shift()) > 0.9 * scene.cell->width);
  CHECK(plain.contacts_met() > 20);
  CHECK(simulation.counters().contacts > (kind == Kind::bonded ? 0 : 15));
  CHECK(apart > 0);
}

TEST_CASE("a_cell_keeps_its_momentum_and_its_energy") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool shapes = GENERATE(false, true);
  const GrainScene scene = shapes ? mixed_cell(stepping.law, 6, 5, 4, 2) : busy_cell(stepping.law, 6, 5, 4, 2);
  GrainSimulation simulation(scene, options_of(stepping, shapes ? 5e-4 : 1e-3));
  simulation.advance(shapes ? 4000 : 3000);
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(stepping.name(), shapes, norm(momenta_of(simulation.grains()).linear), ledger.error(), ledger.largest());
  CHECK(norm(momenta_of(simulation.grains()).linear) < 1e-11);
  CHECK(std::abs(ledger.error()) < (shapes ? 2e-3 : 1e-3) * ledger.largest());
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

TEST_CASE("a_servo_deforms_a_cell_of_shapes_alike_wherever_it_is_cut") {
  GrainScene scene = mixed_cell(NormalLaw::linear_dashpot, 6, 5, 5, 2);
  scene.cell->servo = CellServo{.stress_xx = Schedule{.value = -5}, .max_rate = 10};
  GrainScene other = scene;
  for (Grain& grain : other.grains) grain.position += Vec2{2.7, -1.3};
  GrainSimulation a(scene, verlet_options(0.001)), b(other, verlet_options(0.001));
  a.advance(400);
  b.advance(400);
  CAPTURE(a.cell()->width, b.cell()->width, a.contacts().size());
  CHECK(std::abs(a.cell()->width - 6) > 0.01);
  CHECK(std::abs(a.cell()->width - b.cell()->width) < 1e-9);
}

TEST_CASE("bodies_slide_down_along_a_cell_on_a_floor_and_keep_their_energy") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const bool shapes = GENERATE(false, true);
  if (shapes && stepping.law != NormalLaw::linear_dashpot) return;
  PairProperties pair = one_second(stepping.law, 1, 1);
  pair.stiffness *= 100;
  GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, pair, {1, -1});
  if (shapes)
    scene.grains = {oval({1, 0.249}, 0.5, 0.25), lump(scene, {{{-0.3, 0}, 0.3}, {{0.3, 0}, 0.3}}, {3, 0.2985})};
  else
    scene.grains = {ball({1, 0.499}, 0.5), ball({3, 0.499}, 0.5)};
  scene.cell = PeriodicCell{.along = PeriodicCell::Along::x, .corner = {0, 0}, .width = 4};
  const double step = shapes ? 0.002 : 0.005;
  GrainSimulation simulation(scene, options_of(stepping, step));
  simulation.advance(std::llround(10 / step));  // 10 s: 50 m, twelve periods
  const EnergyLedger ledger = simulation.energy();
  CAPTURE(stepping.name(), shapes, ledger.kinetic, ledger.potential, ledger.error());
  CHECK(ledger.kinetic == Approx(100).epsilon(shapes ? 0.02 : 0.01));
  CHECK(std::abs(ledger.error()) < (shapes ? 2e-3 : 1e-3) * ledger.kinetic);
  CHECK_FALSE(simulation.cell().has_value());
  for (const Grain& grain : simulation.grains()) CHECK(std::abs(grain.position.x - 2) < 2 + 256 * step * 10);
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

TEST_CASE("a_sheared_cell_heats_by_the_work_of_its_cell") {
  const Kind kind = GENERATE(Kind::discs, Kind::shapes, Kind::bonded);
  const NormalLaw law = NormalLaw::linear_dashpot;
  GrainBond like = sprung();
  like.normal_dashpot = like.tangential_dashpot = 1;
  GrainScene scene = kind == Kind::discs    ? busy_cell(law, 6, 6, 24)
                     : kind == Kind::shapes ? mixed_cell(law, 6, 6, 24)
                                            : bonded_cell(law, 6, 6, 24, like);
  if (kind == Kind::bonded)
    scene.strengths =
        bond_strengths(scene, {.tension = 18, .shear = 12, .friction = 0.2, .weibull_modulus = 4.0, .seed = 3});
  else
    scene.pairs[0].restitution = 0.9;
  scene.cell->rate_xy = {.value = kind == Kind::bonded ? 0.5 : 1};
  scene.cell->rate_xx = {.value = kind == Kind::shapes ? -0.02 : -0.05};
  const int steps = kind == Kind::discs ? 1500 : kind == Kind::shapes ? 2500 : 1000;
  std::vector<double> errors;
  for (const int finer : {1, kind == Kind::bonded ? 4 : 2}) {
    GrainSimulation simulation(scene, verlet_options((kind == Kind::shapes ? 0.001 : 0.002) / finer));
    simulation.advance(steps * finer);
    const EnergyLedger ledger = simulation.energy();
    CAPTURE(static_cast<int>(kind), finer, ledger.kinetic, ledger.elastic(), ledger.lost(), ledger.work_of_cell,
            ledger.initial, simulation.breaks().size());
    CHECK(norm(momenta_of(simulation.grains()).linear) < 1e-10);
    if (kind == Kind::bonded) {
      CHECK(simulation.breaks().size() > 4);
      CHECK(simulation.breaks().size() < scene.bonds.size());
      CHECK(ledger.lost_bond > 0.1);
      errors.push_back(std::abs(ledger.error()) / ledger.largest());
    } else {
      CHECK(simulation.counters().contacts > 100);
      CHECK(ledger.work_of_cell > (kind == Kind::shapes ? 0.3 : 0.5) * ledger.initial);
      CHECK(ledger.lost_slip > 0);
      errors.push_back(std::abs(ledger.error()) / ledger.work_of_cell);
    }
    CHECK(errors.back() < (kind == Kind::bonded ? 5e-3 : kind == Kind::shapes ? 4e-3 : 2e-3));
  }
  CAPTURE(static_cast<int>(kind), errors);
  CHECK(errors[1] < (kind == Kind::bonded ? 0.6 : 1) * errors[0]);
}

TEST_CASE("contacts_and_bonds_across_the_sides_of_a_cell_do_not_depend_on_which_body_has_the_lower_number") {
  GrainBond like = sprung();
  like.normal_dashpot = like.tangential_dashpot = 1;
  GrainScene scene = bonded_cell(NormalLaw::linear_dashpot, 6, 6, 24, like);
  scene.cell->rate_xy = {.value = 0.5};
  GrainScene reversed = scene;
  std::ranges::reverse(reversed.grains);
  const std::size_t last = scene.grains.size() - 1;
  for (GrainBond& bond : reversed.bonds) bond.i = last - bond.i, bond.j = last - bond.j;
  GrainSimulation one(scene, verlet_options(0.002)), other(reversed, verlet_options(0.002));
  one.advance(100);
  other.advance(100);
  const std::vector<Grain> grains = one.grains();
  const std::vector<BodyContact> contacts = one.body_contacts(), swapped = other.body_contacts();
  REQUIRE(contacts.size() == swapped.size());
  CHECK(contacts.size() >= scene.bonds.size());
  std::ptrdiff_t across = 0;
  for (const BodyContact& c : contacts) {
    const auto i = static_cast<std::int32_t>(last) - c.i, j = static_cast<std::int32_t>(last) - c.j;
    const auto same = std::ranges::find_if(swapped, [&](const BodyContact& d) { return d.i == j && d.j == i; });
    CAPTURE(c.i, c.j, c.shift.x, c.shift.y);
    REQUIRE(same != swapped.end());
    CHECK(norm(same->shift + c.shift) < 1e-12);
    CHECK(norm(same->force + c.force) < 1e-8);
    CHECK(std::abs(same->bending_moment + c.bending_moment) < 1e-8);
    const Vec2 branch = grains[c.j].position + c.shift - grains[c.i].position;
    CHECK(norm(branch) < 1.5);                         // the nearest image, of a cell of 6 by 6
    CHECK(norm(same->arm - (c.arm - branch)) < 1e-9);  // both lead to one point
    across += static_cast<std::ptrdiff_t>(norm(c.shift) > 0);
  }
  CHECK(across >= 5);
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

TEST_CASE("a_lattice_in_a_cell_answers_small_strains_by_its_effective_stiffness") {
  const bool bonded = GENERATE(false, true), hexagonal = GENERATE(false, true);
  const double kN = 1000, kT = 400, kM = GENERATE(0.0, 60.0);
  if (!bonded && (hexagonal || kM > 0)) return;
  const double strain = 1e-8, time = 0.1, step = bonded ? 1e-3 : 1e-4;
  const double closer = bonded ? 1 : 1 - 1e-7;  // discs without bonds stay in contact
  const LatticeOptions sizes{.columns = 6, .rows = 6, .radius = 0.5, .periodic = true};
  const Assembly lattice = hexagonal ? hexagonal_lattice(sizes) : square_lattice(sizes);
  PairProperties pair{
      .stiffness = kN, .restitution = 0.1, .friction = 100, .tangential_ratio = kT / kN, .tangential_damping = 0.3};
  if (bonded) pair = {.stiffness = 1e-3};  // discs that touch are bonded
  GrainScene scene = scene_of({}, {}, pair);
  for (const Vec2 centre : lattice.centres) scene.grains.push_back(ball(closer * centre, 0.5));
  scene.cell =
      PeriodicCell{.corner = {0, 0}, .width = closer * lattice.period->x, .height = closer * lattice.period->y};
  for (const Contact& contact : lattice.contacts) {
    if (!bonded) break;
    scene.bonds.push_back({.i = static_cast<std::size_t>(contact.i),
                           .j = static_cast<std::size_t>(contact.j),
                           .normal_dashpot = 3,
                           .tangential_dashpot = 3,
                           .normal_spring = kN,
                           .tangential_spring = kT,
                           .bending_spring = kM});
  }
  ContactSprings springs(SpringConstants{kN, kT});
  if (kM > 0) springs = springs.with_bending({kM});
  const Matrix3 expected = effective_stiffness(lattice, springs).stiffness;
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
    simulation.advance(bonded ? 20000 : 30000);
    const CellState after = *simulation.cell();
    const double change[3] = {after.stress.xx - before.xx, after.stress.yy - before.yy,
                              0.5 * (after.stress.xy + after.stress.yx)};
    const double reached[3] = {after.strain.xx, after.strain.yy, after.strain.xy};
    for (int row = 0; row < 3; ++row) {
      CAPTURE(bonded, hexagonal, kM, component, row, change[row] / strain, expected[row][component]);
      CHECK(reached[row] == Approx(row == component ? strain : 0).epsilon(bonded ? 1e-4 : 1e-6).margin(1e-20));
      CHECK(std::abs(change[row] / strain - expected[row][component]) < 1e-6 * kN);
    }
    CHECK(after.coordination_number == (hexagonal ? 6 : 4));
  }
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

namespace {

/// Two discs 1 m apart in a cell of 2.4 m, in which they drift: a bond along x that swings by 0.3 m is shorter than
/// half a period or longer.
GrainScene swinging_pair(NormalLaw law) {
  constexpr double drift = 4.7, parting = 4.2;
  GrainScene scene = scene_of(
      {ball({0.7, 1.2}, 0.5, {drift - 0.5 * parting, 0.3}), ball({1.7, 1.2}, 0.5, {drift + 0.5 * parting, 0.3})}, {},
      one_second(law, 1));
  scene.bonds = {
      {.i = 1, .j = 0, .normal_dashpot = 0.01, .normal_spring = 100, .tangential_spring = 50, .bending_spring = 5}};
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 2.4, .height = 2.4};
  return scene;
}

double relative_speed(const GrainSimulation& simulation) {
  return simulation.grains()[1].velocity.x - simulation.grains()[0].velocity.x;
}

}  // namespace

TEST_CASE("a_bond_stretched_past_half_a_period_of_a_cell_pulls_as_without_the_cell") {
  const Stepping stepping = GENERATE(from_range(spring_bond_steppings));
  const GrainScene scene = swinging_pair(stepping.law);
  GrainScene open = scene;
  open.cell.reset();
  const GrainOptions options = options_of(stepping, 1e-3);
  const std::int64_t first = 520, steps = 4000;  // stretched by 0.26 m where the second stage begins
  std::vector<GrainStage> stages(2, GrainStage{.name = "one", .scene = scene, .steps = first});
  stages[1].name = "two";
  stages[1].steps = steps - first;
  StagedSimulation staged(stages, options);
  GrainSimulation simulation(scene, options), free(open, options);
  std::size_t stretched = 0;
  for (std::int64_t k = 0; k < steps; k += 10) {
    simulation.advance(10);
    free.advance(10);
    staged.advance(10);
    const double distance = norm(free.grains()[1].position - free.grains()[0].position);
    CAPTURE(stepping.name(), simulation.step(), distance);
    if (distance > 1.2) ++stretched;
    REQUIRE(std::abs(relative_speed(simulation) - relative_speed(free)) < 1e-9);
    REQUIRE(std::abs(relative_speed(staged.present()) - relative_speed(free)) < 1e-9);
    REQUIRE(std::abs(simulation.energy().elastic_bond - free.energy().elastic_bond) < 1e-9);
    if (distance < 1.25) continue;
    GrainSimulation resumed(scene, options), whole(scene, options);
    resumed.restore(simulation.save());
    whole.advance(simulation.step() + 7);
    resumed.advance(7);
    REQUIRE(bits_of(resumed) == bits_of(whole));
  }
  CHECK(stretched > 40);
  CHECK(simulation.counters().contacts == 0);
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
    CAPTURE(servo.component, servo.reached, servo.wanted, servo.present, servo.overshoot, servo.mean_error);
    CHECK(servo.reached);
    CHECK(servo.present == Approx(servo.wanted).epsilon(0.02));
  }
  CHECK(cell.stress.xx == Approx(-pressure).epsilon(0.02));
  CHECK(cell.stress.yy == Approx(-2 * pressure).epsilon(0.02));
  CHECK(cell.void_ratio < 0.35);
  CHECK(cell.coordination_number > 2.5);
  const EnergyLedger ledger = simulation.energy();
  CHECK(std::abs(ledger.error()) < 0.01 * ledger.work_of_cell);
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

TEST_CASE("a_sheared_cell_and_its_mirror_image_move_as_mirror_images") {
  GrainScene dense = busy_cell(NormalLaw::linear_dashpot, 6, 6, 24);
  for (Grain& grain : dense.grains) grain.radius *= 1.3;
  dense.cell->rate_xy = {.value = 1};
  GrainOptions options = verlet_options(0.002);
  CHECK(mirror_error(dense, options, 100) < 1e-11);
  CHECK(mirror_error(sheared_net(0), options, 100) < 1e-11);
  // bonds whose dashpots decay one after the other differ in a mirror by the square of the step
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

TEST_CASE("what_a_cell_does_not_carry_is_refused_by_name") {
  const GrainScene good = busy_cell(NormalLaw::linear_dashpot, 4, 4, 7);
  const GrainOptions options = verlet_options();
  const auto check_scene = [&](const auto& change, const std::vector<std::string>& words) {
    GrainScene scene = good;
    change(scene);
    check_refused([&] { return GrainSimulation(scene, options); }, words);
  };
  check_scene([](GrainScene& s) { s.cell->width = 1.9; }, {"width = 1.9 m", "several images"});
  check_scene([](GrainScene& s) { s.cell->height = 0; }, {"the height of the periodic cell is 0 m"});
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
  check_refused([&] { return GrainSimulation(good, options_of(NormalLaw::exact_flow, 0.01)); }, {"law exact_flow"});
  GrainScene shaped = good;
  shaped.grains[3].short_half_axis = 0.5 * shaped.grains[3].radius;
  GrainOptions enlarged = options;
  enlarged.ellipse_law = GrainOptions::EllipseLaw::enlarged;
  check_refused([&] { return GrainSimulation(shaped, enlarged); }, {"enlarged", "exact contact"});
  GrainScene moving = good;
  moving.cell->rate_xy = {.value = 1};
  check_refused([&] { return GrainSimulation(moving, options_of(NormalLaw::linear_dashpot, 0.01)); },
                {"semi_implicit_euler", "velocity_verlet"});
}

TEST_CASE("a_cell_that_becomes_too_thin_is_refused") {
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 4, 4, 28);
  for (Grain& grain : scene.grains) grain.radius *= 0.5;
  scene.cell->rate_yy = {.value = -1};
  scene.cell->rate_xx = {.value = 1};
  GrainSimulation simulation(scene, verlet_options(0.002));
  check_refused([&] { simulation.advance(3000); }, {"the periodic cell has become"}, ErrorKind::computation_failed);
}

TEST_CASE("a_cell_or_a_body_in_it_too_fast_for_the_step_is_refused_before_it_moves") {
  const auto refused = [](const auto& change, const std::vector<std::string>& words) {
    GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 4, 4, 2);
    change(scene);
    GrainSimulation simulation(scene, verlet_options());
    const Bits before = bits_of(simulation);
    for (int k = 0; k < 2; ++k) {
      check_refused([&] { simulation.advance(1); }, words, ErrorKind::computation_failed);
      CHECK(bits_of(simulation) == before);
    }
  };
  const std::vector<std::string> of_cell{"step 0: bodies of the periodic cell would pass through one another",
                                         "Use a step below"};
  refused([](GrainScene& scene) { scene.cell->rate_xy = {.value = 1e7}; }, of_cell);
  refused([](GrainScene& scene) { scene.cell->rate_yy = {.value = -1e4}; }, of_cell);
  GrainScene scene = busy_cell(NormalLaw::linear_dashpot, 4, 4, 2);
  scene.grains[2].velocity.x = 1e6;
  check_refused(
      [&] { GrainSimulation(scene, verlet_options()); },
      {"grain 2 of the periodic cell moves 5000 m in a step of 0.005 s", "pass through others", "Use a step below"});
}
