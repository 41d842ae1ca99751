// SPDX-License-Identifier: GPL-3.0-or-later
#include "command.hpp"

#include <algorithm>
#include <cerrno>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <new>
#include <span>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/quantities.hpp"

namespace equidem {

void parse(CLI::App& app, std::vector<std::string> words) {
  struct Points {  // of this thread: CLI11 reads numbers by strtold
    locale_t numbers = newlocale(LC_NUMERIC_MASK, "C", nullptr), before = uselocale(numbers);
    ~Points() {
      uselocale(before);
      if (numbers != nullptr) freelocale(numbers);
    }
  } const points;
  std::ranges::reverse(words);
  app.parse(words);
}

OptionCheck whole_number(std::int64_t least, std::int64_t most) {
  return [=](const std::string& given) {
    const auto value = number_given<std::int64_t>(given);
    return value && *value >= least && *value <= most
               ? ""
               : fmt::format("'{}' is not a whole number from {} to {}", given, least, most);
  };
}

OptionCheck finite_number() {
  return [](const std::string& given) {
    const auto value = number_given<double>(given);
    return value && std::isfinite(*value) ? "" : fmt::format("'{}' is not a finite number", given);
  };
}

OptionCheck number(double least, double most) {
  return [=](const std::string& given) {
    const auto value = number_given<double>(given);
    return value && *value >= least && *value <= most
               ? ""
               : fmt::format("'{}' is not a number from {:g} to {:g}", given, least, most);
  };
}

OptionCheck plain_text() {
  return [](const std::string& given) { return has_controls(given) ? std::string("it has control characters") : ""; };
}

OptionCheck file_name() {
  return [](const std::string& given) {
    if (given.empty()) return std::string("the name is empty");
    return given.starts_with("--") ? fmt::format("'{0}' is an option; a file of that name is ./{0}", given) : "";
  };
}

void add_result_options(CLI::App& command, CommonOptions& options) {
  options.verb = command.get_name();
  command.add_option("--out", options.out, "write tables, pictures and files for ParaView into this folder")
      ->check(file_name())
      ->type_name("DIR");
  command.add_option("--json", options.json, "write the result as JSON; '-': to stdout, in place of the report")
      ->check(file_name())
      ->type_name("FILE|-");
  command.add_option("--threads", options.threads, "threads; left out: one per processor")
      ->check(whole_number(1, 4096))
      ->type_name("N");
  command.add_flag("--quiet", options.quiet, "no report and no progress");
  command.add_flag("--overwrite", options.overwrite, "replace files that exist");
}

void add_common_options(CLI::App& command, CommonOptions& options) {
  command.add_option("CASE", options.case_file, "the case file (TOML); 'equidem help case' lists its keys")
      ->required()
      ->type_name("FILE");
  command.add_option("--set", options.set, "set a key of the case, as springs.kT=0.3e9; KEY=none: take it out")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_option("--seed", options.seed, "short for --set assembly.seed=S, of a packing packing.seed=S")
      ->check(whole_number(0))
      ->type_name("S");
  command.add_flag("--dry-run", options.dry_run, "say how large the computation is, without doing it");
  add_result_options(command, options);
}

namespace {

/// Files with the names of texts in a document, and those that they name in turn.
void add_named_files(const TomlValue& value, const std::filesystem::path& folder, int depth,
                     std::vector<std::filesystem::path>& files);

void add_document(const std::filesystem::path& file, std::span<const std::string> overrides, int depth,
                  std::vector<std::filesystem::path>& files) {
  files.push_back(file);
  try {
    add_named_files(casefile::read_document(file, overrides), file.parent_path(), depth, files);
  } catch (const Error&) {  // the verb reports what is wrong with it
  }
}

void add_named_files(const TomlValue& value, const std::filesystem::path& folder, int depth,
                     std::vector<std::filesystem::path>& files) {
  for (const TomlValue& item : value.items) add_named_files(item, folder, depth, files);
  for (const TomlEntry& entry : value.entries) add_named_files(entry.value, folder, depth, files);
  std::error_code ignored;
  if (value.type != TomlValue::Type::text || value.text.find('\0') != std::string::npos) return;
  const std::filesystem::path path = folder / value.text;
  if (!std::filesystem::is_regular_file(path, ignored)) return;
  depth > 0 && path.extension() == ".toml" ? add_document(path, {}, depth - 1, files) : files.push_back(path);
}

}  // namespace

std::vector<std::filesystem::path> replaceable_inputs(const CLI::App& command) {
  const auto given = [&](const char* name) {
    const CLI::Option* option = command.get_option_no_throw(name);
    return option != nullptr && option->count() > 0 ? option->results() : std::vector<std::string>{};
  };
  std::vector<std::filesystem::path> files;
  if (given("--overwrite").empty() || !given("--resume").empty()) return files;
  constexpr int documents_in_documents = 2;  // of a study: its case, and the springs of that
  for (const char* name : {"CASE", "STUDY"})
    for (const std::string& file : given(name)) add_document(file, given("--set"), documents_in_documents, files);
  for (const std::string& file : given("--begin-from")) files.emplace_back(file);
  return files;
}

void add_require_stable(CLI::App& command, CommonOptions& options) {
  command.add_flag("--require-stable", options.require_stable,
                   "end with exit code 1 unless the assembly is known to be stable");
}

void prepare(const CommonOptions& options) {
  if (options.threads > 0) set_thread_count(options.threads);
  set_progress_shown(!options.quiet);
}

const char* seed_key(const CommonOptions& options) {
  const TomlValue root = casefile::read_document(options.case_file, options.set);
  const TomlValue* assembly = root.find("assembly");
  const TomlValue* kind = assembly != nullptr && assembly->is_table() ? assembly->find("kind") : nullptr;
  const bool packed =
      kind != nullptr ? kind->text == "packing" : assembly == nullptr && root.find("packing") != nullptr;
  return packed ? "packing.seed" : "assembly.seed";
}

std::vector<std::string> overrides_of(const CommonOptions& options) {
  std::vector<std::string> overrides = options.set;
  if (options.seed) overrides.push_back(fmt::format("{}={}", seed_key(options), *options.seed));
  return overrides;
}

std::vector<std::string> plot_files(const std::string& name) {
  return {name + ".csv", name + ".gp", name + ".svg", name + ".png"};
}

static void check_named(const std::filesystem::path& path, bool overwrite) {
  const auto folder = path.parent_path();
  if (!folder.empty() && !std::filesystem::exists(folder)) {
    bad_input(fmt::format("cannot write '{}'", path.string()), fmt::format("there is no folder '{}'", folder.string()),
              "Make it, or correct the name");
  }
  check_writable(path, overwrite);
}

void expect_json(const CommonOptions& options) {
  if (options.json && *options.json != "-") check_named(*options.json, options.overwrite);
}

void expect_folder_of(const CommonOptions& options, const std::string& what) {
  if (!options.out)
    bad_input("--resume has nothing to continue", what + " would lie in the folder of --out",
              "Add --out with the folder of the computation that is to go on");
}

void expect_results(const CommonOptions& options, const std::vector<OutputPart>& parts, bool replaces) {
  namespace fs = std::filesystem;
  std::vector<fs::path> taken;
  const auto take = [&](const std::string& what, const fs::path& path, bool named) {
    named ? check_named(path, options.overwrite) : check_writable(path, options.overwrite || replaces);
    std::error_code ignored;
    const fs::path place = fs::weakly_canonical(fs::absolute(path), ignored);
    if (std::ranges::find(taken, place) != taken.end())
      bad_input(fmt::format("{} and another result would both be written to '{}'", what, path.string()),
                "one would replace the other", "Give it a file of its own");
    taken.push_back(place);
  };
  if (options.json && *options.json != "-") take("the JSON", *options.json, true);
  if (options.out) take("the results", *options.out / "result.json", false);
  if (options.out && has_page(options.verb)) take("the page", *options.out / page_name, false);
  for (const OutputPart& part : parts) {
    const bool named = part.place == OutputPart::file;
    for (const std::string& name : part.files)
      if (named || options.out) take(part.name, named ? fs::path(name) : *options.out / name, named);
  }
}

namespace {

/// \return errno; 0: written
int write_to_stdout(const std::string& text) {
  return std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0 ? errno : 0;
}

[[noreturn]] void stdout_failed(int error) {
  computation_failed("cannot write to stdout", std::strerror(error), "Send the output somewhere that has room for it");
}

}  // namespace

void print(const std::string& text) {
  if (const int error = write_to_stdout(text); error != 0 && error != EPIPE) stdout_failed(error);
}

std::optional<FolderLock> lock_out(const CommonOptions& options) {
  if (!options.out || options.dry_run) return std::nullopt;
  return FolderLock(*options.out);
}

namespace {

/// Where deliver and hand_over put the results of a verb on this thread.
struct Collection {
  Delivery* delivery = nullptr;  ///< null: deliver prints and writes them
  bool arrays = false;
  std::string command;  ///< that leads to the results
};
thread_local Collection collection;

/// The command of the program, written once before its verb begins.
std::string& command_line() {
  static std::string line;
  return line;
}

}  // namespace

std::string shell_words(const std::vector<std::string>& words) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+.,:/@%";
  const auto quoted = [&](const std::string& word) {
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
    return text + "'";
  };
  return joined(words, quoted, " ");
}

