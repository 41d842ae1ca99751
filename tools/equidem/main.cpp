// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "equidem/casefile/keys.hpp"
#include "equidem/casefile/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/nearest.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/json.hpp"

#include "verbs.hpp"

namespace equidem {
namespace {

constexpr const char* examples = R"(Examples:
  equidem solve data/cases/abe1996_fig6.toml
  equidem solve data/cases/abe1996_fig6.toml --set springs.kT=0.3e9 --out result
  equidem sweep data/cases/abe1996_fig6.toml --key ratio --from 0 --to 1 --steps 11 --out curve
  equidem homogenize data/cases/random_cell.toml
  equidem calibrate data/cases/calibrate_random.toml --springs springs.toml
  equidem stability data/cases/random_cell.toml --set assembly.discs=60 --out waves
  equidem run data/cases/run_pulse.toml --out pulse
  equidem run data/cases/grains_cradle.toml --out cradle
  equidem pack data/cases/pack_jammed.toml --out jammed
  equidem study integrators --accuracy 1e-4
  equidem help case          every key of the case file

Exit codes: 0 done; 1 the computation failed, and says why; 2 bad input or usage; 130 interrupted.)";

/// The usage line in the words of this program.
class HelpText : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* command, std::string) const override {
    if (command->get_parent() == nullptr) return "Usage: equidem VERB CASE.toml [OPTIONS]\n";
    const auto takes = [&](const char* what) { return command->get_option_no_throw(what) != nullptr; };
    return fmt::format("Usage: equidem {} {} [OPTIONS]\n", command->get_name(),
                       takes("CASE")    ? "CASE.toml"
                       : takes("STUDY") ? "NAME|FILE.toml"
                                        : "PAPER");
  }
};

std::string version_text() {
#ifdef NDEBUG
  const char* assertions = "assertions off";
#else
  const char* assertions = "assertions on";
#endif
#ifdef __OPTIMIZE__
  const char* optimized = "optimized";
#else
  const char* optimized = "not optimized";
#endif
  return fmt::format("equidem {}\n{}, {}, compiler {}\nCLI11 {}, fmt {}.{}.{}, {}\n", library_version(), optimized,
                     assertions, __VERSION__, CLI11_VERSION, FMT_VERSION / 10000, FMT_VERSION / 100 % 100,
                     FMT_VERSION % 100, toml_parser());
}

std::vector<std::string> verb_names() {
  std::vector<std::string> names;
  for (const Verb& verb : verbs) names.emplace_back(verb.name);
  names.emplace_back("help");
  return names;
}

std::string listed(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

/// Without what would break the line or the terminal: words of a file may hold any bytes.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text;
}

int usage_error(const std::string& problem, const std::string& why, const std::string& remedy) {
  throw Error(ErrorKind::bad_input, problem, why, remedy);
}

/// What the command line library says, as a sentence of ours.
int parse_failure(const CLI::App& verb, const CLI::ParseError& error) {
  const std::string help = fmt::format("'equidem {} --help' lists its options", verb.get_name());
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    std::vector<std::string> options;
    for (const CLI::Option* option : verb.get_options()) options.push_back(option->get_name());
    for (const std::string& extra : verb.remaining()) {
      if (extra == "--accuracy" || extra.starts_with("--accuracy=")) {
        return usage_error(fmt::format("'equidem {}' takes no --accuracy", verb.get_name()),
                           "it has no setting that could be chosen for one",
                           "solve, homogenize, run and study do; 'equidem study --list' shows what accuracy costs");
      }
      if (extra.starts_with("-")) {
        const auto meant = nearest(extra, options);
        return usage_error(fmt::format("unknown option '{}'", extra), "",
                           meant ? fmt::format("Did you mean '{}'?", *meant) : help);
      }
      return usage_error(fmt::format("'{}' is one argument too many", extra), "a verb takes one case file", help);
    }
  }
  std::string problem = one_line(error.what());
  if (problem.starts_with("CASE ")) problem = "the case file is missing";
  while (!problem.empty() && problem.back() == '.') problem.pop_back();
  return usage_error(problem, "", help);
}

