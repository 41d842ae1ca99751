// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motions in words, and the quotient of energies that distinguishes a mechanism from a soft mode.
#include "equidem/statics/motion_description.hpp"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double radius = 0.005;

Assembly hexagonal(int columns, int rows, bool periodic = false) {
  return hexagonal_lattice({.columns = columns, .rows = rows, .radius = radius, .periodic = periodic});
}

Assembly square_block(int columns, int rows) {
  return square_lattice({.columns = columns, .rows = rows, .radius = radius});
}

std::vector<DiscMotion> rigid_motion(const Assembly& assembly, Vec2 t, double omega, Vec2 about) {
  std::vector<DiscMotion> motions;
  for (const Vec2 x : assembly.centres) motions.push_back({t + omega * perpendicular(x - about), omega});
  return motions;
}

/// theta = +-1 on the squares of a chess board.
std::vector<DiscMotion> gears(const Assembly& square_assembly) {
  std::vector<DiscMotion> motions;
  for (const Vec2 x : square_assembly.centres) {
    const auto square = static_cast<int>(x.x / (2 * radius)) + static_cast<int>(x.y / (2 * radius));
    motions.push_back({{}, square % 2 == 0 ? 1.0 : -1.0});
  }
  return motions;
}

/// The eigenvector of the smallest eigenvalue of K + shift max(diag K) by inverse iteration, as motions.
std::vector<DiscMotion> softest_mode(const Assembly& assembly, const ContactSprings& springs,
                                     const DegreesOfFreedom& unknowns, double shift) {
  const ContactGraph graph(assembly);
  const CompressedColumns columns =
      compress(assemble_stiffness(assembly, graph, springs, unknowns), assembly, graph, unknowns);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::int64_t c = 0; c < columns.size; ++c) {
    entries.emplace_back(c, c, shift * springs.largest());
    for (std::int64_t e = columns.first[c]; e < columns.first[c + 1]; ++e)
      entries.emplace_back(columns.rows[e], c, columns.values[e]);
  }
  Eigen::SparseMatrix<double> K(columns.size, columns.size);
  K.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(K);  // reads the lower triangle
  REQUIRE(factor.info() == Eigen::Success);
  Random random(3);
  Eigen::VectorXd x(columns.size);
  for (double& value : x) value = random.uniform(-1, 1);
  for (int iteration = 0; iteration < 30; ++iteration) x = factor.solve(x).eval().normalized();
  std::vector<DiscMotion> motions(assembly.size());
  for (std::int64_t c = 0; c < columns.size; ++c) {
    const std::int64_t k = columns.component[c] % unknowns.per_disc;
    DiscMotion& m = motions[columns.component[c] / unknowns.per_disc];
    (k == 0 ? m.u.x : k == 1 ? m.u.y : m.theta) = k == 2 ? x[c] / unknowns.rotation_scale : x[c];
  }
  return motions;
}

/// The first row held in all components.
DegreesOfFreedom clamp_first_row(const Assembly& assembly, int columns, int per_disc) {
  DegreesOfFreedom unknowns;
  unknowns.per_disc = per_disc;
  unknowns.rotation_scale = assembly.mean_radius();
  unknowns.held.assign(assembly.size() * per_disc, 0);
  unknowns.prescribed.assign(unknowns.held.size(), 0.0);
  std::fill_n(unknowns.held.begin(), columns * per_disc, std::uint8_t{1});
  return unknowns;
}

}  // namespace

TEST_CASE("a_motion_is_named_by_the_disc_that_moves_most") {
  const Assembly assembly = hexagonal(5, 6);
  std::vector<DiscMotion> motions(assembly.size());
  CHECK(describe_motion(assembly, motions) == "no motion");
  motions[3].u = {0.3, 0.4};
  motions[7].u = {-0.1, 0};
  motions[9].theta = 1e-9 / radius;  // at rest beside the others
  const std::string moves =
      "a motion of 2 of 27 discs, most of all of " + describe_disc(assembly, 3) + ", which moves along (0.6, 0.8)";
  for (const double scale : {1.0, -1.0, 0x1p-400, 0x1p+400}) {
    std::vector<DiscMotion> scaled = motions;
    for (DiscMotion& m : scaled) m = {scale * m.u, scale * m.theta};
    CHECK(describe_motion(assembly, scaled) == moves);
  }
  motions[9].theta = -1 / radius;
  CHECK(describe_motion(assembly, motions) ==
        "a motion of 3 of 27 discs, most of all of " + describe_disc(assembly, 9) + ", which turns");
  CHECK(describe_direction({-2, 1e-9}) == "x");
}

