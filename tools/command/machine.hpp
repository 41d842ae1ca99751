// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The machine and the build on which times were measured.
#pragma once

#include <string>

#include "equidem/output/results.hpp"

namespace equidem {

struct Machine {
  std::string processor;  ///< "" where unknown
  int cores = 0;
  std::string compiler;
  std::string build;  ///< "optimized, assertions off"
  std::string version;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Results results() const;
};

Machine this_machine();

}  // namespace equidem
