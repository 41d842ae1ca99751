// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Complex stiffness of networks of viscoelastic springs: closed forms, a dense oracle, limits, and what must be
/// refused.
#include "equidem/homogenize/viscoelastic_stiffness.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;

namespace {

using Amplitude = std::complex<double>;

/// Every model of both springs, with different times.
std::vector<Viscoelasticity> pairs_of_models() {
  const std::vector<ViscoelasticSpring> models = {
      {},
      {.model = SpringModel::kelvin_voigt, .time = 0.3},
      {.model = SpringModel::maxwell, .time = 0.02},
      {.model = SpringModel::standard_solid, .time = 1.5, .arm = 4},
      {.model = SpringModel::table, .table = {{1e-4, {0.2, 0.5}}, {1, {0.7, 0.01}}, {1e4, {3, 0}}}}};
  std::vector<Viscoelasticity> pairs;
  for (const ViscoelasticSpring& normal : models) {
    for (const ViscoelasticSpring& tangential : models) pairs.push_back({normal, tangential});
  }
  return pairs;
}

HarmonicStiffness harmonic(const Assembly& assembly, const ContactSprings& springs, const Viscoelasticity& law,
                           double frequency, const HomogenizeOptions& options = {}) {
  return viscoelastic_stiffness(assembly, springs, law, std::array{frequency}, options).harmonic.at(0);
}

/// Largest modulus of the difference from storage + i loss over the largest modulus of those.
double complex_difference(const HarmonicStiffness& c, const Matrix3& storage, const Matrix3& loss) {
  double difference = 0, size = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t s = 0; s < 3; ++s) {
      const Amplitude exact{storage[r][s], loss[r][s]};
      difference = std::max(difference, std::abs(Amplitude{c.storage[r][s], c.loss[r][s]} - exact));
      size = std::max(size, std::abs(exact));
    }
  }
  return difference / size;
}

/// The assembly with forces at rest, some pulling and some pressing: `share` of kN times the length of each contact.
Assembly with_forces(Assembly assembly, const ContactSprings& springs, double share) {
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Vec2 l = assembly.branch(assembly.contacts[c]);
    const double twice = 2 * std::atan2(l.y, l.x), size = share * springs[c].kN * norm(l);
    assembly.contact_normal_force.push_back(size * (0.3 + std::cos(twice)));
    assembly.contact_tangential_force.push_back(0.4 * size * std::sin(twice));
  }
  return assembly;
}

/// Complex stiffness by dense algebra: every contact adds k g g^T with g the derivative of its stretch or slip by the
/// unknowns, forces at rest N and T of discs N/l s s^T - T/l (n s^T + s n^T) with n, s of the displacements alone, and
/// 1/A (sum k a a^T - f^T K^-1 f) remains of the mean strains a.
struct DenseStiffness {
  Matrix3 storage{}, loss{};
};

