// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Frictional contacts, forces at rest and viscoelastic springs at the ends of what they can be.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/text.hpp"

#include "breakage/unbonded_scenes.hpp"
#include "hard_cases/ledger.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

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
