// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The geometric stiffness of a contact is the derivative of the forces of finite motions that runs use.
#include "equidem/contact/prestress/prestress.hpp"

#include <array>
#include <cmath>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/geometry/shape_contact.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

template <typename Number>
using Six = std::array<Number, 6>;  ///< (u_x, u_y, theta) of i, then of j, or their forces
using Matrix6 = std::array<Six<double>, 6>;

/// The derivative of forces by motions, by central differences of three widths, extrapolated to the order 6.
template <typename Number, typename Forces>
Matrix6 minus_derivative(const Forces& forces, Number width) {
  Matrix6 k{};
  for (std::size_t q = 0; q < 6; ++q) {
    const auto difference = [&](Number h, std::size_t p) {
      Six<Number> ahead{}, behind{};
      ahead[q] = h, behind[q] = -h;
      return (forces(ahead)[p] - forces(behind)[p]) / (2 * h);
    };
    for (std::size_t p = 0; p < 6; ++p) {
      const Number one = difference(width, p), two = difference(2 * width, p), four = difference(4 * width, p);
      const Number fine = (4 * one - two) / 3, coarse = (4 * two - four) / 3;
      k[p][q] = -static_cast<double>((16 * fine - coarse) / 15);
    }
  }
  return k;
}

/// The tangent that statics assembles, with rotations in rad (a = 1).
Matrix6 tangent(const ContactFrame& frame, const SpringConstants& k, const ContactPrestress& prestress) {
  const ContactStiffness stiffness{.ends = end_gradients(frame, 1), .kN = k.kN, .kT = k.kT, .prestress = &prestress};
  const auto end = [&](int p) -> const EndGradient& { return p == 0 ? stiffness.ends.i : stiffness.ends.j; };
  Matrix6 result{};
  for (int p = 0; p < 2; ++p) {
    for (int q = 0; q < 2; ++q) {
      std::array<double, 9> block{};
      stiffness.add<3>(end(p), end(q), block.data());
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) result[3 * p + r][3 * q + c] = block[3 * r + c];
    }
  }
  return result;
}

double largest_difference(const Matrix6& a, const Matrix6& b) {
  double largest = 0;
  for (std::size_t p = 0; p < 6; ++p)
    for (std::size_t q = 0; q < 6; ++q) largest = std::max(largest, std::abs(a[p][q] - b[p][q]));
  return largest;
}

Assembly two_discs(Vec2 branch, double r_i, double r_j, ContactForce at_rest) {
  Assembly pair;
  pair.centres = {{0, 0}, branch};
  pair.radii = {r_i, r_j};
  pair.contacts = {{.i = 0, .j = 1, .lever_i = r_i, .lever_j = r_j}};
  pair.contact_normal_force = {at_rest.normal};
  pair.contact_tangential_force = {at_rest.tangential};
  return pair;
}

}  // namespace

TEST_CASE("the_prestress_of_bonded_discs_is_the_derivative_of_the_finite_bond") {
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const double angle = random.uniform(0, 6.28), length = random.uniform(0.5, 2);
    const ContactForce at_rest{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
    const SpringConstants k{random.uniform(0.5, 2), random.uniform(-0.2, 1)};
    const Vec2 branch = length * Vec2{std::cos(angle), std::sin(angle)};
    // The finite bond is defined for any levers; the springs of statics are those of levers that add up to the
    // distance.
    const double r_i = random.uniform(0.2, 0.8) * length, r_j = length - r_i;
    const Assembly pair = two_discs(branch, r_i, r_j, at_rest);
    const FiniteBond bond = bond_of(pair, pair.contacts[0], k);
    const auto forces = [&](const Six<long double>& q) {
      const BondMotion<long double> motion{q[3] - q[0], q[4] - q[1], q[2], q[5]};
      const DeformationOf<long double> d = bond_deformation(bond, motion);
      const ForceOf<long double> force{at_rest.normal + k.kN * d.normal, at_rest.tangential + k.kT * d.tangential};
      const BondForces<long double> f = bond_forces(bond, motion, force);
      return Six<long double>{f.x, f.y, f.moment_i, -f.x, -f.y, f.moment_j};
    };
    const Matrix6 expected = minus_derivative<long double>(forces, 1e-3L);
    const Matrix6 found = tangent(frame_of(pair, 0), k, prestress_of(pair)[0]);
    CAPTURE(trial, angle, length, at_rest.normal, at_rest.tangential, k.kN, k.kT);
    CHECK(largest_difference(found, expected) < 1e-12);
    for (std::size_t p = 0; p < 6; ++p)
      for (std::size_t q = 0; q < p; ++q) CHECK(found[p][q] == Approx(found[q][p]).margin(1e-15));
  }
}

