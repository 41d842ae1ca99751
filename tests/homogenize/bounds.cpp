// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Voigt stiffness and uniform-stress estimate against closed forms, against the forces that they stand for, and
/// against each other.
#include "equidem/homogenize/bounds.hpp"

#include <cmath>
#include <numbers>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;
using std::numbers::pi;

namespace {

using std::numbers::sqrt3;

Assembly lattice(const std::string& kind) {
  const LatticeOptions options{.columns = 4, .rows = 6, .radius = 0.005, .periodic = true};
  return kind == "square" ? square_lattice(options) : hexagonal_lattice(options);
}

ContactSprings uniform(double kN, double kT) {
  return ContactSprings(SpringConstants{kN, kT});
}

}  // namespace

TEST_CASE("voigt_stiffness_of_lattices_is_exact") {
  const double kN = GENERATE(1.0, 3e9), ratio = GENERATE(-0.3, 0.0, 1e-8, 0.2, 1.0, 1e8), kT = ratio * kN;
  const Matrix3 hexagonal = isotropic_stiffness(sqrt3 / 2 * kN, sqrt3 / 4 * (kN + kT));
  const Matrix3 square{{{kN, 0, 0}, {0, kN, 0}, {0, 0, kT / 2}}};
  const Matrix3 hexagonal_found = voigt_stiffness(lattice("hexagonal"), uniform(kN, kT));
  const Matrix3 square_found = voigt_stiffness(lattice("square"), uniform(kN, kT));
  CAPTURE(kN, ratio, shown(hexagonal_found), shown(square_found));
  CHECK(relative_difference(hexagonal_found, hexagonal) < 1e-13);
  CHECK(relative_difference(square_found, square) < 1e-13);
  if (ratio >= -0.3 && ratio <= 1) {
    const EffectiveModuli moduli = effective_moduli(hexagonal_found);
    CHECK(moduli.poisson_strain == Approx((1 - ratio) / 4).margin(1e-13));
    CHECK(moduli.poisson_stress == Approx((kN - kT) / (3 * kN + kT)).margin(1e-13));
    CHECK(moduli.young_stress == Approx(2 * sqrt3 * kN * (kN + kT) / (3 * kN + kT)).epsilon(1e-13));
    CHECK(moduli.anisotropy < 1e-13);
  }
}

TEST_CASE("voigt_stiffness_is_the_stress_of_affine_motion") {
  Random random(31);
  for (const bool periodic : {false, true}) {
    for (const auto& [name, assembly] : assemblies(periodic)) {
      const ContactSprings springs = random_springs(assembly, -0.2, 32);
      const Tensor2 h = random_tensor(random);
      const Tensor2 strain{h.xx, 0.5 * (h.xy + h.yx), 0.5 * (h.xy + h.yx), h.yy};
      const Voigt expected = voigt_stress(
          macroscopic_stress(assembly, affine_contact_forces(assembly, springs, strain, mean_rotation(strain))));
      const Voigt found = stress_of(voigt_stiffness(assembly, springs), voigt_strain(h));
      CAPTURE(name, periodic, samples::shown(h));
      CHECK(found.xx == Approx(expected.xx).epsilon(1e-12).margin(1e-13));
      CHECK(found.yy == Approx(expected.yy).epsilon(1e-12).margin(1e-13));
      CHECK(found.xy == Approx(expected.xy).epsilon(1e-12).margin(1e-13));
    }
  }
}

TEST_CASE("uniform_stress_estimate_of_the_hexagonal_lattice_has_its_closed_form") {
  // However soft the tangential springs, K and C66 keep all their digits; C11 - C12 can but keep those of K.
  const double kN = GENERATE(1.0, 3e9), ratio = GENERATE(1e-12, 1e-8, 0.1, 0.25, 0.5, 1.0, 1e8), kT = ratio * kN;
  const Assembly assembly = lattice("hexagonal");
  const Matrix3 found = uniform_stress_estimate(assembly, uniform(kN, kT));
  const EffectiveModuli moduli = effective_moduli(found);
  const double affine = effective_moduli(voigt_stiffness(assembly, uniform(kN, kT))).shear_modulus;
  constexpr double S = 2 * sqrt3;
  const double K = S * kN / 4, G = S / 2 * kN * kT / (kN + kT);
  CAPTURE(kN, ratio, moduli.bulk_modulus_2d / K, found[2][2] / G, moduli.shear_modulus / G, moduli.anisotropy);
  CHECK(moduli.bulk_modulus_2d == Approx(K).epsilon(1e-13));
  CHECK(found[2][2] == Approx(G).epsilon(1e-13));
  CHECK(moduli.shear_modulus == Approx(G).epsilon(1e-13).margin(1e-15 * K));
  CHECK(found[2][2] / affine == Approx(4 * ratio / ((1 + ratio) * (1 + ratio))).epsilon(1e-13));
  CHECK(moduli.poisson_strain == Approx((1 - ratio) / (2 * (1 + ratio))).margin(1e-13));
  CHECK(moduli.poisson_stress == Approx((1 - ratio) / (1 + 3 * ratio)).margin(1e-13));
  CHECK(moduli.anisotropy < 1e-13);
}

