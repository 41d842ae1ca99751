// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Factorization of one dense front: the factors, multiplied out, are the front.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/linear/multifrontal/front.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Symmetric, column-major, whole.
struct Symmetric {
  std::size_t n;
  std::vector<double> values;

  explicit Symmetric(std::size_t size) : n(size), values(size * size, 0.0) {}
  double& operator()(std::size_t r, std::size_t c) { return values[c * n + r]; }
  double operator()(std::size_t r, std::size_t c) const { return values[c * n + r]; }
};

Symmetric random_symmetric(std::size_t n, double diagonal, double zero_share, std::uint64_t seed) {
  Random random(seed);
  Symmetric a(n);
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t r = c + 1; r < n; ++r) a(r, c) = a(c, r) = random.uniform(-1, 1);
    a(c, c) = diagonal + (random.uniform() < zero_share ? 0 : random.uniform(-1, 1));
  }
  return a;
}

/// Largest difference, entries (r, c) of the lower triangle, between `a` and what `product` makes of them.
template <typename Product>
double largest_difference(const Symmetric& a, Product product) {
  double difference = 0;
  for (std::size_t c = 0; c < a.n; ++c) {
    for (std::size_t r = c; r < a.n; ++r) difference = std::max(difference, std::abs(product(r, c) - a(r, c)));
  }
  return difference;
}

/// P L, D and what is left of a front by factorize_indefinite, multiplied out again.
struct Outcome {
  FrontPivots pivots;
  std::size_t two_by_two = 0;
  double difference = 0;  ///< largest entry of P A P^T - L D L^T - (0, Schur complement)
};

Outcome factorize_and_multiply(const Symmetric& a, std::size_t candidates, double u) {
  const std::size_t n = a.n;
  std::vector<double> values = a.values;
  IndefiniteFront front{n, candidates, values.data(), std::vector<std::int64_t>(n)};
  std::iota(front.ids.begin(), front.ids.end(), 0);
  Outcome outcome{factorize_indefinite(front, u, 1e-14), 0, 0};
  const std::size_t k = outcome.pivots.count;
  const auto& d = outcome.pivots.diagonal;
  const auto& off = outcome.pivots.off_diagonal;
  for (const double e : off) outcome.two_by_two += e != 0 ? 1 : 0;
  const auto l = [&](std::size_t r, std::size_t p) { return r < p ? 0.0 : values[p * n + r]; };
  Symmetric permuted(n);
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t r = 0; r < n; ++r) permuted(r, c) = a(front.ids[r], front.ids[c]);
  }
  outcome.difference = largest_difference(permuted, [&](std::size_t r, std::size_t c) {
    double sum = r >= k && c >= k ? values[c * n + r] : 0;
    for (std::size_t p = 0; p < k; ++p) {
      sum += l(r, p) * d[p] * l(c, p);
      if (off[p] != 0) sum += off[p] * (l(r, p) * l(c, p + 1) + l(r, p + 1) * l(c, p));
    }
    return sum;
  });
  // Rows that are no candidates keep their place.
  for (std::size_t r = candidates; r < n; ++r) REQUIRE(front.ids[r] == static_cast<std::int64_t>(r));
  return outcome;
}

}  // namespace

