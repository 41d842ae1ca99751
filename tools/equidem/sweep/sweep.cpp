// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem sweep: a verb over values of keys and seeds.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/page/page.hpp"

#include "command.hpp"
#include "option_checks.hpp"
#include "sweep/sweep_run.hpp"
#include "sweep/sweep_table.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

/// First line of the case that is written, which tells sweeps by different verbs apart.
std::string heading_of(const Sweep& sweep) {
  return fmt::format("# The case of a sweep by 'equidem {}'; what is varied stands at its end.\n", sweep.plan.verb);
}

std::vector<std::string> swept_verbs() {
  std::vector<std::string> names;
  for (const Verb& verb : verbs)
    if (verb.swept) names.emplace_back(verb.name);
  return names;
}

void check_verb(const std::string& name) {
  const std::vector<std::string> names = swept_verbs();
  if (std::ranges::find(names, name) != names.end()) return;
  const bool exists = std::ranges::find(verbs, name, &Verb::name) != verbs.end();
  bad_input_at("--verb",
               exists ? fmt::format("a sweep cannot vary '{}'", name) : fmt::format("there is no verb '{}'", name),
               exists ? "it has no case, or no numbers that depend on its keys" : "a sweep varies the case of a verb",
               fmt::format("Give one of {}", joined(names)));
}

/// The case as the verb reads it.
/// \throws Error as the reader of the verb
CaseDocument read_base(const std::string& verb, const CommonOptions& options) {
  prepare(options);
  const std::vector<std::string> overrides = overrides_of(options);
  if (verb == "pack") return read_pack_case(options.case_file, overrides);
  if (verb == "run" && describes_grains(casefile::read_document(options.case_file, options.set))) {
    if (options.seed)
      bad_input_at("--seeds", "nothing in a case of grains is random", "all points would be equal", "Leave it out");
    return read_grain_case(options.case_file, options.set);
  }
  return read_case(options);
}

/// A key that no case has but whose last part is nearly "ratio".
void refuse_misspelt_ratio(const SweptKey& key) {
  const std::string last = key.name.substr(key.name.rfind('.') + 1);
  const std::vector<std::string> ratio{"ratio"};
  if (unit_of_case_key(key.name) || !nearest(last, ratio)) return;
  bad_input_at("--key", fmt::format("there is no key '{}'", key.name), "kT/kN at the kN of the case has the name ratio",
               "Write --key ratio");
}

/// The keys exist, and the case has a seed where seeds are given.
void check_keys(const SweepOptions& options, const SweepPlan& plan, const CaseDocument& base) {
  for (const SweptKey& key : plan.keys) {
    CommonOptions first = options.common;
    if (key.name != "ratio") refuse_misspelt_ratio(key);
    if (key.name == SweepPlan::seed) {
      first.seed = number_from<std::int64_t>(key.values.front());
    } else if (key.name == "ratio") {
      const TomlValue* const springs = base.document.find("springs");
      if (springs == nullptr || !springs->is_table() || springs->find("kN") == nullptr)
        bad_input("--key ratio needs springs", "it changes kT at the kN of the case file",
                  "Give [springs] in place of [material]");
      continue;
    } else if (unit_of_case_key(key.name)) {
      continue;
    } else {
      first.set.push_back(fmt::format("{}={}", key.name, key.values.front()));
    }
    static_cast<void>(read_base(plan.verb, first));
  }
}

/// "1, 2, 3", of many values the first ones and the last one.
std::string shortened(const std::vector<std::string>& values) {
  constexpr std::ptrdiff_t most = 20;
  if (std::ssize(values) <= most) return joined(values);
  return fmt::format("{}, ..., {} ({} values)", joined(std::vector(values.begin(), values.begin() + most)),
                     values.back(), values.size());
}

/// The case with what is varied as comments, which are no part of what has to agree for --resume.
std::string text_of_case(const Sweep& sweep) {
  const SweepPlan& plan = sweep.plan;
  std::string text = heading_of(sweep) + to_toml(sweep.base.document, *sweep.options.common.out);
  text += fmt::format("\n# Varied {}:\n", plan.side_by_side ? "side by side" : "in all combinations");
  for (const SweptKey& key : plan.keys) text += fmt::format("# {} = {}\n", key.name, shortened(key.values));
  return text;
}

/// Points of an earlier run of the same sweep.
std::vector<SweepPoint> points_to_keep(const Sweep& sweep) {
  const auto& out = sweep.options.common.out;
  if (!sweep.options.resume) return {};
  if (!out)
    bad_input("--resume has nothing to continue", "the points done lie in the folder of --out", "Add --out DIR");
  const auto table = *out / Sweep::table_name;
  if (!std::filesystem::exists(table)) return {};
  if (!read_file(*out / Sweep::case_name).starts_with(heading_of(sweep) + to_toml(sweep.base.document, *out))) {
    bad_input_at((*out / Sweep::case_name).string(), "the sweep there is of another case",
                 "its points would not fit together",
                 "Choose another --out, or leave out --resume and pass --overwrite");
  }
  return read_sweep_points(table, sweep.plan);
}

