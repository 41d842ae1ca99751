// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem study: error against time.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/study/built_in.hpp"
#include "equidem/study/run_study.hpp"

#include "command.hpp"
#include "option_checks.hpp"
#include "study/study_file.hpp"
#include "study/study_results.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct StudyVerb {
  CommonOptions common;
  std::string what;
  bool quick = false;
  bool list = false;
  double discs = 0;
  StudyOptions options;
  std::optional<double> accuracy;
};

bool is_file(const std::string& what) {
  return what.ends_with(".toml");
}

std::string list_of_studies() {
  std::string text = "Built-in studies:\n";
  for (const BuiltInStudy& study : built_in_studies()) text += fmt::format("  {:<20} {}\n", study.name, study.summary);
  return text;
}

std::string command_of(const StudyVerb& verb) {
  std::string command = "equidem study " + verb.what;
  if (verb.quick) command += " --quick";
  if (verb.discs > 0) command += fmt::format(" --discs {:g}", verb.discs);
  command += fmt::format(" --seed {} --threads {} --budget {:g} --rounds {}", verb.options.seed, thread_count(),
                         verb.options.budget, verb.options.least_rounds);
  if (verb.accuracy) command += fmt::format(" --accuracy {:g}", *verb.accuracy);
  return command;
}

/// Round 0 gives the values, later ones the times.
struct SampleRow {
  std::int64_t setting = 0, round = 0;
  const TaskSamples* task = nullptr;
};

/// One row per timing: setting (its number), round (0: the values, not timed), seconds, processor_seconds, one column
/// per quantity (round 0 only), refusal, study.
/// \param identity checksum of study, machine and build
Table samples_table(const Study& study, const StudySamples& samples, const std::string& identity) {
  std::vector<SampleRow> rows;
  for (std::size_t k = 0; k < samples.tasks.size(); ++k) {
    const TaskSamples& task = samples.tasks[k];
    for (std::int64_t round = 0; task.tried() && round <= std::ssize(task.times); ++round)
      rows.push_back({static_cast<std::int64_t>(k), round, &task});
  }
  Table table;
  table.add("setting", rows, &SampleRow::setting).add("round", rows, &SampleRow::round);
  const auto add_time = [&](const char* name, double TimeSample::*time) {
    table.add(name, rows, [&](const SampleRow& row) {
      return row.round == 0 ? std::nullopt
                            : std::optional(row.task->times[static_cast<std::size_t>(row.round - 1)].*time);
    });
  };
  add_time("seconds", &TimeSample::seconds);
  add_time("processor_seconds", &TimeSample::processor_seconds);
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    table.add(study.quantities[q].name, rows, [q](const SampleRow& row) {
      return row.round == 0 && !row.task->values.empty() ? std::optional(row.task->values[q]) : std::nullopt;
    });
  }
  table.add("refusal", rows, [](const SampleRow& row) { return row.round == 0 ? row.task->refusal : std::string(); });
  return table.add("study", rows, [&](const SampleRow&) { return identity; });
}

/// Reads a table of samples_table; numbers have the same bits.
/// \throws Error (bad_input) where the file is another table, damaged, or of another study, machine or build
StudySamples read_samples(const std::filesystem::path& path, const Study& study, const std::string& identity) {
  const StoredTable table(path, samples_table(study, {}, identity), "study",
                          "Choose another --out, or pass --overwrite to begin anew");
  StudySamples samples;
  samples.tasks.resize(study.tasks.size());
  const std::size_t first = 4, refusal = first + study.quantities.size();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.text(row, refusal + 1) != identity)
      table.refuse("they are of another study: settings, quantities, seed, machine or build differ");
    TaskSamples& task =
        samples.tasks[static_cast<std::size_t>(table.integer(row, 0, 0, std::ssize(samples.tasks) - 1))];
    if (table.integer(row, 1) > 0) {
      task.times.push_back({table.number(row, 2), table.number(row, 3)});
      continue;
    }
    task.refusal = table.text(row, refusal);
    for (std::size_t column = first; task.refusal.empty() && column < refusal; ++column)
      task.values.push_back(table.number(row, column));
  }
  return samples;
}

