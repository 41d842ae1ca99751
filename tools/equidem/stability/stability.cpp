// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem stability: mechanisms, inertia, waves, critical kT/kN, natural frequencies and time step.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/waves/extreme_eigenvalues.hpp"
#include "equidem/waves/natural_frequencies.hpp"

#include "command.hpp"
#include "option_checks.hpp"
#include "problem.hpp"
#include "stability/stability_results.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct StabilityCommand : CommonOptions {
  int frequencies = StabilityOptions{}.natural_frequencies;
};

/// The density of the discs, or 1.
StabilityOptions options_of(const Problem& problem, const StabilityCommand& command) {
  const Case& resolved = problem.resolved;
  return {.rotation = resolved.rotation,
          .density = disc_density(resolved, problem.assembly).value_or(1),
          .body = resolved.assembly.body,
          .solver = resolved.solver,
          .natural_frequencies = command.frequencies};
}

/// Whether the contacts also carry what the loads and the motions of supports of the case cause: where prestress is
/// asked for.
/// \throws Error (bad_input) where there are several load cases: stability is that of one state
bool acts_on_rest(const Problem& problem) {
  if (problem.resolved.prestress != PrestressChoice::on) return false;
  const auto moves = [](const Support& support) {
    return support.ux.value_or(0) != 0 || support.uy.value_or(0) != 0 || support.rotation.value_or(0) != 0;
  };
  const auto& load_cases = problem.load_cases;
  const bool acts = std::ranges::any_of(load_cases, [](const NamedLoads& each) { return !each.loads.empty(); }) ||
                    (!load_cases.empty() && std::ranges::any_of(problem.supports, moves));
  if (acts && load_cases.size() > 1)
    bad_input_at(problem.resolved.where("load"), "there are several load cases, and prestress is asked for",
                 "stability is that of one state", "Keep the loads of one");
  return acts;
}

/// To first order, as in Euler's load, that is at the places of before the loads.
Problem under_loads(Problem problem) {
  if (!acts_on_rest(problem)) return problem;
  Assembly& assembly = problem.assembly;
  const Equilibrium loaded = solve_equilibrium(assembly, problem.springs.springs, problem.supports,
                                               problem.load_cases.front().loads, problem.options());
  assembly.contact_normal_force.resize(assembly.contacts.size());
  assembly.contact_tangential_force.resize(assembly.contacts.size());
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    assembly.contact_normal_force[c] += loaded.contact_forces[c].normal;
    assembly.contact_tangential_force[c] += loaded.contact_forces[c].tangential;
  }
  problem.times.add("loads", loaded.times.total());
  return problem;
}

/// Names of files of the mode that is lost at the critical load end like this.
constexpr const char* buckling_suffix = "_buckling";

void draw_mode(const CommonOptions& options, const Problem& problem, const Stability& result) {
  if (!result.critical_load || result.critical_load->motion.empty()) return;
  const auto [left, right] = std::ranges::minmax(problem.assembly.centres, {}, &Vec2::x);
  const auto [low, high] = std::ranges::minmax(problem.assembly.centres, {}, &Vec2::y);
  constexpr double visible = 0.1;  // of the larger side; a mode has no size of its own
  const std::string& title = problem.resolved.title;
  write_state_picture(options, pictures_of(problem.resolved.output), buckling_suffix,
                      {.assembly = problem.assembly, .motions = result.critical_load->motion},
                      {.title = fmt::format("{}{}buckles at {:.6g} times the forces at rest", title,
                                            title.empty() ? "" : ": ", result.critical_load->factor),
                       .undeformed = true,
                       .displacement_scale = visible * std::max(right.x - left.x, high.y - low.y)});
}

