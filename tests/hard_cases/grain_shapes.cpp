// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies whose shape or size is hard: needles, exact symmetry, one in the other, radii 1:100.
#include <algorithm>
#include <cmath>
#include <vector>

#include "hard_cases/bodies.hpp"
#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const HardCase::Words needles{.name = "needles of aspect 20",
                              .why =
                                  "the radius of curvature of a tip is 1/8000 of that of a side, and a contact runs "
                                  "from one to the other in a small turn"};

/// Sixteen needles of the half-axes 1 and 1/20 that fly at each other and turn, e = 1, no walls.
GrainScene flying_needles() {
  Random random(20);
  GrainScene scene = scene_of({}, {}, {.stiffness = 1e5});  // overlaps below the radius of a tip, 1/400
  for (int k = 0; k < 16; ++k) {
    const Vec2 place{2.1 * (k % 4 - 1.5), 2.1 * (k / 4 - 1.5)};
    scene.grains.push_back(oval(place, 1, 0.05, random.uniform(-3, 3), -0.3 * place));
    scene.grains.back().spin = random.uniform(-1, 1);
  }
  return scene;
}

/// Equal ellipses, flat on one another from the floor up, each contact with the overlap that carries what lies above;
/// `angle` turns the whole scene, gravity 1.
GrainScene flat_column(int n, double stiffness, double angle) {
  const Vec2 up{-std::sin(angle), std::cos(angle)};
  GrainScene scene = scene_of({}, {line("floor", {0, 0}, up)}, {.stiffness = stiffness, .restitution = 0.5}, -up);
  double height = 0;
  for (int k = 0; k < n; ++k) {
    height += (k == 0 ? 0.05 : 0.1) - (n - k) / stiffness;
    scene.grains.push_back(oval(height * up, 1, 0.05, angle));
  }
  return scene;
}

}  // namespace

TEST_CASE("needles_keep_momentum_and_energy") {
  HardCase table(needles);
  std::vector<double> errors;
  Balance balance;
  for (const double step : {2e-4, 1e-4, 5e-5}) {  // w dt = 0.2, 0.1, 0.05 of tips, whose mass is 1/5
    GrainSimulation simulation(flying_needles(), verlet(step));
    balance = keep(simulation, static_cast<std::int64_t>(std::llround(2 / step)));
    errors.push_back(balance.energy);
    CAPTURE(step, balance.energy, balance.momentum, balance.angular, balance.contacts);
    CHECK(balance.contacts > 10);
    CHECK(balance.momentum < 1e-13);
    CHECK(balance.angular < 1e-12);
  }
  CAPTURE(errors);
  CHECK(errors[2] < 1e-3);
  CHECK(errors[2] < errors[0] / 8);
  table.note("16 that fly at each other, e = 1, w dt = 0.2, 0.1, 0.05",
             "momentum 1e-13, angular momentum 1e-12, energy 1e-3 at the last and of the second order",
             fmt::format("momentum {}, angular {}, energy {}, {}, {}", digits(balance.momentum),
                         digits(balance.angular), digits(errors[0]), digits(errors[1]), digits(errors[2])));
}

TEST_CASE("a_needle_rests_on_two_pegs_by_its_tip_and_its_side") {
  HardCase table(needles);
  const auto peg = [](std::string name, double x) { return segment(std::move(name), {x, -1}, {x, 0.05}); };
  const double stiffness = 1e4;
  PairProperties pair{
      .stiffness = stiffness, .restitution = 0.1, .friction = 0.5, .tangential_ratio = 0.5, .tangential_damping = 0.5};
  double lack = 0, off = 0;
  for (const double x : {-0.1, -0.5, -0.98}) {
    const GrainScene scene = scene_of({oval({0, 0.12}, 1, 0.05)}, {peg("left", x), peg("right", 0.6)}, pair, {0, -1});
    GrainSimulation simulation(scene, verlet(1e-3));
    simulation.advance(100000);
    const std::vector<GrainContact> contacts = simulation.contacts();
    CAPTURE(x, contacts.size(), simulation.energy().kinetic, simulation.grains()[0].angle);
    REQUIRE(contacts.size() == 2);
    double moment = 0;
    for (const GrainContact& c : contacts) {
      moment -= cross(c.arm_i, c.normal_force * c.normal + c.tangential_force * perpendicular(c.normal));
      off = std::max(off, std::abs(stiffness * c.overlap / c.normal_force - 1));
    }
    lack = std::max({lack, lack_of_balance(simulation, scene), std::abs(moment)});
    CAPTURE(lack, off, moment);
    CHECK(lack < 1e-9);
    CHECK(off < 1e-9);
  }
  table.note("at rest on two pegs, under a tip, a side, both", "forces and moments in balance to 1e-9, overlaps too",
             fmt::format("balance {}, overlaps {}", digits(lack), digits(off)));
}

