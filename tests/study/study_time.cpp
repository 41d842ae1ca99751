// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/study_time.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/stopwatch.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Settings of resolution 1, 1/2, 1/4, ... whose time grows as its inverse square, from 2 ms on.
Study squares(int levels) {
  Study study{.name = "squares", .title = "", .quantities = {{.name = "error"}}, .tasks = {}};
  for (int k = levels; k-- > 0;) {
    const double h = std::ldexp(1.0, -k);
    study.tasks.push_back({{.values = {{"h", h}}, .resolution = h}, [=] {
                             return Trial{.work =
                                              [=] {
                                                const Stopwatch watch;
                                                while (watch.seconds() < 2e-3 / (h * h)) {
                                                }
                                              },
                                          .values = [=] { return std::vector{h}; }};
                           }});
  }
  return study;
}

}  // namespace

TEST_CASE("the_time_of_fine_settings_follows_from_that_of_coarse_ones") {
  const StudyOptions options{.budget = 1, .least_rounds = 3, .most_rounds = 100};
  const StudyEstimate all = estimate_study(squares(3), options, 10);
  CAPTURE(all.round, all.least, all.most);
  CHECK(all.timed == 3);
  CHECK(all.round >= 0.042);
  CHECK(all.least == 4 * all.round);
  CHECK(all.most >= all.least);
  // 2, 8, 32 ms; the others are 128 ms to 33 s. Other programs lengthen single settings: the least of five estimates.
  std::vector<StudyEstimate> some;
  for (int k = 0; k < 5; ++k) some.push_back(estimate_study(squares(8), options, 0.1));
  const StudyEstimate least = *std::ranges::min_element(some, {}, &StudyEstimate::round);
  CAPTURE(least.timed, least.round);
  CHECK(least.timed < 5);
  CHECK(least.round > 43.69 / 3);
  CHECK(least.round < 43.69 * 3);
}
