// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "breakage/dense_unbonded.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct DrawnPacking {
  std::string name;
  Assembly assembly;
  ContactSprings springs{SpringConstants{1, 0.3}};
  ContactStrengths strengths;
  LoadPathOptions path;
  UnbondedOptions unbonded;
  Rotation rotation = Rotation::from_scene;
};

/// Assemblies of about ten discs, loaded, unloaded and reloaded: bonds and contacts without a bond, gaps and forces at
/// rest at random, in every combination of what drives them, tangential springs and friction.
DrawnPacking draw_packing(std::uint64_t seed) {
  Random random(seed);
  DrawnPacking d;
  const bool periodic = seed % 3 == 0;
  d.assembly = delaunay_assembly({.discs = periodic ? 8 : 10,
                                  .points = PointProcess::perturbed_hexagonal,
                                  .disorder = 0.25,
                                  .seed = seed,
                                  .radii = {.smallest = 0.5, .largest = 0.5},
                                  .periodic = periodic});
  const double kT = std::array{0.5, 0.0, 1.0, 0.2}[seed / 3 % 4];
  const double friction = std::array{0.3, 0.0, 0.6, 10.0, 0.1}[seed % 5];
  const double bonded = std::array{0.0, 0.5, 0.9, 1.0}[seed / 2 % 4];
  const int rest = static_cast<int>(seed / 5 % 3);  // 0: no forces at rest, 1: gaps, 2: forces
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < d.assembly.contacts.size(); ++c) {
    springs.push_back({random.uniform(0.5, 2), kT * random.uniform(0.5, 2)});
    const bool bond = random.uniform(0, 1) < bonded;
    d.strengths.tension.push_back(bond ? random.uniform(0.2, 1.5) : 0);
    d.strengths.shear.push_back(bond ? random.uniform(0.2, 1.5) : 0);
    if (rest == 1) d.unbonded.rest.push_back({bond ? 0 : std::max(0.0, random.uniform(-0.3, 0.3)), 0});
    if (rest == 2) {
      const double n = -random.uniform(0.2, 1);
      d.unbonded.rest.push_back({n, bond || kT > 0 ? friction * n * random.uniform(-0.9, 0.9) : 0});
      if (friction > 1) d.unbonded.rest.back().tangential = 0.3 * n;
      if (kT == 0) d.unbonded.rest.back().tangential = 0;
    }
  }
  d.springs = ContactSprings(std::move(springs));
  if (rest == 2 && bonded > 0) {
    for (std::size_t c = 0; c < d.strengths.shear.size(); ++c) d.strengths.shear[c] *= d.strengths.shear[c] > 0 ? 4 : 0;
  }
  d.strengths.friction = std::array{0.0, 0.5}[seed % 2];
  d.unbonded.friction = friction;
  if (seed % 7 == 0) d.rotation = Rotation::restrained;
  d.name = fmt::format("seed {}, kT {}, friction {}, bonded {}, rest {}", seed, kT, friction, bonded, rest);
  d.path.control = LoadControl::motion;
  d.path.legs = {1.5, -0.5, 2};
  const auto part = [&] { return random.uniform(-1, 1); };
  if (periodic) {
    d.path.strain = Voigt{part(), part(), part()};
    d.name += ", strain";
    return d;
  }
  d.path.supports = {{"bottom", 0, 0, {}}};
  if (seed % 2 == 1) {
    d.path.supports.push_back({"top", part(), -std::abs(part()), {}});
    d.name += ", motion";
  } else {
    d.path.loads = {{"top", LoadKind::per_disc, {0.4 * part(), -std::abs(part())}, 0}};
    d.path.control = LoadControl::load;
    d.name += ", loads";
  }
  if (seed % 4 >= 2 && seed % 2 == 0) {
    d.path.dead_loads = {{"top", LoadKind::per_disc, {0.05 * part(), -0.5}, 0}};
    d.name += ", dead loads";
  }
  return d;
}

}  // namespace

TEST_CASE("random_packings_open_close_slip_and_break_as_complementarity_by_dense_matrices_says") {
  std::map<std::string, int> seen;
  std::int64_t compared = 0, ambiguous = 0, unknown = 0, not_found = 0, loose = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const DrawnPacking d = draw_packing(seed);
    CAPTURE(d.name);
    Unbonded ours(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    constexpr std::size_t most = 150;
    while (ours.events().size() < most && ours.run().advance()) {
    }
    CAPTURE(ours.run().why(), ours.events().size());
    CHECK(ours.run().counters().largest_residual < 1e-12);
    CHECK(ours.run().energy_error() < 1e-10);
    const DegreesOfFreedom unknowns = number_unknowns(ours.assembly(), ours.springs(), ours.effects(), d.path.supports);
    DenseUnbonded dense(ours.assembly(), ours.springs(), ours.strengths(), ours.path(), unknowns, d.unbonded.friction,
                        d.unbonded.rest);
    const bool found = dense.go(most);
    not_found += found ? 0 : 1;
    const std::size_t both = std::min({dense.events.size(), ours.events().size(), dense.determined});
    loose += dense.determined < dense.events.size() ? 1 : 0;
    for (std::size_t k = 0; k < both; ++k) {
      const BreakEvent& event = ours.event(k);
      // Where nothing is found to balance the loads, bonds break one after another as everything falls.
      if (!found && event.lambda >= ours.events().back().lambda * (1 - 1e-9)) break;
      if (event.other_answers > 0) ++ambiguous;
      if (event.other_answers < 0) ++unknown;
      // Pivots may find another one of several answers.
      if (event.other_answers != 0 && (event.contact != dense.events[k].contact || event.mode != dense.events[k].mode))
        break;
      CAPTURE(k, dense.events[k].lambda, event.lambda, event.ties, to_string(event.mode),
              to_string(dense.events[k].mode), event.contact, dense.events[k].contact, found);
      CHECK(event.lambda == Approx(dense.events[k].lambda).epsilon(1e-8).margin(1e-9));
      CHECK(event.contact == dense.events[k].contact);
      CHECK(event.mode == dense.events[k].mode);
      if (event.contact != dense.events[k].contact || event.mode != dense.events[k].mode) break;
      ++seen[to_string(event.mode)];
      ++compared;
    }
  }
  CAPTURE(compared, ambiguous, unknown, not_found, loose, seen);
  CHECK(compared > 900);
  for (const char* mode : {"tension", "shear", "open", "close", "slip", "stick"}) CHECK(seen[mode] > 20);
}

TEST_CASE("contacts_that_change_without_end_at_one_state_end_the_path_with_a_sentence") {
  // Cells in which every contact slips: whatever the rates choose, another contact reaches its limit at once.
  for (const std::uint64_t seed : {5304, 4089, 1584}) {
    const DrawnPacking d = draw_packing(seed);
    CAPTURE(d.name);
    Unbonded ours(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    std::int64_t steps = 0;
    while (steps < 3000 && ours.run().advance()) ++steps;
    CAPTURE(steps, ours.run().why(), ours.run().lambda(), ours.run().state().relative_residual());
    CHECK(steps < 3000);
    const bool sentence = ours.run().end() == PathEnd::no_answer || ours.run().end() == PathEnd::not_balanced;
    CHECK(sentence);
    CHECK_FALSE(ours.run().why().empty());
    for (const BreakEvent& event : ours.events()) CHECK(event.relative_residual < 1e-9);
  }
}
