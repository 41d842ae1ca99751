// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem homogenize: the stiffness of the continuum that an assembly stands for.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/stress.hpp"

#include "accuracy.hpp"
#include "command.hpp"
#include "homogenize/ensemble.hpp"
#include "homogenize/homogenize_results.hpp"
#include "problem.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct HomogenizeVerb {
  CommonOptions common;
  bool resume = false;
  std::optional<double> accuracy;
};

/// Strains of the states that are written, and the names of their files.
constexpr double written_strain = 1e-3;
struct WrittenState {
  const char* suffix;  ///< suffix of the names of its files
  const char* label;
};
constexpr std::array written_states{WrittenState{"_strain_xx", "strain xx"}, WrittenState{"_strain_yy", "strain yy"},
                                    WrittenState{"_strain_xy", "shear strain"}};

void check_outputs(const CommonOptions& options, const Case& resolved) {
  const OutputPlan plan(options);
  const OutputCase& wanted = resolved.output;
  plan.expect_results();
  if (resolved.viscoelastic) {
    plan.expect(viscoelastic_table_name);
    plan.expect_plot(moduli_over_frequency);
  }
  expect_assembly(plan, wanted);
  for (const WrittenState& state : written_states) expect_state(plan, wanted, state.suffix);
}

BoundsOptions bounds_options(const Case& resolved) {
  BoundsOptions options = resolved.homogenize;
  options.rotation = resolved.rotation;
  options.solver = resolved.solver;
  return options;
}

std::optional<RelationBeside> relation_of(const Problem& problem) {
  if (!problem.springs.constants) return {};
  return relation_beside(*problem.springs.constants, spring_relation(problem.resolved, problem.assembly));
}

BoundedStiffness homogenize(const Problem& problem) {
  const Case& resolved = problem.resolved;
  try {
    return bounded_stiffness(problem.assembly, problem.springs.springs, bounds_options(resolved));
  } catch (const Error& error) {
    throw resolved.homogenize.boundary ? error.at(resolved.where("homogenize.boundary")) : error;
  }
}

void write_states(const CommonOptions& options, const OutputCase& wanted, const Problem& problem,
                  const EffectiveStiffness& result) {
  const Assembly& assembly = problem.assembly;
  const bool cells_known = cells_hold_area(assembly);
  const std::vector<StrainedState> states = strained_states(assembly, problem.springs.springs, result, written_strain);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const auto& [gradient, fluctuations, changes, moments] = states[k];
    const std::vector<ContactForce> forces = forces_in_total(problem, changes);
    const auto& [suffix, label] = written_states[k];
    std::vector<DiscMotion> motions = fluctuations;
    for (std::size_t d = 0; d < motions.size(); ++d) motions[d].u += gradient * assembly.centres[d];
    const std::vector<Tensor2> stresses = cells_known ? disc_stresses(assembly, forces) : std::vector<Tensor2>{};
    AssemblyState state{.assembly = assembly,
                        .motions = motions,
                        .contact_forces = forces,
                        .stresses = stresses,
                        .bending_moments = moments};
    write_state(options, wanted, suffix, state);
    // A periodic cell is drawn undeformed but for what repeats with it: its images would have to move along.
    if (assembly.periodic()) state.motions = fluctuations;
    const std::string& title = problem.resolved.title;
    write_state_picture(options, wanted, suffix, state,
                        {.title = fmt::format("{}{}{} = {}{}", title, title.empty() ? "" : ": ", label, written_strain,
                                              assembly.periodic() ? ", discs moved beside the mean strain" : ""),
                         .colour = gradient.xy != 0 ? DiscColour::stress_xy : DiscColour::mean_stress});
  }
}

/// Complex moduli over frequency, where the case has [viscoelastic].
struct Harmonic {
  Viscoelasticity springs;
  ViscoelasticStiffness stiffness;
};

