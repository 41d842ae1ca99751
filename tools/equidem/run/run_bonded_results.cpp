// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

#include "run/run_bonded.hpp"

namespace equidem {
namespace {

constexpr double balance_to_mention = 1e-3;  // of the largest energy

/// Keys of the case that have no effect on a run to rest.
std::string unused_at_rest(const RunCase& run, const OutputCase& output) {
  std::vector<std::string> names;
  const auto name = [&](bool given, const char* key) {
    if (given) names.emplace_back(key);
  };
  name(run.time_step.step.has_value(), "time_step");
  name(run.integrator != Integrator::leapfrog, "integrator");
  name(run.damping.mass > 0 || run.damping.acts_late(), "[run.damping]");
  name(!run.velocities.empty(), "[[velocity]]");
  name(output.frame_interval.has_value(), "frame_interval");
  name(!run.probes.empty() || output.probe_interval, "[[probe]]");
  return joined(names);
}

bool any_schedule(const Scene& scene) {
  const auto changes = [](const std::optional<Schedule>& motion) { return motion && motion->changes(); };
  return std::ranges::any_of(
             scene.supports,
             [&](const TimedSupport& s) { return changes(s.ux) || changes(s.uy) || changes(s.rotation); }) ||
         std::ranges::any_of(scene.loads, [](const TimedLoad& load) { return load.factor.changes(); }) ||
         std::ranges::any_of(scene.walls, [](const Wall& wall) { return wall.moves(); });
}

}  // namespace

int BondedRun::order() const {
  return order_of(options_);
}

Results BondedRun::scene() const {
  const RunCase& run = this->run();
  const bool small = run.motion == LoopKind::Motion::small;
  Results out = problem_results(problem_, simulation_.effects(), AssemblyKeys::size);
  if (const auto& springs = problem_.springs.constants) out.set("springs/ratio", springs->ratio());
  out.line("motions")
      .add("motion", "", small ? "small" : "finite")
      .note(small ? ": normals and contact points fixed, the forces are those of the matrix K"
                  : ": normals and contact points follow the bodies");
  if (run.until_rest) {
    const std::string unused = unused_at_rest(run, problem_.resolved.output);
    if (!unused.empty()) out.line("not used", unused + ": a run to rest has steps of its own and no time");
    if (any_schedule(scene_))
      out.line("schedules", "as they are at t = 0: a run to rest has no time, and starts from there");
    return out;
  }
  const IntegrationScheme& scheme = scheme_of(run.integrator);
  return out.line("integrator")
      .add("integrator", "", to_string(run.integrator))
      .add("", "order", order())
      .note(order() < scheme.order ? " (dampers act half a step late)"
            : order() > 2 && !scene_.walls.empty()
                ? " (2 over steps in which a disc touches or leaves a wall: its force has a kink)"
                : "")
      .add("", "", scheme.force_evaluations, "force evaluation", {Shown::count})
      .note(" a step");
}

Results BondedRun::step() const {
  Results out;
  out.line("time step").add("time_step", "", step_.step, "s");
  if (std::isinf(step_.critical)) {
    out.note("; nothing vibrates, any step is stable");
    out.set("critical_time_step", step_.critical).set("time_step_ratio", step_.ratio());
    out.set("time_step_rule", step_.rule);
  } else {
    out.add("time_step_ratio", "", step_.ratio(), step_.exact ? "of the critical step" : "of the guaranteed step",
            {.digits = 4})
        .note(" ")
        .add("critical_time_step", "", step_.critical, "s")
        .note(" (")
        .add("time_step_rule", "rule:", step_.rule)
        .note(")");
  }
  out.set("critical_time_step_exact", step_.exact).set("omega_max", step_.omega_max);
  for (const std::string& note : step_.notes) out.line("", note);
  return out;
}

Results BondedRun::advice(const Balance& balance) const {
  Results out;
  if (balance.most > balance_to_mention) {
    // The work of what drives a run is counted to the second order.
    const bool driven = !scene_.loads.empty() || !scene_.supports.empty() || !scene_.walls.empty();
    const int order = std::min(scheme_of(run().integrator).order, driven ? 2 : 4);
    out.line("",
             fmt::format("it falls as the step to the power {}: about {:g} with run.time_step={:.2g}", order,
                         balance_to_mention, step_.step * std::pow(balance_to_mention / balance.most, 1.0 / order)));
  }
  if (balance.most > Balance::doubtful)
    out.line("", "that is much: compare with a shorter step before trusting the motion");
  return out;
}

}  // namespace equidem