TEST_CASE("equal_ellipses_in_line_stay_in_line") {
  HardCase table({.name = "equal ellipses exactly aligned",
                  .why = "all derivatives across the line vanish: the closest points are found at once or never, and "
                         "round-off alone decides to which side they give way"});
  double restitution = 0, turn = 0;
  for (const bool tips : {true, false}) {
    for (const double e : {0.5, 1.0}) {
      const double reach = tips ? 1 : 0.05;
      const Vec2 way = tips ? Vec2{1, 0} : Vec2{0, 1};
      PairProperties pair = one_second(NormalLaw::linear_dashpot, e, 0.5);
      pair.stiffness *= 1e6;  // overlaps below the radius of a tip, 1/400
      GrainSimulation simulation(
          scene_of({oval(-reach * way, 1, 0.05, 0, way), oval((reach + 1e-5) * way, 1, 0.05, 0, -way)}, {}, pair),
          verlet(1e-6));
      REQUIRE(pass_contact(simulation, 4000));
      const std::vector<Grain> out = simulation.grains();
      CAPTURE(tips, e, out[0].velocity, out[0].spin);
      restitution = std::max(restitution, std::abs(norm(out[0].velocity) - e));
      turn = std::max({turn, std::abs(out[0].spin), std::abs(cross(out[0].velocity, way))});
    }
  }
  CAPTURE(restitution, turn);
  CHECK(restitution < 2e-3);
  CHECK(turn == 0);
  table.note("impact, tip on tip and side on side, e = 0.5 and 1", "restitution to 2e-3, no spin at all",
             fmt::format("restitution {}, spin {}", digits(restitution), digits(turn)));

  for (const double angle : {0.0, 0.3}) {
    const GrainScene scene = flat_column(10, 1e4, angle);
    GrainSimulation simulation(scene, verlet(1e-3));
    simulation.advance(10000);
    double off = 0, lack = 0;
    for (const Grain& g : simulation.grains()) {
      off = std::max({off, std::abs(g.angle - angle), std::abs(cross(g.position, scene.gravity))});
    }
    const std::vector<GrainContact> contacts = simulation.contacts();
    REQUIRE(contacts.size() == 10);
    for (const GrainContact& c : contacts) {
      const double carried = c.j < 0 ? 10 : 10 - std::max(c.i, c.j);
      lack = std::max({lack, std::abs(c.normal_force / carried - 1), std::abs(1e4 * c.overlap / carried - 1)});
    }
    CAPTURE(angle, off, lack);
    CHECK(lack < 1e-9);
    CHECK(off < (angle == 0 ? 1e-300 : 1e-9));
    table.note(fmt::format("column of 10 flat on one another, at {} rad, 10 s", angle),
               angle == 0 ? "overlaps and forces to 1e-9 of what they carry, not a bit to the side"
                          : "the same, to the side 1e-9",
               fmt::format("overlaps {}, to the side {}", digits(lack), digits(off)));
  }
}

