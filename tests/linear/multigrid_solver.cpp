// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Conjugate gradients with multigrid against elimination.
#include "equidem/linear/multigrid/multigrid_solver.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/rigid_growth.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A stiffness matrix that stays in place.
struct Network {
  const Assembly& assembly;
  const ContactSprings& springs;
  DegreesOfFreedom unknowns;
  ContactGraph graph;
  StiffnessMatrix matrix;

  Network(const Assembly& discs, const ContactSprings& k, const std::vector<Support>& supports,
          Rotation rotation = Rotation::from_scene)
      : assembly(discs),
        springs(k),
        unknowns(number_unknowns(discs, k, derive_effects(discs, k, rotation), supports)),
        graph(discs),
        matrix(assemble_stiffness(discs, graph, k, unknowns)) {}

  [[nodiscard]] std::unique_ptr<Factorization> multigrid(const multigrid::CycleOptions& options = {}) const {
    return multigrid_solver({assembly, graph, springs, unknowns}, options);
  }
  [[nodiscard]] std::unique_ptr<Factorization> elimination() const {
    return multifrontal_cholesky(
        std::make_shared<const SymbolicFactor>(analyze(dissect(assembly, graph), graph, unknowns.per_disc)),
        {matrix, assembly, graph});
  }
  [[nodiscard]] std::vector<double> solved(Factorization& factor, std::vector<double> load) const {
    for (std::size_t k = 0; k < load.size(); ++k) {
      if (unknowns.held[k] != 0) load[k] = 0;
    }
    factor.solve(load, 1);
    return load;
  }
};

const std::vector<Support> left_held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
const ContactSprings half_tangential({1e9, 0.5e9});

/// |x - y| over |y|, largest components.
double difference(std::span<const double> x, std::span<const double> y) {
  double off = 0;
  for (std::size_t k = 0; k < x.size(); ++k) off = std::max(off, std::abs(x[k] - y[k]));
  return largest(y) > 0 ? off / largest(y) : off;
}

std::int64_t iterations_for_a_pull(const Assembly& assembly) {
  const Network system(assembly, half_tangential, left_held);
  const auto solver = system.multigrid();
  std::vector<double> load(system.unknowns.held.size(), 0.0);
  for (const std::int32_t disc : group(assembly, "right").discs) {
    load[3 * disc] = 1;
    load[3 * disc + 1] = 0.3;
  }
  static_cast<void>(system.solved(*solver, load));
  return solver->report().iterations;
}

}  // namespace

TEST_CASE("the_error_of_a_solution_is_within_its_estimate_and_the_rounding_of_the_matrix") {
  constexpr double rounding = 2e-6;  // of the matrix in single precision, in the norm of energy
  for (const HeldScene& scene : held_scenes()) {
    if (scene.springs.any_negative()) continue;
    const Network system(scene.assembly(), scene.springs, scene.supports, scene.options.rotation);
    std::vector<double> x = random_vector(system.unknowns.held.size(), 12);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = system.unknowns.held[k] != 0 ? 0 : x[k];
    std::vector<double> error = system.solved(*system.elimination(), x), product_of_error(x.size());
    const auto solver = system.multigrid({.direct_below = 0});
    const Factorization::Energies energies = solver->solve_to(0, 0, x);
    for (std::size_t k = 0; k < x.size(); ++k) error[k] -= x[k];
    multiply(system.matrix, system.assembly, system.graph, error, product_of_error);
    const double of_error = product(error, product_of_error);
    CAPTURE(scene.name, of_error, energies.error, energies.solution);
    CHECK(of_error <= std::max(energies.error, rounding * rounding * energies.solution));
  }
}