DenseStiffness dense_stiffness(const Assembly& assembly, const ContactSprings& springs, const Viscoelasticity& law,
                               double frequency, const std::vector<std::uint8_t>& held) {
  const auto unknowns = static_cast<Eigen::Index>(3 * assembly.size());
  const double scale = assembly.mean_radius();
  constexpr Tensor2 strains[] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0.5, 0.5, 0}};
  Eigen::MatrixXcd k = Eigen::MatrixXcd::Zero(unknowns, unknowns), f = Eigen::MatrixXcd::Zero(unknowns, 3);
  Eigen::Matrix3cd stiffness = Eigen::Matrix3cd::Zero();
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    const EndGradients g = end_gradients(frame, scale);
    const auto row_of = [&](const std::array<double, 3>& of_i, const std::array<double, 3>& of_j) {
      Eigen::VectorXcd row = Eigen::VectorXcd::Zero(unknowns);
      for (int r = 0; r < 3; ++r) {
        row(3 * contact.i + r) += of_i[r];
        row(3 * contact.j + r) += of_j[r];
      }
      return row;
    };
    const auto add = [&](Amplitude spring, const Eigen::VectorXcd& row, Vec2 along, const Eigen::VectorXcd& other,
                         Vec2 across) {
      Eigen::RowVector3cd affine, of_other;
      for (int e = 0; e < 3; ++e) {
        affine(e) = dot(strains[e] * assembly.branch(contact), along);
        of_other(e) = dot(strains[e] * assembly.branch(contact), across);
      }
      k += spring * row * other.transpose();
      f += spring * row * of_other;
      stiffness += spring * affine.transpose() * of_other;
    };
    const Vec2 n = frame.normal, t = frame.tangent();
    const Eigen::VectorXcd stretch = row_of(g.i.normal, g.j.normal), slip = row_of(g.i.tangential, g.j.tangential);
    add(springs[c].kN * law.normal.factor(frequency), stretch, n, stretch, n);
    add(springs[c].kT * law.tangential.factor(frequency), slip, t, slip, t);
    if (!springs.prestressed()) continue;
    const Eigen::VectorXcd apart = row_of({-n.x, -n.y, 0}, {n.x, n.y, 0}),
                           aside = row_of({-t.x, -t.y, 0}, {t.x, t.y, 0});
    const double l = norm(assembly.branch(contact));
    add(assembly.contact_normal_force[c] / l, aside, t, aside, t);
    add(-assembly.contact_tangential_force[c] / l, apart, n, aside, t);
    add(-assembly.contact_tangential_force[c] / l, aside, t, apart, n);
  }
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    for (const Eigen::Index e : {3 * static_cast<Eigen::Index>(d), 3 * static_cast<Eigen::Index>(d) + 1}) {
      if (held[d] == 0) continue;
      k.row(e).setZero();
      k.col(e).setZero();
      f.row(e).setZero();
      k(e, e) = 1;
    }
  }
  stiffness -= f.transpose() * k.fullPivLu().solve(f);
  DenseStiffness result;
  for (int r = 0; r < 3; ++r) {
    for (int s = 0; s < 3; ++s) {
      result.storage[r][s] = stiffness(r, s).real() / assembly.area();
      result.loss[r][s] = stiffness(r, s).imag() / assembly.area();
    }
  }
  return result;
}

}  // namespace

TEST_CASE("lattices_have_the_complex_moduli_of_their_relation") {
  const double frequency = GENERATE(1e-4, 0.3, 7.0, 1e4), ratio = GENERATE(0.25, 1.0);
  for (const Viscoelasticity& law : pairs_of_models()) {
    const Amplitude kN = 1e9 * law.normal.factor(frequency), kT = ratio * 1e9 * law.tangential.factor(frequency);
    const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
    const Rotation rotation = frequency < 1 ? Rotation::from_scene : Rotation::restrained;
    for (const Lattice& lattice : all_lattices()) {
      const Assembly cell = lattice.make({.columns = 4, .rows = 6, .radius = 0.005, .periodic = true});
      const HarmonicStiffness c = harmonic(cell, springs, law, frequency, {.rotation = rotation});
      CAPTURE(lattice.name, frequency, ratio, to_string(law.normal.model), to_string(law.tangential.model));
      if (lattice.relation.equal_springs != nullptr) {  // the square lattice, isotropic for kT = kN alone
        CHECK(complex_difference(c, {{{kN.real(), 0, 0}, {0, kN.real(), 0}, {0, 0, kT.real() / 2}}},
                                 {{{kN.imag(), 0, 0}, {0, kN.imag(), 0}, {0, 0, kT.imag() / 2}}}) < 1e-12);
        continue;
      }
      // The relation is linear in the springs: real and imaginary parts obey it each by itself.
      const SheetModuli storage = lattice.relation.moduli({kN.real(), kT.real()}, {});
      const SheetModuli loss = lattice.relation.moduli({kN.imag(), kT.imag()}, {});
      CHECK(complex_difference(c, isotropic_stiffness(storage.bulk, storage.shear),
                               isotropic_stiffness(loss.bulk, loss.shear)) < 1e-12);
      const HarmonicModuli m = harmonic_moduli(c);
      const Amplitude nu = (1.0 - kT / kN) / 4.0;  // eq. (22) with the complex ratio
      CAPTURE(nu, m.poisson_strain, c.error_bound);
      // Entries are right relative to the largest: the smaller modulus has fewer digits, and their ratio too.
      const double size = std::max(std::abs(m.bulk_modulus_2d), std::abs(m.shear_modulus));
      CHECK(std::abs(m.poisson_strain - nu) < 1e-12 * std::max(1.0, std::norm(kT / kN)));
      CHECK(std::abs(m.shear_modulus - Amplitude{storage.shear, loss.shear}) < 1e-12 * size);
      CHECK(c.relative_residual < 1e-14);
      // Eqs. (20) and (21) with the solid fraction and the contact density of this lattice.
      const IsotropicMeasures measures{std::numbers::pi / (2 * std::numbers::sqrt3), 3 / std::numbers::pi};
      const SheetModuli mean_storage = isotropic_relation.moduli({kN.real(), kT.real()}, measures);
      const SheetModuli mean_loss = isotropic_relation.moduli({kN.imag(), kT.imag()}, measures);
      CHECK(std::abs(m.bulk_modulus_2d - Amplitude{mean_storage.bulk, mean_loss.bulk}) < 1e-12 * size);
      CHECK(std::abs(m.shear_modulus - Amplitude{mean_storage.shear, mean_loss.shear}) < 1e-12 * size);
    }
  }
}