TEST_CASE("uniform_stress_estimate_stores_the_energy_of_forces_that_carry_the_stress") {
  // F = A s B^-1 l has the Love-Weber stress s, and its energy is A s : C^-1 s / 2.
  Random random(33);
  for (const bool periodic : {false, true}) {
    for (const auto& [name, assembly] : assemblies(periodic)) {
      const ContactSprings springs = random_springs(assembly, 0.1, 34);
      const double area = assembly.area(), xx = random.uniform(-1, 1), yy = random.uniform(-1, 1);
      const double xy = random.uniform(-1, 1);
      const Tensor2 stress{xx, xy, xy, yy};
      Tensor2 b;
      for (const Contact& contact : assembly.contacts) b += outer(assembly.branch(contact), assembly.branch(contact));
      const double determinant = b.xx * b.yy - b.xy * b.yx;
      std::vector<ContactForce> forces;
      double energy = 0;
      for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
        const Vec2 l = assembly.branch(assembly.contacts[c]);
        const Vec2 m = Vec2{b.yy * l.x - b.xy * l.y, b.xx * l.y - b.yx * l.x} / determinant;
        const Vec2 force = area * (stress * m);
        const ContactFrame frame = frame_of(assembly, c);
        forces.push_back({dot(force, frame.normal), dot(force, frame.tangent())});
        energy += linear_spring_energy_of(springs[c], forces.back());
      }
      const Tensor2 carried = macroscopic_stress(assembly, forces);
      const Voigt strain = stress_of(inverse(uniform_stress_estimate(assembly, springs)), {xx, yy, xy});
      const double work = 0.5 * area * (xx * strain.xx + yy * strain.yy + xy * strain.xy);
      CAPTURE(name, periodic, samples::shown(stress), samples::shown(carried), energy, work);
      CHECK(difference(carried, stress) < 1e-12);
      CHECK(work == Approx(energy).epsilon(1e-12));
    }
  }
}

TEST_CASE("uniform_stress_estimate_is_never_above_the_voigt_stiffness") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const bool periodic : {false, true}) {
      for (const auto& [name, assembly] : assemblies(periodic)) {
        for (const double least : {0.0, 0.9}) {
          const ContactSprings springs = random_springs(assembly, least, seed);
          const Matrix3 low = uniform_stress_estimate(assembly, springs), high = voigt_stiffness(assembly, springs);
          CAPTURE(name, periodic, seed, least, shown(low), shown(high));
          CHECK(margin(low, high) > -1e-14);
          CHECK(margin(Matrix3{}, low) > 0);
        }
      }
    }
  }
  // Equal springs of equal length on an isotropic network leave no room between them.
  const Assembly hexagonal = lattice("hexagonal");
  const Matrix3 low = uniform_stress_estimate(hexagonal, uniform(1, 1));
  CHECK(relative_difference(low, voigt_stiffness(hexagonal, uniform(1, 1))) < 1e-14);
}

TEST_CASE("stiffnesses_turn_with_the_assembly") {
  const double angle = GENERATE(0.2, pi / 4, 1.9, -2.7);
  for (const auto& [name, assembly] : assemblies(false)) {
    const ContactSprings springs = random_springs(assembly, 0.1, 35);
    const Assembly after = turned(assembly, angle);
    const Matrix3 voigt = voigt_stiffness(assembly, springs), low = uniform_stress_estimate(assembly, springs);
    CAPTURE(name, angle, shown(voigt), shown(low));
    CHECK(relative_difference(voigt_stiffness(after, springs), rotated(voigt, -angle)) < 1e-13);
    CHECK(relative_difference(uniform_stress_estimate(after, springs), rotated(low, -angle)) < 1e-13);
    CHECK(relative_difference(voigt_stiffness(after, springs), rotated(voigt, angle)) > 1e-4);  // the sense counts
  }
}

