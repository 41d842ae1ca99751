// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that break one after another where strengths, loads or the network leave little to go by; frictional
/// contacts at the ends of what they can be.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/text.hpp"

#include "breakage/scenes.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "hard_cases/ledger.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Assembly plate(int columns = 12) {
  return hexagonal_lattice({.columns = columns, .rows = columns, .radius = 0.5});
}

/// Its top moves along y, its bottom stays.
LoadPathOptions moved(double by) {
  LoadPathOptions options;
  options.supports = {{"bottom", 0, 0, {}}, {"top", {}, by, {}}};
  return options;
}

Broken plate_with(double tension, double shear, double friction, double by = 1e-3, double kT = 3e8) {
  const Assembly a = plate();
  return {a, ContactSprings(SpringConstants{1e9, kT}), equal_strengths(a, tension, shear, friction), moved(by)};
}

/// Contacts across horizontal lines cut beforehand.
Assembly cut_at(Assembly assembly, const std::vector<Notch>& notches) {
  const std::vector<std::size_t> cut = contacts_across(assembly, notches);
  for (auto c = cut.rbegin(); c != cut.rend(); ++c)
    assembly.contacts.erase(assembly.contacts.begin() + static_cast<std::ptrdiff_t>(*c));
  assembly.facet_lengths.clear();
  return assembly;
}

std::string told(const BreakageRun& run) {
  return fmt::format("{}, ended: {}; energy closes to {:.1e}", counted(std::ssize(run.events()), "event"),
                     to_string(run.end()), run.energy_error());
}

Answer strengths_of(const StrengthOptions& options) {
  return attempt([&] { static_cast<void>(contact_strengths(plate(), options)); });
}

Answer path_of(double by, double kT = 3e8) {
  return attempt([&] { plate_with(1, 1, 0, by, kT); });
}

}  // namespace

TEST_CASE("contacts_without_strength_or_with_equal_strengths_break_in_order") {
  HardCase table({.name = "strength zero, and all strengths equal",
                  .why = "everything breaks at once, at no load, or at one load that many contacts share"});
  Broken none = plate_with(0, 0, 0.5);
  none.all();
  CHECK(std::ranges::all_of(none.events(), [](const BreakEvent& event) { return event.lambda == 0; }));
  CHECK(none.run().ledger().released == 0);
  CHECK(none.run().end() == PathEnd::carries_nothing);
  table.note("quasistatic, strength 0", "all breaks at lambda 0", told(none.run()));
  const Assembly cell = hexagonal_lattice({.columns = 8, .rows = 8, .radius = 0.5, .periodic = true});
  LoadPathOptions strain;
  strain.strain = Voigt{1e-3, 0, 0};
  Broken perfect(cell, usual_springs, equal_strengths(cell, 1e6, 1e6), strain);
  perfect.all();
  CHECK(perfect.event(0).ties == 63);
  CHECK(perfect.event(0).lambda == Approx(1).epsilon(1e-12));
  CHECK(perfect.run().energy_error() < 1e-10);
  table.note("quasistatic of a perfect lattice", "63 ties at lambda 1",
             fmt::format("{} ties; {}", perfect.event(0).ties, told(perfect.run())));
}

TEST_CASE("pressed_and_pulled_samples_close_their_energy_or_say_why_nothing_breaks") {
  HardCase table({.name = "compression and friction 0 and 10",
                  .why = "contacts under compression cannot break in tension, and with friction not in shear"});
  for (const double friction : {0.0, 10.0}) {
    for (const double by : {1e-3, -1e-3}) {
      Broken pressed = plate_with(1e5, 2e5, friction, by);
      pressed.all();
      CHECK(!pressed.events().empty());
      CHECK(pressed.run().energy_error() < 1e-10);
      for (const BreakEvent& event : pressed.events()) CHECK(event.relative_residual < 1e-12);
      table.note(fmt::format("quasistatic, {}, friction {:g}", by > 0 ? "tension" : "compression", friction),
                 "energy closes to 1e-10", told(pressed.run()));
    }
  }
  const Assembly cell = hexagonal_lattice({.columns = 4, .rows = 4, .radius = 0.5, .periodic = true});
  LoadPathOptions inward;
  inward.strain = Voigt{-1e-3, -1e-3, 0};
  Broken never(cell, usual_springs, equal_strengths(cell, 1e5, 1e5), inward);
  CHECK(never.all().events().empty());
  CHECK(never.run().end() == PathEnd::never_breaks);
  table.note("quasistatic, pressed from all sides", "no event, and why", told(never.run()));
}

