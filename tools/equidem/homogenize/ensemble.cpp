// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/ensemble/ensemble.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <utility>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/ensemble/ensemble_accuracy.hpp"
#include "equidem/homogenize/ensemble/ensemble_statistics.hpp"
#include "equidem/output/plots/plot.hpp"

#include "accuracy.hpp"
#include "homogenize/homogenize.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

constexpr const char* statistics_name = "ensemble.csv";

/// An ensemble as it was asked for, and what came of it.
struct EnsembleResult {
  std::string title;
  EnsemblePlan plan = {};
  std::optional<double> accuracy = {};  ///< relative, wanted
  std::vector<EnsembleSample> samples = {};
  EnsembleStatistics statistics = {};
  std::function<void()> save_samples = {};  ///< writes the table of the samples
  std::optional<Error> failure = {};

  [[nodiscard]] bool complete() const { return !failure || failure->kind() != ErrorKind::interrupted; }
};

std::string with_unit(const EnsembleQuantity& quantity, const std::string& what = "") {
  return quantity.name + what + (quantity.modulus ? "_Pa" : "");
}

Table samples_table(const std::vector<EnsembleSample>& samples) {
  Table table;
  table.add("discs", samples, &EnsembleSample::discs).add("seed", samples, &EnsembleSample::seed);
  table.add("discs_built", samples, [](const EnsembleSample& sample) { return sample.cell.discs; });
  for (const EnsembleQuantity& quantity : ensemble_quantities) {
    table.add(with_unit(quantity), samples, [&](const EnsembleSample& sample) {
      return sample.refused() ? std::nullopt : std::optional(sample.cell.moduli.*quantity.value);
    });
  }
  return table.add("refusal", samples, &EnsembleSample::refusal);
}

/// Reads a table of samples_table; numbers have the same bits.
/// \throws Error (bad_input) where the file is another table or damaged
std::vector<EnsembleSample> read_samples(const std::filesystem::path& path) {
  const StoredTable table(path, samples_table({}), "ensemble", begin_anew);
  std::vector<EnsembleSample> samples(table.rows());
  for (std::size_t row = 0; row < samples.size(); ++row) {
    EnsembleSample& sample = samples[row];
    sample.discs = table.integer(row, 0);
    sample.seed = static_cast<std::uint64_t>(table.integer(row, 1));
    sample.cell.discs = table.integer(row, 2);
    for (std::size_t q = 0; q < ensemble_quantities.size(); ++q)
      sample.cell.moduli.*ensemble_quantities[q].value = table.number(row, 3 + q);
    sample.refusal = table.text(row, 3 + ensemble_quantities.size());
  }
  return samples;
}

Table statistics_table(const EnsembleStatistics& statistics) {
  const auto& sizes = statistics.sizes;
  Table table;
  table.add("discs", sizes, &EnsembleSize::discs).add("mean_discs", sizes, &EnsembleSize::mean_discs);
  table.add("samples", sizes, [](const EnsembleSize& size) { return size.estimates.front().samples; });
  table.add("refused", sizes, &EnsembleSize::refused);
  for (std::size_t q = 0; q < ensemble_quantities.size(); ++q) {
    const auto column = [&](const char* what, const auto& value) {
      table.add(with_unit(ensemble_quantities[q], what), sizes,
                [&](const EnsembleSize& size) { return std::invoke(value, size.estimates[q]); });
    };
    column("_mean", &MeanEstimate::mean);
    column("_standard_deviation", &MeanEstimate::standard_deviation);
    column("_standard_error", &MeanEstimate::standard_error);
    column("_low", &MeanEstimate::low);
    column("_high", &MeanEstimate::high);
  }
  return table;
}

constexpr std::size_t shear_modulus = 1, poisson_ratio = 2;