int show_help(const CLI::App& program, const std::vector<std::string>& arguments) {
  if (arguments.size() > 1 && arguments[1] == "case") {
    std::fputs(describe_case_file().c_str(), stdout);
    return 0;
  }
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (arguments.size() > 1 && arguments[1] == command->get_name()) {
      std::fputs(command->help("equidem").c_str(), stdout);
      return 0;
    }
  }
  if (arguments.size() > 1) {
    auto topics = verb_names();
    topics.back() = "case";
    const auto meant = nearest(arguments[1], topics);
    usage_error(fmt::format("there is no help on '{}'", arguments[1]), "",
                meant ? fmt::format("Did you mean '{}'?", *meant) : fmt::format("There is help on {}", listed(topics)));
  }
  std::fputs(program.help().c_str(), stdout);
  return 0;
}

int run(const std::vector<std::string>& arguments) {
  CLI::App program("equidem: the exact equilibrium of assemblies of discs, and the continuum they stand for",
                   "equidem");
  program.formatter(std::make_shared<HelpText>());
  program.footer(examples);
  program.set_version_flag("--version", version_text());
  program.require_subcommand(1);
  std::vector<Run> runs;
  std::vector<CLI::App*> commands;
  for (const Verb& verb : verbs) {
    commands.push_back(program.add_subcommand(verb.name, verb.summary));
    commands.back()->group("Verbs");
    runs.push_back(verb.declare(*commands.back()));
  }
  if (!arguments.empty() && arguments[0] == "help") return show_help(program, arguments);
  if (arguments.empty())
    usage_error("a verb is missing", fmt::format("the verbs are {}", listed(verb_names())),
                "'equidem --help' shows examples");
  const bool is_verb =
      std::any_of(verbs.begin(), verbs.end(), [&](const Verb& verb) { return arguments[0] == verb.name; });
  if (!arguments[0].starts_with("-") && !is_verb) {
    const auto meant = nearest(arguments[0], verb_names());
    usage_error(fmt::format("unknown verb '{}'", arguments[0]), fmt::format("the verbs are {}", listed(verb_names())),
                meant ? fmt::format("Did you mean '{}'?", *meant) : "'equidem --help' shows examples");
  }

  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    program.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    for (const CLI::App* command : commands) {
      if (!command->parsed()) continue;
      std::fputs(command->help("equidem").c_str(), stdout);
      return 0;
    }
    std::fputs(program.help().c_str(), stdout);
    return 0;
  } catch (const CLI::CallForVersion&) {
    std::fputs(version_text().c_str(), stdout);
    return 0;
  } catch (const CLI::ParseError& error) {
    for (const CLI::App* command : commands)
      if (arguments[0] == command->get_name()) return parse_failure(*command, error);
    return usage_error(fmt::format("unknown option '{}'", arguments[0]), "", "'equidem --help' shows examples");
  }
  for (std::size_t k = 0; k < commands.size(); ++k)
    if (commands[k]->parsed()) return runs[k]();
  return 2;
}

int fail(const std::string& sentence, int exit_code) {
  std::fprintf(stderr, "equidem: %s\n", one_line(sentence).c_str());
  return exit_code;
}

/// OpenBLAS starts its threads when it is loaded, before main, and lets them spin for a while beside ours, although
/// every call here runs on one thread. Only its environment can tell it not to: where the user says nothing, start
/// again and say it.
void start_without_blas_threads(char** argv) {
  constexpr const char* variable = "OPENBLAS_NUM_THREADS";
  if (std::getenv(variable) != nullptr || setenv(variable, "1", 0) != 0) return;
  execv("/proc/self/exe", argv);  // returns only where that is not possible: then it is merely slower
}

}  // namespace
}  // namespace equidem

int main(int argc, char** argv) {
  using namespace equidem;
  start_without_blas_threads(argv);
  catch_interrupts();
  try {
    const int code = run(std::vector<std::string>(argv + 1, argv + argc));
    if (std::fflush(stdout) != 0) return fail("cannot write to stdout.", 2);
    return code;
  } catch (const Error& error) {
    std::fflush(stdout);
    return fail(error.what(), error.exit_code());
  } catch (const std::bad_alloc&) {
    return fail("there is too little memory. Make the assembly smaller; --dry-run says what it needs.", 1);
  } catch (const std::exception& error) {
    return fail(fmt::format("this is a defect of equidem: {}. Please report it with the case file.", error.what()), 1);
  }
}