TEST_CASE("without_tangential_springs_only_stresses_that_load_none_are_resisted") {
  SECTION("hexagonal: the bulk modulus is left") {
    const Matrix3 found = uniform_stress_estimate(lattice("hexagonal"), uniform(2, 0));
    CAPTURE(shown(found));
    CHECK(relative_difference(found, isotropic_stiffness(sqrt3 / 2 * 2, 0)) < 1e-14);
  }
  SECTION("square, turned: tension along its rows is left") {
    const double angle = GENERATE(0.0, 0.3, 0.6, pi / 4, 1.2);
    const Assembly free = square_lattice({.columns = 6, .rows = 6, .radius = 0.005});
    const Matrix3 upright = voigt_stiffness(free, uniform(2, 0));
    const Matrix3 found = uniform_stress_estimate(turned(free, angle), uniform(2, 0));
    CAPTURE(angle, shown(upright), shown(found));
    CHECK(upright[2][2] == 0);
    CHECK(relative_difference(found, rotated(upright, -angle)) < 1e-13);
  }
  SECTION("any: it is the limit kT -> 0, wherever springs are absent") {
    for (const bool all : {true, false}) {
      for (const auto& [name, assembly] : assemblies(false)) {
        const auto springs = [&, &assembly = assembly](double kT) {
          Random random(36);
          std::vector<SpringConstants> k(assembly.contacts.size());
          for (SpringConstants& spring : k) {
            spring.kN = random.uniform(0.5, 1.5);
            spring.kT = all || random.uniform() < 0.1 ? kT : 0.5;
          }
          return ContactSprings(k);
        };
        const Matrix3 limit = uniform_stress_estimate(assembly, springs(0));
        const Matrix3 near = uniform_stress_estimate(assembly, springs(1e-9));
        const Tensor2 b = fabric(assembly).branch;
        const StiffnessEigen eigen = eigenstrains(limit);
        CAPTURE(name, all, shown(limit), shown(near), eigen.values[0], eigen.values[2]);
        CHECK(all_finite(limit));
        CHECK(relative_difference(near, limit) < 1e-7);
        CHECK(relative_difference(near, limit) > 1e-12);
        CHECK(eigen.values[2] > 0.1);
        if (name == "square") continue;  // its deviator along the axes loads no tangential spring either
        CHECK(std::abs(eigen.values[1]) < 1e-14 * eigen.values[2]);
        // As a stress, the one left is along B.
        const auto& e = eigen.strains[2];
        CHECK(e[1] / e[0] == Approx(b.yy / b.xx).epsilon(1e-12));
        CHECK(e[2] / 2 / e[0] == Approx(b.xy / b.xx).epsilon(1e-12).margin(1e-14));
      }
    }
  }
}

TEST_CASE("uniform_stress_estimate_refuses_what_it_cannot_estimate") {
  const auto message = [](const Assembly& assembly, double kT) {
    return message_of([&] { static_cast<void>(uniform_stress_estimate(assembly, uniform(1, kT))); });
  };
  Assembly chain = square_lattice({.columns = 5, .rows = 1, .radius = 0.005});
  CHECK(contains(message(lattice("square"), -0.1), "the tangential spring is kT = -0.1 Pa at contact 0"));
  CHECK(contains(message(chain, 1), "all branches are parallel"));
  CHECK(contains(message(turned(chain, 0.7), 1), "all branches are parallel"));
  chain.contacts.clear();
  CHECK(contains(message(chain, 1), "the assembly has no contacts"));
}

TEST_CASE("other_boundaries_and_affine_motion_enclose_the_stiffness") {
  for (const Sample& sample : assemblies(true)) {
    CAPTURE(sample.name);
    const ContactSprings springs = uniform(1e9, 3e8);
    const auto order = bounded_stiffness(sample.assembly, springs).ordered(springs);
    REQUIRE(order.size() == 4);
    for (std::size_t k = 1; k < order.size(); ++k) {
      CAPTURE(order[k - 1].key, order[k].key);
      CHECK(margin(*order[k - 1].stiffness, *order[k].stiffness) > -1e-9);
    }
    CHECK(bounded_stiffness(sample.assembly, springs, {.bounds = BoundsWanted::affine}).beside.size() == 2);
  }
}

TEST_CASE("the_forces_of_a_strained_state_carry_its_stress") {
  constexpr double strain = 1e-3;
  for (const Sample& sample : assemblies(true)) {
    const ContactSprings springs = uniform(1e9, 3e8);
    const EffectiveStiffness found = effective_stiffness(sample.assembly, springs);
    const auto states = strained_states(sample.assembly, springs, found, strain);
    REQUIRE(states.size() == 3);
    for (std::size_t k = 0; k < 3; ++k) {
      const Tensor2 stress = macroscopic_stress(sample.assembly, states[k].forces);
      CAPTURE(sample.name, k, stress.xx, stress.yy, stress.xy, stress.yx);
      const double rounding = 1e-10 * largest_entry(found.stiffness) * strain;
      CHECK(std::abs(stress.xx - found.stiffness[0][k] * strain) < rounding);
      CHECK(std::abs(stress.yy - found.stiffness[1][k] * strain) < rounding);
      CHECK(std::abs(0.5 * (stress.xy + stress.yx) - found.stiffness[2][k] * strain) < rounding);
    }
  }
}