TEST_CASE("random_networks_have_the_complex_stiffness_of_dense_algebra") {
  const bool periodic = GENERATE(true, false);
  for (const Sample& sample : assemblies(periodic)) {
    if (sample.name == "square") continue;  // its gears leave the dense matrix singular
    const ContactSprings springs = random_springs(sample.assembly, 0.1, 5);
    std::vector<std::uint8_t> held(sample.assembly.size(), 0);
    if (periodic) held[0] = 1;
    if (!periodic) held = boundary_discs(sample.assembly);
    const HomogenizeOptions options{.boundary = periodic ? Boundary::periodic : Boundary::displacement};
    for (const Viscoelasticity& law : pairs_of_models()) {
      for (const double frequency : {0.1, 20.0}) {
        const HarmonicStiffness c = harmonic(sample.assembly, springs, law, frequency, options);
        const DenseStiffness exact = dense_stiffness(sample.assembly, springs, law, frequency, held);
        const double difference = complex_difference(c, exact.storage, exact.loss);
        CAPTURE(sample.name, periodic, frequency, to_string(law.normal.model), to_string(law.tangential.model),
                difference, c.condition, c.relative_residual);
        CHECK(difference < 2e-13 * std::max(1.0, 1e-2 * c.condition));
        CHECK(c.relative_residual < 2e-15);
        CHECK(c.error_bound < 1e-12 * (largest(c.storage) + largest(c.loss)));
        // Passive: no strain yields energy in a cycle.
        CHECK(eigenstrains(c.loss).values[0] > -4 * c.error_bound);
      }
      if (sample.name != "hexagonal") break;
    }
  }
}

TEST_CASE("under_forces_at_rest_the_complex_stiffness_is_that_of_dense_algebra") {
  const bool periodic = GENERATE(true, false);
  for (const Sample& sample : assemblies(periodic)) {
    if (sample.name == "square") continue;
    const ContactSprings elastic = random_springs(sample.assembly, 0.1, 5);
    const Assembly assembly = with_forces(sample.assembly, elastic, 0.05);
    const ContactSprings springs = elastic.with_prestress(prestress_of(assembly));
    std::vector<std::uint8_t> held(assembly.size(), 0);
    if (periodic) held[0] = 1;
    if (!periodic) held = boundary_discs(assembly);
    const HomogenizeOptions options{.boundary = periodic ? Boundary::periodic : Boundary::displacement};
    // what leads to the Cauchy stress is that of the elastic springs, whatever these are
    const Matrix3 change = effective_stiffness(assembly, springs, options).stiffness +
                           (-1.0) * dense_stiffness(assembly, springs, {}, 1, held).storage;
    CHECK(largest(change) > 1e-3 * elastic.largest());
    for (const Viscoelasticity& law : pairs_of_models()) {
      if (!keeps_forces(law.normal) || !keeps_forces(law.tangential)) continue;
      const bool all_laws = sample.name == "hexagonal";  // dense algebra of the larger ones takes long
      if (!all_laws && law.normal.model == SpringModel::elastic) continue;
      const HarmonicStiffness c = harmonic(assembly, springs, law, 0.7, options);
      const DenseStiffness exact = dense_stiffness(assembly, springs, law, 0.7, held);
      const DenseStiffness without = dense_stiffness(assembly, elastic, law, 0.7, held);
      const double difference = complex_difference(c, exact.storage + change, exact.loss);
      CAPTURE(sample.name, periodic, to_string(law.normal.model), to_string(law.tangential.model), difference,
              c.condition, relative_difference(without.storage, exact.storage));
      CHECK(difference < 2e-13 * std::max(1.0, 1e-2 * c.condition));
      CHECK(relative_difference(without.storage, exact.storage) > 1e-3);
      CHECK(c.error_bound < 1e-12 * (largest(c.storage) + largest(c.loss)));
      if (!all_laws) break;
    }
  }
}

