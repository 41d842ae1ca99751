// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem sweep: a verb over values of keys and seeds.
#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <exception>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/study/evaluate.hpp"

#include "problem.hpp"
#include "sweep/sweep_points.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct SweepOptions : CommonOptions {
  std::string swept = "solve";  ///< the verb
  std::vector<KeyOptions> keys;
  std::vector<std::string> seeds;  ///< "1,2,3", "1-5"
  bool side_by_side = false;
  std::optional<std::string> title;  ///< of the curves
  bool resume = false;
};

/// A sweep whose options are checked.
struct Sweep {
  static constexpr const char *table_name = "sweep.csv", *case_name = "case.toml";

  const SweepOptions& options;
  SweepPlan plan;
  CaseDocument base;

  /// The verb with the values of a point and further options.
  [[nodiscard]] VerbRun run_of(const std::vector<std::string>& values, const std::vector<std::string>& further) const;
};

/// Computes points, several at the same time. Each is computed as the verb alone would do it, so that their numbers do
/// not depend on how many.
class SweepRun {
 public:
  /// \param kept points of an earlier run; those that failed are computed again
  SweepRun(const Sweep& sweep, std::vector<SweepPoint> kept);

  /// Computes what is missing: the first point on all threads, the others on one each, as many at a time as there are
  /// threads and as fit into memory. Saves the table after the first one and then about every second.
  /// Errors of points become part of them.
  void operator()();

  [[nodiscard]] bool stopped() const { return stopped_; }  ///< by the user
  [[nodiscard]] std::size_t done() const { return points_.size(); }
  [[nodiscard]] double seconds() const { return watch_.seconds(); }
  /// The points of this run that are done, then those of an earlier one beyond them.
  [[nodiscard]] std::vector<SweepPoint> points() const;
  void save() const;

 private:
  bool compute_next();  ///< false where nothing is left to do
  void announce(std::size_t at_once) const;

  const Sweep& sweep_;
  std::vector<SweepPoint> kept_;
  std::map<std::size_t, SweepPoint> points_;  ///< done
  std::vector<std::size_t> missing_;          ///< to be computed at the start of the run
  std::atomic<std::size_t> next_{0};          ///< position in missing_
  std::mutex mutex_;                          ///< of what follows, and of points_
  Progress progress_;
  SavedOnTheWay saved_;
  Stopwatch watch_, since_saved_;
  double save_after_ = 0;  ///< s
  std::size_t computed_ = 0;
  bool stopped_ = false;
};

/// \param left points to be computed
/// \param bytes of the process with one
std::size_t points_at_once(std::size_t left, double bytes) {
  const double most =
      std::min({static_cast<double>(thread_count()), 1 + available_memory() / bytes, static_cast<double>(left)});
  return static_cast<std::size_t>(std::max(1.0, most));
}

SweepPoint point_of(const Sweep& sweep, std::size_t number) {
  SweepPoint point;
  point.values = sweep.plan.values_of(number);
  try {
    const Delivery delivery = sweep.run_of(point.values, {})();
    point.status = delivery.status;
    point.numbers = scalar_numbers(delivery.results);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    point.status = "failed";
    point.message = error.what();
  } catch (const std::bad_alloc&) {
    point.status = "failed";
    point.message = "there is too little memory";
  } catch (const std::exception& error) {
    point.status = "failed";
    point.message = fmt::format("this is a defect of equidem: {}", error.what());
  }
  return point;
}

VerbRun Sweep::run_of(const std::vector<std::string>& values, const std::vector<std::string>& further) const {
  std::vector<std::string> all = options_of(plan, values, base.document);
  all.insert(all.end(), further.begin(), further.end());
  if (options.seed) all.insert(all.end(), {"--seed", fmt::format("{}", *options.seed)});
  if (options.quiet) all.emplace_back("--quiet");
  return {plan.verb, options.case_file, options.set, all};
}

