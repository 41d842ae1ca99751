// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The stiffness of a prestressed network is the derivative of the forces by which a run moves its bodies.
#include <array>
#include <cmath>
#include <vector>

#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "grains/shapes.hpp"
#include "support/catch.hpp"
#include "support/dense_oracle.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double kN = 1.3;

/// Two bodies that overlap, near (5, 5) in a box that does not touch them.
GrainPacking two_bodies(bool ellipses, Random& random) {
  GrainPacking packing;
  packing.box = {{10, 10}, PackingBox::Sides::walls};
  packing.shape = ellipses ? PackingShape::Kind::ellipse : PackingShape::Kind::disc;
  packing.jammed = true;
  const double overlap = random.uniform(0.005, 0.05), way = random.uniform(0, 6.28);
  for (int k = 0; k < 2; ++k) {
    const double a = random.uniform(0.6, 1.2), b = ellipses ? a * random.uniform(0.4, 0.9) : a;
    packing.grains.push_back(ellipses ? oval({5, 5}, a, b, random.uniform(0, 6.28)) : ball({5, 5}, a));
    packing.radii.push_back(std::sqrt(a * b));
  }
  const auto shape_of = [](const Grain& grain) {
    return Ellipse::at_angle(grain.radius, grain.short_half_axis > 0 ? grain.short_half_axis : grain.radius,
                             grain.angle);
  };
  Vec2 branch = 2.0 * Vec2{std::cos(way), std::sin(way)};
  for (int pass = 0; pass < 60; ++pass) {
    const EllipseContact now = contact_of_ellipses(shape_of(packing.grains[0]), shape_of(packing.grains[1]), branch);
    branch -= (now.gap + overlap) * now.normal;
  }
  packing.grains[1].position += branch;
  return packing;
}

/// Forces and moments on both bodies in the first step of a run that starts displaced, from rest.
std::array<double, 6> forces_of_run(const GrainPacking& packing, const std::array<double, 6>& moved) {
  std::vector<Grain> grains = packing.grains;
  for (std::size_t k = 0; k < 2; ++k) {
    grains[k].position += Vec2{moved[3 * k], moved[3 * k + 1]};
    grains[k].angle += moved[3 * k + 2];
  }
  PairProperties pair;
  pair.stiffness = kN;
  pair.restitution = 1;
  constexpr double step = 1e-3;
  GrainSimulation simulation(scene_of(grains, {}, pair), options_of(NormalLaw::linear_dashpot, step));
  simulation.advance(1);
  std::array<double, 6> forces{};
  for (std::size_t k = 0; k < 2; ++k) {
    const Grain after = simulation.grains()[k];
    const Vec2 force = (after.inertia.mass / step) * after.velocity;
    forces[3 * k] = force.x, forces[3 * k + 1] = force.y, forces[3 * k + 2] = after.inertia.moment * after.spin / step;
  }
  return forces;
}

}  // namespace

TEST_CASE("the_stiffness_of_a_prestressed_pair_is_the_derivative_of_the_forces_of_a_run") {
  const bool ellipses = GENERATE(true, false);
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const GrainPacking packing = two_bodies(ellipses, random);
    const Assembly pair = network_of(packing, {.springs = SpringConstants{kN, 0}});
    REQUIRE(pair.contacts.size() == 1);
    const double overlap = -force_at_rest(pair, 0).normal / kN;
    const ContactSprings springs = choose_prestress(pair, ContactSprings({kN, 0}), PrestressChoice::on)->springs;
    const DegreesOfFreedom unknowns =
        number_unknowns(pair, springs, derive_effects(pair, springs, Rotation::from_scene), {});
    const ContactGraph graph(pair);
    const auto b = static_cast<std::size_t>(unknowns.per_disc);
    REQUIRE(b == (ellipses ? 3 : 2));
    const DenseMatrix k = dense_matrix(assemble_stiffness(pair, graph, springs, unknowns), pair);
    const auto scale = [&](std::size_t c) { return c % 3 == 2 ? unknowns.rotation_scale : 1.0; };
    double largest = 0;
    for (std::size_t q = 0; q < 6; ++q) {
      const auto difference = [&](double width) {
        std::array<double, 6> ahead{}, behind{}, result{};
        ahead[q] = width, behind[q] = -width;
        const auto after = forces_of_run(packing, ahead), before = forces_of_run(packing, behind);
        for (std::size_t p = 0; p < 6; ++p) result[p] = -(after[p] - before[p]) / (2 * width);
        return result;
      };
      const auto one = difference(4e-4), two = difference(8e-4), four = difference(1.6e-3);
      for (std::size_t p = 0; p < 6; ++p) {
        const double fine = (4 * one[p] - two[p]) / 3, coarse = (4 * two[p] - four[p]) / 3;
        const bool turns = p % 3 == 2 || q % 3 == 2;
        const std::size_t row = p / 3 * b + p % 3, column = q / 3 * b + q % 3;
        const double found = b == 2 && turns ? 0 : k(row, column) * scale(p) * scale(q);
        largest = std::max(largest, std::abs((16 * fine - coarse) / 15 - found));
      }
    }
    CAPTURE(ellipses, trial, overlap, largest);
    CHECK(largest < 1e-7 * kN * overlap);
  }
}
