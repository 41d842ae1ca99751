// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds that resist the relative rotation of their discs: beams, energy, lattices, all back ends.

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/rigidity.hpp"

#include "support/catch.hpp"
#include "support/dense_oracle.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double beam_radius = 0.5;
constexpr SpringConstants beam_springs{3, 0.7};
constexpr double beam_kM = 0.21;
const std::vector<Support> built_in{{.group = "root", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};

/// A row of touching discs along x; "root" is the first one, "tip" the last.
Assembly row_of_discs(int discs) {
  Assembly row = square_lattice({.columns = discs, .rows = 1, .radius = beam_radius});
  row.groups["root"].discs = {0};
  row.groups["tip"].discs = {discs - 1};
  return row;
}

/// Largest |value - wanted| over the largest |wanted|.
double off_by(const std::vector<double>& value, const std::vector<double>& wanted) {
  return relative_difference(value, wanted);
}

Assembly bonded_network(bool periodic) {
  return delaunay_assembly(
      {.discs = 60, .disorder = 0.3, .seed = 8, .radii = {.smallest = 0.3, .largest = 0.6}, .periodic = periodic});
}

std::vector<double> random_components(std::size_t count, unsigned seed) {
  Random random(seed);
  std::vector<double> x(count);
  for (double& value : x) value = random.uniform(-1, 1);
  return x;
}

}  // namespace

TEST_CASE("a_row_of_bonded_discs_is_a_discrete_beam") {
  for (const int discs : {2, 3, 12, 200}) {
    const Assembly row = row_of_discs(discs);
    const ContactSprings springs = bending_springs(row, ContactSprings(beam_springs), {.kM = beam_kM});
    const double P = 0.31, Q = 1.7, M0 = -0.13;
    LoadCase load{{.group = "tip", .kind = LoadKind::total, .force = {Q, P}, .moment = M0}};
    const Equilibrium rest = solve_equilibrium(row, springs, built_in, load);
    // The cut at a contact carries Q, P and the moment of the loads about it; disc j follows from disc i.
    double x = 0, y = 0, theta = 0, energy = 0;
    std::vector<double> motion{0, 0, 0}, moments;
    for (int j = 1; j < discs; ++j) {
      const double moment = M0 + P * (2 * beam_radius * (discs - 1) - (2 * j - 1) * beam_radius),
                   next = theta + moment / beam_kM;
      x += Q / beam_springs.kN;
      y += P / beam_springs.kT + beam_radius * (theta + next);
      theta = next;
      motion.insert(motion.end(), {x, y, theta});
      moments.push_back(moment);
      energy += 0.5 * (Q * Q / beam_springs.kN + P * P / beam_springs.kT + moment * moment / beam_kM);
    }
    std::vector<double> found;
    for (const DiscMotion& m : rest.motions) found.insert(found.end(), {m.u.x, m.u.y, m.theta});
    const double work = 0.5 * (Q * x + P * y + M0 * theta);
    CAPTURE(discs, rest.relative_residual, off_by(found, motion), off_by(rest.bending_moments, moments), energy);
    CHECK(off_by(found, motion) < 1e-12);
    CHECK(off_by(rest.bending_moments, moments) < 1e-12);
    CHECK(std::abs(rest.energy - energy) < 1e-12 * energy);
    CHECK(std::abs(work - energy) < 1e-12 * energy);
    REQUIRE(rest.reactions.size() == 1);
    const double root = M0 + P * 2 * beam_radius * (discs - 1);
    CHECK(std::abs(rest.reactions[0].moment + root) < 1e-12 * std::abs(root));
    CHECK(std::abs(rest.reactions[0].force.y + P) < 1e-12 * std::abs(root));
  }
}

