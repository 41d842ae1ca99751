// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "homogenize/ensemble_report.hpp"
#include "problem.hpp"

namespace equidem {
namespace {

constexpr const char* statistics_name = "ensemble.csv";

HomogenizeOptions options_of(const Case& resolved) {
  const auto& boundary = resolved.homogenize.boundary;
  if (!boundary && !resolved.assembly.periodic()) {
    bad_input_at(resolved.where("ensemble"), "the cells of the ensemble have free boundaries",
                 "their moduli lie between two answers, by displacements and by tractions at the boundary",
                 fmt::format("Set {}, or choose homogenize.boundary", joins_sides(resolved.assembly)));
  }
  return {.boundary = boundary.value_or(Boundary::periodic), .rotation = resolved.rotation, .solver = resolved.solver};
}

Assembly build_cell(Case resolved, std::int64_t discs, std::uint64_t seed) {
  AssemblyCase& assembly = resolved.assembly;
  if (assembly.packing) {
    assembly.packing = casefile::with_place(resolved.where("packing"),
                                            [&] { return resized(*std::move(assembly.packing), discs, seed); });
  } else {
    assembly.delaunay.box.reset();  // its shape is the aspect
    assembly.delaunay.discs = discs;
    assembly.delaunay.seed = seed;
  }
  return build_assembly(resolved);
}

/// The first cell that can be packed.
Assembly first_cell(const Case& resolved, std::int64_t discs, std::uint64_t seed) {
  constexpr std::uint64_t most = 8;
  for (std::uint64_t tried = 1;; ++tried) {
    try {
      return build_cell(resolved, discs, seed + tried - 1);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::computation_failed || tried == most) throw;
    }
  }
}

/// The case but for sizes and samples, of which more may be asked later.
std::string continued_part(CommonOptions options, const std::filesystem::path& folder) {
  options.set.emplace_back("ensemble={discs = [3], samples = 2}");
  return to_toml(read_case(options), folder);
}

/// Samples of an earlier run of the same case.
std::vector<EnsembleSample> samples_to_keep(const CommonOptions& options, bool resume) {
  if (!resume) return {};
  if (!options.out)
    bad_input("--resume has nothing to continue", "the samples done lie in the folder of --out", "Add --out DIR");
  const auto table = *options.out / "samples.csv";
  if (!std::filesystem::exists(table)) return {};
  CommonOptions stored;
  stored.case_file = *options.out / "case.toml";
  stored.quiet = options.quiet;
  if (continued_part(stored, *options.out) != continued_part(options, *options.out)) {
    bad_input_at(stored.case_file.string(), "the samples there are of another case", "they would not fit together",
                 "Choose another --out, or leave out --resume and pass --overwrite");
  }
  return read_samples(table);
}

/// The samples done, and those of an earlier run beyond them, by size and seed: what was computed is not lost to a run
/// that asks for less or is stopped.
std::vector<EnsembleSample> with_kept(const std::vector<EnsembleSample>& done,
                                      const std::vector<EnsembleSample>& kept) {
  std::map<std::pair<std::int64_t, std::uint64_t>, EnsembleSample> all;
  for (const EnsembleSample& sample : done) all.emplace(std::pair(sample.discs, sample.seed), sample);
  for (const EnsembleSample& sample : kept) all.emplace(std::pair(sample.discs, sample.seed), sample);
  std::vector<EnsembleSample> result;
  for (auto& [key, sample] : all) result.push_back(std::move(sample));
  return result;
}

std::string describe_plan(const EnsemblePlan& plan) {
  const std::string sizes = joined(plan.discs, [](std::int64_t discs) { return fmt::format("{}", discs); });
  return fmt::format("{} of {} discs each, seeds {} to {}; intervals of 95 % confidence", counted(plan.samples, "cell"),
                     sizes, plan.first_seed, plan.first_seed + static_cast<std::uint64_t>(plan.samples) - 1);
}

/// \throws Error (computation_failed) where the largest cell surely does not fit into memory
void require_memory_of_cells(Case resolved, const EnsemblePlan& plan) {
  if (resolved.assembly.packing) return;  // the radii of its cells are drawn later
  resolved.assembly.delaunay.box.reset();
  resolved.assembly.delaunay.discs = plan.discs.back();
  require_memory_for(resolved, Purpose::factorize);
}

int dry_run(const CommonOptions& options, const Case& resolved, const EnsemblePlan& plan, Results results) {
  const BuiltSprings springs = build_springs(resolved, first_cell(resolved, plan.discs.front(), plan.first_seed));
  const int unknowns_per_disc = derive_effects(springs.springs, resolved.rotation).unknowns_per_disc();
  std::vector<std::int64_t> unknowns;
  for (const std::int64_t discs : plan.discs) {
    unknowns.push_back(discs * unknowns_per_disc);
    results.line("unknowns", fmt::format("about {} in each cell of {} discs", unknowns.back(), discs));
  }
  try {
    require_memory_of_cells(resolved, plan);
  } catch (const Error& error) {
    results.set("refusal", error.what());
    results.line("memory", fmt::format("The computation would be refused: {}", error.what()));
  }
  results.block("nothing was solved (--dry-run)\n");
  results.set("samples", plan.samples).set("discs", plan.discs).set("unknowns", unknowns);
  deliver(options, "dry_run", results, {});
  return 0;
}

}  // namespace

