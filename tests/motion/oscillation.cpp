// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "equidem/motion/saved_state.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double period = 0.37;

double cosine(double time) {
  return std::cos(2 * std::numbers::pi * time / period);
}

Oscillation sampled(double step, double end) {
  Oscillation result;
  for (int k = 0; k * step <= end; ++k) result.add(k * step, cosine(k * step));
  return result;
}

}  // namespace

TEST_CASE("the_period_of_a_cosine_is_found_to_second_order_in_the_step") {
  const double coarse = std::abs(*sampled(0.0201, 2).period() - period);
  const double fine = std::abs(*sampled(0.00201, 2).period() - period);
  CAPTURE(coarse, fine);
  CHECK(coarse < 0.01 * period);
  CHECK(fine < 0.03 * coarse);
}

TEST_CASE("an_oscillation_counts_its_passages_and_how_even_they_are") {
  const Oscillation even = sampled(1e-4, 2.5 * period);
  CHECK(even.passages() == 5);
  CHECK(*even.spread() < 1e-4);
  Oscillation uneven;
  for (const auto& [time, value] : {std::pair{0.0, 1.0}, {1.0, -1.0}, {2.0, 1.0}, {5.0, -1.0}}) uneven.add(time, value);
  CHECK(uneven.passages() == 3);  // at 0.5, 1.5, 3.5
  CHECK(*uneven.period() == Approx(3.0));
  CHECK(*uneven.spread() == Approx(1.0 / 3));
}

TEST_CASE("no_period_without_two_passages") {
  CHECK_FALSE(Oscillation().period());
  const Oscillation quarter = sampled(1e-3, 0.5 * period);
  CHECK(quarter.passages() == 1);
  CHECK_FALSE(quarter.period());
  CHECK_FALSE(quarter.spread());
}

TEST_CASE("an_oscillation_goes_on_from_where_it_was_saved") {
  const auto saved = [](const Oscillation& one) {
    return saved_rows("oscillation", std::vector{one}, Oscillation::numbers);
  };
  Oscillation whole, parted;
  for (int k = 0; k < 200; ++k) {
    const double time = 0.013 * k;
    whole.add(time, cosine(time));
    if (k % 7 == 0) parted = rows_in<Oscillation>({.arrays = {saved(parted)}}, "oscillation", Oscillation::numbers)[0];
    parted.add(time, cosine(time));
  }
  CHECK(saved(parted) == saved(whole));
}
