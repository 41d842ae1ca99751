// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_setup.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "equidem/casefile/assembly/build_run.hpp"
#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/checkpoint.hpp"

#include "run/run_case_text.hpp"

namespace equidem {
namespace {

/// Line of the fingerprint: "# step 1e-06 s, rule lanczos".
constexpr std::string_view step_line = "\n# step ", step_rule = " s, rule ";

Case with_run(Case resolved) {
  if (!resolved.run) {
    throw Error(ErrorKind::bad_input, "the case has no [run]",
                "a run needs its duration, or to be told to come to rest", "Add [run] with duration or until_rest",
                resolved.document.where());
  }
  return resolved;
}

TimeStep step_of(Problem& problem, const Scene& scene, const std::optional<KeptStep>& kept) {
  const RunCase& run = *problem.resolved.run;
  Stopwatch watch;
  TimeStepOptions wanted = run.time_step;
  wanted.duration = run.duration.value_or(0);
  TimeStep step;
  if (run.until_rest) {  // inertia and steps of its own
    step.step = 1;
    return step;
  }
  if (kept && !wanted.step) wanted.step = kept->step;
  try {
    step = choose_time_step(scene, simulation_options(problem.resolved, 1), wanted);
  } catch (const Error& error) {
    throw error.at(problem.resolved.where(run.time_step.step ? "run.time_step" : "run"));
  }
  problem.times.add("time step", watch.lap());
  if (!wanted.step) step.step = std::min(step.step, wanted.duration);
  if (kept && step.step == kept->step) {
    step.rule = kept->rule;
    step.notes.emplace_back("The step is that of the checkpoint.");
  }
  return step;
}

/// Schedules that change faster than the steps can resolve.
void check_events(const Case& resolved, TimeStep& step) {
  constexpr double share_to_mention = 0.05;
  const double end = resolved.run->duration.value_or(0);
  const auto check = [&](const Schedule& schedule, const char* table, std::size_t k) {
    const MissedEvent missed =
        check_event(schedule, step.step, end, resolved.where(fmt::format("{}.{}.schedule", table, k)));
    if (missed.share > share_to_mention) {
      step.notes.push_back(fmt::format("Of the schedule of {} {} steps miss up to {:.0f} % of its range, at {:.6g} s.",
                                       table, k, 100 * missed.share, missed.time));
    }
  };
  const RunCase& run = *resolved.run;
  for (std::size_t k = 0; k < run.supports.size(); ++k) {
    const TimedSupport& support = run.supports[k];
    for (const auto* motion : {&support.ux, &support.uy, &support.rotation})
      if (*motion) check(**motion, "support", k);
  }
  for (std::size_t k = 0; k < run.loads.size(); ++k) check(run.loads[k].factor, "load", k);
  for (std::size_t k = 0; k < run.walls.size(); ++k)
    for (const Schedule* motion : {&run.walls[k].move_x, &run.walls[k].move_y}) check(*motion, "wall", k);
}

/// Tells whether files that a case names are still what they were.
std::string checksum_of(const Assembly& assembly) {
  Checksum sum;
  for (const Vec2 centre : assembly.centres) sum.add(centre.x), sum.add(centre.y);
  sum.add(assembly.radii);
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
      if (*motion) add(sum, **motion);
  for (const TimedLoad& load : scene.loads) add(sum, load.factor);
  for (const Wall& wall : scene.walls) add(sum, wall.move_x), add(sum, wall.move_y);
  return sum.text();
}

/// In what order keys stand does not matter.
void sort_keys(TomlValue& value) {
  std::ranges::stable_sort(value.entries, {}, [](const auto& entry) -> const std::string& { return entry.first; });
  for (auto& [name, entry] : value.entries) sort_keys(entry);
  for (TomlValue& item : value.items) sort_keys(item);
}

}  // namespace

KeptStep kept_step(const std::filesystem::path& checkpoint) {
  const std::string text = case_of_checkpoint(checkpoint);
  KeptStep kept;
  const std::size_t at = text.rfind(step_line);
  if (at != std::string::npos) {
    const char* begin = text.data() + at + step_line.size();
    const auto [end, failed] = std::from_chars(begin, text.data() + text.size(), kept.step);
    const std::string_view rest(end, text.data() + text.size());
    if (failed == std::errc() && rest.starts_with(step_rule)) {
      kept.rule = rest.substr(step_rule.size(), rest.find('\n') - step_rule.size());
      return kept;
    }
  }
  bad_input(fmt::format("cannot go on from '{}'", checkpoint.string()), "its case does not name the time step",
            "Start the run afresh");
}

RunSetup::RunSetup(Case resolved, const std::optional<KeptStep>& kept)
    : problem(problem_of(with_run(std::move(resolved)))),
      scene(build_scene(problem.resolved, problem.assembly, problem.springs.springs)),
      step(step_of(problem, scene, kept)),
      options(simulation_options(problem.resolved, step.step)) {
  if (!run().until_rest) check_events(problem.resolved, step);
}

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
  bad_input(fmt::format("{:.3g} s in steps of {:.3g} s are {:.3g} steps", *run().duration, step.step, steps),
            fmt::format("no run makes more than {:.0e}", most), "Shorten the duration, or take a longer step");
}

std::string RunSetup::fingerprint() const {
  Case known = problem.resolved;
  if (TomlValue* table = known.document.find("run")) {
    erase_keys(*table, {"duration", "time_step", "allow_unstable_step"});  // the step is below
  }
  erase_keys(known.document, {"title", "output", "homogenize", "ensemble", "solver"});
  sort_keys(known.document);
  return to_toml(known, {}) +
         fmt::format("{}{}{}{}\n# checksums: discs and contacts {}\n# springs {}\n# schedules {}\n", step_line,
                     toml_number(step.step), step_rule, step.rule, checksum_of(problem.assembly),
                     checksum_of(problem.assembly, problem.springs.springs), checksum_of_schedules(scene));
}

}  // namespace equidem
