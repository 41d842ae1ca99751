// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem solve: equilibrium under supports and loads, or Abe's tension test.
#include "solve/solve.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/core/text.hpp"
#include "equidem/homogenize/measured_derivatives.hpp"
#include "equidem/homogenize/stress.hpp"

#include "accuracy.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

/// The stability of the equilibrium, by the inertia of K.
std::string stability(const Problem& problem, const Equilibrium& result) {
  if (!result.unstable_modes) return stability_not_known;
  if (result.unstable_modes > 0)
    return fmt::format(
        "UNSTABLE: {} beyond one for each rotation; the assembly is unstable in so many modes, this "
        "equilibrium is no state of rest",
        counted(*result.unstable_modes, "negative pivot"));
  if (!result.negative_pivots) return "stable: no spring is negative";
  if (result.negative_pivots == 0) return "stable: no negative pivot";
  return fmt::format("stable: {}, one for each rotation{}", counted(*result.negative_pivots, "negative pivot"),
                     problem.springs.springs.any_negative() ? " (kT < 0; static-only)" : "");
}

void add_stress(Results& out, const SolvedCase& result) {
  out.line("stress");
  if (!result.stress) {
    out.note("not known: the assembly has no cell areas");
    return;
  }
  if (result.empty_cells) {
    out.note("discs: not known, because the power cell of at least one disc has no area");
    out.line("");
  }
  const Tensor2& s = *result.stress;
  // The forces that add up to the stress may cancel, and are as right as the solution.
  const Equilibrium& e = result.equilibrium;
  const double round_off = 1e-9 * result.stress_scale;
  const double error = std::max(e.error_bound, e.relative_residual) * result.stress_scale;
  const double found = std::abs(asymmetry(s));
  const bool symmetric = found <= std::max(round_off, error);
  out.set("stress", voigt_stress(s)).set("stress_tensor", s);
  out.add("", "", symmetric ? ResultValue(voigt_stress(s)) : ResultValue(s), "Pa", {Shown::components});
  out.note(", mean over the assembly");
  if (symmetric) {
    out.set("stress_asymmetry", asymmetry(s)).set("moment_per_area", result.moment_per_area);
    if (found <= round_off || result.moment_per_area == 0) return;  // without a moment the rest is error
    out.line("", fmt::format("whether it is symmetric is not known: xy - yx = {:.2g} Pa, and the error of the solution "
                             "may make {:.2g} Pa of it",
                             asymmetry(s), error));
    return;
  }
  out.line("", "not symmetric: ")
      .add("stress_asymmetry", "xy - yx =", asymmetry(s), "Pa (Abe 1996, eq. 55)")
      .note(". The moments that restrained rotation, supports and loads put on the discs are ")
      .add("moment_per_area", "", result.moment_per_area, "N m per m²");
}

/// Theory of the tension test on a lattice of equal springs; none for other assemblies and springs.
std::optional<TensionTheory> tension_theory(const Problem& problem) {
  if (!problem.tension || !problem.springs.constants || !problem.springs.springs.uniform()) return {};
  const Lattice* lattice = problem.resolved.assembly.arrangement;
  if (lattice == nullptr || lattice->tension == nullptr) return {};
  return lattice->tension(problem.springs.constants->ratio());
}

/// The factorization, which all load cases share.
Results solver_results(const Problem& problem, const Equilibrium& e) {
  Results out;
  out.line("unknowns").add("unknowns", "", e.unknowns, "", {Shown::count});
  out.line("solver").add("solver", "", e.solver);
  if (e.iterations > 0) {
    out.add("iterations", "", e.iterations, "iteration", {Shown::count}).set("factor_nonzeros", e.factor_nonzeros);
  } else {
    out.add("factor_nonzeros", "", e.factor_nonzeros, "entries in the factor", {.digits = 3});
  }
  out.add("factor_bytes", "", e.factor_bytes, "", {Shown::bytes});
  if (e.mechanisms > 0) {
    out.line("mechanisms")
        .add("mechanisms", "", e.mechanisms, "motion", {Shown::count})
        .note(fmt::format(" without energy, on which no load does work: {}{}", e.first_mechanism,
                          e.mechanisms > 1 ? "; ..." : ""));
  } else {
    out.set("mechanisms", e.mechanisms);
  }
  out.line("stability", stability(problem, e));
  if (e.unstable_modes > 0) out.warn();
  out.set("negative_pivots", e.negative_pivots).set("unstable_modes", e.unstable_modes);
  return out.set("pivot_growth", e.pivot_growth);
}

