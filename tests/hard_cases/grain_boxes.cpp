// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that are pressed, squeezed and shaken, and what has next to nothing to act on it: no gravity, one grain.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/motion/wall.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/packing.hpp"

#include "hard_cases/bodies.hpp"
#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Schedule steady(double speed) {
  return {Schedule::Kind::table, 0, 0, 0, 0, {0, 1000}, {0, 1000 * speed}};
}

double force_on_wall(const GrainSimulation& simulation, std::int32_t wall) {
  double force = 0;
  for (const GrainContact& c : simulation.contacts()) force += c.j == ~wall ? c.normal_force : 0;
  return force;
}

const HardCase::Words closing_gap{.name = "a grain squeezed by a closing gap",
                                  .why =
                                      "the force grows without bound; springs that cannot hold let walls pass "
                                      "through the body unseen"};

}  // namespace

TEST_CASE("a_grain_in_a_closing_gap_is_squeezed_until_that_is_refused") {
  HardCase table(closing_gap);
  for (const BodyKind kind : all_bodies) {
    GrainScene scene =
        scene_of({}, {line("anvil", {0, 0}, {0, 1}), line("press", {0, 2.02}, {0, -1})}, {.stiffness = 1000});
    scene.walls[1].move_y = steady(-0.1);
    add_body(scene, kind, {0, 1.01}, 1);
    GrainSimulation simulation(scene, verlet(1e-3));
    const Answer answer = attempt([&] { simulation.advance(100000); });
    const Bits before = bits_of(simulation);
    CHECK_THROWS_AS(simulation.advance(1), Error);
    CHECK(bits_of(simulation) == before);
    const EnergyLedger ledger = simulation.energy();
    const double error = std::abs(ledger.error()) / ledger.work_of_walls;
    CAPTURE(name_of(kind), simulation.time(), error);
    CHECK(simulation.time() > 1);
    CHECK(error < 1e-4);
    table.refused("between plates, " + name_of(kind) + "; the state is that before", answer, {"grain", "wall", "Use"});
    table.note("between plates until then, " + name_of(kind), "energy to 1e-4 of the work of the walls",
               "energy " + digits(error));
  }
}

TEST_CASE("a_grain_in_a_closing_wedge_is_shot_out_with_the_work_of_the_walls") {
  HardCase table(closing_gap);
  for (const BodyKind kind : all_bodies) {
    std::vector<double> errors;
    double speed = 0;
    for (const double step : {4e-4, 2e-4, 1e-4}) {
      GrainScene scene = scene_of(
          {}, {line("below", {0, 0}, {-0.2, std::sqrt(0.96)}), line("above", {0, 0}, {-0.2, -std::sqrt(0.96)})},
          {.stiffness = 1e4});
      scene.walls[0].point = {10, 0};
      scene.walls[1].point = {10, 0};
      add_body(scene, kind, {4.5, 0.02}, 1, 0.1);
      scene.walls[0].move_y = {Schedule::Kind::ramp, 0.6, 0, 0.5};
      scene.walls[1].move_y = {Schedule::Kind::ramp, -0.6, 0, 0.5};
      GrainSimulation simulation(scene, verlet(step));
      const Balance balance = keep(simulation, static_cast<std::int64_t>(std::llround(2 / step)));
      CAPTURE(name_of(kind), step, balance.energy, balance.contacts);
      CHECK(simulation.contacts().empty());
      CHECK(balance.contacts > 0);
      errors.push_back(balance.energy);
      speed = -simulation.grains()[0].velocity.x;
    }
    CAPTURE(name_of(kind), errors, speed);
    CHECK(speed > 0.5);
    CHECK(errors[2] < 2e-4);
    CHECK(errors[2] < errors[0] / 3);
    table.note("shot out of a wedge, " + name_of(kind),
               "energy to 2e-4 of the work of the walls, falling with the step",
               fmt::format("{}, {}, {}", digits(errors[0]), digits(errors[1]), digits(errors[2])));
  }
}