std::optional<Harmonic> harmonic_of(const Problem& problem, Boundary boundary) {
  const Case& resolved = problem.resolved;
  if (!resolved.viscoelastic) return {};
  Harmonic result{build_viscoelasticity(resolved, problem.springs.constants), {}};
  const std::vector<double> frequencies = frequencies_of(resolved, result.springs);
  try {
    result.stiffness =
        viscoelastic_stiffness(problem.assembly, problem.springs.springs, result.springs, frequencies,
                               {.boundary = boundary, .rotation = resolved.rotation, .solver = resolved.solver});
  } catch (const Error& error) {
    throw error.at(resolved.where("viscoelastic"));
  }
  return result;
}

void write_harmonic(const CommonOptions& into, const std::string& title, const ViscoelasticStiffness& result) {
  write_csv(*into.out / viscoelastic_table_name, viscoelastic_table(result), true);
  write_plot(*into.out, moduli_over_frequency, viscoelastic_plot(title, result), true);
}

void refuse_viscoelastic_samples(const Case& resolved, bool accuracy) {
  if (!resolved.viscoelastic || !(resolved.ensemble || accuracy)) return;
  bad_input_at(resolved.where("viscoelastic"), "[viscoelastic] is given beside [ensemble] or --accuracy",
               "both are about the elastic moduli of random cells",
               "Homogenize one large cell, or use 'equidem sweep' over its seeds");
}

/// Another method, where it is asked for, is that of the elastic moduli alone.
void add_solver_of_complex(Results& results, const SolverOptions& asked) {
  if (asked.method == SolverMethod::automatic || asked.method == SolverMethod::umfpack) return;
  results.line("not used", fmt::format("solver.method = \"{}\" for complex moduli: UMFPACK factorizes complex matrices",
                                       to_string(asked.method)));
}

int dry_run_homogenization(const CommonOptions& options, const Problem& problem, std::optional<double> accuracy) {
  const std::vector<Boundary> boundaries =
      boundaries_of(problem.assembly, problem.springs.springs, bounds_options(problem.resolved));
  const std::string names = joined(boundaries, [](Boundary boundary) { return to_string(boundary); });
  Results results;
  results.line("mean strain", fmt::format("boundaries {}: one factorization and three solutions for each, every one "
                                          "about as large as this",
                                          names));
  results.set("factorizations", boundaries.size());
  if (problem.resolved.viscoelastic) {
    const Viscoelasticity springs = build_viscoelasticity(problem.resolved, problem.springs.constants);
    const std::vector<double> frequencies = frequencies_of(problem.resolved, springs);
    results.line("viscoelastic",
                 fmt::format("{} more, each of complex numbers", counted(std::ssize(frequencies), "factorization")));
    add_solver_of_complex(results, problem.resolved.solver);
  }
  if (accuracy) results.append(accuracy_plan(*accuracy, bound_is_compared));
  deliver(options, "dry_run",
          dry_run_results(problem, results, AssemblyKeys::all, problem.resolved.viscoelastic.has_value()),
          problem.times);
  return 0;
}

