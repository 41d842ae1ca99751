// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep/sweep_run.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <map>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <sys/resource.h>

#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/study/evaluate.hpp"

#include "problem.hpp"

namespace equidem {
namespace {

SweepPoint point_of(const Sweep& sweep, std::size_t number) {
  SweepPoint point;
  point.values = sweep.plan.values_of(number);
  try {
    const Delivery delivery = sweep.run_of(point.values, {})();
    point.status = delivery.status;
    point.numbers = scalar_numbers(delivery.results);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    point.status = "failed";
    point.message = error.what();
  } catch (const std::bad_alloc&) {
    point.status = "failed";
    point.message = "there is too little memory";
  } catch (const std::exception& error) {
    point.status = "failed";
    point.message = fmt::format("this is a defect of equidem: {}", error.what());
  }
  return point;
}

/// Bytes that the process has taken at most.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

VerbRun Sweep::run_of(const std::vector<std::string>& values, const std::vector<std::string>& further) const {
  std::vector<std::string> all = options_of(plan, values, base.document);
  all.insert(all.end(), further.begin(), further.end());
  if (options.common.seed) all.insert(all.end(), {"--seed", fmt::format("{}", *options.common.seed)});
  if (options.common.quiet) all.emplace_back("--quiet");
  return {plan.verb, options.common.case_file, options.common.set, all};
}

SweepRun::SweepRun(const Sweep& sweep, std::vector<SweepPoint> kept)
    : sweep_(sweep), kept_(std::move(kept)), progress_("sweeping " + sweep.plan.names()), saved_(sweep.options.common) {
  std::map<std::vector<std::string>, const SweepPoint*> known;
  for (const SweepPoint& point : kept_)
    if (!point.failed()) known.emplace(point.values, &point);
  for (std::size_t k = 0; k < sweep.plan.size(); ++k) {
    const auto found = known.empty() ? known.end() : known.find(sweep.plan.values_of(k));
    found != known.end() ? void(points_[k] = *found->second) : missing_.push_back(k);
  }
}

void SweepRun::operator()() {
  const SharedAssemblies shared;
  const auto compute_all = [&](std::size_t, int) {
    while (compute_next()) {
    }
  };
  try {
    progress_.update(0);
    if (!missing_.empty()) compute_next();
    const std::size_t at_once = points_at_once();
    announce(at_once);
    at_once == 1 ? compute_all(0, 0) : parallel_tasks(at_once, compute_all);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    stopped_ = true;
  }
}

std::vector<SweepPoint> SweepRun::points() const {
  std::vector<SweepPoint> all;
  std::set<std::vector<std::string>> own;
  for (const auto& [k, point] : points_) {
    all.push_back(point);
    all.back().number = static_cast<std::int64_t>(k) + 1;
    if (!kept_.empty()) own.insert(point.values);
  }
  auto number = static_cast<std::int64_t>(sweep_.plan.size());
  for (const SweepPoint& point : kept_) {
    if (own.contains(point.values)) continue;
    all.push_back(point);
    all.back().number = ++number;
  }
  return all;
}

void SweepRun::save() const {
  const auto& folder = sweep_.options.common.out;
  if (folder) write_samples(*folder / Sweep::table_name, sweep_table(sweep_.plan, points()));
}

bool SweepRun::compute_next() {
  const std::size_t k = next_++;
  if (k >= missing_.size()) return false;
  SweepPoint point = point_of(sweep_, missing_[k]);
  const std::lock_guard lock(mutex_);
  points_[missing_[k]] = std::move(point);
  ++computed_;
  if (since_saved_.seconds() >= save_after_) {
    const Stopwatch saving;
    saved_([&] { save(); });
    save_after_ = std::max(1.0, 20 * saving.seconds());
    since_saved_.lap();
  }
  progress_.update(static_cast<double>(computed_) / static_cast<double>(missing_.size()));
  return true;
}

std::size_t SweepRun::points_at_once() const {
  const double most = std::min({static_cast<double>(thread_count()), 1 + available_memory() / peak_memory(),
                                static_cast<double>(missing_.size()) - static_cast<double>(computed_)});
  return static_cast<std::size_t>(std::max(1.0, most));
}

void SweepRun::announce(std::size_t at_once) const {
  constexpr double worth_telling = 3;  // s
  const double left =
      watch_.seconds() * static_cast<double>(missing_.size() - computed_) / static_cast<double>(at_once);
  if (computed_ == 0 || left < worth_telling) return;
  say(sweep_.options.common,
      fmt::format("sweeping {}: {}, {} at a time on {}, about {}", sweep_.plan.names(),
                  counted(std::ssize(missing_), "point"), at_once,
                  at_once == 1 ? counted(thread_count(), "thread") : "one thread each", readable_seconds(left)));
}

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