TEST_CASE("a_box_filled_past_its_volume_balances_or_is_refused") {
  HardCase table({.name = "a box filled past its volume",
                  .why = "no place is left without overlaps: what is asked for cannot be, or only pressed"});
  for (const auto method : {PackingMethod::rejection, PackingMethod::local_moves, PackingMethod::growth}) {
    for (const auto kind : {PackingShape::Kind::disc, PackingShape::Kind::ellipse, PackingShape::Kind::rigid_pair,
                            PackingShape::Kind::bonded_pair}) {
      PackingOptions options;
      options.method = method;
      options.shape.kind = kind;
      options.radii.assign(20, 0.5);
      const double side = std::sqrt(area_of(options.shape, options.radii) / 1.1);
      options.box.size = {side, side};
      table.refused("pack 1.1 times its area", attempt([&] { pack(options); }), {"times the area of the box", "Make"});
    }
  }
  for (const BodyKind kind : all_bodies) {
    GrainScene scene = scene_of(
        {}, closed_box(4, 4),
        {.stiffness = 1e4, .restitution = 0.3, .friction = 0.3, .tangential_ratio = 0.5, .tangential_damping = 0.3},
        {0, -1});
    double area = 0;
    for (int k = 0; k < 16; ++k) {
      add_body(scene, kind, {k % 4 + 0.5, std::floor(k / 4) + 0.5}, 0.49, 0.4 * k);
    }
    if (kind == BodyKind::disc) area = 16 * std::numbers::pi * 0.49 * 0.49;
    if (kind == BodyKind::ellipse) area = 8 * std::numbers::pi * 0.49 * 0.49;
    if (kind == BodyKind::bonded_pair) area = 8 * std::numbers::pi * 0.49 * 0.49;
    if (kind == BodyKind::clump) area = 16 * inertia_of_clump(scene.clumps[0], 1).mass;
    // the lid comes down until the bodies have 1.05 times the area of the box
    const double down = 4 - area / 1.05 / 4;
    scene.walls[3].move_y = {Schedule::Kind::ramp, -down, 0, 20};
    GrainSimulation simulation(scene, verlet(5e-4));
    Balance balance;
    const Answer pressed = attempt([&] { balance = keep(simulation, 80000); });
    // A clump has a disc of a quarter of the circle's radius, which the lid may pass: where bodies go is chaotic.
    if (kind == BodyKind::clump && !pressed.refusal.message.empty()) {
      table.refused("pressed to 1.05 times its area, " + name_of(kind), pressed, {"grain", "Use stiffer contacts"});
      continue;
    }
    REQUIRE(pressed.refusal.message.empty());
    const double lack = lack_of_balance(simulation, scene);
    double overlap = 0, off = 0, least = std::numeric_limits<double>::infinity();
    for (const GrainContact& c : simulation.contacts()) {
      overlap = std::max(overlap, c.overlap);
      off = std::max(off, std::abs(c.normal_force - 1e4 * c.overlap));
      least = std::min(least, c.normal_force);
    }
    const double floor = force_on_wall(simulation, 0);
    CAPTURE(name_of(kind), balance.energy, lack, off / floor, overlap, least, floor, simulation.energy().kinetic);
    CHECK(balance.energy < 1e-4);
    CHECK(lack < 1e-6);
    CHECK(off < 1e-6 * floor);
    CHECK(least > 0);
    CHECK(overlap > 0.02);
    table.note("pressed to 1.05 times its area, " + name_of(kind),
               "forces in balance and equal to stiffness times overlap, 1e-6; energy to 1e-4",
               fmt::format("balance {}, overlaps {}, energy {}; largest overlap {:.3f} of the circle's radius",
                           digits(lack), digits(off / floor), digits(balance.energy), overlap / 0.49));
    // and on
    GrainScene thrice = scene;
    thrice.walls[3].move_y.value = -(4 - area / 12);
    GrainSimulation further(thrice, verlet(5e-4));
    const Answer answer = attempt([&] { further.advance(40000); });
    const Bits before = bits_of(further);
    CHECK_THROWS_AS(further.advance(1), Error);
    CHECK(bits_of(further) == before);
    table.refused("pressed to three times its area, " + name_of(kind), answer, {"grain", "Use stiffer contacts"});
  }
}

