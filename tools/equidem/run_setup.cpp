// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_setup.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "equidem/casefile/build_run.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

Case with_run(Case resolved) {
  if (!resolved.run) {
    throw Error(ErrorKind::bad_input, "the case has no [run]",
                "a run needs its duration, or to be told to come to rest", "Add [run] with duration or until_rest",
                resolved.document.where());
  }
  return resolved;
}

Problem problem_of(Case resolved) {
  StageTimes times;
  Stopwatch watch;
  Assembly assembly = build_assembly(resolved);
  times.add("assembly", watch.lap());
  BuiltSprings springs = build_springs(resolved, assembly);
  times.add("springs", watch.lap());
  return {.resolved = std::move(resolved),
          .assembly = std::move(assembly),
          .springs = std::move(springs),
          .tension = {},
          .supports = {},
          .load_cases = {},
          .times = std::move(times)};
}

TimeStep step_of(Problem& problem, const Scene& scene) {
  const RunCase& run = *problem.resolved.run;
  Stopwatch watch;
  // A run to rest takes inertia and steps of its own.
  TimeStepOptions wanted = run.time_step;
  wanted.duration = run.duration.value_or(0);
  TimeStep step;
  if (run.until_rest) {
    step.step = 1;
    return step;
  }
  try {
    step = choose_time_step(scene, simulation_options(problem.resolved, 1), wanted);
  } catch (const Error& error) {
    throw error.at(problem.resolved.where(wanted.step ? "run.time_step" : "run"));
  }
  problem.times.add("time step", watch.lap());
  if (!wanted.step) step.step = std::min(step.step, wanted.duration);
  return step;
}

/// Tells whether files that a case names are still what they were: FNV-1a, 64 bits at a time, the upper ones folded
/// down.
class Checksum {
 public:
  void add(std::uint64_t value) {
    sum_ = (sum_ ^ value) * 0x100000001b3U;
    sum_ ^= sum_ >> 32U;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Schedule& schedule) {
    for (const auto* values : {&schedule.times, &schedule.values})
      for (const double value : *values) add(value);
  }
  [[nodiscard]] std::string text() const { return format("{:016x}", sum_); }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325U;
};

std::string checksum_of(const Assembly& assembly) {
  Checksum sum;
  for (const Vec2 centre : assembly.centres) sum.add(centre.x), sum.add(centre.y);
  for (const double radius : assembly.radii) sum.add(radius);
  for (const Contact& contact : assembly.contacts) {
    for (const std::int32_t number : {contact.i, contact.j, contact.shift_x, contact.shift_y})
      sum.add(static_cast<std::uint64_t>(number));
    sum.add(contact.lever_i), sum.add(contact.lever_j);
  }
  return sum.text();
}

std::string checksum_of(const Assembly& assembly, const ContactSprings& springs) {
  Checksum sum;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) sum.add(springs[c].kN), sum.add(springs[c].kT);
  return sum.text();
}

std::string checksum_of_schedules(const Scene& scene) {
  Checksum sum;
  for (const TimedSupport& support : scene.supports)
    for (const auto* motion : {&support.ux, &support.uy, &support.rotation})
      if (*motion) sum.add(**motion);
  for (const TimedLoad& load : scene.loads) sum.add(load.factor);
  for (const Wall& wall : scene.walls) sum.add(wall.displacement);
  return sum.text();
}

void erase(TomlValue& table, std::initializer_list<std::string_view> names) {
  std::erase_if(table.entries,
                [&](const auto& entry) { return std::find(names.begin(), names.end(), entry.first) != names.end(); });
}

}  // namespace

RunSetup::RunSetup(Case resolved)
    : problem(problem_of(with_run(std::move(resolved)))),
      scene(build_scene(problem.resolved, problem.assembly, problem.springs.springs)),
      step(step_of(problem, scene)),
      options(simulation_options(problem.resolved, step.step)) {}

Simulation RunSetup::simulation() const {
  try {
    return {scene, options};
  } catch (const Error& error) {
    throw error.at(problem.resolved.where("run"));
  }
}

std::int64_t RunSetup::steps() const {
  if (!run().duration) return 0;
  constexpr double most = 1e15;  // years of stepping, and every number below is exact in a double
  const double steps = std::ceil(*run().duration / step.step * (1 - 1e-12));
  if (steps <= most) return std::llround(steps);
  bad_input(format("{:.3g} s in steps of {:.3g} s are {:.3g} steps", *run().duration, step.step, steps),
            format("no run makes more than {:.0e}", most), "Shorten the duration, or take a longer step");
}

std::string RunSetup::fingerprint() const {
  Case known = problem.resolved;
  if (TomlValue* table = known.document.find("run")) {
    erase(*table, {"duration", "time_step", "step_rule", "step_fraction", "allow_unstable_step"});  // the step is below
  }
  erase(known.document, {"title", "output", "probe", "homogenize", "ensemble", "solver"});
  return to_toml(known, {}) +
         format("\n# step {} s\n# checksums: discs and contacts {}\n# springs {}\n# schedules {}\n",
                toml_number(step.step), checksum_of(problem.assembly),
                checksum_of(problem.assembly, problem.springs.springs), checksum_of_schedules(scene));
}

}  // namespace equidem