/// Measurements that an earlier run left; none where it begins anew.
StudySamples samples_to_keep(const StudyVerb& verb, const Study& study, const std::string& identity) {
  if (!verb.common.out || verb.common.overwrite) return {};
  const auto table = *verb.common.out / "samples.csv";
  if (!std::filesystem::exists(table)) return {};
  return read_samples(table, study, identity);
}

/// Files of an earlier run of the same study are replaced; those of anything else are not.
void check_outputs(const StudyVerb& verb, const Study& study, bool continues) {
  OutputPlan(verb.common).expect_json();
  CommonOptions common = verb.common;
  common.overwrite = common.overwrite || continues;
  const OutputPlan plan(common);
  for (const char* name : {"samples.csv", "study.csv", "result.json", page_name}) plan.expect(name);
  for (const std::string& name : study_plot_names(study)) plan.expect_plot(name);
}

void check(const StudyVerb& verb) {
  if (verb.accuracy && !(*verb.accuracy > 0))
    bad_input(fmt::format("the accuracy {:g} is not positive", *verb.accuracy), "no computation is without error",
              "Give a positive number, such as 1e-3");
  if ((verb.quick || verb.discs > 0) && is_file(verb.what))
    bad_input(fmt::format("{} does not belong to a study file", verb.quick ? "--quick" : "--discs"),
              "it would change nothing", "Leave it out, or vary other values");
  if (verb.quick && verb.discs > 0)
    bad_input("--quick and --discs exclude each other", "both choose the sizes", "Leave out one of them");
}

void refuse_all_failed(const StudyReport& report) {
  for (const StudyRow& row : report.result.rows) {
    if (row.refusal.empty()) return;
  }
  computation_failed("none of the settings could be computed",
                     "the first: " + without_full_stop(report.result.rows.front().refusal), "");
}

[[noreturn]] void refuse_without_errors() {
  computation_failed("this study has no errors", "it measures time alone", "Leave out --accuracy");
}

/// The accuracy is asked of each problem.
void refuse_unreached(const StudyReport& report) {
  for (const Recommendation& one : report.recommendations) {
    if (one.row) continue;
    computation_failed(fmt::format("no setting reaches {:g}{}", *report.accuracy,
                                   one.problem.empty() ? "" : fmt::format(" for {}", one.problem)),
                       fmt::format("the best one reaches {:.2g}", one.best), "Ask for less, or study finer settings");
  }
  if (report.recommendations.empty()) refuse_without_errors();
}

int dry_run_study(const StudyVerb& verb, const Study& study) {
  Results results;
  results.set("study", study.name).set("title", study.title).block(study.title + "\n\n");
  results.line("settings").add("number_of_settings", "", study.tasks.size());
  results.line("rounds", fmt::format("{} and one to warm up; then more, until all medians are trusted to {:g} % or "
                                     "--budget {:g} s is spent",
                                     verb.options.least_rounds, 100 * verb.options.time_error, verb.options.budget));
  deliver(verb.common, "dry_run", results, {});
  return 0;
}