Results load_case_results(const Problem& problem, const SolvedCase& result, bool show_solver,
                          std::span<const SpringDependent> by_springs) {
  const Equilibrium& e = result.equilibrium;
  const Results solver = solver_results(problem, e);
  Results out = show_solver ? solver : solver.hidden();
  if (!result.name.empty()) out.set("case", result.name).block(fmt::format("\nload case {}\n", result.name));
  out.line("residual")
      .add("relative_residual", "", e.relative_residual, "relative", {Shown::power, 1})
      .add("refinements", "after", e.refinements, "step", {Shown::count})
      .note(" of refinement; ")
      .add("rounded_residual", "", e.rounded_residual, "for the motions rounded to double", {Shown::power, 1});
  if (e.condition > 0) {
    out.line("error bound")
        .add("error_bound", "", e.error_bound, "of the motions", {Shown::power, 1})
        .add("condition", "from the residual and a condition of about", e.condition, "", {Shown::power, 1});
  } else if (e.error_bound > 0) {
    out.line("error")
        .add("error_bound", "", e.error_bound, "of the motions in the norm of energy", {Shown::power, 1})
        .note(", estimated from the iterations");
  }
  constexpr double doubtful = 1e-10;
  if (e.condition > 0 && e.relative_residual > doubtful)
    out.warning("", "WARNING: K is nearly singular; do not trust more digits than the residual leaves");
  add_deformation(out, result.deformation, true);
  out.line("energy").add("energy", "", e.energy, "N (J per m of depth, per m)");
  add_stress(out, result);
  if (result.tension) out.append(tension_results(problem, *result.tension));
  if (!by_springs.empty())
    out.append(spring_effects(problem, by_springs,
                              problem.tension
                                  ? "changes of the moduli (plane stress)"
                                  : "changes of mean displacements of groups and of the stress, over their sizes"));
  return out;
}

}  // namespace

void add_deformation(Results& out, const LargestDeformation& deformation, bool small_motions) {
  constexpr double large = 0.05, doubtful = 1e-9;
  const auto& [most, largest_radius] = deformation;
  out.line("deformation")
      .add("largest_deformation", "contacts change by at most", most, "of the sum of their radii", {.digits = 3});
  if (most > large && small_motions) {
    out.note(": much, for the motions are taken as small");
  } else if (most > 0 && most < doubtful) {
    out.note(fmt::format(
        ": very little. Radii (up to {:.3g} m), springs (Pa) and loads (N/m, Pa) may be in other units than meant",
        largest_radius));
    out.warn();
  }
}

