// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Scenes of options, of files and by hand: contacts, kinds and time steps, and what cannot be simulated, which is
/// refused before the first step, naming the number and its bound.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/grain_file.hpp"
#include "equidem/grains/scene/pair_options.hpp"

#include "grains/scenes.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

struct Spoiled {
  std::string says;
  std::function<void(GrainScene&, GrainOptions&)> spoil;
};

std::vector<Spoiled> all_spoiled() {
  using S = GrainScene;
  using O = GrainOptions;
  return {
      {"the scene has no grains", [](S& s, O&) { s.grains.clear(); }},
      {"the radius of grain 1 is 0 m", [](S& s, O&) { s.grains[1].radius = 0; }},
      {"the radius of grain 1 is nan m", [](S& s, O&) { s.grains[1].radius = no_number; }},
      {"the mass of grain 0 is -1", [](S& s, O&) { s.grains[0].inertia.mass = -1; }},
      {"the moment of inertia of grain 0 is 0", [](S& s, O&) { s.grains[0].inertia.moment = 0; }},
      {"grain 0 has a position, a velocity or a spin", [](S& s, O&) { s.grains[0].velocity.y = no_number; }},
      {"grain 0 has a position, a velocity or a spin", [](S& s, O&) { s.grains[0].position.x = 1 / 0.0; }},
      {"grain 1 is of the kind 1", [](S& s, O&) { s.grains[1].kind = 1; }},
      {"wall \"floor\" is of the kind -1", [](S& s, O&) { s.walls[0].kind = -1; }},
      {"1 pairs are given for 2 kinds", [](S& s, O&) { s.kinds = 2; }},
      {"kinds 0 and 1 meet by other rules than 1 and 0",
       [](S& s, O&) {
         s.kinds = 2;
         s.pairs.resize(4, s.pairs[0]);
         s.pairs[1].friction = 0.1;
       }},
      {"a contact has no stiffness", [](S& s, O&) { s.pairs[0].stiffness = 0; }},
      {"a contact has a stiffness and a dimensionless stiffness", [](S& s, O&) { s.pairs[0].dimensionless = 0.1; }},
      {"the stiffness of a contact is -1", [](S& s, O&) { s.pairs[0].stiffness = -1; }},
      {"the stiffness of a contact is nan", [](S& s, O&) { s.pairs[0].stiffness = no_number; }},
      {"coefficient of restitution is 1.1", [](S& s, O&) { s.pairs[0].restitution = 1.1; }},
      {"coefficient of restitution is 0", [](S& s, O&) { s.pairs[0].restitution = 0; }},
      {"restitution is 2",
       [](S& s, O& o) {
         s.pairs[0].restitution = 2;
         o.law = NormalLaw::energy_map;
       }},
      {"its first step has an answer only where",
       [](S& s, O& o) {
         s.pairs[0].restitution = 0.1;
         o.law = NormalLaw::five_case_map;
       }},
      {"the friction of a contact is -0.1", [](S& s, O&) { s.pairs[0].friction = -0.1; }},
      {"tangential damping is given without", [](S& s, O&) { s.pairs[0].tangential_damping = 0.1; }},
      {"velocity_verlet is asked for with the law \"exact_flow\"",
       [](S&, O& o) { o.integrator = GrainIntegrator::velocity_verlet; }},
      {"velocity_verlet is asked for with the law \"energy_map\"",
       [](S&, O& o) {
         o.integrator = GrainIntegrator::velocity_verlet;
         o.law = NormalLaw::energy_map;
       }},
      {"the time step is 0 s", [](S&, O& o) { o.time_step = 0; }},
      {"the time step is -1 s", [](S&, O& o) { o.time_step = -1; }},
      {"the reference length is -1 m", [](S&, O& o) { o.reference_length = -1; }},
      {"the margin", [](S&, O& o) { o.margin = no_number; }},
      {"gravity is not a number", [](S& s, O&) { s.gravity.x = no_number; }},
      {"grains 0 and 1 start inside one another",
       [](S& s, O&) {
         s.grains[1].position = {0.5, 2};
       }},
      {"grain 1 starts behind wall \"floor\"",
       [](S& s, O&) {
         s.grains[1].position = {5, -0.1};
       }},
      {"wall 'floor' has the normal (0, 2)",
       [](S& s, O&) {
         s.walls[0].normal = {0, 2};
       }},
  };
}

}  // namespace

