// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The main function of a program that is a list of commands: command line, help, exit codes. Its manual for man(1) and
/// the completion of its command line are made from the command line itself.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace equidem {

/// Runs a command after its options are read; what ends it otherwise than done is an Error.
using Run = std::function<void()>;

/// The effects of a case that a command takes; it refuses a case that asks for another one.
struct Takes {
  enum class Viscoelastic {
    none,
    at_rest,  ///< of springs that have an equilibrium
    moving,   ///< with dashpots beside springs
    all,      ///< by the frequency
  };
  bool prestress = false, bending = false;
  Viscoelastic viscoelastic = Viscoelastic::none;
  bool of_another = false;  ///< the command that it carries out checks it
};

/// A command is one file with one declare function, and one line in the list of its program.
struct Verb {
  const char* name;
  const char* summary;                ///< one line of the help
  Run (*declare)(CLI::App& command);  ///< adds its options to the command line
  bool swept = false;                 ///< gives numbers of a case whose keys a sweep may vary
  const char* footer = "";            ///< below its options: examples; without its last line break
  Takes takes = {};
};

/// An option or command that is not accepted, with the message for it.
struct Refusal {
  const char* word;
  const char* problem;
  const char* why;
  const char* remedy;
};

/// A page of help beside those of the commands.
struct HelpTopic {
  const char* name;
  const char* summary;  ///< one line of the manual
  std::string (*text)();
  std::string (*markdown)() = nullptr;                      ///< printed with --markdown
  std::string (*entry)(const std::string& name) = nullptr;  ///< on one of its entries, `help TOPIC NAME`
};

/// Topics of help that every program has: a page of its manual, completion for a shell.
inline constexpr const char* manual_topic = "man";
inline constexpr const char* completion_topic = "completion";

struct Program {
  const char* name;
  const char* description;  ///< one line of the help
  const char* noun;         ///< of a command: "verb"
  const char* usage;        ///< arguments after the name of the program
  const char* footer;       ///< examples and exit codes
  std::span<const Verb> verbs;
  std::vector<HelpTopic> topics = {};
  std::vector<Refusal> refusals = {};  ///< in place of "unknown verb" and "unknown option"
};

/// A page in the macros of man(7): the program's own in section 1, of a command PROGRAM-COMMAND(1), of a help topic
/// PROGRAM-TOPIC(5). The first names all others under SEE ALSO.
/// \param name of the command or topic; empty: the page of the program
/// \return nothing where there is no such command or topic
std::optional<std::string> man_page(const Program& program, const CLI::App& app, const std::string& name);

/// A script for bash that completes commands, their options, and after options what the type of their value names:
/// files, commands, keys of the case file and their words.
std::string bash_completion(const Program& program, const CLI::App& app);

/// Read the command line, carry out its command, report an error as one line on stderr.
/// \return the exit code: 0 done; 1 the computation failed; 2 bad input or usage; 130 interrupted
int run_program(const Program& program, int argc, char** argv);

}  // namespace equidem