TEST_CASE("long_beams_of_discs_are_beams_of_Timoshenko") {
  // EI = kM l and GA = kT l of a continuous beam: w = P L³/(3 EI) + P L/GA, and the row differs by the square of l/L.
  double before = 0;
  for (const int discs : {17, 33, 65}) {
    const Assembly row = row_of_discs(discs);
    const double length = 2 * beam_radius * (discs - 1), P = 1;
    const ContactSprings springs = bending_springs(row, ContactSprings(beam_springs), {.kM = beam_kM});
    const Equilibrium rest =
        solve_equilibrium(row, springs, built_in, {{.group = "tip", .kind = LoadKind::total, .force = {0, P}}});
    const double beam = P * length * length * length / (3 * beam_kM * 2 * beam_radius) +
                        P * length / (beam_springs.kT * 2 * beam_radius);
    const double difference = std::abs(rest.motions.back().u.y / beam - 1);
    CAPTURE(discs, difference, before);
    CHECK(difference < 1.1 / (4.0 * (discs - 1) * (discs - 1)));
    if (before > 0) CHECK(std::abs(before / difference - 4) < 0.1);
    before = difference;
  }
}

TEST_CASE("bending_springs_are_those_of_a_parallel_bond") {
  Assembly pair = row_of_discs(2);
  pair.radii = {0.5, 0.3};
  const double w = 0.8 * 2 * 0.3;
  const ContactSprings springs = bending_springs(pair, ContactSprings(beam_springs), {.bond_width = 0.8});
  CHECK(std::abs(springs.bending(0) - 3 * w * w / 12) < 1e-15);
  // Fibres across the width w, of stiffness kN/w per length, under a relative rotation of 1 rad.
  double moment = 0;
  constexpr int fibres = 20000;
  for (int k = 0; k < fibres; ++k) {
    const double y = ((k + 0.5) / fibres - 0.5) * w;
    moment += 3 / w * y * y * w / fibres;
  }
  CHECK(std::abs(springs.bending(0) - moment) < 1e-8 * moment);
}

TEST_CASE("the_tangent_with_bending_springs_is_the_derivative_of_the_force_and_of_the_energy") {
  for (const bool periodic : {false, true}) {
    const Assembly network = bonded_network(periodic);
    const ContactSprings springs = bending_springs(network, ContactSprings(beam_springs), {.bond_width = 0.9});
    const ContactGraph graph(network);
    const DegreesOfFreedom unknowns =
        number_unknowns(network, springs, derive_effects(network, springs, Rotation::free), {});
    const StiffnessMatrix K = assemble_stiffness(network, graph, springs, unknowns);
    const std::vector<double> x = random_components(3 * network.size(), 4);
    std::vector<double> Kx(x.size()), force(x.size());
    multiply(K, network, graph, x, Kx);
    PreciseMotion motion(0);
    motion.high = x;
    internal_force({network, graph, springs, unknowns}, motion, {}, force);
    double twice_energy = 0;
    for (std::size_t k = 0; k < x.size(); ++k) twice_energy += x[k] * Kx[k];
    const double energy = elastic_energy(network, springs, disc_motions(unknowns, x));
    const std::vector<double> sums = row_sums({network, graph, springs, unknowns});
    const DenseMatrix dense = dense_matrix(K, network);
    std::vector<double> dense_sums(sums.size());
    for (std::size_t r = 0; r < sums.size(); ++r)
      for (std::size_t c = 0; c < sums.size(); ++c) dense_sums[r] += std::abs(dense(r, c));
    // One contact alone, by differences of its energy.
    const double step = 1e-5, theta_i = 0.3, theta_j = -0.2;
    const double slope =
        (bending_energy(beam_kM, theta_i + step, theta_j) - bending_energy(beam_kM, theta_i - step, theta_j)) /
        (2 * step);
    CAPTURE(periodic, off_by(force, Kx), energy, off_by(sums, dense_sums), slope);
    CHECK(off_by(force, Kx) < 1e-13);
    CHECK(std::abs(2 * energy - twice_energy) < 1e-12 * energy);
    CHECK(off_by(sums, dense_sums) < 1e-13);
    CHECK(std::abs(slope + bending_moment(beam_kM, theta_i, theta_j)) < 1e-9);
  }
}

