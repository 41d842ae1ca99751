// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"

#include "run/run_bonded.hpp"

namespace equidem {
namespace {

constexpr std::int64_t finest = 4096;  // times as many steps as the case has

/// Steps between which the user may interrupt.
constexpr std::int64_t steps_at_once = 1000;

double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    apart = std::max(apart, std::abs(a[k] - b[k]));
    largest = std::max(largest, std::abs(b[k]));
  }
  return apart > 0 ? apart / largest : 0;
}

RefinementOptions step_refinement(const BondedRun& given, double accuracy) {
  if (given.goes_to_rest()) {
    bad_input_at(given.where("run.until_rest"), "--accuracy does not act on a run to rest",
                 "run.until_rest is its accuracy",
                 "Leave it out, or set run.until_rest to the unbalanced force wanted");
  }
  return {.accuracy = accuracy,
          .order = static_cast<double>(given.order()),
          .first = given.steps(),
          .most = finest * given.steps(),
          .unit = "steps",
          .apart = std::numbers::sqrt2,
          .distance = relative_distance};
}

std::vector<double> run_pilot(Case resolved) {
  BondedRun pilot(std::move(resolved));
  Simulation& simulation = pilot.simulation();
  const std::int64_t steps = pilot.steps();
  Progress progress(fmt::format("a run of {} to choose the step:", counted(steps, "step")));
  for (std::int64_t done = 0; done < steps; done += steps_at_once) {
    progress.update(static_cast<double>(done) / static_cast<double>(steps));
    simulation.advance(std::min(steps_at_once, steps - done));
  }
  return StepSearch::values_of(simulation.motions());
}

}  // namespace

StepSearch::StepSearch(const CommonOptions& options, double accuracy, const BondedRun& given)
    : CaseSearch(
          options, step_refinement(given, accuracy),
          [duration = given.run().duration.value_or(0)](std::int64_t steps) {
            return AccuracySetting{{"run.time_step", duration / static_cast<double>(steps)}};
          },
          run_pilot),
      case_step_(given.time_step().step) {}

std::vector<double> StepSearch::values_of(const std::vector<DiscMotion>& motions) {
  std::vector<double> values;
  for (const DiscMotion& motion : motions) values.push_back(motion.u.x), values.push_back(motion.u.y);
  return values;
}

ReachedAccuracy StepSearch::reached() const {
  ReachedAccuracy reached = reached_accuracy(
      "displacements at the end of the run, over the largest of them, against those of a step of 0, extrapolated",
      fmt::format("the time step, {:.6g} s in the case", case_step_), 1);
  std::vector<std::int64_t> before = pilots();
  before.insert(before.end(), proposed().begin(), std::prev(proposed().end()));
  std::vector<std::string> numbers;
  double steps = 0;
  for (const std::int64_t count : before) {
    steps += static_cast<double>(count);
    numbers.push_back(fmt::format("{}", count));
  }
  reached.pilots_factor = steps / static_cast<double>(proposed().back());
  reached.pilots = fmt::format("runs of {} steps", listed(std::move(numbers)));
  return reached;
}

}  // namespace equidem
