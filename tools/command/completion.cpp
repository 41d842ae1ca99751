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

/// How the shells complete what stands after an option, or as a positional argument; {0}: the start of the names of
/// functions.
struct Value {
  const char* bash;
  const char* zsh;
  const char* fish;
};
constexpr Value no_value{"", "", ""};
constexpr Value any_value{"", " ", "-x"};
constexpr Value file_value{"files=-f", "_files", "-r -F"};
constexpr Value folder_value{"files=-d", "_files -/", "-x -a '(__fish_complete_directories)'"};
constexpr Value key_value{"words=$keys", "{0}_keys", "-x -a '({0}_keys)'"};
constexpr Value assignment_value{"words=$keys; end='='", "{0}_assignments", "-x -a '({0}_assignments)'"};
constexpr Value command_value{"words=$commands", "{0}_commands", "-x -a '({0}_commands)'"};
constexpr Value listed_or_file_value{"words=$({0}_listed); files=-f", "{0}_listed_or_files", "-a '({0}_listed)' -F"};

const Value& value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (option.get_items_expected_max() == 0) return no_value;
  if (type == "KEY") return key_value;
  if (type == "KEY=VALUE") return assignment_value;
  if (type == "NAME|FILE") return listed_or_file_value;
  if (type.starts_with("FILE")) return file_value;
  if (type == "DIR") return folder_value;
  return type == "VERB" ? command_value : any_value;
}

struct Completed {
  std::string name;  ///< "set", without its hyphens
  const Value* value;
  std::string description;  ///< its first line
  bool repeated;
};

/// A command and what its line may hold.
struct Command {
  std::string name;
  std::string summary;
  std::vector<Completed> options = {};
  const Value* positional = nullptr;
};

/// All that the scripts are made of.
struct Words {
  std::string program;
  std::string function;  ///< start of the names of functions, "_equidem"
  std::vector<Command> commands = {};
  std::vector<std::string> topics = {};
  std::vector<CaseKey> keys = {};
  std::string lister = {};  ///< the command whose --list names what its positional argument may be

  [[nodiscard]] std::string command_names() const {
    return joined(
        commands, [](const Command& command) { return command.name; }, " ");
  }
  [[nodiscard]] std::string key_names() const {
    return joined(
        keys, [](const CaseKey& key) { return key.path; }, " ");
  }
  /// "assembly.kind=square assembly.kind=hexagonal": those whose words can be listed.
  [[nodiscard]] std::string assignments() const {
    std::vector<std::string> out;
    for (const CaseKey& key : keys)
      for (const std::string& word : key.words) out.push_back(fmt::format("{}={}", key.path, word));
    return joined(out, " ");
  }
  /// A shell command that prints the names for Words::lister, one a line.
  [[nodiscard]] std::string listed() const {
    if (lister.empty()) return "true";
    return fmt::format("{} {} --list | sed -n 's/^  *\\([a-z_0-9]*\\) .*/\\1/p'", program, lister);
  }
  [[nodiscard]] std::string with_function(const char* action) const {
    return fmt::format(fmt::runtime(action), function);
  }
};

Words words_of(const Program& program, const CLI::App& app) {
  Words words{.program = program.name, .function = fmt::format("_{}", program.name)};
  std::ranges::replace(words.function, '-', '_');
  words.topics = {manual_topic, completion_topic};
  for (const HelpTopic& topic : program.topics) words.topics.emplace_back(topic.name);
  for (const Verb& verb : program.verbs) {
    Command command{.name = verb.name, .summary = verb.summary};
    for (const CLI::Option* option : app.get_subcommand(verb.name)->get_options()) {
      const Value* value = &value_of(*option);
      if (value == &assignment_value) words.keys = case_keys();
      if (value == &listed_or_file_value) words.lister = verb.name;
      if (option->get_positional()) {
        command.positional = value;
        continue;
      }
      const std::string& text = option->get_description();
      command.options.push_back(
          {option->get_lnames().front(), value, text.substr(0, text.find('\n')), option->get_items_expected_max() > 1});
    }
    words.topics.push_back(command.name);
    words.commands.push_back(std::move(command));
  }
  return words;
}