TEST_CASE("iterations_stay_flat_from_1e3_to_1e5_discs") {
  for (const bool random : {false, true}) {
    std::vector<std::int64_t> iterations;
    for (const int columns : {32, 100, 316}) {
      iterations.push_back(iterations_for_a_pull(random ? delaunay_assembly({.discs = columns * columns})
                                                        : hexagonal_lattice({.columns = columns, .rows = columns})));
    }
    CAPTURE(random, iterations);
    CHECK(*std::max_element(iterations.begin(), iterations.end()) <= iterations[0] + 3);
    CHECK(iterations.back() <= 11);
  }
}

TEST_CASE("spacing_and_smoothing_change_iterations_but_not_the_answer") {
  const Assembly assembly = hexagonal_lattice({.columns = 40, .rows = 40});
  const Network system(assembly, half_tangential, left_held);
  const std::vector<double> load = random_vector(system.unknowns.held.size(), 7);
  const std::vector<double> wanted = system.solved(*system.elimination(), load);
  for (const multigrid::CycleOptions& options :
       {multigrid::CycleOptions{.spacing = 1}, {.spacing = 6}, {.degree = 1, .range = 3}, {.degree = 5, .range = 20}}) {
    CAPTURE(options.spacing, options.degree);
    CHECK(difference(system.solved(*system.multigrid(options), load), wanted) < 3e-5);
  }
}

TEST_CASE("networks_that_grow_rigid_have_no_motions_without_energy_but_rigid_ones") {
  for (const AssemblyKind& kind : assembly_kinds()) {
    for (const double ratio : {0.5, 0.0}) {
      const ContactSprings springs({1e9, ratio * 1e9});
      const ContactGraph graph(kind.assembly);
      const int per_disc = derive_effects(kind.assembly, springs, Rotation::from_scene).unknowns_per_disc();
      const bool rigid = grows_rigid(kind.assembly, graph, springs, per_disc);
      const DegreesOfFreedom unknowns = all_free(kind.assembly, per_disc);
      const StiffnessMatrix matrix = assemble_stiffness(kind.assembly, graph, springs, unknowns);
      const auto factor = multifrontal_ldlt(
          std::make_shared<const SymbolicFactor>(analyze(dissect(kind.assembly, graph), graph, per_disc)),
          {matrix, kind.assembly, graph});
      CAPTURE(kind.name, ratio, per_disc, rigid);
      if (rigid) CHECK(factor->report().zero_pivots <= (kind.assembly.periodic() ? 2 : 3));  // fewer: round-off
      if (kind.name.find("hexagonal") == 0) CHECK(rigid);
      if (kind.name.find("square") == 0) CHECK(!rigid);
    }
  }
}

TEST_CASE("pieces_far_apart_leave_the_grids_small") {
  Assembly assembly = hexagonal_lattice({.columns = 15, .rows = 15});
  const auto discs = static_cast<std::int32_t>(assembly.size());
  const std::vector<Contact> contacts = assembly.contacts;
  for (std::int32_t d = 0; d < discs; ++d) {
    assembly.centres.push_back(assembly.centres[d] + Vec2{2e4, 1e4});
    assembly.radii.push_back(assembly.radii[d]);
  }
  for (Contact c : contacts) {
    c.i += discs;
    c.j += discs;
    assembly.contacts.push_back(c);
  }
  std::vector<std::int32_t>& left = assembly.groups["left"].discs;
  for (std::size_t k = 0, held = left.size(); k < held; ++k) left.push_back(left[k] + discs);
  const Network network(assembly, half_tangential, left_held);
  const std::vector<double> load = random_vector(network.unknowns.held.size(), 9);
  double off = 0, bytes = 0;
  const Refusal refusal = refusal_of([&] {
    const auto solver = network.multigrid();
    bytes = solver->report().bytes;
    off = difference(network.solved(*solver, load), network.solved(*network.elimination(), load));
  });
  CAPTURE(refusal.message, off, bytes);
  CHECK((refusal.message.empty() ? off < 1e-4 : refusal.says("method = \"multifrontal\"")));
  CHECK(bytes < 5e6);
}
