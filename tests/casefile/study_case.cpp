// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/study/study_case.hpp"

#include <cmath>
#include <string>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

const std::string head = R"(schema = "equidem/1"
[study]
verb    = "solve"
case    = "block.toml"
measure = "poisson_ratio"
)";
const std::string rows = R"([[vary]]
key    = "assembly.rows, assembly.columns"
values = [9, 17, 33]
)";

StudyCase parsed_study(const std::string& text) {
  return parse_study_case(text, "study.toml", "cases");
}

}  // namespace

TEST_CASE("a_study_file_tries_every_combination_of_its_values") {
  const StudyCase study =
      parsed_study(head + rows + "[[vary]]\nkey = \"springs.kT\"\nvalues = [0.5, 1e8]\nrefines = \"not\"\n");
  CHECK(study.case_file == "cases/block.toml");
  CHECK(study.truth == Truth::finest);
  const auto points = points_of(study);
  REQUIRE(points.size() == 6);
  CHECK(points[1].overrides ==
        std::vector<std::string>{"assembly.rows=9", "assembly.columns=9", "springs.kT=100000000"});
  CHECK(points[0].setting.method == "springs.kT = 0.5");
  CHECK(points[5].setting.resolution == Approx(1 / 33.0));
  CHECK(points[5].setting.label() == "springs.kT = 1e+08, assembly.rows = 33");
}

TEST_CASE("each_name_of_a_study_file_is_a_method_with_its_order") {
  const auto points = points_of(parsed_study(
      head + rows + "[[vary]]\nkey = \"run.integrator\"\nnames = \"leapfrog, thesis\"\norders = [2, 1]\n"));
  REQUIRE(points.size() == 6);
  CHECK(points[1].overrides ==
        std::vector<std::string>{"assembly.rows=9", "assembly.columns=9", "run.integrator=thesis"});
  CHECK(points[1].setting.method == "thesis");
  CHECK(points[0].setting.order == 2);
  CHECK(points[5].setting.order == 1);
  CHECK_FALSE(points_of(parsed_study(head + rows))[0].setting.order);
}

TEST_CASE("smaller_values_may_be_the_finer_ones") {
  const auto points = points_of(
      parsed_study(head + "[[vary]]\nkey = \"run.time_step\"\nvalues = [0.1, 0.01]\nrefines = \"smaller\"\n"));
  CHECK(points[1].setting.resolution == 0.01);
  CHECK(points[1].overrides.front() == "run.time_step=0.01");
}

TEST_CASE("study_files_that_cannot_be_carried_out_are_refused") {
  const auto refused = [](const std::string& text, const std::string& why) {
    CAPTURE(text);
    CHECK_THROWS_WITH(parsed_study(text), Catch::Contains(why) && Catch::Contains("study.toml"));
  };
  refused(head, "nothing is varied");
  std::string misspelt = head + rows;
  misspelt.replace(misspelt.find("solve"), 5, "solv");
  refused(misspelt, "\"solv\" is no known verb");
  refused(misspelt, "Did you mean \"solve\"?");
  refused(head + "truth = \"richardson\"\n" + rows, "the order is missing");
  refused(head + "truth = \"known\"\n" + rows, "value");
  refused(head + "truth = \"known\"\nvalue = 0\n" + rows, "errors are relative to 0");
  refused(head + rows + rows, "assembly.rows is varied twice");
  refused(head + rows + "[[vary]]\nkey = \"springs.kT\"\nvalues = [1.0, 2.0]\n", "2 keys refine");
  refused(head + "[[vary]]\nkey = \"assembly.rows\"\nvalues = [3, 3]\n", "a value is given twice");
  refused(head + "[[vary]]\nkey = \"assembly.rows\"\nvalues = [0, 3]\n", "0 is among values that refine");
  const std::string methods = head + "[[vary]]\nkey = \"run.integrator\"\n";
  refused(methods, "values");
  refused(methods + "values = [1.0]\nnames = \"leapfrog\"\n", "names");
  refused(methods + "names = \"leapfrog, leapfrog\"\n", "a name is given twice");
  refused(methods + "names = \"leapfrog\"\norders = [1, 2]\n", "there are 2 orders of 1 names");
  refused(methods + "names = \"leapfrog\"\n", "no key refines");
  refused(head + "[[vary]]\nkey = \"springs.kT\"\nvalues = [1.0]\nrefines = \"not\"\n", "no key refines");
  refused(head + "[[vary]]\nkey = \"rows\"\nvalues = [1]\n", "'rows' is no key of a case");
  refused(head + "[[vary]]\nkey = \"assembly.rows\"\nvalues = [1]\nsteps = 3\n", "steps");
}
