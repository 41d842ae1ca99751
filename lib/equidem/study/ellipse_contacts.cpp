// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How two overlapping ellipses touch: exactly, from the best of n directions, and by Sukegawa's enlarged ellipse.
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

constexpr double pi = std::numbers::pi;

struct Pair {
  Ellipse i, j;
  Vec2 branch;
  Vec2 normal;         ///< the true one
  double overlap = 0;  ///< m
};

/// Contact that a method finds.
struct Found {
  double overlap = 0;
  Vec2 normal;
};
using Method = std::function<Found(const Pair&)>;

/// n that maximizes branch . n - h_i(n) - h_j(n): the best of `directions`, then bisection of the derivative, branch .
/// s - h_i' + h_j' with h_j' that of -n, between its neighbours. \param directions enough for the best one to lie
/// beside the maximum
Vec2 normal_by_bisection(const Pair& pair, int directions) {
  const auto at = [](double angle) { return Vec2{std::cos(angle), std::sin(angle)}; };
  double best = 0, largest = -1e300;
  for (int k = 0; k < directions; ++k) {
    const double angle = 2 * pi * k / directions;
    const double value = separation_along(pair.i, pair.j, pair.branch, at(angle));
    if (value <= largest) continue;
    largest = value;
    best = angle;
  }
  double low = best - 2 * pi / directions, high = best + 2 * pi / directions;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    const Vec2 n = at(middle);
    const double slope = dot(pair.branch, perpendicular(n)) - support(pair.i, n).slope - support(pair.j, n).slope;
    (slope > 0 ? low : high) = middle;
  }
  return at(0.5 * (low + high));
}

Found sampled(const Pair& pair, const std::vector<Vec2>& directions) {
  Found found;
  double largest = -1e300;
  for (const Vec2 n : directions) {
    const double value = separation_along(pair.i, pair.j, pair.branch, n);
    if (value <= largest) continue;
    largest = value;
    found.normal = n;
  }
  found.overlap = -largest;
  return found;
}

Found exact(const Pair& pair) {
  const EllipseContact contact = contact_of_ellipses(pair.i, pair.j, pair.branch);
  return {-contact.gap, contact.normal};
}

/// The method gives no overlap; what it would be along its normal.
Found enlarged(const Pair& pair) {
  const EnlargedEllipseContact contact = enlarged_ellipse_contact(pair.i, pair.j, pair.branch);
  return {-separation_along(pair.i, pair.j, pair.branch, contact.normal), contact.normal};
}

/// Long half-axes about 1 m, any direction, overlaps of 1 to 5 % of the mean radius.
std::vector<Pair> random_pairs(double aspect, int count) {
  Random random(1);
  std::vector<Pair> pairs;
  while (static_cast<int>(pairs.size()) < count) {
    const auto one = [&] {
      const double a = random.uniform(1 / std::numbers::sqrt2, std::numbers::sqrt2);
      return Ellipse::at_angle(a, a / aspect, random.uniform(0, pi));
    };
    Pair pair{one(), one(), {}, {}};
    const double angle = random.uniform(0, 2 * pi),
                 wanted = random.uniform(0.01, 0.05) * std::sqrt(pair.i.a * pair.i.b);
    const Vec2 along{std::cos(angle), std::sin(angle)};
    double length = pair.i.a + pair.j.a;
    for (int step = 0; step < 50; ++step) {  // the gap is a convex function of the length
      const EllipseContact contact = contact_of_ellipses(pair.i, pair.j, length * along);
      length -= (contact.gap + wanted) / dot(contact.normal, along);
    }
    pair.branch = length * along;
    pair.normal = normal_by_bisection(pair, 4096);
    pair.overlap = -separation_along(pair.i, pair.j, pair.branch, pair.normal);
    pairs.push_back(pair);
  }
  return pairs;
}

using Pairs = std::shared_ptr<const std::vector<Pair>>;

StudyTask task_of(Setting setting, const Pairs& pairs, Method method) {
  const auto work = [pairs, method = std::move(method)](std::vector<Found>& found) {
    for (std::size_t k = 0; k < pairs->size(); ++k) found[k] = method((*pairs)[k]);
  };
  const auto values = [pairs](const std::vector<Found>& found) {
    double angle = 0, overlap = 0;
    for (std::size_t k = 0; k < pairs->size(); ++k) {
      const Pair& pair = (*pairs)[k];
      const double off = std::atan2(cross(pair.normal, found[k].normal), dot(pair.normal, found[k].normal));
      const double less = found[k].overlap / pair.overlap - 1;
      angle += off * off;
      overlap += less * less;
    }
    const auto count = static_cast<double>(pairs->size());
    return std::vector{std::sqrt(angle / count), std::sqrt(overlap / count)};
  };
  return task_on(
      std::move(setting), [pairs] { return std::vector<Found>(pairs->size()); }, work, values);
}

}  // namespace

Study ellipse_contact_study(bool quick) {
  const int count = quick ? 200 : 1000;
  Study study{.name = "ellipse_contact",
              .title = fmt::format("Normal and overlap of {} pairs of ellipses", count),
              .quantities = {{.name = "normal",
                              .label = "rms error of the normal, rad",
                              .source = "the best of 4096 directions, then bisection"},
                             {.name = "overlap",
                              .label = "relative rms error of the overlap",
                              .source = "the best of 4096 directions, then bisection"}},
              .tasks = {}};
  for (const double aspect : quick ? std::vector{2.0} : std::vector{1.2, 2.0, 5.0}) {
    const auto pairs = std::make_shared<const std::vector<Pair>>(random_pairs(aspect, count));
    const std::string problem = fmt::format("aspect {:g}", aspect);
    study.tasks.push_back(task_of({.problem = problem, .method = "exact"}, pairs, exact));
    study.tasks.push_back(task_of({.problem = problem, .method = "enlarged"}, pairs, enlarged));
    for (int n = 16; n <= 1024; n *= 2) {
      std::vector<Vec2> directions;
      for (int k = 0; k < n; ++k)
        directions.push_back({std::cos(2 * pi * (k + 0.5) / n), std::sin(2 * pi * (k + 0.5) / n)});
      study.tasks.push_back(task_of({.problem = problem,
                                     .method = "best of n directions",
                                     .values = {{"n", static_cast<double>(n)}},
                                     .resolution = 1.0 / n},
                                    pairs, [=](const Pair& p) { return sampled(p, directions); }));
    }
  }
  study.orders = {
      {.method = "best of n directions",
       .quantity = "normal",
       .order = 1,
       .why = "half a step between directions at most"},
      {.method = "best of n directions", .quantity = "overlap", .order = 2, .why = "the overlap is stationary there"}};
  study.notes = {fmt::format("Times are of all {} pairs.", count),
                 "The enlarged ellipse has no overlap of its own: it is taken along its normal."};
  return study;
}

}  // namespace equidem
