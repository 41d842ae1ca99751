// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The exact contact of ellipses.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"
#include "equidem/geometry/shape_contact.hpp"

#include "geometry/ellipse_pairs.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using std::numbers::pi;

bool all_finite(const EllipseContact& c) {
  return std::isfinite(c.gap + c.normal.x + c.normal.y + c.arm_i.x + c.arm_i.y + c.arm_j.x + c.arm_j.y);
}

bool same_bits(const EllipseContact& a, const EllipseContact& b) {
  return a.state == b.state && a.gap == b.gap && a.normal == b.normal && a.arm_i == b.arm_i && a.arm_j == b.arm_j;
}

EllipseContact mirrored(const EllipseContact& c) {
  return {c.state, c.gap, -c.normal, c.arm_j, c.arm_i};
}

}  // namespace

TEST_CASE("closest_points_of_ellipses_are_exact") {
  Random random(1);
  double worst_gap = 0, worst_apart = 0, worst_point = 0;
  int ties = 0, apart = 0, deep = 0;
  for (int k = 0; k < 100000; ++k) {
    const TwoEllipses pair = random_pair(random, 20);
    const EllipseContact contact = pair.contact();
    const oracle::Found truth = oracle::contact(pair.i, pair.j, pair.branch);
    const double size = pair.size();
    worst_gap = std::max(worst_gap, std::abs(contact.gap - static_cast<double>(truth.gap)) / size);
    if (truth.gap > 0) ++apart;
    if (-truth.gap > roundness(pair.i) * pair.i.b + roundness(pair.j) * pair.j.b) ++deep;
    if (truth.gap - truth.second < 1e-12L * size) {
      ++ties;
      continue;
    }
    // Points move R/(R + gap) times as far as what the sizes say.
    const double sensitivity = static_cast<double>(std::max(1.0L, truth.radius / (truth.radius + truth.gap)));
    const double point = std::max(off(truth.arm_i, contact.arm_i), off(truth.arm_j, contact.arm_j)) / size;
    if (truth.gap > 0) worst_apart = std::max(worst_apart, point);
    worst_point = std::max(worst_point, point / sensitivity);
    CAPTURE(k, pair.i.a, pair.i.b, pair.j.a, pair.j.b, pair.branch.x, pair.branch.y, contact.gap, sensitivity);
    if (!(point <= 1e-12 * sensitivity)) FAIL_CHECK("points off by " << point);
    if (!all_finite(contact)) FAIL_CHECK("not finite");
  }
  INFO(
      fmt::format("100000 pairs, {} apart, {} deeper than the sharpest radii, {} with two normals: gap {:.1e}, points "
                  "{:.1e} apart, "
                  "{:.1e} times their sensitivity overlapping",
                  apart, deep, ties, worst_gap, worst_apart, worst_point));
  CHECK(worst_gap < 1e-13);
  CHECK(worst_apart < 1e-12);
  CHECK(std::min(apart, deep) > 10000);
  CHECK(ties < 100);
}

TEST_CASE("ellipses_overlap_where_algebra_says_so") {
  Random random(2);
  int overlaps = 0;
  for (int k = 0; k < 20000; ++k) {
    const TwoEllipses pair = random_pair(random, 20);
    const EllipseContact contact = pair.contact();
    if (std::abs(contact.gap) < 1e-9 * pair.size()) continue;
    const bool apart = oracle::apart_by_algebra(pair.i, pair.j, pair.branch);
    overlaps += apart ? 0 : 1;
    CAPTURE(k, contact.gap);
    if (apart != (contact.state == EllipseState::apart)) FAIL_CHECK("algebra says otherwise");
    const EllipseContact quick = contact_of_ellipses(pair.i, pair.j, pair.branch, {}, WhenApart::only_that_it_is);
    if (apart != (quick.state == EllipseState::apart)) FAIL_CHECK("the quick answer is another");
    if (apart && !(quick.gap > 0 && quick.gap <= contact.gap * (1 + 1e-12)))
      FAIL_CHECK("no lower bound: " << quick.gap);
    if (!apart && !same_bits(quick, contact)) FAIL_CHECK("overlapping, the quick answer is to be the same");
  }
  CHECK(overlaps > 5000);
  CHECK(overlaps < 15000);
}

TEST_CASE("the_last_normal_changes_nothing_but_the_time") {
  Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const TwoEllipses pair = random_pair(random, 20);
    const EllipseContact cold = pair.contact();
    const double far = std::pow(10, random.uniform(-12, 0.5));
    const Vec2 turned = {std::cos(far), std::sin(far)};
    const Vec2 last = {dot(turned, {cold.normal.x, -cold.normal.y}), cross({cold.normal.x, -cold.normal.y}, turned)};
    CAPTURE(k, far, cold.gap);
    if (!(std::abs(pair.contact(last).gap - cold.gap) < 1e-13 * pair.size())) FAIL_CHECK(pair.contact(last).gap);
  }
}

