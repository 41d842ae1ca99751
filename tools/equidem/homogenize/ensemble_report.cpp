// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/ensemble_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::string with_unit(const EnsembleQuantity& quantity, const std::string& what = "") {
  return quantity.name + what + (quantity.modulus ? "_Pa" : "");
}

}  // namespace

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

std::vector<EnsembleSample> read_samples(const std::filesystem::path& path) {
  const StoredTable table(path, samples_table({}), "ensemble",
                          "Choose another --out, or leave out --resume and pass --overwrite");
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

namespace {

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
    samples.x.push_back(static_cast<double>(sample.cell.discs));
    samples.y.push_back(sample.cell.moduli.*q.value);
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
    for (Series* series : {&mean, &low, &high}) series->x.push_back(size.mean_discs);
    mean.y.push_back(e.mean);
    low.y.push_back(e.low());
    high.y.push_back(e.high());
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
      fit.x.push_back(from * std::pow(to / from, static_cast<double>(k) / pieces));
      fit.y.push_back(*d.limit + d.drift / fit.x.back());
    }
    plot.series.push_back(fit);
  }
  const bool bounded = std::any_of(low.y.begin(), low.y.end(), [](double y) { return std::isfinite(y); });
  if (bounded) plot.series.insert(plot.series.end(), {low, high});
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
      measured.x.push_back(size.mean_discs);
      measured.y.push_back(e.standard_deviation / unit);
      law.x.push_back(size.mean_discs);
      law.y.push_back(d.amplitude * std::pow(size.mean_discs, -d.exponent) / unit);
    }
    if (measured.x.empty()) continue;
    plot.series.push_back(law);
    plot.series.push_back(measured);
  }
  return plot;
}

}  // namespace

std::vector<std::pair<std::string, Plot>> ensemble_plots(const EnsembleResult& result) {
  std::vector<std::pair<std::string, Plot>> plots;
  const bool any = std::any_of(result.samples.begin(), result.samples.end(),
                               [](const EnsembleSample& sample) { return !sample.refused(); });
  if (!any) return plots;
  plots.emplace_back(ensemble_plot_names[0], plot_means(result, shear_modulus, "shear modulus G, Pa"));
  plots.emplace_back(ensemble_plot_names[1], plot_means(result, poisson_ratio, "Poisson's ratio ν (plane strain)"));
  Plot scatter = plot_scatter(result);
  if (!scatter.series.empty()) plots.emplace_back(ensemble_plot_names[2], std::move(scatter));
  return plots;
}

namespace {

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
  const auto smallest = std::find_if(statistics.sizes.begin(), statistics.sizes.end(),
                                     [&](const EnsembleSize& size) { return size.estimates[quantity].samples > 0; });
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

/// Dependence of a quantity on the size of the cell, and the required size.
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

}  // namespace

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

}  // namespace equidem
