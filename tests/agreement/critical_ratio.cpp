// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stability of Abe's tension test (1996, Fig. 6) for kT < 0, by inertia, against dense algebra.
#include <cmath>
#include <cstdint>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/internal_force.hpp"

#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/fields.hpp"
#include "support/sturm.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Block {
  Assembly assembly;
  TensionSetup setup;

  explicit Block(int size)
      : assembly(hexagonal_lattice({.columns = size, .rows = size})), setup(tension_setup(assembly, {})) {}

  [[nodiscard]] Equilibrium solved(double ratio) const {
    const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
    return solve_equilibrium(assembly, springs, setup.supports, setup.loads);
  }
  /// Signs of the eigenvalues of the dense stiffness, column by column from the contact law; held components left out.
  [[nodiscard]] Signs dense_signs(double ratio) const {
    const ContactSprings springs(SpringConstants{1, ratio});
    const ContactGraph graph(assembly);
    const DegreesOfFreedom unknowns =
        number_unknowns(assembly, springs, derive_effects(springs, Rotation::free), setup.supports);
    std::vector<std::size_t> free;
    for (std::size_t k = 0; k < unknowns.held.size(); ++k) {
      if (unknowns.held[k] == 0) free.push_back(k);
    }
    DenseMatrix k(free.size());
    std::vector<ContactForce> forces(assembly.contacts.size());
    std::vector<double> f(unknowns.held.size());
    for (std::size_t c = 0; c < free.size(); ++c) {
      PreciseMotion unit(unknowns.held.size());
      unit.high[free[c]] = 1;
      contact_forces_of(assembly, springs, unknowns, unit, forces);
      internal_force(assembly, graph, unknowns, forces, f);
      for (std::size_t r = 0; r < free.size(); ++r) k(r, c) = f[free[r]];
    }
    return signs_of(k, 1e-13);
  }
};

}  // namespace

TEST_CASE("negative_pivots_are_the_negative_eigenvalues_of_the_dense_matrix") {
  const Block block(5);
  std::int64_t before = 0;
  for (const double ratio : {-0.01, -0.05, -0.1, -0.2, -0.3, -0.33, -0.34, -0.36, -0.4, -0.5, -0.7, -0.9}) {
    const Equilibrium state = block.solved(ratio);
    const Signs dense = block.dense_signs(ratio);
    CAPTURE(ratio, dense.negative, dense.zero, state.negative_pivots.value_or(-1), state.unstable_modes.value_or(-1),
            state.pivot_growth, state.relative_residual);
    CHECK(dense.zero == 0);
    CHECK(state.negative_pivots == dense.negative);
    CHECK(state.unstable_modes == dense.negative - static_cast<std::int64_t>(block.assembly.size()));
    CHECK(state.unstable_modes >= before);  // S = K_N + kT S_T only softens as kT falls
    CHECK(state.relative_residual < 1e-12);
    before = state.unstable_modes.value();
  }
  CHECK(before > 0);
}