TEST_CASE("bending_springs_leave_gears_no_zero_energy_mode") {
  const Assembly block = square_lattice({.columns = 4, .rows = 3, .radius = beam_radius});
  const std::vector<Support> held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  CHECK_THROWS_AS(EquilibriumSolver(block, ContactSprings(beam_springs), held), Error);
  const ContactSprings springs = bending_springs(block, ContactSprings(beam_springs), {.kM = beam_kM});
  const Equilibrium rest =
      solve_equilibrium(block, springs, held, {{.group = "right", .kind = LoadKind::total, .force = {0.2, 0.1}}});
  CAPTURE(rest.relative_residual);
  CHECK(rest.relative_residual < 1e-14);
}

TEST_CASE("all_back_ends_find_the_same_state_of_bent_bonds") {
  const Assembly block =
      delaunay_assembly({.discs = 900, .disorder = 0.2, .seed = 3, .radii = {.smallest = 0.4, .largest = 0.6}});
  for (const BendingOptions& how : {BendingOptions{.kM = beam_kM}, BendingOptions{.bond_width = 1.2}}) {
    const ContactSprings springs = bending_springs(block, ContactSprings(beam_springs), how);
    const std::vector<Support> held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
    const LoadCase load{{.group = "right", .kind = LoadKind::total, .force = {0.3, 0.2}}};
    std::vector<double> first;
    double without = 0;
    for (const SolverMethod method :
         {SolverMethod::multifrontal, SolverMethod::cholmod, SolverMethod::umfpack, SolverMethod::multigrid}) {
      EquilibriumOptions options;
      options.solver.method = method;
      const Equilibrium rest = solve_equilibrium(block, springs, held, load, options);
      std::vector<double> found;
      for (const DiscMotion& m : rest.motions) found.insert(found.end(), {m.u.x, m.u.y, m.theta});
      if (first.empty()) {
        first = found;
        without = solve_equilibrium(block, ContactSprings(beam_springs), held, load).energy / rest.energy - 1;
      }
      CAPTURE(to_string(method), off_by(found, first), rest.relative_residual, rest.iterations, without);
      CHECK(off_by(found, first) < 1e-11);
      CHECK(rest.relative_residual < 1e-13);
      CHECK(rest.iterations < 60);
      CHECK(without > 1e-3);  // bending stiffens
    }
  }
}

TEST_CASE("bending_stiffens_a_random_cell_and_the_energies_add_up_to_the_power_of_the_stress") {
  const Assembly cell = bonded_network(true);
  const ContactSprings springs(beam_springs);
  const EffectiveStiffness plain = effective_stiffness(cell, springs);
  const EffectiveStiffness bent = effective_stiffness(cell, bending_springs(cell, springs, {.bond_width = 1.5}));
  const StiffnessEigen stiffer = eigenstrains(bent.stiffness - plain.stiffness);
  CAPTURE(bent.hill_mandel, stiffer.values[0], stiffer.values[2], largest_entry(bent.bending_part));
  CHECK(bent.hill_mandel < 1e-13);
  CHECK(stiffer.values[0] > -1e-13);
  CHECK(stiffer.values[2] > 1e-4);
  // kM dC/dkM by differences.
  const double h = 1e-4;
  const auto with = [&](double factor) {
    const ContactSprings wide = bending_springs(cell, springs, {.bond_width = 1.5 * std::sqrt(factor)});
    return effective_stiffness(cell, wide).stiffness;
  };
  const Matrix3 slope = (0.5 / h) * (with(1 + h) - with(1 - h));
  CHECK(largest_entry(slope - bent.bending_part) < 1e-6 * largest_entry(bent.bending_part));
}

