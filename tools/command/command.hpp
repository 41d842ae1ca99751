// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Options and output that all verbs share: the case file, overrides, threads, files of the results, the machine.
/// Checks of the values of options, for CLI::Option::check.
#pragma once

#include <complex>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/results.hpp"

namespace CLI {
class App;
}

namespace equidem {

/// Parses the words of a command line, whose numbers have a decimal point whatever locale the process is in.
/// \throws CLI::ParseError
void parse(CLI::App& app, std::vector<std::string> words);

/// The number that the value of an option is; none where it is none.
template <class Number>
std::optional<Number> number_given(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return number_from<Number>(text);
}

/// Returns what is wrong with a value, or nothing.
using OptionCheck = std::function<std::string(const std::string& given)>;

/// A whole number in [least, most].
OptionCheck whole_number(std::int64_t least, std::int64_t most = std::numeric_limits<std::int64_t>::max());
/// A finite number, or one in [least, most].
OptionCheck finite_number();
OptionCheck number(double least, double most);
/// A text without control characters.
OptionCheck plain_text();
/// The name of a file or folder: not empty, and no option that stands where a name was forgotten.
OptionCheck file_name();

/// The options that every verb takes.
struct CommonOptions {
  std::string verb;  ///< its name
  std::filesystem::path case_file;
  std::vector<std::string> set;
  std::optional<std::filesystem::path> out;
  std::optional<std::string> json;  ///< file, or "-" for stdout
  int threads = 0;                  ///< 0: one per processor
  std::optional<std::int64_t> seed;
  bool dry_run = false;
  bool quiet = false;
  bool overwrite = false;
  bool require_stable = false;
  bool pictures_only = false;  ///< of what is written into --out: a page of results in memory shows no more
};

/// --out, --json, --threads, --quiet and --overwrite; the only options of verbs without a case file.
void add_result_options(CLI::App& command, CommonOptions& options);
/// The case file, its overrides, and add_result_options.
void add_common_options(CLI::App& command, CommonOptions& options);
/// Where --overwrite allows a verb to replace files: what it reads, its case and the files that the case names. A run
/// that goes on with --resume replaces its own files, which may be its case.
std::vector<std::filesystem::path> replaceable_inputs(const CLI::App& command);
/// --require-stable, which deliver applies.
void add_require_stable(CLI::App& command, CommonOptions& options);

/// Applies --threads and --quiet.
void prepare(const CommonOptions& options);
/// The key that --seed sets: packing.seed, or assembly.seed.
const char* seed_key(const CommonOptions& options);
/// --set, and --seed as an assignment of its key.
std::vector<std::string> overrides_of(const CommonOptions& options);
/// case.toml in --out, if there is one, which reproduces the computation.
/// \param resolved a Case or the document of another kind of case
/// \param note behind it
template <typename Resolved>
void write_case(const CommonOptions& options, const Resolved& resolved, const std::string& note = {}) {
  if (options.out) write_file(*options.out / "case.toml", to_toml(resolved, *options.out) + note, true);
}

/// What a verb writes beside its results: a table, a picture, the case. It is declared before the computation, which
/// checks its files then; it is written after it, and fails alone.
struct OutputPart {
  enum Place {
    folder,  ///< --out
    page,    ///< likewise, and it is drawn again for a page of results in memory: it owns what it refers to
    file,    ///< that it names itself, also without --out
  };
  std::string name;                                      ///< for warnings
  std::function<void(const CommonOptions& into)> write;  ///< into the folder --out of the options
  Place place = folder;
  std::vector<std::string> files = {};  ///< in the folder, or the file that it names itself
};
/// NAME.csv, .gp, .svg and .png, which write_plot writes.
std::vector<std::string> plot_files(const std::string& name);
/// case.toml, which reproduces the computation.
/// \param resolved returns a Case, or the document of another kind of case, that the part keeps
/// \param note behind it
template <typename Resolved>
OutputPart case_part(const Resolved& resolved, const std::string& note = {}) {
  const auto write = [=](const CommonOptions& into) { write_case(into, resolved(), note); };
  return {"case.toml", write, OutputPart::page, {"case.toml"}};
}

/// Checks before the computation that the files of deliver and those of the parts can be written.
/// \param replaces the files of an earlier computation in --out, which this one continues; the file of --json is not
/// \throws Error (bad_input) where one could not be written, or two go to one place
void expect_results(const CommonOptions& options, const std::vector<OutputPart>& parts, bool replaces = false);
/// What to do where --resume finds what it cannot continue.
inline constexpr const char* begin_anew = "Choose another --out, or leave out --resume and pass --overwrite";
/// \param what lies in --out: "the events"
/// \throws Error (bad_input) of --resume without --out
void expect_folder_of(const CommonOptions& options, const std::string& what);
/// The file of --json alone, in an existing folder: a missing one is probably a typing error.
/// \throws Error (bad_input)
void expect_json(const CommonOptions& options);

/// Keeps other processes from --out until the end of a verb, also from what it reads there; none without --out or on a
/// dry run.
/// \throws Error (bad_input) where another process has the folder
[[nodiscard]] std::optional<FolderLock> lock_out(const CommonOptions& options);

/// Does work of a verb. What ends it before its end is returned, so that the verb delivers what it has by then.
/// \param part of the results that is then missing; empty: the rest of the verb
std::optional<Error> failure_of(const std::function<void()>& work, const std::string& part = {});

/// What a computation finds; where it ends before its end, what it had found by then.
/// \param failure set where it ended
template <class Found, class Work>
Found found_by(std::optional<Error>& failure, const Work& work) {
  try {
    return work();
  } catch (const ErrorWith<Found>& ended) {
    failure = ended;
    return ended.found();
  }
}

/// Delivers the results of a verb in the order of their worth: OUT/result.json and --json FILE; the parts, one after
/// the other; OUT/index.html; the report to stdout, unless quiet, or the JSON where --json is "-". What fails on the
/// way is a warning in all that follows and on stderr; result.json is then written again with the warnings. A dry run
/// does not write to the folder.
/// \param status the first key of the JSON: "solved", "dry_run", ...
/// \param failure what ended the work before its end: then the status is "failed" or "interrupted", `complete` is
///        false, `failure` and a line of the report are its reason, and it is thrown afterwards
/// \throws Error (computation_failed) afterwards, where a file was lost or the answer reached neither the folder nor
///         stdout; where --require-stable is given and the status is "unstable", "unjudged" or "mechanism".
///         (interrupted) where the user stopped the parts
void deliver(const CommonOptions& options, const std::string& status, Results results, StageTimes times,
             const std::vector<OutputPart>& parts = {}, const std::optional<Error>& failure = {});

/// Numbers of a result in memory, too many for the JSON.
struct ResultArray {
  std::string name;  ///< "displacements", with '/' between the names of parts
  std::string unit;
  std::shared_ptr<const void> owner;  ///< keeps the numbers
  /// The first of them.
  std::variant<const double*, const std::int32_t*, const std::complex<double>*> numbers{};
  std::size_t rows = 0;
  std::size_t columns = 1;
  std::size_t stride = 1;          ///< numbers from one row to the next
  std::size_t matrix_columns = 0;  ///< rows are matrices of so many columns; 0: they are none
};

/// Results as they are given to deliver, and what hand_over adds.
struct Delivery {
  std::string status;
  Results results;
  StageTimes times;
  std::vector<ResultArray> arrays = {};
  std::shared_ptr<const Assembly> assembly = {};  ///< made by the verb, or null
  std::vector<OutputPart> figures = {};           ///< parts of the page; none where arrays are not wanted
  std::string verb = {};
  std::string command = {};  ///< that leads to the results