Results tension_results(const Problem& problem, const TensionResult& t) {
  Results out;
  const TensionSetup& setup = *problem.tension;
  const auto theory = tension_theory(problem);
  const TomlValue& test = *problem.resolved.document.find("test");
  const auto discs = [](const StrainGauge& gauge) { return std::vector<std::int64_t>{gauge.first, gauge.second}; };
  out.line("tension test")
      .add("", "s11 =", t.stress.xx, "Pa")
      .add("height", "height", setup.height, "m")
      .note(fmt::format(", gauge \"{}\": discs {}-{} along x, {}-{} along y", test.find("gauge")->text,
                        setup.horizontal.first, setup.horizontal.second, setup.vertical.first, setup.vertical.second));
  out.set("gauge/placement", to_string(problem.resolved.test->gauge));
  out.set("gauge/horizontal", discs(setup.horizontal)).set("gauge/vertical", discs(setup.vertical));
  out.set("strain", t.strain).set("stress", t.stress).set("displacement_gradient", t.fitted_gradient);
  out.line("  strain")
      .add("", "e11 =", t.strain.xx, "", {.digits = 9})
      .add("", "e22 =", t.strain.yy, "", {.digits = 9});
  const auto compare = [&](const std::string& key, const std::string& name, double value, double expected) {
    out.line("  " + name).add(key, "", value, "", {.digits = 9});
    if (!theory) return;
    out.add("theory/" + key, "theory", expected, "", {.digits = 9})
        .add("", "difference", value - expected, "", {Shown::power, 2});
  };
  compare("poisson_ratio", "nu, (35)", t.poisson_ratio, theory ? theory->poisson_ratio : 0);
  compare("stiffness_ratio", "2G/((1-nu)kN)", t.stiffness_ratio, theory ? theory->stiffness_ratio : 0);
  // e11 = s11/E in plane stress, (1 - nu²) s11/E in plane strain
  const double nu = t.poisson_ratio, fitted = t.fitted_poisson_ratio, young = t.stress.xx / t.strain.xx;
  out.line("  plane strain")
      .add("plane_strain/poisson_ratio", "nu =", nu, "", {.digits = 9})
      .add("plane_strain/young_modulus", "E =", (1 - nu * nu) * young, "Pa", {.digits = 9});
  out.line("  plane stress")
      .add("plane_stress/poisson_ratio", "nu =", nu / (1 - nu), "", {.digits = 9})
      .add("plane_stress/young_modulus", "E =", young, "Pa", {.digits = 9});
  out.line("  whole field")
      .add("fitted_poisson_ratio", "nu =", t.fitted_poisson_ratio, "", {.digits = 9})
      .add("fitted_young_modulus", "E =", (1 - fitted * fitted) * t.stress.xx / t.fitted_gradient.xx, "Pa",
           {.digits = 9})
      .note(" in plane strain, fitted to the inner half of the block");
  return out;
}

Results solve_results(const Problem& problem, Results out, std::span<const SolvedCase> results,
                      std::span<const std::vector<SpringDependent>> by_springs) {
  const Case& resolved = problem.resolved;
  if (resolved.run || !resolved.schedules.empty()) {
    out.line("not used",
             "what belongs to a run: schedules (loads and supports act in full), gravity, walls, velocities, damping");
  }
  const auto of_case = [&](std::size_t k) {
    return load_case_results(problem, results[k], k == 0,
                             k < by_springs.size() ? by_springs[k] : std::span<const SpringDependent>{});
  };
  if (results.size() == 1 && results.front().name.empty()) return out.append(of_case(0));
  std::vector<Results> cases;
  for (std::size_t k = 0; k < results.size(); ++k) cases.push_back(of_case(k));
  return out.list("load_cases", std::move(cases));
}

