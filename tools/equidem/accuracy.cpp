// SPDX-License-Identifier: GPL-3.0-or-later
#include "accuracy.hpp"

#include <cmath>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/evaluate.hpp"

#include "option_checks.hpp"

namespace equidem {
namespace {

std::string text_of(const AccuracySetting& setting) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : setting) parts.push_back(fmt::format("{} = {:.6g}", key, value));
  return joined(parts);
}

Results json_of(const AccuracySetting& setting) {
  Results object;
  for (const auto& [key, value] : setting) object.set(key, value);
  return object;
}

}  // namespace

void add_accuracy_option(CLI::App& command, std::optional<double>& accuracy, const std::string& what) {
  const auto wrong = [](const std::string& given) -> std::string {
    const auto value = number_given<double>(given);
    const bool right = value && *value >= 1e-15 && *value < 1;
    return right ? "" : fmt::format("'{}' is not a number of at least 1e-15 and below 1, such as 0.01", given);
  };
  command.add_option("--accuracy", accuracy, what)->check(wrong)->type_name("X");
}

Results accuracy_plan(double accuracy, const std::string& how) {
  return Results().line("accuracy").add("accuracy/requested", "asked", accuracy, "", {.digits = 3}).note("; " + how);
}

Results accuracy_results(const ReachedAccuracy& reached) {
  const auto& more = reached.ten_times_more;
  Results results;
  results.line("accuracy")
      .add("accuracy/requested", "asked", reached.requested, "", {.digits = 3})
      .add("accuracy/estimated", "estimated to be reached", reached.estimated, "", {.digits = 2})
      .note(": " + reached.of);
  results.set("accuracy/of", reached.of).set("accuracy/knob", reached.knob);
  results.set("accuracy/value", json_of(reached.value)).set("accuracy/pilots", reached.pilots);
  if (!reached.knob.empty()) results.line("", fmt::format("chosen: {}, {}", reached.knob, text_of(reached.value)));
  if (!reached.pilots.empty()) results.line("", fmt::format("to choose it took {}: ", reached.pilots));
  reached.pilots.empty() ? results.set("accuracy/pilots_factor", reached.pilots_factor)
                         : results.add("accuracy/pilots_factor", "", reached.pilots_factor,
                                       "times the work of what was chosen, beside it", {.digits = 2});
  results.line("", fmt::format("ten times more accuracy ({:.3g}): ", reached.requested / 10));
  results.note(more.note.empty() ? fmt::format("about {:.3g} times the time, {}; {}", more.time_factor,
                                               readable_seconds(more.seconds), text_of(more.value))
                                 : more.note);
  Results ten;
  ten.set("time_factor", more.time_factor).set("seconds", more.seconds).set("value", json_of(more.value));
  if (!more.note.empty()) ten.set("note", more.note);
  return results.set("accuracy/ten_times_more", ten);
}

CaseSearch::CaseSearch(const CommonOptions& options, RefinementOptions refinement, SettingOf setting_of,
                       std::function<std::vector<double>(Case)> values_of)
    : options_(options),
      accuracy_(refinement.accuracy),
      unit_(refinement.unit),
      setting_of_(std::move(setting_of)),
      values_of_(std::move(values_of)),
      admissible_(refinement.admissible),
      search_(
          [this](std::int64_t level) {
            const Stopwatch watch;
            std::vector<double> values = values_of_(case_of(level));
            seconds_before_ += watch.seconds();
            return values;
          },
          std::move(refinement)) {}

Case CaseSearch::propose() {
  proposed_.push_back(search_.propose());
  return case_of(proposed_.back());
}

bool CaseSearch::accepts(std::vector<double> values, double seconds) {
  seconds_before_ += seconds_;
  seconds_ = seconds;
  return search_.accepts(proposed_.back(), std::move(values));
}

Case CaseSearch::case_of(std::int64_t level) const {
  CommonOptions set = options_;
  for (const auto& [key, value] : setting_of_(level)) set.set.push_back(fmt::format("{}={:.17g}", key, value));
  return read_case(set);
}

ReachedAccuracy CaseSearch::reached_accuracy(const std::string& of, const std::string& knob,
                                             double work_exponent) const {
  const std::int64_t level = proposed_.back();
  const bool enough = search_.error(level) <= accuracy_ / 10;
  std::int64_t finer = enough ? level : search_.level_for(accuracy_ / 10, level);
  if (admissible_) finer = admissible_(finer);
  const double factor = std::pow(static_cast<double>(finer) / static_cast<double>(level), work_exponent);
  return {.requested = accuracy_,
          .estimated = search_.error(level),
          .of = fmt::format("{} (errors fall as {}^-{:.2f})", of, unit_, search_.order()),
          .knob = knob,
          .value = setting_of_(level),
          .pilots = {},
          .ten_times_more = {.time_factor = factor,
                             .seconds = factor * seconds_,
                             .value = setting_of_(finer),
                             .note = enough ? has_it_already : ""}};
}

}  // namespace equidem
