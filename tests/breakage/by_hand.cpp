// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/avalanches.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/core/error.hpp"

#include "breakage/scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const ContactSprings pair_springs(SpringConstants{1000, 300});
const Support held{"first", 0, 0, 0};

/// Pairs of discs side by side, the lower held, the upper moved up: fibres that share no load but that of their ends.
Broken bundle(const std::vector<double>& strengths, LoadControl control = LoadControl::path,
              std::vector<double> legs = {}) {
  Assembly a;
  for (std::size_t k = 0; k < strengths.size(); ++k) {
    const double x = 3 * static_cast<double>(k);
    a.groups["low"].discs.push_back(static_cast<std::int32_t>(2 * k));
    a.groups["high"].discs.push_back(static_cast<std::int32_t>(2 * k + 1));
    a.centres.insert(a.centres.end(), {{x, 0}, {x, 2}});
    a.radii.insert(a.radii.end(), 2, 1.0);
    a.contacts.push_back({static_cast<std::int32_t>(2 * k), static_cast<std::int32_t>(2 * k + 1), 0, 0, 1, 1});
  }
  ContactStrengths s = equal_strengths(a, 0, 1e9);
  s.tension = strengths;
  LoadPathOptions options;
  options.supports = {{"low", 0, 0, 0}, {"high", 0, 1e-3, 0}};
  options.control = control;
  options.legs = std::move(legs);
  return {a, pair_springs, s, options};
}

/// Two discs, the first held, the second loaded.
Broken pair(Vec2 load, double friction, LoadCase dead = {}) {
  LoadPathOptions options;
  options.supports = {held, {"last", {}, {}, 0}};
  options.loads = {{"last", LoadKind::per_disc, load, 0}};
  options.dead_loads = std::move(dead);
  const Assembly a = chain_of_discs(2, 1);
  return {a, pair_springs, equal_strengths(a, 5, 3, friction), options};
}

