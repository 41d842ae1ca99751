// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Plots, table, JSON and command line.
#include <algorithm>

#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

#include "abe1996_random/abe1996_random.hpp"
#include "papers.hpp"
#include "tables.hpp"

namespace equidem::abe1996_random {
namespace {

constexpr std::array colours{PlotColour::yellow, PlotColour::sky_blue, PlotColour::green,     PlotColour::orange,
                             PlotColour::purple, PlotColour::blue,     PlotColour::vermilion, PlotColour::black};
constexpr std::array markers{Marker::circle, Marker::square, Marker::triangle, Marker::diamond};

/// The name of a weighting, without the underscores that enhanced text would make subscripts of.
std::string spaced(SpringWeighting weighting) {
  std::string name = to_string(weighting);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// A point with a bar of two standard errors to either side.
void add_with_error(Series& series, const MeanEstimate& estimate) {
  series.y.push_back(estimate.mean);
  series.low.push_back(estimate.mean - 2 * estimate.standard_error);
  series.high.push_back(estimate.mean + 2 * estimate.standard_error);
}

Plot poisson_plot(const Result& result, std::size_t weighting) {
  const std::vector<double>& ratios = result.plan.ratios;
  // Uniform stress in two dimensions, plane strain: Kruyt & Rothenburg (2002).
  const auto uniform_stress_ratio = [](double r) { return (1 - r) / (2 * (1 + r)); };
  Plot plot{.title = fmt::format("Random assemblies, springs weighted \"{}\"; bars: two standard errors",
                                 spaced(weightings[weighting])),
            .x = {.label = "k_T/k_N"},
            .y = {.label = "Poisson's ratio ν (plane strain)"}};
  plot.enhanced = true;
  plot.series = {
      curve({.label = "mean field (22), Voigt", .column = "mean_field"}, 0, ratios.back(), poisson_ratio_of_ratio),
      curve({.label = "uniform stress", .style = SeriesStyle::dashed_line, .column = "uniform_stress"}, 0,
            ratios.back(), uniform_stress_ratio)};
  std::size_t style = 0;
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    const Family& family = result.plan.families[f];
    if (!family.isotropic() || !family.disordered()) continue;
    Series series{.label = family.name,
                  .x = ratios,
                  .style = SeriesStyle::line_with_points,
                  .colour = colours[style % colours.size()],
                  .marker = markers[style % markers.size()]};
    ++style;
    for (std::size_t r = 0; r < ratios.size(); ++r)
      add_with_error(series, result.at(f, weighting, r).numbers[number_of(exact, poisson)]);
    plot.series.push_back(series);
  }
  return plot;
}

/// Error against the scatter of branch lengths: a line through the perturbed lattices, points for the others.
Plot error_plot(const Result& result, std::size_t weighting, const std::string& label, std::size_t error) {
  Plot plot{.title = fmt::format("Springs weighted \"{}\"; lines: disordered lattices; bars: two standard errors",
                                 spaced(weightings[weighting])),
            .x = {.label = "scatter of branch lengths, sd/mean"},
            .y = {.label = label}};
  plot.enhanced = true;
  double lowest = 0, highest = 0;
  for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
    const std::string name = fmt::format("k_T/k_N = {:g}", result.plan.ratios[r]);
    Series lattices{.label = name,
                    .style = SeriesStyle::line_with_points,
                    .colour = colours[(r + 1) % colours.size()],
                    .marker = markers[r % markers.size()]};
    Series others = lattices;
    others.label = "";
    others.style = SeriesStyle::points;
    others.column = name + ", others";
    for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
      const Family& family = result.plan.families[f];
      if (!family.isotropic()) continue;
      const bool lattice = family.points == PointProcess::perturbed_hexagonal;
      const double scatter = result.disorder[f].branch_scatter;
      Series& series = lattice ? lattices : others;
      series.x.push_back(scatter);
      add_with_error(series, result.at(f, weighting, r).numbers[error]);
      if (r == 0 && !lattice) plot.vertical_lines.push_back({scatter, family.name, PlotColour::black, true});
    }
    for (const std::vector<double>& values : {lattices.y, others.y}) {
      for (const double y : values) {
        lowest = std::min(lowest, y);
        highest = std::max(highest, y);
      }
    }
    plot.series.push_back(lattices);
    plot.series.push_back(others);
  }
  plot.y.max = highest + 0.35 * (highest - lowest);  // room for the labels of the vertical lines
  return plot;
}

std::string plot_name(const char* what, std::size_t weighting) {
  return fmt::format("{}_{}", what, to_string(weightings[weighting]));
}
constexpr std::array plot_names{"poisson_ratio", "error_poisson_ratio", "error_shear_modulus"};

