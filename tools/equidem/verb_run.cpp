// SPDX-License-Identifier: GPL-3.0-or-later
#include "verb_run.hpp"

#include <algorithm>

#include "equidem/core/error.hpp"

#include "verbs.hpp"

namespace equidem {

VerbRun::VerbRun(const std::string& verb, const std::filesystem::path& case_file,
                 const std::vector<std::string>& overrides, const std::vector<std::string>& options) {
  run_ = entry_named(verbs, verb, "verb").declare(command_);
  std::vector<std::string> arguments{case_file.string()};
  for (const std::string& assignment : overrides) arguments.insert(arguments.end(), {"--set", assignment});
  arguments.insert(arguments.end(), options.begin(), options.end());
  std::ranges::reverse(arguments);
  try {
    command_.parse(arguments);
  } catch (const CLI::ParseError& error) {
    bad_input(error.what(), "", "See 'equidem help'");
  }
}

}  // namespace equidem
