// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem sweep: solve over a range of one key.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/plots/plot.hpp"

#include "command.hpp"
#include "option_checks.hpp"
#include "problem.hpp"
#include "sweep/sweep_table.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct SweepOptions {
  CommonOptions common;
  std::string key;
  std::optional<double> from, to;
  int steps = 11;
  std::vector<std::string> values;   ///< "a,b,c"
  std::string verb;                  ///< no longer taken
  std::optional<std::string> title;  ///< of the curves
  bool resume = false;
};

std::vector<double> values_of(const SweepOptions& options) {
  const bool range = options.from && options.to;
  if (range == !options.values.empty() || options.from.has_value() != options.to.has_value())
    bad_input(
        options.values.empty() ? "the sweep is given no values" : "the sweep is given a list of values and a range",
        "it takes either one", "Give --values a,b,c or --from A --to B --steps N");
  std::vector<double> values;
  for (const std::string& list : options.values) {
    for (const std::string_view part : parts_of(list, ',')) {
      const std::optional<double> value = number_from<double>(part);
      if (!value || !std::isfinite(*value))
        bad_input_at("--values",
                     part.empty() ? fmt::format("a value is missing in '{}'", list)
                                  : fmt::format("'{}' is among the values", part),
                     "a sweep needs finite numbers", "Leave it out, or correct it");
      values.push_back(*value);
    }
  }
  const int intervals = options.steps - 1;
  for (int k = 0; range && k < options.steps; ++k) {
    const double value =
        intervals == 0 ? *options.from : (*options.from * (intervals - k) + *options.to * k) / intervals;
    // The decimal number that is meant, 0.3 and not 0.30000000000000004; and a spring that is absent, not one
    // that is almost absent.
    const double rounding = 1e-13 * std::max(std::abs(*options.from), std::abs(*options.to));
    values.push_back(std::abs(value) <= rounding ? 0 : std::stod(fmt::format("{:.12g}", value)));
    if (!std::isfinite(values.back()))
      bad_input("the values from --from to --to overflow", "a sweep needs finite numbers", "Give smaller ones");
  }
  return values;
}

/// The override that a value of the key means. "ratio" stands for kT/kN at the kN of the case.
std::string override_of(const SweepOptions& options, const Case& base, double value) {
  if (options.key != "ratio") {
    const TomlValue& now = value_at(base.document, options.key);
    const bool whole = now.type == TomlValue::Type::integer && value == std::floor(value) && std::abs(value) < 1e15;
    return fmt::format("{}={}", options.key, whole ? fmt::format("{:.0f}", value) : toml_number(value));
  }
  return fmt::format("springs={{kN = {}, kT = {}, weighting = \"{}\"}}", toml_number(base.springs->kN),
                     toml_number(value * base.springs->kN), to_string(base.weighting));
}

/// Builds the assembly once where the key does not change it.
class ProblemFactory {
 public:
  explicit ProblemFactory(const SweepOptions& options)
      : reusable_(std::ranges::none_of(std::array{"assembly.", "group.", "packing.", "settling."},
                                       [&](const char* table) { return options.key.starts_with(table); })) {}

  std::unique_ptr<Problem> operator()(Case resolved) {
    std::optional<Assembly> given;
    if (reusable_ && last_) given = *last_;
    auto problem = std::make_unique<Problem>(build_problem(std::move(resolved), std::move(given)));
    if (reusable_ && !last_ && problem->left_out.bodies.empty()) last_ = problem->assembly;
    return problem;
  }

 private:
  bool reusable_;
  std::optional<Assembly> last_;
};

std::unique_ptr<Problem> problem_of(const SweepOptions& options, const Case& base, double value,
                                    ProblemFactory& build) {
  CommonOptions common = options.common;
  common.set.push_back(override_of(options, base, value));
  return build(read_case(common));
}