void set_command_line(const std::vector<std::string>& words) {
  command_line() = shell_words(words);
}

Delivery collect(const std::function<void()>& verb, Arrays arrays, const std::string& command) {
  Delivery delivery;
  struct Restored {
    Collection before;
    ~Restored() { collection = std::move(before); }
  } const restored{std::exchange(collection, {&delivery, arrays == Arrays::wanted, command})};
  verb();
  return delivery;
}

bool arrays_wanted() {
  return collection.arrays;
}

void hand_over(std::vector<ResultArray> arrays) {
  if (arrays_wanted()) std::ranges::move(arrays, std::back_inserter(collection.delivery->arrays));
}

void hand_over(std::shared_ptr<const Assembly> assembly) {
  if (arrays_wanted()) collection.delivery->assembly = std::move(assembly);
}

std::string Delivery::page(const std::filesystem::path& folder, const std::vector<DrawnFigure>& drawn) const {
  const auto written = folder / "case.toml";
  return result_page_html({.verb = verb,
                           .status = status,
                           .version = library_version(),
                           .command = command,
                           .case_text = std::filesystem::exists(written) ? read_file(written) : "",
                           .report = report(),
                           .results = results,
                           .figures = drawn});
}

std::string Delivery::page_drawn_in(const std::filesystem::path& folder) const {
  CommonOptions options;
  options.verb = verb;
  options.out = folder;
  options.overwrite = options.pictures_only = true;
  const DrawnFigures drawn;
  for (const OutputPart& part : figures) part.write(options);
  return page(folder, drawn.list());
}

