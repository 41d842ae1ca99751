// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/page/page.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

using Verdict = TrustCheck::Verdict;

Results bonded_run(double step_ratio, double change, double imbalance, double ratio) {
  Results results;
  return results.set("time_step", 1e-6)
      .set("time_step_ratio", step_ratio)
      .set("critical_time_step_exact", true)
      .set("largest_deformation", change)
      .set("energy/relative_error", imbalance)
      .set("springs/ratio", ratio);
}

std::vector<Verdict> verdicts(const Results& results) {
  std::vector<Verdict> all;
  for (const TrustCheck& check : trust_checks(results)) {
    CAPTURE(check.name, check.found, check.advice);
    CHECK((check.verdict == Verdict::good) == check.advice.empty());
    all.push_back(check.verdict);
  }
  return all;
}

}  // namespace

TEST_CASE("a_key_is_found_in_objects_and_lists") {
  Results results;
  results.set("a/b", 1.0).set("nested", Results().set("c", 2.0)).set("a/b", 3.0);
  results.table("rows", {Results().set("x", 4.0), Results().set("x", 5.0)}).set("none", std::vector<Results>{});
  const auto number = [&](const char* path) {
    const Result* found = find_result(results, path);
    return found == nullptr ? -1 : std::get<double>(found->value.value);
  };
  CHECK(number("a/b") == 3);
  CHECK(number("nested/c") == 2);
  CHECK(number("rows/0/x") == 4);
  CHECK(number("rows/$/x") == 5);
  for (const char* path : {"a", "ab", "nested/d", "rows/2/x", "rows/-1/x", "none/$/x", "none/0/x", ""}) {
    CAPTURE(path);
    CHECK(find_result(results, path) == nullptr);
  }
}

TEST_CASE("a_run_is_trusted_where_step_overlap_balance_and_springs_allow_it") {
  using enum TrustCheck::Verdict;
  CHECK(verdicts(bonded_run(0.8, 1e-4, 1e-12, 0.5)) == std::vector{good, good, good, good});
  CHECK(verdicts(bonded_run(1.1, 0.02, -0.01, -0.1)) == std::vector{bad, doubtful, doubtful, bad});
  CHECK(verdicts(bonded_run(0.5, 0.2, 0.5, 0)) == std::vector{good, bad, bad, good});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(verdicts(Results().set("time_step", nan)).empty());
}

TEST_CASE("the_step_of_colliding_bodies_is_judged_by_one_contact") {
  using enum TrustCheck::Verdict;
  Results results;
  results.set("time_step", 1e-6).set("grains", 5).set("largest_overlap", nullptr);
  for (const auto& [critical, verdict] : {std::pair{4e-6, good}, {1.5e-6, doubtful}, {0.9e-6, bad}}) {
    CAPTURE(critical);
    CHECK(verdicts(Results(results).set("critical_time_step", critical)).front() == verdict);
  }
  CHECK(verdicts(Results(results).set("critical_time_step", nullptr).set("steps_in_contact", 3.0)).front() == good);
  CHECK(verdicts(Results(results).set("critical_time_step", nullptr).set("steps_in_contact", nullptr)).front() ==
        doubtful);
}

TEST_CASE("numbers_of_a_page_have_the_sign_and_the_power_of_print") {
  CHECK(number_html(0.5) == "0.5");
  CHECK(number_html(-0.25) == "−0.25");
  CHECK(number_html(1.5e-19, 2) == "1.5 × 10<sup>−19</sup>");
  CHECK(number_html(-2e12, 2) == "−2 × 10<sup>12</sup>");
}

TEST_CASE("an_answer_has_the_prefix_of_its_unit_and_its_error_the_same") {
  Results results;
  results.set("shear_modulus", 2.5e9).set("error_bound", 3e-6).set("young_modulus/plane_strain", nullptr);
  const Answers answers = answers_of("homogenize", results);
  REQUIRE(answers.main.size() == 1);
  CHECK(answers.main[0].text == "2.5");
  CHECK(answers.main[0].unit == "GPa");
  CHECK(answers.main[0].value == 2.5e9);
  CHECK(answers.main[0].error == "± 3 × 10<sup>−15</sup> GPa");
  CHECK(answers_of("no verb", results).main.empty());
}

TEST_CASE("figures_are_embedded_as_they_are") {
  const TemporaryFolder folder;
  ResultPage page{
      .verb = "solve", .status = "solved", .version = "1", .command = "", .case_text = "", .report = "", .results = {}};
  const auto shown = [&](const char* name, const std::string& bytes, const std::string& address) {
    write_file(folder / name, bytes, true);
    page.figures = {{.name = name, .title = "a < b", .file = folder / name}};
    const std::string html = result_page_html(page);
    CAPTURE(html, address);
    return html.find("<img alt=\"a &lt; b\" src=\"data:image/" + address + "\">") != std::string::npos;
  };
  CHECK(shown("a.png", "Man", "png;base64,TWFu"));
  CHECK(shown("a.png", "Ma", "png;base64,TWE="));
  CHECK(shown("a.png", "M", "png;base64,TQ=="));
  CHECK(shown("a.png", "\xff\xfe\xfd", "png;base64,//79"));
  CHECK(shown("a.svg", "<svg/>", "svg+xml;base64,PHN2Zy8+"));
}

TEST_CASE("a_page_stays_below_its_size_and_names_what_it_lacks") {
  ResultPage page{.verb = "solve",
                  .status = "solved",
                  .version = "1",
                  .command = "equidem solve a.toml",
                  .case_text = std::string(500'000, 'x'),
                  .report = std::string(500'000, 'y'),
                  .results = {}};
  page.figures.push_back({.name = "motion", .title = "t", .player = std::string(1'700'000, ' ')});
  page.figures.push_back({.name = "energy", .title = "t", .missing = "gnuplot is not installed"});
  const std::string html = result_page_html(page);
  CHECK(html.size() < most_page_bytes);
  CHECK(html.find("energy: gnuplot is not installed") != std::string::npos);
  CHECK(result_page_html(page) == html);
}
