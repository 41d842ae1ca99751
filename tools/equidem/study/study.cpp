// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem study: error against time.
#include "equidem/study/study.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/casefile/study/study_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/page/page.hpp"

#include "command.hpp"
#include "option_checks.hpp"
#include "study/study_results.hpp"
#include "verb_run.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct StudyVerb {
  CommonOptions common;
  std::string file;
  StudyOptions options;
  std::optional<double> accuracy;
};

/// The number that a study measures.
double measured_number(const Delivery& result, const std::string& measure) {
  const auto number = number_in_json(result.results.json(), measure);
  if (!number)
    bad_input(fmt::format("the result has no number '{}'", measure), "study.measure names one of its keys",
              "'equidem VERB CASE.toml --json -' shows them");
  return *number;
}

/// Each setting is a run of a verb, in this process.
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
      .quantity = label,
      .label = fmt::format("{}error of {}", resolved.relative ? "relative " : "", resolved.measure),
      .source = resolved.truth == Truth::known    ? "the value of the study file"
                : resolved.truth == Truth::finest ? "the finest level, whose own error is not known"
                                                  : "Richardson's limit of the two finest levels",
      .relative = resolved.relative,
      .truth = resolved.truth,
      .true_value = resolved.value};
  for (const StudyPoint& point : points_of(resolved)) {
    study.tasks.push_back({point.setting, [resolved, point, quiet = options.quiet] {
                             const std::vector<std::string> option(quiet ? 1 : 0, "--quiet");
                             const auto run =
                                 std::make_shared<VerbRun>(resolved.verb, resolved.case_file, point.overrides, option);
                             const auto result = std::make_shared<Delivery>();
                             return Trial{.work = [=] { *result = (*run)(); },
                                          .value = [=] { return measured_number(*result, resolved.measure); }};
                           }});
  }
  study.notes = {"Times are of the whole verb without its report and files: reading the case, and computing."};
  return study;
}

std::string command_of(const StudyVerb& verb) {
  std::string command = fmt::format("equidem study {} --seed {} --threads {} --budget {:g} --rounds {}", verb.file,
                                    verb.options.seed, thread_count(), verb.options.budget, verb.options.least_rounds);
  if (verb.accuracy) command += fmt::format(" --accuracy {:g}", *verb.accuracy);
  return command;
}

/// Round 0 gives the value, later ones the times.
struct SampleRow {
  std::int64_t setting = 0, round = 0;
  const TaskSamples* task = nullptr;
};

/// One row per timing: setting (its number), round (0: the value, not timed), seconds, processor_seconds, the quantity
/// (round 0 only), refusal, study.
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
  table.add(study.quantity, rows,
            [](const SampleRow& row) { return row.round == 0 ? row.task->value : std::optional<double>(); });
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
  constexpr std::size_t value = 4, refusal = 5;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.text(row, refusal + 1) != identity)
      table.refuse("they are of another study: settings, quantity, seed, machine or build differ");
    TaskSamples& task =
        samples.tasks[static_cast<std::size_t>(table.integer(row, 0, 0, std::ssize(samples.tasks) - 1))];
    if (table.integer(row, 1) > 0) {
      task.times.push_back({table.number(row, 2), table.number(row, 3)});
      continue;
    }
    task.refusal = table.text(row, refusal);
    if (task.refusal.empty()) task.value = table.number(row, value);
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
  plan.expect_plot(study_plot_name(study));
}

void check(const StudyVerb& verb) {
  if (verb.file.empty())
    bad_input("it is not said what to study", "a study is a file (.toml)",
              "Give one, such as data/studies/integrators.toml; 'equidem help case' has its keys");
  if (!verb.file.ends_with(".toml")) {
    constexpr std::array files = {"abe_lattice", "integrators", "settled_void_ratio"};
    const bool is_file = std::ranges::find(files, verb.file) != files.end();
    bad_input(fmt::format("the study '{}' is no file (.toml)", verb.file), "studies are files",
              is_file ? fmt::format("Write 'equidem study data/studies/{}.toml'", verb.file)
                      : "Give one, such as data/studies/integrators.toml");
  }
  if (verb.accuracy && !(*verb.accuracy > 0))
    bad_input(fmt::format("the accuracy {:g} is not positive", *verb.accuracy), "no computation is without error",
              "Give a positive number, such as 1e-3");
}

void refuse_all_failed(const StudyReport& report) {
  for (const StudyRow& row : report.result.rows) {
    if (row.refusal.empty()) return;
  }
  computation_failed("none of the settings could be computed",
                     "the first: " + without_full_stop(report.result.rows.front().refusal), "");
}

void refuse_unreached(const StudyReport& report) {
  if (!report.recommendation)
    computation_failed("this study has no errors", "no setting has a reference value", "Leave out --accuracy");
  if (report.recommendation->row) return;
  computation_failed(fmt::format("no setting reaches {:g}", *report.accuracy),
                     fmt::format("the best one reaches {:.2g}", report.recommendation->best),
                     "Ask for less, or study finer settings");
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
  check(verb);
  const Stopwatch watch;
  set_thread_count(verb.common.threads > 0 ? verb.common.threads : 1);
  set_progress_shown(!verb.common.quiet);
  const Study study = study_of_file(verb.file, verb.common);
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
                     .recommendation = {}};
  if (verb.accuracy) report.recommendation = recommend(report.result, *verb.accuracy);
  Results results = study_results(report);
  if (samples.stopped)
    results.block(fmt::format("INCOMPLETE: stopped after {} of all settings\n", counted(samples.rounds(), "round")));
  StageTimes times;
  times.add("study", watch.seconds());
  const auto draw = [name = study_plot_name(study), plot = study_plot(report)](const std::filesystem::path& into,
                                                                               bool overwrite) {
    if (!plot.series.empty()) write_plot(into, name, plot, overwrite);
  };
  std::vector<OutputPart> parts;
  if (folder) {
    parts.push_back({"samples.csv", [&] { save(samples); }});
    parts.push_back({"study.csv", [&] { write_csv(*folder / "study.csv", study_table(report), true); }});
    parts.push_back({study_plot_name(study), [&] { draw(*folder, true); }});
  }
  deliver(verb.common, report.result.complete ? "done" : "interrupted", std::move(results), std::move(times), parts);
  hand_over([draw](const CommonOptions& into) { draw(*into.out, into.overwrite); });
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
  command.add_option("STUDY", verb->file, "the study file (.toml)")->type_name("FILE");
  add_result_options(command, verb->common);
  command.add_flag("--dry-run", verb->common.dry_run, "say how many settings the study has");
  command.get_option("--threads")->description("threads; left out: one, so that times are those of one processor");
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
  command.footer(
      "Examples:\n"
      "  equidem study data/studies/integrators.toml --out figures\n"
      "  equidem study data/studies/abe_lattice.toml --accuracy 0.01\n"
      "Ctrl-C keeps what is done; the same command with the same --out goes on from there.");
  return [verb] { return run_verb(*verb); };
}

}  // namespace equidem
