// SPDX-License-Identifier: GPL-3.0-or-later
#include "program.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <unistd.h>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"

namespace equidem {
namespace {

/// Usage: PROGRAM VERB OPERANDS [OPTIONS].
class HelpText : public CLI::Formatter {
 public:
  explicit HelpText(const Program& program) : program_(program) {}
  std::string make_usage(const CLI::App* command, std::string) const override {
    if (command->get_parent() == nullptr) return fmt::format("Usage: {} {}\n", program_.name, program_.usage);
    std::string usage = fmt::format("Usage: {} {}", program_.name, command->get_name());
    for (const CLI::Option* option : command->get_options())
      if (option->get_positional()) usage += " " + option->get_name();
    return usage + " [OPTIONS]\n";
  }

 private:
  const Program& program_;
};

std::string version_text() {
  return fmt::format("equidem {}\n{}, compiler {}\nCLI11 {}, fmt {}.{}.{}, {}\n", library_version(),
                     build_description(), __VERSION__, CLI11_VERSION, FMT_VERSION / 10000, FMT_VERSION / 100 % 100,
                     FMT_VERSION % 100, toml_parser());
}

/// Without line breaks and control characters: words of a file may hold any bytes.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names, const std::string& otherwise) {
  const auto meant = nearest(word, names);
  return meant ? fmt::format("Did you mean '{}'?", *meant) : otherwise;
}

void check_refusals(const Program& program, const std::string& word) {
  for (const Refusal& refusal : program.refusals)
    if (word == refusal.word) bad_input(refusal.problem, refusal.why, refusal.remedy);
  casefile::refuse_removed_word(word, program.name);
}

[[noreturn]] void parse_failure(const Program& program, const CLI::App& verb, const CLI::ParseError& error) {
  const std::string help = fmt::format("'{} {} --help' lists its options", program.name, verb.get_name());
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    std::vector<std::string> options;
    for (const CLI::Option* option : verb.get_options()) options.push_back(option->get_name());
    for (const std::string& extra : verb.remaining()) {
      check_refusals(program, extra.substr(0, extra.find('=')));
      if (extra.starts_with("-"))
        bad_input(fmt::format("unknown option '{}'", extra), "", did_you_mean(extra, options, help));
      bad_input(fmt::format("'{}' is one argument too many", extra), "", help);
    }
  }
  std::string problem = one_line(error.what());
  if (problem.starts_with("CASE ")) problem = "the case file is missing";
  while (!problem.empty() && problem.back() == '.') problem.pop_back();
  bad_input(problem, "", help);
}

std::string generated_text(const Program& program, const CLI::App& app, const std::string& kind,
                           const std::string& name) {
  if (kind == completion_topic) {
    if (name == "bash") return bash_completion(program, app);
    bad_input(fmt::format("there is no completion for the shell '{}'", name), "", "The only shell is bash");
  }
  if (const auto page = man_page(program, app, name)) return *page;
  bad_input(fmt::format("there is no manual page on '{}'", name), "", "Name a verb or a topic of help");
}

void show_help(const Program& program, const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.size() < 2) return print(app.help());
  const auto take = [&](std::size_t most) {
    if (arguments.size() > most)
      bad_input(fmt::format("'{}' is one argument too many", arguments[most]), "",
                fmt::format("'{} help' shows what there is help on", program.name));
  };
  std::vector<std::string> topics{manual_topic, completion_topic};
  if (std::ranges::find(topics, arguments[1]) != topics.end()) {
    take(3);
    return print(generated_text(program, app, arguments[1], arguments.size() > 2 ? arguments[2] : ""));
  }
  for (const HelpTopic& topic : program.topics) {
    topics.emplace_back(topic.name);
    if (arguments[1] != topic.name) continue;
    const bool further = arguments.size() > 2;
    const bool markdown = topic.markdown != nullptr && further && arguments[2] == "--markdown";
    take(markdown || topic.entry != nullptr ? 3 : 2);
    return print(markdown ? topic.markdown() : further ? topic.entry(arguments[2]) : topic.text());
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    topics.push_back(command->get_name());
    if (arguments[1] != command->get_name()) continue;
    take(2);
    return print(command->help(program.name));
  }
  bad_input(fmt::format("there is no help on '{}'", arguments[1]), "",
            did_you_mean(arguments[1], topics, fmt::format("There is help on {}", joined(topics))));
}