TEST_CASE("bodies_inside_one_another_are_refused") {
  HardCase table({.name = "bodies concentric or nested",
                  .why = "every way out is as good as another, and no contact force follows from the overlap"});
  const auto start = [](const GrainScene& scene) { return attempt([&] { GrainSimulation(scene, verlet(1e-3)); }); };
  const PairProperties pair{.stiffness = 100};
  for (const BodyKind kind : all_bodies) {
    GrainScene scene = scene_of({}, {}, pair);
    add_body(scene, kind, {0, 0}, 1, 0.2);
    CHECK(start(scene).refusal.message.empty());
    add_body(scene, kind, {0, 0}, 1, 0.2);
    table.refused("start concentric, " + name_of(kind), start(scene), {"start inside one another"});
  }
  const GrainScene nested = scene_of({oval({0, 0}, 2, 1), oval({1.2, 0}, 0.5, 0.1, 0.4)}, {}, pair);
  table.refused("start nested, ellipses", start(nested), {"start inside one another"});
  const GrainScene disc_in_ellipse = scene_of({oval({0, 0}, 2, 1), ball({0.9, 0.1}, 0.2)}, {}, pair);
  table.refused("start nested, a disc in an ellipse", start(disc_in_ellipse), {"start inside one another"});
  // a heavy one that springs cannot hold: it goes on as long as its centre is outside
  GrainScene pressed = scene_of({oval({0, 0}, 2, 1), oval({0, 1.3}, 0.5, 0.25, 0, {0, -3})}, {}, pair);
  for (Grain& g : pressed.grains) g.inertia.mass *= 100;
  GrainSimulation simulation(pressed, verlet(1e-3));
  const Answer answer = attempt([&] { simulation.advance(2000); });
  const Bits before = bits_of(simulation);
  CHECK_THROWS_AS(simulation.advance(1), Error);
  CHECK(bits_of(simulation) == before);
  const Vec2 place = simulation.grains()[1].position - simulation.grains()[0].position;
  CAPTURE(place);
  CHECK(place.y > 0.9);  // no centre has entered
  table.refused("run, an ellipse pressed into another; the state is that before", answer, {"pressed into", "Use"});
}

TEST_CASE("small_bodies_meet_one_a_hundred_times_as_large") {
  HardCase table({.name = "radii 1:100",
                  .why = "masses of 1 and 1e4; cells and margins of the neighbours fit one size only; small overlaps "
                         "are differences of large numbers"});
  for (const BodyKind kind : all_bodies) {
    GrainScene scene = scene_of({}, {}, {.stiffness = 1e4});
    add_body(scene, kind == BodyKind::bonded_pair ? BodyKind::disc : kind, {0, 0}, 100, 0.7);
    Inertia& heavy = scene.grains[0].inertia;
    heavy = {1e4 * heavy.mass, 1e4 * heavy.moment};
    for (int k = 0; k < 24; ++k) {
      const Vec2 way{std::cos(k * std::numbers::pi / 12), std::sin(k * std::numbers::pi / 12)};
      add_body(scene, kind, (110.0 + k % 3) * way, 1, 0.3 * k, -20 * way + 3 * perpendicular(way));
    }
    GrainSimulation simulation(scene, verlet(1e-4));
    const Balance balance = keep(simulation, 50000);
    CAPTURE(name_of(kind), balance.energy, balance.momentum, balance.angular, balance.contacts);
    CHECK(balance.contacts >= 6);
    CHECK(balance.momentum < 1e-13);
    CHECK(balance.angular < 1e-12);
    CHECK(balance.energy < 1e-4);
    table.note("24 thrown on one, " + name_of(kind), "energy to 1e-4, momentum to 1e-13, angular momentum to 1e-12",
               fmt::format("energy {}, momentum {}, angular {}", digits(balance.energy), digits(balance.momentum),
                           digits(balance.angular)));
  }
  // a small disc in the hollow of two large ones: normals all but level, each carries half the weight
  GrainScene hollow = scene_of({ball({100, 100}, 100, {}, 1e4), ball({300, 100}, 100, {}, 1e4),
                                ball({200, 100 + std::sqrt(101.0 * 101 - 1e4)}, 1, {}, 1)},
                               closed_box(400, 300), {.stiffness = 1e6, .restitution = 0.05}, {0, -1});
  GrainSimulation simulation(hollow, verlet(2e-4));
  simulation.advance(100000);
  const Grain small = simulation.grains()[2];
  double lack = lack_of_balance(simulation, hollow), off = 0;
  for (const GrainContact& c : simulation.contacts()) {
    if (c.j < 0) continue;
    if (std::max(c.i, c.j) != 2) continue;
    const Vec2 branch = small.position - simulation.grains()[static_cast<std::size_t>(std::min(c.i, c.j))].position;
    const double force = 0.5 * norm(branch) / branch.y;  // of the weight 1
    off = std::max(off, std::abs(1e6 * c.overlap / force - 1));
  }
  CAPTURE(lack, off, simulation.contacts().size());
  CHECK(simulation.contacts().size() >= 6);
  CHECK(lack < 1e-9);
  CHECK(off < 1e-6);
  table.note("a small disc in the hollow of two large ones",
             "forces in balance to 1e-9, overlaps those of them to 1e-6",
             fmt::format("balance {}, overlaps {}", digits(lack), digits(off)));
}