TEST_CASE("pieces_that_carry_nothing_do_not_break_by_round_off") {
  HardCase table({.name = "a sample in pieces",
                  .why = "the forces of pieces that move rigidly are round-off, which any strength would reach"});
  const double width = 12, low = 3.9, high = 6.5;
  const std::vector<Notch> one{{{-1, low}, {width + 1, low}}};
  const std::vector<Notch> two{one.front(), {{-1, high}, {width + 1, high}}};
  for (const auto& notches : {one, two}) {
    const Assembly pieces = cut_at(plate(), notches);
    const std::string name = notches.size() == 1 ? "two pieces" : "a piece between two cracks";
    Broken apart(pieces, usual_springs, equal_strengths(pieces, 1e3, 1e3), moved(1e-3));
    apart.all();
    CAPTURE(told(apart.run()));
    CHECK(apart.events().empty());
    CHECK(apart.run().end() == PathEnd::carries_nothing);
    table.note("quasistatic, " + name, "no event: nothing is carried", told(apart.run()));
    LoadPathOptions pulled;
    pulled.supports = {{"bottom", 0, 0, {}}};
    pulled.loads = {{"top", LoadKind::total, {0, 1}, 0}};
    table.refused("quasistatic, " + name + ", load on the loose one",
                  attempt([&] { Broken(pieces, usual_springs, equal_strengths(pieces, 1e3, 1e3), pulled).all(); }),
                  {"before anything breaks", "Hold that part by a support"});
  }
}

TEST_CASE("loads_that_turn_round_break_what_they_pull") {
  HardCase table({.name = "a load that is reversed", .why = "cracks do not close, and lambda passes through zero"});
  for (const LoadControl control : {LoadControl::path, LoadControl::load, LoadControl::motion}) {
    LoadPathOptions there_and_back = moved(1e-3);
    there_and_back.control = control;
    there_and_back.legs = {0.8, -20, 3};
    const Assembly a = plate();
    Broken turned(a, usual_springs,
                  contact_strengths(a, {.tension = 3e5, .shear = 4e5, .friction = 0.3, .weibull_modulus = 3}),
                  there_and_back);
    turned.all();
    CHECK(turned.events().size() > 5);
    CHECK(turned.events().front().leg < turned.events().back().leg);
    CHECK(turned.run().energy_error() < 1e-10);
    table.note("quasistatic, control of " + std::string(to_string(control)), "energy closes to 1e-10",
               told(turned.run()));
  }
}

TEST_CASE("strengths_and_loads_out_of_the_range_of_numbers_are_refused") {
  HardCase table({.name = "strengths and loads of any size",
                  .why = "energies are squares of forces over springs, and leave the range of numbers before they do"});
  for (const double scale : {1e-60, 1e60}) {
    Broken scaled = plate_with(scale, 2 * scale, 0.5);
    scaled.all();
    Broken usual = plate_with(1, 2, 0.5);
    usual.all();
    REQUIRE(scaled.events().size() == usual.events().size());
    double error = 0;
    for (std::size_t k = 0; k < usual.events().size(); ++k)
      error = std::max(error, std::abs(scaled.event(k).load / (scale * usual.event(k).load) - 1));
    CHECK(error < 1e-12);
    table.note(fmt::format("quasistatic, strengths times {:g}", scale), "loads times the same, to 1e-12",
               fmt::format("to {:.1e}", error));
  }
  const double nan = std::nan("");
  for (const double f : {1e200, 1e-200, nan})
    table.refused("quasistatic, strength " + fmt::format("{:g}", f), strengths_of({.tension = f, .shear = 1}),
                  {"the strength in tension is", "Correct it"});
  table.refused("quasistatic, friction 1e300", strengths_of({.tension = 1, .shear = 1, .friction = 1e300}),
                {"the friction is 1e+300", "Correct it"});
  table.refused("quasistatic, Weibull modulus 1e-3", strengths_of({.tension = 1, .shear = 1, .weibull_modulus = 1e-3}),
                {"a Weibull modulus of 0.001 scatters them", "Give a larger modulus"});
  for (const double by : {1e-300, 1e300})
    table.refused("quasistatic, motion " + fmt::format("{:g}", by), path_of(by),
                  {"the size of the motions of supports is", "leave the range of numbers", "another unit"});
  table.refused("quasistatic, motion 0", path_of(0), {"nothing grows with lambda", "Add [[load]]"});
}

