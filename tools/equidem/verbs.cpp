// SPDX-License-Identifier: GPL-3.0-or-later
#include "verbs.hpp"

#include <algorithm>

#include "equidem/core/error.hpp"
#include "equidem/core/given.hpp"

namespace equidem {
namespace {

/// The command that does the same. A case in memory is that of the page, with its overrides; the folder of the results
/// is left out.
std::string command_of(const std::string& verb, const std::filesystem::path& case_file,
                       const std::vector<std::string>& overrides, const std::vector<std::string>& options) {
  const bool in_memory = Given<std::string>::find(case_file) != nullptr;
  std::vector<std::string> words{"equidem", verb, in_memory ? "case.toml" : case_file.string()};
  if (!in_memory)
    for (const std::string& assignment : overrides) words.insert(words.end(), {"--set", assignment});
  for (std::size_t k = 0; k < options.size(); ++k) {
    if (options[k] == "--overwrite") continue;
    options[k] == "--out" ? void(++k) : words.push_back(options[k]);
  }
  return shell_words(words);
}

}  // namespace

VerbRun::VerbRun(const std::string& verb, const std::filesystem::path& case_file,
                 const std::vector<std::string>& overrides, const std::vector<std::string>& options) {
  command_.name(verb);
  command_line_ = command_of(verb, case_file, overrides, options);
  run_ = entry_named(verbs, verb, "verb").declare(command_);
  std::vector<std::string> arguments{case_file.string()};
  for (const std::string& assignment : overrides) arguments.insert(arguments.end(), {"--set", assignment});
  arguments.insert(arguments.end(), options.begin(), options.end());
  std::ranges::reverse(arguments);
  try {
    const PointsInNumbers points;
    command_.parse(arguments);
  } catch (const CLI::ParseError& error) {
    bad_input(error.what(), "", "See 'equidem help'");
  }
}

std::set<std::string> flags_of_verbs() {
  std::set<std::string> names;
  for (const Verb& verb : verbs) {
    CLI::App command;
    const Run run = verb.declare(command);
    for (const CLI::Option* option : command.get_options())
      if (option->get_items_expected_max() == 0) names.insert(option->get_lnames().begin(), option->get_lnames().end());
  }
  return names;
}

}  // namespace equidem