TEST_CASE("bounds_hold_with_bending_springs") {
  const Assembly cell = bonded_network(true);
  const ContactSprings springs = bending_springs(cell, ContactSprings(beam_springs), {.bond_width = 1.5});
  const auto by = [&](Boundary boundary) { return effective_stiffness(cell, springs, {.boundary = boundary}); };
  const EffectiveStiffness traction = by(Boundary::traction), periodic = by(Boundary::periodic),
                           displacement = by(Boundary::displacement);
  const Matrix3 parts = traction.normal_part + traction.tangential_part + traction.bending_part;
  CHECK(largest_entry(parts - traction.stiffness) < 1e-12 * largest_entry(traction.stiffness));
  CHECK(eigenstrains(periodic.stiffness - traction.stiffness).values[0] > 0);
  CHECK(eigenstrains(displacement.stiffness - periodic.stiffness).values[0] > 0);
}

namespace {

/// Second derivatives of the energy of all contacts by (u_x, u_y, theta) of every disc, then by the mean strains xx, yy
/// and xy, written out from the definitions of stretch and slip.
Eigen::MatrixXd energy_form(const Assembly& assembly, const ContactSprings& springs) {
  const auto n = static_cast<Eigen::Index>(3 * assembly.size());
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n + 3, n + 3);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const Vec2 l = assembly.branch(contact), e = l / norm(l);
    const Eigen::Index i = 3 * contact.i, j = 3 * contact.j;
    Eigen::VectorXd stretch = Eigen::VectorXd::Zero(n + 3), slip = stretch, turn = stretch;
    const auto along = [&](Eigen::VectorXd& row, Vec2 way) {
      row(j) += way.x, row(j + 1) += way.y, row(i) -= way.x, row(i + 1) -= way.y;
      row(n) = l.x * way.x, row(n + 1) = l.y * way.y, row(n + 2) = 0.5 * (l.y * way.x + l.x * way.y);
    };
    along(stretch, e);
    along(slip, {-e.y, e.x});
    slip(i + 2) -= contact.lever_i, slip(j + 2) -= contact.lever_j;
    turn(j + 2) += 1, turn(i + 2) -= 1;
    form += springs[c].kN * stretch * stretch.transpose() + springs[c].kT * slip * slip.transpose() +
            springs.bending(c) * turn * turn.transpose();
  }
  return form;
}

std::int64_t negative_eigenvalues(const Eigen::MatrixXd& matrix) {
  return (Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues().array() < 0).count();
}

}  // namespace

TEST_CASE("negative_tangential_springs_beside_bending_have_the_state_and_the_inertia_of_a_dense_matrix") {
  const Assembly block = bonded_network(false);
  const std::vector<Support> held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  const LoadCase load{{.group = "right", .kind = LoadKind::total, .force = {0.3, 0.2}, .moment = 0.01}};
  const DiscGroup left = group(block, "left"), right = group(block, "right");
  const auto discs = static_cast<Eigen::Index>(block.size());
  std::int64_t stable = 0, unstable = 0, held_rotations = 0;
  for (const double kT : {-0.01, -0.1, -0.3, -1.0}) {
    for (const double width : {0.05, 0.3, 1.0}) {
      const ContactSprings springs = bending_springs(block, ContactSprings({3, kT}), {.bond_width = width});
      const Equilibrium rest = solve_equilibrium(block, springs, held, load);
      Eigen::MatrixXd K = energy_form(block, springs).topLeftCorner(3 * discs, 3 * discs);
      Eigen::VectorXd f = Eigen::VectorXd::Zero(K.rows());
      for (const std::int32_t d : right.discs) {
        f(3 * d) += 0.3 / static_cast<double>(right.discs.size());
        f(3 * d + 1) += 0.2 / static_cast<double>(right.discs.size());
        f(3 * d + 2) += 0.01 / static_cast<double>(right.discs.size());
      }
      for (const std::int32_t d : left.discs) {
        for (const Eigen::Index k : {3 * d, 3 * d + 1}) {
          K.row(k).setZero(), K.col(k).setZero();
          K(k, k) = 1, f(k) = 0;
        }
      }
      Eigen::MatrixXd D(discs, discs);
      for (Eigen::Index p = 0; p < discs; ++p)
        for (Eigen::Index q = 0; q < discs; ++q) D(p, q) = K(3 * p + 2, 3 * q + 2);
      const Eigen::VectorXd x = K.fullPivLu().solve(f);
      std::vector<double> found, wanted(x.data(), x.data() + x.size());
      for (const DiscMotion& m : rest.motions) found.insert(found.end(), {m.u.x, m.u.y, m.theta});
      const std::int64_t of_rotations = negative_eigenvalues(D);
      CAPTURE(kT, width, off_by(found, wanted), rest.unstable_modes.value_or(-1), of_rotations,
              rest.negative_pivots.value_or(-1));
      CHECK(off_by(found, wanted) < 1e-10);
      CHECK(rest.negative_pivots == negative_eigenvalues(K));
      CHECK(rest.unstable_modes == negative_eigenvalues(K) - of_rotations);
      (rest.unstable_modes == 0 ? stable : unstable) += 1;
      held_rotations += of_rotations < discs ? 1 : 0;
    }
  }
  CHECK(stable >= 3);
  CHECK(unstable >= 1);
  CHECK(held_rotations >= 3);
}