std::string Delivery::report() const {
  Results all;
  if (status == "unstable") all.line("UNSTABLE", "any disturbance would grow: what follows is no state of rest");
  all.append(results);
  if (status != "dry_run") {
    all.line("times", fmt::format("{:.2g} s in all", times.total()));
    constexpr double visible = 0.02;  // of all; shorter stages are left to the JSON
    for (const auto& [stage, seconds] : times.stages())
      if (seconds >= visible * times.total()) all.note(fmt::format(", {} {:.2g} s", stage, seconds));
  }
  return all.report();
}

Results Delivery::numbers() const {
  Results seconds, object;
  for (const auto& [stage, time] : times.stages()) seconds.set(stage, time);
  return object.set("status", status).set("times", seconds).set("version", library_version()).append(results);
}

Results Delivery::texts() const {
  return Results().set("report", report()).append(units_and_labels(numbers()));
}

std::string Delivery::json() const {
  return numbers().append(texts()).json();
}

std::optional<Error> failure_of(const std::function<void()>& work, const std::string& part) {
  const std::string missing = part.empty() ? "" : part + " is missing";
  try {
    work();
    return {};
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    if (!part.empty()) return Error(ErrorKind::out_of_memory, missing, "there is too little memory for it", "");
    return Error(ErrorKind::out_of_memory, "there is too little memory to go on", "",
                 "Use fewer discs, or a machine with more memory");
  } catch (const std::exception& error) {
    return Error(ErrorKind::computation_failed, part.empty() ? error.what() : missing, part.empty() ? "" : error.what(),
                 "Please report it with the case");
  }
}

