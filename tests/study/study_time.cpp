// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/study_time.hpp"

#include <cmath>
#include <vector>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Settings of resolution 1, 1/2, 1/4, ...
Study halved(int levels) {
  Study study{.name = "halved", .title = "", .quantities = {{.name = "error"}}, .tasks = {}};
  for (int k = levels; k-- > 0;) {
    const double h = std::ldexp(1.0, -k);
    study.tasks.push_back({{.values = {{"h", h}}, .resolution = h},
                           [=] { return Trial{.work = [] {}, .values = [=] { return std::vector{h}; }}; }});
  }
  return study;
}

constexpr StudyOptions options{.budget = 1, .least_rounds = 3, .most_rounds = 100};

}  // namespace

TEST_CASE("the_time_of_fine_settings_follows_from_that_of_coarse_ones") {
  for (const double power : {0.0, 1.0, 2.0, 3.5}) {
    const auto seconds_of = [&](const StudyTask& task) { return 2e-3 * std::pow(task.setting.resolution, -power); };
    double round = 0;
    for (int k = 0; k < 8; ++k) round += 2e-3 * std::exp2(power * k);
    const StudyEstimate all = estimate_study(halved(8), options, 2 * round, seconds_of);
    const StudyEstimate some = estimate_study(halved(8), options, 0.005, seconds_of);
    CAPTURE(power, round, all.round, some.timed, some.round);
    CHECK(all.timed == 8);
    CHECK(all.round == Approx(round));
    CHECK(all.least == 4 * all.round);
    CHECK(all.most >= all.least);
    CHECK(some.timed <= 3);
    // two times tell the power
    if (some.timed >= 2) CHECK(some.round == Approx(round));
  }
}

TEST_CASE("a_setting_that_fails_has_a_time_too") {
  Study study = halved(1);
  study.tasks[0].prepare = []() -> Trial { computation_failed("it fails", "", ""); };
  CHECK(time_setting(study.tasks[0]) > 0);
  CHECK(estimate_study(study, options).timed == 1);
}
