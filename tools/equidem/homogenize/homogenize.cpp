// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem homogenize: the stiffness of the continuum that an assembly stands for.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/affine.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/statics/load_bearing.hpp"

#include "command.hpp"
#include "homogenize/ensemble.hpp"
#include "homogenize/homogenized.hpp"
#include "solve/solve_accuracy.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct HomogenizeVerb {
  CommonOptions common;
  bool resume = false;
  std::optional<double> accuracy;
};

/// Discs up to which the bounds that need a solution of their own are found unasked.
constexpr std::size_t most_discs_for_bounds = 20000;

/// Strains of the states that are written, and the names of their files.
constexpr double written_strain = 1e-3;
struct WrittenState {
  const char* suffix;  ///< suffix of the names of its files
  const char* label;
  Tensor2 gradient;
};
constexpr std::array written_states{
    WrittenState{"_strain_xx", "strain xx", {.xx = written_strain}},
    WrittenState{"_strain_yy", "strain yy", {.yy = written_strain}},
    WrittenState{"_strain_xy", "shear strain", {.xy = written_strain / 2, .yx = written_strain / 2}}};

void check_outputs(const CommonOptions& options, const OutputCase& wanted) {
  const OutputPlan plan(options);
  plan.expect_results();
  for (const WrittenState& state : written_states) expect_state(plan, wanted, state.suffix);
}

EffectiveStiffness homogenize_with(const Problem& problem, Boundary boundary) {
  return effective_stiffness(
      problem.assembly, problem.springs.springs,
      {.boundary = boundary, .rotation = problem.resolved.rotation, .solver = problem.resolved.solver});
}

/// A bound by another boundary; or the reason why a sample has none.
StiffnessBeside bound_by(const Problem& problem, Boundary boundary) {
  StiffnessBeside bound{.key = to_string(boundary), .name = to_string(boundary), .stiffness = {}, .missing = {}};
  try {
    bound.stiffness = homogenize_with(problem, boundary).stiffness;
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    bound.missing = error.what();
  }
  return bound;
}

StiffnessBeside estimate(const char* key, const char* name, const Problem& problem,
                         Matrix3 (*of)(const Assembly&, const ContactSprings&)) {
  StiffnessBeside one{.key = key, .name = name, .stiffness = {}, .missing = {}};
  try {
    one.stiffness = of(problem.assembly, problem.springs.springs);
  } catch (const Error& error) {
    one.missing = error.what();
  }
  return one;
}

/// Moduli by the relation of Abe (1996), where the springs stand for an isotropic continuum.
std::optional<RelationBeside> relation_of(const Problem& problem) {
  if (!problem.springs.constants) return {};
  const ChosenRelation chosen = spring_relation(problem.resolved, problem.assembly);
  try {
    const ElasticModuli moduli = moduli_of(*problem.springs.constants, chosen.relation, chosen.measures, Plane::stress);
    return RelationBeside{chosen.relation.name, moduli.bulk_modulus_2d(), moduli.shear_modulus};
  } catch (const Error&) {
    return {};
  }
}

/// The boundaries to solve with, that of the result first.
std::vector<Boundary> boundaries_of(const Problem& problem) {
  const HomogenizeCase& wanted = problem.resolved.homogenize;
  const bool periodic = problem.assembly.periodic();
  std::vector<Boundary> chosen = {wanted.boundary.value_or(periodic ? Boundary::periodic : Boundary::displacement)};
  const bool few = problem.assembly.size() <= most_discs_for_bounds && !problem.springs.springs.any_negative();
  const bool side_by_side = !periodic && !wanted.boundary;
  if (side_by_side || wanted.bounds == BoundsWanted::all || (wanted.bounds == BoundsWanted::automatic && few)) {
    for (const Boundary other : {Boundary::displacement, Boundary::traction})
      if (other != chosen.front()) chosen.push_back(other);
  }
  return chosen;
}

Homogenized homogenize(const Problem& problem) {
  StageTimes times = problem.times;
  const std::vector<Boundary> boundaries = boundaries_of(problem);
  EffectiveStiffness result;
  try {
    result = homogenize_with(problem, boundaries.front());
  } catch (const Error& error) {
    throw problem.resolved.homogenize.boundary ? error.at(problem.resolved.where("homogenize.boundary")) : error;
  }
  for (const auto& [stage, seconds] : result.times.stages()) times.add(stage, seconds);
  Stopwatch watch;
  std::vector<StiffnessBeside> beside;
  for (std::size_t k = 1; k < boundaries.size(); ++k) beside.push_back(bound_by(problem, boundaries[k]));
  beside.push_back(estimate("voigt", "Voigt: all discs follow the strain", problem, voigt_stiffness));
  beside.push_back(
      estimate("uniform_stress_estimate", "uniform stress: an estimate, no bound", problem, uniform_stress_estimate));
  const EffectiveModuli moduli = effective_moduli(result.stiffness);
  const Fabric directions = fabric(problem.assembly);
  times.add("bounds", watch.lap());
  return {problem, std::move(result), moduli, directions, std::move(beside), relation_of(problem), std::move(times)};
}