namespace {

/// Carries out the parts of a delivery. What fails is a warning of the results.
class Deliverer {
 public:
  /// \param failure of the work before, which ends the verb
  Deliverer(Results& results, const std::optional<Error>& failure) : results_(results), before_(failure) {}

  /// \param lost where it fails the delivery has failed
  /// \return whether it succeeded
  bool attempt(const std::string& what, const std::function<void()>& task, bool lost = true) {
    if (interruption_) return false;
    const std::optional<Error> error = failure_of(task, what);
    if (!error) return true;
    if (error->kind() == ErrorKind::interrupted) {
      interruption_ = error;
      return false;
    }
    if (lost && !failure_)
      failure_.emplace(ErrorKind::computation_failed, error->problem(), error->why(), error->remedy(), error->where());
    warn(error->what());
    return false;
  }
  void warn(const std::string& sentence) {
    if (std::ranges::find(warnings_, sentence) != warnings_.end()) return;
    warnings_.push_back(sentence);
    results_.warning("WARNING", sentence);
  }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// \param printed warnings go to stderr, and the failure ends the verb; else a caller in memory has both
  void finish(bool printed) const {
    for (const std::string& warning : warnings_)
      if (printed && !(!before_ && failure_ && warning == failure_->what()))
        std::fprintf(stderr, "warning: %s\n", warning.c_str());
    if (before_) throw *before_;
    if (interruption_) throw *interruption_;
    if (printed && failure_) throw *failure_;
  }

 private:
  Results& results_;
  const std::optional<Error>& before_;
  std::vector<std::string> warnings_;
  std::optional<Error> failure_, interruption_;
};

}  // namespace