SweepPoint compute(const SweepOptions& options, const Case& base, double value, ProblemFactory& build, Effects& effects,
                   StageTimes& times) {
  SweepPoint point;
  point.value = value;
  try {
    const auto problem = problem_of(options, base, value, build);
    if (problem->load_cases.size() > 1)
      bad_input("the case has several load cases", "a sweep shows one", "Leave one [[load]] case in the file");
    const EquilibriumSolver solver(problem->assembly, problem->springs.springs, problem->supports, problem->options());
    const SolvedCase result = solve_case(*problem, solver, problem->load_cases.front());
    effects = solver.effects();
    times.add(problem->times);
    times.add(result.equilibrium.times);
    point.status = result.status();
    point.energy = result.equilibrium.energy;
    point.relative_residual = result.equilibrium.relative_residual;
    point.negative_pivots = static_cast<double>(result.equilibrium.negative_pivots);
    point.unstable_modes = static_cast<double>(result.equilibrium.unstable_modes);
    if (result.tension) {
      point.poisson_ratio = result.tension->poisson_ratio;
      point.stiffness_ratio = result.tension->stiffness_ratio;
    }
    if (const auto theory = tension_theory(*problem)) {
      point.theory_poisson_ratio = theory->poisson_ratio;
      point.theory_stiffness_ratio = theory->stiffness_ratio;
    }
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    point.status = "failed";
    point.message = error.what();
  }
  return point;
}

constexpr const char* table_name = "sweep.csv";
constexpr std::array curve_names{"poisson_ratio", "stiffness_ratio"};

std::string axis_label(const std::string& key) {
  return key == "ratio" ? "k_T/k_N" : literal(key);
}

/// The user's own, or what is varied.
std::string title_of(const SweepOptions& options, const Case& base) {
  if (options.title) return literal(*options.title);
  return base.title.empty() ? axis_label(options.key) + " varied" : literal(base.title);
}

std::string plot_curves(const SweepOptions& options, const Case& base, const std::vector<SweepPoint>& points,
                        bool overwrite) {
  struct Curve {
    const char* name;
    const char* label;
    double SweepPoint::*computed;
    double SweepPoint::*theory;
  };
  const std::array curves{
      Curve{curve_names[0], "Poisson's ratio ν (plane strain)", &SweepPoint::poisson_ratio,
            &SweepPoint::theory_poisson_ratio},
      Curve{curve_names[1], "2G/((1 - ν) k_N)", &SweepPoint::stiffness_ratio, &SweepPoint::theory_stiffness_ratio}};
  std::vector<SweepPoint> ordered = points;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const SweepPoint& a, const SweepPoint& b) { return a.value < b.value; });
  std::string said;
  for (const Curve& curve : curves) {
    Series theory{.label = "theory of the lattice", .x = {}, .y = {}, .column = "theory"};
    Series stable{.label = "computed",
                  .x = {},
                  .y = {},
                  .style = SeriesStyle::points,
                  .colour = PlotColour::blue,
                  .column = "computed"};
    Series unstable{.label = "computed, unstable or not judged",
                    .x = {},
                    .y = {},
                    .style = SeriesStyle::points,
                    .colour = PlotColour::vermilion,
                    .filled = false,
                    .column = "unstable"};
    for (const SweepPoint& point : ordered) {
      if (!std::isnan(point.*curve.theory)) {
        theory.x.push_back(point.value);
        theory.y.push_back(point.*curve.theory);
      }
      if (std::isnan(point.*curve.computed)) continue;
      Series& series = point.unstable_modes != 0 ? unstable : stable;
      series.x.push_back(point.value);
      series.y.push_back(point.*curve.computed);
    }
    Plot plot{.title = title_of(options, base),
              .x = {.label = axis_label(options.key)},
              .y = {.label = curve.label},
              .enhanced = true};
    for (const Series* series : {&theory, &stable, &unstable})
      if (!series->x.empty()) plot.series.push_back(*series);
    if (stable.x.empty() && unstable.x.empty()) continue;
    said += write_plot(*options.common.out, curve.name, plot, overwrite).message + "\n";
  }
  return said;
}

