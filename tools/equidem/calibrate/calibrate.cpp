// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem calibrate: wanted moduli -> springs, wanted strengths -> strengths of contacts.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/assembly/files.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/contact_tables.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "calibrate/calibrate_results.hpp"
#include "calibrate/calibrate_strengths.hpp"
#include "command.hpp"
#include "option_checks.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct CalibrateVerb {
  CommonOptions common;
  std::optional<std::filesystem::path> springs;   ///< path of the springs file
  std::optional<std::filesystem::path> strength;  ///< path of the strength file

  /// The path given, else springs.toml in --out.
  [[nodiscard]] std::optional<std::filesystem::path> springs_path() const {
    if (springs || !common.out) return springs;
    return *common.out / "springs.toml";
  }
};

/// \throws Error (bad_input) where a file cannot be written, or two results go to one file
void check_outputs(const CalibrateVerb& options, const std::string& assembly_name) {
  const CommonOptions& common = options.common;
  const OutputPlan plan(common);
  plan.expect_results();
  plan.expect(assembly_name);
  const auto path = options.springs_path();
  if (!path) return;
  options.springs ? plan.expect_file(*path) : check_writable(*path, common.overwrite);
  namespace fs = std::filesystem;
  std::error_code ignored;
  std::vector<fs::path> others;
  if (common.json && *common.json != "-") others.emplace_back(*common.json);
  if (common.out)
    others.insert(others.end(), {*common.out / "result.json", *common.out / "case.toml", *common.out / assembly_name});
  const auto place = [&](const fs::path& file) { return fs::weakly_canonical(fs::absolute(file), ignored); };
  for (const fs::path& other : others) {
    if (place(other) != place(*path)) continue;
    bad_input(fmt::format("the springs and another result would both be written to '{}'", path->string()),
              "one would replace the other", "Give --springs a file of its own");
  }
}

CalibrateOptions calibrate_options(const Case& resolved) {
  return {.homogenize = {.boundary = resolved.homogenize.boundary.value_or(Boundary::periodic),
                         .rotation = resolved.rotation,
                         .solver = resolved.solver},
          .weighting = resolved.weighting,
          .bond_width = resolved.bending.bond_width,
          .lattice = resolved.assembly.arrangement,
          .static_only = resolved.material->static_only};
}

/// The text of the springs file, with the moduli that it was made for and what shows them.
std::string text_of_springs(const Case& resolved, const Assembly& assembly, const Calibration& found) {
  const ElasticModuli& m = resolved.material->moduli;
  const std::string moduli =
      fmt::format("G = {:.9g} Pa and nu = {:.9g} in plane {}", m.shear_modulus, m.poisson_ratio, to_string(m.plane));
  const std::string discs =
      fmt::format("{} discs of kind {} with {} contacts", assembly.size(), assembly.kind, assembly.contacts.size());
  std::string comment;
  if (!found.verified) {
    comment = fmt::format(
        "Springs that give the infinite lattice {}.\nThe {} they were made for have free edges, and are softer.",
        moduli, discs);
  } else {
    comment =
        fmt::format("Springs that give {}, to a relative error of {:.1e},\non {}", moduli, found.relative_error, discs);
    comment += found.achieved.boundary == Boundary::periodic
                   ? "."
                   : fmt::format(" between boundaries of kind {}.", to_string(found.achieved.boundary));
  }
  return springs_file(found.springs, resolved.weighting, disc_density(resolved, assembly), resolved.bending.bond_width,
                      resolved.title, comment + fmt::format("\nBy equidem calibrate, {}.", found.method));
}

/// The case with springs that are not known yet.
Problem problem_with_material(Case resolved) {
  if (!resolved.material) {
    bad_input_at(resolved.document.where(), "there is no [material]",
                 "calibration looks for the springs that stand for it",
                 "Replace the springs by [material] with the moduli wanted, or add [strength_target]");
  }
  require_memory_for(resolved, Purpose::factorize);
  StageTimes times;
  Stopwatch watch;
  Assembly assembly = assembly_of(resolved);
  times.add("assembly", watch.lap());
  BuiltSprings unknown{ContactSprings(SpringConstants{1e9, 1e9}), {}, "not known yet"};
  return {std::move(resolved), std::move(assembly), std::move(unknown), {}, {}, {}, std::move(times)};
}