TEST_CASE("scenes_that_cannot_be_stepped_are_refused") {
  const GrainScene good =
      scene_of({ball({0, 2}, 1), ball({5, 2}, 1)}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e3}, {0, -1});
  const GrainOptions options = options_of(NormalLaw::exact_flow, 0.1);
  CHECK_NOTHROW(GrainSimulation(good, options));
  for (const Spoiled& spoiled : all_spoiled()) {
    GrainScene scene = good;
    GrainOptions other = options;
    spoiled.spoil(scene, other);
    CAPTURE(spoiled.says);
    CHECK_FALSE(check_refused([&] { GrainSimulation(scene, other); }, {spoiled.says}).remedy.empty());
  }
}

TEST_CASE("effects_of_a_scene_are_listed_with_their_reasons") {
  GrainScene scene = scene_of({ball({0, 2}, 1)}, {line("floor", {0, 0}, {0, 1})}, {.stiffness = 1e3});
  const auto active = [&](const std::string& name) {
    const GrainSimulation simulation(scene, options_of(NormalLaw::exact_flow, 0.1));
    for (const Effects::Entry& entry : simulation.effects().entries) {
      CHECK_FALSE(entry.why.empty());
      if (entry.name == name) return entry.active;
    }
    FAIL("no such effect: " << name);
    return false;
  };
  CHECK_FALSE(active("friction"));
  CHECK_FALSE(active("rotation"));
  CHECK_FALSE(active("gravity"));
  CHECK_FALSE(active("loss at impacts"));
  CHECK_FALSE(active("motion of walls"));
  CHECK(active("walls"));
  CHECK(active("normal contact by exact_flow"));
  scene.pairs[0].friction = 0.1;
  scene.pairs[0].restitution = 0.5;
  scene.gravity = {0, -1};
  scene.walls[0].move_x = {Schedule::Kind::sine, 1, 0, 0, 1};
  CHECK(active("friction"));
  CHECK(active("rotation"));
  CHECK(active("gravity"));
  CHECK(active("loss at impacts"));
  CHECK(active("motion of walls"));
  CHECK_FALSE(active("tangential springs"));
  scene.pairs[0].tangential_ratio = 0.5;
  CHECK(active("tangential springs"));
}

namespace {

GrainScene two(const Grain& a, const Grain& b) {
  return scene_of({a, b}, {}, {.stiffness = 100});
}

std::string refusal(const GrainScene& scene, NormalLaw law = NormalLaw::linear_dashpot) {
  const auto place = [](std::size_t grain) { return "grain " + std::to_string(grain); };
  const Refusal refused = refusal_of([&] { check(scene, options_of(law, 0.01), place); });
  CHECK(refused.kind == ErrorKind::bad_input);
  return refused.message;
}

}  // namespace

