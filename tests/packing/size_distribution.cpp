// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/size_distribution.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/packing/packing.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

namespace {

const std::vector<Sieve> sand = {{0.002, 0}, {0.004, 0.25}, {0.008, 0.7}, {0.016, 1}};

SizeDistribution distribution(int kind) {
  if (kind == 0) return {.smallest = 0.005, .largest = 0.01};
  if (kind == 1) return {.kind = SizeDistribution::Kind::log_normal, .median = 0.005, .deviation = 0.4};
  return {.kind = SizeDistribution::Kind::sieve_curve, .sieves = sand};
}

std::vector<double> drawn(const SizeDistribution& sizes, std::int64_t count, std::uint64_t seed = 5) {
  Random random(seed);
  return draw_radii(sizes, count, random);
}

}  // namespace

TEST_CASE("radii_have_the_moments_of_their_distribution") {
  const SizeDistribution sizes = distribution(GENERATE(0, 1, 2));
  constexpr std::int64_t count = 20000;
  double mean = 0, square = 0;
  for (const double r : drawn(sizes, count)) mean += r / count, square += r * r / count;
  const RadiusMoments expected = moments_of(sizes);
  CAPTURE(static_cast<int>(sizes.kind));
  // One radius from each of n equal parts: the error falls faster than n^(-1/2), which would be 0.003.
  CHECK(mean == Approx(expected.mean).epsilon(2e-5));
  CHECK(square == Approx(expected.mean_square).epsilon(1e-4));
}

TEST_CASE("the_logarithm_of_log_normal_radii_is_normal") {
  const auto radii = drawn(distribution(1), 20000);
  double mean = 0, variance = 0;
  for (const double r : radii) mean += std::log(r / 0.005) / static_cast<double>(radii.size());
  for (const double r : radii) variance += std::pow(std::log(r / 0.005) - mean, 2) / static_cast<double>(radii.size());
  CHECK(mean == Approx(0).margin(1e-4));
  // Cut at three deviations: 1 - 6 phi(3)/(2 Phi(3) - 1) of the variance is left.
  const double density = std::exp(-4.5) / std::sqrt(2 * 3.141592653589793), share = std::erf(3 / std::sqrt(2.0));
  CHECK(std::sqrt(variance) == Approx(0.4 * std::sqrt(1 - 6 * density / share)).epsilon(1e-3));
}

TEST_CASE("sieving_the_grains_gives_the_curve_back") {
  const auto radii = drawn(distribution(2), 20000);
  for (const Sieve& sieve : sand) {
    double passing = 0, all = 0;
    for (const double r : radii) {
      all += r * r;
      if (2 * r <= sieve.diameter * (1 + 1e-12)) passing += r * r;
    }
    CAPTURE(sieve.diameter);
    CHECK(passing / all == Approx(sieve.passing).margin(1e-3));
  }
}

TEST_CASE("a_seed_gives_the_same_radii_in_an_order_without_trend") {
  const SizeDistribution sizes = distribution(GENERATE(0, 1, 2));
  const auto radii = drawn(sizes, 2000);
  CHECK(radii == drawn(sizes, 2000));
  CHECK(radii != drawn(sizes, 2000, 6));
  const RadiusMoments expected = moments_of(sizes);
  double first_half = 0;
  for (std::size_t k = 0; k < 1000; ++k) first_half += radii[k] / 1000;
  const double deviation = std::sqrt(expected.mean_square - expected.mean * expected.mean);
  CHECK(first_half == Approx(expected.mean).margin(5 * deviation / std::sqrt(1000.0)));
}

TEST_CASE("sieve_curves_are_read_and_what_is_none_is_refused") {
  const auto path = std::filesystem::temp_directory_path() / "equidem_test_sieves.csv";
  const auto read = [&](const char* text) {
    std::ofstream(path) << text;
    const auto curve = read_sieve_curve(path);
    return curve;
  };
  const auto curve = read("# sand\ndiameter_m,passing\n0.002, 0\n\n0.004,0.25\r\n0.016,1");
  REQUIRE(curve.size() == 3);
  CHECK(curve[1].diameter == 0.004);
  CHECK(curve[1].passing == 0.25);
  for (const char* same :
       {"diameter_mm,passing\n2,0\n4,0.25\n16,1\n", "sieve [mm];passing [%]\n2;0\n4,0;25\n16;100\n",
        "passing_percent diameter_um\n0 2000\n25 4000\n100 16000\n", "0,002 0\n0,004 0,25\n0,016 1\n"}) {
    CAPTURE(same);
    const auto found = read(same);
    REQUIRE(found.size() == 3);
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(found[k].diameter == Approx(curve[k].diameter).epsilon(1e-15));
      CHECK(found[k].passing == curve[k].passing);
    }
  }
  const char* wrong =
      GENERATE("radius_mm,passing\n2,0\n4,1\n", "diameter_s,passing\n2,0\n4,1\n", "diameter_mm,retained\n2,0\n4,1\n",
               "0.002,0\n0.001,1\n", "0.002,0\n0.004,0.5\n", "0.002,0.1\n0.004,1\n", "0.002,0\n", "0.002,0\nx,1\n",
               "0.002\n0.004,1\n", "", "0.002,0\n0.003,0.9\n0.004,0.8\n0.005,1\n");
  CAPTURE(wrong);
  CHECK_THROWS_AS(read(wrong), Error);
  std::filesystem::remove(path);
}

TEST_CASE("a_sieve_curve_that_descends_or_is_in_percent_is_told_so") {
  const auto problem_of = [](std::vector<Sieve> sieves) -> std::string {
    return test::refusal_of([&] {
             check(SizeDistribution{.kind = SizeDistribution::Kind::sieve_curve, .sieves = std::move(sieves)});
           })
        .problem;
  };
  CHECK(problem_of({{0.002, 1}, {0.0015, 0.4}, {0.001, 0}}) == "the sieve curve descends");
  CHECK(problem_of({{0.001, 0}, {0.0015, 40}, {0.002, 100}}) == "the sieve curve runs to 100");
  CHECK(problem_of({{0.001, 0}, {0.0015, 0.4}, {0.002, 1}}).empty());
}

TEST_CASE("sizes_out_of_range_are_refused") {
  CHECK_THROWS_AS(check(SizeDistribution{.smallest = 0, .largest = 1}), Error);
  CHECK_THROWS_AS(check(SizeDistribution{.smallest = 2, .largest = 1}), Error);
  for (const double size : {1e-200, 1e-80, 1e80, 1e200}) {  // moments of inertia would be 0 or infinite
    CAPTURE(size);
    CHECK_THROWS_WITH(check(SizeDistribution{.smallest = size, .largest = size}), Catch::Contains("1e-60 to 1e60"));
    CHECK_THROWS_AS(check(SizeDistribution{.kind = SizeDistribution::Kind::log_normal, .median = size}), Error);
    PackingOptions options;
    options.box.size = {size, size};
    options.radii = {size / 10};
    CHECK_THROWS_WITH(pack(options), Catch::Contains("number"));
  }
  CHECK_THROWS_AS(check(SizeDistribution{.kind = SizeDistribution::Kind::log_normal, .median = 1, .deviation = -1}),
                  Error);
}