int calibrate(const CalibrateVerb& options) {
  const CommonOptions& common = options.common;
  Case read = read_case(common);
  const bool strengths = read.strength_target.has_value();
  if (options.springs && strengths)
    bad_input("--springs asks for springs, and the case for strengths", "[strength_target] takes its springs as given",
              "Leave out --springs; --strength FILE writes the strengths");
  if (options.strength && !strengths)
    bad_input("--strength asks for strengths, and the case for springs", "there is no [strength_target]",
              "Add it, or leave out --strength");
  if (strengths) return calibrate_strengths(common, options.strength, std::move(read));
  const std::string assembly_name = assembly_file_name("assembly", read.output.assembly.value_or(AssemblyFormat::json));
  check_outputs(options, assembly_name);
  const auto lock = lock_out(common);
  Problem problem = problem_with_material(std::move(read));
  const Case& resolved = problem.resolved;
  if (common.dry_run) {
    deliver(common, "dry_run", dry_run_results(problem, {}, AssemblyKeys::size), problem.times);
    return 0;
  }

  const ElasticModuli& wanted = resolved.material->moduli;
  const CalibrateOptions how = calibrate_options(resolved);
  std::optional<Error> refusal;
  const Calibration found = [&] {
    try {
      return calibrate(problem.assembly, wanted, how);
    } catch (const InfeasibleModuli& infeasible) {
      refusal = infeasible.at(resolved.where("material"));
      return infeasible.range();
    }
  }();
  std::vector<OutputPart> parts{{"case.toml", [&] { write_case(common, resolved); }}};
  if (common.out)
    parts.push_back(
        {assembly_name, [&] { write_assembly(*common.out / assembly_name, problem.assembly, common.overwrite); }});
  if (refusal) {
    deliver(common, "not_feasible", feasible_results(problem, found).append(refusal_results(*refusal)), problem.times,
            parts);
    throw *refusal;
  }
  StageTimes times = problem.times;
  times.add(found.times);
  problem.springs = {
      bending_springs(problem.assembly, contact_springs(problem.assembly, found.springs, resolved.weighting),
                      resolved.bending),
      found.springs,
      fmt::format("kN = {:.9g} Pa, kT = {:.9g} Pa (kT/kN = {:.9g}), weighting {}", found.springs.kN, found.springs.kT,
                  found.springs.ratio(), to_string(resolved.weighting))};
  Stopwatch watch;
  const std::optional<MeanFieldGuess> guess = mean_field_guess(problem.assembly, wanted, how);
  times.add("mean field", watch.lap());

  const std::string file = text_of_springs(resolved, problem.assembly, found);
  const auto path = options.springs_path();
  Results results = calibrated_results(problem, found, guess);
  if (path) {
    results.line("springs file").add("springs_file", "", path->string());
  } else {
    results.block("\nsprings file (--springs FILE writes it):\n" + file + "\n").set("springs_file", nullptr);
  }
  if (path) parts.push_back({"the springs file", [&] { write_file(*path, file, common.overwrite); }});
  deliver(common, "calibrated", std::move(results), std::move(times), parts);
  hand_over([kept = resolved](const CommonOptions& into) { write_case(into, kept); });
  if (path) say(common, fmt::format("springs written to {}", path->string()));
  return 0;
}

}  // namespace

Run declare_calibrate(CLI::App& command) {
  const auto options = std::make_shared<CalibrateVerb>();
  add_common_options(command, options->common);
  command.add_option("--springs", options->springs, "write the springs to this file, for springs = \"FILE\"")
      ->check(file_name())
      ->type_name("FILE");
  command.add_option("--strength", options->strength, "write the strengths to this file, for strength = \"FILE\"")
      ->check(file_name())
      ->type_name("FILE");
  command.footer(
      "Examples:\n"
      "  equidem calibrate data/cases/calibrate_strength.toml --strength strength.toml\n"
      "  equidem calibrate data/cases/calibrate_random.toml\n"
      "  equidem calibrate data/cases/calibrate_random.toml --springs springs.toml\n"
      "  equidem calibrate data/cases/calibrate_random.toml --set material.poisson_ratio=0.1 --json -");
  return [options] { return calibrate(*options); };
}

}  // namespace equidem