TEST_CASE("scenes_of_shapes_that_cannot_be_stepped_are_refused") {
  using Catch::Contains;
  const Grain fine = oval({9, 9}, 1, 0.5);
  CHECK(refusal(two(fine, oval({0, 0}, 1, 0.5))).empty());
  CHECK_THAT(refusal(two(fine, oval({0, 0}, 1, 1.5))), Contains("short half-axis 1.5") && Contains("grain 1"));
  CHECK_THAT(refusal(two(fine, oval({0, 0}, 1, -0.5))), Contains("short half-axis -0.5"));
  Grain unknown = fine;
  unknown.short_half_axis = std::nan("");
  CHECK_THAT(refusal(two(ball({0, 0}, 1), unknown)), Contains("short half-axis nan"));
  // concentric, nested, centre in the other
  CHECK_THAT(refusal(two(fine, fine)), Contains("start inside one another"));
  CHECK_THAT(refusal(two(oval({0, 0}, 2, 1), oval({0.5, 0}, 0.5, 0.1))), Contains("start inside one another"));
  CHECK_THAT(refusal(two(oval({0, 0}, 2, 1), oval({0, 1.1}, 2, 1, 1.5))), Contains("start inside one another"));
  // needles: one runs through the other, far from the centres of both; its tip presses on the other's side
  CHECK_THAT(refusal(two(oval({0, 0}, 2, 0.1), oval({1.2, 1.4}, 2, 0.1, 1.5))), Contains("start inside one another"));
  CHECK(refusal(two(oval({0, 0}, 2, 0.1), oval({1.2, 2.06}, 2, 0.1, 1.5))).empty());
  // side by side, nearer than half an axis, they are not
  CHECK(refusal(two(oval({0, 0}, 2, 0.1), oval({0, 0.25}, 2, 0.1))).empty());
  for (const NormalLaw law : exact_laws) {
    CHECK_THAT(refusal(two(fine, oval({0, 0}, 1, 0.5)), law), Contains("Use linear_dashpot or hertz_dashpot"));
  }
  CHECK_THAT(refusal(two(fine, ball({0, 0}, 1, {}, 1, 0.4))), Contains("is a sphere"));

  GrainScene scene = scene_of({}, {}, {.stiffness = 100});
  scene.grains = {lump(scene, pair_of_discs(), {0, 0})};
  CHECK(refusal(scene).empty());
  const auto changed = [&](auto change) {
    GrainScene other = scene;
    change(other);
    return refusal(other);
  };
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].clump = 3; }), Contains("is clump 3") && Contains("has 1"));
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].clump = -2; }), Contains("is clump -2"));
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].short_half_axis = 1; }), Contains("is an ellipse and clump 0"));
  CHECK_THAT(changed([](GrainScene& s) { s.grains[0].radius = 1.9; }), Contains("reaches 2 m"));
  CHECK_THAT(changed([](GrainScene& s) { s.clumps[0].discs[0].offset.x = -0.9; }), Contains("centre of mass at (0.05"));
  CHECK_THAT(changed([](GrainScene& s) { s.clumps[0].discs[0].radius = 0; }), Contains("disc of the radius 0"));
  CHECK_THAT(changed([](GrainScene& s) { s.clumps[0].discs.clear(); }), Contains("has no discs"));
  CHECK_THAT(changed([](GrainScene& s) { s.walls = {line("floor", {0, -0.5}, {1, 0})}; }), Contains("behind wall"));
}

TEST_CASE("an_interlocked_clump_may_start_in_the_hollow_of_another") {
  // centres of mass in one place, no disc in another
  GrainScene scene = scene_of({}, {}, {.stiffness = 100});
  std::vector<Clump::Disc> ring;
  for (int k = 0; k < 12; ++k)
    ring.push_back({{3 * std::cos(k * std::numbers::pi / 6), 3 * std::sin(k * std::numbers::pi / 6)}, 0.8});
  scene.grains = {lump(scene, ring, {0, 0}), lump(scene, pair_of_discs(), {0, 0}, 0.3, {1, 0.2})};
  GrainSimulation simulation(scene, options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 0.002));
  simulation.advance(10000);
  const std::vector<Grain> grains = simulation.grains();
  CAPTURE(simulation.counters().contacts, simulation.energy().error());
  CHECK(simulation.counters().contacts > 5);
  CHECK(norm(grains[1].position - grains[0].position) < 1.3);
  CHECK(std::abs(simulation.energy().error()) < 5e-4 * simulation.energy().initial);
}

TEST_CASE("effects_of_shapes_are_listed") {
  const GrainSimulation simulation(two(oval({0, 0}, 1, 0.5), oval({3, 0}, 1, 0.5)),
                                   options_of(NormalLaw::linear_dashpot, 0.01));
  bool found = false;
  for (const Effects::Entry& entry : simulation.effects().entries) {
    if (entry.name == "rotation") CHECK(entry.why == "normal forces turn ellipses and clumps");
    if (entry.name == "clumps") CHECK_FALSE(entry.active);
    found = found || (entry.name == "ellipses" && entry.active);
  }
  CHECK(found);
  CHECK(simulation.effects().rotation);
}

TEST_CASE("ellipses_that_would_pass_unseen_are_refused") {
  // a fast needle, a needle that turns fast, a clump shot through another
  GrainScene fast = two(oval({0, 0}, 1, 0.05, 1.5), oval({-0.3, 0.1}, 1, 0.05, 1.5, {60, 0}));
  GrainScene turning = two(oval({0, 0}, 1, 0.05), oval({1.1, 0.5}, 1, 0.05, 0.2));
  turning.grains[1].spin = 90;
  GrainScene clumps = scene_of({}, {}, {.stiffness = 100});
  clumps.grains = {lump(clumps, pair_of_discs(), {0, 0}, 1.5), lump(clumps, pair_of_discs(), {-2.1, 0}, 1.5, {500, 0})};
  for (const GrainScene& scene : {fast, turning, clumps}) {
    GrainSimulation simulation(scene, options_of(NormalLaw::linear_dashpot, 0.01));
    const Bits before = bits_of(simulation);
    CHECK_THROWS_WITH(simulation.advance(1), Catch::Contains("pass through") && Catch::Contains("step 0"));
    CHECK(bits_of(simulation) == before);
    GrainOptions options = options_of(NormalLaw::linear_dashpot, 0.01);
    options.refuse_crossing = false;
    GrainSimulation free(scene, options);
    CHECK_NOTHROW(free.advance(5));
  }
}