int homogenize(const HomogenizeVerb& options) {
  const CommonOptions& common = options.common;
  Case resolved = read_case(common);
  refuse_viscoelastic_samples(resolved, options.accuracy.has_value());
  if (options.accuracy && resolved.assembly.random()) {
    if (options.resume)
      bad_input("--resume and --accuracy exclude each other", "what is sampled follows from the samples",
                "Run it anew");
    return homogenize_to_accuracy(common, resolved, *options.accuracy);
  }
  if (resolved.ensemble) return homogenize_ensemble(common, resolved, options.resume);
  if (options.resume)
    bad_input("--resume has nothing to continue", "the case has no [ensemble]", "Leave it out, or add [ensemble]");
  check_outputs(common, resolved);
  const auto lock = lock_out(common);
  if (options.accuracy) resolved.solver.accuracy = std::sqrt(0.1 * *options.accuracy);  // errors of moduli are squares
  const auto shared_problem = std::make_shared<const Problem>(prestressed(problem_of(std::move(resolved))));
  const Problem& problem = *shared_problem;
  if (common.dry_run) return dry_run_homogenization(common, problem, options.accuracy);

  const auto shared_stiffness = std::make_shared<const BoundedStiffness>(homogenize(problem));
  const BoundedStiffness& homogenized = *shared_stiffness;
  const EffectiveStiffness& result = homogenized.result;
  const std::optional<Harmonic> harmonic = harmonic_of(problem, result.boundary);
  StageTimes times = problem.times;
  times.add(result.times);
  if (harmonic) times.add(harmonic->stiffness.times);
  std::optional<ReachedAccuracy> reached;
  if (options.accuracy)
    reached = solver_accuracy(*options.accuracy, result.error_bound / largest_entry(result.stiffness), result.condition,
                              times.total());
  Results results = homogenized_results(problem, homogenized, relation_of(problem));
  results.set("strain_of_states", written_strain);
  if (reached) results.append(accuracy_results(*reached));
  if (harmonic) {
    results.append(viscoelastic_results(harmonic->springs, harmonic->stiffness));
    add_solver_of_complex(results, problem.resolved.solver);
  }
  if (common.out && result.fluctuations.empty())
    results.line("files", "without states: those are of prescribed strains");
  else if (common.out)
    results.line("files", fmt::format("states are those of strains of {}", written_strain));
  std::vector<OutputPart> parts;
  if (common.out) {
    parts.push_back({"case.toml", [&] { write_case(common, problem.resolved); }});
    if (harmonic)
      parts.push_back(
          {viscoelastic_table_name, [&] { write_harmonic(common, problem.resolved.title, harmonic->stiffness); }});
    parts.push_back({"the assembly", [&] { write_assembly(common, problem.resolved.output, problem.assembly); }});
    parts.push_back({"the states", [&] { write_states(common, problem.resolved.output, problem, result); }});
  }
  deliver(common, status_of(result), std::move(results), std::move(times), parts);
  constexpr const char* strains[] = {"xx", "yy", "xy"};
  for (std::size_t k = 0; arrays_wanted() && k < result.fluctuations.size(); ++k)
    hand_over(motion_arrays(fmt::format("fluctuations/{}/", strains[k]), {shared_stiffness, &result.fluctuations[k]}));
  if (arrays_wanted() && harmonic) hand_over(viscoelastic_arrays(harmonic->stiffness));
  hand_over(std::shared_ptr<const Assembly>(shared_problem, &problem.assembly));
  hand_over([shared_problem, shared_stiffness, harmonic](const CommonOptions& into) {
    if (harmonic) write_harmonic(into, shared_problem->resolved.title, harmonic->stiffness);
    write_states(into, pictures_of(shared_problem->resolved.output), *shared_problem, shared_stiffness->result);
    write_case(into, shared_problem->resolved);
  });
  return 0;
}

}  // namespace

Run declare_homogenize(CLI::App& command) {
  const auto options = std::make_shared<HomogenizeVerb>();
  add_common_options(command, options->common);
  add_require_stable(command, options->common);
  command.add_flag("--resume", options->resume, "with [ensemble]: keep the samples in --out, compute the others");
  add_accuracy_option(
      command, options->accuracy,
      "random cells: the size and number that tell the moduli to X;\nelse: fail unless the error is below X");
  command.footer(
      "Examples:\n"
      "  equidem homogenize data/cases/random_cell.toml\n"
      "  equidem homogenize data/cases/random_cell.toml --set effects.rotation=restrained\n"
      "  equidem homogenize data/cases/random_cell.toml --set springs.kT=0.2e9 --out result --json -\n"
      "  equidem homogenize data/cases/random_cell.toml --accuracy 0.01   as many cells as 1 % needs");
  return [options] { return homogenize(*options); };
}

}  // namespace equidem