TEST_CASE("bonds_that_break_all_at_once_leave_discs_that_collide") {
  HardCase table({.name = "every bond breaks at once",
                  .why =
                      "strengths are 0, or all bonds meet theirs in one step: lists of bonds and contacts change as a "
                      "whole, and discs that pressed each other go on as contacts"});
  struct Row {
    double strength, distance;
  };
  for (const Row& row : {Row{0, 1 + 1e-3}, Row{0, 1 - 1e-3}, Row{0.3, 1 + 1e-3}}) {
    std::vector<Grain> grains;
    for (int k = 0; k < 40; ++k) grains.push_back(ball({k * row.distance, 0}, 0.5));
    GrainScene scene = scene_of(grains, {}, {.stiffness = 1000, .restitution = 1});
    for (std::size_t k = 0; k + 1 < grains.size(); ++k)
      scene.bonds.push_back({.i = k,
                             .j = k + 1,
                             .normal_spring = 1000,
                             .tangential_spring = 500,
                             .bending_spring = 50,
                             .rest = BondRest{{1, 0}, 0, 0}});
    const std::vector<double> strengths(scene.bonds.size(), row.strength);
    scene.strengths = ContactStrengths{strengths, strengths, 0};
    GrainSimulation simulation(scene, verlet(1e-3));
    const double stored = simulation.energy().elastic_bond;
    const Balance balance = keep(simulation, 4000);
    const EnergyLedger ledger = simulation.energy();
    CAPTURE(row.strength, row.distance, ledger.lost_breaking, stored, balance.momentum);
    REQUIRE(simulation.breaks().size() == scene.bonds.size());
    CHECK(simulation.breaks().back().step == 0);
    CHECK(std::abs(ledger.error()) < 1e-3 * stored);
    CHECK(std::abs(ledger.lost_breaking - (row.distance > 1 ? stored : 0)) < 1e-9 * stored);  // contacts are as stiff
    CHECK(balance.momentum < 1e-12);
    table.note(fmt::format("40 discs, strength {}, {}", row.strength, row.distance > 1 ? "drawn" : "pressed"),
               "all break in step 0, energy below 1e-3",
               fmt::format("{} of {} broke, energy off by {}", simulation.breaks().size(), scene.bonds.size(),
                           digits(std::abs(ledger.error()) / stored)));
  }
}

TEST_CASE("bonds_past_their_step_limit_are_refused_with_the_limit") {
  HardCase table({.name = "bond stiffness past the step limit",
                  .why = "a step too long for a spring or a dashpot feeds the motion, in one pair among thousands"});
  struct Tie {
    const char* name;
    GrainBond bond;
    double limit;  // of a pair of discs of the masses 1, I = m r²/2: m_n = 1/2, m_s = 1/6
  };
  for (const Tie& tie : {Tie{"normal spring", {.j = 1, .normal_spring = 1e6}, 2 * std::sqrt(0.5 / 1e6)},
                         Tie{"tangential spring", {.j = 1, .tangential_spring = 1e6}, 2 * std::sqrt(1 / 6e6)}}) {
    GrainScene scene = scene_of({ball({0, 0}, 1, {1e-6, 2e-6}), ball({2, 0}, 1)}, {}, {.stiffness = 100});
    scene.bonds = {tie.bond};
    const double limit = bond_step_limit(scene, GrainOptions::BondStep::exact);
    CAPTURE(tie.name, limit, tie.limit);
    CHECK(limit == Approx(tie.limit).epsilon(1e-14));
    GrainOptions options = verlet(0.999 * limit);
    GrainSimulation below(scene, options);
    const double initial = below.energy().initial;
    double most = 0;
    for (int k = 0; k < 20000; ++k) {
      below.advance(1);
      most = std::max(most, below.energy().kinetic / initial);
    }
    CAPTURE(most);
    CHECK(most <= 1 + 1e-3);
    table.note(
        fmt::format("{}, step 0.999 of the limit, 2e4 steps", tie.name),
        "the limit that theory gives, to 1e-14; energy gained below 1e-3",
        fmt::format("limit off by {}, most energy {:.6f} of the first", digits(std::abs(limit / tie.limit - 1)), most));
    options.time_step = 1.001 * limit;
    table.refused(fmt::format("{}, step 1.001 of the limit", tie.name),
                  attempt([&] { GrainSimulation(scene, options); }),
                  {"1.001 times the limit of", "that the bonds impose", "Stay below it"});
  }
  // without dashpots in the limit: exact ones of any size, whatever the step
  GrainScene chain = chain_scene(NormalLaw::linear_dashpot, 9, {.normal_dashpot = 1e12, .tangential_dashpot = 1e12});
  GrainSimulation simulation(chain, verlet(0.01));
  const Balance balance = keep(simulation, 1000);
  CAPTURE(balance.momentum, balance.angular);
  const double left = simulation.energy().kinetic / simulation.energy().initial;
  CHECK(left < 1);
  CHECK(balance.momentum < 1e-13);
  table.note("exact dashpots, 1e9 times the limit of explicit ones", "no energy gained, momentum to 1e-13",
             fmt::format("energy left {:.3f}, momentum {}", left, digits(balance.momentum)));
}