TEST_CASE("the_stiffness_of_a_cell_with_negative_tangential_springs_and_bending_is_that_of_a_dense_matrix") {
  const Assembly cell = bonded_network(true);
  for (const double kT : {-0.02, -0.15}) {
    const ContactSprings springs = bending_springs(cell, ContactSprings({3, kT}), {.bond_width = 0.4});
    const EffectiveStiffness found = effective_stiffness(cell, springs);
    const Eigen::MatrixXd form = energy_form(cell, springs) / cell.area();
    // Without the motion of one disc: translations cost nothing.
    const auto n = static_cast<Eigen::Index>(3 * cell.size()) - 2;
    const Eigen::MatrixXd K = form.block(2, 2, n, n), by_strain = form.block(2, n + 2, n, 3);
    const Eigen::Matrix3d wanted =
        form.bottomRightCorner(3, 3) - by_strain.transpose() * K.fullPivLu().solve(by_strain);
    double difference = 0;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) difference = std::max(difference, std::abs(found.stiffness[r][c] - wanted(r, c)));
    CAPTURE(kT, difference, largest_entry(found.stiffness), found.hill_mandel);
    CHECK(difference < 1e-10 * largest_entry(found.stiffness));
    CHECK(found.hill_mandel < 1e-10);
  }
}

TEST_CASE("bending_springs_that_mean_nothing_are_refused") {
  const Assembly row = row_of_discs(3);
  const ContactSprings springs(beam_springs);
  CHECK_THROWS_AS(bending_springs(row, springs, {.kM = -1.0}), Error);
  CHECK_THROWS_AS(bending_springs(row, springs, {.kM = std::nan("")}), Error);
  CHECK_THROWS_AS(bending_springs(row, springs, {.kM = 1.0, .bond_width = 1.0}), Error);
  CHECK_THROWS_AS(bending_springs(row, springs, {.bond_width = 1e8}), Error);
  CHECK_FALSE(bending_springs(row, springs, {.kM = 0.0}).bends());
  CHECK_FALSE(bending_springs(row, springs, {}).bends());
}

TEST_CASE("without_tangential_springs_bending_is_no_effect") {
  const Assembly block = hexagonal_lattice({.columns = 5, .rows = 4, .radius = beam_radius});
  const ContactSprings springs = bending_springs(block, ContactSprings({1, 0}), {.kM = 0.1});
  const Effects effects = derive_effects(block, springs, Rotation::from_scene);
  CHECK_FALSE(effects.bending);
  CHECK_FALSE(effects.rotation);
  CAPTURE(effects.report());
  CHECK(effects.report().find("bending springs (") != std::string::npos);
}