SweepRun::SweepRun(const Sweep& sweep, std::vector<SweepPoint> kept)
    : sweep_(sweep), kept_(std::move(kept)), progress_("sweeping " + sweep.plan.names()), saved_(sweep.options) {
  std::map<std::vector<std::string>, const SweepPoint*> known;
  for (const SweepPoint& point : kept_)
    if (!point.failed()) known.emplace(point.values, &point);
  for (std::size_t k = 0; k < sweep.plan.size(); ++k) {
    const auto found = known.empty() ? known.end() : known.find(sweep.plan.values_of(k));
    found != known.end() ? void(points_[k] = *found->second) : missing_.push_back(k);
  }
}

void SweepRun::operator()() {
  const SharedAssemblies shared;
  const auto compute_all = [&](std::size_t, int) {
    while (compute_next()) {
    }
  };
  try {
    progress_.update(0);
    if (!missing_.empty()) compute_next();
    const std::size_t at_once = points_at_once(missing_.size() - computed_, peak_resident_memory());
    announce(at_once);
    at_once == 1 ? compute_all(0, 0) : parallel_tasks(at_once, compute_all);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    stopped_ = true;
  }
}

std::vector<SweepPoint> SweepRun::points() const {
  std::vector<SweepPoint> all;
  std::set<std::vector<std::string>> own;
  for (const auto& [k, point] : points_) {
    all.push_back(point);
    all.back().number = static_cast<std::int64_t>(k) + 1;
    if (!kept_.empty()) own.insert(point.values);
  }
  auto number = static_cast<std::int64_t>(sweep_.plan.size());
  for (const SweepPoint& point : kept_) {
    if (own.contains(point.values)) continue;
    all.push_back(point);
    all.back().number = ++number;
  }
  return all;
}

void SweepRun::save() const {
  const auto& folder = sweep_.options.out;
  if (folder) write_samples(*folder / Sweep::table_name, sweep_table(sweep_.plan, points()));
}

bool SweepRun::compute_next() {
  const std::size_t k = next_++;
  if (k >= missing_.size()) return false;
  SweepPoint point = point_of(sweep_, missing_[k]);
  const std::lock_guard lock(mutex_);
  points_[missing_[k]] = std::move(point);
  ++computed_;
  if (since_saved_.seconds() >= save_after_) {
    const Stopwatch saving;
    saved_([&] { save(); });
    save_after_ = std::max(1.0, 20 * saving.seconds());
    since_saved_.lap();
  }
  progress_.update(static_cast<double>(computed_) / static_cast<double>(missing_.size()));
  return true;
}

void SweepRun::announce(std::size_t at_once) const {
  constexpr double least_told = 3;  // s
  const double left =
      watch_.seconds() * static_cast<double>(missing_.size() - computed_) / static_cast<double>(at_once);
  if (computed_ == 0 || left < least_told) return;
  say(sweep_.options,
      fmt::format("sweeping {}: {}, {} at a time on {}, about {}", sweep_.plan.names(),
                  counted(std::ssize(missing_), "point"), at_once,
                  at_once == 1 ? counted(thread_count(), "thread") : "one thread each", readable_seconds(left)));
}

/// The dry run of the first of some points that can be computed, with its number; none where no one of them can.
std::optional<std::pair<std::size_t, Delivery>> first_dry_run(const Sweep& sweep) {
  constexpr std::size_t most = 20;
  for (std::size_t point = 0; point < std::min(sweep.plan.size(), most); ++point) {
    try {
      return std::pair(point, sweep.run_of(sweep.plan.values_of(point), {"--dry-run"})());
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
    }
  }
  return std::nullopt;
}

/// Delivers the number of points and the dry run of the first that can be computed.
/// \param results of the keys, which the others follow
void dry_run_sweep(const Sweep& sweep, Results results) {
  const SweepPlan& plan = sweep.plan;
  const SharedAssemblies shared;
  const double resident = resident_memory();
  results.set("number_of_points", plan.size(), "", "number of points");
  const auto first = first_dry_run(sweep);
  results.block(fmt::format("{} of {}{}\n\n", counted(static_cast<long long>(plan.size()), "point"), plan.names(),
                            first ? fmt::format("; point {}:", first->first + 1) : ""));
  if (first) results.append(first->second.results);
  if (const Result* const told = find_result(results, "peak_bytes")) {
    const double one = std::get<double>(told->value.value);
    const std::size_t at_once = points_at_once(plan.size() - 1, one);
    results.line("memory of all")
        .add("peak_bytes", "", std::max(one, resident + static_cast<double>(at_once) * (one - resident)),
             fmt::format("at the peak, {} at a time", counted(static_cast<long long>(at_once), "point")),
             {Shown::bytes});
  }
  deliver(sweep.options, "dry_run", results, first ? first->second.times : StageTimes{});
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
  if (options.seed && verb == "run" && describes_grains(casefile::read_document(options.case_file, options.set)))
    bad_input_at("--seeds", "nothing in a case of grains is random", "all points would be equal", "Leave it out");
  return read_document(verb, options);
}