void run(const Program& program, const std::vector<std::string>& arguments) {
  CLI::App app(program.description, program.name);
  app.formatter(std::make_shared<HelpText>(program));
  const auto without_end = [](std::string text) {
    if (text.ends_with('\n')) text.pop_back();
    return text;
  };
  app.footer(without_end(program.footer));
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  std::vector<Run> runs;
  std::vector<CLI::App*> commands;
  std::string group = fmt::format("{}s", program.noun);
  group[0] = static_cast<char>(group[0] - 'a' + 'A');
  for (const Verb& verb : program.verbs) {
    commands.push_back(app.add_subcommand(verb.name, verb.summary));
    commands.back()->group(group);
    commands.back()->footer(without_end(verb.footer));
    runs.push_back(verb.declare(*commands.back()));
  }
  std::vector<std::string> names = names_in(program.verbs);
  names.emplace_back("help");
  const std::string examples = fmt::format("'{} --help' shows examples", program.name);
  if (!arguments.empty() && arguments[0] == "help") return show_help(program, app, arguments);
  const std::string known = fmt::format("the {}s are {}", program.noun, joined(names));
  if (arguments.empty()) bad_input(fmt::format("a {} is missing", program.noun), known, examples);
  const auto verb = std::find_if(commands.begin(), commands.end(),
                                 [&](auto* command) { return arguments[0] == command->get_name(); });
  if (!arguments[0].starts_with("-") && verb == commands.end()) {
    check_refusals(program, arguments[0]);
    bad_input(fmt::format("unknown {} '{}'", program.noun, arguments[0]), known,
              did_you_mean(arguments[0], names, examples));
  }

  try {
    parse(app, arguments);
  } catch (const CLI::CallForHelp&) {
    const bool of_verb = verb != commands.end() && (*verb)->parsed();
    return print(of_verb ? (*verb)->help(program.name) : app.help());
  } catch (const CLI::CallForVersion&) {
    return print(version_text());
  } catch (const CLI::ParseError& error) {
    if (verb != commands.end()) parse_failure(program, **verb, error);
  }
  if (verb == commands.end()) bad_input(fmt::format("unknown option '{}'", arguments[0]), "", examples);
  std::vector<std::string> words{program.name};
  words.insert(words.end(), arguments.begin(), arguments.end());
  set_command_line(words);
  const ProtectedInputs inputs(replaceable_inputs(**verb));
  runs[static_cast<std::size_t>(verb - commands.begin())]();
}

/// A descriptor of the standard streams that is closed would become that of the first file that is opened: what cannot
/// be written to takes its place. A pipe or a file that takes no more is an error of the write, not a signal.
void keep_streams_apart() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF) static_cast<void>(open("/dev/null", O_RDONLY));
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace

int run_program(const Program& program, int argc, char** argv) {
  keep_streams_apart();
  const auto fail = [&](const std::string& sentence, int exit_code) {
    std::fprintf(stderr, "%s: %s\n", program.name, one_line(sentence).c_str());
    return exit_code;
  };
  catch_interrupts();
  try {
    run(program, std::vector<std::string>(argv + 1, argv + argc));
    return 0;
  } catch (const Error& error) {
    return fail(error.what(), error.exit_code());
  } catch (const std::bad_alloc&) {
    return fail("there is too little memory. Use fewer discs or threads, or a machine with more memory.", 1);
  } catch (const std::exception& error) {
    return fail(fmt::format("this is a defect of equidem: {}. Please report it with the case file.", error.what()), 1);
  }
}

}  // namespace equidem
