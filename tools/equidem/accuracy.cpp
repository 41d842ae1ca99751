// SPDX-License-Identifier: GPL-3.0-or-later
#include "accuracy.hpp"

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/evaluate.hpp"

#include "solve/report.hpp"

namespace equidem {
namespace {

std::string text_of(const AccuracySetting& setting) {
  std::string text;
  for (const auto& [key, value] : setting) text += fmt::format("{}{} = {:.6g}", text.empty() ? "" : ", ", key, value);
  return text;
}

JsonObject json_of(const AccuracySetting& setting) {
  JsonObject object;
  for (const auto& [key, value] : setting) object.set(key, value);
  return object;
}

}  // namespace

void add_accuracy_option(CLI::App& command, std::optional<double>& accuracy, const std::string& what) {
  const auto wrong = [](const std::string& given) -> std::string {
    double value = 0;
    const bool right = CLI::detail::lexical_cast(given, value) && value >= 1e-15 && value < 1;
    return right ? "" : fmt::format("'{}' is not a number of at least 1e-15 and below 1, such as 0.01", given);
  };
  command.add_option("--accuracy", accuracy, what)->check(wrong)->type_name("X");
}

void refuse_dry_run_with_accuracy(const CommonOptions& options, bool accuracy) {
  if (accuracy && options.dry_run)
    bad_input("--accuracy and --dry-run exclude each other",
              "settings are chosen by computing coarser ones, and a dry run computes nothing", "Leave one of them out");
}

std::string describe_accuracy(const ReachedAccuracy& reached) {
  const auto& more = reached.ten_times_more;
  std::string text = report_line("accuracy", fmt::format("asked {:.3g}, estimated to be reached {:.2g}: {}",
                                                         reached.requested, reached.estimated, reached.of));
  if (!reached.knob.empty())
    text += report_line("", fmt::format("chosen: {}, {}", reached.knob, text_of(reached.value)));
  if (!reached.pilots.empty())
    text += report_line("", fmt::format("to choose it took {}: {:.2g} times the work of what was chosen, beside it",
                                        reached.pilots, reached.pilots_factor));
  text += report_line("", more.note.empty()
                              ? fmt::format("ten times more accuracy ({:.3g}): about {:.3g} times the time, {}; {}",
                                            reached.requested / 10, more.time_factor, readable_seconds(more.seconds),
                                            text_of(more.value))
                              : fmt::format("ten times more accuracy ({:.3g}): {}", reached.requested / 10, more.note));
  return text;
}

void add_accuracy(JsonObject& object, const ReachedAccuracy& reached) {
  const auto& more = reached.ten_times_more;
  JsonObject ten, accuracy;
  ten.set("time_factor", more.time_factor).set("seconds", more.seconds).set("value", json_of(more.value));
  if (!more.note.empty()) ten.set("note", more.note);
  accuracy.set("requested", reached.requested).set("estimated", reached.estimated).set("of", reached.of);
  accuracy.set("knob", reached.knob).set("value", json_of(reached.value));
  accuracy.set("pilots", reached.pilots).set("pilots_factor", reached.pilots_factor).set("ten_times_more", ten);
  object.set("accuracy", accuracy);
}

}  // namespace equidem