TEST_CASE("a_box_shaken_at_100_g_keeps_its_grains_and_its_ledger") {
  HardCase table({.name = "a box shaken at 100 g",
                  .why = "bodies meet walls at many times the speeds they settled at, again and again: overlaps are "
                         "deep, and the walls put in thousands of times the energy that was there"});
  for (const BodyKind kind : all_bodies) {
    std::vector<double> errors;
    double put_in = 0;
    std::int64_t contacts = 0;
    for (const double step : {1e-4, 5e-5, 2.5e-5}) {
      GrainScene scene = scene_of(
          {}, closed_box(5, 5),
          {.stiffness = 1e6, .restitution = 0.5, .friction = 0.4, .tangential_ratio = 0.5, .tangential_damping = 0.1},
          {0, -9.80665});
      for (int k = 0; k < 12; ++k) add_body(scene, kind, {k % 4 + 0.6, std::floor(k / 4) + 0.6}, 0.49, 0.4 * k);
      shake(scene.walls, {1, 0}, harmonic_shaking(980.665, 5, 0, 10));
      GrainSimulation simulation(scene, verlet(step));
      const Balance balance = keep(simulation, static_cast<std::int64_t>(std::llround(2.5 / step)));
      const EnergyLedger ledger = simulation.energy();
      CAPTURE(name_of(kind), step, balance.energy, balance.contacts, ledger.work_of_walls, ledger.lost());
      for (const Grain& g : simulation.grains()) {  // the box is back where it was
        CAPTURE(g.position);
        CHECK(std::min({g.position.x, g.position.y, 5 - g.position.x, 5 - g.position.y}) > 0);
      }
      CHECK(ledger.lost_slip > 0);
      CHECK(balance.contacts > 200);
      errors.push_back(balance.energy);
      put_in = ledger.work_of_walls;
      contacts = balance.contacts;
    }
    CAPTURE(name_of(kind), errors, put_in);
    CHECK(errors[2] < 2e-3);
    CHECK(errors[0] < 2e-2);
    table.note("12 at 5 Hz, 10 cycles, friction 0.4, " + name_of(kind),
               "all stay inside; energy to 2e-3 of the work of the walls at the shortest step",
               fmt::format("energy {}, {}, {}; {} contacts", digits(errors[0]), digits(errors[1]), digits(errors[2]),
                           contacts));
  }
}

