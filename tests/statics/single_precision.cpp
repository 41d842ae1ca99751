// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// States of rest with a factor in single precision are those with one in double precision.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/motions.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const std::vector<Support> left_side{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
const LoadCase pull{{.group = "right", .kind = LoadKind::total, .force = {1e5, -3e4}}};

EquilibriumOptions with(FactorPrecision precision, Rotation rotation = Rotation::from_scene) {
  EquilibriumOptions options{.rotation = rotation, .solver = {}, .error_bound = true};
  options.solver.precision = precision;
  return options;
}

bool is_single(const Equilibrium& state) {
  return state.single_precision && state.solver == "multifrontal Cholesky in single precision";
}

}  // namespace

TEST_CASE("single_and_double_precision_of_the_factor_give_the_same_state") {
  int singles = 0;
  for (const HeldScene& scene : held_scenes()) {
    Assembly assembly = scene.assembly();
    assembly.groups["loaded"].discs = {static_cast<std::int32_t>(assembly.size() / 2)};
    const LoadCase loads{{.group = "loaded", .force = {1e5, 4e4}}};
    const auto solved = [&](FactorPrecision precision) {
      return solve_equilibrium(assembly, scene.springs, scene.supports, loads, with(precision, scene.options.rotation));
    };
    const Equilibrium single = solved(FactorPrecision::single_precision);
    const Equilibrium twofold = solved(FactorPrecision::double_precision);
    const double off = relative_difference(assembly, single, twofold);
    CAPTURE(scene.name, single.solver, off, single.relative_residual, single.error_bound, twofold.error_bound,
            single.condition, twofold.condition);
    CHECK(off <= single.error_bound + twofold.error_bound);
    CHECK(single.relative_residual <= 1e-15);
    CHECK(single.error_bound <= 2 * twofold.error_bound + 1e-15);
    CHECK(single.unstable_modes == twofold.unstable_modes);
    CHECK(single.negative_pivots == twofold.negative_pivots);
    CHECK((is_single(single) || scene.springs.any_negative() || single.solver.find("since") != std::string::npos));
    singles += is_single(single) ? 1 : 0;
  }
  CAPTURE(singles);
  CHECK(singles > 20);
}

TEST_CASE("single_precision_has_the_same_bits_for_every_number_of_threads") {
  const Assembly assembly = hexagonal_lattice({.columns = 60, .rows = 60});
  const auto solved = [&](int threads) {
    const ThreadsFor some(threads);
    return solve_equilibrium(assembly, ContactSprings({1e9, 0.5e9}), left_side, pull,
                             with(FactorPrecision::single_precision));
  };
  const Equilibrium one = solved(1), two = solved(2);
  REQUIRE(is_single(one));
  CHECK(std::memcmp(one.motions.data(), two.motions.data(), one.motions.size() * sizeof(DiscMotion)) == 0);
  CHECK(one.error_bound == two.error_bound);
}

TEST_CASE("large_factors_are_in_single_precision_by_themselves") {
  const auto solved = [](int columns, int max_refinements) {
    EquilibriumOptions options = with(FactorPrecision::automatic);
    options.solver.method = SolverMethod::multifrontal;
    options.solver.max_refinements = max_refinements;
    return solve_equilibrium(hexagonal_lattice({.columns = columns, .rows = columns}), ContactSprings({1e9, 0.5e9}),
                             left_side, pull, options);
  };
  const Equilibrium small = solved(40, 4), large = solved(150, 4), unrefined = solved(150, 0);
  CAPTURE(small.solver, large.solver, large.relative_residual, large.refinements);
  CHECK(small.solver == "multifrontal Cholesky");
  CHECK(is_single(large));
  CHECK(large.relative_residual <= 1e-15);
  CHECK(large.refinements <= 8);
  CHECK(unrefined.solver == "multifrontal Cholesky");
}

TEST_CASE("where_single_precision_does_not_serve_double_does_and_the_report_says_why") {
  struct Case {
    std::string name;
    Assembly assembly;
    ContactSprings springs;
    std::string reason;
  };
  const Assembly block = hexagonal_lattice({.columns = 20, .rows = 20});
  Random random(5);
  std::vector<SpringConstants> decades(block.contacts.size());
  for (SpringConstants& k : decades) {
    k.kN = std::pow(10.0, random.uniform(0, 10));
    k.kT = 0.3 * k.kN;
  }
  const std::vector<Case> cases{
      {"slender strip", hexagonal_lattice({.columns = 4000, .rows = 2}), ContactSprings({1e9, 0.5e9}), "a pivot fell"},
      {"ten decades of springs", block, ContactSprings(decades), "stiffnesses differ"},
      {"small tangential springs", block, ContactSprings({1e9, 1.0}), "stiffnesses differ"},
  };
  for (const Case& one : cases) {
    const auto solved = [&](FactorPrecision precision) {
      return solve_equilibrium(one.assembly, one.springs, left_side, pull, with(precision));
    };
    const Equilibrium single = solved(FactorPrecision::single_precision);
    const Equilibrium twofold = solved(FactorPrecision::double_precision);
    CAPTURE(one.name, single.solver);
    CHECK(single.solver.find("multifrontal Cholesky in double precision, since " + one.reason) == 0);
    CHECK(relative_difference(one.assembly, single, twofold) == 0);
    CHECK(single.error_bound == twofold.error_bound);
    CHECK(single.condition == twofold.condition);
  }
}

TEST_CASE("mechanisms_are_named_whatever_the_precision") {
  // A square lattice without tangential springs shears at no cost; one whose tangential springs are soft nearly does.
  const Assembly square = square_lattice({.columns = 30, .rows = 30});
  const auto refused = [&](FactorPrecision precision) {
    return refusal_of([&] {
      static_cast<void>(solve_equilibrium(square, ContactSprings({1e9, 0.0}), left_side, pull, with(precision)));
    });
  };
  const Refusal single = refused(FactorPrecision::single_precision),
                twofold = refused(FactorPrecision::double_precision);
  CAPTURE(single.message, twofold.message);
  CHECK(single.says("mechanism"));
  CHECK(single.message == twofold.message);
}

TEST_CASE("moduli_do_not_depend_on_the_precision_of_the_factor") {
  for (const AssemblyKind& kind : assembly_kinds()) {
    if (!kind.assembly.periodic() || !kind.triangulated) continue;
    const auto moduli = [&](FactorPrecision precision) {
      HomogenizeOptions options;
      options.solver.precision = precision;
      return effective_stiffness(kind.assembly, ContactSprings({1e9, 0.4e9}), options);
    };
    const EffectiveStiffness single = moduli(FactorPrecision::single_precision);
    const EffectiveStiffness twofold = moduli(FactorPrecision::double_precision);
    double off = 0, size = 0;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        off = std::max(off, std::abs(single.stiffness[r][c] - twofold.stiffness[r][c]));
        size = std::max(size, std::abs(twofold.stiffness[r][c]));
      }
    }
    CAPTURE(kind.name, single.solver, off / size);
    CHECK(off <= 1e-13 * size);
    CHECK(single.local_mechanisms == twofold.local_mechanisms);
  }
}