TEST_CASE("mechanisms_have_no_stiffness_but_rounding") {
  Random random(11);
  SECTION("rigid motions, far from the origin too") {
    Assembly assembly = hexagonal(40, 25);
    const Vec2 shift = GENERATE(Vec2{0, 0}, Vec2{50, -20});
    for (Vec2& x : assembly.centres) x += shift;
    for (Contact& c : assembly.contacts) c.lever_i = c.lever_j = 0.5 * norm(assembly.branch(c));
    const auto motions = rigid_motion(assembly, {0.3, 0.1}, 0.7, {0.1, 0.2});
    const double quotient = softness(assembly, ContactSprings(SpringConstants{1e9, 0.4e9}), motions);
    CAPTURE(quotient, shift.x);
    CHECK(quotient >= 0);
    CHECK(quotient < 1e-27);
  }
  SECTION("gears") {
    const Assembly assembly = square_block(30, 30);
    const double kT = GENERATE(1e9, 1.0, -1e8);
    CHECK(std::abs(softness(assembly, ContactSprings(SpringConstants{1e9, kT}), gears(assembly))) < 1e-28);
  }
  SECTION("the shear of a square lattice without tangential springs, computed from its singular matrix") {
    const Assembly assembly = square_block(10, 30);
    const ContactSprings springs(SpringConstants{1e9, 0});
    const DegreesOfFreedom unknowns = clamp_first_row(assembly, 10, 2);
    const auto motions = softest_mode(assembly, springs, unknowns, 1e-13);
    const double quotient = softness(assembly, springs, motions);
    CAPTURE(quotient);
    CHECK(std::abs(quotient) < 1e-24);
  }
}

TEST_CASE("soft_modes_stay_above_mechanisms") {
  // The slender cantilever: its first bending mode is the softest stable mode of all shapes.
  struct Strip {
    int columns, rows;
    double kT;
  };
  const Strip strip = GENERATE(Strip{2, 660, 0.5e9}, Strip{3, 400, 0.5e9}, Strip{3, 400, 1e5}, Strip{11, 95, 0.5e9});
  const Assembly assembly = hexagonal(strip.columns, strip.rows);
  const ContactSprings springs(SpringConstants{1e9, strip.kT});
  const DegreesOfFreedom unknowns = clamp_first_row(assembly, strip.columns, 3);
  const auto motions = softest_mode(assembly, springs, unknowns, 0);
  const double quotient = softness(assembly, springs, motions);
  CAPTURE(assembly.size(), strip.columns, strip.kT, quotient);
  CHECK(quotient > 1e-16);
  CHECK(quotient < 1e-6);
}

TEST_CASE("the_energy_of_a_motion_is_the_quadratic_form_of_K") {
  const Assembly assembly = hexagonal(5, 5);
  const ContactSprings springs(SpringConstants{1e9, GENERATE(0.3e9, -0.2e9)});
  DegreesOfFreedom unknowns = clamp_first_row(assembly, 0, 3);
  const ContactGraph graph(assembly);
  const StiffnessMatrix K = assemble_stiffness(assembly, graph, springs, unknowns);
  Random random(5);
  std::vector<DiscMotion> motions(assembly.size());
  std::vector<double> x(3 * assembly.size()), y(3 * assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    motions[d] = {{random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(-1, 1) / radius};
    x[3 * d] = motions[d].u.x;
    x[3 * d + 1] = motions[d].u.y;
    x[3 * d + 2] = unknowns.rotation_scale * motions[d].theta;
  }
  multiply(K, assembly, graph, x, y);
  double form = 0;
  for (std::size_t k = 0; k < x.size(); ++k) form += 0.5 * x[k] * y[k];
  CHECK(elastic_energy(assembly, springs, motions) == Approx(form).epsilon(1e-12));
}