const char* joins_sides(const AssemblyCase& assembly) {
  return assembly.packing ? "packing.sides = \"periodic\"" : "assembly.periodic = true";
}

HomogenizedCell homogenize_cell(const Case& resolved, std::int64_t discs, std::uint64_t seed) {
  const Assembly cell = build_cell(resolved, discs, seed);
  return homogenize_cell(cell, build_springs(resolved, cell).springs, options_of(resolved));
}

void check_ensemble_outputs(const CommonOptions& options) {
  const OutputPlan plan(options);
  plan.expect_results();
  for (const char* name : {"samples.csv", statistics_name}) plan.expect(name);
  for (const char* name : ensemble_plot_names) plan.expect_plot(name);
}

Results cell_results(const Case& resolved, std::int64_t discs, std::uint64_t seed, const std::string& plan) {
  const std::string boundary = to_string(options_of(resolved).boundary);
  const Assembly first = first_cell(resolved, discs, seed);
  const BuiltSprings springs = build_springs(resolved, first);
  Results results;
  if (!resolved.title.empty()) results.block(resolved.title + "\n\n");
  results.line("ensemble", plan);
  const AssemblyCase& assembly = resolved.assembly;
  const std::string made = assembly.packing ? fmt::format("method = \"{}\"", to_string(assembly.packing->method))
                                            : fmt::format("points = \"{}\"", to_string(assembly.delaunay.points));
  results.line("cells", fmt::format("{}, {}, boundary = \"{}\"", first.kind, made, boundary));
  results.line("springs", springs.report + (resolved.material ? " (of the first cell)" : ""));
  add_effects(results, derive_effects(springs.springs, resolved.rotation));
  return results;
}

void deliver_ensemble(const CommonOptions& options, const EnsembleResult& result, Results results, StageTimes times,
                      const std::function<void()>& save_samples, const std::optional<Error>& failure) {
  const bool complete = !failure || failure->kind() != ErrorKind::interrupted;
  results.set("complete", complete);
  const auto plots = ensemble_plots(result);
  std::vector<OutputPart> parts;
  if (options.out) parts.push_back({"samples.csv", save_samples});
  if (options.out && complete) {
    parts.push_back({statistics_name,
                     [&] { write_csv(*options.out / statistics_name, statistics_table(result.statistics), true); }});
    for (const auto& plot : plots)
      parts.push_back({plot.first, [&] { write_plot(*options.out, plot.first, plot.second, true); }});
  }
  deliver(options, "done", std::move(results), std::move(times), parts, failure);
  hand_over([plots](const CommonOptions& into) {
    for (const auto& [name, plot] : plots) write_plot(*into.out, name, plot, into.overwrite);
  });
}

int homogenize_ensemble(const CommonOptions& options, const Case& resolved, bool resume) {
  const EnsembleCase& asked = *resolved.ensemble;
  EnsembleResult result{
      .title = resolved.title, .plan = asked.plan, .accuracy = asked.accuracy, .samples = {}, .statistics = {}};
  result.plan.first_seed = resolved.assembly.seed();
  const EnsemblePlan& plan = result.plan;
  Results results = cell_results(resolved, plan.discs.front(), plan.first_seed, describe_plan(plan));
  OutputPlan(options).expect_json();
  if (options.dry_run) return dry_run(options, resolved, plan, std::move(results));
  require_memory_of_cells(resolved, plan);
  CommonOptions written = options;
  written.overwrite = options.overwrite || resume;
  check_ensemble_outputs(written);
  const auto lock = lock_out(options);
  const std::vector<EnsembleSample> kept = samples_to_keep(options, resume);

  const auto& folder = options.out;
  write_case(options, resolved);
  const auto save = [&](const std::vector<EnsembleSample>& done) {
    if (folder) write_samples(*folder / "samples.csv", samples_table(with_kept(done, kept)));
  };
  StageTimes times;
  Stopwatch watch;
  SavedOnTheWay saved(options);
  EnsembleSamples sampled = sample_ensemble(
      result.plan, [&](std::int64_t discs, std::uint64_t seed) { return homogenize_cell(resolved, discs, seed); }, kept,
      [&](const std::vector<EnsembleSample>& done) { saved([&] { save(done); }); });
  times.add("sampling", watch.lap());
  result.samples = std::move(sampled.samples);
  result.statistics = analyze_ensemble(result.plan, result.samples, result.statistics.confidence);

  results.append(ensemble_results(result));
  const std::size_t wanted = result.plan.discs.size() * static_cast<std::size_t>(result.plan.samples);
  if (sampled.stopped)
    results.block(fmt::format("INCOMPLETE: stopped after {} of {} cells\n", result.samples.size(), wanted));
  const std::optional<Error> failure = failure_of([&] {
    if (sampled.stopped)
      throw_stopped(options, fmt::format("{} of {} cells are done", result.samples.size(), wanted),
                    "Run the same command with --resume to do the rest");
    if (std::ranges::all_of(result.samples, &EnsembleSample::refused))
      computation_failed("none of the cells has moduli",
                         "the first: " + without_full_stop(result.samples.front().refusal), "");
  });
  deliver_ensemble(
      options, result, std::move(results), std::move(times), [&] { save(result.samples); }, failure);
  return 0;
}

}  // namespace equidem
