// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_file.hpp"

#include <algorithm>
#include <cctype>
#include <memory>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "equidem/casefile/study/study_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"

#include "verbs.hpp"

namespace equidem {
namespace {

/// One run of a verb, as the command line would do it: quiet, its result as JSON into a file of its own.
class VerbRun {
 public:
  VerbRun(const StudyCase& study, const std::vector<std::string>& overrides, bool quiet)
      : quiet_(quiet),
        result_(std::filesystem::temp_directory_path() / fmt::format("equidem-study-{}-{}.json", getpid(), ++count)) {
    const auto verb = std::find_if(verbs.begin(), verbs.end(), [&](const Verb& v) { return v.name == study.verb; });
    run_ = verb->declare(command_);
    std::vector<std::string> arguments{study.case_file.string(), "--quiet", "--json", result_.string()};
    for (const std::string& assignment : overrides) {
      arguments.emplace_back("--set");
      arguments.push_back(assignment);
    }
    std::reverse(arguments.begin(), arguments.end());
    command_.parse(arguments);
  }
  ~VerbRun() {
    std::error_code ignored;
    std::filesystem::remove(result_, ignored);
    set_progress_shown(!quiet_);
  }
  VerbRun(const VerbRun&) = delete;
  VerbRun& operator=(const VerbRun&) = delete;

  void operator()() { run_(); }
  [[nodiscard]] double value(const std::string& measure) const {
    const auto number = number_in_json(read_file(result_), measure);
    if (!number)
      bad_input(fmt::format("the result has no number '{}'", measure), "study.measure names one of its keys",
                "'equidem VERB CASE.toml --json -' shows them");
    return *number;
  }

 private:
  static inline int count = 0;
  bool quiet_;
  std::filesystem::path result_;
  CLI::App command_;
  Run run_;
};

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
    study.tasks.push_back({point.setting, [resolved, point, quiet = options.quiet] {
                             const auto run = std::make_shared<VerbRun>(resolved, point.overrides, quiet);
                             return Trial{.work = [=] { (*run)(); },
                                          .values = [=] { return std::vector{run->value(resolved.measure)}; }};
                           }});
  }
  study.notes = {"Times are of the whole verb: reading the case, computing, and writing its result."};
  return study;
}

}  // namespace equidem