TEST_CASE("needles_that_slide_past_one_another_are_not_refused") {
  // nearer than half the sum of their long half-axes, and changing sides
  GrainSimulation simulation(two(oval({-1.5, 0}, 1, 0.05, 0, {5, 0}), oval({1.5, 0.11}, 1, 0.05, 0, {-5, 0})),
                             options_of(NormalLaw::linear_dashpot, 0.01));
  CHECK_NOTHROW(simulation.advance(60));
  CHECK(simulation.counters().contacts == 0);
}

namespace {

constexpr double density = 2500;

Grain dense_sphere(Vec2 position, double radius, Vec2 velocity = {}) {
  return {.position = position,
          .radius = radius,
          .inertia = inertia_of(radius, density, Body::sphere),
          .velocity = velocity};
}

/// Two balls that fly at each other, and one above a floor.
GrainScene three_balls() {
  GrainScene scene;
  scene.grains = {dense_sphere({0, 1}, 0.01, {1, 0}), dense_sphere({0.0301, 1}, 0.02, {-1, 0}),
                  dense_sphere({1, 0.5}, 0.03)};
  Wall floor;
  floor.name = "floor";
  floor.normal = {0, 1};
  scene.walls = {floor};
  return scene;
}

PairOptions contact(StiffnessOptions stiffness, double restitution = 0.8) {
  return {.stiffness = stiffness, .rebound = Restitution{restitution}};
}

std::string option_at_fault(const CollisionOptions& options, NormalLaw law = NormalLaw::linear_dashpot) {
  GrainScene scene = three_balls();
  const Refusal refusal = refusal_of([&] { set_kinds(scene, {}, options, law); });
  return refusal.message.empty() ? "none" : refusal.where;
}

}  // namespace

TEST_CASE("bodies_from_options_rebound_as_asked") {
  const StiffnessOptions stiffness =
      GENERATE(StiffnessOptions{SpringStiffness{1e5}}, StiffnessOptions{ContactDuration{1e-4}},
               StiffnessOptions{LargestOverlap{1e-4}});
  const NormalLaw law = GENERATE(NormalLaw::linear_dashpot, NormalLaw::exact_flow, NormalLaw::energy_map);
  const double e = 0.8;
  GrainScene scene = three_balls();
  CollisionOptions collisions{.body = Body::sphere, .bodies = contact(stiffness, e)};
  collisions.bodies.closing_speed = 2;
  const ContactTable contacts = set_kinds(scene, {}, collisions, law);
  CHECK(contacts.kinds == std::vector<std::string>{"grains", "walls"});
  GrainOptions options{.law = law};
  const GrainTimeStep step = choose_time_step(scene, contacts, options, {.steps_per_contact = 200});
  options.time_step = step.step;
  scene.pairs = pairs_at(contacts, law, step.step);
  GrainSimulation simulation(scene, options);
  simulation.advance(count_steps(0.01, step.step));
  const auto grains = simulation.grains();
  CAPTURE(to_string(law), stiffness.index(), step.step, step.contact, step.between);
  CHECK(grains[1].velocity.x - grains[0].velocity.x == Approx(2 * e).epsilon(0.01));
}

TEST_CASE("a_contact_lasts_as_long_as_its_options_say") {
  for (const double e : {1.0, 0.8, 0.3}) {
    const PairContact made = contact_of(contact(ContactDuration{2e-4}, e), NormalLaw::linear_dashpot, {});
    for (const double step : {1e-5, 3e-6}) {
      const PairProperties pair = properties_at(made, NormalLaw::linear_dashpot, step);
      const double zeta = damping_ratio(NormalLaw::linear_dashpot, pair);
      CAPTURE(e, step, zeta, pair.dimensionless);
      // the half period of the damped oscillator
      CHECK(std::numbers::pi * step / std::sqrt(pair.dimensionless * (1 - zeta * zeta)) == Approx(2e-4));
    }
  }
}