Plot plot_means(const EnsembleResult& result, std::size_t quantity, const std::string& label) {
  const EnsembleQuantity& q = ensemble_quantities[quantity];
  Series samples{.label = "one cell",
                 .style = SeriesStyle::points,
                 .colour = PlotColour::sky_blue,
                 .filled = false,
                 .column = "sample"};
  for (const EnsembleSample& sample : result.samples) {
    if (sample.refused()) continue;
    samples.add(static_cast<double>(sample.cell.discs), sample.cell.moduli.*q.value);
  }
  Series mean{.label = "mean", .style = SeriesStyle::line_with_points, .colour = PlotColour::blue, .column = "mean"};
  Series low{.label = fmt::format("{:.4g} % interval of the mean", 100 * result.statistics.confidence),
             .style = SeriesStyle::dashed_line,
             .colour = PlotColour::blue,
             .column = "low"};
  Series high{.style = SeriesStyle::dashed_line, .colour = PlotColour::blue, .column = "high"};
  for (const EnsembleSize& size : result.statistics.sizes) {
    const MeanEstimate& e = size.estimates[quantity];
    if (e.samples == 0) continue;
    mean.add(size.mean_discs, e.mean);
    low.add(size.mean_discs, e.low());
    high.add(size.mean_discs, e.high());
  }
  Plot plot{.title = literal(result.title),
            .x = {.label = "discs in the cell, N", .logarithmic = true},
            .y = {.label = label},
            .series = {samples},
            .enhanced = true};
  const SizeDependence& d = result.statistics.dependence[quantity];
  if (d.drifts) {
    Series fit{.label = "fit: limit + b/N", .style = SeriesStyle::line, .column = "fit"};
    constexpr int pieces = 100;
    const double from = mean.x.front(), to = mean.x.back();
    for (int k = 0; k <= pieces; ++k) {
      const double discs = from * std::pow(to / from, static_cast<double>(k) / pieces);
      fit.add(discs, *d.limit + d.drift / discs);
    }
    plot.series.push_back(fit);
  }
  if (std::ranges::any_of(low.y, [](double y) { return std::isfinite(y); }))
    plot.series.insert(plot.series.end(), {low, high});
  plot.series.push_back(mean);
  return plot;
}

Plot plot_scatter(const EnsembleResult& result) {
  Plot plot{.title = literal(result.title),
            .x = {.label = "discs in the cell, N", .logarithmic = true},
            .y = {.label = "scatter of one cell (moduli: over the mean)", .logarithmic = true},
            .enhanced = true};
  constexpr std::array colours{PlotColour::green, PlotColour::blue, PlotColour::vermilion};
  constexpr std::array markers{Marker::square, Marker::circle, Marker::triangle};
  for (std::size_t q = 0; q < colours.size(); ++q) {
    const SizeDependence& d = result.statistics.dependence[q];
    if (!d.scattered) continue;
    Series measured{
        .label = fmt::format("{}, line N^{{-{:.2f}}}", with_symbols(ensemble_quantities[q].symbol), d.exponent),
        .style = SeriesStyle::points,
        .colour = colours[q],
        .marker = markers[q]};
    Series law{.style = SeriesStyle::dashed_line,
               .colour = colours[q],
               .column = fmt::format("law_{}", ensemble_quantities[q].name)};
    for (const EnsembleSize& size : result.statistics.sizes) {
      const MeanEstimate& e = size.estimates[q];
      if (!(e.standard_deviation > 0)) continue;
      const double unit = ensemble_quantities[q].modulus ? std::abs(e.mean) : 1;
      measured.add(size.mean_discs, e.standard_deviation / unit);
      law.add(size.mean_discs, d.amplitude * std::pow(size.mean_discs, -d.exponent) / unit);
    }
    if (measured.x.empty()) continue;
    plot.series.push_back(law);
    plot.series.push_back(measured);
  }
  return plot;
}

struct EnsemblePlot {
  const char* name;
  Plot (*of)(const EnsembleResult& result);
};