TEST_CASE("without_gravity_bodies_keep_their_momenta_and_rest_stays_rest") {
  HardCase table({.name = "zero gravity",
                  .why = "nothing brings bodies together or holds them, there is no weight to compare with, and errors "
                         "of free flight add up over all steps"});
  for (const BodyKind kind : all_bodies) {
    GrainScene scene =
        scene_of({}, {}, {.stiffness = 1e4, .restitution = 0.8, .friction = 0.4, .tangential_ratio = 0.5});
    Random random(9);
    for (int k = 0; k < 16; ++k) {
      const Vec2 place{2.0 * (k % 4) - 3, 2.0 * std::floor(k / 4) - 3};
      add_body(scene, kind, place, 0.9, random.uniform(-3, 3), -place);
    }
    for (Grain& g : scene.grains) g.velocity += Vec2{0.3, 0.2};
    const std::size_t far = scene.grains.size();
    add_body(scene, kind, {1000, 1000}, 0.9, 0.7);
    GrainSimulation simulation(scene, verlet(1e-4));
    const Balance balance = keep(simulation, 60000);
    CAPTURE(name_of(kind), balance.energy, balance.momentum, balance.angular, balance.contacts);
    CHECK(balance.contacts > 10);
    CHECK(balance.momentum < 1e-12);
    CHECK(balance.angular < 1e-12);
    CHECK(balance.energy < 2e-3);
    CHECK(simulation.energy().potential == 0);
    const std::vector<Grain> after = simulation.grains();
    bool same = true;
    for (std::size_t k = far; k < after.size(); ++k) {
      const Grain &a = after[k], &b = scene.grains[k];
      same = same && a.position == b.position && a.velocity == b.velocity && a.angle == b.angle && a.spin == b.spin;
    }
    CHECK(same);
    table.note("16 fly at each other, one rests far away, " + name_of(kind),
               "momenta to 1e-12, energy to 2e-3; what rests keeps its bits",
               fmt::format("momentum {}, angular {}, energy {}; {}", digits(balance.momentum), digits(balance.angular),
                           digits(balance.energy), same ? "the same bits" : "other bits"));
  }
  // a million steps of free flight
  GrainScene scene = scene_of({oval({0, 0}, 1, 0.5, 0.2, {0.3, -0.7})}, {}, {.stiffness = 1});
  scene.grains[0].spin = 0.1;
  GrainSimulation simulation(scene, verlet(1e-3));
  simulation.advance(1000000);
  const Grain out = simulation.grains()[0];
  const double off = norm(out.position - Vec2{300, -700}) / 761.6, turned = std::abs(out.angle - 100.2) / 100.2;
  CAPTURE(off, turned);
  CHECK(off < 1e-10);
  CHECK(turned < 1e-10);
  CHECK(out.velocity == scene.grains[0].velocity);
  CHECK(out.spin == scene.grains[0].spin);
  table.note("an ellipse flies 1e6 steps", "place and angle to 1e-10, velocities to the bit",
             fmt::format("place {}, angle {}", digits(off), digits(turned)));
  PackingOptions options;
  options.method = PackingMethod::falling;
  options.box = {{5, 0}, PackingBox::Sides::open_top};
  options.radii = {1};
  options.settling.springs = {1e7, 5e6};
  options.settling.gravity = 0;
  table.refused("pack by falling", attempt([&] { pack(options); }),
                {"gravity of the settling is 0", "Give a number > 0"});
}