/// In single quotes. \param special characters that the shell's reader of the text takes as its own
std::string in_quotes(std::string_view text, std::string_view special = "") {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c == '\'' ? std::string_view("'\\''") : std::string_view(&c, 1);
  }
  return fmt::format("'{}'", out);
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
                           command.positional == nullptr ? "" : words.with_function(command.positional->bash));
    for (const Completed& option : command.options) {
      if (option.value == &no_value) continue;
      std::string line = fmt::format("    --{}) {} ;;\n", option.name, words.with_function(option.value->bash));
      if (std::ranges::find(after, line) == after.end()) after.push_back(std::move(line));
    }
  }
  return fmt::format(R"(# Completion of {0} for bash, printed by '{0} help completion bash'.
{1}_listed() {{
  {2}
}}
{1}() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" at=$((COMP_CWORD - 1)) words='' files='' end=''
  local commands='{3}'
  local keys='{4}'
  if [ "$word" = '=' ]; then
    word=''
    at=$COMP_CWORD
  fi
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="$commands help --help --version"
  elif [ "${{COMP_WORDS[at]}}" = '=' ]; then
    case "${{COMP_WORDS[at - 1]}}" in
{5}      --*) files=-f ;;
    esac
  else
    case "${{COMP_WORDS[at]}}" in
{6}    *)
      case "${{COMP_WORDS[1]}}" in
{7}        help)
          case "${{COMP_WORDS[at]}}" in
            help) words='{8}' ;;
            man) words="$commands" ;;
            completion) words='bash zsh fish' ;;
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
                     words.program, words.function, words.listed(), words.command_names(), words.key_names(), values,
                     joined(after, ""), options, joined(words.topics, " "));
}

std::string zsh(const Words& words) {
  constexpr std::string_view special = "[]:\\";
  std::string summaries, arguments;
  for (const Command& command : words.commands) {
    summaries += fmt::format("\n    {}", in_quotes(fmt::format("{}:{}", command.name, command.summary)));
    arguments += fmt::format("    {}) _arguments", command.name);
    for (const Completed& option : command.options) {
      const std::string description = in_quotes(option.description, special);
      std::string action = words.with_function(option.value->zsh);
      if (!action.empty()) action = fmt::format(":{}:{}", option.name, action);
      arguments +=
          fmt::format(" \\\n      '{}--{}['{}']{}'", option.repeated ? "*" : "", option.name, description, action);
    }
    if (command.positional != nullptr)
      arguments += fmt::format(" \\\n      '1:{}:{}'", command.name, words.with_function(command.positional->zsh));
    arguments += " ;;\n";
  }
  return fmt::format(R"(#compdef {0}
# Completion of {0} for zsh, printed by '{0} help completion zsh'.
{1}_listed_or_files() {{
  compadd -- $({2})
  _files
}}
{1}_keys() {{
  compadd -- {3}
}}
{1}_assignments() {{
  compadd -S '=' -- {3}
  compadd -- {4}
}}
{1}_commands() {{
  local -a commands=({5})
  _describe command commands
}}
{1}() {{
  if (( CURRENT == 2 )); then
    {1}_commands
    compadd -- help --help --version
    return
  fi
  shift words
  (( CURRENT -= 1 ))
  case $words[1] in
{6}    help) _arguments '1:topic:({7})' '2:name:({8} bash zsh fish)' ;;
  esac
}}
{1} "$@"
)",
                     words.program, words.function, words.listed(), words.key_names(), words.assignments(), summaries,
                     arguments, joined(words.topics, " "), words.command_names());
}

std::string fish(const Words& words) {
  std::string out = fmt::format(R"(# Completion of {0} for fish, printed by '{0} help completion fish'.
function {1}_listed
  {2}
end
function {1}_keys
  printf '%s\n' {3}
end
function {1}_assignments
  {1}_keys | string replace -r '$' =
  printf '%s\n' {4}
end
function {1}_commands
  printf '%s\n' {5}
end
complete -c {0} -f
complete -c {0} -n __fish_use_subcommand -l version
complete -c {0} -n __fish_use_subcommand -l help
complete -c {0} -n __fish_use_subcommand -a help
complete -c {0} -n '__fish_seen_subcommand_from help' -a '{6}'
complete -c {0} -n '__fish_seen_subcommand_from completion' -a 'bash zsh fish'
)",
                                words.program, words.function, words.listed(), words.key_names(), words.assignments(),
                                words.command_names(), joined(words.topics, " "));
  for (const Command& command : words.commands) {
    out += fmt::format("complete -c {} -n __fish_use_subcommand -a {} -d {}\n", words.program, command.name,
                       in_quotes(command.summary));
    const std::string line =
        fmt::format("complete -c {} -n '__fish_seen_subcommand_from {}' ", words.program, command.name);
    if (command.positional != nullptr)
      out += fmt::format("{}{}\n", line, words.with_function(command.positional->fish));
    for (const Completed& option : command.options)
      out += fmt::format("{}-l {} {} -d {}\n", line, option.name, words.with_function(option.value->fish),
                         in_quotes(option.description));
  }
  return out;
}

}  // namespace

std::optional<std::string> completion(const Program& program, const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash(words_of(program, app));
  if (shell == "zsh") return zsh(words_of(program, app));
  if (shell == "fish") return fish(words_of(program, app));
  return std::nullopt;
}

}  // namespace equidem