TEST_CASE("springs_that_lose_their_force_and_forces_that_buckle_are_refused") {
  const ContactSprings elastic(SpringConstants{1e9, 0.5e9});
  const Assembly cell = with_forces(assemblies(true)[2].assembly, elastic, 0.02);
  const ContactSprings springs = elastic.with_prestress(prestress_of(cell));
  const auto refused = [&](const ViscoelasticSpring& normal, const ContactSprings& of) {
    return message_of([&] { harmonic(cell, of, {normal, {}}, 1); });
  };
  CHECK_THAT(refused({.model = SpringModel::maxwell, .time = 1}, springs), Catch::Contains("flows until it carries"));
  CHECK_THAT(refused({.model = SpringModel::table, .table = {{0.1, 1}, {2, 2}}}, springs),
             Catch::Contains("stiffness at rest is not known"));
  CHECK_THAT(
      refused({.model = SpringModel::kelvin_voigt, .time = 1}, elastic.with_prestress(springs.scaled_prestress(-100))),
      Catch::Contains("motions would grow"));
}

TEST_CASE("without_loss_the_stiffness_is_the_elastic_one") {
  for (const Boundary boundary : {Boundary::periodic, Boundary::displacement}) {
    for (const Sample& sample : assemblies(boundary == Boundary::periodic)) {
      const ContactSprings springs = random_springs(sample.assembly, 0.1, 7);
      const HomogenizeOptions options{.boundary = boundary};
      const EffectiveStiffness elastic = effective_stiffness(sample.assembly, springs, options);
      for (const double loss : {0.0, 1e-15, 1e-8}) {
        const ViscoelasticSpring weak{.model = SpringModel::kelvin_voigt, .time = loss / (2 * std::numbers::pi)};
        const HarmonicStiffness c = harmonic(sample.assembly, springs, {weak, weak}, 1, options);
        CAPTURE(sample.name, loss, relative_difference(c.storage, elastic.stiffness));
        CHECK(relative_difference(c.storage, elastic.stiffness) < 1e-13);
        CHECK(largest(c.loss + (-loss) * elastic.stiffness) <= 1e-13 * loss * largest(elastic.stiffness));
      }
    }
  }
}

TEST_CASE("slow_and_fast_limits_are_elastic_with_relaxed_and_unrelaxed_springs") {
  for (const Sample& sample : assemblies(true)) {
    const ContactSprings springs = random_springs(sample.assembly, 0.1, 9);
    const Viscoelasticity solid{{.model = SpringModel::standard_solid, .time = 1, .arm = 3},
                                {.model = SpringModel::standard_solid, .time = 0.01, .arm = 0.5}};
    const auto elastic = [&](double of_normal, double of_tangential) {
      return effective_stiffness(sample.assembly, springs.changed([&](SpringConstants k) {
               return SpringConstants{of_normal * k.kN, of_tangential * k.kT};
             }))
          .stiffness;
    };
    const HarmonicStiffness slow = harmonic(sample.assembly, springs, solid, 1e-16);
    const HarmonicStiffness fast = harmonic(sample.assembly, springs, solid, 1e17);
    CAPTURE(sample.name);
    CHECK(relative_difference(slow.storage, elastic(1, 1)) < 1e-13);
    CHECK(largest(slow.loss) < 1e-13 * largest(slow.storage));
    CHECK(relative_difference(fast.storage, elastic(4, 1.5)) < 1e-13);
    CHECK(largest(fast.loss) < 1e-13 * largest(fast.storage));
  }
}

