// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The Bloch stiffness against closed forms (F9: Suiker, Metrikine & de Borst 2001) and against the stiffness matrix of
/// repetitions of the cell.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/linear/stiffness_matrix.hpp"

#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/fields.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double diameter = 2;

BlochWaves waves_of(const Assembly& assembly, double ratio, bool rotation = true, double beta = 0.5) {
  const ContactSprings springs(SpringConstants{1, ratio});
  return {primitive_cell(assembly, springs), unit_masses(assembly, beta), rotation};
}

double largest_entry(const ComplexMatrix& m) {
  double size = 0;
  for (const Complex& value : m.entries) size = std::max(size, std::abs(value));
  return size;
}

}  // namespace

TEST_CASE("the_stiffness_of_a_lattice_is_the_sum_over_its_bonds") {
  const double kT = GENERATE(-0.3, 0.2, 1.0);
  const Vec2 q = GENERATE(Vec2{0.3, 0.4}, Vec2{-1.1, 0.2}, Vec2{0.01, -0.6});
  const bool hexagonal = GENERATE(true, false);
  const BlochWaves waves = waves_of(hexagonal ? periodic_hexagonal(3, 4) : periodic_square(4, 3), kT);
  CAPTURE(kT, q.x, q.y, hexagonal);
  ComplexMatrix expected(3);
  for (int b = 0; b < (hexagonal ? 3 : 2); ++b) {
    const double angle = b * std::numbers::pi / (hexagonal ? 3 : 2);
    const Vec2 n{std::cos(angle), std::sin(angle)}, t{-n.y, n.x};
    const double phase = dot(q, diameter * n), w = 2 * (1 - std::cos(phase));
    const double nn[2] = {n.x, n.y}, tt[2] = {t.x, t.y};
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) expected(r, c) += w * (nn[r] * nn[c] + kT * tt[r] * tt[c]);
      expected(r, 2) += Complex(0, -2 * std::sin(phase)) * kT * tt[r];
      expected(2, r) += Complex(0, 2 * std::sin(phase)) * kT * tt[r];
    }
    expected(2, 2) += 2 * (1 + std::cos(phase)) * kT;
  }
  const ComplexMatrix found = waves.stiffness(q);
  // Which sign the coupling has depends on which end of a bond comes first; the spin may be counted either way.
  double difference = 0, other_sign = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double sign = (r == 2) != (c == 2) ? -1 : 1;
      difference = std::max(difference, std::abs(found(r, c) - expected(r, c)));
      other_sign = std::max(other_sign, std::abs(found(r, c) - sign * expected(r, c)));
    }
  }
  CHECK(std::min(difference, other_sign) < 1e-13);
}

TEST_CASE("the_stiffness_is_hermitian_and_periodic_in_frequency") {
  const Assembly assembly = random_cell(9, GENERATE(1, 2, 3));
  const ContactSprings springs(SpringConstants{1, GENERATE(-0.2, 0.0, 0.7)});
  const BlochWaves waves(primitive_cell(assembly, springs), unit_masses(assembly), springs.any_tangential());
  const BrillouinZone zone = brillouin_zone(waves.cell().period);
  const Vec2 q{0.21, -0.13};
  const ComplexMatrix k = waves.stiffness(q);
  for (std::size_t r = 0; r < k.size; ++r)
    for (std::size_t c = 0; c < k.size; ++c) CHECK(std::abs(k(r, c) - std::conj(k(c, r))) < 1e-15 * largest_entry(k));
  const auto here = waves.squared_frequencies(q), opposite = waves.squared_frequencies(-q),
             next = waves.squared_frequencies(q + zone.reciprocal[0] - 2 * zone.reciprocal[1]);
  CHECK(relative_difference(opposite, here) < 1e-13);
  CHECK(relative_difference(next, here) < 1e-13);
}

