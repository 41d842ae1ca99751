// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/linear_solver.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

void check(const SolverOptions& options) {
  if (options.max_refinements < 0) {
    bad_input(fmt::format("max_refinements = {}", options.max_refinements), "a number of steps cannot be negative",
              "Give 0 or more");
  }
  if (!(options.memory_limit >= 0)) {
    bad_input(fmt::format("memory_limit = {}", options.memory_limit),
              "it must be a number of bytes, or 0 for what is free", "Correct it");
  }
  if (options.ordering != CholmodOrdering::equidem && options.method != SolverMethod::cholmod) {
    bad_input(
        fmt::format("ordering = \"{}\" beside method = \"{}\"", to_string(options.ordering), to_string(options.method)),
        "it is an ordering of CHOLMOD", "Use method = \"cholmod\", or leave the ordering out");
  }
}

}  // namespace equidem