/// A name without a table, or of [springs], that is nearly "ratio".
void refuse_misspelt_ratio(const SweptKey& key) {
  const std::size_t dot = key.name.rfind('.');
  if (dot != std::string::npos && key.name.substr(0, dot) != "springs") return;
  const std::vector<std::string> ratio{"ratio"};
  if (unit_of_case_key(key.name) || !nearest(key.name.substr(dot + 1), ratio)) return;
  bad_input_at("--key", fmt::format("there is no key '{}'", key.name), "kT/kN at the kN of the case has the name ratio",
               "Write --key ratio");
}

/// Two keys that set the same one: the second would undo the first.
void check_different(const SweepOptions& options, const SweepPlan& plan) {
  std::map<std::string, std::string> setters;  // of keys of the case
  for (const SweptKey& key : plan.keys) {
    const std::string set = key.name == "ratio"           ? "springs.kT"
                            : key.name == SweepPlan::seed ? seed_key(options)
                                                          : key.name;
    const auto [other, is_new] = setters.emplace(set, key.name);
    if (is_new) continue;
    bad_input(fmt::format("{} and {} are varied", other->second == SweepPlan::seed ? "--seeds" : other->second,
                          key.name == SweepPlan::seed ? "--seeds" : key.name),
              fmt::format("both set {}", set), "Leave out one of them");
  }
}