// Waves that fit into the supercell are the motions of the supercell: every eigenvalue of its K is that of a wave.
TEST_CASE("waves_that_fit_a_supercell_are_the_eigenvalues_of_its_stiffness") {
  struct Given {
    Assembly cell;
    int nx, ny;
    bool rotation;
  };
  const Given given = GENERATE(Given{periodic_hexagonal(1, 2), 3, 2, true}, Given{periodic_square(1, 1), 3, 4, true},
                               Given{random_cell(5, 4), 2, 3, true}, Given{random_cell(7, 9), 3, 2, false});
  const double ratio = GENERATE(-0.2, 0.6), at_rest = GENERATE(0.0, 0.1);
  const Assembly supercell = repeated(given.cell, given.nx, given.ny, 3);
  const ContactSprings bare(SpringConstants{1, ratio}), springs = under_forces(supercell, bare, at_rest);
  CAPTURE(given.cell.size(), given.nx, given.ny, given.rotation, ratio, at_rest);

  const ContactGraph graph(supercell);
  const DegreesOfFreedom unknowns = all_free(supercell, given.rotation ? 3 : 2);
  const DenseMatrix dense_k = dense_matrix(assemble_stiffness(supercell, graph, springs, unknowns), supercell);
  ComplexMatrix real(dense_k.size);
  for (std::size_t r = 0; r < real.size; ++r)
    for (std::size_t c = 0; c < real.size; ++c) real(r, c) = dense_k(r, c);
  const std::vector<double> expected = eigenvalues(real);

  std::vector<double> found;
  const PrimitiveCell cell = primitive_cell(given.cell, under_forces(given.cell, bare, at_rest));
  CHECK(primitive_cell(supercell, springs).size() == cell.size());
  const BlochWaves waves(cell, unit_masses(given.cell), given.rotation);
  const BrillouinZone zone = brillouin_zone(cell.period);
  std::vector<Vec2> fitting;  // q.L = 2 pi times whole numbers, folded
  const auto copies = static_cast<std::size_t>(std::llround(supercell.area() / cell.area()));
  const Vec2 step{2 * std::numbers::pi / supercell.period->x, 2 * std::numbers::pi / supercell.period->y};
  for (int i = -40; i <= 40; ++i) {
    for (int j = -40; j <= 40; ++j) {
      const Vec2 q{i * step.x, j * step.y};
      const bool known = std::any_of(fitting.begin(), fitting.end(), [&](Vec2 p) {
        return norm(zone.folded(p - q)) < 1e-6 * norm(zone.reciprocal[0]);
      });
      if (!known) fitting.push_back(q);
    }
  }
  REQUIRE(fitting.size() == copies);
  for (const Vec2 q : fitting) {
    const std::vector<double> values = eigenvalues(waves.stiffness(q));
    found.insert(found.end(), values.begin(), values.end());
  }
  std::sort(found.begin(), found.end());
  REQUIRE(found.size() == expected.size());
  CHECK(relative_difference(found, expected) < 1e-12);
}

TEST_CASE("sound_in_lattices_has_the_closed_speeds") {
  const double kT = GENERATE(-0.2, 0.1, 0.5, 1.0), beta = GENERATE(0.5, 0.4);
  CAPTURE(kT, beta);
  const double d2 = diameter * diameter;
  const BlochWaves hexagonal = waves_of(periodic_hexagonal(5, 4), kT, true, beta);
  for (const double angle : {0.0, 0.3, std::numbers::pi / 6, 2.0}) {
    const auto speeds = hexagonal.sound_speeds({std::cos(angle), std::sin(angle)});
    CAPTURE(angle, speeds.longitudinal_squared, speeds.transverse_squared);
    CHECK(speeds.longitudinal_squared == Approx(0.375 * (3 + kT) * d2).epsilon(1e-13));
    CHECK(speeds.transverse_squared == Approx(0.375 * (1 + kT) * d2).epsilon(1e-13));
    CHECK(speeds.others.empty());
  }
  const BlochWaves square = waves_of(periodic_square(4, 4), kT, true, beta);
  const auto axis = square.sound_speeds({0, 3}), diagonal = square.sound_speeds({1, 1});
  CHECK(axis.longitudinal_squared == Approx(d2).epsilon(1e-13));
  CHECK(axis.transverse_squared == Approx(kT * d2 / 2).epsilon(1e-13));
  CHECK(diagonal.longitudinal_squared == Approx((1 + kT) * d2 / 2).epsilon(1e-13));
  CHECK(diagonal.transverse_squared == Approx(d2 / 2).epsilon(1e-13));
  CHECK(*hexagonal.squared_rotational_gap() == Approx(12 * kT / beta).epsilon(1e-13));
  CHECK(*square.squared_rotational_gap() == Approx(8 * kT / beta).epsilon(1e-13));
}

// (53): restrained rotation has the wave speeds of G' = sqrt3/4 (kN + 3 kT), G'/(1 - 2nu') = sqrt3/2 (kN - kT).
TEST_CASE("restrained_rotation_has_the_wave_speeds_of_abe_53") {
  const double kT = GENERATE(-0.1, 0.0, 0.3);
  const BlochWaves waves = waves_of(periodic_hexagonal(2, 2), kT, false);
  const double g = std::sqrt(3.0) / 4 * (1 + 3 * kT), sum = std::sqrt(3.0) / 2 * (1 - kT);
  const auto speeds = waves.sound_speeds({0.6, 0.8});
  CHECK(speeds.transverse_squared == Approx(g / waves.mass_per_area()).epsilon(1e-13));
  CHECK(speeds.longitudinal_squared == Approx((g + sum) / waves.mass_per_area()).epsilon(1e-13));
  CHECK(!waves.squared_rotational_gap());
}