void check_outputs(const Sweep& sweep) {
  CommonOptions common = sweep.options.common;
  common.overwrite = common.overwrite || sweep.options.resume;
  const OutputPlan plan(common);
  for (const char* name : {Sweep::table_name, Sweep::case_name, "result.json", page_name}) plan.expect(name);
  for (const std::string& name : curve_names(sweep.plan)) plan.expect_plot(name);
  OutputPlan(sweep.options.common).expect_json();
}

/// None where one of them is no such number.
template <class Number>
std::optional<std::vector<Number>> all_numbers(const std::vector<std::string>& values) {
  std::vector<Number> numbers;
  for (const std::string& value : values) {
    const auto number = number_from<Number>(value);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

Results results_of_keys(const SweepPlan& plan) {
  std::vector<Results> keys;
  for (const SweptKey& key : plan.keys) {
    Results one;
    one.set("key", key.name).set("unit", key.unit);
    if (const auto whole = all_numbers<std::int64_t>(key.values)) {
      one.set("values", *whole, "", "values of the key, in its unit");
    } else if (const auto numbers = all_numbers<double>(key.values)) {
      one.set("values", *numbers, "", "values of the key, in its unit");
    } else {
      one.set("values", key.values);
    }
    keys.push_back(std::move(one));
  }
  return Results().set("verb", plan.verb).set("key", plan.keys.front().name).set("keys", keys);
}

/// Probes of a run that measure a standing wave.
std::vector<std::string> names_of_waves(const TomlValue& document) {
  std::vector<std::string> names;
  const TomlValue* const probes = document.find("probe");
  if (probes == nullptr || !probes->is_array()) return names;
  for (const TomlValue& probe : probes->items)
    if (const TomlValue* const name = probe.find("name"); name != nullptr && probe.find("wavelength") != nullptr)
      names.push_back(name->text);
  return names;
}

/// The number of points that failed, and why, below the table; points with the same reason together.
void add_failures(Results& results, std::span<const SweepPoint> points, std::size_t failed) {
  constexpr std::size_t most = 5, most_numbers = 10;
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const SweepPoint& point : points) {
    if (!point.failed()) continue;
    auto known = std::ranges::find(reasons, point.message, &std::pair<std::string, std::vector<std::string>>::first);
    if (known == reasons.end()) known = reasons.insert(reasons.end(), {point.message, {}});
    known->second.push_back(fmt::format("{}", point.number));
  }
  results.line("failed",
               fmt::format("{}; {} done", counted(static_cast<long long>(failed), "point"), points.size() - failed));
  for (std::size_t k = 0; k < std::min(reasons.size(), most); ++k) {
    auto& [reason, numbers] = reasons[k];
    const bool one = numbers.size() == 1, many = numbers.size() > most_numbers;
    if (many) numbers.resize(most_numbers);
    results.line("",
                 fmt::format("{} {}{}: {}", one ? "point" : "points", joined(numbers), many ? ", ..." : "", reason));
  }
  if (reasons.size() > most)
    results.line(
        "", fmt::format("{} other reasons are in the column message of {}", reasons.size() - most, Sweep::table_name));
}

int sweep(const SweepOptions& options) {
  check_verb(options.verb);
  if (options.common.seed && !options.seeds.empty())
    bad_input("--seed and --seeds exclude each other", "both say which seed a point has", "Leave one of them out");
  Sweep sweep{options, sweep_plan(options.verb, options.keys, options.seeds, options.side_by_side),
              read_base(options.verb, options.common)};
  sweep.plan.waves = names_of_waves(sweep.base.document);
  check_keys(options, sweep.plan, sweep.base);
  check_outputs(sweep);
  if (options.common.dry_run) return dry_run_sweep(sweep, results_of_keys(sweep.plan));
  const auto lock = lock_out(options.common);
  SweepRun run(sweep, points_to_keep(sweep));
  const auto& folder = options.common.out;
  if (folder) write_file(*folder / Sweep::case_name, text_of_case(sweep), true);
  run();

  const std::vector<SweepPoint> points = run.points();
  const auto failed = static_cast<std::size_t>(std::ranges::count_if(points, &SweepPoint::failed));
  const bool all_failed = failed == points.size();
  Results results;
  if (!sweep.base.title.empty()) results.block(sweep.base.title + "\n\n");
  results.set("title", sweep.base.title).append(results_of_keys(sweep.plan)).set("complete", !run.stopped());
  results.table("points", sweep_rows(sweep.plan, points));
  if (failed > 0) add_failures(results, points, failed);
  if (run.stopped())
    results.block(fmt::format("INCOMPLETE: stopped after {} of {} points\n", run.done(), sweep.plan.size()));
  StageTimes times;
  times.add("points", run.seconds());
  std::vector<OutputPart> parts;
  if (folder) parts.push_back({Sweep::table_name, [&] { run.save(); }});
  if (folder && !run.stopped())
    parts.push_back(
        {"the curves", [&] { write_curves(*folder, sweep.plan, points, options.title.value_or(sweep.base.title)); }});
  deliver(options.common,
          run.stopped() ? "interrupted"
          : all_failed  ? "failed"
                        : "done",
          std::move(results), std::move(times), parts);
  if (run.stopped()) {
    throw_stopped(options.common, fmt::format("{} of {} points are done", run.done(), sweep.plan.size()),
                  "Run the same command with --resume to do the rest");
  }
  if (all_failed)
    computation_failed("none of the points could be computed",
                       "the first: " + without_full_stop(points.front().message), "");
  return 0;
}

/// The key that an option belongs to: the last one given before it, or the first one where none is.
KeyOptions& current_key(SweepOptions& options) {
  return options.keys.empty() ? options.keys.emplace_back() : options.keys.back();
}

void name_key(SweepOptions& options, const std::string& name) {
  const bool unnamed = options.keys.size() == 1 && options.keys.front().name.empty();
  (unnamed ? options.keys.front() : options.keys.emplace_back()).name = name;
}

/// Options that may be repeated, those of each key after it.
void add_key_options(CLI::App& command, const std::shared_ptr<SweepOptions>& options) {
  command
      .add_option_function<std::string>(
          "--key", [options](const std::string& name) { name_key(*options, name); },
          "a key to vary, such as springs.kT or assembly.rows; ratio: kT/kN.\nSeveral, each followed by its values: "
          "all "
          "combinations")
      ->trigger_on_parse()
      ->type_name("KEY");
  command
      .add_option_function<double>(
          "--from", [options](double from) { current_key(*options).from = from; }, "first value")
      ->trigger_on_parse()
      ->check(finite_number())
      ->type_name("A");
  command
      .add_option_function<double>(
          "--to", [options](double to) { current_key(*options).to = to; }, "last value")
      ->trigger_on_parse()
      ->check(finite_number())
      ->type_name("B");
  command
      .add_option_function<int>(
          "--steps", [options](int steps) { current_key(*options).steps = steps; },
          "number of values from A to B; 11 where left out")
      ->trigger_on_parse()
      ->check(whole_number(1, 1000000))
      ->type_name("N");
  command
      .add_option_function<std::vector<std::string>>(
          "--values",
          [options](const std::vector<std::string>& lists) {
            std::vector<std::string>& values = current_key(*options).values;
            values.insert(values.end(), lists.begin(), lists.end());
          },
          "the values themselves: numbers, words, true, false")
      ->trigger_on_parse()
      ->allow_extra_args(false)
      ->type_name("A,B,C");
}

}  // namespace

