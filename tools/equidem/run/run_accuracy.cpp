// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_accuracy.hpp"

#include <algorithm>
#include <cmath>
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

/// x and y in turn.
std::vector<double> displacements(const std::vector<DiscMotion>& motions) {
  std::vector<double> values;
  for (const DiscMotion& motion : motions) values.push_back(motion.u.x), values.push_back(motion.u.y);
  return values;
}

RefinementOptions step_refinement(const BondedRun& given, double accuracy) {
  if (given.goes_to_rest()) {
    throw Error(ErrorKind::bad_input, "--accuracy does not act on a run to rest", "run.until_rest is its accuracy",
                "Leave it out, or set run.until_rest to the unbalanced force wanted", given.where("run.until_rest"));
  }
  return {.accuracy = accuracy,
          .order = static_cast<double>(given.order()),
          .first = given.steps(),
          .most = finest * given.steps(),
          .unit = "steps",
          .apart = std::numbers::sqrt2,
          .distance = relative_distance};
}

}  // namespace

StepSearch::StepSearch(const CommonOptions& options, double accuracy, const BondedRun& given)
    : options_(options),
      accuracy_(accuracy),
      duration_(given.run().duration.value_or(0)),
      case_step_(given.time_step().step),
      search_([this](std::int64_t steps) { return motions_at_end(steps); }, step_refinement(given, accuracy)) {}

Case StepSearch::propose() {
  runs_.push_back(search_.propose());
  return case_of(runs_.back());
}

bool StepSearch::accepts(const std::vector<DiscMotion>& motions, double seconds) {
  seconds_ = seconds;
  return search_.accepts(runs_.back(), displacements(motions));
}

ReachedAccuracy StepSearch::reached() const {
  const std::int64_t steps = runs_.back();
  const bool enough = search_.error(steps) <= accuracy_ / 10;
  const std::int64_t finer = enough ? steps : search_.level_for(accuracy_ / 10, steps);
  std::vector<std::int64_t> others = search_.pilots();
  others.insert(others.end(), runs_.begin(), std::prev(runs_.end()));
  double all = 0;
  std::string list;
  for (std::size_t k = 0; k < others.size(); ++k) {
    all += static_cast<double>(others[k]);
    list += fmt::format("{}{}", k == 0 ? "" : k + 1 < others.size() ? ", " : " and ", others[k]);
  }
  const double factor = static_cast<double>(finer) / static_cast<double>(steps);
  return {
      .requested = accuracy_,
      .estimated = search_.error(steps),
      .of = fmt::format("displacements at the end of the run, over the largest of them, against those of a step of 0, "
                        "extrapolated (errors fall as steps^-{:.2f})",
                        search_.order()),
      .knob = fmt::format("the time step, {:.6g} s in the case", case_step_),
      .value = setting_of(steps),
      .pilots = fmt::format("runs of {} steps", list),
      .pilots_factor = all / static_cast<double>(steps),
      .ten_times_more = {.time_factor = factor,
                         .seconds = factor * seconds_,
                         .value = setting_of(finer),
                         .note = enough ? has_it_already : ""}};
}

Case StepSearch::case_of(std::int64_t steps) const {
  CommonOptions stepped = options_;
  stepped.set.push_back(fmt::format("run.time_step={:.17g}", duration_ / static_cast<double>(steps)));
  return read_case(stepped);
}

std::vector<double> StepSearch::motions_at_end(std::int64_t steps) const {
  BondedRun pilot(case_of(steps));
  Simulation& simulation = pilot.simulation();
  Progress progress(fmt::format("a run of {} to choose the step:", counted(steps, "step")));
  for (std::int64_t done = 0; done < pilot.steps(); done += steps_at_once) {
    progress.update(static_cast<double>(done) / static_cast<double>(pilot.steps()));
    simulation.advance(std::min(steps_at_once, pilot.steps() - done));
  }
  return displacements(simulation.motions());
}

AccuracySetting StepSearch::setting_of(std::int64_t steps) const {
  return {{"run.time_step", duration_ / static_cast<double>(steps)}};
}

}  // namespace equidem
