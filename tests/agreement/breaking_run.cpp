// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds that break inside `run` beside the events of `quasistatic`.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/breakage/avalanches.hpp"
#include "equidem/breakage/breakage_run.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/waves/natural_frequencies.hpp"

#include "breakage/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr SpringConstants brittle_springs{400, 150};
constexpr double brittle_mass = 1;

Inertia brittle_inertia(const Assembly& block, std::size_t disc) {
  return {brittle_mass, 0.5 * brittle_mass * block.radii[disc] * block.radii[disc]};
}

/// A random block of discs, with levers that add up to the distances.
Assembly brittle_block(std::uint64_t seed) {
  Assembly block =
      delaunay_assembly({.discs = 60, .disorder = 0.2, .seed = seed, .radii = {.smallest = 0.4, .largest = 0.6}});
  for (Contact& c : block.contacts) {
    const double distance = norm(block.branch(c));
    c.lever_i = block.radii[c.i] / (block.radii[c.i] + block.radii[c.j]) * distance;
    c.lever_j = distance - c.lever_i;
  }
  return block;
}

/// Left end held, right end moved by 1 m at lambda = 1.
std::vector<Support> parting_ends() {
  return {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0},
          {.group = "right", .ux = 1.0, .uy = 0.0, .rotation = 0.0}};
}

/// The block as colliding discs, so small that those whose bond broke do not meet. The ends are as heavy as plates, and
/// the right one moves at a speed. Dashpots in proportion to the springs, by `lag`, take no part in how a steady motion
/// divides forces, and the block goes to its new rest behind a break without swinging beyond it where lag > 2/omega.
GrainScene parting_block(const Assembly& block, const ContactStrengths& strengths, double lag, double speed) {
  GrainScene scene;
  scene.pairs = {{.stiffness = 1, .restitution = 1}};
  for (std::size_t d = 0; d < block.size(); ++d) {
    Grain grain;
    grain.position = block.centres[d];
    grain.radius = 0.5 * block.radii[d];
    grain.inertia = brittle_inertia(block, d);
    scene.grains.push_back(grain);
  }
  for (const char* end : {"left", "right"})
    for (const std::int32_t d : block.groups.at(end).discs)
      scene.grains[static_cast<std::size_t>(d)].inertia = {1e20, 1e20};
  for (const std::int32_t d : block.groups.at("right").discs)
    scene.grains[static_cast<std::size_t>(d)].velocity = {speed, 0};
  for (const Contact& contact : block.contacts)
    scene.bonds.push_back({.i = static_cast<std::size_t>(contact.i),
                           .j = static_cast<std::size_t>(contact.j),
                           .normal_dashpot = lag * brittle_springs.kN,
                           .tangential_dashpot = lag * brittle_springs.kT,
                           .normal_spring = brittle_springs.kN,
                           .tangential_spring = brittle_springs.kT});
  scene.strengths = strengths;
  return scene;
}

/// The block without some contacts.
Assembly left_of(const Assembly& block, const std::set<std::int64_t>& broken) {
  Assembly left = block;
  left.contacts.clear();
  left.facet_lengths.clear();
  for (std::size_t c = 0; c < block.contacts.size(); ++c)
    if (!broken.contains(static_cast<std::int64_t>(c))) left.contacts.push_back(block.contacts[c]);
  return left;
}

/// Contacts that bear more than their strength where the ends of what is left are apart by lambda.
std::set<std::int64_t> overloaded(const Assembly& block, const ContactStrengths& strengths,
                                  const std::set<std::int64_t>& broken, double lambda) {
  std::vector<Support> ends = parting_ends();
  ends[1].ux = lambda;
  const Assembly left = left_of(block, broken);
  const Equilibrium rest = solve_equilibrium(left, ContactSprings(brittle_springs), ends, {});
  std::set<std::int64_t> found;
  std::size_t number = 0;
  for (std::size_t c = 0; c < block.contacts.size(); ++c) {
    if (broken.contains(static_cast<std::int64_t>(c))) continue;
    const ContactForce& force = rest.contact_forces[number++];
    if (force.normal >= strengths.tension[c] || std::abs(force.tangential) >= strengths.shear[c])
      found.insert(static_cast<std::int64_t>(c));
  }
  return found;
}