Run declare_sweep(CLI::App& command) {
  const auto options = std::make_shared<SweepOptions>();
  add_common_options(command, options->common);
  command
      .add_option("--verb", options->verb,
                  fmt::format("what is done at each point; solve where left out:\n{}", joined(swept_verbs())))
      ->type_name("VERB");
  add_key_options(command, options);
  command.add_flag("--list", options->side_by_side, "keys take their values side by side, not in all combinations");
  command.add_option("--seeds", options->seeds, "each point with each of these seeds: 1,2,3 or 1-5")
      ->allow_extra_args(false)
      ->type_name("S,T");
  command.add_option("--title", options->title, "title of the curves; left out: that of the case")
      ->check(plain_text())
      ->type_name("TEXT");
  command.add_flag("--resume", options->resume, "keep the points that lie in --out, compute the others");
  command.footer(
      "Examples:\n"
      "  equidem sweep data/cases/abe1996_fig6.toml --key ratio --from 0 --to 1 --steps 11 --out curve\n"
      "  equidem sweep data/cases/abe1996_fig6.toml --key assembly.rows --values 5,11,21,41\n"
      "  equidem sweep data/cases/random_cell.toml --verb homogenize --key ratio --values 0,0.5,1 --seeds 1-5\n"
      "  equidem sweep data/cases/abe1996_fig6.toml --list --key assembly.rows --values 11,21 --key assembly.columns\n"
      "                --values 11,21\n"
      "The table sweep.csv has a row for each point, the keys and all numbers of the verb's result, units in the "
      "names.\n"
      "A point that fails stays in the table with its reason, and the exit code is 0; it is 1 where all fail.\n"
      "Ctrl-C keeps what is done; --resume continues.");
  return [options] { return sweep(*options); };
}

}  // namespace equidem
