// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/refinement.hpp"

#include "run_setup.hpp"

namespace equidem {
namespace {

constexpr std::int64_t finest = 4096;  // times as many steps as the case has

/// Steps between which the user may interrupt.
constexpr std::int64_t steps_at_once = 1000;

std::string step_key(double duration, std::int64_t steps) {
  return format("run.time_step={:.17g}", duration / static_cast<double>(steps));
}

/// Displacements at the end, x and y in turn.
std::vector<double> motions_at_end(const CommonOptions& options, double duration, std::int64_t steps) {
  CommonOptions stepped = options;
  stepped.set.push_back(step_key(duration, steps));
  const RunSetup setup(read_case(stepped));
  Simulation simulation(setup.simulation());
  Progress progress(format("{}:", counted(steps, "step")));
  for (std::int64_t done = 0; done < setup.steps(); done += steps_at_once) {
    stop_if_interrupted();
    simulation.advance(std::min(steps_at_once, setup.steps() - done));
  }
  std::vector<double> values;
  for (const DiscMotion& motion : simulation.motions()) values.push_back(motion.u.x), values.push_back(motion.u.y);
  return values;
}

double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    apart = std::max(apart, std::abs(a[k] - b[k]));
    largest = std::max(largest, std::abs(b[k]));
  }
  return apart > 0 ? apart / largest : 0;
}

AccuracySetting setting_of(double duration, std::int64_t steps) {
  return {{"run.time_step", duration / static_cast<double>(steps)}};
}

}  // namespace

ReachedAccuracy choose_step(CommonOptions& options, double accuracy) {
  const RunSetup setup(read_case(options));
  const RunCase& run = setup.run();
  if (!run.duration) {
    throw Error(ErrorKind::bad_input, "--accuracy does not act on a run to rest", "run.until_rest is its accuracy",
                "Leave it out, or set run.until_rest to the unbalanced force wanted",
                setup.problem.resolved.where("run.until_rest"));
  }
  const double duration = *run.duration;
  const Damping& damping = run.damping;
  const bool late = damping.stiffness > 0 || damping.contact > 0 || damping.local > 0;
  const int order = late ? order_with_late_velocities : facts_of(run.integrator).order;
  const std::int64_t first = setup.steps();
  std::map<std::int64_t, double> seconds;
  const auto evaluate = [&](std::int64_t steps) {
    Stopwatch watch;
    std::vector<double> motions = motions_at_end(options, duration, steps);
    seconds[steps] = watch.lap();
    return motions;
  };
  const Refinement refined = refine_to(evaluate, {.accuracy = accuracy,
                                                  .order = static_cast<double>(order),
                                                  .first = first,
                                                  .most = finest * first,
                                                  .distance = relative_distance});
  options.set.push_back(step_key(duration, refined.level));
  const std::int64_t finer = refined.level_for(accuracy / 10);
  const double factor = static_cast<double>(finer) / static_cast<double>(refined.level);
  return {
      .requested = accuracy,
      .estimated = refined.estimated,
      .of = format(
          "displacements at the end of the run, over the largest of them, against those of a step of 0, extrapolated "
          "from runs of {} to {} steps (errors fall as steps^-{:.2f})",
          first, *std::max_element(refined.levels.begin(), refined.levels.end()), refined.order),
      .knob = format("the time step, {:.6g} s in the case", setup.step.step),
      .value = setting_of(duration, refined.level),
      .ten_times_more = {.time_factor = factor,
                         .seconds = factor * seconds.at(refined.level),
                         .value = setting_of(duration, finer),
                         .note = {}}};
}

}  // namespace equidem