  /// The report, with the times.
  [[nodiscard]] std::string report() const;
  /// The results with status, times and version.
  [[nodiscard]] Results numbers() const;
  /// Report, units and labels.
  [[nodiscard]] Results texts() const;
  /// Numbers and texts: result.json.
  [[nodiscard]] std::string json() const;
  /// The page with the case of the folder.
  [[nodiscard]] std::string page(const std::filesystem::path& folder, const std::vector<DrawnFigure>& drawn) const;
  /// The page; the case and the figures are written into an empty folder for it.
  [[nodiscard]] std::string page_drawn_in(const std::filesystem::path& folder) const;
};
enum class Arrays { wanted, not_wanted };
/// Carry out a verb whose results are not printed: deliver and hand_over pass those of this thread on to here.
/// \param command that the page of the results names
/// \throws Error as the verb does
Delivery collect(const std::function<void()>& verb, Arrays arrays = Arrays::not_wanted,
                 const std::string& command = {});
/// The command line of the program, which pages name.
void set_command_line(const std::vector<std::string>& words);
/// The words as a shell takes them, with spaces between them.
std::string shell_words(const std::vector<std::string>& words);
/// Whether the caller of the verb takes arrays: only then hand_over has an effect.
bool arrays_wanted();
void hand_over(std::vector<ResultArray> arrays);
void hand_over(std::shared_ptr<const Assembly> assembly);

/// Saves a table on the way to an end that writes it again: a disk that is full then costs no computation.
class SavedOnTheWay {
 public:
  explicit SavedOnTheWay(const CommonOptions& options) : options_(options) {}
  /// What fails is a warning on stderr, once.
  void operator()(const std::function<void()>& save);

 private:
  const CommonOptions& options_;
  bool failed_ = false;
};

/// \param done "3 of 12 points are done"
/// \param again how to continue a run with --out
/// \throws Error (interrupted)
[[noreturn]] void throw_stopped(const CommonOptions& options, const std::string& done,
                                const std::string& again = "Run the same command with --resume to do the rest");

/// "optimized, assertions off".
std::string build_description();
/// The machine and the build on which times are measured.
std::string machine_text();
Results machine_results();

/// The sentence without its full stop, as a part of another one.
std::string without_full_stop(std::string sentence);

/// Write to stdout, at once; nothing more to a reader that has gone.
/// \throws Error (computation_failed) where that fails
void print(const std::string& text);
/// One line on stderr, unless quiet.
void say(const CommonOptions& options, const std::string& line);

}  // namespace equidem
