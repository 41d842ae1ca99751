// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/study_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"

namespace equidem {
namespace {

constexpr double shortest = 1e-3;  // s: time_work repeats what is shorter

/// Settings of one problem and method that were timed, from coarse to fine.
using Refined = std::vector<std::pair<double, double>>;  // resolution, s

/// s; none where fewer than two resolutions were timed.
std::optional<double> extrapolated(const Refined& timed, double resolution) {
  constexpr double steepest = 4;  // power of the resolution: time of an explicit run in three dimensions
  if (timed.size() < 2 || std::isnan(resolution)) return std::nullopt;
  const auto& [coarse, before] = timed[timed.size() - 2];
  const auto& [fine, seconds] = timed.back();
  if (!(coarse > fine)) return seconds;
  const double power = std::clamp(std::log(seconds / before) / std::log(coarse / fine), 0.0, steepest);
  return seconds * std::pow(fine / resolution, power);
}

}  // namespace

double time_setting(const StudyTask& task) {
  const Stopwatch watch;
  try {
    const Trial trial = task.prepare();
    trial.work();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
  }
  return std::max(watch.seconds(), shortest);
}

StudyEstimate estimate_study(const Study& study, const StudyOptions& options, double seconds,
                             const std::function<double(const StudyTask&)>& seconds_of) {
  const std::vector<StudyTask>& tasks = study.tasks;
  std::vector<std::size_t> coarse_first(tasks.size());
  std::iota(coarse_first.begin(), coarse_first.end(), std::size_t{0});
  const auto coarseness = [&](std::size_t k) {
    const double resolution = tasks[k].setting.resolution;
    return std::isnan(resolution) ? std::numeric_limits<double>::infinity() : resolution;
  };
  std::ranges::stable_sort(coarse_first, std::ranges::greater{}, coarseness);

  std::map<std::pair<std::string, std::string>, Refined> refined;
  std::vector<std::size_t> left_out;
  StudyEstimate result;
  double spent = 0;
  for (const std::size_t k : coarse_first) {
    const Setting& setting = tasks[k].setting;
    Refined& timed = refined[{setting.problem, setting.method}];
    if (spent + extrapolated(timed, setting.resolution).value_or(0) > seconds) {
      left_out.push_back(k);
      continue;
    }
    stop_if_interrupted();
    const double taken = seconds_of(tasks[k]);
    if (!std::isnan(setting.resolution)) timed.emplace_back(setting.resolution, taken);
    spent += taken;
    ++result.timed;
  }
  result.round = spent;
  const double mean = result.timed > 0 ? spent / static_cast<double>(result.timed) : 0;
  for (const std::size_t k : left_out) {
    const Setting& setting = tasks[k].setting;
    result.round += extrapolated(refined[{setting.problem, setting.method}], setting.resolution).value_or(mean);
  }
  result.least = (options.least_rounds + 1) * result.round;
  result.most = std::max(result.least, std::min(options.budget, (options.most_rounds + 1) * result.round));
  return result;
}

}  // namespace equidem
