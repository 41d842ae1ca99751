// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/calibrate_strengths.hpp"

#include <algorithm>
#include <array>
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
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "problem.hpp"

namespace equidem {
namespace {

/// The second strength beside the tensile one.
struct SecondStrength {
  std::string key, unit, unit_of_ratio;
};

SecondStrength second_of(const StrengthTargets& wanted) {
  if (wanted.compressive) return {"compressive", "Pa", ""};
  return {"toughness", "Pa sqrt(m)", "sqrt(m)"};
}

void add_error(Results& out, const std::string& key, double error, const std::string& unit) {
  std::isfinite(error) ? out.add(key, "+-", error, unit, {.digits = 2}) : out.set(key, nullptr);
}

void add_wanted_strengths(Results& out, const StrengthTargets& wanted) {
  const SecondStrength second = second_of(wanted);
  out.line("wanted")
      .add("target/tensile", "tensile", wanted.tensile, "Pa")
      .add("target/" + second.key, second.key, wanted.second(), second.unit)
      .add("target/strength_ratio", "ratio", wanted.second() / wanted.tensile, second.unit_of_ratio);
}

void add_tests(Results& out, const StrengthTargetCase& target, const StrengthSample& sample,
               const StrengthCalibration& found) {
  const std::string how = fmt::format(
      "ends along {} moved apart{}, {} plates, until the load has fallen to {:g} % of its peak",
      to_string(target.test.axis), target.wanted.compressive ? " and together" : ", without and with notches",
      to_string(target.test.ends), 100 * target.test.fallen_to);
  out.line("tests", how);
  out.line("").add("width", "width", sample.width(), "m").add("tests", "", found.tests, "test", {Shown::count});
  out.add("sample_count", "of", std::ssize(found.samples), "sample", {Shown::count});
  if (found.samples.size() == 1)
    out.line("", "one sample: neither the assembly nor the strengths are random, or one was asked for: no scatter");
}

void add_found_strengths(Results& out, const StrengthCalibration& found, const StrengthTargetCase& target,
                         BondLength length) {
  const std::string unit = length == BondLength::none ? "N/m" : "Pa";
  out.line("contacts").add("contact_strength/tension", "tension", found.tension, unit, {.digits = 9});
  add_error(out, "contact_strength/tension_error", found.tension_error, unit);
  out.line("").add("contact_strength/shear", "shear", found.shear, unit, {.digits = 9});
  add_error(out, "contact_strength/shear_error", found.shear_error, unit);
  out.add("contact_strength/shear_over_tension", "shear over tension", found.shear / found.tension);
  out.line("").add("contact_strength/friction", "friction", found.friction, "", {.digits = 9});
  if (target.shear_over_tension) {
    add_error(out, "contact_strength/friction_error", found.friction_error, "");
  } else {
    out.note(", as given").set("contact_strength/friction_error", found.friction_error);
  }
  if (found.shear / found.tension >= largest_shear_over_tension)
    out.line("", "contacts break in tension alone: any larger strength in shear gives the same");
}

void add_mean(Results& out, const std::string& key, const std::string& name, const MeanEstimate& mean, double wanted,
              const std::string& unit) {
  const std::string place = "achieved/" + key;
  out.line(name).add(place, "", mean.mean, unit, {.digits = 9});
  add_error(out, place + "_error", mean.standard_error, unit + " (standard error)");
  std::isfinite(mean.standard_deviation)
      ? out.add(place + "_deviation", "samples scatter by", mean.standard_deviation, unit, {.digits = 2})
      : out.set(place + "_deviation", nullptr);
  constexpr double rounding = 1e-12;
  const double off = mean.mean / wanted - 1;
  std::abs(off) > rounding ? out.add(place + "_off", "off by", off, "", {Shown::percent})
                           : out.note(", as wanted").set(place + "_off", off);
}

void add_reached_strengths(Results& out, const StrengthTargets& wanted, const StrengthCalibration& found) {
  const SecondStrength second = second_of(wanted);
  add_mean(out, "tensile", "tensile", found.tensile, wanted.tensile, "Pa");
  add_mean(out, second.key, second.key, found.second, wanted.second(), second.unit);
  std::vector<Results> rows;
  for (const TestedSample& one : found.samples) {
    Results row;
    row.add("seed", "seed", static_cast<std::int64_t>(one.seed))
        .add("tensile", "tensile", one.tensile, "Pa")
        .add(second.key, second.key, one.second, second.unit)
        .add("strength_ratio", "ratio", one.second / one.tensile, second.unit_of_ratio, {.digits = 4})
        .add("events", "broken", one.events)
        .add("in_shear", "of them in shear", one.in_shear);
    rows.push_back(std::move(row));
  }
  out.table("samples", std::move(rows));
}

void add_feasible(Results& out, const StrengthTargetCase& target, const StrengthCalibration& found) {
  const SecondStrength second = second_of(target.wanted);
  const std::string unknown = target.shear_over_tension ? "friction" : "shear_over_tension";
  const auto shown = [](double ratio) {
    return std::isfinite(ratio) ? fmt::format("{:.4g}", ratio) : std::string("no bound");
  };
  out.line("feasible ratio", fmt::format("{} over tensile from {} to {}{}, for {} from {:g} to {:g}", second.key,
                                         shown(found.lowest_ratio()), shown(found.highest_ratio()),
                                         second.unit_of_ratio.empty() ? "" : " " + second.unit_of_ratio,
                                         target.shear_over_tension ? "friction" : "shear over tension",
                                         found.tried.front().value, found.tried.back().value));
  out.set("feasible_strength_ratio", std::vector<double>{found.lowest_ratio(), found.highest_ratio()},
          second.unit_of_ratio);
  std::vector<Results> tried;
  for (const TriedValue& one : found.tried)
    tried.push_back(Results().set(unknown, one.value).set("strength_ratio", one.ratio, second.unit_of_ratio));
  out.set("tried", std::move(tried));
}

/// Tells of supports, loads and paths of the case, in whose place the tests stand.
void add_unused(Results& out, const Case& resolved) {
  static constexpr std::array tables{"test", "support", "load", "strain"};
  std::vector<std::string> unused = resolved.headings(tables);
  if (resolved.quasistatic != QuasistaticCase{}) unused.emplace_back("[quasistatic]");
  if (!unused.empty()) out.line("not used", joined(unused) + ": the tests of [strength_target] take their place");
}

/// \param first sample, whose width the report tells
Results strength_results(const Problem& problem, const StrengthSample& first, const StrengthCalibration& found) {
  const Case& resolved = problem.resolved;
  const StrengthTargetCase& target = *resolved.strength_target;
  const StrengthOptions given = resolved.strength.value_or(StrengthOptions{});
  Results out = problem_results(problem, derive_effects(problem.assembly, problem.springs.springs, resolved.rotation));
  add_unused(out, resolved);
  add_wanted_strengths(out, target.wanted);
  add_tests(out, target, first, found);
  add_found_strengths(out, found, target, given.bond_length);
  add_reached_strengths(out, target.wanted, found);
  add_feasible(out, target, found);
  out.line("energy").add("energies/error", "in every test closed to", found.energy_error, "", {Shown::power, 1});
  return out;
}

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
  problem.breaks = true;
  Results results;
  add_unused(results, problem.resolved);
  const std::int64_t tests = 2 * number_of_samples(problem.resolved);
  const int at_once = static_cast<int>(std::min<std::int64_t>(thread_count(), tests));
  deliver(options, "dry_run",
          dry_run_results(problem, results, AssemblyKeys::size, {.inertia = {}, .at_once = at_once}), problem.times);
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

void add_found_file(Results& results, std::vector<OutputPart>& parts, const std::string& noun,
                    const std::optional<std::filesystem::path>& path, const std::string& text) {
  const std::string name = noun + " file", key = noun + "_file";
  if (!path) {
    results.block(fmt::format("\n{} (--{} FILE writes it):\n{}\n", name, noun, text)).set(key, nullptr);
    return;
  }
  results.line(name).add(key, "", path->string());
  const auto write = [place = *path, text](const CommonOptions& into) { write_file(place, text, into.overwrite); };
  parts.push_back({"the " + name, write, OutputPart::file});
}

void add_no_file(Results& results, const std::string& noun, const std::string& why) {
  results.line(noun + " file", "none: " + why).set(noun + "_file", nullptr);
}

Results refusal_results(const Error& refusal) {
  return Results().line("NOT FEASIBLE", refusal.what()).set("refusal", refusal.what());
}

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
  std::optional<Error> refusal, failure;
  const StrengthCalibration found = casefile::with_place(place, [&] {
    try {
      return calibrate_strength(samples, target.wanted,
                                {.strengths = strengths, .shear_over_tension = target.shear_over_tension},
                                [&](double share) { progress.update(share); });
    } catch (const InfeasibleStrengths& infeasible) {
      refusal = infeasible.at(place);
      return infeasible.found();
    } catch (const ErrorWith<StrengthCalibration>& ended) {
      failure = ended.at(place);
      return ended.found();
    }
  });
  problem.times.add("tests", watch.lap());
  const StopsHeldBack held_back(failure);
  strengths.tension = found.tension;
  strengths.shear = found.shear;
  strengths.friction = found.friction;
  const std::string text = text_of_strengths(resolved, found, strengths);
  Results results = strength_results(problem, samples.front().sample, found);
  std::vector<OutputPart> parts{{"case.toml", [&](const CommonOptions& into) { write_case(into, resolved); }}};
  if (refusal) results.append(refusal_results(*refusal));
  if (refusal || failure) {
    add_no_file(results, "strength", "what is above has the nearest ratio that was found");
  } else {
    add_found_file(results, parts, "strength", path, text);
  }
  deliver(options, refusal ? "not_feasible" : "calibrated", std::move(results), problem.times, parts, failure);
  if (refusal) throw *refusal;
  if (path) say(options, fmt::format("strengths written to {}", path->string()));
  return 0;
}

}  // namespace equidem
