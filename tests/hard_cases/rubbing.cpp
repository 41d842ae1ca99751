// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that rub, forces at rest and viscoelastic springs at the ends of what they can be.
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/viscoelastic_stiffness.hpp"
#include "equidem/statics/critical_load.hpp"

#include "breakage/unbonded_scenes.hpp"
#include "hard_cases/ledger.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

std::string told(const UnbondedRun& run) {
  return fmt::format("{}, ended: {}", counted(std::ssize(run.events()), "event"), to_string(run.end()));
}

Assembly rubbing_cell() {
  return hexagonal_lattice({.columns = 4, .rows = 4, .radius = 0.5, .periodic = true});
}

/// A column of discs pressed by 1 N/m along x.
Assembly pressed_chain(int discs) {
  Assembly chain = chain_of_discs(discs, 0.5);
  chain.contact_normal_force.assign(chain.contacts.size(), -1.0);
  chain.contact_tangential_force.assign(chain.contacts.size(), 0.0);
  return chain;
}

}  // namespace

TEST_CASE("an_inclined_crack_with_any_friction_goes_to_and_fro_and_closes_its_energy") {
  HardCase table({.name = "faces of a crack that rub, friction 0 to 10, to and fro",
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
    table.note(fmt::format("quasistatic, rubs, friction {:g}", friction),
               friction > 1 ? "an end with its reason" : "energy closes to 1e-10, residual below 1e-12",
               told(scene.run()));
  }
}

TEST_CASE("discs_without_a_bond_and_without_a_force_open_or_close_at_once") {
  HardCase table({.name = "a packing that rubs without a force at rest",
                  .why = "every contact is at the apex of its cone: it may open, stick, or slip either way"});
  for (const double strain : {-1e-3, 1e-3}) {
    LoadPathOptions path;
    path.strain = Voigt{strain, strain, 0};
    path.control = LoadControl::motion;
    path.legs = {1};
    Unbonded scene(rubbing_cell(), usual_springs, path, 0.5);
    scene.all();
    const auto& status = scene.run().contact_state().status();
    CAPTURE(strain, told(scene.run()));
    CHECK(std::ranges::count(status, ContactStatus::open) == (strain > 0 ? std::ssize(status) : 0));
    CHECK(std::abs(scene.run().leg_points().back().load) > (strain > 0 ? -1.0 : 1.0));
    table.note(strain > 0 ? "quasistatic, rubs, pulled from all sides" : "quasistatic, rubs, pressed from all sides",
               strain > 0 ? "all open, no load" : "no contact opens", told(scene.run()));
  }
}

TEST_CASE("forces_at_rest_of_what_rolls_or_does_not_balance_are_not_taken") {
  HardCase table({.name = "forces at rest",
                  .why = "what holds by them alone has no critical load, and what they do not balance moves"});
  const std::vector<Support> held{{"first", 0, 0, 0}};
  const ContactSprings springs = usual_springs;
  const Assembly soft = pressed_chain(4);
  const CriticalLoad none = find_critical_load(soft, springs_of(0).with_prestress(prestress_of(soft)), held);
  CHECK_FALSE(none.sought);
  table.note("stability, a chain of discs, kT = 0", "not sought, and why", none.why);
  Assembly cell = rubbing_cell();
  cell.contact_normal_force.assign(cell.contacts.size(), 0.0);
  cell.contact_tangential_force.assign(cell.contacts.size(), 0.0);
  cell.contact_normal_force[0] = -1;
  table.refused("homogenize, forces at rest that do not balance",
                attempt([&] { choose_prestress(cell, springs, PrestressChoice::on); }), {"do not balance"});
}

TEST_CASE("dashpots_of_one_time_give_complex_moduli_at_any_frequency") {
  HardCase table({.name = "viscoelastic springs",
                  .why = "springs of one frequency may differ by any power of ten, and stand for nothing at rest"});
  const Assembly cell = rubbing_cell();
  constexpr double tau = 0.01;
  const ViscoelasticSpring dashpot{.model = SpringModel::kelvin_voigt, .time = tau};
  const Viscoelasticity both{dashpot, dashpot};
  HomogenizeOptions options;
  options.boundary = Boundary::periodic;
  const Matrix3 elastic = effective_stiffness(cell, usual_springs, options).stiffness;
  for (const double frequency : {1e-30, 1.0, 1e30}) {
    const HarmonicStiffness found =
        viscoelastic_stiffness(cell, usual_springs, both, std::vector{frequency}, options).harmonic.front();
    const std::complex<double> factor = dashpot.factor(frequency);
    const double error = (largest_entry(found.storage + (-factor.real()) * elastic) +
                          largest_entry(found.loss + (-factor.imag()) * elastic)) /
                         (std::abs(factor) * largest_entry(elastic));
    CAPTURE(frequency, error);
    CHECK(error < 1e-12);
    table.note(fmt::format("homogenize, Kelvin-Voigt, {:g} Hz", frequency), "(1 + i omega tau) C, to 1e-12",
               error < 1e-12 ? "to 1e-12" : "not");
  }
  const auto at = [&](const ContactSprings& springs, const Viscoelasticity& law, double frequency) {
    return attempt([&] { viscoelastic_stiffness(cell, springs, law, std::vector{frequency}, options); });
  };
  table.refused("homogenize, viscoelastic, 0 Hz", at(usual_springs, both, 0), {"a frequency is 0 Hz"});
  table.refused("homogenize, viscoelastic, -1 Hz", at(usual_springs, both, -1), {"a frequency is -1 Hz"});
  table.refused("homogenize, viscoelastic, kT < 0", at(springs_of(-0.1), both, 1), {"kT is negative"});
  const Viscoelasticity endless{{.model = SpringModel::maxwell, .time = 0}, dashpot};
  table.refused("homogenize, Maxwell, tau = 0", at(usual_springs, endless, 1), {});
}
