// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe (1996), section 4: the macroscopic stress, eq. (50), of uniform strain on regular lattices: eqs. (51), (52)
/// with free rotation, (54), (55) with restrained rotation. The springs range beyond what the paper allows: these
/// relations hold for every kT, stable or not.
#include <cmath>
#include <numbers>
#include <numeric>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/material/spring_relations.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;
using std::numbers::sqrt3;

namespace {

constexpr double ratios[] = {-0.9, -1.0 / 3, -0.1, 0, 0.1, 0.25, 0.5, 0.9, 1, 2};

Assembly periodic_hexagonal() {
  return hexagonal_lattice({.columns = 12, .rows = 10, .radius = 0.005, .periodic = true});
}

/// Largest deviation of any disc's stress from the expected one.
double worst_difference(const Assembly& assembly, const std::vector<ContactForce>& forces, const Tensor2& expected) {
  double worst = 0;
  for (const Tensor2& s : disc_stresses(assembly, forces)) worst = std::max(worst, difference(s, expected));
  return worst;
}

/// t_ij by indices 0, 1, to write sums as the paper prints them.
double component(const Tensor2& t, int i, int j) {
  return i == 0 ? (j == 0 ? t.xx : t.xy) : (j == 0 ? t.yx : t.yy);
}
constexpr double delta(int i, int j) {
  return i == j ? 1 : 0;
}
/// e_12 = 1 = -e_21: the tangent is s_i = e_ki n_k.
constexpr double permutation(int i, int j) {
  return j - i;
}

/// The bracket of eq. (55), corrected: the paper leaves out delta_2i delta_2j (u_1,1 + 3 u_2,2).
double bracket_55(const Tensor2& u, const SpringConstants& k, int i, int j) {
  const auto both = [&](int p, int q) { return delta(p, i) * delta(q, j); };
  const double normal =
      both(0, 0) * (3 * u.xx + u.yy) + both(1, 1) * (u.xx + 3 * u.yy) + (both(0, 1) + both(1, 0)) * (u.xy + u.yx);
  const double tangential =
      (both(0, 0) - both(1, 1)) * (u.xx - u.yy) + both(0, 1) * (3 * u.xy - u.yx) + both(1, 0) * (-u.xy + 3 * u.yx);
  return k.kN * normal + k.kT * tangential;
}

}  // namespace

TEST_CASE("uniform_strain_of_the_hexagonal_lattice_gives_hookes_law_disc_by_disc") {
  // Eq. (52), with the springs that eq. (34) gives for G and nu.
  const Assembly assembly = periodic_hexagonal();
  Random random(41);
  for (const double ratio : ratios) {
    const double nu = poisson_ratio_of_ratio(ratio), G = random.uniform(1e8, 1e9);
    const SpringConstants k = springs_for({.shear_modulus = G, .poisson_ratio = nu, .plane = Plane::strain},
                                          lattices::hexagonal.relation, {}, NegativeTangential::static_only);
    REQUIRE(k.kT == Approx(ratio * k.kN).margin(1e-12 * k.kN));
    for (int sample = 0; sample < 5; ++sample) {
      const Tensor2 h = 1e-3 * random_tensor(random);
      const double volume = 2 * nu / (1 - 2 * nu) * (h.xx + h.yy);
      const Tensor2 expected = G * Tensor2{volume + 2 * h.xx, h.xy + h.yx, h.xy + h.yx, volume + 2 * h.yy};
      const auto forces = affine_contact_forces(assembly, ContactSprings(k), h, mean_rotation(h));
      const double error = worst_difference(assembly, forces, expected) / (k.kN * largest(h));
      CAPTURE(ratio, nu, G, shown(h), shown(expected), error);
      CHECK(error < 1e-13);
      CHECK(difference(macroscopic_stress(assembly, forces), expected) < 1e-13 * k.kN * largest(h));
    }
  }
}

