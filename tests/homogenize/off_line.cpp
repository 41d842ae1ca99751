// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Moduli of networks of bodies that touch off the lines of their centres.

#include "equidem/assembly/delaunay.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"
#include "support/off_line_networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr Tensor2 unit_strains[] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0.5, 0.5, 0}};

Assembly discs_of(std::uint64_t seed, std::int64_t discs = 16) {
  return delaunay_assembly({.discs = discs, .seed = seed, .radii = {0.8, 1.2}, .periodic = true});
}

double difference(const Matrix3& a, const Matrix3& b) {
  return largest_entry(a + (-1.0) * b) / largest_entry(b);
}

EffectiveStiffness of(const Assembly& assembly, const ContactSprings& springs, Boundary boundary = Boundary::periodic,
                      Rotation rotation = Rotation::from_scene) {
  return effective_stiffness(assembly, springs, {.boundary = boundary, .rotation = rotation, .solver = {}});
}

/// min over motions of the energy of points under unit strains, the translations of body 0 held, over the area.
Matrix3 dense_stiffness(const Assembly& assembly, const ContactSprings& springs, bool rotation) {
  const std::size_t n = 3 * assembly.size();
  DenseMatrix k = stiffness_of_energy(assembly, springs, 1);
  std::vector<DiscMotion> rest(assembly.size());
  const auto energy = [&](const Tensor2& gradient) { return energy_of_points(assembly, springs, rest, gradient); };
  std::vector<std::vector<double>> coupling(3, std::vector<double>(n));
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t p = 0; p < n; ++p) {
      std::vector<DiscMotion> motions(assembly.size());
      DiscMotion& m = motions[p / 3];
      (p % 3 == 0 ? m.u.x : p % 3 == 1 ? m.u.y : m.theta) = 1;
      coupling[a][p] =
          energy_of_points(assembly, springs, motions, unit_strains[a]) - 0.5 * k(p, p) - energy(unit_strains[a]);
    }
  }
  for (std::size_t p = 0; p < n; ++p) {
    if (p >= 2 && (rotation || p % 3 != 2)) continue;
    for (std::size_t q = 0; q < n; ++q) k(p, q) = k(q, p) = 0;
    k(p, p) = 1;
    for (auto& b : coupling) b[p] = 0;
  }
  Matrix3 c{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<double> motion = solve(k, coupling[a]);
    for (std::size_t b = 0; b < 3; ++b) {
      double sum = energy(unit_strains[a] + unit_strains[b]) - energy(unit_strains[a]) - energy(unit_strains[b]);
      for (std::size_t p = 0; p < n; ++p) sum -= coupling[b][p] * motion[p];
      c[a][b] = sum / assembly.area();
    }
  }
  return c;
}

}  // namespace

TEST_CASE("moduli_off_the_line_of_centres_are_those_of_the_least_energy_of_points") {
  const std::uint64_t seed = GENERATE(1, 2, 3);
  const double ratio = GENERATE(0.5, 0.1);
  const Rotation rotation = GENERATE(Rotation::from_scene, Rotation::restrained);
  const Assembly assembly = off_line(discs_of(seed), seed);
  const ContactSprings springs(SpringConstants{1e8, ratio * 1e8});
  const EffectiveStiffness found = of(assembly, springs, Boundary::periodic, rotation);
  const Matrix3 expected = dense_stiffness(assembly, springs, rotation != Rotation::restrained);
  CAPTURE(seed, ratio, rotation == Rotation::restrained, found.error_bound, found.hill_mandel);
  CHECK(difference(found.stiffness, expected) < 1e-11);
  CHECK(largest_entry(found.stiffness + (-1.0) * expected) < found.error_bound + 1e-11 * largest_entry(expected));
  CHECK(found.hill_mandel < 1e-12);
  // Moments balance on bodies that turn freely, and the stress is symmetric; held, they make it unsymmetric.
  if (rotation == Rotation::restrained) {
    CHECK(found.stress_asymmetry > 1e-3);
  } else {
    CHECK(found.stress_asymmetry < 1e-12);
  }
}

