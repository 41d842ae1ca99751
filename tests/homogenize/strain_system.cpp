// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The equations of a periodic cell that are handed to other solvers.
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/sample_solver.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

using SparseK = Eigen::SparseMatrix<double>;

SparseK eigen_matrix(const CompressedColumns& k) {
  using Long = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;
  return SparseK(
      Eigen::Map<const Long>(k.size, k.size, k.first.back(), k.first.data(), k.rows.data(), k.values.data()));
}

}  // namespace

TEST_CASE("eigen_finds_the_fluctuations_of_a_periodic_cell_under_each_mean_strain") {
  const Rotation rotation = GENERATE(Rotation::free, Rotation::restrained);
  for (const Assembly& cell : {delaunay_assembly({.discs = 70, .periodic = true}),
                               hexagonal_lattice({.columns = 4, .rows = 4, .periodic = true})}) {
    const ContactSprings springs(SpringConstants{1e9, 0.3e9});
    const EffectiveStiffness ours = effective_stiffness(cell, springs, {.rotation = rotation});
    const LinearSystem system = strain_system(cell, springs, rotation);
    CHECK(system.size() == ours.unknowns);
    REQUIRE(system.right_hand_sides.size() == (rotation == Rotation::free ? 3 : 4));
    REQUIRE(system.names.size() == system.right_hand_sides.size());
    const auto k = eigen_matrix(with_upper_triangle(system.stiffness));
    const Eigen::SparseLU<SparseK> factor(k);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::vector<double>& given = system.right_hand_sides[c];
      const Eigen::VectorXd f = Eigen::VectorXd::Map(given.data(), static_cast<Eigen::Index>(given.size()));
      Eigen::VectorXd u = factor.solve(f);
      u += factor.solve(f - k * u);
      const std::vector<DiscMotion> motions = system.motions({u.data(), static_cast<std::size_t>(u.size())});
      double off = 0;
      for (std::size_t d = 0; d < cell.size(); ++d) off = std::max(off, norm(motions[d].u - ours.fluctuations[c][d].u));
      CAPTURE(cell.kind, system.names[c], off);
      CHECK(off < 1e-10 * cell.mean_radius());
    }
  }
}