/// Means with their confidence limits and all samples against size, of G and of nu (plane strain); the scatter of K, G
/// and nu against size, without series where they do not scatter.
constexpr std::array ensemble_plots{
    EnsemblePlot{"shear_modulus",
                 [](const EnsembleResult& r) { return plot_means(r, shear_modulus, "shear modulus G, Pa"); }},
    EnsemblePlot{
        "poisson_ratio",
        [](const EnsembleResult& r) { return plot_means(r, poisson_ratio, "Poisson's ratio ν (plane strain)"); }},
    EnsemblePlot{"scatter", plot_scatter}};

/// K, G and nu: the others follow from them.
constexpr std::size_t reported_quantities = 3;
constexpr std::size_t anisotropy_index = ensemble_quantities.size() - 1;

/// Keys of ensemble_quantities in the JSON, those of `equidem homogenize`.
constexpr std::array quantity_keys{"bulk_modulus_2d",
                                   "shear_modulus",
                                   "poisson_ratio/plane_strain",
                                   "poisson_ratio/plane_stress",
                                   "young_modulus/plane_strain",
                                   "young_modulus/plane_stress",
                                   "anisotropy"};

void add_table(Results& out, const EnsembleStatistics& statistics, std::size_t quantity) {
  const EnsembleQuantity& q = ensemble_quantities[quantity];
  const std::string interval = fmt::format("{} interval of the mean", percent(statistics.confidence, 4));
  std::vector<Results> rows;
  for (const EnsembleSize& size : statistics.sizes) {
    const MeanEstimate& e = size.estimates[quantity];
    const double relative = e.mean != 0 ? e.standard_deviation / std::abs(e.mean) : MeanEstimate::unknown;
    rows.push_back(Results()
                       .add("", "  discs", size.discs)
                       .add("", "cells", e.samples)
                       .add("", "mean", e.mean, "", {.digits = 7})
                       .add("", interval, std::vector{e.low(), e.high()})
                       .add("", "sd of one cell", e.standard_deviation, "", {.digits = 3})
                       .add("", "sd/mean", relative, "", {Shown::percent, 3}));
  }
  out.block(fmt::format("{}{}\n", q.symbol, q.modulus ? ", Pa" : "")).table("", std::move(rows));
}

std::string describe_scatter(const SizeDependence& d, double confidence) {
  if (!d.measured_exponent) return "";
  const double t = student_critical_value(confidence, d.freedom);
  const double error = t * d.exponent_error;
  constexpr double too_wide = 0.5;  // an error that does not tell the exponent from 0
  if (d.exponent == 0.5 && error > too_wide) {
    return fmt::format(
        "  these samples do not tell how the scatter falls with size (exponent known to ± {:.2g}); N^-1/2 of many "
        "independent patches is used below\n",
        error);
  }
  const std::string text =
      fmt::format("  scatter {} as N^{:.2f} (± {:.2f}): ", *d.measured_exponent < 0 ? "grows" : "falls",
                  -*d.measured_exponent, error);
  if (d.exponent == 0.5) return text + "compatible with N^-1/2 of many independent patches, which is used below\n";
  return text + "not the N^-1/2 of many independent patches; the exponent measured is used below\n";
}

std::string describe_drift(const EnsembleStatistics& statistics, std::size_t quantity) {
  const SizeDependence& d = statistics.dependence[quantity];
  if (!d.limit) return "";
  const double t = student_critical_value(statistics.confidence, d.freedom);
  const char* unit = ensemble_quantities[quantity].modulus ? " Pa" : "";
  const EnsembleSize& largest = statistics.sizes.back();
  if (!d.drifts) {
    return fmt::format("  size: no drift seen; mean = limit + b/N would have b = {:.3g} ± {:.2g}{}\n", d.drift,
                       t * d.drift_error, unit);
  }
  return fmt::format(
      "  size: the mean drifts as {:.6g} + {:.3g}/N{} (limit ± {:.2g}, b ± {:.2g}): at N = {:.0f} it is still "
      "{:.2g}{} from the limit\n",
      *d.limit, d.drift, unit, t * d.limit_error, t * d.drift_error, largest.mean_discs,
      std::abs(d.drift) / largest.mean_discs, unit);
}