TEST_CASE("restrained_rotation_leaves_the_contact_forces_of_equation_54") {
  const Assembly assembly = periodic_hexagonal();
  const double a = assembly.radii.front();
  Random random(42);
  for (const double ratio : ratios) {
    const SpringConstants k{1, ratio};
    const Tensor2 u = random_tensor(random);
    const auto forces = affine_contact_forces(assembly, ContactSprings(k), u, 0);
    double worst = 0;
    for (std::size_t c = 0; c < forces.size(); ++c) {
      const ContactFrame frame = frame_of(assembly, c);
      const double n[] = {frame.normal.x, frame.normal.y};
      double expected[] = {0, 0};
      for (int i = 0; i < 2; ++i)
        for (int m = 0; m < 2; ++m)
          for (int q = 0; q < 2; ++q) {
            expected[i] += 2 * a * k.kN * component(u, m, q) * n[i] * n[m] * n[q];
            for (int l = 0; l < 2; ++l)
              for (int p = 0; p < 2; ++p)
                expected[i] +=
                    2 * a * k.kT * component(u, m, q) * permutation(l, m) * permutation(p, i) * n[l] * n[p] * n[q];
          }
      worst = std::max(worst, norm(force_on_i(frame, forces[c]) - Vec2{expected[0], expected[1]}));
    }
    CAPTURE(ratio, shown(u), worst);
    CHECK(worst < 1e-13 * 2 * a * largest(u));
  }
}

TEST_CASE("restrained_rotation_of_the_hexagonal_lattice_gives_the_stress_of_equation_55") {
  const Assembly assembly = periodic_hexagonal();
  const double a = assembly.radii.front();
  const double solid_fraction = std::numbers::pi / (2 * sqrt3);
  Random random(43);
  for (const double ratio : ratios) {
    const SpringConstants k{1, ratio};
    const Tensor2 u = random_tensor(random);
    const auto forces = affine_contact_forces(assembly, ContactSprings(k), u, 0);

    // Eq. (50): s_ij = (gamma/rho)/(pi a) sum F_i n_j, sum F_i n_j = (3a/2) {bracket} of eq. (55).
    const auto s = [&](int i, int j) {
      return solid_fraction / (std::numbers::pi * a) * 1.5 * a * bracket_55(u, k, i, j);
    };
    const Tensor2 printed{s(0, 0), s(0, 1), s(1, 0), s(1, 1)};
    // The same in closed form: the symmetric law of eq. (52), and an antisymmetric part.
    const double spin = u.yx - u.xy;
    const double volume = sqrt3 / 4 * (1 - ratio) * (u.xx + u.yy);
    const double twice_G = sqrt3 / 2 * (1 + ratio);
    const double shear = twice_G * (u.xy + u.yx) / 2;
    const Tensor2 closed{volume + twice_G * u.xx, shear - sqrt3 / 2 * ratio * spin, shear + sqrt3 / 2 * ratio * spin,
                         volume + twice_G * u.yy};

    CAPTURE(ratio, shown(u), shown(printed), shown(closed));
    CHECK(worst_difference(assembly, forces, printed) < 1e-13 * largest(u));
    CHECK(worst_difference(assembly, forces, closed) < 1e-13 * largest(u));
  }
}

TEST_CASE("asymmetry_of_equation_55_is_minus_sqrt3_kT_spin_and_the_moments_that_hold_the_discs") {
  const Assembly assembly = periodic_hexagonal();
  Random random(44);
  for (const double ratio : ratios) {
    const Tensor2 u = random_tensor(random);
    const auto forces = affine_contact_forces(assembly, ContactSprings(SpringConstants{1, ratio}), u, 0);
    const double expected = -sqrt3 * ratio * (u.yx - u.xy);
    std::vector<double> holding;
    for (const Resultant& r : contact_resultants(assembly, forces)) holding.push_back(-r.moment);
    const double difference = asymmetry(macroscopic_stress(assembly, forces));
    const double density = std::accumulate(holding.begin(), holding.end(), 0.0) / assembly.area();
    double worst = 0;
    for (const Tensor2& s : disc_stresses(assembly, forces)) worst = std::max(worst, std::abs(asymmetry(s) - expected));
    CAPTURE(ratio, shown(u), expected, difference, density, worst);
    CHECK(worst < 1e-13 * largest(u));
    CHECK(std::abs(difference - expected) < 1e-13 * largest(u));
    CHECK(std::abs(density - expected) < 1e-13 * largest(u));
    if (ratio != 0) CHECK(std::abs(expected) > 1e-3 * largest(u));
  }
}