TEST_CASE("the_estimate_of_uniform_stress_is_the_inverse_of_its_compliance_off_the_line_of_centres") {
  const Assembly assembly = off_line(discs_of(5, 40), 5);
  const ContactSprings springs(SpringConstants{2, 0.7});
  Tensor2 b;
  for (const Contact& contact : assembly.contacts) {
    const Vec2 l = assembly.branch(contact);
    b += outer(l, l);
  }
  const double det = b.xx * b.yy - b.xy * b.yx;
  const Tensor2 inverse_b = (1 / det) * Tensor2{b.yy, -b.xy, -b.yx, b.xx};
  Matrix3 compliance{};
  constexpr Tensor2 stresses[] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 1, 1, 0}};
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Vec2 n = assembly.contact_arms[c].normal, s = perpendicular(n);
    const Vec2 m = inverse_b * assembly.branch(assembly.contacts[c]);
    for (int p = 0; p < 3; ++p) {
      for (int q = 0; q < 3; ++q) {
        const Vec2 f = stresses[p] * m, g = stresses[q] * m;
        compliance[p][q] += assembly.area() * (dot(f, n) * dot(g, n) / 2 + dot(f, s) * dot(g, s) / 0.7);
      }
    }
  }
  CHECK(difference(uniform_stress_estimate(assembly, springs), inverse(compliance)) < 1e-12);
  CHECK_THROWS_WITH(uniform_stress_estimate(assembly, ContactSprings(SpringConstants{1, 0})),
                    Catch::Contains("kT = 0"));
}

TEST_CASE("the_mean_stress_is_that_of_the_bodies_by_their_areas_off_the_line_of_centres") {
  const Assembly assembly = off_line(discs_of(6, 40), 6);
  const std::vector<ContactForce> forces = samples::random_forces(assembly, 6);
  const Tensor2 whole = macroscopic_stress(assembly, forces);
  const Tensor2 sum = average_stress(assembly, disc_stresses(assembly, forces), [](std::size_t) { return true; });
  CHECK(samples::difference(whole, sum) < 1e-13 * samples::largest(whole));
  Tensor2 expected;
  for (std::size_t c = 0; c < forces.size(); ++c)
    expected += outer(force_on_i(frame_of(assembly, c), forces[c]), assembly.branch(assembly.contacts[c]));
  CHECK(samples::difference(whole, (1 / assembly.area()) * expected) < 1e-13 * samples::largest(whole));
}

// Each of them joins two bodies, so that it is its own balance that leaves it nothing to carry.
TEST_CASE("bodies_that_carry_nothing_off_the_line_of_centres_are_left_out_without_loss") {
  Assembly assembly = off_line(discs_of(8, 30), 8);
  std::vector<SpringConstants> springs(assembly.contacts.size(), {1e8, 0.4e8});
  const Matrix3 without = of(assembly, ContactSprings(springs)).stiffness;
  const auto add_body = [&](Vec2 centre) {
    assembly.centres.push_back(centre);
    assembly.radii.push_back(1);
    assembly.sections.push_back({std::numbers::pi, 2});
    assembly.cell_areas.push_back(0);
    return static_cast<std::int32_t>(assembly.size() - 1);
  };
  /// At a point beside the centre of j.
  const auto touch = [&](std::int32_t i, std::int32_t j, Vec2 normal, Vec2 beside, double kT) {
    place_contact(assembly, {.i = i, .j = j}, normal, assembly.centres[j] + beside - assembly.centres[i]);
    springs.push_back({1e8, kT});
  };
  const std::int32_t hanging = add_body(assembly.centres[0] + Vec2{0.7, 0.4});
  touch(0, hanging, {0.6, 0.8}, {0.2, -0.5}, 1e8);
  const std::int32_t between = add_body(assembly.centres[3] + Vec2{0.5, 0.5});  // normal forces on different lines
  touch(3, between, {1, 0}, {-0.3, 0.5}, 0);
  touch(12, between, {-1, 0}, {0.3, -0.5}, 0);
  const std::int32_t held = add_body(assembly.centres[6] + Vec2{0.5, 0.5});  // one of two may slip
  touch(6, held, {0, 1}, {0.2, -0.5}, 0);
  touch(15, held, {1, 0}, {-0.2, 0.5}, 1e8);
  check(assembly);
  const EffectiveStiffness found = of(assembly, ContactSprings(springs));
  CHECK(found.discs_removed == 3);
  CHECK(difference(found.stiffness, without) < 1e-12);
  // On one line two normal forces squeeze a body, and it stays.
  const std::int32_t squeezed = add_body(assembly.centres[9] + Vec2{0.5, 0.5});
  touch(9, squeezed, {1, 0}, {-0.3, 0.3}, 0);
  touch(18, squeezed, {-1, 0}, {0.4, 0.3}, 0);
  const EffectiveStiffness with_squeezed = of(assembly, ContactSprings(springs));
  CHECK(with_squeezed.discs_removed == 3);
  CHECK(difference(with_squeezed.stiffness, without) > 1e-3);
}
