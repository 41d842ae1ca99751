// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// States of rest by method = "multigrid" are those of elimination.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/motions.hpp"
#include "support/off_line_networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// An assembly large enough for grids, with the groups "anchor" and "loaded" where it is periodic.
struct Sample {
  std::string name;
  Assembly assembly;
  bool stands_without_tangential = true;
};

Assembly network(PointProcess points, bool periodic, bool equal) {
  return delaunay_assembly({.discs = 600,
                            .points = points,
                            .disorder = 0.2,
                            .seed = 4,
                            .radii = {.smallest = 0.004, .largest = equal ? 0.004 : 0.008},
                            .aspect = 1.5,
                            .periodic = periodic});
}

/// Every tenth contact left out.
Assembly diluted(Assembly assembly) {
  std::vector<Contact> contacts;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    if (c % 10 != 3) contacts.push_back(assembly.contacts[c]);
  }
  assembly.contacts = std::move(contacts);
  assembly.facet_lengths.clear();
  return assembly;
}

std::vector<Sample> samples() {
  std::vector<Sample> all;
  for (const bool periodic : {false, true}) {
    const std::string boundary = periodic ? ", periodic" : ", free";
    all.push_back({"hexagonal" + boundary, hexagonal_lattice({.columns = 22, .rows = 20, .periodic = periodic})});
    all.push_back({"square" + boundary, square_lattice({.columns = 17, .rows = 15, .periodic = periodic}), false});
    for (const bool equal : {true, false}) {
      for (const PointProcess points :
           {PointProcess::uniform, PointProcess::poisson_disc, PointProcess::perturbed_hexagonal}) {
        all.push_back({std::string(to_string(points)) + (equal ? ", equal discs" : ", unequal discs") + boundary,
                       network(points, periodic, equal)});
      }
    }
    all.push_back({"diluted" + boundary, diluted(network(PointProcess::poisson_disc, periodic, true)), false});
    all.push_back({"off the lines of centres" + boundary,
                   off_line(network(PointProcess::poisson_disc, periodic, true), 3), false});
  }
  for (Sample& sample : all) {
    auto& groups = sample.assembly.groups;
    groups["anchor"].discs = {0};
    groups["loaded"].discs = {static_cast<std::int32_t>(sample.assembly.size() / 2 + 7)};
  }
  return all;
}

/// Springs of each contact, three decades apart.
ContactSprings scattered(const Assembly& assembly, double ratio) {
  Random random(2);
  std::vector<SpringConstants> each(assembly.contacts.size());
  for (SpringConstants& k : each) {
    k.kN = std::pow(10.0, random.uniform(7, 10));
    k.kT = ratio * k.kN;
  }
  return ContactSprings(std::move(each));
}

EquilibriumOptions by(SolverMethod method, Rotation rotation = Rotation::from_scene) {
  EquilibriumOptions options{.rotation = rotation, .solver = {}};
  options.solver.method = method;
  return options;
}

void check_same(const std::string& name, const Assembly& assembly, const ContactSprings& springs,
                const std::vector<Support>& supports, const LoadCase& loads, Rotation rotation = Rotation::from_scene) {
  const Equilibrium direct =
      solve_equilibrium(assembly, springs, supports, loads, by(SolverMethod::multifrontal, rotation));
  const Equilibrium ours = solve_equilibrium(assembly, springs, supports, loads, by(SolverMethod::multigrid, rotation));
  const double off = largest_difference(assembly, ours, direct);
  CAPTURE(name, off, ours.iterations, ours.relative_residual, direct.relative_residual);
  CHECK(off < 1e-10);
  CHECK(ours.energy == Approx(direct.energy).epsilon(1e-10));
  CHECK(ours.relative_residual <= 1e-12);
  CHECK(ours.unknowns == direct.unknowns);
  CHECK_FALSE(ours.negative_pivots);
  CHECK(ours.unstable_modes == 0);
  CHECK(ours.solver != direct.solver);
}

std::vector<Support> supports_of(const Assembly& assembly) {
  if (assembly.periodic()) return {{.group = "anchor", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  return {{.group = "left", .ux = 1e-4, .uy = 0.0, .rotation = 0.0}};
}

}  // namespace

TEST_CASE("multigrid_finds_the_states_of_rest_of_elimination") {
  for (const Sample& sample : samples()) {
    const LoadCase loads{{.group = "loaded", .kind = LoadKind::per_disc, .force = {1e5, -3e4}}};
    for (const double ratio : {0.5, 0.01, 0.0}) {
      if (ratio == 0 && !sample.stands_without_tangential) continue;
      for (const Rotation rotation : {Rotation::free, Rotation::restrained}) {
        if (rotation == Rotation::restrained && ratio == 0) continue;
        const std::string name = sample.name + ", kT/kN = " + std::to_string(ratio) +
                                 (rotation == Rotation::free ? ", rotation free" : ", rotation restrained");
        check_same(name, sample.assembly, ContactSprings({1e9, ratio * 1e9}), supports_of(sample.assembly), loads,
                   rotation);
      }
    }
    check_same(sample.name + ", scattered springs", sample.assembly, scattered(sample.assembly, 0.3),
               supports_of(sample.assembly), loads);
  }
}

TEST_CASE("multigrid_refuses_negative_springs_and_floppy_networks") {
  const Assembly assembly = hexagonal_lattice({.columns = 20, .rows = 20});
  const std::vector<Support> left{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  const Refusal negative = refusal_of([&] {
    static_cast<void>(solve_equilibrium(assembly, ContactSprings({1e9, -1e8}), left, {}, by(SolverMethod::multigrid)));
  });
  CAPTURE(negative.message);
  CHECK(negative.kind == ErrorKind::bad_input);
  CHECK(negative.says("'multigrid' cannot solve this case"));
  CHECK(negative.says("some kT is negative"));
  const Refusal floppy = refusal_of([&] {
    static_cast<void>(solve_equilibrium(square_lattice({.columns = 17, .rows = 17}), ContactSprings({1e9, 0.0}), left,
                                        {}, by(SolverMethod::multigrid)));
  });
  CAPTURE(floppy.message);
  CHECK(floppy.kind == ErrorKind::computation_failed);
  CHECK(floppy.says("method = \"multifrontal\""));
}