namespace {

/// Two ellipses with the overlap given, one against the other along a direction at random, and what they are as bodies
/// of an assembly.
class EllipsePair {
 public:
  EllipsePair(Random& random, double overlap) : overlap_(overlap) {
    for (int e = 0; e < 2; ++e) {
      a_[e] = random.uniform(0.6, 1.2);
      b_[e] = a_[e] * random.uniform(0.4, 1);
      angle_[e] = random.uniform(0, 6.28);
    }
    const double way = random.uniform(0, 6.28);
    branch_ = (a_[0] + a_[1]) * Vec2{std::cos(way), std::sin(way)};
    for (int k = 0; k < 50; ++k) {
      const EllipseContact now = contact({});
      branch_ -= (now.gap + overlap) * now.normal;
    }
  }
  [[nodiscard]] Ellipse body(int e, const Six<double>& q) const {
    return Ellipse::at_angle(a_[e], b_[e], angle_[e] + q[e == 0 ? 2 : 5]);
  }
  [[nodiscard]] EllipseContact contact(const Six<double>& q) const {
    return contact_of_ellipses(body(0, q), body(1, q), branch_ + Vec2{q[3] - q[0], q[4] - q[1]});
  }
  /// Derivatives of the slip: the arcs that the points with the common normal have gone along both outlines. With the
  /// angle phi of the normal, radii of curvature rho and turns theta it is rho_i d(phi - theta_i) + rho_j d(phi -
  /// theta_j), and s . d(O_j - O_i) = (rho_i + rho_j + gap) d phi for the centres of curvature O.
  [[nodiscard]] Six<double> slip_gradient(const Six<double>& q) const {
    const EllipseContact now = contact(q);
    const Vec2 n = now.normal, s = perpendicular(n);
    const double rho_i = support(body(0, q), n).radius, rho_j = support(body(1, q), -n).radius;
    const Vec2 to_i = now.arm_i - rho_i * n, to_j = now.arm_j + rho_j * n;
    const Six<double> moved{-s.x, -s.y, -dot(perpendicular(to_i), s), s.x, s.y, dot(perpendicular(to_j), s)};
    Six<double> gradient{};
    for (std::size_t k = 0; k < 6; ++k) gradient[k] = moved[k] * (rho_i + rho_j) / (rho_i + rho_j + now.gap);
    gradient[2] -= rho_i, gradient[5] -= rho_j;
    return gradient;
  }
  /// The slip of a run at unit rates of the motion: that of the material points in the middle of the overlap.
  [[nodiscard]] Six<double> slip_rate(const Six<double>& q) const {
    const EllipseContact now = contact(q);
    const Vec2 n = now.normal, s = perpendicular(n);
    const Vec2 arm_i = now.arm_i + 0.5 * now.gap * n, arm_j = now.arm_j - 0.5 * now.gap * n;
    return {-s.x, -s.y, -dot(perpendicular(arm_i), s), s.x, s.y, dot(perpendicular(arm_j), s)};
  }
  [[nodiscard]] Assembly assembly(ContactForce at_rest) const {
    const EllipseContact now = contact({});
    const Vec2 n = now.normal, s = perpendicular(n);
    const Vec2 arm_i = now.arm_i - 0.5 * overlap_ * n, arm_j = now.arm_j + 0.5 * overlap_ * n;
    Assembly pair;
    pair.centres = {{0, 0}, branch_};
    pair.radii = {std::sqrt(a_[0] * b_[0]), std::sqrt(a_[1] * b_[1])};
    pair.contacts = {{.i = 0, .j = 1, .lever_i = dot(arm_i, n), .lever_j = -dot(arm_j, n)}};
    pair.contact_arms = {{n, dot(arm_i, s), -dot(arm_j, s)}};
    pair.contact_normal_force = {at_rest.normal};
    pair.contact_tangential_force = {at_rest.tangential};
    pair.contact_curvature_i = {1 / (support(body(0, {}), n).radius - 0.5 * overlap_)};
    pair.contact_curvature_j = {1 / (support(body(1, {}), -n).radius - 0.5 * overlap_)};
    return pair;
  }

 private:
  double overlap_;
  double a_[2], b_[2], angle_[2];
  Vec2 branch_;
};

}  // namespace

// The force of colliding bodies is kN times the overlap along the common normal; the point that it acts in rolls along
// both outlines.
TEST_CASE("the_prestress_of_ellipses_is_the_derivative_of_their_contact_force") {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const double kN = random.uniform(0.5, 2), overlap = random.uniform(0.001, 0.05);
    const EllipsePair bodies(random, overlap);
    REQUIRE(bodies.contact({}).gap == Approx(-overlap).epsilon(1e-9));
    const auto forces = [&](const Six<double>& q) {
      const EllipseContact now = bodies.contact(q);
      const Vec2 on_i = kN * now.gap * now.normal;
      return Six<double>{on_i.x, on_i.y, cross(now.arm_i, on_i), -on_i.x, -on_i.y, -cross(now.arm_j, on_i)};
    };
    const Assembly pair = bodies.assembly({kN * bodies.contact({}).gap, 0});
    const Matrix6 expected = minus_derivative<double>(forces, 5e-4);
    const Matrix6 found = tangent(frame_of(pair, 0), {kN, 0}, prestress_of(pair)[0]);
    const Matrix6 without = tangent(frame_of(pair, 0), {kN, 0}, {});
    CAPTURE(trial, kN, overlap);
    CHECK(largest_difference(found, expected) < 1e-7 * kN * overlap);
    CHECK(largest_difference(without, expected) > 0.1 * kN * overlap);
  }
}

