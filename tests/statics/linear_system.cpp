// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The equations handed to other solvers are those that the program solves.
#include "equidem/statics/linear_system.hpp"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "equidem/assembly/lattices.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/motions.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using Matrix = Eigen::SparseMatrix<double>;

Matrix eigen_matrix(const CompressedColumns& k) {
  using Long = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;
  return Matrix(Eigen::Map<const Long>(k.size, k.size, k.first.back(), k.first.data(), k.rows.data(), k.values.data()));
}

std::vector<double> solved_by_eigen(const LinearSystem& system, std::size_t right_hand_side) {
  if (system.size() == 0) return {};
  const auto k = eigen_matrix(with_upper_triangle(system.stiffness));
  const Eigen::SparseLU<Matrix> factor(k);
  REQUIRE(factor.info() == Eigen::Success);
  const std::vector<double>& given = system.right_hand_sides[right_hand_side];
  const Eigen::VectorXd f = Eigen::VectorXd::Map(given.data(), static_cast<Eigen::Index>(given.size()));
  Eigen::VectorXd u = factor.solve(f);
  u += factor.solve(f - k * u);
  return {u.data(), u.data() + u.size()};
}

}  // namespace

TEST_CASE("eigen_solves_the_equations_that_are_handed_to_it_as_the_program_does") {
  for (const HeldScene& scene : held_scenes()) {
    std::vector<Support> supports = scene.supports;
    supports.front().ux = 1e-3;
    const std::vector<LoadCase> cases{{{.group = "a", .kind = LoadKind::per_disc, .force = {1e5, -3e4}}},
                                      {{.group = "b", .kind = LoadKind::per_disc, .force = {-5e4, 7e4}}}};
    const LinearSystem system =
        equilibrium_system(scene.assembly(), scene.springs, supports, cases, scene.options.rotation);
    REQUIRE(system.right_hand_sides.size() == cases.size());
    for (std::size_t k = 0; k < cases.size(); ++k) {
      EquilibriumOptions options = scene.options;
      options.error_bound = true;
      const Equilibrium ours = solve_equilibrium(scene.assembly(), scene.springs, supports, cases[k], options);
      Equilibrium theirs;
      theirs.motions = system.motions(solved_by_eigen(system, k));
      const double difference = largest_difference(scene.assembly(), theirs, ours);
      CAPTURE(scene.name, k, system.size(), ours.condition, difference);
      CHECK(system.size() == ours.unknowns);
      // Entries of K are rounded to doubles; the program refines by the contact law, which has no entries.
      CHECK(difference < std::max(1e-10, 0x1.0p-52 * ours.condition));
    }
  }
}

TEST_CASE("the_compressed_rows_are_sorted_symmetric_and_eigen_takes_either_triangle") {
  const Assembly block = hexagonal_lattice({.columns = 6, .rows = 5});
  const LinearSystem system = equilibrium_system(block, ContactSprings(SpringConstants{1e9, 0.4e9}),
                                                 {{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}}}, {});
  const CompressedColumns full = with_upper_triangle(system.stiffness);
  REQUIRE(full.first.size() == static_cast<std::size_t>(system.size()) + 1);
  CHECK(full.first.back() == 2 * system.stiffness.first.back() - system.size());
  for (std::int64_t row = 0; row < full.size; ++row)
    CHECK(std::is_sorted(full.rows.begin() + full.first[row], full.rows.begin() + full.first[row + 1]));
  const auto whole = eigen_matrix(full), lower = eigen_matrix(system.stiffness);
  const Matrix mirrored = lower.selfadjointView<Eigen::Lower>();
  CHECK((whole - Matrix(whole.transpose())).norm() == 0);
  CHECK((whole - mirrored).norm() == 0);
}