Named<Plot> plots(const Result& result) {
  Named<Plot> all;
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    all.emplace_back(plot_name(plot_names[0], w), poisson_plot(result, w));
    all.emplace_back(plot_name(plot_names[1], w),
                     error_plot(result, w, "ν of the mean field less the exact one", error_of(poisson)));
    all.emplace_back(plot_name(plot_names[2], w),
                     error_plot(result, w, "G of the mean field over the exact one, less 1", error_of(shear)));
  }
  return all;
}

Table table(const Result& result) {
  const auto& points = result.points;
  Table all;
  all.add("points", points, [&](const Point& p) { return std::string(to_string(result.family_of(p).points)); });
  all.add("disorder", points, [&](const Point& p) { return result.family_of(p).disorder; });
  all.add("stretch", points, [&](const Point& p) { return result.family_of(p).stretch; });
  all.add("weighting", points, [](const Point& p) { return std::string(to_string(p.weighting)); });
  all.add("branch_scatter", points, [&](const Point& p) { return result.disorder[p.family].branch_scatter; });
  all.add("kT_over_kN", points, &Point::ratio);
  const auto mean = [&](const std::string& name, std::size_t number) {
    all.add(name, points, [&](const Point& p) { return p.mean(number); });
  };
  const auto estimate = [&](const std::string& name, std::size_t number) {
    mean(name, number);
    all.add(name + "_standard_error", points, [&](const Point& p) { return p.numbers[number].standard_error; });
  };
  for (const auto& [modulus, name, unit] :
       {std::tuple{poisson, "nu", ""}, {shear, "G", "_over_kN"}, {bulk, "K", "_over_kN"}}) {
    estimate(fmt::format("{}_exact{}", name, unit), number_of(exact, modulus));
    mean(fmt::format("{}_mean_field{}", name, unit), number_of(mean_field, modulus));
    mean(fmt::format("{}_voigt{}", name, unit), number_of(voigt, modulus));
    if (modulus != bulk) mean(fmt::format("{}_uniform_stress{}", name, unit), number_of(uniform_stress, modulus));
  }
  estimate("nu_error", error_of(poisson));
  estimate("G_error", error_of(shear));
  estimate("K_error", error_of(bulk));
  estimate("anisotropy", anisotropy);
  return all;
}

void add_estimate(Results& object, const std::string& key, const MeanEstimate& e) {
  Results one;
  one.set("mean", e.mean).set("standard_error", e.standard_error).set("standard_deviation", e.standard_deviation);
  object.set(key, one);
}

Results json_of(const Result& result, const Point& p) {
  const Family& family = result.family_of(p);
  Results object;
  object.set("points", to_string(family.points)).set("disorder", family.disorder).set("stretch", family.stretch);
  object.set("branch_scatter", result.disorder[p.family].branch_scatter);
  object.set("weighting", to_string(p.weighting)).set("ratio", p.ratio);
  for (const auto& [answer, name] :
       {std::pair{exact, "exact"}, {mean_field, "mean_field"}, {voigt, "voigt"}, {uniform_stress, "uniform_stress"}}) {
    Results moduli;
    for (const auto& [modulus, key] :
         {std::pair{bulk, "bulk_modulus_2d"}, {shear, "shear_modulus"}, {poisson, "poisson_ratio"}})
      add_estimate(moduli, key, p.numbers[number_of(answer, modulus)]);
    object.set(name, moduli);
  }
  add_estimate(object, "shear_modulus_error", p.numbers[error_of(shear)]);
  add_estimate(object, "bulk_modulus_error", p.numbers[error_of(bulk)]);
  add_estimate(object, "poisson_ratio_error", p.numbers[error_of(poisson)]);
  add_estimate(object, "anisotropy", p.numbers[anisotropy]);
  return object;
}

int reproduce(const CommonOptions& options, bool quick) {
  std::vector<std::string> names;
  for (std::size_t w = 0; w < weightings.size(); ++w)
    for (const char* what : plot_names) names.push_back(plot_name(what, w));
  const auto lock = start_paper(options, names, {"mean_field.csv"});
  const Result result = compute(plan_of(quick));
  return finish_paper(options, {.paper = "abe1996_random",
                                .report = report(result),
                                .times = result.times,
                                .effects = derive_effects(ContactSprings({1, 1}), Rotation::free),
                                .add_numbers =
                                    [&](Results& object) {
                                      object.set("discs", result.plan.discs).set("samples", result.plan.samples);
                                      object.set("refusals", result.refusals);
                                      std::vector<Results> points;
                                      for (const Point& p : result.points) points.push_back(json_of(result, p));
                                      object.set("points", points);
                                    },
                                .tables = {{"mean_field", table(result)}},
                                .plots = plots(result)});
}

}  // namespace

Run declare(CLI::App& command) {
  return declare_with_quick(command,
                            "A question that the paper leaves open: the mean field (21), (22) and the correction (11) "
                            "beside the exact\nmoduli of random assemblies, over disorder, kT/kN and weightings.",
                            reproduce);
}

}  // namespace equidem::abe1996_random