std::string refusal(const Assembly& assembly, const LoadPathOptions& options) {
  try {
    Broken(assembly, pair_springs, equal_strengths(assembly, 1, 1), options).all();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("two_discs_break_where_their_only_contact_says") {
  Broken pulled = pair({1, 0}, 0);
  pulled.all();
  REQUIRE(pulled.events().size() == 1);
  CHECK(pulled.event(0).lambda == Approx(5).epsilon(1e-12));
  CHECK(pulled.event(0).mode == BreakMode::tension);
  CHECK(pulled.event(0).load == Approx(5).epsilon(1e-12));
  CHECK(pulled.event(0).motion == Approx(5e-3).epsilon(1e-12));
  CHECK(pulled.event(0).energy_before == Approx(25 / 2000.0).epsilon(1e-12));
  CHECK(pulled.run().end() == PathEnd::load_moves_part);
  Broken sheared = pair({0, 1}, 10);
  CHECK(sheared.all().event(0).lambda == Approx(3).epsilon(1e-12));
  CHECK(sheared.event(0).mode == BreakMode::shear);
  // |T| = lambda, N = +-lambda: f_s - mu N is reached at 3/(1 + mu), and under compression at 3/(1 - mu) or never.
  CHECK(pair({1, 1}, 0.5).all().event(0).lambda == Approx(2).epsilon(1e-12));
  CHECK(pair({-1, 1}, 0.5).all().event(0).lambda == Approx(6).epsilon(1e-12));
  CHECK(pair({1, 1}, 10).all().event(0).lambda == Approx(3 / 11.0).epsilon(1e-12));
  Broken pressed = pair({-1, 1}, 10);
  CHECK(pressed.all().events().empty());
  CHECK(pressed.run().end() == PathEnd::never_breaks);
}

TEST_CASE("dead_loads_stay_while_lambda_grows") {
  CHECK(pair({1, 0}, 0, {{"last", LoadKind::per_disc, {2, 0}, 0}}).all().event(0).lambda == Approx(3).epsilon(1e-12));
  CHECK(pair({1, 0}, 0, {{"last", LoadKind::per_disc, {-2, 0}, 0}}).all().event(0).lambda == Approx(7).epsilon(1e-12));
  Broken over = pair({1, 0}, 0, {{"last", LoadKind::per_disc, {6, 0}, 0}});
  CHECK(over.all().event(0).lambda == 0);  // the dead loads alone break it
  Broken under = pair({-1, 0}, 0, {{"last", LoadKind::per_disc, {6, 0}, 0}});
  CHECK(under.all().event(0).lambda == 0);
}

TEST_CASE("a_bundle_of_fibres_breaks_in_the_order_of_their_strengths") {
  Broken b = bundle({4, 1, 1.2});
  b.all();
  REQUIRE(b.events().size() == 3);
  const std::int64_t order[] = {1, 2, 0};
  const double strength[] = {1, 1.2, 4};
  for (std::size_t k = 0; k < 3; ++k) {
    CAPTURE(k);
    CHECK(b.event(k).contact == order[k]);
    CHECK(b.event(k).lambda == Approx(strength[k]).epsilon(1e-12));
    CHECK(b.event(k).load == Approx(static_cast<double>(3 - k) * strength[k]).epsilon(1e-12));
    CHECK(b.event(k).energy_released == Approx(strength[k] * strength[k] / 2000).epsilon(1e-12));
  }
  CHECK(b.run().end() == PathEnd::carries_nothing);
  CHECK(b.run().energy_error() < 1e-14);
  const Avalanches of_load = avalanches_by(b.run(), &BreakEvent::load);  // loads 3, 2.4, 4
  CHECK(of_load.number == std::vector<std::int64_t>{0, 0, 1});
  CHECK(avalanches_by(b.run(), &BreakEvent::motion).count() == 3);
  const LoadCurve envelope = motion_envelope(b.run());
  const std::vector<double> load{0, 3, 2, 2.4, 1.2, 4, 0};
  REQUIRE(envelope.load.size() == load.size());
  for (std::size_t k = 0; k < load.size(); ++k) CHECK(envelope.load[k] == Approx(load[k]).margin(1e-12));
}

TEST_CASE("a_load_that_is_held_passes_to_the_fibres_left") {
  // The first break at the load 3 leaves 1.5 to each of two: the second breaks at once, the third carries 3 and waits.
  Broken b = bundle({4, 1, 1.2}, LoadControl::load);
  b.all();
  REQUIRE(b.events().size() == 3);
  CHECK(b.event(1).lambda == Approx(1.5).epsilon(1e-12));
  CHECK(b.event(1).load == Approx(3).epsilon(1e-12));
  CHECK(b.event(2).lambda == Approx(4).epsilon(1e-12));
  CHECK(b.run().energy_error() < 1e-14);
}

TEST_CASE("legs_load_unload_and_reload") {
  Broken b = bundle({1.5, 0.5}, LoadControl::motion, {1, 0, 2, -3});
  b.all();
  REQUIRE(b.events().size() == 2);
  CHECK(b.event(0).leg == 0);
  CHECK(b.event(1).leg == 2);
  CHECK(b.event(1).lambda == Approx(1.5).epsilon(1e-12));
  CHECK(b.run().end() == PathEnd::carries_nothing);
  const std::vector<LegPoint> points = b.run().leg_points();
  REQUIRE(points.size() == 3);
  CHECK(points[1].load == Approx(1).epsilon(1e-12));
  CHECK(points[2].load == Approx(0).margin(1e-12));
  // The second leg goes back to zero, where the third begins. The load does not grow from 0.5 to 1, the motion does.
  const LoadCurve by_load = load_envelope(b.run()), by_motion = motion_envelope(b.run());
  const std::vector<double> loads{0, 1, 0, 1.5}, left{0, 1, 0.5, 1, 0, 1.5, 0}, motions{0, 0.5, 0.5, 1, 0, 1.5, 1.5};
  REQUIRE(by_load.load.size() == loads.size());
  REQUIRE(by_motion.load.size() == left.size());
  for (std::size_t k = 0; k < loads.size(); ++k) CHECK(by_load.load[k] == Approx(loads[k]).margin(1e-12));
  for (std::size_t k = 0; k < left.size(); ++k) {
    CAPTURE(k);
    CHECK(by_motion.load[k] == Approx(left[k]).margin(1e-12));
    CHECK(by_motion.motion[k] == Approx(motions[k] * b.event(0).motion / 0.5).margin(1e-12));
  }
  Broken reversed = bundle({1.5, 0.5}, LoadControl::path, {-5});
  CHECK(reversed.all().events().empty());  // compression
  CHECK(reversed.run().end() == PathEnd::legs_done);
  CHECK(reversed.run().leg_points().back().load == Approx(-10).epsilon(1e-12));
  CHECK(load_envelope(reversed.run()).load.back() == Approx(-10).epsilon(1e-12));
  CHECK(motion_envelope(reversed.run()).load.back() == Approx(-10).epsilon(1e-12));
}

TEST_CASE("parts_that_come_loose_leave_the_network") {
  // A chain pulled apart at its ends: the first break takes all load, the discs between have nothing to carry.
  const Assembly a = chain_of_discs(5, 1);
  LoadPathOptions options;
  options.supports = {held, {"last", 1e-3, 0, 0}};
  ContactStrengths strengths = equal_strengths(a, 2, 9);
  strengths.tension[2] = 1;
  Broken b(a, pair_springs, strengths, options, Rotation::restrained);
  b.all();
  REQUIRE(b.events().size() == 1);
  CHECK(b.event(0).contact == 2);
  CHECK(b.event(0).lambda == Approx(4).epsilon(1e-12));
  CHECK(b.event(0).loosened == std::vector<std::int32_t>{1, 2, 3});
  CHECK(b.run().end() == PathEnd::carries_nothing);
  Assembly two = chain_of_discs(5, 1);
  two.contacts.erase(two.contacts.begin() + 2);
  Broken cut(two, pair_springs, equal_strengths(two, 1, 1), options, Rotation::restrained);
  CHECK(cut.all().events().empty());
  CHECK(cut.run().idle() == std::vector<std::int32_t>{1, 2, 3});
}

TEST_CASE("equal_contacts_of_a_lattice_break_in_the_order_of_their_numbers") {
  const Assembly cell = hexagonal_lattice({.columns = 6, .rows = 6, .radius = 0.5, .periodic = true});
  LoadPathOptions options;
  options.strain = Voigt{1e-3, 0, 0};
  options.max_events = 15;
  Broken b(cell, pair_springs, equal_strengths(cell, 1, 1, 0.3), options);
  b.all();
  REQUIRE(b.events().size() == 15);
  CHECK(b.run().end() == PathEnd::most_events);
  // All contacts along the strain carry the same, kN e d.
  CHECK(b.event(0).lambda == Approx(1).epsilon(1e-12));
  CHECK(b.event(0).ties == 35);
  const std::vector<double> along = [&] {
    std::vector<double> x;
    for (std::size_t c = 0; c < cell.contacts.size(); ++c) x.push_back(std::abs(frame_of(cell, c).normal.x));
    return x;
  }();
  for (std::int64_t c = 0; c < b.event(0).contact; ++c) CHECK(along[static_cast<std::size_t>(c)] < 0.99);
  for (const BreakEvent& event : b.events()) CHECK(event.relative_residual < 1e-12);
  CHECK(b.run().energy_error() < 1e-10);
}

TEST_CASE("hard_strengths_and_paths_have_an_answer_or_a_reason") {
  const Assembly cell = hexagonal_lattice({.columns = 4, .rows = 4, .radius = 0.5, .periodic = true});
  LoadPathOptions strain;
  strain.strain = Voigt{1e-3, 5e-4, 0};
  for (const double kT : {0.0, 300.0}) {
    CAPTURE(kT);
    const ContactSprings k(SpringConstants{1000, kT});
    Broken zero(cell, k, equal_strengths(cell, 0, 0), strain);
    REQUIRE(zero.run().advance());
    CHECK(zero.event(0).lambda == 0);
    zero.all();
    CHECK(zero.events().size() > 10);
    CHECK(zero.events().back().lambda == 0);
  }
  LoadPathOptions pressed;
  pressed.strain = Voigt{-1e-3, -1e-3, 0};
  Broken compressed(cell, pair_springs, equal_strengths(cell, 1, 1, 10), pressed);
  CHECK(compressed.all().events().empty());
  CHECK(compressed.run().end() == PathEnd::never_breaks);

  LoadPathOptions none;
  none.strain = Voigt{};
  CHECK_THAT(refusal(cell, none), Catch::Contains("nothing grows with lambda"));
  const Assembly chain = chain_of_discs(3, 1);
  CHECK_THAT(refusal(chain, strain), Catch::Contains("not periodic"));
  LoadPathOptions both;
  both.supports = {held, {"last", 1e-3, 0, 0}};
  both.loads = {{"last", LoadKind::per_disc, {0, 1}, 1}};
  CHECK_THAT(refusal(chain, both), Catch::Contains("the loads and the motions of supports grow with lambda together"));
  LoadPathOptions loose;
  loose.supports = {held};
  loose.loads = {{"last", LoadKind::per_disc, {1, 0}, 0}};
  Assembly pieces = chain_of_discs(3, 1);
  pieces.contacts.pop_back();
  CHECK_THAT(refusal(pieces, loose), Catch::Contains("before anything breaks"));
  LoadPathOptions still = strain;
  still.legs = {1, 1};
  CHECK_THAT(refusal(cell, still), Catch::Contains("nothing happens on it"));
}

TEST_CASE("a_path_that_goes_on_has_the_events_of_one_that_was_not_stopped") {
  const Assembly cell = hexagonal_lattice({.columns = 8, .rows = 8, .radius = 0.5, .periodic = true});
  ContactStrengths strengths =
      contact_strengths(cell, {.tension = 1, .shear = 2, .friction = 0.4, .weibull_modulus = 4, .seed = 7});
  for (const LoadControl control : {LoadControl::path, LoadControl::load, LoadControl::motion}) {
    CAPTURE(to_string(control));
    LoadPathOptions options;
    options.strain = Voigt{1e-3, -2e-4, 5e-4};
    options.control = control;
    options.legs = {0.7, 0.1, 20};
    Broken whole(cell, pair_springs, strengths, options);
    whole.all();
    REQUIRE(whole.events().size() > 40);
    for (const std::size_t stop : {std::size_t{1}, whole.events().size() / 2, whole.events().size()}) {
      CAPTURE(stop);
      Broken part(cell, pair_springs, strengths, options);
      part.run().resume({whole.events().begin(), whole.events().begin() + static_cast<std::ptrdiff_t>(stop)});
      part.all();
      REQUIRE(part.events().size() == whole.events().size());
      for (std::size_t k = 0; k < whole.events().size(); ++k) {
        CHECK(part.event(k).contact == whole.event(k).contact);
        CHECK(part.event(k).lambda == Approx(whole.event(k).lambda).epsilon(1e-11));
        CHECK(part.event(k).work == Approx(whole.event(k).work).epsilon(1e-11));
      }
      CHECK(part.run().leg_points().size() == whole.run().leg_points().size());
      CHECK(part.run().energy_error() < 1e-10);
    }
    std::vector<BreakEvent> twice{whole.event(0), whole.event(0)};
    Broken other(cell, pair_springs, strengths, options);
    CHECK_THROWS_AS(other.run().resume(twice), Error);
  }
}

TEST_CASE("a_held_motion_never_falls_and_a_held_load_neither") {
  const Assembly cell = hexagonal_lattice({.columns = 8, .rows = 8, .radius = 0.5, .periodic = true});
  const ContactStrengths strengths =
      contact_strengths(cell, {.tension = 1, .shear = 2, .friction = 0.4, .weibull_modulus = 4, .seed = 3});
  for (const LoadControl control : {LoadControl::load, LoadControl::motion}) {
    LoadPathOptions options;
    options.strain = Voigt{1e-3, 0, 0};
    options.control = control;
    Broken b(cell, pair_springs, strengths, options);
    b.all();
    REQUIRE(b.events().size() > 20);
    double BreakEvent::*const held_quantity = control == LoadControl::load ? &BreakEvent::load : &BreakEvent::motion;
    for (std::size_t k = 1; k < b.events().size(); ++k)
      CHECK(b.event(k).*held_quantity >= b.event(k - 1).*held_quantity * (1 - 1e-12));
    CHECK(b.run().energy_error() < 1e-10);
  }
}

// Two discs of the cell pull at each other from the start: load S = stress : strain, with the stress of those forces.
TEST_CASE("the_load_of_a_strained_cell_is_its_stress_on_the_strain_with_dead_loads_too") {
  Assembly cell = hexagonal_lattice({.columns = 8, .rows = 8, .radius = 0.5, .periodic = true});
  cell.groups["one"] = {{9}, {}};
  cell.groups["other"] = {{45}, {}};
  const ContactStrengths strengths =
      contact_strengths(cell, {.tension = 1, .shear = 2, .friction = 0.4, .weibull_modulus = 4, .seed = 3});
  const Voigt strain{1e-3, -2e-4, 5e-4};
  LoadPathOptions options;
  options.strain = strain;
  const Vec2 pull = GENERATE(Vec2{0, 0}, Vec2{0.5, 0.2}, Vec2{-0.1, 0.4});
  options.dead_loads = {{"one", LoadKind::per_disc, pull, 0}, {"other", LoadKind::per_disc, -pull, 0}};
  const Factor factor = GENERATE(Factor::updated, Factor::anew);
  Broken b(cell, pair_springs, strengths, options, Rotation::from_scene, factor);
  b.all();
  REQUIRE(b.events().size() > 20);
  for (const BreakEvent& event : b.events()) {
    const double work = event.stress.xx * strain.xx + event.stress.yy * strain.yy +
                        0.5 * (event.stress.xy + event.stress.yx) * strain.xy;
    CAPTURE(factor == Factor::anew, pull.x, pull.y, event.lambda, event.load, work / 1e-3);
    CHECK(std::abs(event.load - work / 1e-3) < 1e-11 * (1 + norm(pull)));
  }
  CHECK(b.run().energy_error() < 1e-10);
}

TEST_CASE("a_contact_of_two_groups_is_as_strong_as_given_or_as_the_weaker_of_both") {
  Assembly chain = chain_of_discs(7, 1);
  chain.groups["a"] = {{0, 1, 2}, {}};
  chain.groups["b"] = {{3, 4}, {}};  // contacts: a a, a a, a b, b b, b -, - -
  const std::vector<OfPair<PairStrengths>> between = {{{"a", "a"}, false, {5, 1}}, {{"b", "b"}, false, {3, 2}}};
  const ContactStrengths found = contact_strengths(chain, {.tension = 4, .shear = 4, .between = between});
  CHECK(found.tension == std::vector<double>{5, 5, 3, 3, 3, 4});
  CHECK(found.shear == std::vector<double>{1, 1, 1, 2, 2, 4});
  std::vector<OfPair<PairStrengths>> named = between;
  named.push_back({{"b", "a"}, false, {9, 8}});
  const ContactStrengths by_size = contact_strengths(
      chain, {.tension = 4, .shear = 4, .bond_length = BondLength::smaller_diameter, .between = named});
  CHECK(by_size.tension[2] == 18);
  CHECK(by_size.shear[2] == 16);
  named.back().property.shear = -1;
  CHECK_THROWS_AS(contact_strengths(chain, {.tension = 4, .shear = 4, .between = named}), Error);
}

TEST_CASE("strengths_follow_the_distribution_of_weibull") {
  const Assembly cell = hexagonal_lattice({.columns = 60, .rows = 60, .radius = 0.5, .periodic = true});
  const ContactStrengths drawn = contact_strengths(cell, {.tension = 2, .shear = 6, .weibull_modulus = 3, .seed = 1});
  const auto count = static_cast<double>(drawn.tension.size());
  for (const double x : {0.5, 1.0, 1.3}) {
    double stronger = 0;
    for (const double f : drawn.tension) stronger += f > 2 * x ? 1 : 0;
    const double p = std::exp(-x * x * x);
    CHECK(std::abs(stronger / count - p) < 4 * std::sqrt(p * (1 - p) / count));
  }
  for (std::size_t c = 0; c < drawn.tension.size(); ++c) CHECK(drawn.shear[c] == Approx(3 * drawn.tension[c]));
  const ContactStrengths stress =
      contact_strengths(cell, {.tension = 2, .shear = 6, .bond_length = BondLength::smaller_diameter});
  CHECK(stress.tension.front() == Approx(2 * 1.0));
  Assembly own = cell;
  own.contact_tension.assign(cell.contacts.size(), 1);
  own.contact_shear.assign(cell.contacts.size(), 2);
  CHECK(contact_strengths(own, {}).shear.front() == 2);
  CHECK_THROWS_AS(contact_strengths(own, {.tension = 1, .shear = 1}), Error);
  CHECK_THROWS_AS(contact_strengths(cell, {}), Error);
  CHECK_THROWS_AS(contact_strengths(cell, {.tension = 1, .shear = 1, .weibull_modulus = 0}), Error);
}

TEST_CASE("a_notch_cuts_the_contacts_that_it_crosses") {
  const Assembly plate = hexagonal_lattice({.columns = 5, .rows = 4, .radius = 0.5});
  const double between = 0.5 * (plate.centres.front().y + std::sqrt(3.0) / 2);
  const Notch across{{-10, between}, {10, between}};
  CHECK(contacts_across(plate, {&across, 1}).size() == 8);  // every contact between the two lowest rows
  const Notch outside{{-10, -10}, {10, -10}};
  CHECK_THROWS_AS(contacts_across(plate, {&outside, 1}), Error);
}