TEST_CASE("a_normal_handed_on_for_long_stays_a_unit_vector") {
  Vec2 normal;
  double farthest = 0, worst = 0;
  for (int step = 0; step < 300000; ++step) {
    const Ellipse i = Ellipse::at_angle(2, 0.5, 1e-5 * step), j = Ellipse::at_angle(1, 0.8, -2e-5 * step);
    const EllipseContact contact = contact_of_ellipses(i, j, {1.9, 0.3}, normal);
    normal = contact.normal;
    farthest = std::max(farthest, std::abs(norm(normal) - 1));
    if (step % 1000 == 0) worst = std::max(worst, std::abs(contact.gap - contact_of_ellipses(i, j, {1.9, 0.3}).gap));
  }
  CAPTURE(farthest, worst);
  CHECK(farthest < 5e-16);
  CHECK(worst < 2e-15);
}

TEST_CASE("needles_of_any_size_and_aspect_are_found") {
  Random random(6);
  double worst = 0;
  for (int k = 0; k < 3000; ++k) {
    const auto one = [&] {
      const double a = std::pow(10, random.uniform(-1, 1)), aspect = std::pow(10, random.uniform(0, 3));
      return Ellipse{a, a / aspect, random_direction(random)};
    };
    const Ellipse i = one(), j = one();
    TwoEllipses pair{i, j, random.uniform(0, 1.2) * (i.a + j.a) * random_direction(random)};
    const EllipseContact contact = pair.contact();
    // No direction separates them more, and the one that is given does by the gap.
    CAPTURE(k, i.a, i.b, j.a, j.b, pair.branch.x, pair.branch.y, contact.gap);
    REQUIRE(all_finite(contact));
    double best = -1e300;
    for (int m = 0; m < 3000; ++m) best = std::max(best, separation_along(i, j, pair.branch, random_direction(random)));
    if (best > contact.gap + 1e-12 * pair.size()) FAIL_CHECK("a direction separates them by " << best);
    worst = std::max(worst, std::abs(separation_along(i, j, pair.branch, contact.normal) - contact.gap) / pair.size());
    for (const double scale : {1e-9, 1e9}) {
      const EllipseContact other = contact_of_ellipses({scale * i.a, scale * i.b, i.axis},
                                                       {scale * j.a, scale * j.b, j.axis}, scale * pair.branch);
      if (!(std::abs(other.gap / scale - contact.gap) < 1e-13 * pair.size()))
        FAIL_CHECK("scaled by " << scale << ": " << other.gap);
    }
  }
  INFO(worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("ellipses_in_one_another_are_told") {
  const Ellipse large{2, 1}, small{0.5, 0.25, {0.6, 0.8}};
  SECTION("concentric") {
    for (const Ellipse& other : {large, small, Ellipse{2, 1, {0, 1}}, Ellipse{1, 1}}) {
      const EllipseContact contact = contact_of_ellipses(large, other, {});
      CHECK(contact.state == EllipseState::concentric);
      CHECK(!contact.is_contact());
      REQUIRE(all_finite(contact));
      CHECK(contact.gap == Approx(static_cast<double>(oracle::contact(large, other, {}).gap)));
    }
  }
  SECTION("nested, either way round, up to touching from inside") {
    for (const double r : {0.25, 0.8}) {
      // A circle in (2, 1) with its centre at x touches it in the tip, x + r = a, or beside it, x²/(a² - b²) + r²/b²
      // = 1.
      const Ellipse round{r, r};
      const double farthest = r < 0.5 ? 2 - r : std::sqrt(3 * (1 - r * r));
      CAPTURE(r, farthest);
      for (const double x : {1e-12, 0.5, 1.0, farthest * (1 - 1e-9)}) {
        CAPTURE(x);
        CHECK(contact_of_ellipses(large, round, {x, 0}).state == EllipseState::nested);
        CHECK(contact_of_ellipses(round, large, {x, 0}).state == EllipseState::nested);
      }
      CHECK(contact_of_ellipses(large, round, {farthest * (1 + 1e-9), 0}).state == EllipseState::touching);
    }
    CHECK(contact_of_ellipses(large, small, {0.3, 0.2}).state == EllipseState::nested);
    CHECK(contact_of_ellipses(large, {1.5, 0.1, {0, 1}}, {0.3, 0.2}).state == EllipseState::touching);
  }
  SECTION("nested is what sampling says") {
    Random random(7);
    int count = 0;
    for (int k = 0; k < 2000; ++k) {
      const Ellipse i = random_ellipse(random, 5), j = random_ellipse(random, 5);
      const Vec2 branch = random.uniform(0, 1) * i.a * random_direction(random);
      const auto farthest = [&](const Ellipse& in, const Ellipse& out, Vec2 c) {
        double most = 0;
        for (int m = 0; m < 400; ++m) {
          const double angle = 2 * pi * m / 400;
          const Vec2 x = c + in.a * std::cos(angle) * in.axis + in.b * std::sin(angle) * perpendicular(in.axis);
          most = std::max(most, std::hypot(dot(x, out.axis) / out.a, cross(out.axis, x) / out.b));
        }
        return most;
      };
      const double most = std::min(farthest(j, i, branch), farthest(i, j, -branch));
      if (std::abs(most - 1) < 1e-3) continue;
      count += most < 1 ? 1 : 0;
      CAPTURE(k, most);
      if (nested(i, j, branch) != (most < 1)) FAIL_CHECK("nested differs");
      if ((contact_of_ellipses(i, j, branch).state == EllipseState::nested) != (most < 1)) FAIL_CHECK("state differs");
    }
    CHECK(count > 200);
  }
  SECTION("aligned: the disc of curvature at the tips, then sideways") {
    for (const double x : {4.5, 4.0, 3.9, 3.0, 1.0}) {
      const EllipseContact contact = contact_of_ellipses(large, large, {x, 0});
      CAPTURE(x, contact.normal.x, contact.normal.y);
      REQUIRE(all_finite(contact));
      if (x > 3) CHECK(contact.gap == Approx(x - 4).margin(1e-15));
      if (x > 3) CHECK(norm(contact.normal - Vec2{1, 0}) == 0);
      if (x < 3) CHECK(std::abs(contact.normal.y) > 0.8);
      CHECK(contact.gap == Approx(static_cast<double>(oracle::contact(large, large, {x, 0}).gap)).margin(1e-15));
      CHECK(same_bits(mirrored(contact), contact_of_ellipses(large, large, {-x, 0})));
    }
  }
}

TEST_CASE("an_ellipse_meets_a_line_like_a_disc_of_infinite_radius") {
  Random random(8);
  for (int k = 0; k < 300; ++k) {
    const Ellipse i = random_ellipse(random, 20);
    const Vec2 n = random_direction(random),
               to_line = random.uniform(0, 1.2) * i.a * n + random.uniform(-5, 5) * perpendicular(n);
    const EllipseContact line = contact_with_line(i, to_line, -n);
    constexpr double r = 1e8;
    const EllipseContact disc = contact_of_ellipses(i, {r, r}, (dot(to_line, n) + r) * n);
    CAPTURE(k, line.gap);
    CHECK(std::abs(line.gap - disc.gap) < 1e-6 * (1 + i.a * i.a));
    CHECK(line.normal == n);
    CHECK(norm(line.arm_i + line.gap * n - to_line - line.arm_j) < 1e-14 * (1 + norm(to_line)));
    CHECK(std::abs(dot(line.arm_j, n)) < 1e-14 * (1 + norm(to_line)));
  }
}

TEST_CASE("an_ellipse_meets_a_segment_at_its_side_or_end") {
  Random random(9);
  int sides = 0, ends = 0, overlaps = 0;
  for (int k = 0; k < 2000; ++k) {
    const Ellipse i = random_ellipse(random, 5);
    const Vec2 half = random.uniform(0.2, 3) * random_direction(random),
               middle = random.uniform(0, 1.5) * (i.a + norm(half)) * random_direction(random);
    const EllipseContact contact = contact_with_segment(i, middle - half, middle + half);
    double best = -1e300;
    for (int m = 0; m < 4000; ++m) {
      const double angle = 2 * pi * m / 4000;
      const Vec2 n = {std::cos(angle), std::sin(angle)};
      best = std::max(best, dot(middle, n) - support(i, n).reach - std::abs(dot(half, n)));
    }
    CAPTURE(k, i.a, i.b, contact.gap, best);
    CHECK(norm(contact.arm_i + contact.gap * contact.normal - middle - contact.arm_j) < 1e-12);
    CHECK(std::abs(cross(contact.arm_j, half)) < 1e-12);
    CHECK(norm(contact.arm_j) <= norm(half) * (1 + 1e-12));
    CHECK((contact.state == EllipseState::apart) == (contact.gap > 0));
    (norm(contact.arm_j) < norm(half) * (1 - 1e-12) ? sides : ends) += 1;
    overlaps += contact.gap <= 0 ? 1 : 0;
    CHECK(contact.gap > best - 1e-14 * norm(middle));
    CHECK(contact.gap < best + 1e-3 * (norm(half) + norm(middle) + i.a));  // half the way between two directions
  }
  INFO(fmt::format("{} sides, {} ends, {} overlaps", sides, ends, overlaps));
  CHECK(std::min(sides, ends) > 300);
  CHECK(overlaps > 300);
}