namespace {

/// End of the names of the files of a load case.
std::string suffix_of(const std::string& load_case) {
  return load_case.empty() ? "" : "_" + load_case;
}

struct SolveCommand : CommonOptions {
  std::optional<double> accuracy;
  bool sensitivities = false;
};

struct Solution {
  std::optional<Problem> problem = {};
  std::vector<SolvedCase> cases = {};
  std::vector<std::vector<SpringDependent>> by_springs = {};  ///< of each case, where asked for
};

/// E and nu of the tension test, else displacements of loaded groups and the stress.
/// \throws Error (bad_input) where the state is unstable or nothing is measured
std::vector<SpringDependent> measured_by_springs(const Problem& problem, EquilibriumSolver& solver,
                                                 const NamedLoads& loads, const Equilibrium& state) {
  if (state.unstable_modes.value_or(0) > 0)
    bad_input("derivatives are asked for, and the equilibrium is unstable", "it is no state of rest",
              "Choose springs at which it is stable");
  std::vector<SpringDependent> numbers;
  const auto add = [&](MeasuredNumber& number, const std::string& key, const std::string& heading, const char* unit) {
    numbers.push_back({std::move(static_cast<SpringDerivatives&>(number)), number.symbol, key, heading, unit,
                       number.scale, false, problem.tension.has_value()});
  };
  if (problem.tension) {
    auto measured = tension_derivatives(solver, state, *problem.resolved.test, *problem.tension);
    add(measured[0], "young_modulus", "dE/E", "Pa");
    add(measured[1], "poisson_ratio", "dnu", "");
    return numbers;
  }
  for (MeasuredNumber& number : displacement_derivatives(solver, state, loads.loads))
    add(number, "displacement/" + number.symbol, "d " + number.symbol, "m");
  for (MeasuredNumber& number : stress_derivatives(solver, state))
    add(number, "stress/" + number.symbol.substr(number.symbol.size() - 2), "d " + number.symbol, "Pa");
  if (numbers.empty())
    bad_input("derivatives are asked for, and nothing is measured",
              "no load acts on a group that can move, and the stress is not known without cell areas",
              "Load a group, with a force of 0 too, or give the discs cells");
  return numbers;
}

void write_state_of(const CommonOptions& options, const Problem& problem, const LoadCase& loads,
                    const SolvedCase& result) {
  const OutputCase& wanted = problem.resolved.output;
  const std::vector<ContactForce> forces =
      forces_in_total(problem.assembly, problem.springs.springs, result.equilibrium.contact_forces);
  std::vector<Tensor2> stresses;
  if (cells_hold_area(problem.assembly)) stresses = disc_stresses(problem.assembly, forces);
  const AssemblyState state{.assembly = problem.assembly,
                            .motions = result.equilibrium.motions,
                            .contact_forces = forces,
                            .stresses = stresses,
                            .bending_moments = result.equilibrium.bending_moments};
  write_state(options, wanted, suffix_of(result.name), state);
  PictureOptions picture{.title = problem.resolved.title};
  picture.loads = drawn_loads(problem.assembly, loads);
  picture.supports = drawn_supports(problem.assembly, problem.supports);
  if (problem.tension) {
    const auto& [a, b] = problem.tension->horizontal;
    const auto& [c, d] = problem.tension->vertical;
    picture.gauges = {{a, b, "A", "B"}, {c, d, "C", "D"}};
  }
  write_state_picture(options, wanted, suffix_of(result.name), state, picture);
}

std::vector<OutputPart> output_parts(const Case& resolved, const std::shared_ptr<const Solution>& solution,
                                     bool sensitivities) {
  std::vector<OutputPart> parts{
      case_part([=]() -> const Case& { return solution->problem->resolved; }),
      assembly_part(resolved.output, [=]() -> const Assembly& { return solution->problem->assembly; })};
  for (std::size_t k = 0; k < resolved.load_cases.size(); ++k) {
    const auto write = [=](const CommonOptions& into) {
      const auto& [problem, cases, by_springs] = *solution;
      if (k < cases.size()) write_state_of(into, *problem, problem->load_cases[k].loads, cases[k]);
    };
    parts.push_back(
        {"the state", write, OutputPart::page, state_names(resolved.output, suffix_of(resolved.load_cases[k].name))});
    if (!sensitivities) continue;
    const auto write_table = [=](const CommonOptions& into) {
      if (k < solution->by_springs.size())
        write_sensitivities(into, *solution->problem, solution->by_springs[k], suffix_of(solution->cases[k].name));
    };
    const std::vector<std::string> pictures =
        resolved.test ? std::vector<std::string>{"E", "nu"} : std::vector<std::string>{};
    parts.push_back({sensitivities_name, write_table, OutputPart::page,
                     files_of_sensitivities(resolved.output, pictures, suffix_of(resolved.load_cases[k].name))});
  }
  return parts;
}

constexpr const char* plan_of_blocks =
    "blocks from 9 rows on are solved until their errors give the size that reaches it, at most 1e6 discs; below is "
    "the block of the case";

constexpr double most_discs_of_block = 1e6;
constexpr double work_per_rows = 2.4;  // time of a plane block of n x n discs as n^2.4, a little above that of n²

std::int64_t one_beyond_a_multiple_of_four(double n) {
  return 4 * std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil((n - 1) / 4 - 1e-9))) + 1;
}

std::vector<double> searched_values(const TensionResult& result) {
  return {result.poisson_ratio, std::log(std::abs(result.stiffness_ratio))};
}

std::vector<double> solve_block(Case resolved) {
  const Problem problem = prestressed(build_problem(std::move(resolved)));
  EquilibriumSolver solver(problem.assembly, problem.springs.springs, problem.supports, problem.options());
  return searched_values(*solve_case(problem, solver, problem.load_cases.front()).tension);
}

