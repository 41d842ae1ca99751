// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem study: error against time.
#include "equidem/study/study.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/casefile/study/study_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/study/evaluate.hpp"

#include "command.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct StudyVerb : CommonOptions {
  std::string file;
  StudyOptions options;
  std::optional<double> accuracy;
};

/// The command that repeats the study.
std::string command_of(const StudyVerb& verb) {
  std::string command = fmt::format("equidem study {} --seed {} --threads {} --budget {:g} --rounds {}", verb.file,
                                    verb.options.seed, thread_count(), verb.options.budget, verb.options.least_rounds);
  if (verb.accuracy) command += fmt::format(" --accuracy {:g}", *verb.accuracy);
  return command;
}

/// A study, its result and how it was run.
struct StudyReport {
  const StudyVerb& verb;
  const Study& study;
  std::string checksum;  ///< of its settings on this machine and build
  StudyResult result = {};
  std::optional<Recommendation> recommendation = {};  ///< set if an accuracy is requested
};

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-";
}

std::vector<Results> table_of(const StudyReport& report) {
  std::vector<Results> rows;
  for (std::size_t k = 0; k < report.result.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[k];
    const Timing& time = row.time;
    const bool on_front = std::ranges::find(report.result.front, k) != report.result.front.end();
    Results& line = rows.emplace_back();
    line.add("", "  setting", (on_front ? "* " : "  ") + row.setting.label());
    if (!row.refusal.empty() || time.repetitions == 0) {
      line.note(row.refusal.empty() ? "not timed" : row.refusal);
      continue;
    }
    line.add("", "time", readable_seconds(time.median))
        .add("", "spread", (time.upper_quartile - time.lower_quartile) / time.median, "", {Shown::percent, 2})
        .add("", "n", time.repetitions)
        .add("", "err " + report.study.quantity, cell(row.error));
  }
  return rows;
}

Results row_results(const StudyReport& report, const StudyRow& row) {
  const std::string& quantity = report.study.quantity;
  Results setting;
  for (const auto& [name, value] : row.setting.values) setting.set(name, value);
  Results out;
  out.set("method", row.setting.method).set("setting", setting).set("resolution", row.setting.resolution);
  out.set("seconds/median", row.time.median)
      .set("seconds/lower_quartile", row.time.lower_quartile)
      .set("seconds/upper_quartile", row.time.upper_quartile)
      .set("seconds/processor_median", row.time.processor_median)
      .set("seconds/processor_lower_quartile", row.time.processor_lower_quartile)
      .set("seconds/processor_upper_quartile", row.time.processor_upper_quartile)
      .set("seconds/repetitions", row.time.repetitions);
  if (!row.refusal.empty()) return out.set("refusal", row.refusal);
  Results values, errors, assured;
  if (row.value) values.set(quantity, *row.value), errors.set(quantity, row.error), assured.set(quantity, row.assured);
  return out.set("values", values).set("errors", errors).set("assured_errors", assured);
}

Results curve_results(const StudyReport& report, const StudyCurve& curve) {
  const std::string& quantity = report.study.quantity;
  Results out;
  out.set("method", curve.method).set("quantity", quantity);
  out.set("observed_order", nullptr).set("theoretical_order", nullptr).set("cost_exponent", curve.cost_exponent);
  if (curve.expected) out.set("theoretical_order", *curve.expected).set("agrees", curve.agrees);
  if (!curve.order) return out;
  const ObservedOrder& order = *curve.order;
  out.set("observed_order", order.order).set("uncertainty", order.uncertainty).set("levels", order.levels);
  out.set("range", std::vector{order.coarsest, order.finest});
  std::string text = fmt::format(
      "  {}{}: order {:.3f}{} over {} levels", curve.method.empty() ? "" : curve.method + ", ", quantity, order.order,
      std::isfinite(order.uncertainty) ? fmt::format(" ± {:.2g}", order.uncertainty) : "", order.levels);
  if (curve.expected) text += fmt::format("; theory {:g}, {}", *curve.expected, curve.agrees ? "agrees" : "DIFFERS");
  return out.block(text + fmt::format("; time as h^{:.2f}\n", -curve.cost_exponent));
}

Results quantity_results(const Study& study) {
  Results out;
  out.set("name", study.quantity).set("label", study.label).set("relative", study.relative);
  out.set("truth", to_string(study.truth)).set("source", study.source);
  if (study.truth == Truth::known) out.set("true_value", study.true_value);
  return out.line("measured", study.label + "; truth: " + study.source);
}

