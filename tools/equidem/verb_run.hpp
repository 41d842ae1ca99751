// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Verbs carried out within another one, as the command line would do it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/file.hpp"

#include "command.hpp"

namespace equidem {

/// One run of a verb, without files.
class VerbRun {
 public:
  /// \param verb its name
  /// \param overrides of keys of the case, as those of --set
  /// \param options further ones of the command line
  /// \throws Error (bad_input) on an option that the verb does not have
  VerbRun(const std::string& verb, const std::filesystem::path& case_file, const std::vector<std::string>& overrides,
          const std::vector<std::string>& options);

  /// \throws Error as the verb does
  [[nodiscard]] Delivery operator()(Arrays arrays = Arrays::not_wanted) const {
    const ProtectedInputs inputs(replaceable_inputs(command_));
    return collect(run_, arrays, command_line_);
  }

 private:
  CLI::App command_;
  std::string command_line_;
  std::function<void()> run_;
};

}  // namespace equidem