/// The keys exist, and the case has a seed where seeds are given.
void check_keys(const SweepOptions& options, const SweepPlan& plan, const CaseDocument& base) {
  check_different(options, plan);
  for (const SweptKey& key : plan.keys) {
    SweepOptions first = options;
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

/// The case, and the files that it or a value of a key names, have to agree for --resume.
std::string deciding_text(const Sweep& sweep) {
  const auto folder = sweep.options.case_file.parent_path();
  std::vector<std::filesystem::path> named;
  for (const SweptKey& key : sweep.plan.keys)
    if (!key.numeric())
      std::ranges::transform(key.values, std::back_inserter(named), [&](const auto& v) { return folder / v; });
  return fmt::format("# The case of a sweep by 'equidem {}'; what is varied stands at its end.\n{}{}", sweep.plan.verb,
                     to_toml(sweep.base.document, *sweep.options.out), note_of_files(sweep.base.document, named));
}

/// The case with what is varied as comments.
std::string text_of_case(const Sweep& sweep) {
  const SweepPlan& plan = sweep.plan;
  std::string text = deciding_text(sweep);
  text += fmt::format("\n# Varied {}:\n", plan.side_by_side ? "side by side" : "in all combinations");
  for (const SweptKey& key : plan.keys) text += fmt::format("# {} = {}\n", key.name, shortened(key.values));
  return text;
}

std::vector<SweepPoint> points_to_keep(const Sweep& sweep) {
  const auto& out = sweep.options.out;
  if (!sweep.options.resume) return {};
  expect_folder_of(sweep.options, "the points done");
  const auto table = *out / Sweep::table_name;
  if (!std::filesystem::exists(table)) return {};
  if (!read_file(*out / Sweep::case_name).starts_with(deciding_text(sweep))) {
    bad_input_at((*out / Sweep::case_name).string(), "the sweep there is of another case",
                 "it, or a file that it reads, has changed", begin_anew);
  }
  return read_sweep_points(table, sweep.plan);
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
  results
      .line("failed",
            fmt::format("{}; {} done", counted(static_cast<long long>(failed), "point"), points.size() - failed))
      .warn("WARNING, failed:");
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

void sweep(const SweepOptions& options) {
  check_verb(options.swept);
  if (options.seed && !options.seeds.empty())
    bad_input("--seed and --seeds exclude each other", "both say which seed a point has", "Leave one of them out");
  Sweep sweep{options, sweep_plan(options.swept, options.keys, options.seeds, options.side_by_side),
              read_base(options.swept, options)};
  sweep.plan.waves = names_of_waves(sweep.base.document);
  check_keys(options, sweep.plan, sweep.base);
  std::optional<SweepRun> computed;
  std::vector<SweepPoint> points;
  const auto draw = [&](const CommonOptions& into) {
    if (!computed->stopped()) write_curves(*into.out, sweep.plan, points, options.title.value_or(sweep.base.title));
  };
  const auto save = [&](const CommonOptions& /*into*/) { computed->save(); };
  const std::vector<OutputPart> parts{
      {Sweep::table_name, save, OutputPart::folder, {Sweep::table_name, Sweep::case_name}},
      {"the curves", draw, OutputPart::folder, files_of_curves(sweep.plan)}};
  expect_results(options, parts, options.resume);
  if (options.dry_run) return dry_run_sweep(sweep, results_of_keys(sweep.plan));
  const auto lock = lock_out(options);
  SweepRun& run = computed.emplace(sweep, points_to_keep(sweep));
  const auto& folder = options.out;
  if (folder) write_file(*folder / Sweep::case_name, text_of_case(sweep), true);
  run();

  points = run.points();
  const auto failed = static_cast<std::size_t>(std::ranges::count_if(points, &SweepPoint::failed));
  const bool all_failed = failed == points.size();
  Results results;
  if (!sweep.base.title.empty()) results.block(sweep.base.title + "\n\n");
  results.set("title", sweep.base.title).append(results_of_keys(sweep.plan)).set("complete", !run.stopped());
  results.table("points", sweep_rows(sweep.plan, points));
  if (failed > 0) add_failures(results, points, failed);
  if (run.stopped())
    results.block(fmt::format("INCOMPLETE: stopped after {} of {} points\n", run.done(), sweep.plan.size())).warn();
  StageTimes times;
  times.add("points", run.seconds());
  deliver(options,
          run.stopped() ? "interrupted"
          : all_failed  ? "failed"
                        : "done",
          std::move(results), std::move(times), parts);
  if (run.stopped()) {
    throw_stopped(options, fmt::format("{} of {} points are done", run.done(), sweep.plan.size()));
  }
  if (all_failed)
    computation_failed("none of the points could be computed",
                       "the first: " + without_full_stop(points.front().message), "");
}

/// The key that an option belongs to: the last one given before it, or the first one where none is.
KeyOptions& current_key(SweepOptions& options) {
  return options.keys.empty() ? options.keys.emplace_back() : options.keys.back();
}

/// Options that may be repeated, those of each key after it.
void add_key_options(CLI::App& command, const std::shared_ptr<SweepOptions>& options) {
  const auto name_key = [options](const std::string& name) {
    const bool unnamed = options->keys.size() == 1 && options->keys.front().name.empty();
    (unnamed ? options->keys.front() : options->keys.emplace_back()).name = name;
  };
  command
      .add_option_function<std::string>(
          "--key", name_key,
          "a key to vary, such as springs.kT or assembly.rows; ratio: kT/kN.\nSeveral, each followed by its values: "
          "all "
          "combinations")
      ->trigger_on_parse()
      ->type_name("KEY");
  const auto add_number = [&](const char* name, const char* type, auto member, const OptionCheck& check,
                              const char* help) {
    using OptionValue = std::conditional_t<std::same_as<decltype(member), int KeyOptions::*>, int, double>;
    command
        .add_option_function<OptionValue>(
            name, [options, member](OptionValue value) { current_key(*options).*member = value; }, help)
        ->trigger_on_parse()
        ->check(check)
        ->type_name(type);
  };
  add_number("--from", "A", &KeyOptions::from, finite_number(), "first value");
  add_number("--to", "B", &KeyOptions::to, finite_number(), "last value");
  add_number("--steps", "N", &KeyOptions::steps, whole_number(1, 1000000),
             "number of values from A to B; 11 where left out");
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
  add_common_options(command, *options);
  command
      .add_option("--verb", options->swept,
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
  return [options] { return sweep(*options); };
}

}  // namespace equidem