TEST_CASE("factors_of_a_positive_front_multiply_to_the_front") {
  struct Size {
    std::size_t pivots, updates;
  };
  // From 768 rows on, fronts are worked on in tiles of 256.
  const auto [k, m] =
      GENERATE(values<Size>({{1, 0}, {3, 5}, {30, 60}, {300, 468}, {256, 512}, {700, 100}, {769, 0}, {5, 800}}));
  const int threads = GENERATE(1, 3);
  const ThreadsFor with(threads);
  const std::size_t n = k + m;
  const Symmetric a = random_symmetric(n, static_cast<double>(n), 0, 5);
  std::vector<double> panel(n * k), update(m * m, 0.0);
  std::copy_n(a.values.begin(), n * k, panel.begin());
  for (std::size_t c = 0; c < m; ++c) {
    for (std::size_t r = c; r < m; ++r) update[c * m + r] = a(k + r, k + c);
  }
  REQUIRE(factorize_front(k, m, panel.data(), update.data()) == 0);
  Random random(6);
  double difference = 0;
  // Every entry of small fronts, some of large ones.
  const bool all = n <= 100;
  for (std::size_t trial = 0; trial < (all ? n * n : 20000); ++trial) {
    std::size_t r = all ? trial / n : random.below(n), c = all ? trial % n : random.below(n);
    if (r < c) std::swap(r, c);
    double sum = c >= k ? update[(c - k) * m + r - k] : 0;
    for (std::size_t p = 0; p < std::min(k, c + 1); ++p) sum += panel[p * n + r] * panel[p * n + c];
    difference = std::max(difference, std::abs(sum - a(r, c)));
  }
  CAPTURE(k, m, threads, difference);
  CHECK(difference < 1e-14 * static_cast<double>(n));
}

TEST_CASE("a_front_that_is_not_positive_definite_names_its_first_bad_pivot") {
  const std::size_t k = GENERATE(5, 800), bad = GENERATE(0, 3);
  Symmetric a = random_symmetric(k, static_cast<double>(k), 0, 5);
  a(bad, bad) = -1;
  CAPTURE(k, bad);
  CHECK(factorize_front(k, 0, a.values.data(), nullptr) == static_cast<int>(bad) + 1);
}

TEST_CASE("factors_of_an_indefinite_front_multiply_to_the_front") {
  const double u = GENERATE(0.01, 0.1, 0.5);
  const double zero_share = GENERATE(0.0, 0.5, 1.0);
  std::size_t two_by_two = 0, left = 0;
  for (const std::size_t n : {1, 2, 7, 60, 150, 400}) {
    for (const std::size_t candidates : {n, n / 2}) {
      const Symmetric a = random_symmetric(n, 0, zero_share, 100 + n);
      const Outcome outcome = factorize_and_multiply(a, candidates, u);
      CAPTURE(n, candidates, u, zero_share, outcome.pivots.count, outcome.two_by_two, outcome.pivots.growth,
              outcome.difference);
      CHECK(outcome.pivots.count <= candidates);
      CHECK(outcome.pivots.growth <= (1 + 1e-12) / u);
      CHECK(outcome.difference < 1e-13 * static_cast<double>(n) / u);
      // Where no row lies outside the candidates, only zeros may be left.
      if (candidates == n && n > 1) CHECK(outcome.pivots.count == n);
      two_by_two += outcome.two_by_two;
      left += candidates - outcome.pivots.count;
    }
  }
  CAPTURE(u, zero_share, two_by_two, left);
  if (zero_share == 1) CHECK(two_by_two > 0);
}

TEST_CASE("candidates_that_would_grow_stay_behind") {
  // A small diagonal entry with a large coupling to a row that is no candidate.
  Symmetric a(3);
  a(0, 0) = 1e-6;
  a(1, 1) = 2;
  a(2, 0) = a(0, 2) = 1;
  a(2, 2) = 1;
  const Outcome outcome = factorize_and_multiply(a, 2, 0.01);
  CAPTURE(outcome.pivots.growth, outcome.difference);
  CHECK(outcome.pivots.count == 1);
  CHECK(outcome.pivots.diagonal == std::vector<double>{2});
  CHECK(outcome.difference < 1e-15);
}

TEST_CASE("what_counts_as_nothing_is_no_pivot") {
  Symmetric a(4);  // rank 1, twice over
  for (const std::size_t r : {0, 1}) {
    for (const std::size_t c : {0, 1}) a(r, c) = 1, a(r + 2, c + 2) = -1;
  }
  const Outcome outcome = factorize_and_multiply(a, 4, 0.01);
  CHECK(outcome.pivots.count == 2);
  CHECK(outcome.difference < 1e-15);
}
