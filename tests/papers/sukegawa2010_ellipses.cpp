// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sukegawa (2010), (4.1)-(4.49): the approximate contact of ellipses beside the exact one.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/shape_contact.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

using std::numbers::pi;

struct TwoEllipses {
  Ellipse i, j;
  Vec2 branch;
};

/// Sizes as in chapter 8: long half-axes 1/sqrt(2) to sqrt(2); any direction.
TwoEllipses random_pair(Random& random, double aspect) {
  const auto one = [&] {
    const double size = std::sqrt(2 / aspect) * random.uniform(1 / std::numbers::sqrt2, std::numbers::sqrt2);
    return Ellipse::at_angle(size * aspect / std::numbers::sqrt2, size / std::numbers::sqrt2, random.uniform(0, pi));
  };
  const Ellipse i = one(), j = one();
  const double angle = random.uniform(0, 2 * pi);
  return {i, j, {std::cos(angle), std::sin(angle)}};
}

/// The branch along a direction with the wanted gap, which is a convex function of its length.
void place(TwoEllipses& pair, double gap) {
  const Vec2 direction = pair.branch / norm(pair.branch);
  double length = pair.i.a + pair.j.a + gap;
  for (int step = 0; step < 50; ++step) {
    const EllipseContact contact = contact_of_ellipses(pair.i, pair.j, length * direction);
    length -= (contact.gap - gap) / dot(contact.normal, direction);
  }
  pair.branch = length * direction;
}

double degrees_between(Vec2 a, Vec2 b) {
  return std::abs(std::atan2(cross(a, b), dot(a, b))) * 180 / pi;
}

struct Spread {
  double mean = 0, most_of_all = 0, largest = 0;
};

/// Mean, 95 % quantile, largest.
Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  Spread spread{0, values[values.size() * 95 / 100], values.back()};
  for (const double value : values) spread.mean += value / static_cast<double>(values.size());
  return spread;
}

/// JDG + 1 = c . M^-1 c with M = P_i + P_j + 2 P_i # P_j, P = R diag(a², b²) R^T and # the geometric mean of matrices,
/// in the plane sqrt(al be/det(P_i/al + P_j/be)) (P_i/al + P_j/be), al = a_i b_i, be = a_j b_j.
double judgement_by_matrix_mean(const TwoEllipses& pair) {
  const auto matrix = [](const Ellipse& e) {
    const Vec2 v = perpendicular(e.axis);
    return e.a * e.a * outer(e.axis, e.axis) + e.b * e.b * outer(v, v);
  };
  const auto determinant = [](const Tensor2& t) { return t.xx * t.yy - t.xy * t.yx; };
  const double al = pair.i.a * pair.i.b, be = pair.j.a * pair.j.b;
  const Tensor2 sum = 1 / al * matrix(pair.i) + 1 / be * matrix(pair.j);
  const Tensor2 m = matrix(pair.i) + matrix(pair.j) + 2 * std::sqrt(al * be / determinant(sum)) * sum;
  const Vec2 c = pair.branch;
  return (m.yy * c.x * c.x - (m.xy + m.yx) * c.x * c.y + m.xx * c.y * c.y) / determinant(m) - 1;
}

}  // namespace

TEST_CASE("sukegawa_2010_ellipses_of_an_independent_implementation") {
  nlohmann::json numbers;
  std::ifstream(EQUIDEM_SOURCE_DIR "/data/reference/ellipse_pairs.json") >> numbers;
  const auto vector = [](const nlohmann::json& xy) { return Vec2{xy[0], xy[1]}; };
  REQUIRE(numbers["pairs"].size() == 100);
  for (const auto& given : numbers["pairs"]) {
    const auto &of_i = given["Ei"], &of_j = given["Ej"];
    CAPTURE(of_i.dump(), of_j.dump());
    const Ellipse i = Ellipse::at_angle(of_i[0], of_i[1], of_i[2]), j = Ellipse::at_angle(of_j[0], of_j[1], of_j[2]);
    const Vec2 branch = {of_j[3].get<double>() - of_i[3].get<double>(), of_j[4].get<double>() - of_i[4].get<double>()};
    const EllipseContact exact = contact_of_ellipses(i, j, branch);
    CHECK(std::abs(exact.gap - given["gap"].get<double>()) < 1e-14);
    CHECK(norm(exact.normal - vector(given["normal"])) < 1e-14);
    CHECK(norm(exact.arm_i - vector(given["point_i"])) < 1e-14);
    CHECK(norm(branch + exact.arm_j - vector(given["point_j"])) < 1e-14);
    CHECK((exact.state != EllipseState::apart) == given["overlap"].get<bool>());

    const auto& mapped = given["mapped"];
    const MappedEllipse image = mapped_ellipse(i, j, branch);
    CHECK(image.a == Approx(mapped["a"].get<double>()).epsilon(1e-12));
    CHECK(image.b == Approx(mapped["b"].get<double>()).epsilon(1e-12));
    CHECK(image.theta == Approx(mapped["theta"].get<double>()).epsilon(1e-12));
    CHECK(image.h == Approx(mapped["h"].get<double>()).epsilon(1e-12));
    CHECK(image.k == Approx(mapped["k"].get<double>()).epsilon(1e-12));
    const EnlargedEllipseContact mended = enlarged_ellipse_contact(i, j, branch);
    CHECK(std::abs(mended.judgement - given["JDG"].get<double>()) < 1e-12);
    CHECK(norm(mended.point - Vec2{given["xc"], given["yc"]}) < 1e-12);
    CHECK(norm(mended.surface_point - Vec2{given["xcn"], given["ycn"]}) < 1e-12);
    CHECK(std::abs(mended.angle - given["omega"].get<double>()) < 1e-12);
  }
}

