// SPDX-License-Identifier: GPL-3.0-or-later
// Paths of frictional contacts, saved between two events and restored.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "equidem/breakage/path_numbers.hpp"
#include "equidem/core/error.hpp"

#include "breakage/random_packings.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Unbonded path_of(const DrawnPacking& d) {
  return {d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation};
}

std::vector<double> saved(Unbonded& path) {
  PathNumbers numbers;
  path.run().pass(numbers);
  return numbers.numbers();
}

void restore(Unbonded& path, const std::vector<double>& numbers) {
  PathNumbers kept(numbers);
  path.run().pass(kept);
  kept.check_end();
}

/// Place of the first number whose bits differ; -1: none.
std::int64_t first_difference(const std::vector<double>& a, const std::vector<double>& b) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  const auto [x, y] = std::ranges::mismatch(a, b, {}, bits, bits);
  return x == a.end() && y == b.end() ? -1 : x - a.begin();
}

/// \return whether the path goes on
bool step(Unbonded& path, std::int64_t& left) {
  return left-- > 0 && path.run().advance();
}

}  // namespace

TEST_CASE("numbers_of_a_state_with_other_members_are_refused") {
  double load = 1.5;
  std::int64_t events = 3;
  std::vector<std::int64_t> contacts{4, 5};
  PathNumbers numbers;
  EQUIDEM_PASS(numbers, load, events, contacts);
  const auto named = [&](const char* names, auto&... members) {
    PathNumbers kept(numbers.numbers());
    kept.pass(names, members...);
    kept.check_end();
  };
  const auto restored = [&](auto&... members) { named("load, events, contacts", members...); };
  restored(load, events, contacts);
  CHECK(load == 1.5);
  CHECK(events == 3);
  double other = 0;
  std::vector<double> lengths;
  CHECK_THROWS_AS(restored(events, load, contacts), Error);
  CHECK_THROWS_AS(restored(load, events, lengths), Error);
  CHECK_THROWS_AS(restored(load, events), Error);
  CHECK_THROWS_AS(restored(load, events, contacts, other), Error);
  CHECK_THROWS_AS(named("motion, events, contacts", load, events, contacts), Error);
}

TEST_CASE("a_path_that_is_restored_goes_on_with_the_same_bits") {
  constexpr std::int64_t most = 150;
  std::int64_t restored = 0, breaks = 0, slips = 0, ended = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const DrawnPacking d = draw_packing(seed);
    Unbonded whole = path_of(d);
    std::int64_t left = most, steps = 0;
    while (step(whole, left)) ++steps;
    const std::vector<double> expected = saved(whole);
    Random random(seed);
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::int64_t>(random.uniform(0, static_cast<double>(steps) + 1));
      Unbonded first = path_of(d), second = path_of(d);
      left = most;
      while (most - left < at && step(first, left)) {
      }
      restore(second, saved(first));
      CAPTURE(d.name, steps, at, whole.run().why(), second.events().size());
      REQUIRE(first_difference(saved(second), saved(first)) == -1);
      while (step(second, left)) {
      }
      CHECK(first_difference(saved(second), expected) == -1);
      CHECK(second.events().size() == whole.events().size());
      ++restored;
    }
    ended += whole.run().end() == PathEnd::legs_done ? 1 : 0;
    for (const BreakEvent& event : whole.events()) {
      breaks += event.mode == BreakMode::tension || event.mode == BreakMode::shear ? 1 : 0;
      slips += event.mode == BreakMode::slip ? 1 : 0;
    }
  }
  CAPTURE(restored, breaks, slips, ended);
  CHECK(breaks > 100);
  CHECK(slips > 100);
  CHECK(ended > 10);
}

TEST_CASE("a_path_that_has_ended_is_restored_with_its_end") {
  const DrawnPacking d = draw_packing(5);
  Unbonded first = path_of(d), second = path_of(d);
  first.all();
  restore(second, saved(first));
  CHECK(second.run().end() == first.run().end());
  CHECK(second.run().why() == first.run().why());
  CHECK_FALSE(second.run().advance());
}

TEST_CASE("the_state_of_another_path_is_refused") {
  Unbonded first = path_of(draw_packing(5));
  std::vector<double> numbers = saved(first);
  for (const bool longer : {true, false}) {
    std::vector<double> other = numbers;
    longer ? other.push_back(0) : other.pop_back();
    Unbonded second = path_of(draw_packing(5));
    CHECK_THROWS_AS(restore(second, other), Error);
  }
}
