// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Buckling: the factor of the forces at rest at which a column of discs gives way.
#include "equidem/statics/critical_load.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/mechanisms.hpp"

#include "support/catch.hpp"
#include "support/dense_oracle.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double disc_radius = 0.5;
constexpr SpringConstants bond{1, 0.5};
const std::vector<Support> clamped{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};

/// A column of `rows` rows, clamped at its left end, whose contacts carry what a load of -1 N/m at its right end
/// causes.
Assembly compressed_column(int columns, int rows = 2, double load = -1) {
  Assembly column = square_lattice({.columns = columns, .rows = rows, .radius = disc_radius});
  const Equilibrium loaded = solve_equilibrium(column, ContactSprings(bond), clamped,
                                               {{.group = "right", .kind = LoadKind::total, .force = {load, 0}}});
  for (const ContactForce& force : loaded.contact_forces) {
    column.contact_normal_force.push_back(force.normal);
    column.contact_tangential_force.push_back(force.tangential);
  }
  return column;
}

ContactSprings prestressed(const Assembly& assembly, SpringConstants springs = bond) {
  return choose_prestress(assembly, ContactSprings(springs), PrestressChoice::on)->springs;
}

/// Dense K and K_g of bonded discs about their centres, written out, with the first `held` components left out:
/// N0/l t t^T - T0/l (n t^T + t n^T), t and n the motions of the centres along and across the contact.
void dense_pencil(const Assembly& a, std::size_t held, DenseMatrix& k, DenseMatrix& k_g) {
  const auto number = [&](std::int32_t disc, std::size_t c) { return 3 * static_cast<std::size_t>(disc) + c; };
  for (std::size_t e = 0; e < a.contacts.size(); ++e) {
    const Contact& c = a.contacts[e];
    const Vec2 l = a.branch(c), n = l / norm(l);
    std::vector<double> stretch(3 * a.size()), slip(3 * a.size()), across(3 * a.size());
    for (const auto& [disc, sign] : {std::pair(c.i, -1.0), std::pair(c.j, 1.0)}) {
      stretch[number(disc, 0)] = sign * n.x, stretch[number(disc, 1)] = sign * n.y;
      across[number(disc, 0)] = -sign * n.y, across[number(disc, 1)] = sign * n.x;
    }
    slip = across;
    slip[number(c.i, 2)] = -c.lever_i, slip[number(c.j, 2)] = -c.lever_j;
    const double n0 = a.contact_normal_force[e], t0 = a.contact_tangential_force[e];
    for (std::size_t p = held; p < stretch.size(); ++p) {
      for (std::size_t q = held; q < stretch.size(); ++q) {
        k(p - held, q - held) += bond.kN * stretch[p] * stretch[q] + bond.kT * slip[p] * slip[q];
        k_g(p - held, q - held) +=
            n0 / norm(l) * across[p] * across[q] - t0 / norm(l) * (stretch[p] * across[q] + across[p] * stretch[q]);
      }
    }
  }
}

/// 1/(largest eigenvalue of -K_g x = mu K x) by iteration with K^-1.
double dense_critical_load(const Assembly& column, std::size_t held) {
  const std::size_t size = 3 * column.size() - held;
  DenseMatrix k(size), k_g(size);
  dense_pencil(column, held, k, k_g);
  std::vector<double> x(size);
  for (std::size_t p = 0; p < size; ++p) x[p] = 1 + std::sin(static_cast<double>(p));
  double mu = 0;
  for (int pass = 0; pass < 60; ++pass) {
    std::vector<double> g(size);
    for (std::size_t p = 0; p < size; ++p)
      for (std::size_t q = 0; q < size; ++q) g[p] -= k_g(p, q) * x[q];
    double work = 0, energy = 0;
    for (std::size_t p = 0; p < size; ++p) {
      work += x[p] * g[p];
      for (std::size_t q = 0; q < size; ++q) energy += x[p] * k(p, q) * x[q];
    }
    mu = work / energy;
    x = solve(k, g);
    double largest = 0;
    for (const double value : x) largest = std::max(largest, std::abs(value));
    for (double& value : x) value /= largest;
  }
  return 1 / mu;
}

/// pi² E I/(4 L²) of the clamped column: chords of stiffness 2 a kN at the distances of the rows from the middle.
double euler_load(int columns, int rows) {
  double bending = 0;
  for (int row = 0; row < rows; ++row)
    bending += 2 * disc_radius * bond.kN * squared(2 * disc_radius * (row - 0.5 * (rows - 1)));
  const double length = 2 * disc_radius * (columns - 1);
  return squared(std::numbers::pi) * bending / (4 * length * length);
}

}  // namespace