/// Loads and motions that make a prestress are not solved for.
int dry_run_survey(const StabilityCommand& options, Problem given) {
  const bool acted_on = acts_on_rest(given);
  const Problem problem =
      acted_on && !carries_forces(given.assembly) ? std::move(given) : prestressed(std::move(given));

  const Assembly& assembly = problem.assembly;
  const ContactSprings& springs = problem.springs.springs;
  const Effects effects = derive_effects(assembly, springs, problem.resolved.rotation);
  Results results;
  if (acted_on) results.line("forces at rest", "those of the loads and motions of the case count: one more solution");
  results.line("waves").set("waves", Results());
  if (assembly.periodic()) {
    const PrimitiveCell cell = primitive_cell(assembly, springs);
    results.set("waves/primitive_cell_discs", cell.size());
    if (cell.size() <= most_discs_of_survey) {
      results.add("waves/wave_vectors", "about", survey_size(cell), "wave vectors of a cell of")
          .note(" " + counted(static_cast<long long>(cell.size()), "disc"));
    } else {
      results.note(
          fmt::format("none: the smallest cell has {} discs, more than {}", cell.size(), most_discs_of_survey));
    }
  } else {
    results.note("none: the assembly is not periodic");
  }
  const StabilityOptions judged = options_of(problem, options);
  const bool assumed = !disc_density(problem.resolved, assembly);
  const auto inertia = inertia_of(assembly, judged.density, judged.body);
  check_magnitudes(assembly, springs, inertia);
  results.line("time step")
      .add("element_bound_time_step", "", 2 / std::sqrt(element_bound(assembly, springs, inertia, effects.rotation)),
           "s is guaranteed to be stable (element bound)")
      .note(assumed ? "; density 1 kg/m³ assumed" : "");
  results.set("density_assumed", assumed);
  deliver(options, "dry_run",
          dry_run_results(problem, results, AssemblyKeys::size, false, vectors_of_frequencies(options.frequencies)),
          problem.times);
  return 0;
}

int stability(const StabilityCommand& options) {
  Case resolved = read_case(options);
  const OutputPlan plan(options);
  plan.expect_results();
  expect_survey(plan);
  expect_state(plan, pictures_of(resolved.output), buckling_suffix);
  const auto lock = lock_out(options);
  // Nothing needs to act: an assembly without supports is judged as a free body or a periodic cell.
  Problem built = acts(resolved) ? build_problem(std::move(resolved)) : problem_of(std::move(resolved));
  if (options.dry_run) return dry_run_survey(options, std::move(built));
  const auto shared_problem = std::make_shared<const Problem>(prestressed(under_loads(std::move(built))));
  const Problem& problem = *shared_problem;
  const auto shared_result = std::make_shared<const Stability>(
      analyze_stability(problem.assembly, problem.springs.springs, problem.supports, options_of(problem, options)));
  const Stability& result = *shared_result;
  StageTimes times = problem.times;
  times.add(result.times);
  std::vector<OutputPart> parts;
  if (options.out) {
    parts.push_back({"case.toml", [&] { write_case(options, problem.resolved); }});
    parts.push_back(
        {"the waves", [&] { write_survey(*options.out, problem.resolved.title, result, options.overwrite); }});
    parts.push_back({"the mode", [&] { draw_mode(options, problem, result); }});
  }
  deliver(options, result.status(), stability_results(problem, result), std::move(times), parts);
  if (arrays_wanted() && result.critical_load && !result.critical_load->motion.empty())
    hand_over(motion_arrays("buckling/", {shared_result, &result.critical_load->motion}));
  if (arrays_wanted() && result.survey) hand_over(dispersion_arrays(*result.survey));
  for (std::size_t k = 0; arrays_wanted() && k < result.natural.motions.size(); ++k) {
    const std::shared_ptr<const std::vector<DiscMotion>> mode(shared_result, &result.natural.motions[k]);
    hand_over(motion_arrays(fmt::format("modes/{}/", k), mode));
  }
  hand_over(std::shared_ptr<const Assembly>(shared_problem, &problem.assembly));
  hand_over([shared_problem, shared_result](const CommonOptions& into) {
    write_survey(*into.out, shared_problem->resolved.title, *shared_result, into.overwrite);
    draw_mode(into, *shared_problem, *shared_result);
    write_case(into, shared_problem->resolved);
  });
  return 0;
}

}  // namespace

Run declare_stability(CLI::App& command) {
  const auto options = std::make_shared<StabilityCommand>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  command.add_option("--frequencies", options->frequencies, "number of the lowest natural frequencies; 0: none")
      ->check(whole_number(0, 50))
      ->capture_default_str()
      ->type_name("N");
  command.footer(
      "A periodic assembly needs neither supports nor loads; a free one is judged with its [[support]]\n"
      "or [test], or as a free body.\n"
      "Examples:\n"
      "  equidem stability data/cases/abe1996_fig6.toml         free edges: stable down to kT/kN = -0.2650\n"
      "  equidem stability data/cases/column.toml --set effects.prestress=on   the load at which a column buckles\n"
      "  equidem stability sample.toml --frequencies 10         the ten lowest natural frequencies\n"
      "  equidem stability cell.toml --out waves                dispersion, critical kT/kN over the zone\n"
      "  equidem stability cell.toml --set springs.kT=-0.1e9    stable in statics, but not in motion");
  return [options] { return stability(*options); };
}

}  // namespace equidem
