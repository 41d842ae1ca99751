// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

#include "homogenize/ensemble_report.hpp"

namespace equidem {
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

}  // namespace equidem