/// A tension test of a lattice misses the lattice without sides by about one over its rows. Finds the rows and columns,
/// in the proportion of the case, for which nu, and the stiffness ratio (36) relative to itself, are within the
/// accuracy. Sides of whole fours and one disc: gauges then sit alike in all.
/// \param resolved a tension test of a lattice
SearchedSetting searched_block(const Case& resolved, double accuracy) {
  const auto& [columns, rows] = std::tie(resolved.assembly.lattice.columns, resolved.assembly.lattice.rows);
  const double aspect = static_cast<double>(columns) / rows;
  return {.refinement = {.accuracy = accuracy,
                         .order = 1,
                         .first = one_beyond_a_multiple_of_four(std::max(9.0, 9 / aspect)),
                         .most = one_beyond_a_multiple_of_four(std::sqrt(most_discs_of_block / aspect)) - 4,
                         .unit = "rows",
                         .admissible =
                             [](std::int64_t n) { return one_beyond_a_multiple_of_four(static_cast<double>(n)); }},
          .setting_of =
              [aspect](std::int64_t n) {
                const auto wide = one_beyond_a_multiple_of_four(std::round(aspect * static_cast<double>(n)));
                return AccuracySetting{{"assembly.rows", static_cast<double>(n)},
                                       {"assembly.columns", static_cast<double>(wide)}};
              },
          .values_of = solve_block,
          .of = "nu, and 2G/((1-nu)kN) relative, of this block against the lattice without sides, extrapolated",
          .knob = fmt::format("the size of the block, {} x {} in the case", columns, rows),
          .work_exponent = work_per_rows};
}

ReachedAccuracy reached_by_block(const CaseSearch& search) {
  ReachedAccuracy reached = search.reached();
  const auto [fewest, most] = std::ranges::minmax(search.pilots());
  reached.pilots = fmt::format("{} of {} to {} rows", counted(std::ssize(search.before()), "block"), fewest, most);
  reached.pilots_factor = search.seconds_before();
  auto& more = reached.ten_times_more;
  if (const double rows = more.value[0].second, columns = more.value[1].second; rows * columns > most_discs_of_block) {
    more.note = fmt::format(
        "{} x {} discs, more than are tried; a periodic cell has no sides: 'equidem homogenize' gives both to "
        "round-off",
        columns, rows);
  }
  return reached;
}