TEST_CASE("sukegawa_2010_judgement_is_a_mean_of_matrices") {
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    TwoEllipses pair = random_pair(random, std::exp(random.uniform(0, std::log(20.0))));
    pair.branch = random.uniform(0.1, 1.2) * (pair.i.a + pair.j.a) * pair.branch;
    const double judgement = enlarged_ellipse_contact(pair.i, pair.j, pair.branch).judgement;
    CAPTURE(k, judgement, pair.i.a / pair.i.b);
    CHECK(std::abs(judgement - judgement_by_matrix_mean(pair)) < 1e-10 * (1 + judgement));
    const double swapped = enlarged_ellipse_contact(pair.j, pair.i, -pair.branch).judgement;
    CHECK(std::abs(judgement - swapped) < 1e-10 * (1 + judgement));
  }
}

TEST_CASE("sukegawa_2010_contacts_are_missed_but_never_invented") {
  std::string table = "aspect | missed at a depth up to 1, 5, 10, 20 % of the mean radius | deepest missed\n";
  Random random(1);
  for (const double aspect : {1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0}) {
    table += fmt::format("{:6.1f} |", aspect);
    double deepest = 0;
    std::vector<double> shares;
    for (const double depth : {0.01, 0.05, 0.1, 0.2}) {
      int missed = 0;
      constexpr int pairs = 1000;
      for (int k = 0; k < pairs; ++k) {
        TwoEllipses pair = random_pair(random, aspect);
        const double radius = std::sqrt(std::min(pair.i.a * pair.i.b, pair.j.a * pair.j.b));
        const double overlap = random.uniform(1e-6, depth);
        place(pair, -overlap * radius);
        if (!enlarged_ellipse_contact(pair.i, pair.j, pair.branch).is_contact()) {
          ++missed;
          deepest = std::max(deepest, overlap);
        }
        place(pair, overlap * radius);
        CAPTURE(aspect, overlap);
        CHECK(enlarged_ellipse_contact(pair.i, pair.j, pair.branch).judgement > 0);
      }
      shares.push_back(static_cast<double>(missed) / pairs);
      table += fmt::format(" {:5.1f} %", 100 * shares.back());
    }
    table += fmt::format(" | {:.3f}\n", deepest);
    INFO(table);
    if (aspect == 1) CHECK(deepest == 0);
    if (aspect > 1) CHECK(shares.front() > 0);
    CHECK(std::is_sorted(shares.rbegin(), shares.rend()));
  }
}

TEST_CASE("sukegawa_2010_normals_at_first_touch") {
  std::string table = "aspect | degrees off, mean, 95 %, largest\n";
  Random random(2);
  for (const double aspect : {1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0}) {
    std::vector<double> degrees;
    for (int k = 0; k < 4000; ++k) {
      TwoEllipses pair = random_pair(random, aspect);
      place(pair, 0);
      const Vec2 normal = contact_of_ellipses(pair.i, pair.j, pair.branch).normal;
      degrees.push_back(degrees_between(normal, enlarged_ellipse_contact(pair.i, pair.j, pair.branch).normal));
    }
    const Spread off = spread_of(degrees);
    table += fmt::format("{:6.1f} | {:5.1f} {:5.1f} {:5.1f}\n", aspect, off.mean, off.most_of_all, off.largest);
    INFO(table);
    if (aspect == 1) CHECK(off.largest < 1e-5);
    if (aspect == 2) {  // independent values: 7.4, 23, 33
      CHECK(off.mean == Approx(7.4).margin(0.3));
      CHECK(off.most_of_all == Approx(23).margin(1));
      CHECK(off.largest == Approx(33).margin(2));
    }
  }
}