TEST_CASE("restrained_rotation_still_gives_nu_of_free_rotation_in_uniaxial_stress") {
  // Eq. (53) describes the displacement operator; without spin its nu' = (1 - 5r)/(4(1 - r)) does not appear.
  const Assembly assembly = periodic_hexagonal();
  for (const double ratio : ratios) {
    const ContactSprings springs(SpringConstants{1, ratio});
    const Tensor2 along = macroscopic_stress(assembly, affine_contact_forces(assembly, springs, {1, 0, 0, 0}, 0));
    const Tensor2 across = macroscopic_stress(assembly, affine_contact_forces(assembly, springs, {0, 0, 0, 1}, 0));
    const double e22 = -along.yy / across.yy;
    CAPTURE(ratio, e22);
    CHECK(poisson_ratio_of_strains(1, e22) == Approx((1 - ratio) / 4).margin(1e-13));
    const double s11 = along.xx + e22 * across.xx;
    CHECK(s11 == Approx(hexagonal_stiffness_ratio(ratio)).epsilon(1e-13));
  }
}

TEST_CASE("square_lattice_is_cubic_and_isotropic_only_for_equal_springs") {
  // C11 = kN, C12 = 0, C66 = kT/2; turned by 45 degrees C11 = (kN + kT)/2, C12 = (kN - kT)/2, C66 = kN/2.
  const Assembly assembly = square_lattice({.columns = 9, .rows = 7, .radius = 0.005, .periodic = true});
  Random random(45);
  for (const double ratio : ratios) {
    const ContactSprings springs(SpringConstants{1, ratio});
    const auto stress_of = [&](const Tensor2& h) {
      return affine_contact_forces(assembly, springs, h, mean_rotation(h));
    };
    const Tensor2 h = random_tensor(random);
    const double shear = ratio / 2 * (h.xy + h.yx);
    const Tensor2 expected{h.xx, shear, shear, h.yy};
    CAPTURE(ratio, shown(h), shown(expected));
    CHECK(worst_difference(assembly, stress_of(h), expected) < 1e-13 * largest(h));

    // Elongation along the diagonal n = (1, 1)/sqrt2: s_nn = (kN + kT)/2 and across it (kN - kT)/2.
    const Tensor2 s = disc_stresses(assembly, stress_of({0.5, 0.5, 0.5, 0.5})).front();
    CHECK((s.xx + s.xy + s.yx + s.yy) / 2 == Approx((1 + ratio) / 2).margin(1e-13));
    CHECK((s.xx - s.xy - s.yx + s.yy) / 2 == Approx((1 - ratio) / 2).margin(1e-13));
    // Shear between the diagonals, gamma = 2 e_nm = 1.
    const Tensor2 t = disc_stresses(assembly, stress_of({0.5, 0, 0, -0.5})).front();
    CHECK((t.xx - t.yy) / 2 == Approx(0.5).margin(1e-13));
  }
}

TEST_CASE("stress_of_unequal_discs_scatters_about_the_applied_stress") {
  // End of section 4.2: (50) with V the cell of the disc, and as printed with V = pi r²/phi.
  const double largest_radius = GENERATE(0.005, 0.01);
  const Assembly cell = delaunay_assembly(
      {.discs = 400, .points = PointProcess::poisson_disc, .radii = {0.005, largest_radius}, .periodic = true});
  const ContactSprings springs(SpringConstants{1, 0.25});
  const EffectiveStiffness found = effective_stiffness(cell, springs);
  const Matrix3 compliance = inverse(found.stiffness);
  const auto states = strained_states(cell, springs, found, 1);
  std::vector<ContactForce> forces(cell.contacts.size());
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t c = 0; c < forces.size(); ++c) {
      forces[c].normal += compliance[k][0] * states[k].forces[c].normal;
      forces[c].tangential += compliance[k][0] * states[k].forces[c].tangential;
    }
  }
  const std::vector<Tensor2> stresses = disc_stresses(cell, forces);
  double mean = 0, square = 0, printed = 0;
  for (std::size_t d = 0; d < cell.size(); ++d) {
    mean += cell.cell_areas[d] * stresses[d].xx / cell.area();
    square += cell.cell_areas[d] * std::pow(stresses[d].xx - 1, 2) / cell.area();
    const double volume = std::numbers::pi * cell.radii[d] * cell.radii[d] / cell.solid_fraction();
    printed += volume * (stresses[d].xx * cell.cell_areas[d] / volume) / cell.area();
  }
  CAPTURE(largest_radius, mean, printed, std::sqrt(square));
  CHECK(mean == Approx(1).epsilon(1e-10));
  CHECK(printed == Approx(1).epsilon(1e-10));
  CHECK(std::sqrt(square) == Approx(0.25).margin(0.05));
}
