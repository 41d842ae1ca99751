// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Moduli by method = "multigrid" are those of elimination.
#include <string>

#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/calibrate/calibrate.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace samples;

namespace {

EffectiveStiffness stiffness_by(SolverMethod method, const Assembly& assembly, const ContactSprings& springs,
                                Boundary boundary, Rotation rotation) {
  HomogenizeOptions options{.boundary = boundary, .rotation = rotation, .solver = {}};
  options.solver.method = method;
  return effective_stiffness(assembly, springs, options);
}

Assembly random_cell(bool periodic) {
  return delaunay_assembly(
      {.discs = 700, .seed = 8, .radii = {.smallest = 0.004, .largest = 0.006}, .periodic = periodic});
}

}  // namespace

TEST_CASE("multigrid_finds_the_moduli_of_elimination") {
  for (const Boundary boundary : {Boundary::periodic, Boundary::displacement, Boundary::traction}) {
    const bool periodic = boundary == Boundary::periodic;
    for (const Sample& sample :
         {Sample{"random", random_cell(periodic)},
          Sample{"hexagonal", hexagonal_lattice({.columns = 22, .rows = 20, .periodic = periodic})}}) {
      for (const Rotation rotation : {Rotation::free, Rotation::restrained}) {
        for (const double ratio : {0.4, 0.0}) {
          if (ratio == 0 && rotation == Rotation::restrained) continue;
          const ContactSprings springs({1e9, ratio * 1e9});
          const auto by = [&](SolverMethod method) {
            return stiffness_by(method, sample.assembly, springs, boundary, rotation);
          };
          const EffectiveStiffness direct = by(SolverMethod::multifrontal), ours = by(SolverMethod::multigrid);
          const double off = relative_difference(ours.stiffness, direct.stiffness);
          CAPTURE(sample.name, to_string(boundary), ratio, rotation == Rotation::free, off, ours.iterations,
                  ours.condition, direct.condition);
          CHECK(off < 1e-10);
          CHECK(off * largest_entry(direct.stiffness) < ours.error_bound + direct.error_bound);
          CHECK(ours.relative_residual <= 1e-12);
          CHECK_FALSE(ours.negative_pivots);
          CHECK(ours.unstable_modes == 0);
        }
      }
    }
  }
}

TEST_CASE("multigrid_calibrates_the_springs_of_elimination_in_half_the_iterations") {
  for (const bool periodic : {true, false}) {
    const Assembly assembly = random_cell(periodic);
    for (const double nu : {-0.3, 0.1, 0.2}) {
      const auto by = [&](SolverMethod method) {
        return calibrate(assembly, {2.5e7, nu, Plane::strain}, {.homogenize = {.solver = {.method = method}}});
      };
      const Calibration direct = by(SolverMethod::multifrontal), ours = by(SolverMethod::multigrid);
      const EffectiveStiffness to_round_off =
          stiffness_by(SolverMethod::multigrid, assembly, ContactSprings(direct.springs),
                       periodic ? Boundary::periodic : Boundary::displacement, Rotation::from_scene);
      CAPTURE(periodic, nu, direct.springs.kN, ours.springs.kN, ours.achieved.iterations, to_round_off.iterations);
      CHECK(ours.springs.kN == Approx(direct.springs.kN).epsilon(2e-11));
      CHECK(ours.springs.kT == Approx(direct.springs.kT).epsilon(5e-10));
      CHECK(2 * ours.achieved.iterations <= to_round_off.iterations);
    }
  }
}

TEST_CASE("lattices_at_rest_under_a_mean_strain_take_few_iterations") {
  const Assembly cell = hexagonal_lattice({.columns = 60, .rows = 60, .periodic = true});
  const ContactSprings springs({1e9, 0.4e9});
  const EffectiveStiffness ours =
      stiffness_by(SolverMethod::multigrid, cell, springs, Boundary::periodic, Rotation::free);
  const Matrix3 voigt = voigt_stiffness(cell, springs);  // exact for this lattice
  const double off = relative_difference(ours.stiffness, voigt);
  CAPTURE(off, ours.iterations, ours.error_bound, ours.relative_residual);
  CHECK(off < 1e-13);
  CHECK(off * largest_entry(voigt) <= ours.error_bound);
  CHECK(ours.iterations <= 12);
}

TEST_CASE("bits_of_moduli_by_multigrid_are_those_of_one_thread") {
  const Assembly cell = delaunay_assembly({.discs = 20000, .seed = 4, .periodic = true});
  const ContactSprings springs({1e9, 0.4e9});
  const auto on = [&](int threads) {
    const test::ThreadsFor only(threads);
    return stiffness_by(SolverMethod::multigrid, cell, springs, Boundary::periodic, Rotation::restrained);
  };
  const EffectiveStiffness one = on(1);
  for (const int threads : {2, 3}) {
    const EffectiveStiffness other = on(threads);
    CAPTURE(threads, one.error_bound, other.error_bound);
    CHECK(one.stiffness == other.stiffness);
    CHECK(one.gradient_stiffness == other.gradient_stiffness);
    CHECK(one.error_bound == other.error_bound);
  }
}