std::string describe_need(const EnsembleResult& result, std::size_t quantity) {
  const EnsembleStatistics& statistics = result.statistics;
  const SizeDependence& d = statistics.dependence[quantity];
  const char* symbol = ensemble_quantities[quantity].symbol;
  const double confidence = statistics.confidence;
  if (!d.scattered) {
    const bool several = statistics.sizes.front().estimates[quantity].samples > 1;
    return several ? "  all cells agree to round-off: any size does\n" : "";
  }
  const EnsembleSize& largest = statistics.sizes.back();
  const double one =
      student_critical_value(confidence, d.freedom) * d.amplitude * std::pow(largest.mean_discs, -d.exponent);
  const char* unit = ensemble_quantities[quantity].modulus ? " Pa" : "";
  std::string text;
  if (largest.estimates[quantity].samples > 0) {
    text += fmt::format(
        "  with {} confidence one cell of {:.0f} discs lies within {:.2g}{} of the mean, the mean of {} within "
        "{:.2g}{}\n",
        percent(confidence), largest.mean_discs, one, unit, result.plan.samples, one / std::sqrt(result.plan.samples),
        unit);
  }
  if (!result.accuracy) return text;
  const auto alone = needed_discs(statistics, quantity, *result.accuracy, 1);
  const auto averaged = needed_discs(statistics, quantity, *result.accuracy, result.plan.samples);
  if (!alone || !averaged) {
    return text + fmt::format("  {} is 0 within its error, or its scatter does not fall: no size reaches {} of it\n",
                              symbol, percent(*result.accuracy));
  }
  const auto smallest = std::ranges::find_if(
      statistics.sizes, [&](const EnsembleSize& size) { return size.estimates[quantity].samples > 0; });
  const auto discs = [&](std::int64_t needed) {
    return fmt::format("{} discs{}", needed, static_cast<double>(needed) < smallest->mean_discs + 1 ? " at most" : "");
  };
  return text + fmt::format("  {} of {} with {} confidence needs one cell of {}, or the mean of {} cells of {}\n",
                            percent(*result.accuracy), symbol, percent(confidence), discs(*alone), result.plan.samples,
                            discs(*averaged));
}

void add_refusals(Results& out, const EnsembleResult& result) {
  constexpr std::size_t named = 5;
  std::vector<Results> refusals;
  std::string text;
  for (const EnsembleSample& sample : result.samples) {
    if (!sample.refused()) continue;
    refusals.push_back(Results().set("discs", sample.discs).set("seed", sample.seed).set("why", sample.refusal));
    if (refusals.size() <= named)
      text += fmt::format("  {} discs, seed {}: {}\n", sample.discs, sample.seed, sample.refusal);
  }
  out.set("refusals", refusals);
  if (refusals.empty()) return;
  if (refusals.size() > named) text += fmt::format("  and {} more, named in samples.csv\n", refusals.size() - named);
  out.block(fmt::format("{} of {} have no moduli; the means are those of the others, not of all such cells:\n{}\n",
                        counted(std::ssize(refusals), "cell"), result.samples.size(), text));
}

void add_sizes(Results& out, const EnsembleStatistics& statistics) {
  std::vector<Results> sizes;
  for (const EnsembleSize& size : statistics.sizes) {
    Results one;
    one.set("discs", size.discs).set("mean_discs", size.mean_discs);
    one.set("samples", size.estimates.front().samples).set("refused", size.refused);
    for (std::size_t q = 0; q < quantity_keys.size(); ++q) {
      const MeanEstimate& e = size.estimates[q];
      one.set(quantity_keys[q], Results()
                                    .set("mean", e.mean)
                                    .set("standard_deviation", e.standard_deviation)
                                    .set("standard_error", e.standard_error)
                                    .set("confidence_interval", std::vector{e.low(), e.high()}));
    }
    sizes.push_back(std::move(one));
  }
  out.set("ensemble", sizes);
}

