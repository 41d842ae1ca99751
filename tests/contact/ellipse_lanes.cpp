// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The exact contact of ellipses, eight pairs at once.
#include "equidem/core/text.hpp"
#include "equidem/grains/kernels/part_lanes.hpp"

#include "geometry/ellipse_pairs.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Eight pairs, each with a normal of the step before.
struct EightPairs {
  std::array<TwoEllipses, 8> pairs;
  std::array<oracle::Found, 8> truth;
  ContactGroup group = {};
  PairSlips slips = {};
  PairLaws laws = {};
  PairRecords records = {};
  PartShapes shapes = {};
  std::array<PartBody, 16> bodies = {};

  void set(int k, const TwoEllipses& pair, const oracle::Found& found, double turned) {
    const auto at = static_cast<std::size_t>(k);
    pairs[at] = pair;
    truth[at] = found;
    group.i[k] = 2 * k;
    group.j[k] = 2 * k + 1;
    group.since[k] = 0;
    const auto turned_of = [](const Ellipse& ellipse) { return ellipse.a > ellipse.b ? ellipse.axis : Vec2{}; };
    bodies[2 * at].turned = turned_of(pair.i);
    bodies[2 * at + 1].turned = turned_of(pair.j);
    bodies[2 * at + 1].centre = pair.branch;
    const Vec2 n{static_cast<double>(found.n.x), static_cast<double>(found.n.y)};
    const Vec2 last = std::cos(turned) * n + std::sin(turned) * perpendicular(n);
    shapes.a_i[k] = pair.i.a;
    shapes.b_i[k] = pair.i.b;
    shapes.a_j[k] = pair.j.a;
    shapes.b_j[k] = pair.j.b;
    shapes.share[k] = 0.5;
    shapes.arrived[k] = angle_of_arrival(pair.i, pair.j);
    shapes.sharpest[k] = roundness(pair.i) * pair.i.b + roundness(pair.j) * pair.j.b;
    records.normal_x[k] = last.x;
    records.normal_y[k] = last.y;
  }
};

}  // namespace

TEST_CASE("closest_points_of_eight_pairs_of_ellipses_are_exact") {
  Random random(5);
  double worst_gap = 0, worst_normal = 0, worst_point = 0;
  int by_lanes = 0, count = 0;
  while (count < 100000) {
    EightPairs eight;
    for (int k = 0; k < 8;) {
      TwoEllipses pair = random_pair(random, 20);
      if (random.uniform(0, 1) < 0.7) {  // as contacts are: shallow
        const EllipseContact contact = pair.contact();
        pair.branch -= (contact.gap + std::pow(10, random.uniform(-8, -1)) * pair.size()) * contact.normal;
      }
      const oracle::Found truth = oracle::contact(pair.i, pair.j, pair.branch);
      if (truth.gap >= 0 || truth.gap - truth.second < 1e-12L * pair.size()) continue;
      eight.set(k++, pair, truth, std::pow(10, random.uniform(-9, -2)) * (random.uniform(0, 1) < 0.5 ? 1 : -1));
    }
    const PairRecords before = eight.records;
    const ContactRows rows{eight.group, eight.slips, eight.laws, eight.records, eight.shapes, nullptr, nullptr};
    const auto standing =
        eight::standing_of<false, eight::Eight>(eight.bodies.data(), rows, eight::CellShifts(MovingCell()));
    const auto all = ~eight::Bits<eight::Eight>{};
    const auto found = eight::geometry_of_ellipses<false>(rows, standing, all, all);
    for (int k = 0; k < 8; ++k, ++count) {
      const auto at = static_cast<std::size_t>(k);
      const TwoEllipses& pair = eight.pairs[at];
      const oracle::Found& truth = eight.truth[at];
      const double size = pair.size(), bend = static_cast<double>(truth.radius + truth.gap);
      const double sensitivity = std::max(1.0, static_cast<double>(truth.radius) / bend);
      const Vec2 normal{found.normal.x[k], found.normal.y[k]};
      const Vec2 back = 0.5 * found.overlap[k] * normal;
      const Vec2 arm_i = Vec2{found.arm_i.x[k], found.arm_i.y[k]} + back;
      const Vec2 arm_j = Vec2{found.arm_j.x[k], found.arm_j.y[k]} - back;
      const double gap = std::abs(found.overlap[k] + static_cast<double>(truth.gap)) / size;
      const double point = std::max(off(truth.arm_i, arm_i), off(truth.arm_j, arm_j)) / size / sensitivity;
      const double turn = off(truth.n, normal) / std::max(1.0, size / bend);
      worst_gap = std::max(worst_gap, gap);
      worst_point = std::max(worst_point, point);
      worst_normal = std::max(worst_normal, turn);
      const Vec2 last{before.normal_x[k], before.normal_y[k]};
      if (contact_of_parts(pair.i, pair.j, pair.branch, true, last).normal != normal) ++by_lanes;
      CAPTURE(count, pair.i.a, pair.i.b, pair.j.a, pair.j.b, pair.branch.x, pair.branch.y, sensitivity, bend);
      if (!(found.touch[k] != 0)) FAIL_CHECK("no contact");
      if (!(point <= 1e-12)) FAIL_CHECK("points off by " << point << " times their sensitivity");
      if (!(turn <= 1e-12)) FAIL_CHECK("normal off by " << turn);
    }
  }
  INFO(fmt::format("{} contacts, {} with other bits than one by one: gap {:.1e}, points {:.1e}, normals {:.1e}", count,
                   by_lanes, worst_gap, worst_point, worst_normal));
  CHECK(worst_gap < 1e-13);
  CHECK(by_lanes > count / 10);  // otherwise it is the function for single ones
}
