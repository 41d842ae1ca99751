// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_setup.hpp"

#include <cmath>
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
  return step;
}

}  // namespace

RunSetup::RunSetup(Case resolved)
    : problem(problem_of(with_run(std::move(resolved)))),
      scene(build_scene(problem.resolved, problem.assembly, problem.springs.springs)),
      step(step_of(problem, scene)),
      options(simulation_options(problem.resolved, step.step)) {}

std::int64_t RunSetup::steps() const {
  if (!run().duration) return 0;
  return std::llround(std::ceil(*run().duration / step.step * (1 - 1e-12)));
}

std::string RunSetup::fingerprint() const {
  Case known = problem.resolved;
  auto& entries = known.document.entries;
  if (TomlValue* table = known.document.find("run")) {
    std::erase_if(table->entries, [](const auto& entry) { return entry.first == "duration"; });
  }
  std::erase_if(entries, [](const auto& entry) { return entry.first == "output" || entry.first == "probe"; });
  return to_toml(known, {}) + format("\n# step {} s\n", toml_number(step.step));
}

}  // namespace equidem
