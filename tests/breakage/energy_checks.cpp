// SPDX-License-Identifier: GPL-3.0-or-later
// The closure of energy that a path tells is not 0 where forces are wrong, and says by how much: to the round-off that
// it has with the right forces, 1e-13.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/random.hpp"

#include "breakage/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A plate of random springs and strengths, pulled at its top. The path may be given a spring that is not that of the
/// network: an error of energies that is put in.
class PulledPlate : public OwnedScene {
 public:
  explicit PulledPlate(Factor factor)
      : PulledPlate(delaunay_assembly({.discs = 60,
                                       .points = PointProcess::perturbed_hexagonal,
                                       .disorder = 0.25,
                                       .seed = 3,
                                       .radii = {.smallest = 0.5, .largest = 0.5}}),
                    factor) {}

  BreakableSystem& system() { return system_; }
  /// From now on the energy of this contact is taken `by`² times as large, as if its force were `by` times as large.
  void scale(std::size_t contact, double by) {
    const SpringConstants k = springs()[contact];
    taken_.set(contact, {k.kN / (by * by), k.kT / (by * by)}, contacts());
  }
  BreakageRun& run() { return run_; }
  [[nodiscard]] std::size_t contacts() const { return assembly().contacts.size(); }

 private:
  PulledPlate(const Assembly& assembly, Factor factor)
      : OwnedScene(assembly, springs_of(assembly), strengths_of(assembly), options(), Rotation::from_scene),
        taken_(springs()),
        system_(breakable_network(scene(), effects(), supports()), factor),
        run_({this->assembly(), taken_, strengths(), path()}, system_) {}
  static ContactSprings springs_of(const Assembly& assembly) {
    Random random(5);
    std::vector<SpringConstants> springs;
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c)
      springs.push_back({random.uniform(0.5, 2), random.uniform(0.2, 0.8)});
    return ContactSprings(std::move(springs));
  }
  static ContactStrengths strengths_of(const Assembly& assembly) {
    Random random(7);
    ContactStrengths strengths;
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      strengths.tension.push_back(random.uniform(0.2, 1.5));
      strengths.shear.push_back(random.uniform(0.2, 1.5));
    }
    return strengths;
  }
  static LoadPathOptions options() {
    LoadPathOptions options;
    options.supports = {{"bottom", 0, 0, {}}, {"top", 0, 1, {}}};
    return options;
  }

  ContactSprings taken_;
  BreakableSystem system_;
  BreakageRun run_;
};

/// Work until the contact of this event let go, N: that done meanwhile is part of what the event released.
double work_before(const BreakEvent& event) {
  return event.work - (event.energy_released - event.energy_before + event.energy_after);
}

double larger_of_work_and_energy(const BreakEvent& event) {
  return std::max(std::abs(work_before(event)), std::abs(event.energy_before));
}

constexpr std::size_t events = 12;

/// A contact that does not break and carries a force throughout.
std::size_t lasting_contact() {
  PulledPlate plate(Factor::updated);
  for (std::size_t k = 0; k < events; ++k) REQUIRE(plate.run().advance());
  const auto forces = plate.system().forces(0);
  std::size_t most = 0;
  for (std::size_t c = 0; c < plate.contacts(); ++c)
    if (std::abs(forces[c].normal) > std::abs(forces[most].normal)) most = c;
  return most;
}

}  // namespace

// Where the force of a contact is taken s times as large as it is, the energy of its spring is s² times as large. The
// energy by works does not depend on it.
TEST_CASE("a_wrong_force_of_one_contact_shows_in_the_energy_of_springs") {
  const std::size_t contact = lasting_contact();
  for (const double wrong : {0.0, 1e-8, 1e-4, 0.1}) {
    PulledPlate plate(Factor::updated);
    plate.scale(contact, 1 + wrong);
    double expected = 0;
    for (std::size_t k = 0; k < events; ++k) {
      const ContactForce f = plate.system().forces(0)[contact];
      REQUIRE(plate.run().advance());
      REQUIRE(plate.system().sums().has_value());
      if (k != 0 && k != 1 && k != 3 && k != 7) continue;
      const BreakEvent& event = plate.run().events().back();
      const double energy = event.lambda * event.lambda * linear_spring_energy_of(plate.springs()[contact], f);
      expected = std::max(expected, (2 + wrong) * wrong * energy / larger_of_work_and_energy(event));
    }
    const double told = plate.run().energy_error();
    CAPTURE(contact, wrong, expected, told);
    if (wrong == 0) {
      CHECK(told < 1e-13);
    } else {
      CHECK(told == Approx(expected).epsilon(1e-9).margin(1e-13));
    }
  }
}

// A network that is factorized anew has its energy by springs, and works by motions: they part on the way from one
// event to the next.
TEST_CASE("a_wrong_force_shows_in_the_works_of_a_network_that_is_factorized_anew") {
  const std::size_t contact = lasting_contact();
  for (const double wrong : {0.0, 1e-8, 1e-4, 0.1}) {
    PulledPlate plate(Factor::anew);
    plate.scale(contact, 1 + wrong);
    double apart = 0, from = 0;
    for (std::size_t k = 0; k < events; ++k) {
      const ContactForce f = plate.system().forces(0)[contact];
      REQUIRE(plate.run().advance());
      const double to = plate.run().lambda();
      if (k > 0)
        apart += (2 + wrong) * wrong * (to * to - from * from) * linear_spring_energy_of(plate.springs()[contact], f);
      from = to;
    }
    const BreakageRun& run = plate.run();
    const double told = run.energy_error();
    const double largest = std::max({run.events().back().work, run.ledger().elastic, run.ledger().released});
    CAPTURE(contact, wrong, apart, largest, told);
    if (wrong == 0) {
      CHECK(told < 1e-13);
    } else {
      CHECK(told == Approx(std::abs(apart) / largest).epsilon(1e-9).margin(1e-13));
    }
  }
}