TEST_CASE("a_network_that_breaks_needs_springs_under_which_discs_can_move") {
  HardCase table({.name = "kT = 0 and kT < 0 in a network that breaks",
                  .why = "no motion of discs is stable with kT < 0, and a break asks for one"});
  Broken without = plate_with(1e5, 2e5, 0.5, 1e-3, 0);
  without.all();
  CHECK(!without.events().empty());
  CHECK(without.run().energy_error() < 1e-10);
  table.note("quasistatic, kT = 0", "energy closes to 1e-10", told(without.run()));
  for (const double kT : {-1e7, -5e8})
    table.refused(fmt::format("quasistatic, kT/kN = {:g}", kT / 1e9), path_of(1e-3, kT),
                  {"kT < 0 in a network that breaks", "no motion of discs is stable", "Take kT >= 0"});
}

namespace {

std::string told(const UnbondedRun& run) {
  return fmt::format("{}, ended: {}", counted(std::ssize(run.events()), "event"), to_string(run.end()));
}

Assembly frictional_cell() {
  return hexagonal_lattice({.columns = 4, .rows = 4, .radius = 0.5, .periodic = true});
}

}  // namespace

TEST_CASE("an_inclined_crack_with_any_friction_goes_to_and_fro_and_closes_its_energy") {
  HardCase table({.name = "faces of a crack, friction 0 to 10, to and fro",
                  .why = "the tangent is not symmetric where faces slip, and at every turn all of them stick at once"});
  for (const double friction : {0.0, 0.3, 1.0, 10.0}) {
    const Assembly block = hexagonal_lattice({.columns = 9, .rows = 9, .radius = 0.5});
    ContactStrengths strengths = equal_strengths(block, 1e9, 1e9);
    const std::vector<Notch> crack{{{2.1, 2.2}, {6.3, 5.4}}};
    for (const std::size_t c : contacts_across(block, crack)) strengths.tension[c] = strengths.shear[c] = 0;
    LoadPathOptions path;
    path.supports = {{"bottom", 0, 0, {}}, {"top", 0, -1e-3, {}}};
    path.control = LoadControl::motion;
    path.legs = {1, -1, 1};
    Unbonded scene(block, usual_springs, strengths, path, {friction, {}});
    scene.all();
    CAPTURE(friction, told(scene.run()), scene.run().energy_error());
    // Much friction may leave no answer: the path says so.
    CHECK(scene.run().end() == (friction > 1 ? PathEnd::no_answer : PathEnd::legs_done));
    CHECK(!scene.run().why().empty());
    CHECK(scene.run().energy_error() < 1e-10);
    CHECK(scene.run().solver().largest_residual < 1e-12);
    const double lost = scene.run().ledger().friction;
    CHECK(lost >= 0);
    if (friction <= 1) CHECK((lost > 0) == (friction > 0));
    table.note(fmt::format("quasistatic, frictional, friction {:g}", friction),
               friction > 1 ? "an end with its reason" : "energy closes to 1e-10, residual below 1e-12",
               told(scene.run()));
  }
}

TEST_CASE("discs_without_a_bond_and_without_a_force_open_or_close_at_once") {
  HardCase table({.name = "a frictional packing without a force at rest",
                  .why = "every contact is at the apex of its cone: it may open, stick, or slip either way"});
  for (const double strain : {-1e-3, 1e-3}) {
    LoadPathOptions path;
    path.strain = Voigt{strain, strain, 0};
    path.control = LoadControl::motion;
    path.legs = {1};
    Unbonded scene(frictional_cell(), usual_springs, path, 0.5);
    scene.all();
    const auto& status = scene.run().contact_state().status();
    CAPTURE(strain, told(scene.run()));
    CHECK(std::ranges::count(status, ContactStatus::open) == (strain > 0 ? std::ssize(status) : 0));
    CHECK(std::abs(scene.run().leg_points().back().load) > (strain > 0 ? -1.0 : 1.0));
    table.note(strain > 0 ? "quasistatic, frictional, pulled from all sides"
                          : "quasistatic, frictional, pressed from all sides",
               strain > 0 ? "all open, no load" : "no contact opens", told(scene.run()));
  }
}