/// Points of an earlier run of the same sweep.
std::vector<SweepPoint> points_to_keep(const SweepOptions& options, const Case& base) {
  if (!options.resume) return {};
  if (!options.common.out)
    bad_input("--resume has nothing to continue", "the points done lie in the folder of --out", "Add --out DIR");
  const auto table = *options.common.out / table_name;
  if (!std::filesystem::exists(table)) return {};
  if (read_file(*options.common.out / "case.toml") != to_toml(base, *options.common.out)) {
    bad_input_at((*options.common.out / "case.toml").string(), "the sweep there is of another case",
                 "its points would not fit together",
                 "Choose another --out, or leave out --resume and pass --overwrite");
  }
  return read_sweep_points(table, options.key);
}

void check_outputs(const SweepOptions& options) {
  CommonOptions common = options.common;
  common.overwrite = common.overwrite || options.resume;
  const OutputPlan plan(common);
  for (const char* name : {table_name, "case.toml", "result.json"}) plan.expect(name);
  for (const char* name : curve_names) plan.expect_plot(name);
  OutputPlan(options.common).expect_json();
}

/// The points of this run, then those of an earlier one that it has not come to.
std::vector<SweepPoint> merged(std::vector<SweepPoint> points, const std::vector<SweepPoint>& kept) {
  const std::size_t own = points.size();
  for (const SweepPoint& point : kept) {
    const auto same = [&](const SweepPoint& other) { return other.value == point.value; };
    if (std::none_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(own), same)) points.push_back(point);
  }
  return points;
}

/// The key exists and the sweep can begin.
void check_key(const SweepOptions& options, const Case& base, double first) {
  if (options.key == "ratio") {
    if (!base.springs)
      bad_input("--key ratio needs springs", "it changes kT at the kN of the case file",
                "Give [springs] in place of [material]");
    return;
  }
  if (is_case_key(options.key)) return;
  CommonOptions common = options.common;
  common.set.push_back(fmt::format("{}={}", options.key, toml_number(first)));
  static_cast<void>(read_case(common));
}

int dry_run(const SweepOptions& options, const Case& base, const std::vector<double>& values) {
  const Problem problem = build_problem(base);
  Results results;
  results.block(
      fmt::format("{} of {}, each about as large as this one:\n\n", counted(std::ssize(values), "point"), options.key));
  results.append(dry_run_results(problem, static_cast<double>(values.size())))
      .set("key", options.key)
      .set("values", values);
  deliver(options.common, "dry_run", results, problem.times);
  return 0;
}

/// The state of a sweep at its end or where it was stopped.
struct Progressed {
  std::vector<SweepPoint> points;  ///< of this run
  bool stopped = false;            ///< by the user, before the last value
  Effects effects;                 ///< of the last point
  StageTimes times;                ///< of all points
};

void write_points(const SweepOptions& options, const std::vector<SweepPoint>& points) {
  write_samples(*options.common.out / table_name, sweep_table(options.key, points));
}

/// Compute the points that are not kept, and save the table every second: whatever ends the program, little is lost.
Progressed compute_points(const SweepOptions& options, const Case& base, const std::vector<double>& values,
                          const std::vector<SweepPoint>& kept) {
  Progressed run;
  ProblemFactory build(options);
  Stopwatch since_saved;
  try {
    Progress progress(fmt::format("sweeping {}", options.key));
    for (std::size_t k = 0; k < values.size(); ++k) {
      progress.update(static_cast<double>(k) / static_cast<double>(values.size()));
      const auto done = std::find_if(kept.begin(), kept.end(), [&](const SweepPoint& point) {
        return point.value == values[k] && point.status != "failed";
      });
      run.points.push_back(done != kept.end() ? *done
                                              : compute(options, base, values[k], build, run.effects, run.times));
      if (done != kept.end() && k + 1 == values.size()) {
        const auto problem = problem_of(options, base, values[k], build);
        run.effects = derive_effects(problem->assembly, problem->springs.springs, problem->resolved.rotation);
      }
      if (!options.common.out || since_saved.seconds() < 1) continue;
      write_points(options, merged(run.points, kept));
      since_saved.lap();
    }
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    run.stopped = true;
  }
  return run;
}

