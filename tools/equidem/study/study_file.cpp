// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_file.hpp"

#include <algorithm>
#include <cctype>
#include <memory>

#include "equidem/casefile/study/study_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "verb_run.hpp"

namespace equidem {
namespace {

/// The number that a study measures.
double measured_number(const Delivery& result, const std::string& measure) {
  const auto number = number_in_json(result.results.json(), measure);
  if (!number)
    bad_input(fmt::format("the result has no number '{}'", measure), "study.measure names one of its keys",
              "'equidem VERB CASE.toml --json -' shows them");
  return *number;
}

}  // namespace

Study study_of_file(const std::filesystem::path& path, const CommonOptions& options) {
  const StudyCase resolved = read_study_case(path);
  if (!std::filesystem::exists(resolved.case_file))
    bad_input(fmt::format("there is no case '{}'", resolved.case_file.string()), "study.case names it",
              "Correct the name; it is relative to the folder of the study file");
  std::string name = path.stem().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-'; }, '_');
  std::string label = resolved.measure;
  std::replace(label.begin(), label.end(), '.', '_');
  Study study{
      .name = name,
      .title = resolved.title.empty() ? fmt::format("{} of {}", resolved.measure, resolved.verb) : resolved.title,
      .quantities = {{.name = label,
                      .label = fmt::format("{}error of {}", resolved.relative ? "relative " : "", resolved.measure),
                      .relative = resolved.relative,
                      .truth = resolved.value,
                      .source = resolved.truth == Truth::known    ? "the value of the study file"
                                : resolved.truth == Truth::finest ? "the finest level, whose own error is not known"
                                                                  : "Richardson's limit of the two finest levels"}},
      .tasks = {},
      .truth = resolved.truth};
  if (resolved.order) study.orders = {{.order = *resolved.order, .why = "as the study file says"}};
  for (const StudyPoint& point : points_of(resolved)) {
    study.tasks.push_back(
        {point.setting, [resolved, point, quiet = options.quiet] {
           const std::vector<std::string> option(quiet ? 1 : 0, "--quiet");
           const auto run = std::make_shared<VerbRun>(resolved.verb, resolved.case_file, point.overrides, option);
           const auto result = std::make_shared<Delivery>();
           return Trial{.work = [=] { *result = (*run)(); },
                        .values = [=] { return std::vector{measured_number(*result, resolved.measure)}; }};
         }});
  }
  study.notes = {"Times are of the whole verb without its report and files: reading the case, and computing."};
  return study;
}

}  // namespace equidem
