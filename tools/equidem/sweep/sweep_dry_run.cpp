// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_dry_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "problem.hpp"

namespace equidem {
namespace {

/// The number of this name among results; none where it is not there.
std::optional<double> number_in(const Results& results, const std::string& key) {
  for (const Result& part : results.parts())
    if (const auto* number = std::get_if<double>(&part.value.value); number != nullptr && part.key == key)
      return *number;
  return std::nullopt;
}

struct SweepTime {
  double seconds = 0;
  std::size_t points = 0;  ///< of which it was estimated
  std::size_t failed = 0;  ///< of them
  std::string failure;     ///< the first reason
};

/// From dry runs of some points on one thread each, as most points of a sweep are computed.
SweepTime time_of(const Sweep& sweep) {
  constexpr std::size_t most = 6;
  constexpr double enough = 3;  // s
  const std::size_t size = sweep.plan.size(), asked = std::min(size, most);
  const int threads = thread_count();
  SweepTime result;
  const Stopwatch watch;
  double sum = 0;
  for (std::size_t k = 0; k < asked && (k == 0 || watch.seconds() < enough); ++k) {
    const std::size_t point = asked == 1 ? 0 : k * (size - 1) / (asked - 1);
    try {
      const Delivery delivery = sweep.run_of(sweep.plan.values_of(point), {"--dry-run", "--threads", "1"})();
      if (const auto seconds = number_in(delivery.results, "estimated_seconds")) {
        sum += *seconds;
        ++result.points;
      }
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
      if (result.failed++ == 0) result.failure = error.what();
    }
  }
  set_thread_count(threads);
  const double at_once = std::min(static_cast<double>(threads), static_cast<double>(size));
  if (result.points > 0)
    result.seconds = sum / static_cast<double>(result.points) * std::ceil(static_cast<double>(size) / at_once);
  return result;
}

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
  results.line("sweep");
  const SweepTime time = time_of(sweep);
  if (time.points > 0) {
    results.add("estimated_seconds_of_sweep", "about", time.seconds, "s for all points", {.digits = 2})
        .note(fmt::format(", from {} of them", time.points));
  } else {
    results.note("the time of its points is not predicted");
  }
  if (time.failed > 0)
    results.note(fmt::format("; {} of those asked cannot be computed: {}", time.failed, time.failure));
  deliver(sweep.options.common, "dry_run", results, first ? first->second.times : StageTimes{});
  return 0;
}

}  // namespace equidem