/// Forces of all contacts in one of the written states: those of the uniform strain and of the fluctuations. Contacts
/// of discs that carry no load have none.
std::vector<ContactForce> state_forces(const Problem& problem, const Tensor2& gradient,
                                       const std::vector<DiscMotion>& fluctuations, const LoadBearingNetwork& bearing) {
  const Assembly& assembly = problem.assembly;
  std::vector<ContactForce> forces = affine_contact_forces(assembly, problem.springs.springs, gradient, 0);
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactDeformation d = deformation(frame_of(assembly, c), fluctuations[contact.i], fluctuations[contact.j]);
    const ContactForce f = linear_spring_force(problem.springs.springs[c], d);
    forces[c].normal += f.normal;
    forces[c].tangential += f.tangential;
  }
  if (!bearing.part) return forces;
  std::vector<ContactForce> carried(forces.size());
  for (const std::int32_t c : bearing.part->contacts) carried[c] = forces[c];
  return carried;
}

void write_states(const CommonOptions& options, const Homogenized& homogenized) {
  const Problem& problem = homogenized.problem;
  const Assembly& assembly = problem.assembly;
  const OutputCase& wanted = problem.resolved.output;
  const LoadBearingNetwork bearing =
      homogenized.result.discs_removed > 0
          ? load_bearing_network(assembly, problem.springs.springs, homogenized.result.effects)
          : LoadBearingNetwork{};
  const bool cells_known =
      !assembly.cell_areas.empty() &&
      std::all_of(assembly.cell_areas.begin(), assembly.cell_areas.end(), [](double v) { return v > 0; });
  for (std::size_t k = 0; k < written_states.size() && k < homogenized.result.fluctuations.size(); ++k) {
    const auto& [suffix, label, gradient] = written_states[k];
    std::vector<DiscMotion> motions = homogenized.result.fluctuations[k];
    for (DiscMotion& motion : motions) motion = {written_strain * motion.u, written_strain * motion.theta};
    const std::vector<ContactForce> forces = state_forces(problem, gradient, motions, bearing);
    const std::vector<Tensor2> stresses = cells_known ? disc_stresses(assembly, forces) : std::vector<Tensor2>{};
    const std::vector<DiscMotion> fluctuations = motions;
    for (std::size_t d = 0; d < motions.size(); ++d) motions[d].u += gradient * assembly.centres[d];
    AssemblyState state{.assembly = assembly, .motions = motions, .contact_forces = forces, .stresses = stresses};
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

int dry_run_homogenization(const CommonOptions& options, const Problem& problem) {
  const std::string names = joined(boundaries_of(problem), [](Boundary boundary) { return to_string(boundary); });
  Results results;
  results.line("mean strain", fmt::format("boundaries {}: one factorization and three solutions for each, every one "
                                          "about as large as this",
                                          names));
  results.set("factorizations", boundaries_of(problem).size());
  deliver(options, "dry_run", dry_run_results(problem, results), problem.times);
  return 0;
}

int homogenize(const HomogenizeVerb& options) {
  const CommonOptions& common = options.common;
  Case resolved = read_case(common);
  refuse_dry_run_with_accuracy(common, options.accuracy.has_value());
  if (options.accuracy && resolved.assembly.kind == AssemblyKind::delaunay) {
    if (options.resume)
      bad_input("--resume and --accuracy exclude each other", "what is sampled follows from the samples",
                "Run it anew");
    return homogenize_to_accuracy(common, resolved, *options.accuracy);
  }
  if (resolved.ensemble) return homogenize_ensemble(common, resolved, options.resume);
  if (options.resume) {
    throw Error(ErrorKind::bad_input, "--resume has nothing to continue", "the case has no [ensemble]",
                "Leave it out, or add [ensemble]");
  }
  check_outputs(common, resolved.output);
  const Problem problem = problem_of(std::move(resolved));
  if (common.dry_run) return dry_run_homogenization(common, problem);

  Homogenized homogenized = homogenize(problem);
  std::optional<ReachedAccuracy> reached;
  if (options.accuracy) {
    const EffectiveStiffness& result = homogenized.result;
    reached = solver_accuracy(*options.accuracy, result.error_bound / largest_entry(result.stiffness), result.condition,
                              homogenized.times.total());
  }
  if (common.out) {
    Stopwatch watch;
    write_states(common, homogenized);
    write_case(common, problem.resolved);
    homogenized.times.add("files", watch.lap());
  }
  Results results = homogenized_results(homogenized);
  results.set("strain_of_states", written_strain);
  if (reached) results.append(accuracy_results(*reached));
  if (common.out && homogenized.result.fluctuations.empty())
    results.line("files", "without states: those are of prescribed strains");
  else if (common.out)
    results.line("files", fmt::format("states are those of strains of {}", written_strain));
  deliver(common, homogenized.status(), results, homogenized.times);
  return 0;
}

}  // namespace

Run declare_homogenize(CLI::App& command) {
  const auto options = std::make_shared<HomogenizeVerb>();
  add_common_options(command, options->common);
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
