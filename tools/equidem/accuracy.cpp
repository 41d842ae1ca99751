// SPDX-License-Identifier: GPL-3.0-or-later
#include "accuracy.hpp"

#include <algorithm>
#include <cmath>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/evaluate.hpp"

#include "verbs.hpp"

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

CaseSearch::CaseSearch(const CommonOptions& options, SearchedSetting searched)
    : options_(options),
      searched_(std::move(searched)),
      search_(
          [this](std::int64_t level) {
            const Stopwatch watch;
            std::vector<double> values = searched_.values_of(case_of(level));
            seconds_before_ += watch.seconds();
            return values;
          },
          searched_.refinement) {}

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
  for (const auto& [key, value] : searched_.setting_of(level)) set.set.push_back(fmt::format("{}={:.17g}", key, value));
  return read_case(set);
}

std::vector<std::int64_t> CaseSearch::before() const {
  std::vector<std::int64_t> levels = pilots();
  levels.insert(levels.end(), proposed_.begin(), proposed_.end() - 1);
  return levels;
}

ReachedAccuracy CaseSearch::reached() const {
  const auto& [accuracy, admissible] = std::tie(searched_.refinement.accuracy, searched_.refinement.admissible);
  const bool enough = search_.error(level()) <= accuracy / 10;
  std::int64_t finer = enough ? level() : search_.level_for(accuracy / 10, level());
  if (admissible) finer = admissible(finer);
  const double factor = std::pow(static_cast<double>(finer) / static_cast<double>(level()), searched_.work_exponent);
  return {.requested = accuracy,
          .estimated = search_.error(level()),
          .of = fmt::format("{} (errors fall as {}^-{:.2f})", searched_.of, searched_.refinement.unit, search_.order()),
          .knob = searched_.knob,
          .value = searched_.setting_of(level()),
          .ten_times_more = {.time_factor = factor,
                             .seconds = factor * seconds_,
                             .value = searched_.setting_of(finer),
                             .note = enough ? has_it_already : ""}};
}

ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds) {
  if (!(error_bound > 0) || error_bound > accuracy) {
    computation_failed(fmt::format("an accuracy of {:.3g} cannot be reached", accuracy),
                       error_bound <= 0 ? "this solver gives no bound of its error"
                       : condition > 0  ? fmt::format("the answer is known to {:.2g}: its condition is about {:.1e}",
                                                      error_bound, condition)
                                        : fmt::format("the answer is known to {:.2g}", error_bound),
                       error_bound > 0 ? "Ask for less, or give the assembly with fewer extremes of size or stiffness"
                                       : "Set solver.method = \"auto\"");
  }
  ReachedAccuracy reached{
      .requested = accuracy,
      .estimated = error_bound,
      .of = fmt::format("the answer to this assembly, {}; what the assembly stands for is not judged",
                        condition > 0 ? "bound from the residual and the condition" : "estimated from the iterations"),
      .ten_times_more = {.seconds = seconds}};
  if (condition == 0) {
    reached.ten_times_more.note = "about two iterations more";
    return reached;
  }
  reached.ten_times_more.note = error_bound <= accuracy / 10
                                    ? "nothing: the direct solution has it already"
                                    : "cannot be had: the direct solution is refined as far as doubles go";
  return reached;
}

}  // namespace equidem