/// An empty series of the k-th method: a line where it has several points.
Series series_of(std::size_t k, std::size_t points) {
  using enum PlotColour;
  struct Look {
    PlotColour colour;
    Marker marker;
    bool filled;
  };
  constexpr Look looks[] = {{blue, Marker::circle, true},     {vermilion, Marker::square, true},
                            {green, Marker::triangle, true},  {orange, Marker::diamond, true},
                            {purple, Marker::circle, false},  {sky_blue, Marker::square, false},
                            {black, Marker::triangle, false}, {black, Marker::diamond, true}};
  const Look& look = looks[k % std::size(looks)];
  return {.style = points > 1 ? SeriesStyle::line_with_points : SeriesStyle::points,
          .colour = look.colour,
          .marker = look.marker,
          .filled = look.filled};
}

/// "leapfrog, order 1.98 (theory 2)".
std::string legend_of(const StudyReport& report, const std::string& method) {
  std::string order;
  for (const StudyCurve& curve : report.result.curves) {
    if (curve.method != method || !curve.order) continue;
    order = fmt::format("order {:.2f}{}", curve.order->order,
                        curve.expected ? fmt::format(" (theory {:.3g})", *curve.expected) : "");
  }
  if (method.empty()) return order.empty() ? "measured" : order;
  return literal(order.empty() ? method : method + ", " + order);
}

/// The rows that were timed, method by method in the order of the study.
using MethodRows = std::pair<std::string, std::vector<std::size_t>>;
std::vector<MethodRows> by_method(const StudyReport& report) {
  std::vector<MethodRows> methods;
  for (std::size_t k = 0; k < report.result.rows.size(); ++k) {
    const StudyRow& row = report.result.rows[k];
    if (row.time.repetitions == 0) continue;
    auto at = std::ranges::find(methods, row.setting.method, &MethodRows::first);
    if (at == methods.end()) at = methods.insert(at, {row.setting.method, {}});
    at->second.push_back(k);
  }
  return methods;
}

Results study_results(const StudyReport& report) {
  const Study& study = report.study;
  const StudyResult& result = report.result;
  const StudyOptions& options = report.verb.options;
  Results out;
  out.set("study", study.name).set("title", study.title).set("complete", result.complete);
  out.set("command", command_of(report.verb)).set("machine", machine_results());
  out.set("seed", options.seed).set("rounds", result.rounds).set("budget", options.budget);
  out.set("checksum", report.checksum).block(study.title + "\n\n");
  std::vector<Results> settings, curves, fronts, recommendations;
  for (const StudyRow& row : result.rows) settings.push_back(row_results(report, row));
  for (const StudyCurve& curve : result.curves) curves.push_back(curve_results(report, curve));
  std::vector<std::string> labels;
  for (const std::size_t row : result.front) labels.push_back(result.rows[row].setting.label());
  if (!labels.empty()) fronts.push_back(Results().set("quantity", study.quantity).set("settings", labels));
  if (report.recommendation) {
    const Recommendation& one = *report.recommendation;
    Results& told = recommendations.emplace_back();
    told.set("text", one.text).set("best_error", one.best).block(one.text + "\n").set("setting", nullptr);
    if (one.row) told.set("setting", row_results(report, result.rows[*one.row]));
  }

  out.list("quantities", {quantity_results(study)}).line("machine", machine_text());
  out.line("timing", fmt::format("{} after one to warm up, all settings in an order drawn anew each time (seed {}); "
                                 "median, quartiles apart, number n",
                                 counted(result.rounds, "round"), options.seed));
  out.block("\n").table("", table_of(report));
  if (!fronts.empty()) out.block("\n* on a front: nothing is both faster and as accurate\n");
  if (std::ranges::any_of(result.curves, [](const StudyCurve& curve) { return curve.order.has_value(); }))
    out.block("\norders, errors as h^p over the finest levels (95 % interval)\n");
  out.list("orders", std::move(curves));
  out.block("\n" + (result.advice.empty() ? "" : result.advice + "\n"));
  if (report.verb.accuracy)
    out.set("accuracy", *report.verb.accuracy).list("recommendations", std::move(recommendations));
  for (const std::string& note : study.notes) out.block(note + "\n");
  out.set("settings", settings).set("fronts", fronts);
  return out.set("advice", result.advice).set("notes", study.notes);
}