TEST_CASE("errors_of_contacts_name_the_option_at_fault") {
  const PairOptions good = contact(SpringStiffness{1e5});
  CHECK(option_at_fault({.bodies = good}) == "none");
  CHECK(option_at_fault({}) == "restitution");
  CHECK(option_at_fault({.bodies = {.rebound = Restitution{0.5}}}) == "stiffness");
  CHECK(option_at_fault({.bodies = good, .walls = contact(LargestOverlap{1e-4})}) == "walls.largest_overlap");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"grains", "flor", good}}}) == "pairs.0.with");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"floor", "grains", good}}}) == "pairs.0.group");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"grains", "floor", good}, {"grains", "floor", good}}}) ==
        "pairs.1");
  CHECK(option_at_fault({.bodies = good, .pairs = {{"grains", "floor", contact(SpringStiffness{1e5}, 0)}}}) ==
        "pairs.0.restitution");
  CHECK(option_at_fault({.bodies = contact(ContactDuration{1e-4})}, NormalLaw::hertz_dashpot) == "contact_duration");
  CHECK(option_at_fault({.bodies = contact(HertzModuli{1e9, 0.3})}, NormalLaw::hertz_dashpot) == "young_modulus");
  CHECK(option_at_fault({.body = Body::sphere, .bodies = contact(WaveSpeedStiffness{density, 150, 0.25})}) ==
        "shear_wave_speed");
  CHECK(option_at_fault({.bodies = contact(WaveSpeedStiffness{density, 150, 0.5})}) == "poisson_ratio");
  PairOptions damped = good;
  damped.rebound = DashpotDamping{0.3};
  CHECK(option_at_fault({.bodies = damped}) == "none");
  CHECK(option_at_fault({.bodies = damped}, NormalLaw::energy_map) == "damping");
}

TEST_CASE("a_step_that_cannot_be_chosen_is_asked_for") {
  const auto place_of_error = [](StiffnessOptions stiffness, NormalLaw law, const GrainStepOptions& wanted = {}) {
    GrainScene scene = three_balls();
    const ContactTable contacts = set_kinds(scene, {}, {.body = Body::sphere, .bodies = contact(stiffness)}, law);
    const Refusal refusal = refusal_of([&] { choose_time_step(scene, contacts, {.law = law}, wanted); });
    return refusal.message.empty() ? "none" : refusal.where;
  };
  CHECK(place_of_error(SpringStiffness{1e5}, NormalLaw::linear_dashpot) == "none");
  CHECK(place_of_error(SpringStiffness{1e5}, NormalLaw::linear_dashpot, {.time_step = 1}) == "time_step");
  CHECK(place_of_error(SpringStiffness{1e5}, NormalLaw::hertz_dashpot) == "time_step");
  CHECK(place_of_error(DimensionlessStiffness{0.1}, NormalLaw::energy_map) == "time_step");
  CHECK_THROWS_AS(count_steps(1, 1e-20), Error);
}

TEST_CASE("reduced_masses_span_all_pairs_of_two_kinds") {
  std::vector<Grain> grains;
  const std::vector<double> masses{5, 2, 7, 3, 11};
  const std::vector<int> kinds{0, 0, 1, 0, 1};
  for (std::size_t g = 0; g < masses.size(); ++g) {
    Grain grain;
    grain.inertia.mass = masses[g];
    grain.kind = kinds[g];
    grains.push_back(grain);
  }
  const auto of_kinds = masses_of_kinds(grains, 3);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      double smallest = INFINITY, largest = 0;
      for (std::size_t i = 0; i < masses.size(); ++i) {
        if (kinds[i] == a && b == 2) smallest = std::min(smallest, masses[i]), largest = std::max(largest, masses[i]);
        if (kinds[i] == b && a == 2) smallest = std::min(smallest, masses[i]), largest = std::max(largest, masses[i]);
        for (std::size_t j = 0; j < masses.size(); ++j) {
          if (i == j || kinds[i] != a || kinds[j] != b) continue;
          const double reduced = masses[i] * masses[j] / (masses[i] + masses[j]);
          smallest = std::min(smallest, reduced), largest = std::max(largest, reduced);
        }
      }
      CAPTURE(a, b);
      const auto found = reduced_masses(of_kinds, a, b);
      REQUIRE(found.has_value() == (largest > 0));
      if (!found) continue;
      CHECK(found->smallest == Approx(smallest));
      CHECK(found->largest == Approx(largest));
    }
  }
}