void deliver(const CommonOptions& options, const std::string& given_status, Results results, StageTimes times,
             const std::vector<OutputPart>& parts, const std::optional<Error>& failure) {
  const bool interrupted = given_status == "interrupted" || (failure && failure->kind() == ErrorKind::interrupted);
  const StopsHeldBack held_back(interrupted);
  const std::string status = interrupted ? "interrupted" : failure ? "failed" : given_status;
  if (failure) {
    const std::string where = failure->where().empty() ? "" : failure->where() + ": ";
    const std::string why = failure->why().empty() ? "" : fmt::format(" ({})", failure->why());
    results = Results()
                  .line("NOT DONE", where + failure->problem() + why + "; what follows is what there was by then")
                  .append(results)
                  .set("complete", false)
                  .set("failure", failure->what());
  }
  const bool printed = collection.delivery == nullptr, to_stdout = options.json && *options.json == "-";
  const bool filed = options.out && !options.dry_run, file_of_json = printed && options.json && !to_stdout;
  Deliverer all(results, failure);
  const auto delivery = [&] {
    Delivery made{status, results, times};
    if (!all.warnings().empty()) made.results.set("warnings", all.warnings());
    made.verb = options.verb;
    made.command = printed ? command_line() : collection.command;
    return made;
  };
  // The files were found writable before the computation.
  const auto write_json = [&] {
    if (!filed && !file_of_json) return true;
    const std::string json = delivery().json();
    bool written = true;
    if (filed) written = all.attempt("result.json", [&] { write_file(*options.out / "result.json", json, true); });
    if (file_of_json) written &= all.attempt(*options.json, [&] { write_file(*options.json, json, true); });
    return written;
  };
  const bool written = write_json() && (filed || file_of_json);
  const Stopwatch watch;
  const DrawnFigures drawn;
  for (const OutputPart& part : parts)
    if (options.out || part.place == OutputPart::file) {
      all.attempt(part.name, [&] {
        stop_if_interrupted();
        part.write(options);
      });
    }
  for (const DrawnFigure& figure : drawn.list())
    if (!figure.missing.empty()) all.warn(figure.missing);
  const bool timed = options.out && !parts.empty();
  if (timed) times.add("files", watch.seconds());
  if (filed && has_page(options.verb)) {
    all.attempt(page_name,
                [&] { write_file(*options.out / page_name, delivery().page(*options.out, drawn.list()), true); });
  }
  if (!printed) {
    *collection.delivery = delivery();
    if (arrays_wanted())
      std::ranges::copy_if(parts, std::back_inserter(collection.delivery->figures),
                           [](const OutputPart& part) { return part.place == OutputPart::page; });
  } else if (to_stdout || !options.quiet) {
    const int error = write_to_stdout(to_stdout ? delivery().json() : delivery().report());
    if (error != 0)
      all.attempt(
          "stdout", [&] { stdout_failed(error); }, !written);
  }
  if (timed || !all.warnings().empty()) write_json();
  if (filed) say(options, fmt::format("written to {}", options.out->string()));
  all.finish(printed);
  if (options.require_stable && (status == "unstable" || status == "unjudged" || status == "mechanism")) {
    computation_failed(fmt::format("the assembly is not stable: its status is \"{}\"", status),
                       "--require-stable was given", "Raise kT, hold more discs, or leave the option out");
  }
}

void SavedOnTheWay::operator()(const std::function<void()>& save) {
  try {
    save();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    if (!failed_) say(options_, fmt::format("warning: {}", error.what()));
    failed_ = true;
  }
}

void throw_stopped(const CommonOptions& options, const std::string& done, const std::string& again) {
  throw Error(ErrorKind::interrupted, "stopped as asked", done,
              options.out ? again : "With --out DIR what is done would be kept");
}

std::string build_description() {
#ifdef __OPTIMIZE__
  const std::string optimized = "optimized";
#else
  const std::string optimized = "not optimized";
#endif
#ifdef NDEBUG
  return optimized + ", assertions off";
#else
  return optimized + ", assertions on";
#endif
}

namespace {

/// The first "model name" of Linux; empty where unknown.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    return colon == std::string::npos ? "" : line.substr(colon + 2);
  }
  return "";
}

}  // namespace

std::string machine_text() {
  const std::string processor = processor_name();
  return fmt::format("{}, {}; equidem {}, {}, compiler {}", processor.empty() ? "unknown processor" : processor,
                     counted(std::thread::hardware_concurrency(), "core"), library_version(), build_description(),
                     __VERSION__);
}

Results machine_results() {
  return Results()
      .set("processor", processor_name())
      .set("cores", std::thread::hardware_concurrency())
      .set("compiler", __VERSION__)
      .set("build", build_description())
      .set("version", library_version());
}

std::string without_full_stop(std::string sentence) {
  if (sentence.ends_with('.')) sentence.pop_back();
  return sentence;
}

void say(const CommonOptions& options, const std::string& line) {
  if (!options.quiet) std::fprintf(stderr, "%s\n", line.c_str());
}

}  // namespace equidem