TEST_CASE("the_prestress_of_ellipses_with_friction_is_the_derivative_of_their_slip_by_arcs") {
  Random random(11);
  double largest = 0, least_size = 1;
  for (int trial = 0; trial < 40; ++trial) {
    const EllipsePair bodies(random, 0);
    const double along = random.uniform(-1, 1);
    const auto forces = [&](const Six<double>& q) {
      Six<double> f = bodies.slip_gradient(q);
      for (double& x : f) x *= -along;
      return f;
    };
    const Assembly pair = bodies.assembly({0, along});
    const Matrix6 found = tangent(frame_of(pair, 0), {0, 0}, prestress_of(pair)[0]);
    const Matrix6 expected = minus_derivative<double>(forces, 1e-3);
    largest = std::max(largest, largest_difference(found, expected) / std::abs(along));
    least_size = std::min(least_size, largest_difference(found, {}) / std::abs(along));
    // The gradient is that of a function, and where bodies touch the slip of a run.
    const Six<double> slides = bodies.slip_gradient({}), rate = bodies.slip_rate({});
    for (std::size_t p = 0; p < 6; ++p) {
      CHECK(slides[p] == Approx(rate[p]).margin(1e-12));
      for (std::size_t q = 0; q < p; ++q) CHECK(expected[p][q] == Approx(expected[q][p]).margin(1e-8));
    }
  }
  CAPTURE(largest, least_size);
  CHECK(largest < 1e-7);
  CHECK(least_size > 0.1);
}

TEST_CASE("arcs_of_circles_off_the_centres_have_the_prestress_of_the_finite_bond_of_their_discs") {
  // Clumps: two discs fixed to bodies whose centres lie elsewhere.
  Random random(17);
  for (int trial = 0; trial < 40; ++trial) {
    const double way = random.uniform(0, 6.28), r_i = random.uniform(0.5, 1), r_j = random.uniform(0.5, 1);
    const Vec2 n{std::cos(way), std::sin(way)}, s = perpendicular(n);
    const Vec2 to_i{random.uniform(-1, 1), random.uniform(-1, 1)}, to_j{random.uniform(-1, 1), random.uniform(-1, 1)};
    const ContactForce at_rest{random.uniform(-1, 1), random.uniform(-1, 1)};
    // Body i at the origin, its disc at to_i; that of j at to_j from the centre of j.
    const Vec2 arm_i = to_i + r_i * n, arm_j = to_j - r_j * n;
    Assembly pair;
    pair.centres = {{0, 0}, arm_i - arm_j};
    pair.radii = {1, 1};
    pair.contacts = {{.i = 0, .j = 1, .lever_i = dot(arm_i, n), .lever_j = -dot(arm_j, n)}};
    pair.contact_arms = {{n, dot(arm_i, s), -dot(arm_j, s)}};
    pair.contact_normal_force = {at_rest.normal};
    pair.contact_tangential_force = {at_rest.tangential};
    pair.contact_curvature_i = {1 / r_i};
    pair.contact_curvature_j = {1 / r_j};
    const FiniteBond bond{(r_i + r_j) * n, r_i, r_j, {0, 0}};
    const auto turned = [](Vec2 x, long double by) {
      const long double c = std::cos(by), t = std::sin(by);
      return std::array{c * x.x - t * x.y, t * x.x + c * x.y};
    };
    const auto forces = [&](const Six<long double>& q) {
      const auto i = turned(to_i, q[2]), j = turned(to_j, q[5]);
      const BondMotion<long double> motion{q[3] - q[0] + j[0] - to_j.x - (i[0] - to_i.x),
                                           q[4] - q[1] + j[1] - to_j.y - (i[1] - to_i.y), q[2], q[5]};
      const BondForces<long double> f = bond_forces(bond, motion, {at_rest.normal, at_rest.tangential});
      return Six<long double>{f.x,  f.y,  f.moment_i + i[0] * f.y - i[1] * f.x,
                              -f.x, -f.y, f.moment_j - (j[0] * f.y - j[1] * f.x)};
    };
    CAPTURE(trial, way, r_i, r_j, at_rest.normal, at_rest.tangential);
    const Matrix6 found = tangent(frame_of(pair, 0), {0, 0}, prestress_of(pair)[0]);
    CHECK(largest_difference(found, minus_derivative<long double>(forces, 1e-3L)) < 1e-11);
  }
}

