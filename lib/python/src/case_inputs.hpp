// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case from Python: a file or a text, with an assembly in memory.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/given.hpp"

namespace equidem::python {

class CaseInputs {
 public:
  /// \param case_text read in place of `case_file` where that is empty
  /// \param assembly null, or that of assembly.path
  CaseInputs(const std::string& case_text, std::string case_file, const std::shared_ptr<const Assembly>& assembly,
             std::vector<std::string> overrides)
      : case_file_(std::move(case_file)), overrides_(std::move(overrides)) {
    if (case_file_.empty()) case_file_ = text_.emplace("case", std::make_shared<const std::string>(case_text)).name();
    if (assembly == nullptr) return;
    overrides_.push_back("assembly.path=\"" + assembly_.emplace("assembly", assembly).name() + "\"");
  }

  [[nodiscard]] const std::string& case_file() const { return case_file_; }
  [[nodiscard]] const std::vector<std::string>& overrides() const { return overrides_; }

 private:
  std::optional<Given<std::string>> text_;
  std::optional<Given<Assembly>> assembly_;
  std::string case_file_;
  std::vector<std::string> overrides_;
};

}  // namespace equidem::python
