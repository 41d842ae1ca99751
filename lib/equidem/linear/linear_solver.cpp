// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/linear_solver.hpp"

#include <algorithm>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multigrid/multigrid_solver.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

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

SolveEstimate estimate(const SymbolicFactor& symbolic, const DegreesOfFreedom& unknowns, bool indefinite) {
  SolveEstimate result;
  result.unknowns = unknowns.unknowns;
  result.factor_nonzeros = symbolic.nonzeros;
  result.factor_bytes = sizeof(double) * symbolic.panel_entries();
  result.operations = symbolic.operations;
  // Beside the factor: update matrices on their way up, of which buffers are kept; L D L^T works in whole fronts.
  double waiting = 0, largest = 0;
  std::vector<double> of_children(symbolic.fronts(), 0.0);
  for (std::size_t t = 0; t < symbolic.fronts(); ++t) {
    const auto pivots = static_cast<double>(symbolic.pivots(t)), updates = static_cast<double>(symbolic.updates(t));
    const double update = updates * updates, front = indefinite ? (pivots + updates) * (pivots + updates) : 0;
    largest = std::max(largest, waiting + update + front);
    waiting += update - of_children[t];
    const std::int32_t parent = symbolic.tree.nodes[t].parent;
    if (parent >= 0) of_children[parent] += update;
  }
  // K on the discs and about three contacts each, and the vectors of a solution.
  const double b = symbolic.block, discs = static_cast<double>(symbolic.position.size());
  const double system = sizeof(double) * discs * (4 * b * b + 12 * b);
  // Fronts of L D L^T come in many sizes, and idle buffers are kept: measured.
  result.peak_bytes = result.factor_bytes + sizeof(double) * (indefinite ? 2.5 : 1) * largest + system;
  return result;
}

SolveEstimate estimate_iterations(const Assembly& assembly, const DegreesOfFreedom& unknowns) {
  SolveEstimate result;
  result.unknowns = unknowns.unknowns;
  result.peak_bytes =
      bytes_of_multigrid(static_cast<double>(assembly.size()), static_cast<double>(assembly.contacts.size()));
  return result;
}

void check_memory(const SolveEstimate& estimate, double memory_limit) {
  // OpenBLAS maps one for each thread that calls it, and tries for ever where the limit of the process forbids it.
  constexpr double blas_buffer = 128.0 * (1 << 20);
  require_address_space(estimate.peak_bytes + blas_buffer * thread_count(),
                        fmt::format("solving for {} unknowns on {} needs about", grouped(estimate.unknowns),
                                    counted(thread_count(), "thread")));
  require_memory(estimate.peak_bytes, fmt::format("solving for {} unknowns needs about", grouped(estimate.unknowns)),
                 "Use fewer discs, restrain rotation, raise the limit, or take a machine with more memory",
                 memory_limit);
}

}  // namespace equidem