TEST_CASE("motions_without_energy_are_held_at_every_frequency") {
  // A disc of the hexagonal lattice that keeps two contacts in line can leave it at no cost where kT = 0.
  Assembly cell = hexagonal_lattice({.columns = 6, .rows = 6, .radius = 0.005, .periodic = true});
  cell.facet_lengths.clear();
  std::erase_if(cell.contacts,
                [&](const Contact& c) { return (c.i == 14 || c.j == 14) && std::abs(cell.branch(c).y) > 1e-6; });
  const ContactSprings springs(SpringConstants{1e9, 0});
  const EffectiveStiffness elastic = effective_stiffness(cell, springs);
  REQUIRE(elastic.mechanisms == 1);
  const ViscoelasticSpring solid{.model = SpringModel::standard_solid, .time = 1, .arm = 3};
  for (const double frequency : {1e-3, 0.2, 1e3}) {
    const HarmonicStiffness c = harmonic(cell, springs, {solid, {}}, frequency);
    const Amplitude m = solid.factor(frequency);
    CAPTURE(frequency);
    CHECK(complex_difference(c, m.real() * elastic.stiffness, m.imag() * elastic.stiffness) < 1e-13);
  }
}

TEST_CASE("springs_that_are_not_passive_or_not_known_are_refused") {
  const Assembly cell = assemblies(true)[0].assembly;
  const ContactSprings springs(SpringConstants{1e9, 0.5e9});
  const auto refused = [&](const ViscoelasticSpring& normal, double frequency, const ContactSprings& of,
                           const HomogenizeOptions& options = {}) {
    return message_of([&] { harmonic(cell, of, {normal, {}}, frequency, options); });
  };
  const auto table = [](std::vector<MeasuredSpring> rows) {
    return ViscoelasticSpring{.model = SpringModel::table, .table = std::move(rows)};
  };
  const ViscoelasticSpring maxwell{.model = SpringModel::maxwell, .time = 1};
  CHECK_THAT(refused(maxwell, 0, springs), Catch::Contains("at rest a Maxwell spring has flowed"));
  CHECK_THAT(refused(maxwell, -1, springs), Catch::Contains("frequency"));
  CHECK_THAT(refused({.model = SpringModel::maxwell, .time = 0}, 1, springs), Catch::Contains("without viscosity"));
  CHECK_THAT(refused({.model = SpringModel::kelvin_voigt, .time = -1}, 1, springs), Catch::Contains("viscosity"));
  CHECK_THAT(refused({.model = SpringModel::standard_solid, .time = 1, .arm = 0}, 1, springs), Catch::Contains("arm"));
  CHECK_THAT(refused(table({}), 1, springs), Catch::Contains("empty"));
  CHECK_THAT(refused(table({{1, 1}, {1, 2}}), 1, springs), Catch::Contains("do not ascend"));
  CHECK_THAT(refused(table({{2, 1}, {1, 2}}), 1, springs), Catch::Contains("do not ascend"));
  CHECK_THAT(refused(table({{1, {1, -0.1}}, {2, 2}}), 1, springs), Catch::Contains("give away energy in every cycle"));
  CHECK_THAT(refused(table({{1, {-1, 0.1}}, {2, 2}}), 1, springs), Catch::Contains("unstable"));
  CHECK_THAT(refused(table({{1, 1}, {2, 2}}), 2.1, springs), Catch::Contains("outside the table"));
  CHECK_THAT(refused(table({{1, 1}, {2, 2}}), 0.9, springs), Catch::Contains("outside the table"));
  CHECK_THAT(refused(maxwell, 1, ContactSprings(SpringConstants{1e9, -1e8})), Catch::Contains("every rotation grows"));
  CHECK_THAT(refused(maxwell, 1, springs, {.boundary = Boundary::traction}), Catch::Contains("from mean strains"));
  // Normal springs that have flowed leave the tangential ones alone, which a double cannot show beside them.
  CHECK_THAT(refused(maxwell, 1e-20, springs), Catch::Contains("too far apart"));
}