int sweep(const SweepOptions& options) {
  if (!options.verb.empty()) bad_input("'equidem sweep' takes no --verb", "a sweep solves", "Leave it out");
  const std::vector<double> values = values_of(options);
  const Case base = read_case(options.common);
  check_key(options, base, values.front());
  check_outputs(options);
  if (options.common.dry_run) return dry_run(options, base, values);
  const auto lock = lock_out(options.common);
  const std::vector<SweepPoint> kept = points_to_keep(options, base);

  const auto& folder = options.common.out;
  if (folder) write_file(*folder / "case.toml", to_toml(base, *folder), true);
  Progressed run = compute_points(options, base, values, kept);
  const std::size_t done = run.points.size();
  const std::vector<SweepPoint> points = merged(std::move(run.points), kept);
  const auto failed = static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [](const SweepPoint& point) { return point.status == "failed"; }));
  const bool all_failed = failed == points.size();

  Results results;
  if (!base.title.empty()) results.block(base.title + "\n\n");
  results.set("key", options.key).set("complete", !run.stopped).table("points", sweep_rows(options.key, points));
  if (failed > 0) {
    results.block(
        fmt::format("{} failed, {} done\n", counted(static_cast<long long>(failed), "point"), points.size() - failed));
  }
  if (run.stopped) results.block(fmt::format("INCOMPLETE: stopped after {} of {} points\n", done, values.size()));
  Results effects;
  add_effects(effects, run.effects);
  results.append(effects.hidden());
  deliver(options.common,
          run.stopped  ? "interrupted"
          : all_failed ? "failed"
                       : "done",
          std::move(results), run.times, [&](Results& out) {
            if (!folder) return;
            write_points(options, points);
            if (!run.stopped && base.test) out.block(plot_curves(options, base, points, true));
          });
  if (run.stopped) {
    throw_stopped(options.common, fmt::format("{} of {} points are done", done, values.size()),
                  "Run the same command with --resume to do the rest");
  }
  if (all_failed)
    computation_failed("none of the points could be computed",
                       "the first: " + without_full_stop(points.front().message), "");
  return 0;
}

}  // namespace

Run declare_sweep(CLI::App& command) {
  const auto options = std::make_shared<SweepOptions>();
  add_common_options(command, options->common);
  command.add_option("--key", options->key, "the key to vary, such as springs.kT or assembly.rows; ratio: kT/kN")
      ->required()
      ->type_name("KEY");
  command.add_option("--from", options->from, "first value")->check(finite_number())->type_name("A");
  command.add_option("--to", options->to, "last value")->check(finite_number())->type_name("B");
  command.add_option("--steps", options->steps, "number of values from A to B; 11 where left out")
      ->check(whole_number(1, 1000000))
      ->type_name("N");
  command.add_option("--values", options->values, "the values themselves")->allow_extra_args(false)->type_name("A,B,C");
  command.add_option("--verb", options->verb)->group("");
  command.add_option("--title", options->title, "title of the curves; left out: that of the case")->type_name("TEXT");
  command.add_flag("--resume", options->resume, "keep the points that lie in --out, compute the others");
  command.footer(
      "Examples:\n"
      "  equidem sweep data/cases/abe1996_fig6.toml --key ratio --from 0 --to 1 --steps 11 --out curve\n"
      "  equidem sweep data/cases/abe1996_fig6.toml --key assembly.rows --values 5,11,21,41\n"
      "A point that fails stays in the table with its reason.\n"
      "Ctrl-C keeps what is done; --resume continues.");
  return [options] { return sweep(*options); };
}

}  // namespace equidem
