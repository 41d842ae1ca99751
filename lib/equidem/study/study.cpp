// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/study.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <ctime>
#include <numeric>

#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The settings of one round in its order (Fisher & Yates).
std::vector<std::size_t> order_of_round(std::size_t tasks, std::uint64_t seed, int round) {
  std::vector<std::size_t> order(tasks);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(round + 1));
  for (std::size_t k = tasks; k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  return order;
}

bool trusted(const StudySamples& samples, const StudyOptions& options) {
  return std::all_of(samples.tasks.begin(), samples.tasks.end(), [&](const TaskSamples& task) {
    return !task.refusal.empty() || summarize(task.times).relative_error() <= options.time_error;
  });
}

/// The first round: the value, once.
void try_once(const StudyTask& task, TaskSamples& samples) {
  try {
    const Trial trial = task.prepare();
    trial.work();
    samples.value = trial.value();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    samples.refusal = error.what();
  }
}

/// Processor time of the calling thread, s.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::string Setting::label() const {
  std::vector<std::string> words;
  if (!method.empty()) words.push_back(method);
  for (const auto& [name, value] : values) words.push_back(fmt::format("{} = {:.6g}", name, value));
  return joined(words);
}

std::string Study::checksum(const std::string& context) const {
  Checksum sum;
  const auto add = [&](const std::string& text) {
    sum.add(std::as_bytes(std::span(text)));
    sum.add(std::uint64_t{text.size()});
  };
  add(context);
  add(name);
  add(fmt::format("{} {} {} {}", quantity, to_string(truth), relative, true_value));
  for (const StudyTask& task : tasks) {
    add(task.setting.method);
    for (const auto& [key, value] : task.setting.values) add(fmt::format("{} {}", key, value));
  }
  return sum.text();
}

int StudySamples::rounds() const {
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const TaskSamples& task : tasks) {
    if (!task.tried()) return 0;
    if (task.refusal.empty()) least = std::min(least, task.times.size());
  }
  return least == std::numeric_limits<std::size_t>::max() ? 0 : static_cast<int>(least);
}

StudySamples run_study(const Study& study, const StudyOptions& options, StudySamples kept,
                       const std::function<void(const StudySamples& done)>& save) {
  assert(options.least_rounds >= 3 && options.most_rounds >= options.least_rounds);
  StudySamples samples = std::move(kept);
  samples.stopped = false;
  samples.tasks.resize(study.tasks.size());
  const Stopwatch watch;
  double seconds_of_round = 0;
  try {
    Progress progress(study.name);
    // Round r times those that have r - 1 times: an interrupted round is completed, round 0 gives values.
    for (int round = 0; round <= options.most_rounds; ++round) {
      const double begin = watch.seconds();
      if (round > options.least_rounds && (trusted(samples, options) || begin + seconds_of_round > options.budget))
        break;
      bool worked = false;
      double done = 0;
      for (const std::size_t k : order_of_round(study.tasks.size(), options.seed, round)) {
        TaskSamples& task = samples.tasks[k];
        const double of_round = done++ / static_cast<double>(study.tasks.size());
        const double by_rounds = (round + of_round) / (options.least_rounds + 1);
        progress.update(std::min({1.0, by_rounds, watch.seconds() / options.budget}));
        const bool due =
            round == 0 ? !task.tried() : task.refusal.empty() && task.times.size() < static_cast<std::size_t>(round);
        if (!due) continue;
        if (round == 0)
          try_once(study.tasks[k], task);
        else
          task.times.push_back(time_work([&] { return study.tasks[k].prepare().work; }));
        worked = true;
        if (save) save(samples);
      }
      if (worked) seconds_of_round = watch.seconds() - begin;
      if (round > 0 && std::all_of(samples.tasks.begin(), samples.tasks.end(),
                                   [](const TaskSamples& task) { return !task.refusal.empty(); }))
        break;
    }
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    samples.stopped = true;
  }
  return samples;
}

double Timing::relative_error() const {
  if (repetitions < 3 || !(median > 0)) return std::numeric_limits<double>::infinity();
  return 1.2533 / 1.349 * (upper_quartile - lower_quartile) / (median * std::sqrt(repetitions));
}

double quantile(std::span<const double> sorted, double share) {
  assert(!sorted.empty() && share >= 0 && share <= 1);
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

Timing summarize(std::span<const TimeSample> samples) {
  if (samples.empty()) return {};
  std::vector<double> wall, processor;
  for (const TimeSample& sample : samples) {
    wall.push_back(sample.seconds);
    processor.push_back(sample.processor_seconds);
  }
  std::sort(wall.begin(), wall.end());
  std::sort(processor.begin(), processor.end());
  return {.median = quantile(wall, 0.5),
          .lower_quartile = quantile(wall, 0.25),
          .upper_quartile = quantile(wall, 0.75),
          .processor_median = quantile(processor, 0.5),
          .processor_lower_quartile = quantile(processor, 0.25),
          .processor_upper_quartile = quantile(processor, 0.75),
          .repetitions = static_cast<int>(samples.size())};
}

TimeSample time_work(const std::function<std::function<void()>()>& prepare, double least) {
  constexpr int most = 1000;
  TimeSample sum;
  int times = 0;
  while (times == 0 || (sum.seconds < least && times < most)) {
    const std::function<void()> work = prepare();
    const double processor = thread_seconds();
    const Stopwatch watch;
    work();
    sum.seconds += watch.seconds();
    sum.processor_seconds += thread_seconds() - processor;
    ++times;
  }
  return {sum.seconds / times, sum.processor_seconds / times};
}

}  // namespace equidem