TEST_CASE("the_critical_load_of_a_column_is_the_eigenvalue_of_its_dense_pencil") {
  const int columns = GENERATE(4, 8), rows = GENERATE(2, 3);
  const Assembly column = compressed_column(columns, rows);
  // Discs of a column of the lattice need not follow each other: those that are held come first here.
  Assembly sorted = column;
  std::vector<std::int32_t> number(column.size(), -1);
  std::int32_t next = 0;
  for (const std::int32_t disc : column.groups.at("left").discs) number[static_cast<std::size_t>(disc)] = next++;
  for (std::int32_t& n : number)
    if (n < 0) n = next++;
  for (std::size_t d = 0; d < column.size(); ++d)
    sorted.centres[static_cast<std::size_t>(number[d])] = column.centres[d];
  for (Contact& c : sorted.contacts)
    c.i = number[static_cast<std::size_t>(c.i)], c.j = number[static_cast<std::size_t>(c.j)];

  const CriticalLoad found = find_critical_load(column, prestressed(column), clamped);
  const double expected = dense_critical_load(sorted, 3 * static_cast<std::size_t>(rows));

  CAPTURE(columns, rows, found.factor, found.width, expected, found.factorizations, found.why);
  CHECK(std::abs(found.factor - expected) <= found.width * expected);
  CHECK((found.width > 0 && found.width < 1e-9));
  CHECK(found.motion.size() == column.size());
  CHECK(found.factorizations < 40);
}

// By Engesser 1/P = 1/P_Euler + 1/(G A): the difference from Euler's load falls as the square of the slenderness.
TEST_CASE("columns_of_discs_buckle_at_eulers_load_as_they_get_slender") {
  double before = 0, difference_before = 0;
  for (const int columns : {8, 16, 32, 64, 128}) {
    const Assembly column = compressed_column(columns);
    const CriticalLoad found = find_critical_load(column, prestressed(column), clamped);
    const double euler = euler_load(columns, 2), missing = 1 - found.factor / euler;
    const double flexibility = 1 / found.factor - 1 / euler;
    CAPTURE(columns, found.factor, euler, missing, missing * columns * columns, flexibility);
    CHECK(missing > 0);
    if (columns > 8) {
      CHECK(before / missing > 3.8);
      CHECK(before / missing < 4.3);
      CHECK(flexibility > difference_before);
      CHECK(flexibility < 8.0 / 3);
      CHECK(found.width < 1e-5);
    }
    before = missing, difference_before = flexibility;
  }
  CHECK(before < 2.1e-4);
  CHECK(difference_before == Approx(8.0 / 3).epsilon(4e-3));
}

TEST_CASE("beyond_the_critical_load_one_mode_is_unstable_and_in_tension_none_is") {
  const Assembly column = compressed_column(16);
  const ContactSprings springs = prestressed(column);
  const double critical = find_critical_load(column, springs, clamped).factor;
  const auto modes = [&](double factor) {
    const ContactSprings loaded = springs.with_prestress(springs.scaled_prestress(factor));
    return find_inertia(column, loaded, Rotation::from_scene, clamped).unstable_modes;
  };
  CHECK(modes(critical * (1 - 1e-6)) == 0);
  CHECK(modes(critical * (1 + 1e-6)) == 1);
  CHECK(modes(12 * critical) == 2);  // the second mode of a clamped column buckles at about nine times the first
  const Assembly pulled = compressed_column(16, 2, 1);
  CHECK(find_critical_load(pulled, prestressed(pulled), clamped).factor > 50 * critical);
}

// Under a load beside the axis deflections grow by 1/(1 - P/P_c), but for the other modes.
TEST_CASE("a_compressed_column_bends_more_and_gives_way_at_the_critical_load") {
  Assembly column = compressed_column(32);
  const ContactSprings unit = prestressed(column);
  const double critical = find_critical_load(column, unit, clamped).factor;
  const LoadCase across{{.group = "right", .kind = LoadKind::total, .force = {0, 1e-6}}};
  const auto deflection = [&](double share) {
    const ContactSprings springs = unit.with_prestress(unit.scaled_prestress(share * critical));
    const Equilibrium bent = solve_equilibrium(column, springs, clamped, across);
    CHECK(bent.relative_residual < 1e-12);
    CHECK(bent.unstable_modes == (share > 1 ? 1 : 0));
    Vec2 reactions;
    for (const Reaction& reaction : bent.reactions) reactions += reaction.force;
    CHECK(reactions.y == Approx(-1e-6).epsilon(1e-8));
    return bent.motions[static_cast<std::size_t>(column.groups.at("right").discs.front())].u.y;
  };
  const double alone = deflection(1e-9);
  CHECK(deflection(0.5) == Approx(2 * alone).epsilon(0.03));
  CHECK(deflection(0.9) == Approx(10 * alone).epsilon(0.03));
  CHECK(deflection(1.1) < 0);
}

TEST_CASE("a_column_that_springs_alone_do_not_hold_has_no_critical_load") {
  const Assembly column = compressed_column(8);
  CHECK(find_critical_load(column, ContactSprings(bond), clamped).why == "no forces at rest count");
  CHECK_FALSE(find_critical_load(column, prestressed(column, {1, 0}), clamped).sought);
  CHECK_FALSE(find_critical_load(column, prestressed(column, {1, -0.1}), clamped).sought);
  CHECK_THROWS_AS(find_critical_load(column, prestressed(column), clamped, {.largest = 0}), Error);
}