/// The angular frequency of the lowest mode between the held ends, 1/s.
double lowest_frequency(const Assembly& block) {
  const ContactSprings springs(brittle_springs);
  std::vector<Inertia> inertia;
  for (std::size_t d = 0; d < block.size(); ++d) inertia.push_back(brittle_inertia(block, d));
  const DegreesOfFreedom unknowns =
      number_unknowns(block, springs, derive_effects(springs, Rotation::from_scene), parting_ends());
  return std::sqrt(natural_frequencies(block, springs, unknowns, inertia, {.count = 1}).squared.at(0));
}

}  // namespace

TEST_CASE("a_block_that_parts_slowly_breaks_the_bonds_of_quasistatic_avalanche_by_avalanche") {
  // Where dashpots are in proportion to the springs and inertia counts little, a block whose ends stand still goes from
  // its rest before a break straight to that behind it. Loads of bonds are convex along the way, so a bond breaks on it
  // only if it is overloaded at its end: where that is one bond at a time, run and quasistatic have no choice. Where it
  // is several, quasistatic breaks the one of the least lambda first and run that which is reached first: the sequences
  // may part, and are compared no further.
  const std::uint64_t seed = GENERATE(11, 12);
  const Assembly block = brittle_block(6);
  // strengths at which bonds break at strains of about 1e-6
  const ContactStrengths strengths =
      contact_strengths(block, {.tension = 8e-4, .shear = 6e-4, .weibull_modulus = 2.0, .seed = seed});
  LoadPathOptions path;
  path.supports = parting_ends();
  path.control = LoadControl::motion;
  path.max_events = 30;
  Broken statics(block, ContactSprings(brittle_springs), strengths, path);
  statics.all();
  const Avalanches avalanches = avalanches_by(statics.run(), &BreakEvent::motion);
  std::set<std::int64_t> broken;
  std::size_t determined = 0, whole = 0;  // events, and events of whole avalanches
  for (bool unique = true; unique && determined + 1 < statics.events().size();) {
    broken.insert(statics.event(determined++).contact);
    if (!statics.event(determined - 1).loosened.empty()) break;  // overloaded() knows no loose discs
    const bool ends = avalanches.number[determined] != avalanches.number[determined - 1];
    const std::set<std::int64_t> next = overloaded(block, strengths, broken, statics.event(determined - 1).lambda);
    CAPTURE(seed, determined, next);
    if (ends) {
      CHECK(next.empty());
      whole = determined;
    } else {
      CHECK(next.contains(statics.event(determined).contact));
    }
    unique = next.size() <= 1;
  }
  broken.clear();
  for (std::size_t e = 0; e < whole; ++e) broken.insert(statics.event(e).contact);

  const double lag = 2 / lowest_frequency(left_of(block, broken));
  const double step = 0.9 * explicit_step_limit(parting_block(block, strengths, lag, 0));
  // a whole number of units in the last place of the positions of the end, so that each step is as long
  const double unit = std::ldexp(std::numeric_limits<double>::epsilon(), 4);
  const double speed = std::round(1e-8 * step / unit) * unit / step;
  GrainSimulation run(
      parting_block(block, strengths, lag, speed),
      {.law = NormalLaw::linear_dashpot, .time_step = step, .bond_step = GrainOptions::BondStep::explicit_euler});
  while (run.breaks().size() < whole && run.time() * speed < 2 * statics.event(whole).lambda) run.advance(1000);
  const std::vector<BondBreak> breaks = run.breaks();
  CAPTURE(seed, whole, lag, step, run.step(), avalanches.largest);
  REQUIRE(whole >= 10);
  REQUIRE(breaks.size() >= whole);
  double shortest = std::numeric_limits<double>::infinity();
  for (const Contact& contact : block.contacts) shortest = std::min(shortest, norm(block.branch(contact)));
  for (std::size_t e = 0; e < whole; ++e) {
    const BreakEvent& event = statics.event(e);
    const double lambda = static_cast<double>(breaks[e].step) * step * speed;
    const bool begins = e == 0 || avalanches.number[e] != avalanches.number[e - 1];
    // The step in which the strength is reached and the one before which it is told. Finite motions change forces by
    // the strain, at most that of one bond, no shorter than 0.8 m, which takes all of lambda.
    const double bound = 2 * speed * step + lambda * lambda / 0.8;
    CAPTURE(e, avalanches.number[e], event.lambda, lambda - event.lambda, bound, event.contact, breaks[e].bond);
    CHECK(static_cast<std::int64_t>(breaks[e].bond) == event.contact);
    CHECK(breaks[e].mode == event.mode);
    if (begins) CHECK(std::abs(lambda - event.lambda) < bound);
    CHECK(lambda > event.lambda - bound);
  }
}