Table study_table(const StudyReport& report) {
  const auto& rows = report.result.rows;
  const std::string& quantity = report.study.quantity;
  Table table;
  table.add("method", rows, [](const StudyRow& r) { return r.setting.method; });
  table.add("setting", rows, [](const StudyRow& r) { return r.setting.label(); });
  table.add("resolution", rows, [](const StudyRow& r) { return r.setting.resolution; });
  table.add("median_s", rows, [](const StudyRow& r) { return r.time.median; });
  table.add("lower_quartile_s", rows, [](const StudyRow& r) { return r.time.lower_quartile; });
  table.add("upper_quartile_s", rows, [](const StudyRow& r) { return r.time.upper_quartile; });
  table.add("processor_median_s", rows, [](const StudyRow& r) { return r.time.processor_median; });
  table.add("repetitions", rows, [](const StudyRow& r) { return static_cast<double>(r.time.repetitions); });
  table.add(quantity, rows, [](const StudyRow& r) { return r.value.value_or(NAN); });
  table.add(quantity + "_error", rows, &StudyRow::error);
  table.add(quantity + "_assured_error", rows, &StudyRow::assured);
  return table.add("refusal", rows, &StudyRow::refusal);
}

Plot study_plot(const StudyReport& report) {
  Plot plot{.title = with_symbols(report.study.title),
            .x = {.label = "time of computing, s", .logarithmic = true},
            .y = {.label = with_symbols(report.study.label), .logarithmic = true},
            .enhanced = true};
  Series line{.label = "front", .style = SeriesStyle::dashed_line, .colour = PlotColour::black, .column = "front"};
  for (const std::size_t k : report.result.front) {
    const StudyRow& row = report.result.rows[k];
    if (!line.x.empty()) {  // until here nothing is better than the one before
      line.add(row.time.median, line.y.back());
    }
    line.add(row.time.median, row.assured);
  }
  if (!line.x.empty()) plot.series.push_back(std::move(line));
  std::size_t count = 0;
  for (const auto& [method, rows] : by_method(report)) {
    Series series = series_of(count++, rows.size());
    series.label = legend_of(report, method);
    series.column = method.empty() ? "error" : method;
    for (const std::size_t k : rows) {
      const StudyRow& row = report.result.rows[k];
      if (!std::isfinite(row.error)) continue;
      series.add(row.time.median, row.error);
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

std::string study_plot_name(const Study& study) {
  return study.name + "_" + study.quantity;
}

double measured_number(const Delivery& result, const std::string& measure) {
  const auto number = number_in_json(result.results.json(), measure);
  if (!number)
    bad_input(fmt::format("the result has no number '{}'", measure), "study.measure names one of its keys",
              "'equidem VERB CASE.toml --json -' shows them");
  return *number;
}

/// The study file, the case and the files that it reads decide the values of a study.
std::string inputs_of_study(StudyVerb verb) {
  const std::filesystem::path path = verb.file;
  const StudyCase resolved = read_study_case(path);
  verb.verb = resolved.verb;
  verb.case_file = resolved.case_file;
  std::string text = to_toml(resolved.document, path.parent_path());
  for (const StudyPoint& point : points_of(resolved)) {
    verb.set = point.overrides;
    const auto refused = failure_of([&] {
      const TomlValue document = read_document(resolved.verb, verb).document;
      text += to_toml(document, path.parent_path()) + note_of_files(document);
    });
    if (refused) text += refused->what();
  }
  return text;
}

/// Each setting is a run of a verb, in this process; on a dry run a dry run of it, whose memory is measured.
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
  std::vector<std::string> given(options.quiet ? 1 : 0, "--quiet");
  if (options.dry_run) given.emplace_back("--dry-run");
  const std::string measure = options.dry_run ? "peak_bytes" : resolved.measure;
  for (const StudyPoint& point : points_of(resolved)) {
    study.tasks.push_back({point.setting, [resolved, point, given, measure] {
                             const auto run =
                                 std::make_shared<VerbRun>(resolved.verb, resolved.case_file, point.overrides, given);
                             const auto result = std::make_shared<Delivery>();
                             return Trial{.work = [=] { *result = (*run)(); },
                                          .value = [=] { return measured_number(*result, measure); }};
                           }});
  }
  study.notes = {"Times are of the whole verb without its report and files: reading the case, and computing."};
  return study;
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
  if (!verb.out || verb.overwrite) return {};
  const auto table = *verb.out / "samples.csv";
  if (!std::filesystem::exists(table)) return {};
  return read_samples(table, study, identity);
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
  if (std::ranges::any_of(report.result.rows, [](const StudyRow& row) { return row.refusal.empty(); })) return;
  computation_failed("none of the settings could be computed",
                     "the first: " + without_full_stop(report.result.rows.front().refusal), "");
}

void refuse_unreached(const StudyReport& report) {
  if (!report.recommendation)
    computation_failed("this study has no errors", "no setting has a reference value", "Leave out --accuracy");
  if (report.recommendation->row) return;
  computation_failed(fmt::format("no setting reaches {:g}", *report.verb.accuracy),
                     fmt::format("the best one reaches {:.2g}", report.recommendation->best),
                     "Ask for less, or study finer settings");
}

void dry_run_study(const StudyVerb& verb, const Study& study) {
  Results results;
  results.set("study", study.name).set("title", study.title).block(study.title + "\n\n");
  results.line("settings").add("number_of_settings", "", study.tasks.size());
  results.line("rounds", fmt::format("{} and one to warm up; then more, until all medians are trusted to {:g} % or "
                                     "--budget {:g} s is spent",
                                     verb.options.least_rounds, 100 * verb.options.time_error, verb.options.budget));
  double most = 0;
  for (const StudyTask& task : study.tasks) {
    const auto refused = failure_of([&] {
      const Trial trial = task.prepare();
      trial.work();
      most = std::max(most, trial.value());
    });
    if (refused && refused->kind() == ErrorKind::interrupted) throw Error(*refused);
  }
  if (most > 0) results.line("memory").add("peak_bytes", "", most, "at the peak", {Shown::bytes});
  deliver(verb, "dry_run", results, {});
}

void run_verb(const StudyVerb& verb) {
  check(verb);
  const Stopwatch watch;
  set_thread_count(verb.threads > 0 ? verb.threads : 1);
  set_progress_shown(!verb.quiet);
  const Study study = study_of_file(verb.file, verb);
  if (verb.dry_run) return dry_run_study(verb, study);
  const std::string identity = study.checksum(fmt::format("{} seed {} threads {} {}", machine_text(), verb.options.seed,
                                                          thread_count(), inputs_of_study(verb)));
  const auto lock = lock_out(verb);
  StudySamples kept = samples_to_keep(verb, study, identity);
  const auto& folder = verb.out;
  Stopwatch since_saved;
  const auto save = [&](const StudySamples& done) {
    write_samples(*folder / "samples.csv", samples_table(study, done, identity));
  };
  StudySamples samples;
  StudyReport report{verb, study, identity};
  const auto plot = std::make_shared<Plot>();
  const auto draw = [name = study_plot_name(study), plot](const CommonOptions& into) {
    if (!plot->series.empty()) write_plot(*into.out, name, *plot, true);
  };
  const auto write = [&](const CommonOptions& into) { write_csv(*into.out / "study.csv", study_table(report), true); };
  const std::vector<OutputPart> parts{
      {"samples.csv", [&](const CommonOptions& /*into*/) { save(samples); }, OutputPart::folder, {"samples.csv"}},
      {"study.csv", write, OutputPart::folder, {"study.csv"}},
      {study_plot_name(study), draw, OutputPart::page, plot_files(study_plot_name(study))}};
  // Files of an earlier run of the same study are replaced; those of anything else are not.
  expect_results(verb, parts, !kept.tasks.empty());
  SavedOnTheWay saved(verb);
  samples = run_study(study, verb.options, std::move(kept), [&](const StudySamples& done) {
    if (!folder || since_saved.seconds() < 1) return;
    saved([&] { save(done); });
    since_saved.lap();
  });

  report.result = evaluate(study, samples);
  if (verb.accuracy) report.recommendation = recommend(report.result, *verb.accuracy);
  Results results = study_results(report);
  if (samples.stopped)
    results.block(fmt::format("INCOMPLETE: stopped after {} of all settings\n", counted(samples.rounds(), "round")))
        .warn();
  StageTimes times;
  times.add("study", watch.seconds());
  *plot = study_plot(report);
  deliver(verb, report.result.complete ? "done" : "interrupted", std::move(results), std::move(times), parts);
  if (samples.stopped) {
    throw_stopped(verb, fmt::format("{} of all settings are done", counted(samples.rounds(), "round")),
                  "Run the same command to go on");
  }
  refuse_all_failed(report);
  if (verb.accuracy) refuse_unreached(report);
}

}  // namespace

Run declare_study(CLI::App& command) {
  const auto verb = std::make_shared<StudyVerb>();
  command.add_option("STUDY", verb->file, "the study file (.toml)")->type_name("FILE");
  add_result_options(command, *verb);
  command.add_flag("--dry-run", verb->dry_run, "say how many settings the study has");
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
  return [verb] { return run_verb(*verb); };
}

}  // namespace equidem