namespace {

/// A file that is removed at the end.
class WrittenFile {
 public:
  WrittenFile(const std::string& name, const std::string& text)
      : path(std::filesystem::temp_directory_path() / ("equidem_body_files_" + name)) {
    write_file(path, text, true);
  }
  ~WrittenFile() { std::filesystem::remove(path); }
  WrittenFile(const WrittenFile&) = delete;
  WrittenFile& operator=(const WrittenFile&) = delete;

  const std::filesystem::path path;
};

}  // namespace

TEST_CASE("rows_of_a_file_become_bodies_without_a_case_file") {
  GrainShapes shapes(Body::disc);
  const WrittenFile file("grains.csv",
                         "# a comment\ngroup,y_m,x,radius,short_half_axis,discs,density\n"
                         ",2,1,0.5,,,1000\nsteel,0,0,0.5,0.25,,7800\nrods,0,5,,,0 0 0.1; 0.2 0 0.1,1000\n");
  const GrainRows rows = read_grains(file.path, {}, shapes);
  REQUIRE(rows.grains.size() == 3);
  CHECK(rows.groups == std::vector<std::string>{"grains", "steel", "rods"});
  CHECK(rows.lines == std::vector<int>{3, 4, 5});
  CHECK(rows.densities == std::vector<double>{1000, 7800, 1000});
  CHECK(rows.grains[0].position == Vec2{1, 2});
  CHECK(rows.grains[0].inertia.mass == Approx(1000 * std::numbers::pi * 0.25));
  CHECK(rows.grains[1].inertia.mass == Approx(7800 * std::numbers::pi * 0.5 * 0.25));
  CHECK(rows.grains[2].shape() == GrainShape::clump);
  CHECK(rows.grains[2].radius == Approx(0.2));
  REQUIRE(shapes.clumps().size() == 1);
  const WrittenFile plain("plain.csv", "x,y,radius\n0,0,1\n");
  CHECK(read_grains(plain.path, 1000, shapes).densities == std::vector<double>{1000});
  const WrittenFile quoted("quoted.csv",
                           "\"x_mm\";\"y_mm\";\"radius_mm\";\"discs_mm\"\n0;0,5;2;\n9;0;;\"0 0 2; 3 0 2\"\n");
  const GrainRows in_mm = read_grains(quoted.path, 1000, shapes);
  CHECK(in_mm.grains[0].position == Vec2{0, 0.5e-3});
  CHECK(in_mm.grains[0].radius == 2e-3);
  CHECK(in_mm.grains[1].radius == Approx(3.5e-3));
  const WrittenFile mixed("mixed.csv", "x_mm,y_mm,radius\n0,0,1\n");
  CHECK_THROWS_WITH(read_grains(mixed.path, 1000, shapes),
                    Catch::Contains("mixed.csv:1") && Catch::Contains("'radius'"));
  CHECK_THROWS_WITH(read_grains(plain.path, {}, shapes), Catch::Contains("plain.csv:2: the density"));
}

TEST_CASE("rows_of_a_file_become_bonds_without_a_case_file") {
  const GrainBond common{.normal_dashpot = 3, .rolling_dashpot = 4};
  const WrittenFile file("bonds.csv", "i,j,normal_dashpot,force_N\n0,1,7,9\n1,2,,9\n");
  const BondRows rows = read_bonds(file.path, common);
  REQUIRE(rows.bonds.size() == 2);
  CHECK(rows.bonds[0].normal_dashpot == 7);
  CHECK(rows.bonds[1].normal_dashpot == 3);
  CHECK(rows.bonds[1].rolling_dashpot == 4);
  CHECK((rows.bonds[1].i == 1 && rows.bonds[1].j == 2));
  CHECK(rows.places[1] == file.path.string() + ":3");
  for (const char* wrong :
       {"i,j,tensoin\n0,1,5\n", "i,j,tension_MPa\n0,1,5\n", "i,j\n-1,0\n", "i,j\n0,1.5\n", "i,j\n0,nan\n",
        "i,j\n0,99999999999999999999\n", "i,j\n0\n", "i,j,shear\n0,1,-3\n", "i,j,shear\n0,1,inf\n"}) {
    CAPTURE(wrong);
    const WrittenFile bad("bad.csv", wrong);
    CHECK_THROWS_AS(read_bonds(bad.path, common), Error);
  }
}