TEST_CASE("one_grain_falls_rebounds_and_rests") {
  HardCase table({.name = "one grain",
                  .why = "no neighbours, no contacts, no scale but its own: lists, means and ratios are of nothing"});
  for (const BodyKind kind : all_bodies) {
    std::vector<double> errors;
    for (const double step : {1e-3, 5e-4, 2.5e-4}) {
      GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e4}, {0, -1});
      add_body(scene, kind, {0, 2}, 1, 0.4);
      GrainSimulation simulation(scene, verlet(step));
      const Balance balance = keep(simulation, static_cast<std::int64_t>(std::llround(10 / step)));
      CAPTURE(name_of(kind), step, balance.contacts);
      CHECK(balance.contacts > 1);
      errors.push_back(balance.energy);
    }
    CAPTURE(name_of(kind), errors);
    CHECK(errors[2] < 1e-3);
    CHECK(errors[2] < errors[0] / 2.5);
    table.note("bouncing for 10 s, e = 1, " + name_of(kind), "energy to 1e-3, falling with the step",
               fmt::format("{}, {}, {}", digits(errors[0]), digits(errors[1]), digits(errors[2])));

    GrainScene scene = scene_of({}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e4, .restitution = 0.1}, {0, -1});
    add_body(scene, kind, {0, 1}, 1, kind == BodyKind::clump ? -2.356 : 0);
    scene.pairs[0].friction = 0.5;
    scene.pairs[0].tangential_ratio = 0.5;
    scene.pairs[0].tangential_damping = 0.5;
    GrainSimulation simulation(scene, verlet(5e-4));
    simulation.advance(200000);
    const double mass = kind == BodyKind::bonded_pair ? 2 : 1;
    double carried = 0, pressed = 0;
    for (const GrainContact& c : simulation.contacts()) {
      carried += c.normal_force;
      pressed += 1e4 * c.overlap;
    }
    const double lack = std::max(std::abs(carried / mass - 1), std::abs(pressed / mass - 1));
    CAPTURE(name_of(kind), lack, simulation.energy().kinetic, simulation.contacts().size());
    CHECK(lack < 1e-9);
    table.note("at rest on the floor, " + name_of(kind), "force and stiffness times overlap are the weight to 1e-9",
               digits(lack));
  }
  for (const auto& entry : EnumNames<PackingMethod>::list) {
    PackingOptions options;
    options.method = entry.value;
    const bool falls = entry.value == PackingMethod::falling;
    options.box = {{5, falls ? 0.0 : 5}, falls ? PackingBox::Sides::open_top : PackingBox::Sides::walls};
    options.radii = {1};
    options.settling.springs = {1e7, 5e6};
    const GrainPacking packing = pack(options);
    REQUIRE(packing.size() == 1);
    const Rectangle all{{-1, -1}, {6, 6}};  // a bit of what fell is in the floor
    const double off = std::abs(measure(packing, all).solid_fraction * all.area() / std::numbers::pi - 1);
    CAPTURE(entry.name, off, packing.settling.unbalanced);
    CHECK(off < 1e-12);
    CHECK(packing.settling.unbalanced <= 1e-6);
    table.note(std::string("pack by ") + entry.name, "it is there, its area to 1e-12", digits(off));
  }
}

TEST_CASE("with_a_friction_of_ten_bodies_roll_where_they_would_slide") {
  HardCase table({.name = "friction 10",
                  .why =
                      "no contact slides up to 84 degrees: the tangential spring carries ten times the normal force, "
                      "and any jump of the friction limit would be seen"});
  for (const double degrees : {20.0, 60.0, 80.0}) {
    const double slope = degrees * std::numbers::pi / 180, g = 9.8;
    const Vec2 down{std::cos(slope), -std::sin(slope)}, normal{std::sin(slope), std::cos(slope)};
    GrainScene scene = scene_of({}, {line("slope", {0, 0}, normal)}, {.stiffness = 1e5, .restitution = 0.1}, {0, -g});
    const double sunk = g * std::cos(slope) / 1e5;
    add_body(scene, BodyKind::disc, (1 - sunk) * normal, 1);
    scene.pairs[0].friction = 10;
    scene.pairs[0].tangential_ratio = 0.5;
    scene.pairs[0].tangential_damping = 0.5;
    GrainSimulation simulation(scene, verlet(1e-4));
    const double inertia = scene.grains[0].inertia.moment / scene.grains[0].inertia.mass;
    const auto speed_after = [&](std::int64_t steps) {
      simulation.advance(steps);
      return dot(simulation.grains()[0].velocity, down);
    };
    const double first = speed_after(10000), second = speed_after(10000);
    const double expected = g * std::sin(slope) / (1 + inertia);  // rolling: a = g sin/(1 + I/(m r²)), r = 1
    const double off = std::abs(second - first - expected) / expected;
    CAPTURE(degrees, first, second, expected, off);
    CHECK(off < 1e-3);
    table.note(fmt::format("a disc on a slope of {:.0f} degrees, 20000 steps", degrees),
               "rolls, with the acceleration of rolling to 1e-3", digits(off));
  }
}