void add_dependence(Results& out, const EnsembleResult& result, std::size_t quantity) {
  const SizeDependence& d = result.statistics.dependence[quantity];
  const std::string key = std::string("/") + quantity_keys[quantity];
  const auto if_known = [](bool is_known, double value) { return is_known ? value : MeanEstimate::unknown; };
  out.set("scatter_exponent" + key,
          Results()
              .set("value", d.measured_exponent)
              .set("standard_error", if_known(d.measured_exponent.has_value(), d.exponent_error))
              .set("used", d.exponent));
  const bool limit = d.limit.has_value();
  out.set("size_limit" + key, Results()
                                  .set("value", d.limit)
                                  .set("standard_error", if_known(limit, d.limit_error))
                                  .set("drift", if_known(limit, d.drift))
                                  .set("drift_standard_error", if_known(limit, d.drift_error))
                                  .set("drifts", d.drifts));
  const auto needed = [&](std::int64_t samples) {
    return result.accuracy ? needed_discs(result.statistics, quantity, *result.accuracy, samples) : std::nullopt;
  };
  out.set("needed_discs" + key,
          Results().set("one_cell", needed(1)).set("mean_of_samples", needed(result.plan.samples)));
}

Results ensemble_results(const EnsembleResult& result) {
  const EnsembleStatistics& statistics = result.statistics;
  Results out;
  out.block("\n").set("title", result.title).set("confidence", statistics.confidence).set("accuracy", result.accuracy);
  add_refusals(out, result);
  for (std::size_t q = 0; q < ensemble_quantities.size(); ++q) {
    add_table(out, statistics, q);
    if (q < reported_quantities) {
      out.block(describe_scatter(statistics.dependence[q], statistics.confidence) + describe_drift(statistics, q) +
                describe_need(result, q));
    }
    out.block("\n");
    if (q != anisotropy_index) add_dependence(out, result, q);
  }
  add_sizes(out, statistics);
  return out;
}

/// The key and value that make a random assembly periodic.
const char* joins_sides(const AssemblyCase& assembly) {
  return assembly.packing ? "packing.sides = \"periodic\"" : "assembly.periodic = true";
}

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

/// The case without sizes and samples, of which more may be asked later.
std::string continued_part(CommonOptions options, const std::filesystem::path& folder) {
  options.set.emplace_back("ensemble={discs = [3], samples = 2}");
  return to_toml(read_case(options), folder);
}

/// \param note of the files that the case reads
std::vector<EnsembleSample> samples_to_keep(const CommonOptions& options, bool resume, const std::string& note) {
  if (!resume) return {};
  expect_folder_of(options, "the samples done");
  const auto table = *options.out / "samples.csv";
  if (!std::filesystem::exists(table)) return {};
  CommonOptions stored;
  stored.verb = options.verb;
  stored.case_file = *options.out / "case.toml";
  stored.quiet = options.quiet;
  if (continued_part(stored, *options.out) != continued_part(options, *options.out) ||
      !read_file(stored.case_file).ends_with(note)) {
    bad_input_at(stored.case_file.string(), "the samples there are of another case",
                 "it, or a file that it reads, has changed", begin_anew);
  }
  return read_samples(table);
}