TEST_CASE("a_disc_on_a_wall_rolls_and_slides_without_geometric_stiffness") {
  Assembly pair = two_discs({0, -2}, 1, 1, {-0.1, 0.02});
  pair.contact_curvature_i = {1};
  pair.contact_curvature_j = {0};
  const Matrix6 found = tangent(frame_of(pair, 0), {0, 0}, prestress_of(pair)[0]);
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t q = 0; q < 3; ++q) CHECK(std::abs(found[p][q]) < 1e-16);
}

TEST_CASE("discs_by_their_curvatures_have_the_prestress_of_discs") {
  Assembly pair = two_discs({1.2, 0.9}, 0.6, 0.9, {-0.2, 0.1});
  const ContactFrame frame = frame_of(pair, 0);
  const Matrix6 expected = tangent(frame, {0, 0}, prestress_of_discs(frame, 1.5, {-0.2, 0.1}));
  const Matrix6 found = tangent(frame, {0, 0}, prestress_of_bodies(frame, {1 / 0.6, 1 / 0.9}, {-0.2, 0.1}));
  CHECK(largest_difference(found, expected) < 1e-16);
  CHECK_FALSE(turns_i(prestress_of_bodies(frame, {1 / 0.6, 1 / 0.9}, {-0.2, 0.1}), frame));
  CHECK(turns_j(prestress_of_bodies(frame, {1 / 0.6, 1 / 0.8}, {-0.2, 0}), frame));
}

TEST_CASE("prestress_is_chosen_by_its_size_and_refused_where_it_is_not_known") {
  const ContactSprings stiff(SpringConstants{1e6, 1e5}), smooth(SpringConstants{1e6, 0});
  const Assembly pair = two_discs({2, 0}, 1, 1, {-100, 0});  // |N0|/(kN l) = 5e-5
  using enum PrestressChoice;
  CHECK_FALSE(choose_prestress(pair, stiff, automatic)->springs.prestressed());
  CHECK(choose_prestress(pair, stiff, automatic)->largest == Approx(5e-5));
  CHECK(choose_prestress(pair, smooth, automatic)->springs.prestressed());
  CHECK(choose_prestress(pair, stiff, on)->springs.prestressed());
  CHECK_FALSE(choose_prestress(pair, smooth, off)->springs.prestressed());
  Assembly loose = pair;
  loose.contact_normal_force.clear(), loose.contact_tangential_force.clear();
  CHECK_FALSE(choose_prestress(loose, stiff, automatic));
  CHECK_THROWS_WITH(choose_prestress(loose, stiff, on), Catch::Contains("no contact carries a force"));

  Assembly bodies = pair;
  bodies.contact_arms = {{{1, 0}, 0, 0}};
  CHECK_THROWS_WITH(choose_prestress(bodies, stiff, on), Catch::Contains("curvatures"));
  CHECK_THAT(choose_prestress(bodies, smooth, automatic)->sentence, Catch::Contains("DO NOT COUNT"));
  bodies.contact_curvature_i = {0.5}, bodies.contact_curvature_j = {1};
  CHECK(choose_prestress(bodies, stiff, on)->springs.prestressed());
  bodies.contact_tangential_force = {1};
  CHECK(choose_prestress(bodies, stiff, on)->springs.prestressed());

  Assembly cell = pair;
  cell.period = Vec2{4, 4};
  CHECK_THROWS_WITH(choose_prestress(cell, stiff, on), Catch::Contains("do not balance"));
  cell.contacts.push_back({.i = 1, .j = 0, .shift_x = 1, .lever_i = 1, .lever_j = 1});
  cell.contact_normal_force = {-100, -100}, cell.contact_tangential_force = {0, 0};
  CHECK(choose_prestress(cell, stiff, on)->springs.prestressed());
}

TEST_CASE("a_force_that_is_round_off_of_the_others_loads_no_contact") {
  Assembly chain = chain_of_discs(4, 1);
  chain.contact_normal_force = {-2, -1, 1e-15};
  chain.contact_tangential_force = {0, 0, -3e-16};
  for (const double scale : {1.0, 1e-9, 1e12}) {
    Assembly scaled = chain;
    for (double& force : scaled.contact_normal_force) force *= scale;
    for (double& force : scaled.contact_tangential_force) force *= scale;
    const RestBalance balance = balance_at_rest(scaled);
    CAPTURE(scale, balance.loaded, balance.mean_force, balance.relative);
    CHECK(balance.loaded == 2);
    CHECK(balance.mean_force == Approx(1.5 * scale));
    CHECK(balance.relative == Approx(2 / 1.5));
  }
}
