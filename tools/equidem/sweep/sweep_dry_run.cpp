// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_dry_run.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "problem.hpp"

namespace equidem {
namespace {

/// The dry run of the first of some points that can be computed, with its number; none where no one of them can.
std::optional<std::pair<std::size_t, Delivery>> first_dry_run(const Sweep& sweep) {
  constexpr std::size_t most = 20;
  for (std::size_t point = 0; point < std::min(sweep.plan.size(), most); ++point) {
    try {
      return std::pair(point, sweep.run_of(sweep.plan.values_of(point), {"--dry-run"})());
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
    }
  }
  return std::nullopt;
}

}  // namespace

int dry_run_sweep(const Sweep& sweep, Results results) {
  const SweepPlan& plan = sweep.plan;
  const SharedAssemblies shared;
  results.set("number_of_points", plan.size(), "", "number of points");
  const auto first = first_dry_run(sweep);
  results.block(fmt::format("{} of {}{}\n\n", counted(static_cast<long long>(plan.size()), "point"), plan.names(),
                            first ? fmt::format("; point {}:", first->first + 1) : ""));
  if (first) results.append(first->second.results);
  deliver(sweep.options.common, "dry_run", results, first ? first->second.times : StageTimes{});
  return 0;
}

}  // namespace equidem