/// The samples done, and those of an earlier run beyond them, by size and seed: what was computed is not lost to a run
/// that asks for less or is stopped.
std::vector<EnsembleSample> with_kept(const std::vector<EnsembleSample>& done,
                                      const std::vector<EnsembleSample>& kept) {
  std::map<std::pair<std::int64_t, std::uint64_t>, EnsembleSample> all;
  for (const auto* samples : {&done, &kept})
    for (const EnsembleSample& sample : *samples) all.emplace(std::pair(sample.discs, sample.seed), sample);
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

/// Bytes of cells with their solutions, as many as are computed beside each other. Packings are not packed for it: the
/// smallest is measured, and its solution takes N log N.
/// \param cells of each size
double bytes_of_cells(const Case& resolved, const std::vector<EnsembleSetting>& cells, std::uint64_t seed) {
  const std::int64_t smallest = std::ranges::min(cells, {}, &EnsembleSetting::discs).discs;
  const auto& packing = resolved.assembly.packing;
  double most = 0;
  for (const auto& [discs, samples] : cells) {
    const Assembly cell = first_cell(resolved, packing ? smallest : discs, seed);
    const SolveEstimate estimate = estimate_solve(cell, build_springs(resolved, cell).springs, {},
                                                  {.rotation = resolved.rotation, .solver = resolved.solver});
    const double n = static_cast<double>(discs), measured = static_cast<double>(cell.size());
    const double solved =
        bytes_of_network(n) + estimate.peak_bytes * n * std::log(n + 1) / (measured * std::log(measured + 1));
    const double packed = packing ? entry_of(packing->method).bytes_of_body * n : 0;
    most = std::max(most, std::min(cells_at_once(discs), samples) * std::max(solved, packed));
  }
  return most;
}

Results memory_of_cells(const Case& resolved, const std::vector<EnsembleSetting>& cells, std::uint64_t seed) {
  const double resident = resident_memory();
  return Results().line("memory").add("peak_bytes", "about", resident + bytes_of_cells(resolved, cells, seed),
                                      "at the peak, of the cells computed at once", {Shown::bytes});
}

void dry_run_ensemble(const CommonOptions& options, const Case& resolved, const EnsemblePlan& plan, Results results) {
  const BuiltSprings springs = build_springs(resolved, first_cell(resolved, plan.discs.front(), plan.first_seed));
  const int unknowns_per_disc = derive_effects(springs.springs, resolved.rotation).unknowns_per_disc();
  std::vector<std::int64_t> unknowns;
  for (const std::int64_t discs : plan.discs) {
    unknowns.push_back(discs * unknowns_per_disc);
    results.line("unknowns", fmt::format("about {} in each cell of {} discs", unknowns.back(), discs));
  }
  std::vector<EnsembleSetting> cells;
  for (const std::int64_t discs : plan.discs) cells.push_back({discs, plan.samples});
  try {
    require_memory_of_cells(resolved, plan);
    results.append(memory_of_cells(resolved, cells, plan.first_seed));
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    results.set("refusal", error.what());
    results.line("memory", fmt::format("The computation would be refused: {}", error.what()));
  }
  results.block("nothing was solved (--dry-run)\n");
  results.set("samples", plan.samples).set("discs", plan.discs).set("unknowns", unknowns);
  deliver(options, "dry_run", results, {});
}

HomogenizedCell homogenize_cell(const Case& resolved, std::int64_t discs, std::uint64_t seed) {
  const Assembly cell = build_cell(resolved, discs, seed);
  return homogenize_cell(cell, build_springs(resolved, cell).springs, options_of(resolved));
}

/// Title, cells, springs and effects; those of the first cell stand for all.
/// \param plan what is sampled, in words; empty: left out
Results cell_results(const Case& resolved, std::int64_t discs, std::uint64_t seed, const std::string& plan = {}) {
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

/// Samples, statistics and plots; the latter where the sampling came to its end.
std::vector<OutputPart> output_parts(const std::shared_ptr<const EnsembleResult>& made) {
  const auto save = [=](const CommonOptions& /*into*/) { made->save_samples(); };
  const auto write_statistics = [=](const CommonOptions& into) {
    if (made->complete()) write_csv(*into.out / statistics_name, statistics_table(made->statistics), true);
  };
  std::vector<OutputPart> parts{{"samples.csv", save, OutputPart::folder, {"samples.csv", "case.toml"}},
                                {statistics_name, write_statistics, OutputPart::folder, {statistics_name}}};
  for (const EnsemblePlot& plot : ensemble_plots) {
    const auto draw = [=](const CommonOptions& into) {
      if (!made->complete() || std::ranges::all_of(made->samples, &EnsembleSample::refused)) return;
      const Plot drawn = plot.of(*made);
      if (!drawn.series.empty()) write_plot(*into.out, plot.name, drawn, true);
    };
    parts.push_back({plot.name, draw, OutputPart::page, plot_files(plot.name)});
  }
  return parts;
}

/// Fewer bodies jam earlier, so that many of their cells could not be packed.
constexpr std::int64_t smallest_packing = 128;

AccuracySetting setting_of(const EnsembleSetting& setting) {
  return {{"ensemble.discs", static_cast<double>(setting.discs)},
          {"ensemble.samples", static_cast<double>(setting.samples)}};
}

double work_of(const AccurateEnsemble& sampled) {
  double work = 0;
  for (const EnsembleSample& sample : sampled.samples) work += EnsembleSetting{sample.discs, 1}.work();
  return work;
}

ReachedAccuracy reached_by(const AccurateEnsemble& sampled, const EnsembleAccuracy& wanted, double seconds) {
  ReachedAccuracy reached{
      .requested = wanted.accuracy,
      .estimated = sampled.estimated,
      .of = fmt::format(
          "K and G relative, nu (plane strain) as it is, mean of {} cells of {} discs against infinite cells, with "
          "{:.4g} % confidence, scatter and drift together",
          sampled.chosen.samples, sampled.chosen.discs, 100 * wanted.confidence),
      .knob = "size and number of cells",
      .value = setting_of(sampled.chosen)};
  std::vector<std::string> pilots;
  for (const std::int64_t discs : sampled.plan.discs) {
    if (discs == sampled.chosen.discs) continue;
    const auto cells = std::ranges::count(sampled.samples, discs, &EnsembleSample::discs);
    pilots.push_back(fmt::format("{} cells of {} discs", cells, discs));
  }
  reached.pilots = joined(pilots);
  reached.pilots_factor = work_of(sampled) / sampled.chosen.work() - 1;
  auto& more = reached.ten_times_more;
  more.time_factor = sampled.ten_times_more.work() / sampled.chosen.work();
  more.seconds = seconds * sampled.ten_times_more.work() / work_of(sampled);
  more.value = setting_of(sampled.ten_times_more);
  if (sampled.estimated <= wanted.accuracy / 10) more.note = has_it_already;
  if (sampled.ten_times_more.samples == 0) more.note = "cannot be had: cells of any size are off by more";
  if (sampled.ten_times_more.all_discs() > wanted.most_discs)
    more.note = fmt::format("cannot be had: it takes {:.2g} discs in all", sampled.ten_times_more.all_discs());
  return reached;
}

}  // namespace

void homogenize_ensemble(const CommonOptions& options, const Case& resolved, bool resume) {
  const EnsembleCase& asked = *resolved.ensemble;
  const auto made = std::make_shared<EnsembleResult>(
      EnsembleResult{.title = resolved.title, .plan = asked.plan, .accuracy = asked.accuracy});
  EnsembleResult& result = *made;
  result.plan.first_seed = resolved.assembly.seed();
  const EnsemblePlan& plan = result.plan;
  Results results = cell_results(resolved, plan.discs.front(), plan.first_seed, describe_plan(plan));
  expect_json(options);
  if (options.dry_run) return dry_run_ensemble(options, resolved, plan, std::move(results));
  require_memory_of_cells(resolved, plan);
  const std::vector<OutputPart> parts = output_parts(made);
  expect_results(options, parts, resume);
  const auto lock = lock_out(options);
  const std::string note = options.out ? note_of_files(resolved.document) : std::string();
  const std::vector<EnsembleSample> kept = samples_to_keep(options, resume, note);

  const auto& folder = options.out;
  write_case(options, resolved, note);
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
    results.block(fmt::format("INCOMPLETE: stopped after {} of {} cells\n", result.samples.size(), wanted)).warn();
  result.save_samples = [&] { save(result.samples); };
  result.failure = failure_of([&] {
    if (sampled.stopped) throw_stopped(options, fmt::format("{} of {} cells are done", result.samples.size(), wanted));
    if (std::ranges::all_of(result.samples, &EnsembleSample::refused))
      computation_failed("none of the cells has moduli",
                         "the first: " + without_full_stop(result.samples.front().refusal), "");
  });
  results.set("complete", result.complete());
  deliver(options, "done", std::move(results), std::move(times), parts, result.failure);
}

void homogenize_to_accuracy(const CommonOptions& options, const Case& resolved, double accuracy) {
  if (!resolved.assembly.periodic()) {
    bad_input_at(resolved.where("assembly"), "--accuracy cannot be kept by samples with free boundaries",
                 "their moduli depend on the boundary far more than on the number of samples",
                 fmt::format("Set {}", joins_sides(resolved.assembly)));
  }
  expect_json(options);
  const auto made = std::make_shared<EnsembleResult>(EnsembleResult{.title = resolved.title, .accuracy = accuracy});
  EnsembleResult& result = *made;
  const std::vector<OutputPart> parts = output_parts(made);
  if (!options.dry_run) expect_results(options, parts);
  const auto lock = lock_out(options);
  EnsembleAccuracy wanted{.accuracy = accuracy, .first_seed = resolved.assembly.seed()};
  if (resolved.assembly.packing) wanted.smallest = smallest_packing;
  Results results = cell_results(resolved, wanted.smallest, wanted.first_seed);
  if (options.dry_run) {
    const auto pilots = accuracy_pilots(wanted);
    const auto described = [](const EnsembleSetting& pilot) {
      return fmt::format("{} cells of {} discs", pilot.samples, pilot.discs);
    };
    results.append(accuracy_plan(accuracy, fmt::format("first {}; the size and number of cells that reach it follow "
                                                       "from them, with at most {:.0e} discs in all",
                                                       joined(pilots, described, " and "), wanted.most_discs)));
    results.append(memory_of_cells(resolved, {pilots.begin(), pilots.end()}, wanted.first_seed));
    return deliver(options, "dry_run", results.block("nothing was solved (--dry-run)\n"), {});
  }
  const auto& folder = options.out;
  const auto save = [&](const std::vector<EnsembleSample>& done) {
    if (folder) write_samples(*folder / "samples.csv", samples_table(done));
  };
  StageTimes times;
  Stopwatch watch;
  SavedOnTheWay saved(options);
  AccurateEnsemble sampled =
      sample_to_accuracy([&](std::int64_t discs, std::uint64_t seed) { return homogenize_cell(resolved, discs, seed); },
                         wanted, [&](const std::vector<EnsembleSample>& done) { saved([&] { save(done); }); });
  times.add("sampling", watch.lap());
  result.failure = sampled.failure;
  if (sampled.stopped)
    result.failure = Error(
        ErrorKind::interrupted, "stopped as asked",
        fmt::format("{} cells are done, too few for an accuracy of {:.3g}", sampled.samples.size(), accuracy), "");
  const ReachedAccuracy reached = reached_by(sampled, wanted, times.total());
  result.plan = sampled.plan;
  result.samples = std::move(sampled.samples);
  result.statistics = std::move(sampled.statistics);
  result.save_samples = [&] { save(result.samples); };
  if (folder) {
    CommonOptions chosen = options;
    chosen.set.push_back(fmt::format("ensemble={{discs = [{}], samples = {}, accuracy = {}}}", sampled.chosen.discs,
                                     sampled.chosen.samples, accuracy));
    write_case(options, read_case(chosen), note_of_files(resolved.document));
  }
  results.append(ensemble_results(result));
  if (sampled.estimated > 0 || !result.failure) results.append(accuracy_results(reached));
  results.set("complete", result.complete());
  deliver(options, "done", std::move(results), std::move(times), parts, result.failure);
}

}  // namespace equidem