int run_verb(const StudyVerb& verb) {
  if (verb.list) {
    print(list_of_studies());
    return 0;
  }
  check(verb);
  const Stopwatch watch;
  set_thread_count(verb.common.threads > 0 ? verb.common.threads : 1);
  set_progress_shown(!verb.common.quiet);
  const Study study =
      is_file(verb.what) ? study_of_file(verb.what, verb.common) : built_in_study(verb.what, verb.quick, verb.discs);
  if (verb.accuracy && std::ranges::all_of(study.quantities, &Quantity::fact)) refuse_without_errors();
  if (verb.common.dry_run) return dry_run_study(verb, study);
  const Machine machine = this_machine();
  const std::string identity =
      study.checksum(fmt::format("{} seed {} threads {}", machine.text(), verb.options.seed, thread_count()));
  const auto lock = lock_out(verb.common);
  StudySamples kept = samples_to_keep(verb, study, identity);
  const bool continues = !kept.tasks.empty();
  check_outputs(verb, study, continues);
  const auto& folder = verb.common.out;
  Stopwatch since_saved;
  const auto save = [&](const StudySamples& done) {
    write_samples(*folder / "samples.csv", samples_table(study, done, identity));
  };
  SavedOnTheWay saved(verb.common);
  const StudySamples samples = run_study(study, verb.options, std::move(kept), [&](const StudySamples& done) {
    if (!folder || since_saved.seconds() < 1) return;
    saved([&] { save(done); });
    since_saved.lap();
  });

  StudyReport report{.study = study,
                     .result = evaluate(study, samples),
                     .options = verb.options,
                     .machine = machine,
                     .command = command_of(verb),
                     .checksum = identity,
                     .accuracy = verb.accuracy,
                     .recommendations = {}};
  if (verb.accuracy) report.recommendations = recommend(study, report.result, *verb.accuracy);
  Results results = study_results(report);
  if (samples.stopped)
    results.block(fmt::format("INCOMPLETE: stopped after {} of all settings\n", counted(samples.rounds(), "round")));
  StageTimes times;
  times.add("study", watch.seconds());
  const auto plots = study_plots(report);
  const auto draw = [](const std::filesystem::path& into, const auto& named, bool overwrite) {
    write_plot(into, named.first, named.second, overwrite);
  };
  std::vector<OutputPart> parts;
  if (folder) {
    parts.push_back({"samples.csv", [&] { save(samples); }});
    parts.push_back({"study.csv", [&] { write_csv(*folder / "study.csv", study_table(report), true); }});
    for (const auto& plot : plots) parts.push_back({plot.first, [&] { draw(*folder, plot, true); }});
  }
  deliver(verb.common, report.result.complete ? "done" : "interrupted", std::move(results), std::move(times), parts);
  hand_over([plots, draw](const CommonOptions& into) {
    for (const auto& plot : plots) draw(*into.out, plot, into.overwrite);
  });
  if (samples.stopped) {
    throw_stopped(verb.common, fmt::format("{} of all settings are done", counted(samples.rounds(), "round")),
                  "Run the same command to go on");
  }
  refuse_all_failed(report);
  if (verb.accuracy) refuse_unreached(report);
  return 0;
}

}  // namespace

Run declare_study(CLI::App& command) {
  const auto verb = std::make_shared<StudyVerb>();
  command.add_option("STUDY", verb->what, "a built-in study, or a study file (.toml)")->type_name("NAME|FILE");
  add_result_options(command, verb->common);
  command.add_flag("--dry-run", verb->common.dry_run, "say how long the study takes, from some of its settings");
  command.get_option("--threads")->description("threads; left out: one, so that times are those of one processor");
  command.add_flag("--list", verb->list, "list the built-in studies");
  command.add_flag("--quick", verb->quick, "built-in studies: fewer and smaller settings");
  command.add_option("--discs", verb->discs, "study 'solvers': discs of the largest block; left out: 1e5")
      ->check(number(1e3, 1e7))
      ->type_name("N");
  command.add_option("--accuracy", verb->accuracy, "name the cheapest setting whose errors are at most X")
      ->check(finite_number())
      ->type_name("X");
  command
      .add_option("--budget", verb->options.budget,
                  "seconds after which no round begins, once there are --rounds of them")
      ->capture_default_str()
      ->check(number(0, 1e7))
      ->type_name("S");
  command.add_option("--rounds", verb->options.least_rounds, "rounds at least")
      ->capture_default_str()
      ->check(whole_number(3, 100))
      ->type_name("N");
  command.add_option("--seed", verb->options.seed, "of the order in which settings are timed")
      ->capture_default_str()
      ->check(whole_number(0))
      ->type_name("S");
  command.footer(list_of_studies() +
                 "\nExamples:\n"
                 "  equidem study integrators --out figures\n"
                 "  equidem study collision_laws --quick --accuracy 0.01\n"
                 "  equidem study solvers --discs 1e6 --out figures\n"
                 "  equidem study data/cases/study_tension.toml --out figures\n"
                 "Ctrl-C keeps what is done; the same command with the same --out goes on from there.");
  return [verb] {
    if (verb->what.empty() && !verb->list)
      bad_input("it is not said what to study", "a study has a name or a file",
                "'equidem study --list' shows the built-in ones");
    return run_verb(*verb);
  };
}

}  // namespace equidem
