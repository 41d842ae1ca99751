// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace equidem {

/// While one exists, check_writable and write_file refuse to replace these files on its thread, whatever their names.
class ProtectedInputs {
 public:
  explicit ProtectedInputs(std::vector<std::filesystem::path> files);
  ~ProtectedInputs();
  ProtectedInputs(const ProtectedInputs&) = delete;
  ProtectedInputs& operator=(const ProtectedInputs&) = delete;

 private:
  std::vector<std::filesystem::path> files_;
  const std::vector<std::filesystem::path>* outer_;
};

}  // namespace equidem