/// Solves and delivers; false, and nothing delivered, where the block that the search proposed is too small.
bool solve_once(const SolveCommand& options, const std::vector<OutputPart>& parts,
                const std::shared_ptr<Solution>& solution, CaseSearch* search) {
  const std::optional<double>& accuracy = options.accuracy;
  const Problem& problem = *solution->problem;
  EquilibriumOptions solver_options = problem.options();
  solver_options.error_bound = true;
  if (accuracy && search == nullptr) solver_options.solver.accuracy = 0.5 * *accuracy;
  solver_options.solver.right_hand_sides = static_cast<int>(problem.load_cases.size());
  std::vector<SolvedCase>& results = solution->cases;
  results.clear();
  std::vector<std::vector<SpringDependent>>& by_springs = solution->by_springs;
  Effects effects;
  std::optional<Error> failure, refused;
  double of_derivatives = 0;  // s
  {                           // the factorization is not needed beyond the load cases
    EquilibriumSolver solver(problem.assembly, problem.springs.springs, problem.supports, solver_options);
    for (const NamedLoads& loads : problem.load_cases) {
      failure = failure_of([&] { results.push_back(solve_case(problem, solver, loads)); });
      if (failure && results.empty()) throw Error(*failure);
      if (!failure && options.sensitivities && search == nullptr && by_springs.size() + 1 == results.size()) {
        const Stopwatch watch;
        refused = failure_of(
            [&] { by_springs.push_back(measured_by_springs(problem, solver, loads, results.back().equilibrium)); });
        of_derivatives += watch.seconds();
      }
      if (!failure) continue;
      failure =
          failure->because(fmt::format("{} of {} load cases are done", results.size(), problem.load_cases.size()));
      break;
    }
    effects = solver.effects();
  }
  if (!failure) failure = refused;
  const StopsHeldBack held_back(failure);

  StageTimes times = problem.times;
  for (const SolvedCase& result : results) {
    const bool first = &result == &results.front();  // all load cases share one factorization
    for (const auto& [stage, seconds] : result.equilibrium.times.stages()) {
      if (first || stage == "solve" || stage == "refine") times.add(stage, seconds);
    }
  }
  if (options.sensitivities) times.add("sensitivities", of_derivatives);
  std::optional<ReachedAccuracy> reached;
  if (search != nullptr) {
    if (!search->accepts(searched_values(*results.front().tension), times.total())) return false;
    reached = reached_by_block(*search);
  } else if (accuracy) {
    const auto bound = [](const SolvedCase& result) { return result.equilibrium.error_bound; };
    const Equilibrium& worst = std::ranges::max_element(results, {}, bound)->equilibrium;
    reached = solver_accuracy(*accuracy, worst.error_bound, worst.condition, times.total());
  }
  Results all = solve_results(problem, problem_results(problem, effects), results, by_springs);
  if (reached) all.append(accuracy_results(*reached));
  deliver(options, status_of(results.front().equilibrium.unstable_modes), std::move(all), std::move(times), parts,
          failure);
  if (!arrays_wanted()) return true;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const std::string prefix = results[k].name.empty() ? "" : results[k].name + "/";
    hand_over(state_arrays(prefix, std::shared_ptr<const Equilibrium>(solution, &results[k].equilibrium)));
    if (k < by_springs.size()) hand_over(sensitivity_arrays(by_springs[k], prefix));
  }
  hand_over(std::shared_ptr<const Assembly>(solution, &problem.assembly));
  return true;
}

void solve(const SolveCommand& options) {
  const std::optional<double>& accuracy = options.accuracy;
  Case resolved = read_case(options);
  const auto solution = std::make_shared<Solution>();
  const std::vector<OutputPart> parts = output_parts(resolved, solution, options.sensitivities);
  expect_results(options, parts);
  const auto lock = lock_out(options);
  const auto build = [&](Case wanted) { solution->problem.emplace(prestressed(build_problem(std::move(wanted)))); };
  const bool searched = accuracy && resolved.test && resolved.assembly.arrangement != nullptr;
  if (searched && options.sensitivities)
    bad_input("--sensitivities is given beside the --accuracy of a lattice", "it is about the contacts of one block",
              "Leave one of them out");
  if (searched && !options.dry_run) {
    CaseSearch search(options, searched_block(resolved, *accuracy));
    do {
      build(search.propose());
    } while (!solve_once(options, parts, solution, &search));
    return;
  }
  build(std::move(resolved));
  if (!options.dry_run) {
    solve_once(options, parts, solution, nullptr);
    return;
  }
  const Problem& problem = *solution->problem;
  Results further;
  if (accuracy) further = accuracy_plan(*accuracy, searched ? plan_of_blocks : bound_is_compared);
  const double picture = bytes_of_state_picture(options, problem.resolved.output, problem.assembly);
  constexpr double of_stress = 3, of_group = 2;  // numbers with derivatives, at most
  double numbers = 0;
  for (const NamedLoads& each : problem.load_cases)
    numbers += of_stress + of_group * static_cast<double>(each.loads.size());
  dry_run(options, problem, further, AssemblyKeys::all,
          {.bytes_of_disc = options.sensitivities ? bytes_of_sensitivities(problem, numbers) : 0,
           .bytes_of_picture = picture});
}

}  // namespace

Run declare_solve(CLI::App& command) {
  const auto options = std::make_shared<SolveCommand>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  add_accuracy_option(
      command, options->accuracy,
      "tension test of a lattice: the size that tells nu to X;\nelse: fail unless the error is below X");
  command.add_flag("--sensitivities", options->sensitivities,
                   "derivatives by the springs of each contact: of the moduli of a\ntension test, else of mean "
                   "displacements of loaded groups and the\nstress; sensitivities.csv in --out");
  return [options] { return solve(*options); };
}

}  // namespace equidem
