// SPDX-License-Identifier: GPL-3.0-or-later
#include "completion.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// How bash completes what stands after an option, or as a positional argument
/// functions, null: nothing is expected.
using Value = const char*;
constexpr Value any_value = "";
constexpr Value file_value = "files=-f";
constexpr Value folder_value = "files=-d";
constexpr Value key_value = "words=$keys";
constexpr Value assignment_value = "words=$keys; end='='";
constexpr Value command_value = "words=$commands";

Value value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (option.get_items_expected_max() == 0) return nullptr;
  if (type == "KEY") return key_value;
  if (type == "KEY=VALUE") return assignment_value;
  if (type.starts_with("FILE")) return file_value;
  if (type == "DIR") return folder_value;
  return type == "VERB" ? command_value : any_value;
}

struct Completed {
  std::string name;  ///< "set", without its hyphens
  Value value;
};

/// A command and what its line may hold.
struct Command {
  std::string name;
  std::vector<Completed> options = {};
  Value positional = nullptr;
};

/// All that the script is made of.
struct Words {
  std::string program;
  std::string function;  ///< start of the names of functions, "_equidem"
  std::vector<Command> commands = {};
  std::vector<std::string> topics = {};
  std::vector<CaseKey> keys = {};

  [[nodiscard]] std::string command_names() const {
    return joined(
        commands, [](const Command& command) { return command.name; }, " ");
  }
  [[nodiscard]] std::string key_names() const {
    return joined(
        keys, [](const CaseKey& key) { return key.path; }, " ");
  }
};

Words words_of(const Program& program, const CLI::App& app) {
  Words words{.program = program.name, .function = fmt::format("_{}", program.name)};
  std::ranges::replace(words.function, '-', '_');
  words.topics = {manual_topic, completion_topic};
  for (const HelpTopic& topic : program.topics) words.topics.emplace_back(topic.name);
  for (const Verb& verb : program.verbs) {
    Command command{.name = verb.name};
    for (const CLI::Option* option : app.get_subcommand(verb.name)->get_options()) {
      const Value value = value_of(*option);
      if (value == assignment_value) words.keys = case_keys();
      if (option->get_positional()) {
        command.positional = value;
        continue;
      }
      command.options.push_back({option->get_lnames().front(), value});
    }
    words.topics.push_back(command.name);
    words.commands.push_back(std::move(command));
  }
  return words;
}

/// bash splits words at '=': the value of a key is the second word after it.
std::string bash(const Words& words) {
  std::string values, options;
  for (const CaseKey& key : words.keys)
    if (!key.words.empty()) values += fmt::format("      {}) words='{}' ;;\n", key.path, joined(key.words, " "));
  std::vector<std::string> after;
  for (const Command& command : words.commands) {
    const auto option_name = [](const Completed& option) { return "--" + option.name; };
    options += fmt::format("        {}) words='{}' {} ;;\n", command.name, joined(command.options, option_name, " "),
                           command.positional == nullptr ? "" : command.positional);
    for (const Completed& option : command.options) {
      if (option.value == nullptr) continue;
      std::string line = fmt::format("    --{}) {} ;;\n", option.name, option.value);
      if (std::ranges::find(after, line) == after.end()) after.push_back(std::move(line));
    }
  }
  return fmt::format(R"(# Completion of {0} for bash, printed by '{0} help completion bash'.
{1}() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" at=$((COMP_CWORD - 1)) words='' files='' end=''
  local commands='{2}'
  local keys='{3}'
  if [ "$word" = '=' ]; then
    word=''
    at=$COMP_CWORD
  fi
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="$commands help --help --version"
  elif [ "${{COMP_WORDS[at]}}" = '=' ]; then
    case "${{COMP_WORDS[at - 1]}}" in
{4}      --*) files=-f ;;
    esac
  else
    case "${{COMP_WORDS[at]}}" in
{5}    *)
      case "${{COMP_WORDS[1]}}" in
{6}        help)
          case "${{COMP_WORDS[at]}}" in
            help) words='{7}' ;;
            man) words="$commands" ;;
            completion) words=bash ;;
          esac
          ;;
      esac
      ;;
    esac
  fi
  [ -z "$end" ] || compopt -o nospace
  [ -z "$files" ] || compopt -o filenames
  mapfile -t COMPREPLY < <(compgen $files -W "$words" -S "$end" -- "$word")
}}
complete -F {1} {0}
)",
                     words.program, words.function, words.command_names(), words.key_names(), values, joined(after, ""),
                     options, joined(words.topics, " "));
}

}  // namespace

std::string bash_completion(const Program& program, const CLI::App& app) {
  return bash(words_of(program, app));
}

}  // namespace equidem
