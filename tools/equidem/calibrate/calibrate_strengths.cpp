// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/calibrate_strengths.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/calibrate/calibrate_strength.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"

#include "calibrate/calibrate_results.hpp"
#include "problem.hpp"

namespace equidem {
namespace {

/// Samples as asked for; one where neither the assembly nor the strengths are random.
std::int64_t number_of_samples(const Case& resolved) {
  const bool scattered = resolved.strength && resolved.strength->weibull_modulus;
  return resolved.assembly.random() || scattered ? resolved.strength_target->samples : 1;
}

/// The assembly of the k-th sample.
Assembly sample_assembly(Case resolved, std::uint64_t k) {
  resolved.assembly.delaunay.seed += k;
  if (resolved.assembly.packing) resolved.assembly.packing->seed += k;
  return build_assembly(resolved);
}

std::vector<SeededSample> build_samples(const Problem& first) {
  const Case& resolved = first.resolved;
  StrengthTestOptions test = resolved.strength_target->test;
  test.rotation = resolved.rotation;
  test.solver = resolved.solver;
  const std::uint64_t seed = resolved.strength.value_or(StrengthOptions{}).seed;
  std::vector<SeededSample> samples;
  for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(number_of_samples(resolved)); ++k) {
    Assembly assembly = k == 0 || !resolved.assembly.random() ? first.assembly : sample_assembly(first.resolved, k);
    ContactSprings springs = k == 0 ? first.springs.springs : build_springs(resolved, assembly).springs;
    samples.push_back({StrengthSample(std::move(assembly), std::move(springs), test), seed + k});
  }
  return samples;
}

int dry_run_strengths(const CommonOptions& options, Problem& problem) {
  problem.resolved.solver = factor_to_update(problem.resolved.solver);
  Results results;
  add_unused(results, problem.resolved);
  deliver(options, "dry_run", dry_run_results(problem, results, AssemblyKeys::size), problem.times);
  return 0;
}

std::string text_of_strengths(const Case& resolved, const StrengthCalibration& found,
                              const StrengthOptions& strengths) {
  const StrengthTargets& wanted = resolved.strength_target->wanted;
  const std::string second = wanted.compressive ? fmt::format("compressive {:.6g} Pa", *wanted.compressive)
                                                : fmt::format("toughness {:.6g} Pa sqrt(m)", *wanted.toughness);
  return strength_file(
      strengths, resolved.title,
      fmt::format("Strengths of contacts for the strengths tensile {:.6g} Pa and {},\n{} of {}, along {}, {} ends. By "
                  "equidem calibrate.",
                  wanted.tensile, second, found.samples.size() > 1 ? "the means" : "those",
                  counted(std::ssize(found.samples), "sample"), to_string(resolved.strength_target->test.axis),
                  to_string(resolved.strength_target->test.ends)));
}

void check_alone(const Case& resolved) {
  if (resolved.material)
    bad_input_at(resolved.where("strength_target"), "[material] and [strength_target] are both given",
                 "strengths are calibrated for springs that are known",
                 "Calibrate the springs first, with --springs FILE, and take springs = \"FILE\" here");
}

}  // namespace

int calibrate_strengths(const CommonOptions& options, const std::optional<std::filesystem::path>& file, Case read) {
  check_alone(read);
  const OutputPlan plan(options);
  plan.expect_results();
  std::optional<std::filesystem::path> path = file;
  if (path) {
    plan.expect_file(*path);
  } else if (options.out) {
    plan.expect("strength.toml");
    path = *options.out / "strength.toml";
  }
  const auto lock = lock_out(options);
  Problem problem = problem_of(std::move(read));
  const Case& resolved = problem.resolved;
  if (options.dry_run) return dry_run_strengths(options, problem);

  casefile::with_place(resolved.where("springs"), [&] { check_breaking_springs(problem.springs.springs); });
  const std::string place = resolved.where("strength_target");
  Stopwatch watch;
  const std::vector<SeededSample> samples = casefile::with_place(place, [&] { return build_samples(problem); });
  problem.times.add("samples", watch.lap());
  const StrengthTargetCase& target = *resolved.strength_target;
  StrengthOptions strengths = resolved.strength.value_or(StrengthOptions{});
  Progress progress("testing");
  std::optional<Error> refusal;
  const StrengthCalibration found = casefile::with_place(place, [&] {
    try {
      return calibrate_strength(samples, target.wanted,
                                {.strengths = strengths, .shear_over_tension = target.shear_over_tension},
                                [&](double share) { progress.update(share); });
    } catch (const InfeasibleStrengths& infeasible) {
      refusal = infeasible.at(place);
      return infeasible.nearest();
    }
  });
  problem.times.add("tests", watch.lap());
  strengths.tension = found.tension;
  strengths.shear = found.shear;
  strengths.friction = found.friction;
  const std::string text = text_of_strengths(resolved, found, strengths);
  Results results = strength_results(problem, samples.front().sample, found);
  if (refusal) {
    results.append(refusal_results(*refusal));
    results.line("strength file", "none: what is above has the nearest ratio that was found")
        .set("strength_file", nullptr);
    path.reset();
  } else if (path) {
    results.line("strength file").add("strength_file", "", path->string());
  } else {
    results.block("\nstrength file (--strength FILE writes it):\n" + text + "\n").set("strength_file", nullptr);
  }
  std::vector<OutputPart> parts{{"case.toml", [&] { write_case(options, resolved); }}};
  if (path) parts.push_back({"the strength file", [&] { write_file(*path, text, options.overwrite); }});
  deliver(options, refusal ? "not_feasible" : "calibrated", std::move(results), problem.times, parts);
  if (refusal) throw *refusal;
  if (path) say(options, fmt::format("strengths written to {}", path->string()));
  return 0;
}

}  // namespace equidem
